// The outputs of the running node for good pairs.
#include <cv_bridge/cv_bridge.h>
#include <gtest/gtest.h>
#include <sensor_msgs/PointCloud2.h>
#include <stereo_msgs/DisparityImage.h>

#include <cmath>
#include <cstring>

#include "core/stages.hpp"
#include "ros/clouds.hpp"
#include "ros/rig.hpp"

namespace fpga_stereo::test {
namespace {

using sensor_msgs::CameraInfo;
using sensor_msgs::Image;
using sensor_msgs::PointCloud2;
using stereo_msgs::DisparityImage;

const cv::Size kSize(160, 120);

TEST(Outputs, AllShareTheStampAndTheFrameOfTheLeftImage) {
  Rig rig;
  Listener<DisparityImage> disparity(rig.nh(), "disparity");
  Listener<PointCloud2> cloud(rig.nh(), "points2");
  Listener<Image> left(rig.nh(), "left/image_rect"), right(rig.nh(), "right/image_rect");
  Listener<Image> left_color(rig.nh(), "left/image_rect_color");
  Listener<Image> right_color(rig.nh(), "right/image_rect_color");
  Listener<Image> depth(rig.nh(), "depth"), picture(rig.nh(), "disparity_color");
  Listener<CameraInfo> depth_info(rig.nh(), "depth/camera_info");
  ASSERT_TRUE(rig.node_listens());
  PairMessages pair = synthetic_pair(kSize, 12, true);
  pair.right.header.frame_id = "somewhere_else";
  const ros::Time stamp = rig.publish(pair);

  const auto d = disparity.with_stamp(stamp);
  ASSERT_TRUE(d);
  EXPECT_EQ(d->header.frame_id, "stereo_left_optical_frame");
  EXPECT_EQ(d->image.header.stamp, stamp);
  EXPECT_EQ(d->image.header.frame_id, "stereo_left_optical_frame");
  const auto c = cloud.with_stamp(stamp);
  ASSERT_TRUE(c);
  EXPECT_EQ(c->header.frame_id, "stereo_left_optical_frame");
  for (const auto* listener : {&left, &right, &left_color, &right_color, &depth, &picture}) {
    const auto image = listener->with_stamp(stamp);
    ASSERT_TRUE(image);
    EXPECT_EQ(image->width, 160U);
    EXPECT_EQ(image->height, 120U);
    EXPECT_EQ(image->header.frame_id, listener == &right || listener == &right_color
                                          ? "somewhere_else"
                                          : "stereo_left_optical_frame");
  }
  EXPECT_EQ(left.last()->encoding, "mono8");
  EXPECT_EQ(left_color.last()->encoding, "mono8") << "a grey camera stays grey";
  EXPECT_EQ(depth.last()->encoding, "32FC1");
  EXPECT_EQ(picture.last()->encoding, "bgr8");
  const auto info = depth_info.with_stamp(stamp);
  ASSERT_TRUE(info);
  EXPECT_EQ(info->P[0], 300);
  EXPECT_EQ(info->P[3], 0);
}

TEST(Outputs, DisparityEqualsCorePixelForPixel) {
  Rig rig;
  Listener<DisparityImage> disparity(rig.nh(), "disparity");
  ASSERT_TRUE(rig.node_listens());
  const PairMessages pair = synthetic_pair(kSize, 12, true);
  const auto message = disparity.with_stamp(rig.publish(pair));
  ASSERT_TRUE(message);
  const cv::Mat1w expected = core_disparity(pair, Parameters());
  EXPECT_GT(cv::countNonZero(expected != kNoDisparity), 160 * 120 / 3)
      << "enough valid pixels for a meaningful test";
  expect_disparity(*message, expected, 0);
  EXPECT_FLOAT_EQ(message->f, 300);
  EXPECT_FLOAT_EQ(message->T, 0.1F);
  EXPECT_EQ(message->min_disparity, 0);
  EXPECT_EQ(message->max_disparity, 63);
  EXPECT_EQ(message->delta_d, 1.0F / 32);
}

TEST(Outputs, EveryAlgorithmEqualsCorePixelForPixel) {
  Rig rig;
  Listener<DisparityImage> disparity(rig.nh(), "disparity");
  ASSERT_TRUE(rig.node_listens());
  const PairMessages pair = synthetic_pair(kSize, 12, true);
  std::vector<cv::Mat1w> results;
  for (const StereoAlgorithm algorithm : {StereoAlgorithm::kWindow, StereoAlgorithm::kSgm}) {
    for (const bool dense : {true, false}) {
      SCOPED_TRACE(to_text(algorithm) + (dense ? ", dense" : ""));
      rig.reconfigure("stereo_algorithm", to_text(algorithm));
      rig.reconfigure("dense", dense ? "true" : "false");
      const auto message = disparity.with_stamp(rig.publish(pair));
      ASSERT_TRUE(message);
      Parameters parameters;
      parameters.stereo_algorithm = algorithm;
      parameters.dense = dense;
      results.push_back(core_disparity(pair, parameters));
      expect_disparity(*message, results.back(), 0);
      EXPECT_EQ(message->valid_window.width == 160U, dense);
    }
  }
  for (std::size_t i = 1; i < results.size(); ++i) {
    EXPECT_GT(cv::countNonZero(results[i] != results[i - 1]), 0) << "the results tell them apart";
  }
}

TEST(Outputs, ADenseFrameHasDepthAndAPointInEveryPixel) {
  Rig rig;
  Listener<DisparityImage> disparity(rig.nh(), "disparity");
  Listener<PointCloud2> cloud(rig.nh(), "points2");
  Listener<Image> depth(rig.nh(), "depth");
  ASSERT_TRUE(rig.node_listens());
  rig.reconfigure("dense", "true");
  const ros::Time stamp = rig.publish(synthetic_pair(kSize, 12, true));
  const auto d = disparity.with_stamp(stamp);
  const auto points = cloud.with_stamp(stamp);
  const auto z = depth.with_stamp(stamp);
  ASSERT_TRUE(d && points && z);
  int without_disparity = 0, without_depth = 0, without_point = 0;
  for (unsigned i = 0; i < 160 * 120; ++i) {
    without_disparity += float_at(d->image.data, i * 4) <= 0;
    without_depth += !std::isfinite(float_at(z->data, i * 4));
    without_point += !std::isfinite(float_at(points->data, i * 32 + 8));
  }
  EXPECT_EQ(without_disparity, 0);
  EXPECT_EQ(without_depth, 0);
  EXPECT_EQ(without_point, 0);
  rig.reconfigure("dense", "false");
}

TEST(Outputs, EveryEncodingGivesTheDisparityOfItsGreyImage) {
  Rig rig;
  Listener<DisparityImage> disparity(rig.nh(), "disparity");
  ASSERT_TRUE(rig.node_listens());
  const PairMessages grey = synthetic_pair(kSize, 12);
  for (const std::string encoding : {"mono8", "mono16", "bgr8", "rgb8", "bgra8", "rgba8",
                                     "bayer_rggb8", "bayer_bggr8", "bayer_gbrg8", "bayer_grbg8"}) {
    PairMessages pair = grey;
    for (Image* image : {&pair.left, &pair.right}) {
      const bool bayer = encoding.rfind("bayer", 0) == 0;
      const auto header = image->header;
      if (bayer) {
        image->encoding = encoding;  // every grey image is a valid mosaic
      } else {
        *image = *cv_bridge::cvtColor(cv_bridge::toCvCopy(*image), encoding)->toImageMsg();
        image->header = header;
      }
    }
    const auto message = disparity.with_stamp(rig.publish(pair));
    ASSERT_TRUE(message) << encoding;
    SCOPED_TRACE(encoding);
    expect_disparity(*message, core_disparity(pair, Parameters()), 0);
  }
}

TEST(Outputs, ColorOfTheCameraReachesImageAndCloud) {
  Rig rig;
  Listener<Image> color(rig.nh(), "left/image_rect_color");
  Listener<Image> grey(rig.nh(), "left/image_rect");
  Listener<Image> raw_color(rig.nh(), "left/image_color");
  Listener<Image> raw_mono(rig.nh(), "right/image_mono");
  Listener<PointCloud2> cloud(rig.nh(), "points2");
  ASSERT_TRUE(rig.node_listens());
  PairMessages pair = synthetic_pair(kSize, 12);
  for (Image* image : {&pair.left, &pair.right}) {
    const auto header = image->header;
    const cv::Mat texture = cv_bridge::toCvCopy(*image)->image;
    const std::vector<cv::Mat> bgr{texture, texture / 2, 255 - texture};
    cv::Mat merged;
    cv::merge(bgr, merged);
    *image = *cv_bridge::CvImage(header, "bgr8", merged).toImageMsg();
  }
  const ros::Time stamp = rig.publish(pair);
  const auto picture = color.with_stamp(stamp);
  const auto points = cloud.with_stamp(stamp);
  ASSERT_TRUE(picture && points && grey.with_stamp(stamp));
  EXPECT_EQ(picture->encoding, "bgr8");
  EXPECT_EQ(picture->data, pair.left.data) << "this calibration moves no pixel";
  EXPECT_EQ(grey.last()->encoding, "mono8");
  ASSERT_TRUE(raw_color.with_stamp(stamp) && raw_mono.with_stamp(stamp));
  EXPECT_EQ(raw_color.last()->encoding, "bgr8");
  EXPECT_EQ(raw_color.last()->data, pair.left.data);
  EXPECT_EQ(raw_mono.last()->encoding, "mono8");
  EXPECT_EQ(raw_mono.last()->data, cv_bridge::toCvCopy(pair.right, "mono8")->toImageMsg()->data);
  int wrong = 0;
  for (unsigned i = 0; i < 160 * 120; ++i) {
    wrong += std::memcmp(&points->data[i * 32 + 16], &pair.left.data[i * 3], 3) != 0;
  }
  EXPECT_EQ(wrong, 0);
}

TEST(Outputs, MinDisparityShiftsTheSearchNotTheResult) {
  Rig rig;
  Listener<DisparityImage> disparity(rig.nh(), "disparity");
  Listener<Image> right(rig.nh(), "right/image_rect");
  ASSERT_TRUE(rig.node_listens());
  rig.reconfigure("min_disparity", "8");
  const PairMessages pair = synthetic_pair(kSize, 12);
  const ros::Time stamp = rig.publish(pair);
  const auto message = disparity.with_stamp(stamp);
  ASSERT_TRUE(message);
  Parameters parameters;
  parameters.min_disparity = 8;
  expect_disparity(*message, core_disparity(pair, parameters), 8);
  EXPECT_EQ(message->min_disparity, 8);
  EXPECT_EQ(message->max_disparity, 71);
  EXPECT_NEAR(float_at(message->image.data, 60 * message->image.step + 110 * 4), 12, 0.1);
  const auto image = right.with_stamp(stamp);
  ASSERT_TRUE(image);
  EXPECT_EQ(image->data, pair.right.data) << "the published right image is not shifted";
  rig.reconfigure("min_disparity", "0");
}

TEST(Outputs, DepthFollowsFromTheDisparityInBothEncodings) {
  Rig rig;
  Listener<DisparityImage> disparity(rig.nh(), "disparity");
  Listener<Image> depth(rig.nh(), "depth");
  ASSERT_TRUE(rig.node_listens());
  for (const std::string encoding : {"32FC1", "16UC1"}) {
    rig.reconfigure("depth_encoding", encoding);
    const ros::Time stamp = rig.publish(synthetic_pair(kSize, 12));
    const auto d = disparity.with_stamp(stamp);
    const auto z = depth.with_stamp(stamp);
    ASSERT_TRUE(d && z);
    ASSERT_EQ(z->encoding, encoding);
    int wrong = 0;
    for (unsigned i = 0; i < z->width * z->height; ++i) {
      const float value = float_at(d->image.data, i * 4);
      const double metres = 300 * 0.1 / value;
      if (encoding == "32FC1") {
        const float got = float_at(z->data, i * 4);
        wrong += value > 0 ? std::abs(got - metres) > 1e-5 * metres : !std::isnan(got);
      } else {
        const int got = z->data[i * 2] + 256 * z->data[i * 2 + 1];
        wrong += got != (value > 0 ? std::lround(metres * 1000) : 0);
      }
    }
    EXPECT_EQ(wrong, 0) << encoding;
  }
  rig.reconfigure("depth_encoding", "32FC1");
}

TEST(Outputs, CloudHasTheLayoutOfTheParameters) {
  Rig rig;
  Listener<PointCloud2> cloud(rig.nh(), "points2");
  ASSERT_TRUE(rig.node_listens());
  const auto next = [&] {
    const auto message = cloud.with_stamp(rig.publish(synthetic_pair(kSize, 12)));
    EXPECT_TRUE(message);
    return message ? *message : PointCloud2();
  };
  const PointCloud2 standard = next();
  EXPECT_EQ(standard.point_step, 32U);
  EXPECT_EQ(standard.row_step, 32U * 160);
  EXPECT_EQ(standard.width, 160U);
  EXPECT_EQ(standard.height, 120U);
  EXPECT_FALSE(standard.is_dense);
  ASSERT_EQ(standard.fields.size(), 4U);
  EXPECT_EQ(standard.fields[3].name, "rgb");
  EXPECT_EQ(standard.fields[3].offset, 16U);
  std::size_t valid = 0;
  for (std::size_t i = 0; i < standard.data.size(); i += 32) {
    valid += !std::isnan(float_at(standard.data, i + 8));
  }

  rig.reconfigure("cloud_fields", "mono");
  EXPECT_EQ(next().fields[3].name, "intensity");
  rig.reconfigure("cloud_padded", "false");
  EXPECT_EQ(next().point_step, 16U);
  rig.reconfigure("cloud_fields", "xyz");
  EXPECT_EQ(next().point_step, 12U);
  EXPECT_EQ(next().fields.size(), 3U);
  rig.reconfigure("cloud_organized", "false");
  const PointCloud2 dense = next();
  EXPECT_TRUE(dense.is_dense);
  EXPECT_EQ(dense.height, 1U);
  EXPECT_EQ(dense.width, valid);
  EXPECT_EQ(dense.data.size(), valid * 12);
  rig.reconfigure("cloud_organized", "true");
  rig.reconfigure("cloud_decimation", "3");
  EXPECT_EQ(next().width, 54U);
  EXPECT_EQ(next().height, 40U);
  rig.reconfigure("cloud_decimation", "1");
  rig.reconfigure("cloud_padded", "true");
  rig.reconfigure("cloud_fields", "rgb");
}

TEST(Outputs, CloudRateIsLimitedByStamp) {
  Rig rig;
  Listener<PointCloud2> cloud(rig.nh(), "points2");
  Listener<DisparityImage> disparity(rig.nh(), "disparity");
  ASSERT_TRUE(rig.node_listens());
  rig.reconfigure("cloud_max_rate", "5");
  PairMessages pair = synthetic_pair(kSize, 12);
  const ros::Time start = ros::Time::now() + ros::Duration(1);
  for (int i = 0; i < 8; ++i) {  // 20 Hz
    pair.set_stamp(start + ros::Duration(0.05 * i));
    rig.publish(pair, true);
    ASSERT_TRUE(disparity.with_stamp(pair.left.header.stamp));
  }
  EXPECT_TRUE(cloud.with_stamp(start));
  EXPECT_TRUE(cloud.with_stamp(start + ros::Duration(0.2)));
  EXPECT_EQ(cloud.count(), 2U);
  rig.reconfigure("cloud_max_rate", "0");
}

}  // namespace
}  // namespace fpga_stereo::test
