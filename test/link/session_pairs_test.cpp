// A session whose board takes its pairs from the host; stamps of late frames.
#include <gtest/gtest.h>

#include "link/session.hpp"
#include "link/streaming_rig.hpp"

namespace fpga_stereo::test {
namespace {

using link::Session;
using link::Stream;

constexpr std::uint64_t kStamp = 1600000000000000;  // us

/// Switches the board to pairs of the host. Returns true once it streams.
bool take_pairs(Streaming& rig) {
  link::DesiredState wanted = rig.wanted(SessionRig::setting(5), 5, kDisparity);
  wanted.host_input = true;
  rig.session.set_desired_state(wanted);
  if (!rig.run_until([&] { return rig.streaming(); })) return false;
  rig.run(20);  // until the frames of the former state have arrived
  return rig.streaming();
}

TEST(Session, FramesOfHostPairsCarryTheirIdsAndStamps) {
  Streaming rig;
  ASSERT_TRUE(take_pairs(rig));
  for (std::uint64_t i = 0; i < 6; ++i) {
    ASSERT_TRUE(rig.session.send_pair(rig.pairs[i % 2].left, rig.pairs[i % 2].right, 100 + i,
                                      kStamp + 33333 * i));
    rig.run(5);
  }
  ASSERT_EQ(rig.received.size(), 6U) << "and no frames of the cameras";
  for (std::size_t i = 0; i < 6; ++i) {
    const link::ReceivedFrames& r = rig.received[i];
    EXPECT_EQ(r.set.frame_id, 100 + i);
    EXPECT_EQ(r.set.timestamp, kStamp + 33333 * i);
    EXPECT_TRUE(same("disparity", SessionRig::expected(rig.pairs[i % 2], SessionRig::setting(5)),
                     r.set.image(Stream::kDisparity)));
  }
}

TEST(Session, AnswersRequestsBehindPairsOnASlowLink) {
  Streaming rig;
  ASSERT_TRUE(take_pairs(rig));
  rig.bytes_per_ms = 2;  // a pair takes more than two seconds, longer than all tries of a request
  std::uint64_t sent = 0, refused = 0;
  for (int i = 0; i < 20000; ++i) {
    const bool went = rig.session.send_pair(rig.pairs[0].left, rig.pairs[0].right, sent, kStamp);
    went ? ++sent : ++refused;
    rig.run(1);
  }
  EXPECT_GE(sent, 7U);
  EXPECT_GT(refused, 15000U) << "one at a time";
  EXPECT_GE(rig.received.size() + 2, sent);
  for (std::size_t i = 0; i < rig.received.size(); ++i) {
    EXPECT_EQ(rig.received[i].set.frame_id, i);
  }
  rig.expect_true_frames();
  EXPECT_TRUE(rig.steps.empty());
  EXPECT_EQ(rig.session.counters().retries, 0U);
  EXPECT_TRUE(rig.streaming());
}

TEST(Session, FramesInFlightKeepTheStampsOfTheirSource) {
  Streaming rig;
  rig.want(5);
  ASSERT_TRUE(rig.run_until([&] { return rig.good() > 3; }));
  // Switches from the cameras to the host and back, with frames in flight each time.
  for (std::uint64_t i = 0; i < 5; ++i) {
    ASSERT_TRUE(take_pairs(rig));
    ASSERT_TRUE(rig.session.send_pair(rig.pairs[0].left, rig.pairs[0].right, i, kStamp));
    rig.want(5);
    rig.run(100);
  }
  std::size_t hosts = 0;
  for (const link::ReceivedFrames& r : rig.received) {
    const bool is_hosts = r.set.frame_id < 5 && r.set.timestamp == kStamp;
    hosts += is_hosts ? 1 : 0;
    EXPECT_NEAR(r.stamp, is_hosts ? kStamp * 1e-6 : r.arrived, 0.005) << r.set.frame_id;
  }
  EXPECT_EQ(hosts, 5U);
}

TEST(Session, StampsFramesThatALostLinkCuts) {
  Streaming rig;
  rig.want(1, kAll);
  ASSERT_TRUE(rig.run_until([&] { return rig.good() > 3; }));
  // Only the first stream of a pair arrives.
  rig.to_host = [](SessionRig::Bytes& bytes) {
    bytes.resize(std::min<std::size_t>(bytes.size(), 4000));
  };
  rig.run(25);
  rig.received.clear();
  rig.session.closed();
  const auto left = rig.session.take_received();
  ASSERT_FALSE(left.empty());
  for (const link::ReceivedFrames& r : left) {
    EXPECT_NEAR(r.arrived, rig.host, 0.001);
    EXPECT_NEAR(r.stamp, rig.host, 0.03);
  }
}

}  // namespace
}  // namespace fpga_stereo::test
