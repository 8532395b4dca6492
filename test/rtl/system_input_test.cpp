// Raw pairs from the host: the board processes them like camera pairs.
#include <gtest/gtest.h>

#include <functional>

#include "system_rig.hpp"

namespace fpga_stereo::test {
namespace {

using sim::GreyPair;

const cv::Size kSize(37, 22);

/// Tags of a pair that the host sends, and which of its packets are missing or repeated.
struct HostPair {
  std::uint64_t id = 0x1122334455667788, timestamp = 0x99AABBCCDDEEFF00;
  std::function<int(int)> copies = [](int) { return 1; };  // number of times to send row y
  bool leader = true, trailer = true;
};

/// Sends a pair from the host to the board's input.
void send_pair(SystemRig& rig, const GreyPair& pair, const HostPair& host_pair = {}) {
  Header header;
  header.stream = Stream::kInput;
  header.frame_id = host_pair.id;
  header.timestamp = host_pair.timestamp;
  link::Leader leader;
  leader.width = static_cast<std::uint16_t>(pair.left.cols);
  leader.height = static_cast<std::uint16_t>(pair.left.rows);
  leader.format = link::PixelFormat::kGrey;
  header.type = PacketType::kLeader;
  const auto packed = link::pack(leader);
  if (host_pair.leader) rig.send(header, {packed.begin(), packed.end()});
  header.type = PacketType::kRows;
  for (int y = 0; y < pair.left.rows; ++y) {
    cv::Mat both;
    cv::hconcat(pair.left.row(y), pair.right.row(y), both);
    std::vector<std::uint8_t> bytes;
    link::append_row(both, bytes);
    header.index = static_cast<std::uint16_t>(y);
    for (int i = 0; i < host_pair.copies(y); ++i) rig.send(header, bytes);
  }
  header.index = 0;
  header.type = PacketType::kTrailer;
  const auto trailer = link::pack(link::Trailer{});
  if (host_pair.trailer) rig.send(header, {trailer.begin(), trailer.end()});
}

class RtlSystemInput : public ::testing::Test {
 protected:
  void SetUp() override {
    rig_.apply_configuration(parameters_, rectification_);
    rig_.write(spec::kRegStreams, kAllStreams);
    rig_.write(spec::kRegInput, spec::kInputHost.put(1));
  }
  void expect_good(const AssembledFrame& frame, const GreyPair& pair, const HostPair& host_pair) {
    const Taps& taps = pipeline_.process(pair.left, pair.right, rectification_, parameters_, 1);
    EXPECT_EQ(frame.verdict, Verdict::kGood) << frame.text();
    EXPECT_EQ(frame.frame_id, host_pair.id);
    EXPECT_EQ(frame.timestamp, host_pair.timestamp);
    EXPECT_TRUE(same(frame.text(), expected_image(frame.stream, pair, taps), frame.image));
  }

  SystemRig rig_;
  ReferencePipeline pipeline_;
  Parameters parameters_ = system_parameters();
  StereoRectification rectification_ = distorted_rectification(kSize, 0.6);
};

TEST_F(RtlSystemInput, FramesCarryTheIdAndTimeOfTheirPair) {
  const auto pairs = textured_pairs(kSize, 4, 3);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    HostPair host_pair;
    host_pair.id += 3 * i;
    host_pair.timestamp -= i;
    send_pair(rig_, pairs[i], host_pair);
  }
  rig_.run_until_frames(5 * pairs.size());
  for (const AssembledFrame& frame : rig_.frames) {
    const std::size_t i = (frame.frame_id - HostPair{}.id) / 3;
    HostPair host_pair;
    host_pair.id += 3 * i;
    host_pair.timestamp -= i;
    expect_good(frame, pairs.at(i), host_pair);
  }
  EXPECT_EQ(rig_.read(spec::kRegInputErrors), 0U);
  EXPECT_EQ(rig_.read(spec::kRegFramesDropped), 0U);
}

TEST_F(RtlSystemInput, ASlowLineStallsThePipelineAndDropsNothing) {
  const auto pairs = textured_pairs(kSize, 6, 3);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    HostPair host_pair;
    host_pair.id = i;
    send_pair(rig_, pairs[i], host_pair);
  }
  sim::SystemModel::Flow stalled;
  stalled.buffer_bytes = 0;
  rig_.system().set_flow(stalled);
  rig_.run(40000);
  sim::SystemModel::Flow slow;
  slow.tx = 0.15;
  rig_.system().set_flow(slow);
  rig_.run_until_frames(5 * pairs.size());
  for (const AssembledFrame& frame : rig_.frames) {
    HostPair host_pair;
    host_pair.id = frame.frame_id;
    expect_good(frame, pairs.at(host_pair.id), host_pair);
  }
  EXPECT_EQ(rig_.read(spec::kRegFramesDropped), 0U);
}

