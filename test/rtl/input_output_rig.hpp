// Drives input and output of the gateware pipeline (test/rtl/input_output.sv): a stream source, a
// stream sink and the register bus. expected_frames() is the twin of fs_input.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <random>
#include <vector>

#include "fpga_stereo/core/spec.hpp"
#include "rtl/register_bus.hpp"

namespace fpga_stereo::test::input_output {

/// One word of the stream of pixel pairs.
struct Pixel {
  bool sof = false, eol = false;
  std::uint16_t value = 0;  // left << 8 | right
  int idle_clocks = 0;      // before this word
};

/// A frame that the output must deliver.
struct ExpectedFrame {
  std::vector<std::uint16_t> pixels;
  bool is_cut = false, is_long = false, has_buffer_error = false;
  bool is_bad() const { return is_cut || is_long || has_buffer_error; }
};

/// A frame that the output delivered.
struct ReceivedFrame {
  std::vector<std::uint16_t> pixels;
  int width = 0;
  bool is_bad = false;
};

/// input_output.sv reports a buffer error for pixels of this value.
constexpr std::uint16_t kBufferErrorPixel = 0xEEEE;

/// Returns the frames that a stream results in, up to the last complete one.
inline std::vector<ExpectedFrame> expected_frames(const std::vector<Pixel>& stream, int width,
                                                  int height) {
  const std::size_t size = static_cast<std::size_t>(width) * height;
  std::vector<ExpectedFrame> frames;
  std::size_t line = 0;  // index of the current line's first pixel
  bool is_dropping = false;
  const auto fill = [&](std::size_t end) {
    ExpectedFrame& f = frames.back();
    if (f.pixels.size() < end) f.is_cut = true;
    f.pixels.resize(std::max(end, f.pixels.size()), 0);
  };
  for (const Pixel& p : stream) {
    if (p.sof) {
      if (!frames.empty()) fill(size);
      frames.emplace_back();
      line = 0;
      is_dropping = false;
    }
    if (frames.empty()) continue;
    ExpectedFrame& f = frames.back();
    if (is_dropping || f.pixels.size() == size) {
      f.is_long = true;
      if (p.eol) is_dropping = false;
      continue;
    }
    f.pixels.push_back(p.value);
    if (p.value == kBufferErrorPixel) f.has_buffer_error = true;
    const bool is_full = f.pixels.size() == line + width;
    if (p.eol) fill(line + width);
    is_dropping = is_full && !p.eol;
    if (p.eol || is_full) line += width;
  }
  if (!frames.empty() && frames.back().pixels.size() < size) frames.pop_back();
  return frames;
}

inline std::uint16_t random_value(std::mt19937& random) {
  const auto value = static_cast<std::uint16_t>(random());
  return value == kBufferErrorPixel ? 0 : value;
}

inline void append_frame(std::vector<Pixel>& stream, int width, int height, std::mt19937& random) {
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      stream.push_back({x == 0 && y == 0, x == width - 1, random_value(random)});
    }
  }
}

inline std::vector<Pixel> complete_frames(int width, int height, int frames, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::vector<Pixel> stream;
  for (int i = 0; i < frames; ++i) append_frame(stream, width, height, random);
  return stream;
}

/// Returns frames with faults of every kind at random places; one frame in `faulty_one_in` may have
/// faults.
inline std::vector<Pixel> faulty_frames(int width, int height, int frames, std::mt19937& random,
                                        unsigned faulty_one_in = 1) {
  std::vector<Pixel> stream;
  for (int i = 0; i < frames; ++i) {
    append_frame(stream, width, height, random);
    // Pixels before the first frame belong to no frame, so that one has no faults.
    if (i == 0 || random() % faulty_one_in != 0) continue;
    const std::size_t start = stream.size() - static_cast<std::size_t>(width) * height;
    for (auto faults = random() % 4; faults > 0; --faults) {
      const auto at = stream.begin() + start + random() % (stream.size() - start);
      switch (random() % 6) {
        case 0:
          at->sof = !at->sof;
          break;
        case 1:
          at->eol = !at->eol;
          break;
        case 2:
          at->value = kBufferErrorPixel;
          break;
        case 3:
          stream.erase(at, at + std::min<std::ptrdiff_t>(random() % 40, stream.end() - at));
          break;
        case 4:
          stream.insert(at, random() % 40, Pixel{false, random() % 8 == 0, 0x1234});
          break;
        case 5:
          stream.insert(stream.end(), random() % 40, Pixel{false, random() % 8 == 0, 0x4321});
          break;
      }
      if (stream.size() <= start) break;
    }
  }
  return stream;
}

