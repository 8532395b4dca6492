// The same topics through the software and through a board: the same messages, byte for byte.
#include <gtest/gtest.h>
#include <ros/serialization.h>
#include <sensor_msgs/PointCloud2.h>
#include <stereo_msgs/DisparityImage.h>

#include "ros/pty_board.hpp"
#include "ros/rig.hpp"

namespace fpga_stereo::test {
namespace {

using sensor_msgs::CameraInfo;
using sensor_msgs::Image;
using sensor_msgs::PointCloud2;
using stereo_msgs::DisparityImage;

const cv::Size kSize(160, 120);

/// As it goes over the wire, but for the numbers that publishers count.
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

/// One topic of both nodes.
template <class Message>
class Both {
 public:
  explicit Both(const std::string& topic)
      : topic_(topic), software_(stereo_, topic), board_(of_board_, topic) {}

  /// Both nodes' messages come here.
  bool connected() const { return software_.count() > 0 && board_.count() > 0; }

  void expect_same(const ros::Time& stamp) {
    const auto software = software_.with_stamp(stamp, 3);
    const auto board = board_.with_stamp(stamp, 3);
    ASSERT_TRUE(software) << topic_;
    ASSERT_TRUE(board) << topic_;
    EXPECT_TRUE(bytes(*software) == bytes(*board)) << topic_;
  }

 private:
  ros::NodeHandle stereo_{"stereo"}, of_board_{"board"};
  std::string topic_;
  Listener<Message> software_, board_;
};

TEST(BoardTopics, EveryMessageIsThatOfTheSoftware) {
  std::string line;
  ros::param::get("~line", line);
  PtyBoard board(line, sim::SoftwareBoard::Options{});
  Rig rig;
  ros::NodeHandle board_nh("board");
  Listener<StereoStatus> status(board_nh, "fpga_stereo/status");
  Both<DisparityImage> disparity("disparity");
  Both<PointCloud2> cloud("points2");
  Both<Image> depth("depth"), picture("disparity_color");
  Both<CameraInfo> depth_info("depth/camera_info");
  Both<Image> left_rect("left/image_rect"), right_rect("right/image_rect");
  Both<Image> left_color("left/image_rect_color"), right_color("right/image_rect_color");
  Both<Image> left_mono("left/image_mono"), right_raw_color("right/image_color");
  ASSERT_TRUE(rig.node_listens());
  ASSERT_TRUE(
      eventually([&] { return status.last() && status.last()->board.rfind("none", 0) != 0; }));

  // Another calibration comes with the pair; the software computes until the board has it.
  PairMessages pair = synthetic_pair(kSize, 12, true);
  const std::uint32_t idle = board.peek(spec::kRegFramesOut);
  const auto publish_and_wait = [&] {
    rig.publish(pair);
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
  };
  ASSERT_TRUE(eventually([&] {
    publish_and_wait();
    return board.peek(spec::kRegFramesOut) > idle;
  }));
  // Until nothing of that is under way.
  std::this_thread::sleep_for(std::chrono::seconds(2));
  const auto lost = [&] { return status.last()->frames_in - status.last()->frames_published; };
  const std::uint64_t lost_before = lost();
  const std::uint32_t before = board.peek(spec::kRegFramesOut);
  constexpr int kPairs = 15;
  for (int i = 0; i < kPairs; ++i) {
    pair = synthetic_pair(kSize, 5 + 3 * i, true);
    pair.right.header.frame_id = "somewhere_else";
    const ros::Time stamp = rig.publish(pair);
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
  EXPECT_EQ(board.peek(spec::kRegFramesOut), before + kPairs) << "the board made them";
  ASSERT_TRUE(eventually([&] { return status.last()->verified_frames >= 4; }));
  EXPECT_EQ(status.last()->verified_pixels_differ, 0U);
  EXPECT_EQ(status.last()->source, "board");
  EXPECT_EQ(lost(), lost_before);
  EXPECT_EQ(board.peek(spec::kRegInputErrors), 0U);
  EXPECT_EQ(board.peek(spec::kRegBadPackets), 0U);
  EXPECT_EQ(board.peek(spec::kRegLostPackets), 0U);

  // Unplugged in the middle: the software goes on, nothing is lost.
  board.plug(false);
  for (int i = 0; i < 5; ++i) disparity.expect_same(rig.publish(pair));
  board.plug(true);
  ASSERT_TRUE(eventually([&] {
    publish_and_wait();
    return board.peek(spec::kRegFramesOut) > before + kPairs;
  }));
  disparity.expect_same(rig.publish(pair));
}

}  // namespace
}  // namespace fpga_stereo::test
