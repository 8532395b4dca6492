// Decoding the messages of a pair.
#include "ros/source_pair.hpp"

#include <cv_bridge/cv_bridge.h>
#include <gtest/gtest.h>

#include <boost/make_shared.hpp>

#include "ros/conversions.hpp"
#include "ros/rig.hpp"

namespace fpga_stereo::test {
namespace {

const cv::Size kSize(64, 48);

Result<SourcePair> decode(const PairMessages& messages, const Demand& demand = {}) {
  return decode_pair(boost::make_shared<sensor_msgs::Image>(messages.left),
                     boost::make_shared<sensor_msgs::CameraInfo>(messages.left_info),
                     boost::make_shared<sensor_msgs::Image>(messages.right),
                     boost::make_shared<sensor_msgs::CameraInfo>(messages.right_info), demand);
}

PairMessages colored_pair() {
  PairMessages pair = synthetic_pair(kSize, 4);
  for (sensor_msgs::Image* image : {&pair.left, &pair.right}) {
    *image = *cv_bridge::cvtColor(cv_bridge::toCvCopy(*image), "bgr8")->toImageMsg();
  }
  return pair;
}

TEST(SourcePair, SharesThePixelsOfGreyMessages) {
  const auto pair = decode(synthetic_pair(kSize, 4));
  ASSERT_TRUE(pair);
  EXPECT_EQ(pair->raw.left.data, pair->left_message->data.data());
  EXPECT_EQ(pair->raw.left_color.data, pair->raw.left.data) << "grey cameras have no other colour";
  EXPECT_EQ(pair->raw.right.data, pair->right_message->data.data());
}

TEST(SourcePair, DecodesColourOnlyOnDemand) {
  const auto grey = decode(colored_pair());
  ASSERT_TRUE(grey);
  EXPECT_EQ(grey->raw.left.size(), kSize);
  EXPECT_TRUE(grey->raw.left_color.empty());
  Demand demand;
  demand.left.rect_color = true;
  const auto color = decode(colored_pair(), demand);
  ASSERT_TRUE(color);
  EXPECT_EQ(color->raw.left_color.type(), CV_8UC3);
  EXPECT_TRUE(color->raw.right_color.empty());
}

TEST(SourcePair, HasTheStampAndTheFrameOfEachImage) {
  PairMessages messages = synthetic_pair(kSize, 4);
  messages.left.header.stamp = ros::Time(1600000000, 123456789);
  messages.right.header.stamp = messages.left.header.stamp + ros::Duration(0.01);
  messages.right.header.frame_id = "right_frame";
  const auto pair = decode(messages);
  ASSERT_TRUE(pair);
  EXPECT_EQ(pair->raw.stamp_ns, 1600000000123456789);
  EXPECT_EQ(pair->left_header().stamp, messages.left.header.stamp);
  EXPECT_EQ(pair->left_header().frame_id, "stereo_left_optical_frame");
  EXPECT_EQ(pair->right_header().stamp, messages.right.header.stamp);
  EXPECT_EQ(pair->right_header().frame_id, "right_frame");
}

TEST(SourcePair, OfRectifiedImagesIsDescribedByPAlone) {
  const PairMessages messages = synthetic_pair(kSize, 4, true);
  const auto decode_as = [&](PairKind kind) {
    const auto pair =
        decode_pair(boost::make_shared<sensor_msgs::Image>(messages.left),
                    boost::make_shared<sensor_msgs::CameraInfo>(messages.left_info),
                    boost::make_shared<sensor_msgs::Image>(messages.right),
                    boost::make_shared<sensor_msgs::CameraInfo>(messages.right_info), {}, kind);
    EXPECT_TRUE(pair);
    return pair->raw.calibration;
  };
  const StereoCalibration raw = decode_as(PairKind::kRaw);
  EXPECT_EQ(raw.left.D.size(), 5U);
  const StereoCalibration rectified = decode_as(PairKind::kRectified);
  EXPECT_EQ(rectified.left, rectified_calibration(raw.left));
  EXPECT_EQ(rectified.right, rectified_calibration(raw.right));
}

TEST(SourcePair, RefusesAnImageThatCannotBeDecodedByName) {
  PairMessages messages = synthetic_pair(kSize, 4);
  messages.right.encoding = "jpeg";
  const auto pair = decode(messages);
  ASSERT_FALSE(pair);
  EXPECT_EQ(pair.error().message.rfind("right image with encoding \"jpeg\", 64x48", 0), 0U)
      << pair.error().message;
}

}  // namespace
}  // namespace fpga_stereo::test
