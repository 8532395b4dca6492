// Camera frames over the link: compares every stream with the reference pipeline.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "system_rig.hpp"

namespace fpga_stereo::test {
namespace {

using sim::GreyPair;
using sim::Pixel;
using sim::SystemModel;

constexpr std::uint64_t kFirstFrame = std::uint64_t{0xFFFFFFFF} << 32 | kLinkFirstFrame;
constexpr std::int64_t kMs = 100;  // clocks per millisecond
/// Camera pixels per clock at which the line has the bandwidth for all streams.
constexpr double kSlowCamera = 0.12;

SystemModel::Flow make_flow(double camera, double tx = 1, unsigned seed = 1) {
  SystemModel::Flow flow;
  flow.camera = camera;
  flow.tx = tx;
  flow.seed = seed;
  return flow;
}

/// Expects that the rig received exactly the frames of `streams`, all good and equal to those of
/// the reference pipeline, and removes them from the rig.
void expect_good(SystemRig& rig, const std::vector<GreyPair>& pairs, const Parameters& p,
                 const StereoRectification& rectification, std::uint32_t streams,
                 std::uint64_t first_id, std::uint32_t configuration) {
  ReferencePipeline pipeline;
  std::map<std::pair<std::uint64_t, Stream>, const AssembledFrame*> received;
  for (const AssembledFrame& frame : rig.frames) {
    EXPECT_EQ(frame.verdict, Verdict::kGood) << frame.text();
    const bool once = received.insert({{frame.frame_id, frame.stream}, &frame}).second;
    EXPECT_TRUE(once) << frame.text();
  }
  std::size_t expected = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Taps& taps = pipeline.process(pairs[i].left, pairs[i].right, rectification, p, 1);
    for (int number = 1; number <= 5; ++number) {
      const auto stream = static_cast<Stream>(number);
      if ((streams & stream_bit(stream)) == 0) continue;
      ++expected;
      const auto found = received.find({first_id + i, stream});
      ASSERT_NE(found, received.end()) << link::name(stream) << " of pair " << i;
      EXPECT_TRUE(
          same(link::name(stream), expected_image(stream, pairs[i], taps), found->second->image));
      EXPECT_EQ(found->second->configuration, configuration);
      EXPECT_EQ(found->second->timestamp, received.at({first_id + i, stream})->timestamp);
    }
  }
  EXPECT_EQ(received.size(), expected);
  rig.frames.clear();
}

TEST(RtlSystemFrames, EqualSoftwareInEveryStream) {
  SystemRig rig;
  std::uint64_t id = kFirstFrame;
  std::uint32_t configuration = 0;
  unsigned seed = 1;
  // Rows that fill their last word and rows that do not; a single row; ids beyond the wrap.
  for (const cv::Size size : {cv::Size(64, 40), cv::Size(33, 25), cv::Size(18, 17), cv::Size(31, 1),
                              cv::Size(16, 9), cv::Size(47, 40)}) {
    SCOPED_TRACE(size);
    const StereoRectification rectification =
        size.height > 20 ? distorted_rectification(size, 0.7) : identity_rectification(size);
    Parameters p = system_parameters();
    p.speckle_size = static_cast<int>(seed * 7 % 40);
    rig.apply_configuration(p, rectification);
    rig.write(spec::kRegStreams, kAllStreams);
    const auto pairs = textured_pairs(size, 4, ++seed);
    rig.system().set_flow(make_flow(kSlowCamera, 1, seed));
    for (const GreyPair& pair : pairs) rig.system().feed(pair);
    rig.run_until_frames(5 * pairs.size());
    expect_good(rig, pairs, p, rectification, kAllStreams, id, ++configuration);
    id += pairs.size();
    EXPECT_EQ(rig.read(spec::kRegConfiguration), configuration);
  }
  EXPECT_EQ(rig.read(spec::kRegFramesDropped), 0U);
  EXPECT_EQ(rig.counters().lost_packets, 0U);
  EXPECT_EQ(rig.counters().skipped_bytes, 0U);
  EXPECT_EQ(rig.frame_counters().refused_packets, 0U);
}

TEST(RtlSystemFrames, EqualSoftwareAtOnePixelPerClock) {
  SystemRig rig;
  const cv::Size size(64, 40);
  const Parameters p = system_parameters();
  rig.apply_configuration(p, distorted_rectification(size, 0.7));
  const std::uint32_t streams = stream_bit(Stream::kDisparity);
  rig.write(spec::kRegStreams, streams);
  const auto pairs = textured_pairs(size, 5, 3);
  for (const GreyPair& pair : pairs) rig.system().feed(pair);
  rig.run_until_frames(pairs.size());
  expect_good(rig, pairs, p, distorted_rectification(size, 0.7), streams, kFirstFrame, 1);
}

TEST(RtlSystemFrames, EqualSoftwareWhenTheLineStallsAtRandom) {
  const cv::Size size(61, 30);
  const Parameters p = system_parameters();
  for (unsigned seed = 1; seed < 4; ++seed) {
    SystemRig rig(seed);
    rig.apply_configuration(p, distorted_rectification(size, 0.7));
    rig.write(spec::kRegStreams, kAllStreams);
    const auto pairs = textured_pairs(size, 2, seed);
    rig.system().set_flow(make_flow(0.07 * seed, 0.25 + 0.2 * seed, seed));
    for (const GreyPair& pair : pairs) rig.system().feed(pair);
    // The board answers requests meanwhile.
    for (int i = 0; i < 5; ++i) EXPECT_EQ(rig.read(spec::kRegIdentity), spec::kRegIdentityReset);
    rig.run_until_frames(5 * pairs.size());
    expect_good(rig, pairs, p, distorted_rectification(size, 0.7), kAllStreams, kFirstFrame, 1);
  }
}

TEST(RtlSystemFrames, TimestampIsTheMiddleOfTheExposure) {
  SystemRig rig;
  const cv::Size size(40, 20);
  rig.apply_configuration(system_parameters(), identity_rectification(size));
  rig.write(spec::kRegStreams, kAllStreams);
  rig.write(spec::kRegMidExposure, 5000);
  rig.run(1000 * kMs);
  rig.read(spec::kRegIdentity);
  const std::int64_t before = rig.system().microseconds();
  rig.system().feed(textured_pairs(size, 1, 1)[0]);
  rig.run_until_frames(5);
  for (const AssembledFrame& frame : rig.frames) {
    EXPECT_NEAR(static_cast<double>(frame.timestamp), static_cast<double>(before) - 5000, 60)
        << frame.text();
  }
}

TEST(RtlSystemFrames, ASlowLineDropsWholeFramesAndCountsThem) {
  SystemRig rig;
  const cv::Size size(64, 32);
  const Parameters p = system_parameters();
  const StereoRectification rectification = identity_rectification(size);
  rig.apply_configuration(p, rectification);
  rig.write(spec::kRegStreams, kAllStreams);
  // The line is much slower than the cameras, then stalls completely for some frames.
  const auto pairs = textured_pairs(size, 14, 5);
  rig.system().set_flow(make_flow(1, 0.3, 2));
  for (std::size_t i = 0; i < 6; ++i) rig.system().feed(pairs[i]);
  rig.run(6 * size.area());
  SystemModel::Flow stalled = make_flow(1, 1, 2);
  stalled.buffer_bytes = 0;
  rig.system().set_flow(stalled);
  for (std::size_t i = 6; i < 12; ++i) rig.system().feed(pairs[i]);
  rig.run(9 * size.area());
  ASSERT_TRUE(rig.system().is_idle());
  rig.system().set_flow(make_flow(kSlowCamera));
  rig.run(size.area());
  // Frames after the stall are good.
  rig.system().feed(pairs[12]);
  rig.system().feed(pairs[13]);
  const auto has_last_frames = [&] {
    int good = 0;
    for (const AssembledFrame& f : rig.frames) good += f.frame_id >= kFirstFrame + 12 ? 1 : 0;
    return good == 10;
  };
  rig.run_until(has_last_frames);
  ReferencePipeline pipeline;
  std::uint32_t flagged = 0, good = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Taps& taps = pipeline.process(pairs[i].left, pairs[i].right, rectification, p, 1);
    for (const AssembledFrame& frame : rig.frames) {
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
  // Each trailer states the number of rows packets of its frame.
  std::map<std::pair<std::uint64_t, Stream>, std::uint32_t> rows;
  for (const Received& packet : rig.packets) {
    const auto key = std::make_pair(packet.header.frame_id, packet.header.stream);
    if (packet.header.type == PacketType::kRows) ++rows[key];
    if (packet.header.type == PacketType::kTrailer) {
      EXPECT_EQ(packet.payload.at(0), rows[key]);
    }
  }
  EXPECT_EQ(rig.counters().skipped_bytes, 0U);
  rig.write(spec::kRegControl, spec::kControlClear.put(1));
  EXPECT_EQ(rig.read(spec::kRegFramesDropped), 0U);
}

TEST(RtlSystemFrames, CarryTheIdOfTheConfigurationThatMadeThem) {
  SystemRig rig;
  const cv::Size size(48, 24);
  rig.write(spec::kRegStreams, kAllStreams);
  std::vector<GreyPair> pairs;
  std::vector<Parameters> pair_parameters;
  const StereoRectification rectification = identity_rectification(size);
  for (std::uint32_t i = 0; i < 5; ++i) {
    Parameters p = system_parameters();
    p.subpixel = i % 2 == 0;
    p.speckle_size = static_cast<int>(10 * i);
    p.left_right_check = i != 3;
    // Frames of the previous configuration are still in flight.
    rig.apply_configuration(p, rectification);
    rig.system().set_flow(make_flow(kSlowCamera, 1, i));
    for (const GreyPair& pair : textured_pairs(size, 2, i)) {
      rig.system().feed(pair);
      pairs.push_back(pair);
      pair_parameters.push_back(p);
    }
    rig.run_until([&] { return rig.system().is_idle(); });
  }
  rig.run_until_frames(5 * pairs.size());
  ReferencePipeline pipeline;
  for (const AssembledFrame& frame : rig.frames) {
    EXPECT_EQ(frame.verdict, Verdict::kGood);
    const std::size_t i = frame.frame_id - kFirstFrame;
    EXPECT_EQ(frame.configuration, i / 2 + 1) << frame.text();
    const Taps& taps =
        pipeline.process(pairs.at(i).left, pairs[i].right, rectification, pair_parameters[i], 1);
    EXPECT_TRUE(same(frame.text(), expected_image(frame.stream, pairs[i], taps), frame.image));
  }
  // A refused configuration does not change the id.
  rig.write(spec::kRegWidth, 65);
  rig.write(spec::kRegControl, spec::kControlApply.put(1));
  EXPECT_EQ(rig.read(spec::kRegConfiguration), 5U);
}

/// Returns the numbers of the pairs whose frame of this stream was received; all must be good.
std::vector<std::uint64_t> pair_numbers(const SystemRig& rig, Stream stream) {
  std::vector<std::uint64_t> numbers;
  for (const AssembledFrame& frame : rig.frames) {
    EXPECT_EQ(frame.verdict, Verdict::kGood) << frame.text();
    if (frame.stream == stream) numbers.push_back(frame.frame_id - kFirstFrame);
  }
  return numbers;
}

TEST(RtlSystemFrames, FollowTheIntervalsOfPairsAndRawImages) {
  using Numbers = std::vector<std::uint64_t>;
  SystemRig rig;
  const cv::Size size(20, 12);
  rig.apply_configuration(system_parameters(), identity_rectification(size));
  rig.write(spec::kRegStreams, kAllStreams);
  rig.write(spec::kRegFrameInterval,
            spec::kFrameIntervalPairs.put(3) | spec::kFrameIntervalRaw.put(2));
  rig.system().set_flow(make_flow(kSlowCamera));
  const auto pairs = textured_pairs(size, 20, 1);
  for (std::size_t i = 0; i < 14; ++i) rig.system().feed(pairs[i]);
  rig.run(14 * 2500);
  EXPECT_EQ(pair_numbers(rig, Stream::kDisparity), (Numbers{0, 3, 6, 9, 12}));
  EXPECT_EQ(pair_numbers(rig, Stream::kRectifiedRight), (Numbers{0, 3, 6, 9, 12}));
  EXPECT_EQ(pair_numbers(rig, Stream::kRawLeft), (Numbers{0, 6, 12}));
  EXPECT_EQ(pair_numbers(rig, Stream::kRawRight), (Numbers{0, 6, 12}));
  // A new interval takes effect with the next pair; 0 means 1.
  rig.frames.clear();
  rig.write(spec::kRegFrameInterval, 0);
  for (std::size_t i = 14; i < 17; ++i) rig.system().feed(pairs[i]);
  rig.run_until_frames(15);
  EXPECT_EQ(pair_numbers(rig, Stream::kRawLeft), (Numbers{14, 15, 16}));
  rig.frames.clear();
  rig.write(spec::kRegStreams, stream_bit(Stream::kRectifiedLeft));
  for (std::size_t i = 17; i < 19; ++i) rig.system().feed(pairs[i]);
  rig.run(10000);
  EXPECT_EQ(pair_numbers(rig, Stream::kRectifiedLeft), (Numbers{17, 18}));
  EXPECT_EQ(rig.frames.size(), 2U);
}

/// Makes the board send every stream of slow cameras.
void start(SystemRig& rig, const StereoRectification& rectification) {
  rig.apply_configuration(system_parameters(), rectification);
  rig.write(spec::kRegStreams, kAllStreams);
  rig.system().set_flow(make_flow(kSlowCamera));
}

TEST(RtlSystemFrames, BeginOnlyWhileAHostIsHeard) {
  SystemRig rig;
  const cv::Size size(20, 12);
  start(rig, identity_rectification(size));
  const auto pairs = textured_pairs(size, 3, 1);
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
  EXPECT_EQ(pair_numbers(rig, Stream::kDisparity), (std::vector<std::uint64_t>{0, 2}));
}

/// Returns the flags of a pair's frames by stream; 0 means good.
std::map<Stream, std::uint32_t> flags_of(const SystemRig& rig, std::uint64_t id) {
  std::map<Stream, std::uint32_t> flags;
  for (const AssembledFrame& frame : rig.frames) {
    if (frame.frame_id != id) continue;
    EXPECT_EQ(frame.verdict, frame.flags == 0 ? Verdict::kGood : Verdict::kFlagged) << frame.text();
    flags[frame.stream] = frame.flags;
  }
  return flags;
}

/// Returns what flags_of() returns if raw images and results have these flags.
std::map<Stream, std::uint32_t> all_flags(std::uint32_t raw, std::uint32_t results) {
  return {{Stream::kRawLeft, raw},
          {Stream::kRawRight, raw},
          {Stream::kRectifiedLeft, results},
          {Stream::kRectifiedRight, results},
          {Stream::kDisparity, results}};
}

TEST(RtlSystemFrames, AreFlaggedIfTheCameraFrameIsBad) {
  SystemRig rig;
  const cv::Size size(34, 26);
  start(rig, distorted_rectification(size, 0.5));
  const std::vector<Pixel> good = sim::to_pixels(textured_pairs(size, 1, 9));
  std::vector<Pixel> cut(good.begin(), good.begin() + 34 * 11 + 17), long_line = good;
  long_line.insert(long_line.begin() + 5 * 34 + 10, 8, Pixel{1, 2, false, false});
  // Wait first: the board pads a cut frame at one pixel per clock, which may drop rows of the
  // previous frame.
  rig.system().feed(good);
  rig.run_until_frames(5);
  for (const auto& words : {cut, good, long_line, good}) rig.system().feed(words);
  rig.run_until_frames(25);
  EXPECT_EQ(flags_of(rig, kFirstFrame), all_flags(0, 0));
  EXPECT_EQ(flags_of(rig, kFirstFrame + 1), all_flags(kFrameCut, kFrameCut));
  EXPECT_EQ(flags_of(rig, kFirstFrame + 2), all_flags(0, 0));
  EXPECT_EQ(flags_of(rig, kFirstFrame + 3), all_flags(kFrameLong, kFrameLong));
  EXPECT_EQ(flags_of(rig, kFirstFrame + 4), all_flags(0, 0));
  // Reading starts too early for the mesh; the raw images are still good.
  rig.write(spec::kRegReadStart, spec::kReadStartPixels.put(1));
  rig.write(spec::kRegControl, spec::kControlApply.put(1));
  rig.system().feed(good);
  rig.run_until_frames(30);
  EXPECT_EQ(flags_of(rig, kFirstFrame + 5), all_flags(0, kFrameBufferError));
  EXPECT_EQ(rig.read(spec::kRegFramesDropped), 0U);
}

TEST(RtlSystemFrames, AreFlaggedFromAWriteToAMeshToTheApply) {
  SystemRig rig;
  const cv::Size size(34, 26);
  start(rig, distorted_rectification(size, 0.5));
  const auto pairs = textured_pairs(size, 3, 9);
  rig.write(spec::kRegMeshAddress, 0);
  rig.write(spec::kRegMeshData, 0);
  rig.system().feed(pairs[0]);
  rig.run_until_frames(5);
  EXPECT_EQ(flags_of(rig, kFirstFrame), all_flags(0, kFrameBufferError));
  // The upload begins while a frame is in flight, and ends with a refused apply.
  rig.write(spec::kRegControl, spec::kControlApply.put(1));
  rig.system().feed(pairs[1]);
  rig.run(size.area());
  rig.write(spec::kRegMeshData, 0);
  rig.write(spec::kRegWidth, 1);
  rig.write(spec::kRegControl, spec::kControlApply.put(1));
  rig.run_until_frames(10);
  EXPECT_EQ(flags_of(rig, kFirstFrame + 1), all_flags(0, kFrameBufferError));
  rig.write(spec::kRegWidth, static_cast<std::uint32_t>(size.width));
  rig.write(spec::kRegControl, spec::kControlApply.put(1));
  rig.system().feed(pairs[2]);
  rig.run_until_frames(15);
  EXPECT_EQ(flags_of(rig, kFirstFrame + 2), all_flags(0, 0));
}

}  // namespace
}  // namespace fpga_stereo::test
