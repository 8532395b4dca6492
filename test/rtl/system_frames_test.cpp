// Frames of the cameras over the link: every stream, against the pipeline in software.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "system_rig.hpp"

namespace fpga_stereo::test {
namespace {

using sim::Pixel;
using sim::RawPair;
using sim::SystemModel;

constexpr std::uint64_t kFirstFrame = std::uint64_t{0xFFFFFFFF} << 32 | kLinkFirstFrame;
constexpr std::int64_t kMs = 100;  // clocks
/// Pixels a clock, so that the line can take all streams of narrow images.
constexpr double kSlow = 0.12;

SystemModel::Flow flow(double camera, double tx = 1, unsigned seed = 1) {
  SystemModel::Flow flow;
  flow.camera = camera;
  flow.tx = tx;
  flow.seed = seed;
  return flow;
}

/// Takes frames of `streams` out of the rig; all are good and as the software makes them.
void expect_good(SystemRig& rig, const std::vector<RawPair>& pairs, const Parameters& p,
                 const StereoRectification& rectification, std::uint32_t streams,
                 std::uint64_t first_id, std::uint32_t configuration) {
  ReferencePipeline pipeline;
  std::map<std::pair<std::uint64_t, Stream>, const Assembled*> got;
  for (const Assembled& frame : rig.frames) {
    EXPECT_EQ(frame.verdict, Verdict::kGood) << frame.text();
    const bool once = got.insert({{frame.frame_id, frame.stream}, &frame}).second;
    EXPECT_TRUE(once) << frame.text();
  }
  std::size_t expected = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Taps& taps = pipeline.process(pairs[i].left, pairs[i].right, rectification, p, 1);
    for (int number = 1; number <= 5; ++number) {
      const auto stream = static_cast<Stream>(number);
      if ((streams & stream_bit(stream)) == 0) continue;
      ++expected;
      const auto found = got.find({first_id + i, stream});
      ASSERT_NE(found, got.end()) << link::name(stream) << " of pair " << i;
      EXPECT_TRUE(
          same(link::name(stream), expected_image(stream, pairs[i], taps), found->second->image));
      EXPECT_EQ(found->second->configuration, configuration);
      EXPECT_EQ(found->second->timestamp, got.at({first_id + i, stream})->timestamp);
    }
  }
  EXPECT_EQ(got.size(), expected);
  rig.frames.clear();
}

TEST(RtlSystemFrames, OfEveryStreamAreThoseOfTheSoftware) {
  SystemRig rig;
  std::uint64_t id = kFirstFrame;
  std::uint32_t configuration = 0;
  unsigned seed = 1;
  // Rows that do and do not fill their last word; one row only; ids past the wrap.
  for (const cv::Size size : {cv::Size(64, 40), cv::Size(33, 25), cv::Size(18, 17), cv::Size(31, 1),
                              cv::Size(16, 9), cv::Size(47, 40)}) {
    SCOPED_TRACE(size);
    const StereoRectification rectification =
        size.height > 20 ? distorted(size, 0.7) : unmoved(size);
    Parameters p = system_parameters();
    p.speckle_size = static_cast<int>(seed * 7 % 40);
    rig.configure(p, rectification);
    rig.write(spec::kRegStreams, kAllStreams);
    const auto pairs = textured(size, 4, ++seed);
    rig.system().set_flow(flow(kSlow, 1, seed));
    for (const RawPair& pair : pairs) rig.system().feed(pair);
    rig.run_until_frames(5 * pairs.size());
    expect_good(rig, pairs, p, rectification, kAllStreams, id, ++configuration);
    id += pairs.size();
    EXPECT_EQ(rig.read(spec::kRegConfiguration), configuration);
  }
  EXPECT_EQ(rig.read(spec::kRegFramesDropped), 0U);
  EXPECT_EQ(rig.counters().lost, 0U);
  EXPECT_EQ(rig.counters().skipped, 0U);
  EXPECT_EQ(rig.frame_counters().refused, 0U);
}

TEST(RtlSystemFrames, AtAPixelPerClock) {
  SystemRig rig;
  const cv::Size size(64, 40);
  const Parameters p = system_parameters();
  rig.configure(p, distorted(size, 0.7));
  const std::uint32_t streams = stream_bit(Stream::kDisparity);
  rig.write(spec::kRegStreams, streams);
  const auto pairs = textured(size, 5, 3);
  for (const RawPair& pair : pairs) rig.system().feed(pair);
  rig.run_until_frames(pairs.size());
  expect_good(rig, pairs, p, distorted(size, 0.7), streams, kFirstFrame, 1);
}

TEST(RtlSystemFrames, TheLineStallsAtRandom) {
  const cv::Size size(61, 30);
  const Parameters p = system_parameters();
  for (unsigned seed = 1; seed < 4; ++seed) {
    SystemRig rig(seed);
    rig.configure(p, distorted(size, 0.7));
    rig.write(spec::kRegStreams, kAllStreams);
    const auto pairs = textured(size, 2, seed);
    rig.system().set_flow(flow(0.07 * seed, 0.25 + 0.2 * seed, seed));
    for (const RawPair& pair : pairs) rig.system().feed(pair);
    // Requests are answered meanwhile.
    for (int i = 0; i < 5; ++i) EXPECT_EQ(rig.read(spec::kRegIdentity), spec::kRegIdentityReset);
    rig.run_until_frames(5 * pairs.size());
    expect_good(rig, pairs, p, distorted(size, 0.7), kAllStreams, kFirstFrame, 1);
  }
}

TEST(RtlSystemFrames, TimeIsThatOfTheMiddleOfTheExposure) {
  SystemRig rig;
  const cv::Size size(40, 20);
  rig.configure(system_parameters(), unmoved(size));
  rig.write(spec::kRegStreams, kAllStreams);
  rig.write(spec::kRegMidExposure, 5000);
  rig.run(1000 * kMs);
  rig.read(spec::kRegIdentity);
  const std::int64_t before = rig.system().microseconds();
  rig.system().feed(textured(size, 1, 1)[0]);
  rig.run_until_frames(5);
  for (const Assembled& frame : rig.frames) {
    EXPECT_NEAR(static_cast<double>(frame.timestamp), static_cast<double>(before) - 5000, 60)
        << frame.text();
  }
}

TEST(RtlSystemFrames, ALineThatIsTooSlowCostsWholeFramesAndIsCounted) {
  SystemRig rig;
  const cv::Size size(64, 32);
  const Parameters p = system_parameters();
  const StereoRectification rectification = unmoved(size);
  rig.configure(p, rectification);
  rig.write(spec::kRegStreams, kAllStreams);
  // Much slower than the cameras, and then not at all for some frames.
  const auto pairs = textured(size, 14, 5);
  rig.system().set_flow(flow(1, 0.3, 2));
  for (std::size_t i = 0; i < 6; ++i) rig.system().feed(pairs[i]);
  rig.run(6 * size.area());
  SystemModel::Flow held = flow(1, 1, 2);
  held.buffer_bytes = 0;
  rig.system().set_flow(held);
  for (std::size_t i = 6; i < 12; ++i) rig.system().feed(pairs[i]);
  rig.run(9 * size.area());
  ASSERT_TRUE(rig.system().idle());
  rig.system().set_flow(flow(kSlow));
  rig.run(size.area());
  // What comes behind is good.
  rig.system().feed(pairs[12]);
  rig.system().feed(pairs[13]);
  const auto last = [&] {
    int good = 0;
    for (const Assembled& f : rig.frames) good += f.frame_id >= kFirstFrame + 12 ? 1 : 0;
    return good == 10;
  };
  rig.run_until(last);
  ReferencePipeline pipeline;
  std::uint32_t flagged = 0, good = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Taps& taps = pipeline.process(pairs[i].left, pairs[i].right, rectification, p, 1);
    for (const Assembled& frame : rig.frames) {
      if (frame.frame_id != kFirstFrame + i) continue;
      if (frame.verdict == Verdict::kGood) {
        ++good;
        EXPECT_TRUE(same(frame.text(), expected_image(frame.stream, pairs[i], taps), frame.image));
      } else {
        ++flagged;
        EXPECT_EQ(frame.verdict, Verdict::kFlagged) << frame.text();
        EXPECT_EQ(frame.flags, kFrameOverrun) << frame.text();
        EXPECT_LT(i, 12U);
      }
    }
  }
  const std::uint32_t missing = 5 * 14 - good - flagged;
  EXPECT_GT(good, 10U);
  EXPECT_GT(flagged, 3U);
  EXPECT_GT(missing, 3U);
  EXPECT_EQ(rig.read(spec::kRegFramesDropped), flagged + missing);
  // A trailer says how many rows were sent.
  std::map<std::pair<std::uint64_t, Stream>, std::uint32_t> rows;
  for (const Received& packet : rig.packets) {
    const auto key = std::make_pair(packet.header.frame_id, packet.header.stream);
    if (packet.header.type == PacketType::kRows) ++rows[key];
    if (packet.header.type == PacketType::kTrailer) {
      EXPECT_EQ(packet.payload.at(0), rows[key]);
    }
  }
  EXPECT_EQ(rig.counters().skipped, 0U);
  rig.write(spec::kRegControl, spec::kControlClear.put(1));
  EXPECT_EQ(rig.read(spec::kRegFramesDropped), 0U);
}