// A whole pair fits into the FIFO before the pipeline, and the next one waits before that FIFO.
TEST_F(RtlSystemInput, PairsOfOneRowKeepTheirIds) {
  rectification_ = identity_rectification({16, 1});
  rig_.apply_configuration(parameters_, rectification_);
  const auto pairs = textured_pairs({16, 1}, 40, 3);
  sim::SystemModel::Flow slow;
  slow.tx = 0.02;
  rig_.system().set_flow(slow);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    HostPair host_pair;
    host_pair.id = i;
    host_pair.timestamp = 1000 * i;
    send_pair(rig_, pairs[i], host_pair);
  }
  rig_.run(50000);
  rig_.system().set_flow({});
  rig_.run_until_frames(5 * pairs.size());
  for (const AssembledFrame& frame : rig_.frames) {
    HostPair host_pair;
    host_pair.id = frame.frame_id;
    host_pair.timestamp = 1000 * host_pair.id;
    expect_good(frame, pairs.at(host_pair.id), host_pair);
  }
  EXPECT_EQ(rig_.read(spec::kRegFramesDropped), 0U);
}

TEST_F(RtlSystemInput, IgnoresRepeatedRows) {
  const GreyPair pair = textured_pairs(kSize, 1, 4)[0];
  HostPair host_pair;
  host_pair.copies = [](int y) { return y % 5 == 2 ? 2 : 1; };
  send_pair(rig_, pair, host_pair);
  rig_.run_until_frames(5);
  for (const AssembledFrame& frame : rig_.frames) expect_good(frame, pair, host_pair);
  EXPECT_EQ(rig_.read(spec::kRegInputErrors), 0U);
}

// A pair with missing rows is flagged as cut, and the next pair is good.
TEST_F(RtlSystemInput, FlagsPairsWithMissingRowsAsCut) {
  const auto pairs = textured_pairs(kSize, 2, 4);
  std::uint32_t errors = 0;
  const std::vector<std::function<int(int)>> losses{
      [](int y) { return y == 0 ? 0 : 1; }, [](int y) { return y / 3 == 2 ? 0 : 1; },
      [](int y) { return y == kSize.height - 1 ? 0 : 1; }, [](int y) { return y < 4 ? 1 : 0; },
      [](int) { return 0; }};
  for (const bool trailer : {true, false}) {
    for (const auto& copies : losses) {
      HostPair host_pair;
      host_pair.id = 100 + errors;
      host_pair.copies = copies;
      host_pair.trailer = trailer;
      send_pair(rig_, pairs[0], host_pair);
      HostPair good;
      good.id = 1000 + errors;
      send_pair(rig_, pairs[1], good);
      rig_.run_until_frames(10);
      for (const AssembledFrame& frame : rig_.frames) {
        if (frame.frame_id == good.id) {
          expect_good(frame, pairs[1], good);
        } else {
          EXPECT_EQ(frame.frame_id, host_pair.id);
          EXPECT_EQ(frame.flags, kFrameCut) << frame.text();
        }
      }
      rig_.frames.clear();
      EXPECT_EQ(rig_.read(spec::kRegInputErrors), ++errors);
    }
  }
  EXPECT_EQ(rig_.read(spec::kRegFramesDropped), 0U);
}

TEST_F(RtlSystemInput, CountsAMissingTrailer) {
  const auto pairs = textured_pairs(kSize, 2, 4);
  HostPair host_pair;
  host_pair.trailer = false;
  send_pair(rig_, pairs[0], host_pair);
  HostPair next;
  next.id = 1;
  send_pair(rig_, pairs[1], next);
  rig_.run_until_frames(10);
  for (const AssembledFrame& frame : rig_.frames) {
    if (frame.frame_id == host_pair.id) expect_good(frame, pairs[0], host_pair);
    if (frame.frame_id == next.id) expect_good(frame, pairs[1], next);
  }
  EXPECT_EQ(rig_.read(spec::kRegInputErrors), 1U);
}

