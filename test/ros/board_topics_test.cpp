// The same topics through the software and through a board give the same messages, byte for byte.
#include <gtest/gtest.h>
#include <ros/serialization.h>
#include <sensor_msgs/PointCloud2.h>
#include <stereo_msgs/DisparityImage.h>

#include "ros/health.hpp"
#include "ros/pty_board.hpp"
#include "ros/rig.hpp"

namespace fpga_stereo::test {
namespace {

using sensor_msgs::CameraInfo;
using sensor_msgs::Image;
using sensor_msgs::PointCloud2;
using stereo_msgs::DisparityImage;

const cv::Size kSize(160, 120);

/// Returns the serialised message without the sequence numbers that publishers count.
std::vector<std::uint8_t> bytes(Image message) {
  message.header.seq = 0;
  const auto all = ros::serialization::serializeMessage(message);
  return {all.buf.get(), all.buf.get() + all.num_bytes};
}
std::vector<std::uint8_t> bytes(DisparityImage message) {
  message.header.seq = message.image.header.seq = 0;
  const auto all = ros::serialization::serializeMessage(message);
  return {all.buf.get(), all.buf.get() + all.num_bytes};
}
template <class Message>
std::vector<std::uint8_t> bytes(Message message) {
  message.header.seq = 0;
  const auto all = ros::serialization::serializeMessage(message);
  return {all.buf.get(), all.buf.get() + all.num_bytes};
}

/// Listens to one topic of both nodes.
template <class Message>
class Both {
 public:
  explicit Both(const std::string& topic)
      : topic_(topic), software_(software_nh_, topic), board_(board_nh_, topic) {}

  void expect_same(const ros::Time& stamp) {
    const auto software = software_.with_stamp(stamp, 3);
    const auto board = board_.with_stamp(stamp, 3);
    ASSERT_TRUE(software) << topic_;
    ASSERT_TRUE(board) << topic_;
    EXPECT_TRUE(bytes(*software) == bytes(*board)) << topic_;
  }

 private:
  ros::NodeHandle software_nh_{"stereo"}, board_nh_{"board"};
  std::string topic_;
  Listener<Message> software_, board_;
};

class BoardTopics : public testing::Test {
 protected:
  static std::string line() {
    std::string path;
    ros::param::get("~line", path);
    return path;
  }
  StereoStatus status() {
    const std::size_t seen = status_.count();
    eventually([&] { return status_.count() >= seen + 2; });
    return *status_.last();
  }
  bool reports_a_board() {
    return eventually(
        [&] { return status_.last() && status_.last()->link_state != StereoStatus::LINK_CLOSED; });
  }
  /// Publishes pairs until the board has made a frame.
  bool board_computes() {
    const std::uint32_t before = board_.peek(spec::kRegFramesOut);
    return eventually([&] {
      rig_.publish(pair_);
      std::this_thread::sleep_for(std::chrono::milliseconds(200));
      return board_.peek(spec::kRegFramesOut) > before;
    });
  }