TEST(RtlSystemFrames, TheConfigurationChangesWithTheFramesThatItMakes) {
  SystemRig rig;
  const cv::Size size(48, 24);
  rig.write(spec::kRegStreams, kAllStreams);
  std::vector<RawPair> pairs;
  std::vector<Parameters> made_with;
  const StereoRectification rectification = unmoved(size);
  for (std::uint32_t i = 0; i < 5; ++i) {
    Parameters p = system_parameters();
    p.subpixel = i % 2 == 0;
    p.speckle_size = static_cast<int>(10 * i);
    p.left_right_check = i != 3;
    // Frames of the settings before are still under way.
    rig.configure(p, rectification);
    rig.system().set_flow(flow(kSlow, 1, i));
    for (const RawPair& pair : textured(size, 2, i)) {
      rig.system().feed(pair);
      pairs.push_back(pair);
      made_with.push_back(p);
    }
    rig.run_until([&] { return rig.system().idle(); });
  }
  rig.run_until_frames(5 * pairs.size());
  ReferencePipeline pipeline;
  for (const Assembled& frame : rig.frames) {
    EXPECT_EQ(frame.verdict, Verdict::kGood);
    const std::size_t i = frame.frame_id - kFirstFrame;
    EXPECT_EQ(frame.configuration, i / 2 + 1) << frame.text();
    const Taps& taps =
        pipeline.process(pairs.at(i).left, pairs[i].right, rectification, made_with[i], 1);
    EXPECT_TRUE(same(frame.text(), expected_image(frame.stream, pairs[i], taps), frame.image));
  }
  // One that is refused does not count.
  rig.write(spec::kRegWidth, 65);
  rig.write(spec::kRegControl, spec::kControlApply.put(1));
  EXPECT_EQ(rig.read(spec::kRegConfiguration), 5U);
}

