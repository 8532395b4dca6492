// Inputs of fpga_stereo/disparity and fpga_stereo/point_cloud2 that image_proc does not make:
// other encodings, disparities of other programs, and damaged messages.
#include <cv_bridge/cv_bridge.h>
#include <gtest/gtest.h>
#include <sensor_msgs/PointCloud2.h>
#include <stereo_msgs/DisparityImage.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <limits>

#include "ros/clouds.hpp"
#include "ros/graph.hpp"
#include "ros/rig.hpp"

namespace fpga_stereo::test {
namespace {

using sensor_msgs::CameraInfo;
using sensor_msgs::Image;
using sensor_msgs::PointCloud2;
using stereo_msgs::DisparityImage;

const cv::Size kSize(160, 120);

/// Returns the pair without what describes the raw images.
PairMessages without_distortion(PairMessages pair) {
  for (CameraInfo* info : {&pair.left_info, &pair.right_info}) {
    info->D.assign(5, 0);
    info->R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    info->K = {300, 0, 80, 0, 300, 60, 0, 0, 1};
  }
  return pair;
}

TEST(DisparityNodelet, SubscribesOnDemandOnly) {
  Rig rig("direct", "image_rect", "disparity");
  EXPECT_TRUE(rig.node_is_unsubscribed());
  EXPECT_EQ(rig.status().state, StereoStatus::IDLE);
  Listener<DisparityImage> disparity(rig.nh(), "disparity");
  EXPECT_TRUE(rig.node_listens());
}

TEST(DisparityNodelet, TakesGreyAndColourImagesAndUsesPAlone) {
  Rig rig("direct", "image_rect", "disparity");
  Listener<DisparityImage> disparity(rig.nh(), "disparity");
  ASSERT_TRUE(rig.node_listens());
  PairMessages pair = synthetic_pair(kSize, 12, true);
  for (CameraInfo* info : {&pair.left_info, &pair.right_info}) {
    info->K = {250, 0, 70, 0, 260, 50, 0, 0, 1};
    info->R = {0, 1, 0, -1, 0, 0, 0, 0, 1};
    info->distortion_model = "equidistant";
  }
  const cv::Mat1w expected = core_disparity(without_distortion(pair), Parameters());
  for (const std::string encoding : {"mono8", "mono16", "bgr8", "rgb8"}) {
    SCOPED_TRACE(encoding);
    PairMessages encoded = pair;
    for (Image* image : {&encoded.left, &encoded.right}) {
      const auto header = image->header;
      *image = *cv_bridge::cvtColor(cv_bridge::toCvCopy(*image), encoding)->toImageMsg();
      image->header = header;
    }
    const auto message = disparity.with_stamp(rig.publish(encoded));
    ASSERT_TRUE(message);
    expect_disparity(*message, expected, 0);
    EXPECT_EQ(message->f, 300);
    EXPECT_FLOAT_EQ(message->T, 0.1F);
  }
}

TEST(DisparityNodelet, SettingsChangeWhileItRuns) {
  Rig rig("direct", "image_rect", "disparity");
  Listener<DisparityImage> disparity(rig.nh(), "disparity");
  ASSERT_TRUE(rig.node_listens());
  rig.reconfigure("min_disparity", "8");
  const PairMessages pair = synthetic_pair(kSize, 12);
  const auto message = disparity.with_stamp(rig.publish(pair));
  ASSERT_TRUE(message);
  Parameters parameters;
  parameters.min_disparity = 8;
  expect_disparity(*message, core_disparity(pair, parameters), 8);
  rig.reconfigure("min_disparity", "0");
}

TEST(DisparityNodelet, NamesWhatIsMissing) {
  Rig rig("direct", "image_rect", "disparity");
  Listener<DisparityImage> disparity(rig.nh(), "disparity");
  ASSERT_TRUE(rig.node_listens());
  const StereoStatus silent = rig.status_when(
      [](const StereoStatus& s) { return s.state == StereoStatus::WAITING_FOR_IMAGES; });
  EXPECT_NE(silent.state_text.find("/direct/left/image_rect"), std::string::npos)
      << silent.state_text;
  PairMessages pair = synthetic_pair(kSize, 12);
  pair.right_info.P = {};
  rig.publish(pair);
  const StereoStatus bad = rig.status_when(
      [](const StereoStatus& s) { return s.state == StereoStatus::BAD_CALIBRATION; });
  EXPECT_NE(bad.state_text.find("right camera_info P[0] = 0"), std::string::npos) << bad.state_text;
}

class CloudOfForeignDisparity : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(eventually([this] {
      return disparity_.getNumSubscribers() > 0 && color_.getNumSubscribers() > 0 &&
             all_links_are_up();
    }));
  }

  static DisparityImage foreign_disparity(float value) {
    DisparityImage message;
    message.header.frame_id = "somewhere";
    message.min_disparity = 0;
    message.max_disparity = 63;
    message.image.encoding = "32FC1";
    message.image.width = 160;
    message.image.height = 120;
    message.image.step = 160 * 4;
    message.image.data.resize(160 * 120 * 4);
    for (std::size_t i = 0; i < 160 * 120; ++i) set(message, i, value);
    return message;
  }
  static void set(DisparityImage& message, std::size_t pixel, float value) {
    std::memcpy(&message.image.data[pixel * 4], &value, sizeof value);
  }

