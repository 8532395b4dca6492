// The two ends of the gateware pipeline (fs_input, fs_output, fs_stream_fifo, with fs_registers and
// fs_signature), with stages between them that only delay: test/rtl/fs_ends.sv.
#include <gtest/gtest.h>

#include <deque>
#include <memory>
#include <random>
#include <vector>

#include "Ends.h"
#include "EndsFew.h"
#include "EndsTiny.h"
#include "fpga_stereo/core/signature.hpp"
#include "fpga_stereo/core/spec.hpp"

namespace fpga_stereo::test {
namespace {

/// One word of the stream of pixel pairs.
struct Pixel {
  bool sof = false, eol = false;
  std::uint16_t value = 0;  // left << 8 | right
  int idle_clocks = 0;      // before it
};

/// What comes out for one frame.
struct Frame {
  std::vector<std::uint16_t> pixels;
  bool cut = false, surplus = false, lacks = false;
  bool bad() const { return cut || surplus || lacks; }
};

constexpr std::uint16_t kLacking = 0xEEEE;  // "rectify" of fs_ends lacks such pixels

/// The frames that a stream gives; what is after the last whole one is left out.
std::vector<Frame> expected_frames(const std::vector<Pixel>& stream, int width, int height) {
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

std::uint16_t some_value(std::mt19937& random) {
  const auto value = static_cast<std::uint16_t>(random());
  return value == kLacking ? 0 : value;
}

void append_frame(std::vector<Pixel>& stream, int width, int height, std::mt19937& random) {
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      stream.push_back({x == 0 && y == 0, x == width - 1, some_value(random)});
    }
  }
}

std::vector<Pixel> whole_frames(int width, int height, int frames, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::vector<Pixel> stream;
  for (int i = 0; i < frames; ++i) append_frame(stream, width, height, random);
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
  std::vector<Frame> frames;              // that came out whole; bad() is in `cut`
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
    reset_left_ = 7;  // stage_rst_no stays low at least so long
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
    model.write_i = 1;
    model.address_i = address;
    model.data_i = data;
    clock();
    model.write_i = 0;
  }
  std::uint32_t read(std::uint32_t address) {
    model.read_i = 1;
    model.address_i = address;
    clock();
    model.read_i = 0;
    EXPECT_TRUE(model.read_valid_o);
    return model.data_o;
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
    ASSERT_FALSE(pending());
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
      Frame frame;
      frame.cut = word.bad;
      frame.pixels.swap(partial_);
      frames.push_back(frame);
      widths.push_back(line_);
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
      reset_left_ = 8;
      ++applies;
    } else if (reset_left_ > 0) {
      if (!model.stage_rst_no || reset_left_ < 8) --reset_left_;
    }
    if (!model.stage_rst_no) {
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
    ASSERT_EQ(reset_left_, 0) << "a tick too soon after the configuration changed";
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

 public:
  std::vector<int> widths;  // of the frames

 private:
  int min_rows_;
  std::mt19937 random_;
  std::deque<Pixel> in_;
  bool offered_ = false, held_ = false, applied_ = false;
  Word last_{};
  std::vector<std::uint16_t> partial_;
  int x_ = 0, y_ = 0, line_ = 0;
  int since_sol_ = -1, row_ = -1, rows_since_sof_ = -1, reset_left_ = 0, in_flight_ = 0;
  std::array<int, 2> configuration_{};
};

class Standard : public Bench<Ends> {
 public:
  explicit Standard(unsigned seed = 1) : Bench(3, seed) {}
};

/// Bit for bit, from frame `first` of the bench on.
template <class Model>
void expect(const Bench<Model>& bench, const std::vector<Frame>& expected, std::size_t first = 0) {
  ASSERT_EQ(bench.frames.size(), first + expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    ASSERT_EQ(bench.frames[first + i].pixels, expected[i].pixels) << "frame " << i;
    ASSERT_EQ(bench.frames[first + i].cut, expected[i].bad()) << "bad flag of frame " << i;
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

TEST(InputOutput, WholeFramesInOrder) {
  const double idles[] = {0, 0.3, 0.9};
  Standard bench(2);
  for (const auto& [width, height] :
       {std::pair{16, 1}, {16, 2}, {17, 3}, {16, 4}, {23, 7}, {64, 9}}) {
    bench.configure(width, height);
    for (const double source_idle : idles) {
      for (const double sink_idle : idles) {
        SCOPED_TRACE(::testing::Message() << width << " x " << height << ", idle " << source_idle
                                          << " and " << sink_idle);
        bench.source_idle = source_idle;
        bench.sink_idle = sink_idle;
        check(bench, whole_frames(width, height, 5), width, height);
        if (HasFatalFailure()) return;
      }
    }
  }
}

TEST(InputOutput, GapsOfAnyLength) {
  Standard bench(3);
  bench.configure(16, 4);
  std::mt19937 random(3);
  for (int i = 0; i < 60; ++i) {
    auto stream = whole_frames(16, 4, 4, i);
    for (Pixel& p : stream) {
      if (p.sof || random() % 40 == 0) p.idle_clocks = static_cast<int>(random() % 300);
    }
    check(bench, stream, 16, 4);
    if (HasFatalFailure()) return;
  }
}

TEST(InputOutput, BackToBackAPixelPerClock) {
  Standard bench;
  for (const auto& [width, height] : {std::pair{16, 3}, {31, 4}, {64, 11}, {16, 1}, {20, 2}}) {
    SCOPED_TRACE(::testing::Message() << width << " x " << height);
    bench.configure(width, height);
    const std::size_t first = bench.frames.size();
    const auto stream = whole_frames(width, height, 9);
    bench.send(stream);
    bench.run_until(first + 9);
    expect(bench, expected_frames(stream, width, height), first);
    if (HasFailure()) return;
    for (std::size_t i = first + 1; i < first + 9; ++i) {
      EXPECT_EQ(bench.first_words[i] - bench.first_words[i - 1], width * std::max(height, 3));
    }
  }
}

TEST(InputOutput, LastFrameComesOutAndThenAllIsStill) {
  Standard bench;
  bench.configure(16, 5);
  const auto stream = whole_frames(16, 5, 2);
  bench.send(stream);
  bench.run_until(2);
  expect(bench, expected_frames(stream, 16, 5));
  EXPECT_FALSE(bench.busy());
  bench.run(40);  // the rest of a row of bubbles
  const auto ticks = bench.ticks;
  bench.run(1000);
  EXPECT_EQ(bench.ticks, ticks);
  // The latency is that of fs_ends: 7 rows and 7 ticks behind the last pixel, and rows are
  // completed.
  EXPECT_EQ(bench.ticks, 16 * (2 * 5 + 8));
}

TEST(InputOutput, SignatureIsThereWhenAllIsStill) {
  Standard bench;
  bench.configure(16, 5);
  for (int i = 0; i < 3; ++i) {
    const auto stream = whole_frames(16, 5, 2, i);
    bench.send(stream);
    bench.run_until(2 * (i + 1));
    Signature signature;
    for (const std::uint16_t value : bench.frames.back().pixels) signature.add(value);
    bench.run(40);
    EXPECT_EQ(bench.read(spec::kRegSignatureRectify), signature.value());
    EXPECT_EQ(bench.read(spec::kRegSignatureSpike), signature.value());
  }
}

TEST(InputOutput, CutAtEveryPixel) {
  const int width = 16, height = 4;
  Standard bench;
  bench.configure(width, height);
  for (const double idle : {0., 0.4}) {
    bench.source_idle = bench.sink_idle = idle;
    for (int length = 1; length < width * height; ++length) {
      SCOPED_TRACE(length);
      auto stream = whole_frames(width, height, 2);
      stream.resize(width * height + length);
      check(bench, stream, width, height);
      if (HasFatalFailure()) return;
    }
  }
}

TEST(InputOutput, PadsAtATickPerClock) {
  const int width = 16, height = 4;
  Standard bench;
  bench.configure(width, height);
  std::vector<Pixel> stream;
  for (const int length : {64, 1, 20, 64, 16, 63, 64}) {
    auto frame = whole_frames(width, height, 1, length);
    frame.resize(length);
    stream.insert(stream.end(), frame.begin(), frame.end());
  }
  bench.send(stream);
  bench.run_until(7);
  expect(bench, expected_frames(stream, width, height));
  for (int i = 1; i < 7; ++i) {
    EXPECT_EQ(bench.first_words[i] - bench.first_words[i - 1], width * height);
  }
}

TEST(InputOutput, ShortAndLongLines) {
  const int width = 16, height = 4;
  Standard bench;
  bench.configure(width, height);
  for (const double idle : {0., 0.4}) {
    bench.source_idle = bench.sink_idle = idle;
    for (int y = 0; y < height; ++y) {
      for (const int length : {1, 2, 14, 15, 17, 18, 31, 32, 33, 50}) {
        for (const bool ended : {true, false}) {
          SCOPED_TRACE(::testing::Message() << "line " << y << " of " << length << " " << ended);
          std::mt19937 random(y);
          std::vector<Pixel> stream = whole_frames(width, height, 1);
          for (int line = 0; line < height; ++line) {
            const int pixels = line == y ? length : width;
            for (int x = 0; x < pixels; ++x) {
              const bool eol = x == pixels - 1 && (line != y || ended);
              stream.push_back({line == 0 && x == 0, eol, some_value(random)});
            }
          }
          check(bench, stream, width, height);
          if (HasFatalFailure()) return;
        }
      }
    }
  }
}

TEST(InputOutput, MissingEolAtTheVeryEndIsNoFault) {
  Standard bench;
  bench.configure(16, 4);
  auto stream = whole_frames(16, 4, 1);
  stream.back().eol = false;
  ASSERT_FALSE(expected_frames(stream, 16, 4)[0].bad());
  check(bench, stream, 16, 4);
}

TEST(InputOutput, PixelsBeforeTheFirstFrameAndAfterTheLastLine) {
  Standard bench;
  std::mt19937 random(1);
  std::vector<Pixel> noise;
  for (int i = 0; i < 40; ++i) noise.push_back({false, i % 7 == 3, some_value(random)});
  bench.send(noise);
  bench.run(100);
  EXPECT_EQ(bench.read(spec::kRegLongFrames), 0U);
  bench.configure(16, 4);
  auto stream = noise;
  const auto add = [&](const std::vector<Pixel>& more) {
    stream.insert(stream.end(), more.begin(), more.end());
  };
  add(whole_frames(16, 4, 2));
  add(noise);
  add(whole_frames(16, 4, 1));
  add({{false, true, 5}});
  check(bench, stream, 16, 4);
}

TEST(InputOutput, SurplusThatComesLateIsCounted) {
  Standard bench;
  bench.configure(16, 4);
  bench.send(whole_frames(16, 4, 1));
  bench.run_until(1);
  EXPECT_FALSE(bench.frames[0].cut);
  bench.run(100);
  bench.send({{false, false, 1}, {false, true, 2}});
  bench.run(20);
  EXPECT_EQ(bench.read(spec::kRegLongFrames), 1U);
  bench.send(whole_frames(16, 4, 2));
  bench.run_until(3);
  EXPECT_FALSE(bench.frames[1].cut);
  EXPECT_FALSE(bench.frames[2].cut);
}

/// Frames with mistakes of every kind at random places.
std::vector<Pixel> spoiled_frames(int width, int height, int frames, std::mt19937& random) {
  std::vector<Pixel> stream;
  for (int i = 0; i < frames; ++i) {
    append_frame(stream, width, height, random);
    if (i == 0) continue;  // nothing is before it that a pixel could belong to
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

TEST(InputOutput, SpoiledFrames) {
  std::mt19937 random(11);
  Standard bench(4);
  for (int i = 0; i < 150; ++i) {
    SCOPED_TRACE(i);
    const int width = 16 + static_cast<int>(random() % 5),
              height = 1 + static_cast<int>(random() % 5);
    bench.configure(width, height);
    bench.source_idle = random() % 3 == 0 ? 0.3 : 0;
    bench.sink_idle = random() % 3 == 0 ? 0.3 : 0;
    check(bench, spoiled_frames(width, height, 12, random), width, height);
    if (HasFatalFailure()) return;
  }
}

TEST(InputOutput, ManyTinyFramesInFlight) {
  // 130 rows of latency, frames of one row: about 130 at a time.
  Bench<EndsTiny> bench(1, 1);
  bench.configure(16, 1);
  std::mt19937 random(1);
  for (const double idle : {0., 0.3}) {
    bench.source_idle = bench.sink_idle = idle;
    check(bench, spoiled_frames(16, 1, 700, random), 16, 1);
    if (HasFatalFailure()) return;
  }
  EXPECT_GE(bench.most_in_flight, 125);
}

TEST(InputOutput, NoMoreFramesInFlightThanFlagsForThem) {
  // 7 rows of latency, but at most 3 frames: a further one waits.
  Bench<EndsFew> bench(1, 1);
  bench.configure(16, 1);
  std::mt19937 random(1);
  check(bench, spoiled_frames(16, 1, 60, random), 16, 1);
  EXPECT_EQ(bench.most_in_flight, 3);
}

TEST(InputOutput, NewConfigurationBetweenFrames) {
  // Frames back to back, of sizes that change with a request at a random time before.
  std::mt19937 random(5);
  for (int i = 0; i < 40; ++i) {
    SCOPED_TRACE(i);
    Standard bench(i);
    bench.source_idle = i % 2 == 0 ? 0 : 0.2;
    bench.sink_idle = i % 3 == 0 ? 0.2 : 0;
    int width = 16, height = 4;
    bench.configure(width, height);
    const auto applies = bench.applies;
    std::size_t out = 0;
    int begun = 0;
    for (int change = 0; change < 4; ++change) {
      const int frames = 1 + static_cast<int>(random() % 3);
      const auto stream = whole_frames(width, height, frames, random());
      bench.send(stream);
      // The request comes once the last of these frames has begun; all behind it waits.
      begun += frames;
      while (bench.begun < begun) bench.clock();
      bench.run(static_cast<int>(random() % static_cast<unsigned>(width * height)));
      const auto expected = expected_frames(stream, width, height);
      width = 16 + static_cast<int>(random() % 49), height = 1 + static_cast<int>(random() % 6);
      bench.request(width, height);
      if (change % 2 == 0) {
        bench.send(whole_frames(width, height, 1, change));
        ++begun;
      }
      while (bench.pending()) bench.run(1);
      ASSERT_GE(bench.frames.size() + 1, out + expected.size());
      bench.run_until(out + expected.size() + (change % 2 == 0 ? 1 : 0));
      ASSERT_FALSE(HasFailure());
      for (std::size_t k = 0; k < expected.size(); ++k) {
        ASSERT_EQ(bench.frames[out + k].pixels, expected[k].pixels);
        ASSERT_FALSE(bench.frames[out + k].cut);
      }
      if (change % 2 == 0) {
        const auto next = expected_frames(whole_frames(width, height, 1, change), width, height);
        ASSERT_EQ(bench.frames.back().pixels, next[0].pixels);
        ASSERT_FALSE(bench.frames.back().cut);
        ASSERT_EQ(bench.widths.back(), width);
      }
      out = bench.frames.size();
    }
    ASSERT_EQ(bench.applies, applies + 4);
  }
}

TEST(InputOutput, ConfigurationWaitsForTheFrameUnderWay) {
  Standard bench;
  bench.configure(16, 4);
  auto stream = whole_frames(16, 4, 1);
  const std::vector<Pixel> rest(stream.begin() + 40, stream.end());
  stream.resize(40);
  bench.send(stream);
  bench.run(200);
  bench.request(20, 5);
  bench.run(500);
  EXPECT_TRUE(bench.pending());
  EXPECT_EQ(bench.model.width_o, 16);
  bench.send(rest);
  bench.run_until(1);
  expect(bench, expected_frames(whole_frames(16, 4, 1), 16, 4));
  bench.run(40);
  EXPECT_FALSE(bench.pending());
  EXPECT_EQ(bench.model.width_o, 20);
}

TEST(InputOutput, RefusedConfigurationChangesNothing) {
  Standard bench;
  bench.configure(16, 4);
  const auto applies = bench.applies;
  for (const auto& [width, height] : {std::pair{15, 4}, {65, 4}, {16, 0}, {16, 1201}}) {
    bench.write(spec::kRegErrors, 0xFFFFFFFF);
    bench.request(width, height);
    bench.run(2);
    EXPECT_EQ(bench.read(spec::kRegErrors), spec::kErrorsConfig.put(1));
    EXPECT_FALSE(bench.pending());
    const std::size_t first = bench.frames.size();
    const auto stream = whole_frames(16, 4, 3);
    bench.send(stream);
    bench.run_until(first + 3);
    expect(bench, expected_frames(stream, 16, 4), first);
    bench.run(100);
  }
  EXPECT_EQ(bench.applies, applies);
}

TEST(InputOutput, WithdrawnConfigurationChangesNothing) {
  Standard bench;
  bench.configure(16, 4);
  const auto stream = whole_frames(16, 4, 2);
  bench.send(stream);
  bench.run(50);
  bench.request(20, 5);
  bench.run(5);
  EXPECT_TRUE(bench.pending());
  bench.write(spec::kRegWidth, 5000);
  EXPECT_FALSE(bench.pending());
  bench.run_until(2);
  expect(bench, expected_frames(stream, 16, 4));
  bench.run(100);
  EXPECT_EQ(bench.model.width_o, 16);
  // In every clock around the one in which it would take effect: all of the old or all of the new.
  for (int wait = 0; wait < 20; ++wait) {
    bench.configure(16, 4);
    bench.request(20, 5);
    bench.run(wait);
    bench.write(spec::kRegWidth, 33);
    bench.run(40);
    EXPECT_TRUE((bench.model.width_o == 16 && bench.model.height_o == 4) ||
                (bench.model.width_o == 20 && bench.model.height_o == 5));
  }
}

TEST(InputOutput, ResetAtAnyTime) {
  std::mt19937 random(9);
  Standard bench(6);
  for (int i = 0; i < 120; ++i) {
    SCOPED_TRACE(i);
    bench.configure(16 + i % 3, 4);
    bench.source_idle = i % 2 == 0 ? 0 : 0.3;
    bench.sink_idle = i % 4 < 2 ? 0 : 0.3;
    bench.send(spoiled_frames(16 + i % 3, 4, 6, random));
    bench.run(static_cast<int>(random() % 600));
    bench.reset(1 + i % 3);
    bench.frames.clear();
    bench.widths.clear();
    bench.configure(16 + i % 2, 3);
    // The source goes on within a frame: that one is lost, whatever comes behind it is right.
    auto stream = whole_frames(16 + i % 2, 3, 3, i);
    stream.erase(stream.begin(), stream.begin() + 1 + random() % 40);
    check(bench, stream, 16 + i % 2, 3);
    if (HasFatalFailure()) return;
    ASSERT_EQ(bench.frames.size(), 3U);
  }
}

}  // namespace
}  // namespace fpga_stereo::test