/// A model with a stream source, a stream sink and a register bus. Checks in every clock that the
/// output stream and the raster follow the rules of fpga_fw/rtl/fs_top.sv.
template <class Model>
class InputOutputRig {
 public:
  InputOutputRig(int gap_rows, unsigned seed) : gap_rows_(gap_rows), random_(seed) { reset(); }

  double source_idle = 0, sink_idle = 0;  // probability that a clock is idle
  std::int64_t clocks = 0, ticks = 0, applies = 0;
  int frames_begun = 0, max_in_flight = 0;  // frames
  std::vector<ReceivedFrame> frames;        // complete ones
  std::vector<std::int64_t> first_words;    // clock of each frame's first output word
  Model model;

  void reset(int reset_clocks = 1) {
    model.rst_ni = 0;
    model.write_i = model.read_i = 0;
    for (int i = 0; i < reset_clocks; ++i) {
      model.valid_i = model.ready_i = 0;
      edge();
    }
    model.rst_ni = 1;
    is_offered_ = is_stalled_ = false;
    in_.clear();
    partial_.clear();
    x_ = y_ = 0;
    since_sol_ = -1;
    row_ = bubble_rows_ = -1;
    needs_stage_reset_ = true;
    reset_clocks_ = 0;
    in_flight_ = 0;
    configuration_ = {0, 0};
  }

  /// Appends to the words that the source sends.
  void send(const std::vector<Pixel>& stream) {
    in_.insert(in_.end(), stream.begin(), stream.end());
  }
  std::size_t unsent() const { return in_.size(); }

  void clock() {
    if (!is_offered_ && !in_.empty()) {
      if (in_.front().idle_clocks > 0) {
        --in_.front().idle_clocks;
      } else {
        is_offered_ = random_share() >= source_idle;
      }
    }
    model.valid_i = is_offered_ ? 1 : 0;
    if (is_offered_) {
      model.sof_i = in_.front().sof ? 1 : 0;
      model.eol_i = in_.front().eol ? 1 : 0;
      model.left_i = in_.front().value >> 8;
      model.right_i = in_.front().value & 0xFF;
    } else {
      model.sof_i = random_() & 1;
      model.eol_i = random_() & 1;
      model.left_i = model.right_i = 0x99;
    }
    model.ready_i = random_share() >= sink_idle ? 1 : 0;
    model.clk_i = 0;
    model.eval();
    check_stream();
    check_raster();
    if (is_offered_ && model.ready_o) {
      in_.pop_front();
      is_offered_ = false;
    }
    edge();
    ++clocks;
  }

  void run(int n) {
    for (int i = 0; i < n && !::testing::Test::HasFailure(); ++i) clock();
  }
  /// Runs until `n` frames are out; fails if nothing moves for 20,000 clocks.
  void run_until(std::size_t n) {
    for (std::int64_t quiet = 0; frames.size() < n && quiet < 20000; ++quiet) {
      const auto before = ticks;
      const auto unsent_before = in_.size();
      clock();
      if (::testing::Test::HasFailure()) return;
      if (ticks != before || in_.size() != unsent_before) quiet = 0;
    }
    ASSERT_EQ(frames.size(), n);
  }

  void write(std::uint32_t address, std::uint32_t data) {
    write_register(
        model, [this] { clock(); }, address, data);
  }
  std::uint32_t read(std::uint32_t address) {
    return read_register(
        model, [this] { clock(); }, address);
  }
  bool is_pending() { return spec::kStatusPending.get(read(spec::kRegStatus)) != 0; }
  bool is_busy() { return spec::kStatusBusy.get(read(spec::kRegStatus)) != 0; }