  /// Publishes the disparity with an image and camera_infos that fit, unless `damage` changes them.
  /// Returns its stamp.
  ros::Time publish(DisparityImage disparity,
                    const std::function<void(PairMessages&)>& damage = nullptr) {
    PairMessages pair = synthetic_pair(kSize, 12, true);
    if (damage) damage(pair);
    const ros::Time stamp = rig_.publish(pair);
    pair.left.header.stamp = disparity.header.stamp = stamp;
    color_.publish(pair.left);
    disparity_.publish(disparity);
    return stamp;
  }

  Rig rig_{"direct", "image_rect", "point_cloud2"};
  ros::Publisher disparity_ = rig_.nh().advertise<DisparityImage>("foreign_disparity", 10);
  ros::Publisher color_ = rig_.nh().advertise<Image>("left/image_rect_color", 10);
  Listener<PointCloud2> cloud_{rig_.nh(), "points2"};
};

TEST_F(CloudOfForeignDisparity, HasNoPointWhereThereIsNoDisparity) {
  DisparityImage message = foreign_disparity(12);
  const float infinity = std::numeric_limits<float>::infinity();
  // The markers of stereo_image_proc, depth_image_proc and others; a pixel at min_disparity.
  const std::vector<float> values{-1, 0, std::nanf(""), infinity, -infinity, -17, 0.0625F, 100};
  for (std::size_t i = 0; i < values.size(); ++i) set(message, i, values[i]);
  const auto cloud = cloud_.with_stamp(publish(message));
  ASSERT_TRUE(cloud);
  EXPECT_EQ(cloud->header.frame_id, "somewhere");
  EXPECT_EQ(cloud->width, 160U);
  EXPECT_EQ(cloud->point_step, 32U);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_TRUE(std::isnan(float_at(cloud->data, i * 32 + 8))) << values[i];
  }
  EXPECT_FLOAT_EQ(float_at(cloud->data, 6 * 32 + 8), 300 * 0.1F / 0.0625F);
  EXPECT_FLOAT_EQ(float_at(cloud->data, 7 * 32 + 8), 300 * 0.1F / 100);
  EXPECT_FLOAT_EQ(float_at(cloud->data, 8 * 32 + 8), 300 * 0.1F / 12);

  message.min_disparity = 16;
  const auto nearer = cloud_.with_stamp(publish(message));
  ASSERT_TRUE(nearer);
  EXPECT_TRUE(std::isnan(float_at(nearer->data, 8 * 32 + 8))) << "12 is below the range";
}

TEST_F(CloudOfForeignDisparity, RefusesMessagesThatCannotBeRight) {
  const auto expect_refused = [&](const std::function<void(DisparityImage&)>& damage,
                                  std::uint8_t state, const std::string& words) {
    DisparityImage message = foreign_disparity(12);
    damage(message);
    const StereoStatus before = rig_.status();
    const ros::Time stamp = publish(message);
    const StereoStatus after = rig_.status_when([&](const StereoStatus& s) {
      return s.dropped_encoding + s.dropped_image_size >
             before.dropped_encoding + before.dropped_image_size;
    });
    EXPECT_EQ(after.state, state);
    EXPECT_NE(after.state_text.find(words), std::string::npos) << after.state_text;
    EXPECT_FALSE(cloud_.with_stamp(stamp, 0));
  };
  expect_refused([](DisparityImage& m) { m.image.encoding = "16SC1"; }, StereoStatus::BAD_IMAGE,
                 "disparity image with encoding \"16SC1\", 160x120");
  expect_refused([](DisparityImage& m) { m.image.data.pop_back(); }, StereoStatus::BAD_IMAGE,
                 "the data must have 76800 bytes");
  expect_refused(
      [](DisparityImage& m) {
        m.image.height = 119;
        m.image.data.resize(119 * 640);
      },
      StereoStatus::BAD_IMAGE, "disparity image is 160x119: camera_info says 160x120");
  EXPECT_TRUE(cloud_.with_stamp(publish(foreign_disparity(12))));
  EXPECT_EQ(rig_.status().state, StereoStatus::STREAMING);
}

TEST_F(CloudOfForeignDisparity, RefusesColorAndCameraInfoThatCannotBeRight) {
  const auto expect_refused = [&](const std::function<void(PairMessages&)>& damage,
                                  const std::string& words) {
    const ros::Time stamp = publish(foreign_disparity(12), damage);
    const StereoStatus status = rig_.status_when(
        [&](const StereoStatus& s) { return s.state_text.find(words) != std::string::npos; });
    EXPECT_NE(status.state_text.find(words), std::string::npos) << status.state_text;
    EXPECT_FALSE(cloud_.with_stamp(stamp, 0));
    EXPECT_TRUE(cloud_.with_stamp(publish(foreign_disparity(12))));
  };
  expect_refused(
      [](PairMessages& p) {
        p.left.step = 35791395;  // 120 rows are 104 bytes in 32 bits
        p.left.data.resize(104);
      },
      "left/image_rect_color image with encoding \"mono8\", 160x120, step 35791395, 104 bytes: the "
      "data must have 4294967400 bytes");
  expect_refused([](PairMessages& p) { p.right_info.roi.width = 1U << 31; },
                 "right camera_info roi.width = 2147483648: allowed are 0 to 65535");
}

}  // namespace
}  // namespace fpga_stereo::test
