// The simulated pipeline of the gateware (fpga_fw/rtl/fs_top.sv), clock by clock: registers, a
// stream of raw pixels in and a stream of disparities out.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "fpga_stereo/core/calibration.hpp"
#include "fpga_stereo/core/gateware_configuration.hpp"
#include "fpga_stereo/core/parameters.hpp"
#include "fpga_stereo/core/result.hpp"
#include "fpga_stereo/core/spec.hpp"
#include "sim/gateware/grey_pair.hpp"
#include "sim/gateware/library.hpp"

namespace fpga_stereo::sim {

/// A word of the raw pixel stream.
struct Pixel {
  std::uint8_t left = 0, right = 0;
  bool sof = false;  // first pixel of a frame
  bool eol = false;  // last pixel of a row
};

/// A word of the disparity stream.
struct Word {
  std::uint16_t disparity = 0;
  bool sof = false, eol = false;
  bool eof = false;  // last pixel of a frame
  bool bad = false;  // with eof: the frame is invalid
};

/// The result of one frame, with the clocks of its first and last pixel in and out.
struct Frame {
  cv::Mat1w disparity;
  bool bad = false;
  std::int64_t first_in = -1, last_in = -1, first_out = -1, last_out = -1;
};

/// How fast both streams move.
struct Flow {
  double valid = 1;  // fraction of the clocks in which the next pixel is offered
  double ready = 1;  // fraction of the clocks in which a disparity is taken
  unsigned seed = 1;
  std::vector<RegisterWrite> writes;  // registers to write meanwhile, one per clock
};

struct Counters {
  std::uint32_t frames_in, frames_out, cut_frames, long_frames, buffer_errors, label_exhaustion,
      mesh_uploads;
};

/// Returns the pixel words of consecutive frames.
std::vector<Pixel> to_pixels(const std::vector<GreyPair>& frames);

/// Not thread-safe.
class Gateware {
 public:
  /// Loads a model of fs_top and resets it. Registers and memories start with random values from
  /// `seed`. Refuses a file that is not a model or was made from another specification.
  static Result<Gateware> open(const std::string& model, std::uint32_t seed = 1);

  /// Build parameters: from its registers, and from the model.
  const GatewareBuild& build() const { return build_; }
  const ModelParameters& model_parameters() const { return model_.parameters(); }

  // Every function below consumes simulated clocks. Register accesses stall both streams, except
  // for Flow::writes.

  void reset(int num_clocks = 4);
  void write(std::uint32_t address, std::uint32_t value);
  std::uint32_t read(std::uint32_t address);

  /// Writes a configuration, which takes effect when all frames in flight have come out. Refuses
  /// what check_build() refuses. Fails if a register does not hold the written value.
  Status apply(const Parameters& parameters, const StereoRectification& rectification);

  /// Sends words until all are taken and `num_frames` frames have come out. Returns these frames;
  /// frames that stay in flight come with the next call. Fails if the streams stop moving or the
  /// output violates the stream contract.
  Result<std::vector<Frame>> stream(const std::vector<Pixel>& words, std::size_t num_frames,
                                    const Flow& flow = {});
  /// Sends consecutive frames and returns their results.
  Result<std::vector<Frame>> process(const std::vector<GreyPair>& frames, const Flow& flow = {});

  /// Runs the clock without input; takes every disparity.
  void idle(int num_clocks);

  Counters counters();
  /// Waits until no frame is in flight. Returns the signature of the last frame of each stage.
  std::array<std::uint32_t, kNumGatewareStages> signatures();

  /// Returns the number of clocks since construction.
  std::int64_t clocks() const { return clocks_; }

  /// Writes all signals from now on to a VCD file. Works only for models built with --trace.
  Status open_trace(const std::string& path) { return model_.open_trace(path); }
  void close_trace() { model_.close_trace(); }

 private:
  explicit Gateware(LoadedModel<ModelInterface> model) : model_(std::move(model)) {}
  ModelOutputs clock(const ModelInputs& in);
  Status check_identity(const std::string& model);
  void read_build();
  void count_in(const Pixel& pixel);
  void count_out(const ModelOutputs& out, bool ready);
  void collect(const Word& word);
  void fail(const std::string& what);
  /// Returns the number of clocks without movement after which the gateware is stuck.
  std::int64_t timeout_clocks() const;

  LoadedModel<ModelInterface> model_;
  GatewareBuild build_;
  std::int64_t clocks_ = 0;

  // The streams.
  std::deque<Frame> in_flight_;        // oldest first
  std::vector<std::uint16_t> values_;  // disparities of the oldest frame so far
  int row_length_ = 0;                 // of that frame; 0: not known yet
  std::vector<Frame> done_;
  std::optional<ModelOutputs> stalled_;  // a disparity that was offered and not taken
  std::string failure_;                  // the first since the reset; empty: none
};

}  // namespace fpga_stereo::sim