/// The numbers of the pairs of which a stream has come.
std::vector<std::uint64_t> pairs_of(const SystemRig& rig, Stream stream) {
  std::vector<std::uint64_t> numbers;
  for (const Assembled& frame : rig.frames) {
    EXPECT_EQ(frame.verdict, Verdict::kGood) << frame.text();
    if (frame.stream == stream) numbers.push_back(frame.frame_id - kFirstFrame);
  }
  return numbers;
}

TEST(RtlSystemFrames, IntervalsOfPairsAndOfRawImages) {
  using Numbers = std::vector<std::uint64_t>;
  SystemRig rig;
  const cv::Size size(20, 12);
  rig.configure(system_parameters(), unmoved(size));
  rig.write(spec::kRegStreams, kAllStreams);
  rig.write(spec::kRegFrameInterval,
            spec::kFrameIntervalPairs.put(3) | spec::kFrameIntervalRaw.put(2));
  rig.system().set_flow(flow(kSlow));
  const auto pairs = textured(size, 20, 1);
  for (std::size_t i = 0; i < 14; ++i) rig.system().feed(pairs[i]);
  rig.run(14 * 2500);
  EXPECT_EQ(pairs_of(rig, Stream::kDisparity), (Numbers{0, 3, 6, 9, 12}));
  EXPECT_EQ(pairs_of(rig, Stream::kRectifiedRight), (Numbers{0, 3, 6, 9, 12}));
  EXPECT_EQ(pairs_of(rig, Stream::kRawLeft), (Numbers{0, 6, 12}));
  EXPECT_EQ(pairs_of(rig, Stream::kRawRight), (Numbers{0, 6, 12}));
  // Takes effect with the next pair; 0 is as 1.
  rig.frames.clear();
  rig.write(spec::kRegFrameInterval, 0);
  for (std::size_t i = 14; i < 17; ++i) rig.system().feed(pairs[i]);
  rig.run_until_frames(15);
  EXPECT_EQ(pairs_of(rig, Stream::kRawLeft), (Numbers{14, 15, 16}));
  rig.frames.clear();
  rig.write(spec::kRegStreams, stream_bit(Stream::kRectifiedLeft));
  for (std::size_t i = 17; i < 19; ++i) rig.system().feed(pairs[i]);
  rig.run(10000);
  EXPECT_EQ(pairs_of(rig, Stream::kRectifiedLeft), (Numbers{17, 18}));
  EXPECT_EQ(rig.frames.size(), 2U);
}

