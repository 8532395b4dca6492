// What makes frames beside the software.
#pragma once

#include <functional>
#include <optional>

#include "fpga_stereo/core/parameters.hpp"
#include "fpga_stereo/core/result.hpp"
#include "ros/board_report.hpp"
#include "ros/demand.hpp"
#include "ros/node_state.hpp"
#include "ros/settings.hpp"
#include "ros/source_pair.hpp"
#include "ros/stereo_frame.hpp"

namespace fpga_stereo {

/// A board, or the recording of one. Thread-safe.
class BoardInput {
 public:
  /// Called without a lock, from threads of the input; `pair` and `changed` also from refresh().
  struct Callbacks {
    std::function<void(const StereoFrame&)> frame;
    /// Images of the board's cameras, before anything is made of them.
    std::function<void(const SourcePair&)> images;
    /// A raw pair that the software has to compute, because the board cannot or has gone.
    std::function<void(const SourcePair&)> pair;
    /// The board came, went, or changed what it can do.
    std::function<void()> changed;
  };

  virtual ~BoardInput() = default;
  /// True while a board is connected that this software works with, or a recording is open.
  virtual bool is_present() const = 0;
  virtual bool makes_disparity() const = 0;
  /// Sends a pair from the topics, or drops it while the board is busy with older ones. Returns
  /// false if the pair is left to the software.
  virtual bool send(const SourcePair& pair) = 0;
  /// The parameters for the board's pairs, whether the board or the software computes them. Without
  /// a board, those of the settings.
  virtual Parameters parameters() const = 0;

  virtual void set_demand(const Demand& demand) = 0;
  virtual void set_settings(const Settings& settings) = 0;
  /// Adopts a new calibration and lets go of a board that was refused. Call about once a second.
  virtual void refresh() = 0;
  /// Resets the link as the last step of the watchdog does. Fails if it is not open.
  virtual Status reset() = 0;

  /// Says why there are no frames; nullopt if there are or would be.
  virtual std::optional<StateReport> trouble() const = 0;
  virtual BoardReport report() const = 0;
};

}  // namespace fpga_stereo
