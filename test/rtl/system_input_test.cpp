// Pairs of images from the host: the board's pipeline runs on them as on the cameras'.
#include <gtest/gtest.h>

#include <functional>

#include "system_rig.hpp"

namespace fpga_stereo::test {
namespace {

using sim::RawPair;

const cv::Size kSize(37, 22);

/// What a host does to a pair that it sends.
struct Sending {
  std::uint64_t id = 0x1122334455667788, timestamp = 0x99AABBCCDDEEFF00;
  std::function<int(int)> copies = [](int) { return 1; };  // of each row
  bool leader = true, trailer = true;
};

void send_pair(SystemRig& rig, const RawPair& pair, const Sending& how = {}) {
  Header header;
  header.stream = Stream::kInput;
  header.frame_id = how.id;
  header.timestamp = how.timestamp;
  link::Leader leader;
  leader.width = static_cast<std::uint16_t>(pair.left.cols);
  leader.height = static_cast<std::uint16_t>(pair.left.rows);
  leader.format = link::PixelFormat::kGrey;
  header.type = PacketType::kLeader;
  const auto packed = link::pack(leader);
  if (how.leader) rig.send(header, {packed.begin(), packed.end()});
  header.type = PacketType::kRows;
  for (int y = 0; y < pair.left.rows; ++y) {
    cv::Mat both;
    cv::hconcat(pair.left.row(y), pair.right.row(y), both);
    std::vector<std::uint8_t> bytes;
    link::append_row(both, bytes);
    header.index = static_cast<std::uint16_t>(y);
    for (int i = 0; i < how.copies(y); ++i) rig.send(header, bytes);
  }
  header.index = 0;
  header.type = PacketType::kTrailer;
  const auto trailer = link::pack(link::Trailer{});
  if (how.trailer) rig.send(header, {trailer.begin(), trailer.end()});
}

class RtlSystemInput : public ::testing::Test {
 protected:
  void SetUp() override {
    rig_.configure(parameters_, rectification_);
    rig_.write(spec::kRegStreams, kAllStreams);
    rig_.write(spec::kRegInput, spec::kInputHost.put(1));
  }
  void expect_good(const Assembled& frame, const RawPair& pair, const Sending& how) {
    const Taps& taps = pipeline_.process(pair.left, pair.right, rectification_, parameters_, 1);
    EXPECT_EQ(frame.verdict, Verdict::kGood) << frame.text();
    EXPECT_EQ(frame.frame_id, how.id);
    EXPECT_EQ(frame.timestamp, how.timestamp);
    EXPECT_TRUE(same(frame.text(), expected_image(frame.stream, pair, taps), frame.image));
  }

  SystemRig rig_;
  ReferencePipeline pipeline_;
  Parameters parameters_ = system_parameters();
  StereoRectification rectification_ = distorted(kSize, 0.6);
};

TEST_F(RtlSystemInput, PairsComeBackWithTheirIdsAndTimes) {
  const auto pairs = textured(kSize, 4, 3);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    Sending how;
    how.id += 3 * i;
    how.timestamp -= i;
    send_pair(rig_, pairs[i], how);
  }
  rig_.run_until_frames(5 * pairs.size());
  for (const Assembled& frame : rig_.frames) {
    const std::size_t i = (frame.frame_id - Sending{}.id) / 3;
    Sending how;
    how.id += 3 * i;
    how.timestamp -= i;
    expect_good(frame, pairs.at(i), how);
  }
  EXPECT_EQ(rig_.read(spec::kRegInputErrors), 0U);
  EXPECT_EQ(rig_.read(spec::kRegFramesDropped), 0U);
}

TEST_F(RtlSystemInput, ASlowLineHoldsThePipelineAndNothingIsDropped) {
  const auto pairs = textured(kSize, 6, 3);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    Sending how;
    how.id = i;
    send_pair(rig_, pairs[i], how);
  }
  sim::SystemModel::Flow held;
  held.buffer_bytes = 0;
  rig_.system().set_flow(held);
  rig_.run(40000);
  sim::SystemModel::Flow slow;
  slow.tx = 0.15;
  rig_.system().set_flow(slow);
  rig_.run_until_frames(5 * pairs.size());
  for (const Assembled& frame : rig_.frames) {
    Sending how;
    how.id = frame.frame_id;
    expect_good(frame, pairs.at(how.id), how);
  }
  EXPECT_EQ(rig_.read(spec::kRegFramesDropped), 0U);
}

