// The running node and the simulated gateware behind a link: the disparity equals the software's,
// pixel for pixel. The link is a pseudo terminal, or USB if the launch file has put a board there.
#include <gtest/gtest.h>
#include <stereo_msgs/DisparityImage.h>

#include <cstring>

#include "ros/pty_board.hpp"
#include "ros/rig.hpp"
#include "sim/virtual_board/gateware_board.hpp"

namespace fpga_stereo::test {
namespace {

using stereo_msgs::DisparityImage;

TEST(BoardGateware, MakesTheDisparityOfTheSoftware) {
  std::string line;
  std::unique_ptr<PtyBoard> board;
  if (ros::param::get("~line", line)) {
    auto model = sim::SystemModel::open(FPGA_STEREO_SYSTEM_MODEL);
    ASSERT_TRUE(model) << model.error().message;
    board =
        std::make_unique<PtyBoard>(line, std::make_unique<sim::GatewareBoard>(std::move(*model)));
  }
  Rig rig;
  Listener<DisparityImage> disparity(rig.nh(), "disparity");
  Listener<sensor_msgs::Image> left(rig.nh(), "left/image_rect");
  ASSERT_TRUE(rig.node_listens());
  rig.status_when(
      [](const StereoStatus& s) { return s.board.find("gateware") != std::string::npos; });

  const cv::Size size(64, 40);
  Parameters parameters = window_parameters();
  parameters.disparity_range = 16;
  parameters.speckle_size = 20;
  // The first pair brings the calibration; pairs are refused until the board has it.
  ASSERT_TRUE(eventually(
      [&] {
        rig.publish(synthetic_pair(size, 3, true));
        ros::WallDuration(0.5).sleep();
        return disparity.count() > 0;
      },
      30));
  for (int i = 0; i < 8; ++i) {
    const PairMessages pair = synthetic_pair(size, i + 2, true);
    const auto message = disparity.with_stamp(rig.publish(pair));
    ASSERT_TRUE(message) << rig.status().state_text;
    const cv::Mat1w expected = core_disparity(pair, parameters);
    int different = 0, valid = 0;
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) {
        float value = 0;
        std::memcpy(&value, &message->image.data[y * message->image.step + x * 4], sizeof value);
        const bool none = expected(y, x) == kNoDisparity;
        if (value != (none ? -1.0F : static_cast<float>(expected(y, x) / 32.0))) ++different;
        valid += none ? 0 : 1;
      }
    }
    EXPECT_EQ(different, 0);
    EXPECT_GT(valid, 500);
  }
  const StereoStatus s =
      rig.status_when([](const StereoStatus& status) { return status.verified_frames >= 8; });
  EXPECT_GE(s.verified_frames, 8U);
  EXPECT_EQ(s.verified_pixels_differ, 0U);
  EXPECT_EQ(s.source, "board");
  EXPECT_EQ(s.board_bad_packets, 0U);

  // So far the build has decided about the algorithm. It is not suitable for another.
  rig.reconfigure("stereo_algorithm", "window");
  rig.reconfigure("stereo_algorithm", "sgm");
  rig.publish(synthetic_pair(size, 3, true));
  const StereoStatus unsuitable = rig.status_when(
      [](const StereoStatus& status) { return status.state == StereoStatus::BOARD_UNSUITABLE; });
  EXPECT_EQ(unsuitable.state, StereoStatus::BOARD_UNSUITABLE);
  EXPECT_EQ(unsuitable.state_text,
            "pair dropped: the board cannot make this disparity: stereo_algorithm = sgm: this "
            "gateware is built for window only");
}

}  // namespace
}  // namespace fpga_stereo::test
