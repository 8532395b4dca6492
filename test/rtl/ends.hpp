// Drives the two ends of the gateware pipeline (test/rtl/fs_ends.sv) as a source and a sink of
// streams and over the bus, and says what must come out.
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

namespace fpga_stereo::test::ends {

/// One word of the stream of pixel pairs.
struct Pixel {
  bool sof = false, eol = false;
  std::uint16_t value = 0;  // left << 8 | right
  int idle_clocks = 0;      // before it
};

/// What must come out for one frame.
struct Frame {
  std::vector<std::uint16_t> pixels;
  bool cut = false, surplus = false, lacks = false;
  bool bad() const { return cut || surplus || lacks; }
};

/// What came out for one frame.
struct Received {
  std::vector<std::uint16_t> pixels;
  int width = 0;
  bool bad = false;
};

constexpr std::uint16_t kLacking = 0xEEEE;  // "rectify" of fs_ends lacks such pixels

/// The frames that a stream gives; what is after the last whole one is left out.
inline std::vector<Frame> expected_frames(const std::vector<Pixel>& stream, int width, int height) {
  const std::size_t size = static_cast<std::size_t>(width) * height;
  std::vector<Frame> frames;
  std::size_t line = 0;  // where the line under way begins
  bool dropping = false;
  const auto fill = [&](std::size_t end) {
    Frame& f = frames.back();
    if (f.pixels.size() < end) f.cut = true;
    f.pixels.resize(std::max(end, f.pixels.size()), 0);
  };
  for (const Pixel& p : stream) {
    if (p.sof) {
      if (!frames.empty()) fill(size);
      frames.emplace_back();
      line = 0;
      dropping = false;
    }
    if (frames.empty()) continue;
    Frame& f = frames.back();
    if (dropping || f.pixels.size() == size) {
      f.surplus = true;
      if (p.eol) dropping = false;
      continue;
    }
    f.pixels.push_back(p.value);
    if (p.value == kLacking) f.lacks = true;
    const bool full = f.pixels.size() == line + width;
    if (p.eol) fill(line + width);
    dropping = full && !p.eol;
    if (p.eol || full) line += width;
  }
  if (!frames.empty() && frames.back().pixels.size() < size) frames.pop_back();
  return frames;
}

inline std::uint16_t some_value(std::mt19937& random) {
  const auto value = static_cast<std::uint16_t>(random());
  return value == kLacking ? 0 : value;
}

inline void append_frame(std::vector<Pixel>& stream, int width, int height, std::mt19937& random) {
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      stream.push_back({x == 0 && y == 0, x == width - 1, some_value(random)});
    }
  }
}

inline std::vector<Pixel> whole_frames(int width, int height, int frames, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::vector<Pixel> stream;
  for (int i = 0; i < frames; ++i) append_frame(stream, width, height, random);
  return stream;
}