TEST(RtlSystemFrames, NoFrameBeginsWithoutAHost) {
  SystemRig rig;
  const cv::Size size(20, 12);
  rig.configure(system_parameters(), unmoved(size));
  rig.write(spec::kRegStreams, kAllStreams);
  rig.system().set_flow(flow(kSlow));
  const auto pairs = textured(size, 3, 1);
  rig.system().feed(pairs[0]);
  rig.run_until_frames(5);
  rig.run(2010 * kMs);
  rig.packets.clear();
  rig.system().feed(pairs[1]);
  rig.run(100 * kMs);
  EXPECT_TRUE(rig.packets.empty());
  rig.read(spec::kRegIdentity);
  rig.system().feed(pairs[2]);
  rig.run_until_frames(10);
  EXPECT_EQ(pairs_of(rig, Stream::kDisparity), (std::vector<std::uint64_t>{0, 2}));
}

/// The flags with which the frames of a pair came, by stream; 0 = good.
std::map<Stream, std::uint32_t> flags_of(const SystemRig& rig, std::uint64_t id) {
  std::map<Stream, std::uint32_t> flags;
  for (const Assembled& frame : rig.frames) {
    if (frame.frame_id != id) continue;
    EXPECT_EQ(frame.verdict, frame.flags == 0 ? Verdict::kGood : Verdict::kFlagged) << frame.text();
    flags[frame.stream] = frame.flags;
  }
  return flags;
}

TEST(RtlSystemFrames, BadFramesOfTheCamerasAreFlagged) {
  SystemRig rig;
  const cv::Size size(34, 26);
  rig.configure(system_parameters(), distorted(size, 0.5));
  rig.write(spec::kRegStreams, kAllStreams);
  rig.system().set_flow(flow(kSlow));
  const std::vector<Pixel> good = sim::pixels(textured(size, 1, 9));
  std::vector<Pixel> cut(good.begin(), good.begin() + 34 * 11 + 17), long_line = good;
  long_line.insert(long_line.begin() + 5 * 34 + 10, 8, Pixel{1, 2, false, false});
  // A frame that is cut is filled up as fast as the clock: it may cost rows of the one before.
  rig.system().feed(good);
  rig.run_until_frames(5);
  for (const auto& words : {cut, good, long_line, good}) rig.system().feed(words);
  rig.run_until_frames(25);
  const auto all = [](std::uint32_t flags) {
    std::map<Stream, std::uint32_t> map;
    for (int stream = 1; stream <= 5; ++stream) map[static_cast<Stream>(stream)] = flags;
    return map;
  };
  EXPECT_EQ(flags_of(rig, kFirstFrame), all(0));
  EXPECT_EQ(flags_of(rig, kFirstFrame + 1), all(kFrameCut));
  EXPECT_EQ(flags_of(rig, kFirstFrame + 2), all(0));
  EXPECT_EQ(flags_of(rig, kFirstFrame + 3), all(kFrameLong));
  EXPECT_EQ(flags_of(rig, kFirstFrame + 4), all(0));
  // Too early for the mesh: the raw images are good.
  rig.write(spec::kRegReadStart, spec::kReadStartPixels.put(1));
  rig.write(spec::kRegControl, spec::kControlApply.put(1));
  rig.system().feed(good);
  rig.run_until_frames(30);
  auto expected = all(kFrameBufferError);
  expected[Stream::kRawLeft] = expected[Stream::kRawRight] = 0;
  EXPECT_EQ(flags_of(rig, kFirstFrame + 5), expected);
  EXPECT_EQ(rig.read(spec::kRegFramesDropped), 0U);
}

}  // namespace
}  // namespace fpga_stereo::test