// A whole pair fits into the FIFO in front of the pipeline, and the next one into what holds it.
TEST_F(RtlSystemInput, PairsOfOneRowKeepTheirIds) {
  rectification_ = unmoved({16, 1});
  rig_.configure(parameters_, rectification_);
  const auto pairs = textured({16, 1}, 40, 3);
  sim::SystemModel::Flow slow;
  slow.tx = 0.02;
  rig_.system().set_flow(slow);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    Sending how;
    how.id = i;
    how.timestamp = 1000 * i;
    send_pair(rig_, pairs[i], how);
  }
  rig_.run(50000);
  rig_.system().set_flow({});
  rig_.run_until_frames(5 * pairs.size());
  for (const Assembled& frame : rig_.frames) {
    Sending how;
    how.id = frame.frame_id;
    how.timestamp = 1000 * how.id;
    expect_good(frame, pairs.at(how.id), how);
  }
  EXPECT_EQ(rig_.read(spec::kRegFramesDropped), 0U);
}

TEST_F(RtlSystemInput, RowsThatComeTwiceCountOnce) {
  const RawPair pair = textured(kSize, 1, 4)[0];
  Sending how;
  how.copies = [](int y) { return y % 5 == 2 ? 2 : 1; };
  send_pair(rig_, pair, how);
  rig_.run_until_frames(5);
  for (const Assembled& frame : rig_.frames) expect_good(frame, pair, how);
  EXPECT_EQ(rig_.read(spec::kRegInputErrors), 0U);
}

/// What lacks something is flagged as cut, and the next one is good.
TEST_F(RtlSystemInput, RowsThatAreMissingAreCut) {
  const auto pairs = textured(kSize, 2, 4);
  std::uint32_t errors = 0;
  const std::vector<std::function<int(int)>> losses{
      [](int y) { return y == 0 ? 0 : 1; }, [](int y) { return y / 3 == 2 ? 0 : 1; },
      [](int y) { return y == kSize.height - 1 ? 0 : 1; }, [](int y) { return y < 4 ? 1 : 0; },
      [](int) { return 0; }};
  for (const bool trailer : {true, false}) {
    for (const auto& copies : losses) {
      Sending how;
      how.id = 100 + errors;
      how.copies = copies;
      how.trailer = trailer;
      send_pair(rig_, pairs[0], how);
      Sending good;
      good.id = 1000 + errors;
      send_pair(rig_, pairs[1], good);
      rig_.run_until_frames(10);
      for (const Assembled& frame : rig_.frames) {
        if (frame.frame_id == good.id) {
          expect_good(frame, pairs[1], good);
        } else {
          EXPECT_EQ(frame.frame_id, how.id);
          EXPECT_EQ(frame.flags, kFrameCut) << frame.text();
        }
      }
      rig_.frames.clear();
      EXPECT_EQ(rig_.read(spec::kRegInputErrors), ++errors);
    }
  }
  EXPECT_EQ(rig_.read(spec::kRegFramesDropped), 0U);
}

TEST_F(RtlSystemInput, AMissingTrailerAloneIsCounted) {
  const auto pairs = textured(kSize, 2, 4);
  Sending how;
  how.trailer = false;
  send_pair(rig_, pairs[0], how);
  Sending next;
  next.id = 1;
  send_pair(rig_, pairs[1], next);
  rig_.run_until_frames(10);
  for (const Assembled& frame : rig_.frames) {
    if (frame.frame_id == how.id) expect_good(frame, pairs[0], how);
    if (frame.frame_id == next.id) expect_good(frame, pairs[1], next);
  }
  EXPECT_EQ(rig_.read(spec::kRegInputErrors), 1U);
}

