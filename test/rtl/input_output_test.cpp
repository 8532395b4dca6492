// The two ends of the gateware pipeline (fs_input, fs_output, fs_stream_fifo, with fs_registers and
// fs_signature), with stages between them that only delay: test/rtl/fs_ends.sv.
#include <gtest/gtest.h>

#include <random>
#include <utility>
#include <vector>

#include "Ends.h"
#include "EndsFew.h"
#include "EndsTiny.h"
#include "core/signature.hpp"
#include "rtl/ends.hpp"

namespace fpga_stereo::test::ends {
namespace {

class Standard : public Bench<Ends> {
 public:
  explicit Standard(unsigned seed = 1) : Bench(3, seed) {}
};

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
    if (HasFailure()) return;
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
  if (HasFailure()) return;
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
    if (HasFailure()) return;
    Signature signature;
    for (const std::uint16_t value : bench.frames.back().pixels) signature.add(value);
    bench.run(40);
    EXPECT_EQ(bench.read(spec::kRegSignatureRectify), signature.value());
    EXPECT_EQ(bench.read(spec::kRegSignatureSpeckle), signature.value());
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
  if (HasFailure()) return;
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
  if (HasFailure()) return;
  EXPECT_FALSE(bench.frames[0].bad);
  bench.run(100);
  bench.send({{false, false, 1}, {false, true, 2}});
  bench.run(20);
  EXPECT_EQ(bench.read(spec::kRegLongFrames), 1U);
  bench.send(whole_frames(16, 4, 2));
  bench.run_until(3);
  if (HasFailure()) return;
  EXPECT_FALSE(bench.frames[1].bad);
  EXPECT_FALSE(bench.frames[2].bad);
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
    check(bench, spoiled_frames(16, 1, 900, random, 40), 16, 1);
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
      for (int n = 0; bench.begun < begun && n < 20000; ++n) bench.run(1);
      ASSERT_EQ(bench.begun, begun);
      bench.run(static_cast<int>(random() % static_cast<unsigned>(width * height)));
      const auto expected = expected_frames(stream, width, height);
      width = 16 + static_cast<int>(random() % 49), height = 1 + static_cast<int>(random() % 6);
      bench.request(width, height);
      if (change % 2 == 0) {
        bench.send(whole_frames(width, height, 1, change));
        ++begun;
      }
      for (int n = 0; bench.pending() && n < 20000; ++n) bench.run(1);
      ASSERT_FALSE(bench.pending());
      ASSERT_GE(bench.frames.size() + 1, out + expected.size());
      bench.run_until(out + expected.size() + (change % 2 == 0 ? 1 : 0));
      ASSERT_FALSE(HasFailure());
      for (std::size_t k = 0; k < expected.size(); ++k) {
        ASSERT_EQ(bench.frames[out + k].pixels, expected[k].pixels);
        ASSERT_FALSE(bench.frames[out + k].bad);
      }
      if (change % 2 == 0) {
        const auto next = expected_frames(whole_frames(width, height, 1, change), width, height);
        ASSERT_EQ(bench.frames.back().pixels, next[0].pixels);
        ASSERT_FALSE(bench.frames.back().bad);
        ASSERT_EQ(bench.frames.back().width, width);
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
  if (HasFailure()) return;
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
    if (HasFailure()) return;
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
  if (HasFailure()) return;
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
}  // namespace fpga_stereo::test::ends