  PairMessages pair_ = synthetic_pair(kSize, 12, true);
  PtyBoard board_{line(), sim::SoftwareBoard::Options{}};
  Rig rig_;
  ros::NodeHandle board_nh_{"board"};
  Listener<StereoStatus> status_{board_nh_, "fpga_stereo/status"};
};

TEST_F(BoardTopics, EveryMessageEqualsTheSoftwares) {
  Both<DisparityImage> disparity("disparity");
  Both<PointCloud2> cloud("points2");
  Both<Image> depth("depth"), picture("disparity_color");
  Both<CameraInfo> depth_info("depth/camera_info");
  Both<Image> left_rect("left/image_rect"), right_rect("right/image_rect");
  Both<Image> left_color("left/image_rect_color"), right_color("right/image_rect_color");
  Both<Image> left_mono("left/image_mono"), right_raw_color("right/image_color");
  ASSERT_TRUE(rig_.node_listens());
  ASSERT_TRUE(reports_a_board());

  // The pair brings a calibration; the software computes until the board has it.
  ASSERT_TRUE(board_computes());
  // Until no pair is in flight.
  std::this_thread::sleep_for(std::chrono::seconds(2));
  const auto lost = [&] { return status_.last()->frames_in - status_.last()->frames_published; };
  const std::uint64_t lost_before = lost();
  const std::uint32_t before = board_.peek(spec::kRegFramesOut);
  constexpr int kPairs = 15;
  for (int i = 0; i < kPairs; ++i) {
    PairMessages pair = synthetic_pair(kSize, 5 + 3 * i, true);
    pair.right.header.frame_id = "somewhere_else";
    const ros::Time stamp = rig_.publish(pair);
    disparity.expect_same(stamp);
    cloud.expect_same(stamp);
    depth.expect_same(stamp);
    depth_info.expect_same(stamp);
    picture.expect_same(stamp);
    left_rect.expect_same(stamp);
    right_rect.expect_same(stamp);
    left_color.expect_same(stamp);
    right_color.expect_same(stamp);
    left_mono.expect_same(stamp);
    right_raw_color.expect_same(stamp);
  }
  EXPECT_EQ(board_.peek(spec::kRegFramesOut), before + kPairs) << "the board made them";
  ASSERT_TRUE(eventually([&] { return status_.last()->verified_frames >= 4; }));
  EXPECT_EQ(status_.last()->verified_pixels_differ, 0U);
  EXPECT_EQ(status_.last()->source, "board");
  EXPECT_TRUE(eventually([&] { return lost() == lost_before; }, 3)) << lost();
  EXPECT_EQ(board_.peek(spec::kRegInputErrors), 0U);
  EXPECT_EQ(board_.peek(spec::kRegBadPackets), 0U);
  EXPECT_EQ(board_.peek(spec::kRegLostPackets), 0U);

  // While the board is unplugged, the software computes; nothing is lost.
  board_.plug(false);
  for (int i = 0; i < 5; ++i) disparity.expect_same(rig_.publish(pair_));
  board_.plug(true);
  ASSERT_TRUE(board_computes());
  disparity.expect_same(rig_.publish(pair_));
}

TEST_F(BoardTopics, TheSoftwareDoesNotOvertakeASlowBoard) {
  Listener<DisparityImage> disparity(board_nh_, "disparity");
  ASSERT_TRUE(rig_.node_listens());
  ASSERT_TRUE(reports_a_board());
  ASSERT_TRUE(board_computes());
  const auto publish = [&](int pairs) {
    std::vector<ros::Time> stamps;
    for (int i = 0; i < pairs; ++i) {
      stamps.push_back(rig_.publish(pair_));
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    return stamps;
  };
  const StereoStatus before = status();
  board_.hold(true);
  std::vector<ros::Time> stamps = publish(8);
  board_.hold(false);
  EXPECT_TRUE(disparity.with_stamp(stamps[0]));
  EXPECT_FALSE(disparity.with_stamp(stamps[1], 0.1)) << "the link has not taken the first pair yet";
  const StereoStatus after = status();
  EXPECT_EQ(after.dropped_replaced, before.dropped_replaced + 7);
  EXPECT_EQ(after.dropped_stamp, before.dropped_stamp);
  EXPECT_EQ(after.frames_published, before.frames_published + 1);

  // A stall makes the watchdog identify the board again; the software computes unanswered pairs.
  board_.hold(true);
  stamps = publish(1);
  ASSERT_TRUE(
      eventually([&] { return status_.last()->board_recoveries > after.board_recoveries; }));
  board_.hold(false);
  EXPECT_TRUE(disparity.with_stamp(stamps[0]));
  const auto in_flight = [](const StereoStatus& s) {
    std::uint64_t known = s.frames_published;
    for (const DropCauseInfo& cause : kDropCauses) known += s.*cause.field;
    return s.frames_in - known;
  };
  EXPECT_EQ(in_flight(status()), in_flight(after));
}

}  // namespace
}  // namespace fpga_stereo::test
