// The simulated gateware, clock by clock, as the software of a board sees the real one: registers
// and two streams (fpga_fw/rtl/fs_top.sv).
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

/// A word of the stream of raw pixels.
struct Pixel {
  std::uint8_t left = 0, right = 0;
  bool sof = false;  // first of a frame
  bool eol = false;  // last of a line
};

/// A word of the stream of disparities.
struct Word {
  std::uint16_t disparity = 0;
  bool sof = false, eol = false;
  bool eof = false;  // last of a frame
  bool bad = false;  // with eof: the frame is not to be used
};

/// What came out for one frame that went in, with the clocks in which pixels were taken.
struct Frame {
  cv::Mat1w disparity;
  bool bad = false;
  std::int64_t first_in = -1, last_in = -1, first_out = -1, last_out = -1;
};

/// How streams are moved.
struct Flow {
  double valid = 1;  // share of the clocks in which a pixel is offered, if there is one
  double ready = 1;  // share of the clocks in which a disparity is taken
  unsigned seed = 1;
  std::vector<RegisterWrite> writes;  // registers to write meanwhile, one in a clock
};

struct Counters {
  std::uint32_t frames_in, frames_out, cut_frames, long_frames, buffer_errors, label_exhaustion,
      mesh_swaps;
};

/// The words of frames that follow each other.
std::vector<Pixel> pixels(const std::vector<GreyPair>& frames);

class Gateware {
 public:
  /// Loads what build_model made and resets it. Registers and memories start with random values of
  /// `seed`. Refuses a file that is no model and one of another specification.
  static Result<Gateware> open(const std::string& model, std::uint32_t seed = 1);

  /// What its registers say, and what it was made with.
  const GatewareBuild& build() const { return build_; }
  const ModelParameters& model_parameters() const { return model_.parameters(); }

  // Every function below takes clocks of simulated time. Those that write or read registers hold
  // both streams meanwhile, but for Flow::writes.

  void reset(int num_clocks = 4);
  void write(std::uint32_t address, std::uint32_t value);
  std::uint32_t read(std::uint32_t address);

  /// Writes everything; it takes effect when all frames in flight have come out. Refuses what
  /// check_build() does, and says which register does not hold what was written.
  Status apply(const Parameters& parameters, const StereoRectification& rectification);

  /// Sends words, until they are taken and `num_frames` frames have come out. Gives these frames;
  /// those that stay in flight come with the next call. Fails where nothing moves for long, and
  /// where what comes out is no stream of whole frames.
  Result<std::vector<Frame>> stream(const std::vector<Pixel>& words, std::size_t num_frames,
                                    const Flow& flow = {});
  /// Sends frames, one behind the other, and gives what comes out for them.
  Result<std::vector<Frame>> process(const std::vector<GreyPair>& frames, const Flow& flow = {});

  /// Lets the clock run, with nothing offered and every disparity taken.
  void idle(int num_clocks);

  Counters counters();
  /// Of the frame that last left each stage: waits until none is in flight.
  std::array<std::uint32_t, kNumStages> signatures();

  /// Clocks so far.
  std::int64_t clocks() const { return clocks_; }

  /// Every signal from now on, as VCD; for models built with --trace.
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
  /// Clocks after which a gateware in which nothing moves is stuck.
  std::int64_t patience() const;

  LoadedModel<ModelInterface> model_;
  GatewareBuild build_;
  std::int64_t clocks_ = 0;

  // The streams.
  std::deque<Frame> in_flight_;        // in the order in which they went in
  std::vector<std::uint16_t> values_;  // of the frame that comes out
  int row_length_ = 0;                 // of that frame: 0 = not known yet
  std::vector<Frame> done_;
  std::optional<ModelOutputs> waiting_;  // a disparity that was offered and not taken
  std::string failure_;                  // first one since the reset; empty: none
};

}  // namespace fpga_stereo::sim