TEST_F(RtlSystemInput, IgnoresRowsWithoutLeaderAndInvalidLeaders) {
  const auto pairs = textured_pairs(kSize, 1, 4);
  HostPair host_pair;
  host_pair.leader = false;
  send_pair(rig_, pairs[0], host_pair);
  const auto send_leader = [&](int width, int height, std::uint8_t format, Stream stream) {
    Header header;
    header.type = PacketType::kLeader;
    header.stream = stream;
    header.frame_id = 5;
    link::Leader leader;
    leader.width = static_cast<std::uint16_t>(width);
    leader.height = static_cast<std::uint16_t>(height);
    leader.format = static_cast<link::PixelFormat>(format);
    const auto packed = link::pack(leader);
    rig_.send(header, {packed.begin(), packed.end()});
  };
  send_leader(15, 10, kFormatGrey, Stream::kInput);
  send_leader(1281, 10, kFormatGrey, Stream::kInput);
  send_leader(64, 0, kFormatGrey, Stream::kInput);
  send_leader(64, 1201, kFormatGrey, Stream::kInput);
  send_leader(64, 10, kFormatDisparity, Stream::kInput);
  send_leader(37, 22, kFormatGrey, Stream::kRawLeft);
  EXPECT_EQ(rig_.read(spec::kRegFramesIn), 0U);
  EXPECT_TRUE(rig_.frames.empty());
  HostPair good;
  good.id = 6;
  send_pair(rig_, pairs[0], good);
  rig_.run_until_frames(5);
  for (const AssembledFrame& frame : rig_.frames) expect_good(frame, pairs[0], good);
  EXPECT_EQ(rig_.read(spec::kRegInputErrors), 0U);
}

TEST_F(RtlSystemInput, FlagsPairsOfAnotherSizeThanConfigured) {
  send_pair(rig_, textured_pairs({kSize.width, kSize.height - 3}, 1, 1)[0]);
  HostPair good;
  good.id = 1;
  const GreyPair pair = textured_pairs(kSize, 1, 4)[0];
  send_pair(rig_, pair, good);
  rig_.run_until_frames(10);
  for (const AssembledFrame& frame : rig_.frames) {
    if (frame.frame_id == good.id) {
      expect_good(frame, pair, good);
    } else {
      EXPECT_EQ(frame.flags, kFrameCut);
    }
  }
}

TEST_F(RtlSystemInput, SwitchesBetweenCamerasAndHost) {
  const auto pairs = textured_pairs(kSize, 3, 4);
  sim::SystemModel::Flow flow;
  flow.camera = 0.12;
  rig_.system().set_flow(flow);
  // The cameras run all the time; their frames are lost while the host has the input.
  rig_.system().feed(pairs[0]);
  HostPair host_pair;
  send_pair(rig_, pairs[1], host_pair);
  rig_.run_until_frames(5);
  for (const AssembledFrame& frame : rig_.frames) expect_good(frame, pairs[1], host_pair);
  rig_.run_until([&] { return rig_.system().is_idle(); });
  rig_.frames.clear();
  // If the host does not complete a pair, switching to the cameras ends it.
  HostPair open;
  open.id = 9;
  open.copies = [](int y) { return y < 7 ? 1 : 0; };
  open.trailer = false;
  send_pair(rig_, pairs[1], open);
  rig_.write(spec::kRegInput, 0);
  rig_.system().feed(pairs[2]);
  rig_.run_until_frames(10);
  const std::uint64_t first = std::uint64_t{0xFFFFFFFF} << 32 | kLinkFirstFrame;
  for (const AssembledFrame& frame : rig_.frames) {
    if (frame.frame_id == open.id) {
      EXPECT_TRUE(frame.flags & kFrameCut) << frame.text();
      continue;
    }
    EXPECT_EQ(frame.frame_id, first);
    host_pair.id = first;
    host_pair.timestamp = frame.timestamp;
    expect_good(frame, pairs[2], host_pair);
  }
  EXPECT_EQ(rig_.read(spec::kRegInputErrors), 1U);
}

TEST_F(RtlSystemInput, EndsTheFrameOfASilentHost) {
  HostPair host_pair;
  host_pair.copies = [](int y) { return y < 7 ? 1 : 0; };
  host_pair.trailer = false;
  send_pair(rig_, textured_pairs(kSize, 1, 1)[0], host_pair);
  rig_.run(2100 * 100);
  EXPECT_EQ(rig_.read(spec::kRegInputErrors), 1U);
  EXPECT_EQ(rig_.read(spec::kRegCutFrames), 1U);
  EXPECT_EQ(rig_.read(spec::kRegFramesOut), 1U);
}

}  // namespace
}  // namespace fpga_stereo::test