  /// Writes the frame size and CONTROL.apply without waiting.
  void request_size(int width, int height) {
    write(spec::kRegWidth, width);
    write(spec::kRegHeight, height);
    write(spec::kRegControl, spec::kControlApply.put(1));
  }
  /// Requests a frame size and waits until it takes effect; no frame may be in flight.
  void apply_size(int width, int height) {
    request_size(width, height);
    for (int i = 0; i < 100 && is_pending(); ++i) run(1);
    run(2);
    ASSERT_FALSE(is_pending()) << "the configuration did not take effect";
    ASSERT_EQ(model.width_o, width);
    ASSERT_EQ(model.height_o, height);
  }

 private:
  double random_share() { return std::uniform_real_distribution<>()(random_); }
  void edge() {
    model.clk_i = 0;
    model.eval();
    model.clk_i = 1;
    model.eval();
  }

  struct Word {
    bool sof, eol, eof, bad;
    std::uint16_t disparity;
    bool operator==(const Word& o) const {
      return sof == o.sof && eol == o.eol && eof == o.eof && bad == o.bad &&
             disparity == o.disparity;
    }
  };

  void check_stream() {
    const Word word{model.sof_o != 0, model.eol_o != 0, model.eof_o != 0, model.bad_o != 0,
                    model.disparity_o};
    if (is_stalled_) {
      ASSERT_TRUE(model.valid_o) << "valid fell before ready";
      ASSERT_TRUE(word == last_) << "the payload changed while stalled";
    }
    is_stalled_ = model.valid_o && !model.ready_i;
    last_ = word;
    if (!model.valid_o || !model.ready_i) return;
    // Each frame's size follows from its own eol and eof; expect_equal() compares it.
    ASSERT_EQ(word.sof, x_ == 0 && y_ == 0) << "sof at x " << x_ << ", y " << y_;
    if (word.sof) {
      first_words.push_back(clocks);
      line_ = 0;
    }
    partial_.push_back(word.disparity);
    ++x_;
    ASSERT_TRUE(!word.eof || word.eol) << "eof without eol";
    ASSERT_TRUE(!word.bad || word.eof) << "bad without eof";
    if (word.eol) {
      ASSERT_TRUE(line_ == 0 || x_ == line_) << "line " << y_ << " has " << x_ << " pixels";
      line_ = x_;
      x_ = 0;
      ++y_;
    }
    if (word.eof) {
      frames.push_back({partial_, line_, word.bad});
      partial_.clear();
      y_ = 0;
    }
  }

  /// Checks the rules of the raster (fs_top.sv) and when the configuration may change.
  void check_raster() {
    const std::array<int, 2> configuration{model.width_o, model.height_o};
    if (configuration_[0] != 0 && configuration != configuration_) {
      ASSERT_TRUE(was_applied_) << "the configuration changed without apply";
      ASSERT_EQ(in_flight_, 0) << "the configuration changed with a frame in flight";
    }
    configuration_ = configuration;
    was_applied_ = model.apply_o;
    if (model.apply_o) {
      ASSERT_EQ(in_flight_, 0);
      ASSERT_TRUE(since_sol_ < 0 || since_sol_ == model.width_o) << "apply in the middle of a row";
      needs_stage_reset_ = true;
      reset_clocks_ = 0;
      ++applies;
    }
    if (!model.stage_rst_no) {
      ++reset_clocks_;
      ASSERT_FALSE(model.raster_valid_o || model.raster_sof_o || model.raster_sol_o);
      since_sol_ = -1;
      row_ = bubble_rows_ = -1;
      return;
    }
    if (model.frame_out_o) --in_flight_;
    ASSERT_GE(in_flight_, 0);
    if (!model.en_o) return;
    ++ticks;
    ASSERT_TRUE(!needs_stage_reset_ || reset_clocks_ >= 4)
        << "the stages were not reset for 4 clocks";
    needs_stage_reset_ = false;
    if (since_sol_ < 0 || since_sol_ == model.width_o) {
      ASSERT_TRUE(model.raster_sol_o) << "a row does not start with sol";
      since_sol_ = 0;
      if (model.raster_sof_o) {
        ASSERT_TRUE(model.raster_valid_o);
        ASSERT_LT(row_, 0) << "a frame starts before the previous one ended";
        ASSERT_TRUE(bubble_rows_ < 0 || bubble_rows_ >= gap_rows_)
            << bubble_rows_ << " bubble rows between frames";
        row_ = 0;
        ++in_flight_;
        ++frames_begun;
        max_in_flight = std::max(max_in_flight, in_flight_);
      } else {
        ASSERT_EQ(model.raster_valid_o != 0, row_ >= 0);
        if (row_ < 0 && bubble_rows_ >= 0) ++bubble_rows_;
      }
    } else {
      ASSERT_FALSE(model.raster_sol_o || model.raster_sof_o)
          << "sol or sof at column " << since_sol_;
      ASSERT_EQ(model.raster_valid_o != 0, row_ >= 0);
    }
    ++since_sol_;
    if (since_sol_ == model.width_o && row_ >= 0 && ++row_ == model.height_o) {
      row_ = -1;
      bubble_rows_ = 0;
    }
  }

