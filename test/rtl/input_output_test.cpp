// Input and output of the gateware pipeline (fs_input, fs_output, fs_stream_fifo, fs_registers and
// fs_signature) with delays in place of the stages: test/rtl/input_output.sv.
#include <gtest/gtest.h>

#include <random>
#include <utility>
#include <vector>

#include "InputOutput.h"
#include "InputOutputDeep.h"
#include "InputOutputFew.h"
#include "core/signature.hpp"
#include "rtl/input_output_rig.hpp"

namespace fpga_stereo::test::input_output {
namespace {

constexpr int kGapRows = 2;  // input_output.sv

class StandardRig : public InputOutputRig<InputOutput> {
 public:
  explicit StandardRig(unsigned seed = 1) : InputOutputRig(kGapRows, seed) {}
};

TEST(InputOutput, PassesCompleteFramesInOrder) {
  const double idles[] = {0, 0.3, 0.9};
  StandardRig rig(2);
  for (const auto& [width, height] :
       {std::pair{16, 1}, {16, 2}, {17, 3}, {16, 4}, {23, 7}, {64, 9}}) {
    rig.apply_size(width, height);
    for (const double source_idle : idles) {
      for (const double sink_idle : idles) {
        SCOPED_TRACE(::testing::Message() << width << " x " << height << ", idle " << source_idle
                                          << " and " << sink_idle);
        rig.source_idle = source_idle;
        rig.sink_idle = sink_idle;
        send_and_check(rig, complete_frames(width, height, 5), width, height);
        if (HasFatalFailure()) return;
      }
    }
  }
}

TEST(InputOutput, AcceptsGapsOfAnyLength) {
  StandardRig rig(3);
  rig.apply_size(16, 4);
  std::mt19937 random(3);
  for (int i = 0; i < 60; ++i) {
    auto stream = complete_frames(16, 4, 4, i);
    for (Pixel& p : stream) {
      if (p.sof || random() % 40 == 0) p.idle_clocks = static_cast<int>(random() % 300);
    }
    send_and_check(rig, stream, 16, 4);
    if (HasFatalFailure()) return;
  }
}

TEST(InputOutput, PassesOnePixelPerClockWithTheGapBetweenFrames) {
  StandardRig rig;
  for (const auto& [width, height] : {std::pair{16, 3}, {31, 4}, {64, 11}, {16, 1}, {20, 2}}) {
    SCOPED_TRACE(::testing::Message() << width << " x " << height);
    rig.apply_size(width, height);
    const std::size_t first = rig.frames.size();
    const auto stream = complete_frames(width, height, 9);
    rig.send(stream);
    rig.run_until(first + 9);
    if (HasFailure()) return;
    expect_equal(rig, expected_frames(stream, width, height), first);
    if (HasFailure()) return;
    for (std::size_t i = first + 1; i < first + 9; ++i) {
      EXPECT_EQ(rig.first_words[i] - rig.first_words[i - 1], width * (height + kGapRows));
    }
  }
}

TEST(InputOutput, FlushesTheLastFrameThenStops) {
  StandardRig rig;
  rig.apply_size(16, 5);
  const auto stream = complete_frames(16, 5, 2);
  rig.send(stream);
  rig.run_until(2);
  if (HasFailure()) return;
  expect_equal(rig, expected_frames(stream, 16, 5));
  EXPECT_FALSE(rig.is_busy());
  rig.run(40);  // completes the row of bubbles
  const auto ticks = rig.ticks;
  rig.run(1000);
  EXPECT_EQ(rig.ticks, ticks);
  // input_output.sv delays by 7 rows and 7 ticks, and the last row of bubbles is completed.
  EXPECT_EQ(rig.ticks, 16 * (2 * 5 + kGapRows + 8));
}

TEST(InputOutput, UpdatesSignaturesOnceThePipelineIsIdle) {
  StandardRig rig;
  rig.apply_size(16, 5);
  for (int i = 0; i < 3; ++i) {
    const auto stream = complete_frames(16, 5, 2, i);
    rig.send(stream);
    rig.run_until(2 * (i + 1));
    if (HasFailure()) return;
    Signature signature;
    for (const std::uint16_t value : rig.frames.back().pixels) signature.add(value);
    rig.run(40);
    EXPECT_EQ(rig.read(spec::kRegSignatureRectify), signature.value());
    EXPECT_EQ(rig.read(spec::kRegSignatureSpeckle), signature.value());
  }
}

TEST(InputOutput, PadsFramesCutAtAnyPixel) {
  const int width = 16, height = 4;
  StandardRig rig;
  rig.apply_size(width, height);
  for (const double idle : {0., 0.4}) {
    rig.source_idle = rig.sink_idle = idle;
    for (int length = 1; length < width * height; ++length) {
      SCOPED_TRACE(length);
      auto stream = complete_frames(width, height, 2);
      stream.resize(width * height + length);
      send_and_check(rig, stream, width, height);
      if (HasFatalFailure()) return;
    }
  }
}

TEST(InputOutput, PadsOnePixelPerClock) {
  const int width = 16, height = 4;
  StandardRig rig;
  rig.apply_size(width, height);
  std::vector<Pixel> stream;
  for (const int length : {64, 1, 20, 64, 16, 63, 64}) {
    auto frame = complete_frames(width, height, 1, length);
    frame.resize(length);
    stream.insert(stream.end(), frame.begin(), frame.end());
  }
  rig.send(stream);
  rig.run_until(7);
  if (HasFailure()) return;
  expect_equal(rig, expected_frames(stream, width, height));
  for (int i = 1; i < 7; ++i) {
    EXPECT_EQ(rig.first_words[i] - rig.first_words[i - 1], width * (height + kGapRows));
  }
}

TEST(InputOutput, FlagsShortAndLongLines) {
  const int width = 16, height = 4;
  StandardRig rig;
  rig.apply_size(width, height);
  for (const double idle : {0., 0.4}) {
    rig.source_idle = rig.sink_idle = idle;
    for (int y = 0; y < height; ++y) {
      for (const int length : {1, 2, 14, 15, 17, 18, 31, 32, 33, 50}) {
        for (const bool has_eol : {true, false}) {
          SCOPED_TRACE(::testing::Message() << "line " << y << " has " << length << " pixels and "
                                            << (has_eol ? "an eol" : "no eol"));
          std::mt19937 random(y);
          std::vector<Pixel> stream = complete_frames(width, height, 1);
          for (int line = 0; line < height; ++line) {
            const int pixels = line == y ? length : width;
            for (int x = 0; x < pixels; ++x) {
              const bool eol = x == pixels - 1 && (line != y || has_eol);
              stream.push_back({line == 0 && x == 0, eol, random_value(random)});
            }
          }
          send_and_check(rig, stream, width, height);
          if (HasFatalFailure()) return;
        }
      }
    }
  }
}

TEST(InputOutput, AcceptsALastPixelWithoutEol) {
  StandardRig rig;
  rig.apply_size(16, 4);
  auto stream = complete_frames(16, 4, 1);
  stream.back().eol = false;
  ASSERT_FALSE(expected_frames(stream, 16, 4)[0].is_bad());
  send_and_check(rig, stream, 16, 4);
}

TEST(InputOutput, DropsPixelsBeforeTheFirstFrameAndAfterTheLastLine) {
  StandardRig rig;
  std::mt19937 random(1);
  std::vector<Pixel> noise;
  for (int i = 0; i < 40; ++i) noise.push_back({false, i % 7 == 3, random_value(random)});
  rig.send(noise);
  rig.run(100);
  EXPECT_EQ(rig.read(spec::kRegLongFrames), 0U);
  rig.apply_size(16, 4);
  auto stream = noise;
  const auto add = [&](const std::vector<Pixel>& more) {
    stream.insert(stream.end(), more.begin(), more.end());
  };
  add(complete_frames(16, 4, 2));
  add(noise);
  add(complete_frames(16, 4, 1));
  add({{false, true, 5}});
  send_and_check(rig, stream, 16, 4);
}

TEST(InputOutput, CountsSurplusPixelsAfterTheFrameIsOut) {
  StandardRig rig;
  rig.apply_size(16, 4);
  rig.send(complete_frames(16, 4, 1));
  rig.run_until(1);
  if (HasFailure()) return;
  EXPECT_FALSE(rig.frames[0].is_bad);
  rig.run(100);
  rig.send({{false, false, 1}, {false, true, 2}});
  rig.run(20);
  EXPECT_EQ(rig.read(spec::kRegLongFrames), 1U);
  rig.send(complete_frames(16, 4, 2));
  rig.run_until(3);
  if (HasFailure()) return;
  EXPECT_FALSE(rig.frames[1].is_bad);
  EXPECT_FALSE(rig.frames[2].is_bad);
}

TEST(InputOutput, HandlesRandomFaults) {
  std::mt19937 random(11);
  StandardRig rig(4);
  for (int i = 0; i < 150; ++i) {
    SCOPED_TRACE(i);
    const int width = 16 + static_cast<int>(random() % 5),
              height = 1 + static_cast<int>(random() % 5);
    rig.apply_size(width, height);
    rig.source_idle = random() % 3 == 0 ? 0.3 : 0;
    rig.sink_idle = random() % 3 == 0 ? 0.3 : 0;
    send_and_check(rig, faulty_frames(width, height, 12, random), width, height);
    if (HasFatalFailure()) return;
  }
}

TEST(InputOutput, Holds130TinyFramesInFlight) {
  // The latency is 130 rows and a frame has one row, so about 130 frames are in flight.
  InputOutputRig<InputOutputDeep> rig(0, 1);
  rig.apply_size(16, 1);
  std::mt19937 random(1);
  for (const double idle : {0., 0.3}) {
    rig.source_idle = rig.sink_idle = idle;
    send_and_check(rig, faulty_frames(16, 1, 900, random, 40), 16, 1);
    if (HasFatalFailure()) return;
  }
  EXPECT_GE(rig.max_in_flight, 125);
}

TEST(InputOutput, LimitsFramesInFlightToTheFlagsItStores) {
  // The latency is 7 rows, but only 3 frames may be in flight: a fourth one waits.
  InputOutputRig<InputOutputFew> rig(0, 1);
  rig.apply_size(16, 1);
  std::mt19937 random(1);
  send_and_check(rig, faulty_frames(16, 1, 60, random), 16, 1);
  EXPECT_EQ(rig.max_in_flight, 3);
}

TEST(InputOutput, AppliesConfigurationsBetweenFrames) {
  // Sends frames back to back and requests a new size at a random time before each change.
  std::mt19937 random(5);
  for (int i = 0; i < 40; ++i) {
    SCOPED_TRACE(i);
    StandardRig rig(i);
    rig.source_idle = i % 2 == 0 ? 0 : 0.2;
    rig.sink_idle = i % 3 == 0 ? 0.2 : 0;
    int width = 16, height = 4;
    rig.apply_size(width, height);
    const auto applies = rig.applies;
    std::size_t out = 0;
    int begun = 0;
    for (int change = 0; change < 4; ++change) {
      const int frames = 1 + static_cast<int>(random() % 3);
      const auto stream = complete_frames(width, height, frames, random());
      rig.send(stream);
      // The request comes after the last of these frames has begun; later frames wait for it.
      begun += frames;
      for (int n = 0; rig.frames_begun < begun && n < 20000; ++n) rig.run(1);
      ASSERT_EQ(rig.frames_begun, begun);
      rig.run(static_cast<int>(random() % static_cast<unsigned>(width * height)));
      const auto expected = expected_frames(stream, width, height);
      width = 16 + static_cast<int>(random() % 49), height = 1 + static_cast<int>(random() % 6);
      rig.request_size(width, height);
      if (change % 2 == 0) {
        rig.send(complete_frames(width, height, 1, change));
        ++begun;
      }
      for (int n = 0; rig.is_pending() && n < 20000; ++n) rig.run(1);
      ASSERT_FALSE(rig.is_pending());
      ASSERT_GE(rig.frames.size() + 1, out + expected.size());
      rig.run_until(out + expected.size() + (change % 2 == 0 ? 1 : 0));
      ASSERT_FALSE(HasFailure());
      for (std::size_t k = 0; k < expected.size(); ++k) {
        ASSERT_EQ(rig.frames[out + k].pixels, expected[k].pixels);
        ASSERT_FALSE(rig.frames[out + k].is_bad);
      }
      if (change % 2 == 0) {
        const auto next = expected_frames(complete_frames(width, height, 1, change), width, height);
        ASSERT_EQ(rig.frames.back().pixels, next[0].pixels);
        ASSERT_FALSE(rig.frames.back().is_bad);
        ASSERT_EQ(rig.frames.back().width, width);
      }
      out = rig.frames.size();
    }
    ASSERT_EQ(rig.applies, applies + 4);
  }
}

TEST(InputOutput, AppliesAConfigurationAfterTheFrameInFlight) {
  StandardRig rig;
  rig.apply_size(16, 4);
  auto stream = complete_frames(16, 4, 1);
  const std::vector<Pixel> rest(stream.begin() + 40, stream.end());
  stream.resize(40);
  rig.send(stream);
  rig.run(200);
  rig.request_size(20, 5);
  rig.run(500);
  EXPECT_TRUE(rig.is_pending());
  EXPECT_EQ(rig.model.width_o, 16);
  rig.send(rest);
  rig.run_until(1);
  if (HasFailure()) return;
  expect_equal(rig, expected_frames(complete_frames(16, 4, 1), 16, 4));
  rig.run(40);
  EXPECT_FALSE(rig.is_pending());
  EXPECT_EQ(rig.model.width_o, 20);
}

TEST(InputOutput, IgnoresARefusedConfiguration) {
  StandardRig rig;
  rig.apply_size(16, 4);
  const auto applies = rig.applies;
  for (const auto& [width, height] : {std::pair{15, 4}, {65, 4}, {16, 0}, {16, 1201}}) {
    rig.write(spec::kRegErrors, 0xFFFFFFFF);
    rig.request_size(width, height);
    rig.run(2);
    EXPECT_EQ(rig.read(spec::kRegErrors), spec::kErrorsConfig.put(1));
    EXPECT_FALSE(rig.is_pending());
    const std::size_t first = rig.frames.size();
    const auto stream = complete_frames(16, 4, 3);
    rig.send(stream);
    rig.run_until(first + 3);
    if (HasFailure()) return;
    expect_equal(rig, expected_frames(stream, 16, 4), first);
    rig.run(100);
  }
  EXPECT_EQ(rig.applies, applies);
}

TEST(InputOutput, IgnoresAWithdrawnConfiguration) {
  StandardRig rig;
  rig.apply_size(16, 4);
  const auto stream = complete_frames(16, 4, 2);
  rig.send(stream);
  rig.run(50);
  rig.request_size(20, 5);
  rig.run(5);
  EXPECT_TRUE(rig.is_pending());
  rig.write(spec::kRegWidth, 5000);
  EXPECT_FALSE(rig.is_pending());
  rig.run_until(2);
  if (HasFailure()) return;
  expect_equal(rig, expected_frames(stream, 16, 4));
  rig.run(100);
  EXPECT_EQ(rig.model.width_o, 16);
  // Withdraws in every clock around the one that applies: the size is entirely old or entirely new.
  for (int wait = 0; wait < 20; ++wait) {
    rig.apply_size(16, 4);
    rig.request_size(20, 5);
    rig.run(wait);
    rig.write(spec::kRegWidth, 33);
    rig.run(40);
    EXPECT_TRUE((rig.model.width_o == 16 && rig.model.height_o == 4) ||
                (rig.model.width_o == 20 && rig.model.height_o == 5));
  }
}

TEST(InputOutput, RecoversFromAResetAtAnyTime) {
  std::mt19937 random(9);
  StandardRig rig(6);
  for (int i = 0; i < 120; ++i) {
    SCOPED_TRACE(i);
    rig.apply_size(16 + i % 3, 4);
    rig.source_idle = i % 2 == 0 ? 0 : 0.3;
    rig.sink_idle = i % 4 < 2 ? 0 : 0.3;
    rig.send(faulty_frames(16 + i % 3, 4, 6, random));
    rig.run(static_cast<int>(random() % 600));
    rig.reset(1 + i % 3);
    rig.frames.clear();
    rig.apply_size(16 + i % 2, 3);
    // The source continues in the middle of a frame: that frame is lost, all later ones are intact.
    auto stream = complete_frames(16 + i % 2, 3, 3, i);
    stream.erase(stream.begin(), stream.begin() + 1 + random() % 40);
    send_and_check(rig, stream, 16 + i % 2, 3);
    if (HasFatalFailure()) return;
    ASSERT_EQ(rig.frames.size(), 3U);
  }
}

}  // namespace
}  // namespace fpga_stereo::test::input_output