/// Frames with mistakes of every kind at random places.
inline std::vector<Pixel> spoiled_frames(int width, int height, int frames, std::mt19937& random,
                                         unsigned one_in = 1) {
  std::vector<Pixel> stream;
  for (int i = 0; i < frames; ++i) {
    append_frame(stream, width, height, random);
    // Before the first there is nothing that a pixel could belong to.
    if (i == 0 || random() % one_in != 0) continue;
    const std::size_t start = stream.size() - static_cast<std::size_t>(width) * height;
    for (auto mistakes = random() % 4; mistakes > 0; --mistakes) {
      const auto at = stream.begin() + start + random() % (stream.size() - start);
      switch (random() % 6) {
        case 0:
          at->sof = !at->sof;
          break;
        case 1:
          at->eol = !at->eol;
          break;
        case 2:
          at->value = kLacking;
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

/// The model with a source, a sink and a bus. Every clock checks that streams and raster keep to
/// their rules.
template <class Model>
class Bench {
 public:
  Bench(int min_rows, unsigned seed) : min_rows_(min_rows), random_(seed) { reset(); }

  double source_idle = 0, sink_idle = 0;  // shares of the clocks
  std::int64_t clocks = 0, ticks = 0, applies = 0;
  int begun = 0, most_in_flight = 0;      // frames
  std::vector<Received> frames;           // that came out whole
  std::vector<std::int64_t> first_words;  // clocks in which frames began to come out
  Model model;

  void reset(int reset_clocks = 1) {
    model.rst_ni = 0;
    model.write_i = model.read_i = 0;
    for (int i = 0; i < reset_clocks; ++i) {
      model.valid_i = model.ready_i = 0;
      edge();
    }
    model.rst_ni = 1;
    offered_ = held_ = false;
    in_.clear();
    partial_.clear();
    x_ = y_ = 0;
    since_sol_ = -1;
    row_ = rows_since_sof_ = -1;
    resets_ = true;
    low_clocks_ = 0;
    in_flight_ = 0;
    configuration_ = {0, 0};
  }

  void send(const std::vector<Pixel>& stream) {
    in_.insert(in_.end(), stream.begin(), stream.end());
  }
  std::size_t unsent() const { return in_.size(); }

  void clock() {
    if (!offered_ && !in_.empty()) {
      if (in_.front().idle_clocks > 0) {
        --in_.front().idle_clocks;
      } else {
        offered_ = share() >= source_idle;
      }
    }
    model.valid_i = offered_ ? 1 : 0;
    if (offered_) {
      model.sof_i = in_.front().sof ? 1 : 0;
      model.eol_i = in_.front().eol ? 1 : 0;
      model.left_i = in_.front().value >> 8;
      model.right_i = in_.front().value & 0xFF;
    } else {
      model.sof_i = random_() & 1;
      model.eol_i = random_() & 1;
      model.left_i = model.right_i = 0x99;
    }
    model.ready_i = share() >= sink_idle ? 1 : 0;
    model.clk_i = 0;
    model.eval();
    check_stream();
    check_raster();
    if (offered_ && model.ready_o) {
      in_.pop_front();
      offered_ = false;
    }
    edge();
    ++clocks;
  }

  void run(int n) {
    for (int i = 0; i < n && !::testing::Test::HasFailure(); ++i) clock();
  }
  /// Until so many frames are out, or nothing has happened for long.
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
  bool pending() { return spec::kStatusPending.get(read(spec::kRegStatus)) != 0; }
  bool busy() { return spec::kStatusBusy.get(read(spec::kRegStatus)) != 0; }

  void request(int width, int height) {
    write(spec::kRegWidth, width);
    write(spec::kRegHeight, height);
    write(spec::kRegControl, spec::kControlApply.put(1));
  }
  /// With nothing in flight.
  void configure(int width, int height) {
    request(width, height);
    for (int i = 0; i < 100 && pending(); ++i) run(1);
    run(2);
    ASSERT_FALSE(pending()) << "the configuration does not take effect";
    ASSERT_EQ(model.width_o, width);
    ASSERT_EQ(model.height_o, height);
  }

 private:
  double share() { return std::uniform_real_distribution<>()(random_); }
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
    if (held_) {
      ASSERT_TRUE(model.valid_o) << "valid went away";
      ASSERT_TRUE(word == last_) << "the payload changed while it waited";
    }
    held_ = model.valid_o && !model.ready_i;
    last_ = word;
    if (!model.valid_o || !model.ready_i) return;
    // The size of a frame is taken from its own eol and eof; expect() compares all of it.
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
      ASSERT_TRUE(line_ == 0 || x_ == line_) << "a line of " << x_;
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

  /// The rules of the raster (fs_top), and of the configuration.
  void check_raster() {
    const std::array<int, 2> configuration{model.width_o, model.height_o};
    if (configuration_[0] != 0 && configuration != configuration_) {
      ASSERT_TRUE(applied_) << "the configuration changed by itself";
      ASSERT_EQ(in_flight_, 0) << "the configuration changed under a frame";
    }
    configuration_ = configuration;
    applied_ = model.apply_o;
    if (model.apply_o) {
      ASSERT_EQ(in_flight_, 0);
      ASSERT_TRUE(since_sol_ < 0 || since_sol_ == model.width_o) << "apply within a row";
      resets_ = true;
      low_clocks_ = 0;
      ++applies;
    }
    if (!model.stage_rst_no) {
      ++low_clocks_;
      ASSERT_FALSE(model.raster_valid_o || model.raster_sof_o || model.raster_sol_o);
      since_sol_ = -1;
      rows_since_sof_ = -1;
      row_ = -1;
      return;
    }
    if (model.frame_out_o) --in_flight_;
    ASSERT_GE(in_flight_, 0);
    if (!model.en_o) return;
    ++ticks;
    ASSERT_TRUE(!resets_ || low_clocks_ >= 4) << "no reset of the stages";
    resets_ = false;
    if (since_sol_ < 0 || since_sol_ == model.width_o) {
      ASSERT_TRUE(model.raster_sol_o) << "a row that does not start with sol";
      since_sol_ = 0;
      if (rows_since_sof_ >= 0) ++rows_since_sof_;
      if (model.raster_sof_o) {
        ASSERT_TRUE(model.raster_valid_o);
        ASSERT_LT(row_, 0) << "a frame starts within a frame";
        ASSERT_TRUE(rows_since_sof_ < 0 || rows_since_sof_ >= min_rows_)
            << "frames start " << rows_since_sof_ << " rows apart";
        row_ = rows_since_sof_ = 0;
        ++in_flight_;
        ++begun;
        most_in_flight = std::max(most_in_flight, in_flight_);
      } else {
        ASSERT_EQ(model.raster_valid_o != 0, row_ >= 0);
      }
    } else {
      ASSERT_FALSE(model.raster_sol_o || model.raster_sof_o) << "sol after " << since_sol_;
      ASSERT_EQ(model.raster_valid_o != 0, row_ >= 0);
    }
    ++since_sol_;
    if (since_sol_ == model.width_o && row_ >= 0 && ++row_ == model.height_o) row_ = -1;
  }

  int min_rows_;
  std::mt19937 random_;
  std::deque<Pixel> in_;
  bool offered_ = false, held_ = false, applied_ = false;
  Word last_{};
  std::vector<std::uint16_t> partial_;
  int x_ = 0, y_ = 0, line_ = 0;
  int since_sol_ = -1, row_ = -1, rows_since_sof_ = -1, in_flight_ = 0;
  bool resets_ = true;  // the stages must be reset before the next tick
  int low_clocks_ = 0;  // of stage_rst_no
  std::array<int, 2> configuration_{};
};

/// Bit for bit, from frame `first` of the bench on.
template <class Model>
void expect(const Bench<Model>& bench, const std::vector<Frame>& expected, std::size_t first = 0) {
  ASSERT_EQ(bench.frames.size(), first + expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    ASSERT_EQ(bench.frames[first + i].pixels, expected[i].pixels) << "frame " << i;
    ASSERT_EQ(bench.frames[first + i].bad, expected[i].bad()) << "bad flag of frame " << i;
  }
}

template <class Model>
void expect_counters(Bench<Model>& bench, const std::vector<Frame>& expected) {
  std::uint32_t cut = 0, surplus = 0, lacks = 0;
  for (const Frame& f : expected) {
    cut += f.cut ? 1 : 0;
    surplus += f.surplus ? 1 : 0;
    lacks += f.lacks ? 1 : 0;
  }
  EXPECT_EQ(bench.read(spec::kRegFramesOut), expected.size());
  EXPECT_EQ(bench.read(spec::kRegCutFrames), cut);
  EXPECT_EQ(bench.read(spec::kRegLongFrames), surplus);
  EXPECT_EQ(bench.read(spec::kRegBufferErrors), lacks);
  const std::uint32_t errors = bench.read(spec::kRegErrors);
  EXPECT_EQ(spec::kErrorsCutFrame.get(errors), cut > 0 ? 1U : 0U);
  EXPECT_EQ(spec::kErrorsLongFrame.get(errors), surplus > 0 ? 1U : 0U);
  EXPECT_EQ(spec::kErrorsBufferLeft.get(errors), lacks > 0 ? 1U : 0U);
}

/// Sends a stream, behind it a whole frame, and compares everything.
template <class Model>
void check(Bench<Model>& bench, std::vector<Pixel> stream, int width, int height) {
  std::mt19937 random(7);
  append_frame(stream, width, height, random);
  const auto expected = expected_frames(stream, width, height);
  const std::size_t first = bench.frames.size();
  bench.write(spec::kRegControl, spec::kControlClear.put(1));
  bench.send(stream);
  bench.run_until(first + expected.size());
  if (::testing::Test::HasFatalFailure()) return;
  bench.run(200);
  expect(bench, expected, first);
  expect_counters(bench, expected);
  EXPECT_EQ(bench.read(spec::kRegFramesIn), expected.size());
  EXPECT_FALSE(bench.busy());
}

}  // namespace fpga_stereo::test::ends