  int gap_rows_;
  std::mt19937 random_;
  std::deque<Pixel> in_;
  bool is_offered_ = false, is_stalled_ = false, was_applied_ = false;
  Word last_{};
  std::vector<std::uint16_t> partial_;
  int x_ = 0, y_ = 0, line_ = 0;
  int since_sol_ = -1, row_ = -1, in_flight_ = 0;
  int bubble_rows_ = -1;           // since the last frame; -1: there was none
  bool needs_stage_reset_ = true;  // before the next tick
  int reset_clocks_ = 0;           // of stage_rst_no
  std::array<int, 2> configuration_{};
};

/// Compares the rig's frames from `first` on with the expected ones, bit for bit.
template <class Model>
void expect_equal(const InputOutputRig<Model>& rig, const std::vector<ExpectedFrame>& expected,
                  std::size_t first = 0) {
  ASSERT_EQ(rig.frames.size(), first + expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    ASSERT_EQ(rig.frames[first + i].pixels, expected[i].pixels) << "frame " << i;
    ASSERT_EQ(rig.frames[first + i].is_bad, expected[i].is_bad()) << "bad flag of frame " << i;
  }
}

template <class Model>
void expect_counters(InputOutputRig<Model>& rig, const std::vector<ExpectedFrame>& expected) {
  std::uint32_t cut = 0, too_long = 0, buffer_errors = 0;
  for (const ExpectedFrame& f : expected) {
    cut += f.is_cut ? 1 : 0;
    too_long += f.is_long ? 1 : 0;
    buffer_errors += f.has_buffer_error ? 1 : 0;
  }
  EXPECT_EQ(rig.read(spec::kRegFramesOut), expected.size());
  EXPECT_EQ(rig.read(spec::kRegCutFrames), cut);
  EXPECT_EQ(rig.read(spec::kRegLongFrames), too_long);
  EXPECT_EQ(rig.read(spec::kRegBufferErrors), buffer_errors);
  const std::uint32_t errors = rig.read(spec::kRegErrors);
  EXPECT_EQ(spec::kErrorsCutFrame.get(errors), cut > 0 ? 1U : 0U);
  EXPECT_EQ(spec::kErrorsLongFrame.get(errors), too_long > 0 ? 1U : 0U);
  EXPECT_EQ(spec::kErrorsBufferLeft.get(errors), buffer_errors > 0 ? 1U : 0U);
}

/// Sends the stream and after it one complete frame; compares frames, flags and counters.
template <class Model>
void send_and_check(InputOutputRig<Model>& rig, std::vector<Pixel> stream, int width, int height) {
  std::mt19937 random(7);
  append_frame(stream, width, height, random);
  const auto expected = expected_frames(stream, width, height);
  const std::size_t first = rig.frames.size();
  rig.write(spec::kRegControl, spec::kControlClear.put(1));
  rig.send(stream);
  rig.run_until(first + expected.size());
  if (::testing::Test::HasFatalFailure()) return;
  rig.run(200);
  expect_equal(rig, expected, first);
  expect_counters(rig, expected);
  EXPECT_EQ(rig.read(spec::kRegFramesIn), expected.size());
  EXPECT_FALSE(rig.is_busy());
}

}  // namespace fpga_stereo::test::input_output