TEST_F(RtlSystemInput, RowsOfNoFrameAndImpossibleLeadersAreIgnored) {
  const auto pairs = textured(kSize, 1, 4);
  Sending how;
  how.leader = false;
  send_pair(rig_, pairs[0], how);
  const auto lead = [&](int width, int height, std::uint8_t format, Stream stream) {
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
  lead(15, 10, kFormatGrey, Stream::kInput);
  lead(1281, 10, kFormatGrey, Stream::kInput);
  lead(64, 0, kFormatGrey, Stream::kInput);
  lead(64, 1201, kFormatGrey, Stream::kInput);
  lead(64, 10, kFormatDisparity, Stream::kInput);
  lead(37, 22, kFormatGrey, Stream::kRawLeft);
  EXPECT_EQ(rig_.read(spec::kRegFramesIn), 0U);
  EXPECT_TRUE(rig_.frames.empty());
  Sending good;
  good.id = 6;
  send_pair(rig_, pairs[0], good);
  rig_.run_until_frames(5);
  for (const Assembled& frame : rig_.frames) expect_good(frame, pairs[0], good);
  EXPECT_EQ(rig_.read(spec::kRegInputErrors), 0U);
}

TEST_F(RtlSystemInput, AnotherSizeThanConfiguredIsFlagged) {
  send_pair(rig_, textured({kSize.width, kSize.height - 3}, 1, 1)[0]);
  Sending good;
  good.id = 1;
  const RawPair pair = textured(kSize, 1, 4)[0];
  send_pair(rig_, pair, good);
  rig_.run_until_frames(10);
  for (const Assembled& frame : rig_.frames) {
    if (frame.frame_id == good.id) {
      expect_good(frame, pair, good);
    } else {
      EXPECT_EQ(frame.flags, kFrameCut);
    }
  }
}

TEST_F(RtlSystemInput, CamerasAndHostTakeTurns) {
  const auto pairs = textured(kSize, 3, 4);
  sim::SystemModel::Flow flow;
  flow.camera = 0.12;
  rig_.system().set_flow(flow);
  // The cameras go on all the time; what they send while the host has the input is lost.
  rig_.system().feed(pairs[0]);
  Sending how;
  send_pair(rig_, pairs[1], how);
  rig_.run_until_frames(5);
  for (const Assembled& frame : rig_.frames) expect_good(frame, pairs[1], how);
  rig_.run_until([&] { return rig_.system().idle(); });
  rig_.frames.clear();
  // A pair that the host does not end is ended by the cameras.
  Sending open;
  open.id = 9;
  open.copies = [](int y) { return y < 7 ? 1 : 0; };
  open.trailer = false;
  send_pair(rig_, pairs[1], open);
  rig_.write(spec::kRegInput, 0);
  rig_.system().feed(pairs[2]);
  rig_.run_until_frames(10);
  const std::uint64_t first = std::uint64_t{0xFFFFFFFF} << 32 | kLinkFirstFrame;
  for (const Assembled& frame : rig_.frames) {
    if (frame.frame_id == open.id) {
      EXPECT_TRUE(frame.flags & kFrameCut) << frame.text();
      continue;
    }
    EXPECT_EQ(frame.frame_id, first);
    how.id = first;
    how.timestamp = frame.timestamp;
    expect_good(frame, pairs[2], how);
  }
  EXPECT_EQ(rig_.read(spec::kRegInputErrors), 1U);
}

TEST_F(RtlSystemInput, AHostThatFallsSilentLeavesNoFrameOpen) {
  Sending how;
  how.copies = [](int y) { return y < 7 ? 1 : 0; };
  how.trailer = false;
  send_pair(rig_, textured(kSize, 1, 1)[0], how);
  rig_.run(2100 * 100);
  EXPECT_EQ(rig_.read(spec::kRegInputErrors), 1U);
  EXPECT_EQ(rig_.read(spec::kRegCutFrames), 1U);
  EXPECT_EQ(rig_.read(spec::kRegFramesOut), 1U);
}

}  // namespace
}  // namespace fpga_stereo::test
