// Plays the recording of a link: what the board was, how it was configured, and its frames.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "fpga_stereo/core/gateware_configuration.hpp"
#include "fpga_stereo/core/parameters.hpp"
#include "fpga_stereo/core/result.hpp"
#include "fpga_stereo/link/counters.hpp"
#include "fpga_stereo/link/frame_set.hpp"
#include "fpga_stereo/link/identity.hpp"
#include "fpga_stereo/link/streams.hpp"
#include "fpga_stereo/link/transport.hpp"

namespace fpga_stereo::link {

/// A configuration of the recorded board, as its host wrote it and the board confirmed it.
struct RecordedConfiguration {
  GatewareConfiguration configuration;

  /// The parameters that its registers and the board's build hold. min_disparity is not among them:
  /// it is part of the right mesh.
  Parameters parameters() const;
  /// Returns true if registers and meshes are the same.
  bool equals(const GatewareConfiguration& other) const;
};

/// Sends nothing: the recorded board answered another host. Not thread-safe.
class RecordingPlayer {
 public:
  struct Frames {
    FrameSet set;
    /// What made them; null if the recording does not contain it.
    std::shared_ptr<const RecordedConfiguration> configuration;
  };

  /// Opens a recording: "replay:FILE[:SPEED]", as for open_transport(). Frames of other streams
  /// than `streams` are ignored.
  static Result<std::unique_ptr<RecordingPlayer>> open(const std::string& name,
                                                       StreamSet streams = StreamSet::all());
  virtual ~RecordingPlayer() = default;

  /// Returns the frame sets that are due; blocks until some are or the timeout expires. Fails with
  /// kUnplugged at the end and with kIo at damage, after it has returned all frames.
  virtual Result<std::vector<Frames>> take(std::chrono::milliseconds timeout) = 0;
  /// The board that was recorded; nullopt until its answer has been played.
  virtual const std::optional<Identity>& identity() const = 0;
  /// How many times as fast as recorded; 0: unlimited.
  virtual double speed() const = 0;
  /// Returns a text for people.
  virtual std::string description() const = 0;
  virtual DecoderCounters decoder_counters() const = 0;
  virtual FrameCounters frame_counters() const = 0;
  virtual Transport::Counters transport_counters() const = 0;
};

}  // namespace fpga_stereo::link
