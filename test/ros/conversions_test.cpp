// Conversions between messages and core, without a node.
#include "ros/conversions.hpp"

#include <cv_bridge/cv_bridge.h>
#include <gtest/gtest.h>
#include <image_geometry/stereo_camera_model.h>

#include <boost/make_shared.hpp>
#include <cmath>
#include <cstring>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "core/stages.hpp"
#include "ros/image_pixels.hpp"
#include "ros/message_pool.hpp"
#include "ros/rig.hpp"

namespace fpga_stereo::test {
namespace {

constexpr std::uint16_t kNone = kNoDisparity;

StereoGeometry geometry(cv::Size size) {
  StereoGeometry g;
  g.image_size = size;
  g.fx = g.fy = 400;
  g.cx = g.cx_right = 2;
  g.cy = 1;
  g.baseline = 0.25;
  return g;
}

std::vector<float> values(const stereo_msgs::DisparityImage& message) {
  std::vector<float> result(message.image.data.size() / 4);
  std::memcpy(result.data(), message.image.data.data(), message.image.data.size());
  return result;
}

stereo_msgs::DisparityImage disparity_message(const cv::Mat1w& disparity, const StereoGeometry& g,
                                              const Parameters& parameters) {
  stereo_msgs::DisparityImage message;
  to_disparity_image(disparity, g, parameters, {}, message);
  return message;
}

TEST(Conversions, DisparityImageHasValuesMarkerAndRange) {
  const cv::Mat1w disparity = (cv::Mat1w(1, 4) << 0, 32, 33, kNone);
  Parameters parameters;
  const auto message = disparity_message(disparity, geometry({4, 1}), parameters);
  EXPECT_EQ(values(message), (std::vector<float>{0, 1, 1.03125F, -1}));
  EXPECT_EQ(message.min_disparity, 0);
  EXPECT_EQ(message.max_disparity, 63);
  EXPECT_EQ(message.f, 400);
  EXPECT_EQ(message.T, 0.25F);

  parameters.min_disparity = -16;
  const auto shifted = disparity_message(disparity, geometry({4, 1}), parameters);
  EXPECT_EQ(values(shifted), (std::vector<float>{-16, -15, -14.96875F, -17}));
  EXPECT_EQ(shifted.min_disparity, -16);
  EXPECT_EQ(shifted.max_disparity, 47);
}

TEST(Conversions, SubtractsTheOffsetOfThePrincipalPointsOnce) {
  const cv::Mat1w disparity = (cv::Mat1w(1, 2) << 320, kNone);
  StereoGeometry g = geometry({2, 1});
  g.cx = 5;
  g.cx_right = 3;
  const auto message = disparity_message(disparity, g, {});
  EXPECT_EQ(values(message), (std::vector<float>{8, -3}));
  EXPECT_EQ(message.min_disparity, -2);
  EXPECT_EQ(message.max_disparity, 61);
  // The cloud uses the same disparity: Z = f T / (x_l - x_r - (cx_l - cx_r)).
  sensor_msgs::PointCloud2 cloud;
  to_point_cloud2(disparity, make_reprojection(g, 0), cv::Mat1b::zeros(1, 2), {}, {}, cloud);
  float z = 0;
  std::memcpy(&z, &cloud.data[8], sizeof z);
  EXPECT_FLOAT_EQ(z, 400 * 0.25 / 8);
}

TEST(Conversions, OverwritesAReusedMessageCompletely) {
  const StereoGeometry large = geometry({6, 4}), small = geometry({3, 2});
  const cv::Mat1w first(large.image_size, std::uint16_t{320}), second(small.image_size, kNone);
  const CloudLayout other{PointColor::kMono, false, true, 1};
  sensor_msgs::PointCloud2 used, fresh;
  to_point_cloud2(first, make_reprojection(large, 0), cv::Mat1b(4, 6, std::uint8_t{200}), {}, {},
                  used);
  for (auto* cloud : {&used, &fresh}) {
    to_point_cloud2(second, make_reprojection(small, 0), cv::Mat1b(2, 3, std::uint8_t{9}), other,
                    {}, *cloud);
  }
  EXPECT_TRUE(used.data == fresh.data);
  EXPECT_EQ(used.fields.size(), fresh.fields.size());
  EXPECT_EQ(used.row_step, fresh.row_step);
  stereo_msgs::DisparityImage used_image = disparity_message(first, large, {});
  to_disparity_image(second, small, {}, {}, used_image);
  EXPECT_EQ(values(used_image), values(disparity_message(second, small, {})));
}

TEST(Conversions, MessagePoolReusesAMessageThatNobodyHolds) {
  MessagePool<sensor_msgs::PointCloud2> pool;
  auto first = pool.take();
  const auto* const memory = first.get();
  EXPECT_NE(pool.take().get(), memory) << "it is held";
  first.reset();
  EXPECT_EQ(pool.take().get(), memory);
  std::vector<boost::shared_ptr<sensor_msgs::PointCloud2>> held;
  for (int i = 0; i < 10; ++i) held.push_back(pool.take());
  std::set<const void*> different;
  for (const auto& message : held) different.insert(message.get());
  EXPECT_EQ(different.size(), 10U);
}

TEST(Conversions, ValidWindowLiesInTheImage) {
  Parameters parameters = window_parameters();
  const auto window = [&](cv::Size size) {
    return disparity_message(cv::Mat1w(size, kNone), geometry(size), parameters).valid_window;
  };
  auto w = window({640, 480});
  EXPECT_EQ(w.x_offset, 64U + 7 - 1);
  EXPECT_EQ(w.y_offset, 7U);
  EXPECT_EQ(w.width, 640U - 1 - 7 - 70);
  EXPECT_EQ(w.height, 480U - 1 - 14);
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(10, 10), cv::Size(71, 15)}) {
    w = window(size);
    EXPECT_LE(w.x_offset + w.width, static_cast<unsigned>(size.width));
    EXPECT_LE(w.y_offset + w.height, static_cast<unsigned>(size.height));
  }
  parameters.min_disparity = -20;
  w = window({640, 480});
  EXPECT_EQ(w.x_offset, 64U - 20 + 7 - 1);
  EXPECT_EQ(w.width, 640U - 1 - 20 - 50);

  // Semi-global matching has no border, and a dense image no gaps.
  parameters = {};
  w = window({640, 480});
  EXPECT_EQ(w.x_offset, 64U - 1);
  EXPECT_EQ(w.y_offset, 0U);
  EXPECT_EQ(w.width, 640U - 1 - 63);
  EXPECT_EQ(w.height, 480U - 1);
  parameters.min_disparity = 10;
  w = window({640, 480});
  EXPECT_EQ(w.x_offset, 64U + 10 - 1);
  EXPECT_EQ(w.width, 640U - 1 - 10 - 73);
  for (const StereoAlgorithm algorithm : {StereoAlgorithm::kSgm, StereoAlgorithm::kWindow}) {
    parameters.stereo_algorithm = algorithm;
    parameters.dense = true;
    w = window({640, 480});
    EXPECT_EQ(w.x_offset, 0U);
    EXPECT_EQ(w.y_offset, 0U);
    EXPECT_EQ(w.width, 640U);
    EXPECT_EQ(w.height, 480U);
  }
}

TEST(Conversions, CameraInfoKeepsEveryFieldBothWays) {
  sensor_msgs::CameraInfo info = synthetic_pair({64, 48}, 3, true).right_info;
  info.binning_x = 2;
  info.binning_y = 3;
  info.roi.x_offset = 4;
  info.roi.y_offset = 5;
  info.roi.width = 20;
  info.roi.height = 30;
  const CameraCalibration c = *to_calibration(info, "right");
  EXPECT_EQ(c.width, 64);
  EXPECT_EQ(c.height, 48);
  EXPECT_EQ(c.distortion_model, "plumb_bob");
  EXPECT_EQ(c.D, info.D);
  EXPECT_TRUE(std::equal(c.K.begin(), c.K.end(), info.K.begin()));
  EXPECT_TRUE(std::equal(c.R.begin(), c.R.end(), info.R.begin()));
  EXPECT_TRUE(std::equal(c.P.begin(), c.P.end(), info.P.begin()));
  EXPECT_EQ(c.binning_x, 2);
  EXPECT_EQ(c.binning_y, 3);
  EXPECT_EQ(c.roi, cv::Rect(4, 5, 20, 30));
  std_msgs::Header header;
  header.frame_id = "somewhere";
  const sensor_msgs::CameraInfo back = to_camera_info(c, header);
  EXPECT_EQ(back.header.frame_id, "somewhere");
  EXPECT_EQ(*to_calibration(back, "right"), c);
}

TEST(Conversions, GeometryEqualsImageGeometryWithBinningAndRoi) {
  PairMessages pair = synthetic_pair({640, 480}, 3, true);
  for (sensor_msgs::CameraInfo* info : {&pair.left_info, &pair.right_info}) {
    info->binning_x = info->binning_y = 2;
    info->roi.x_offset = 40;
    info->roi.y_offset = 20;
    info->roi.width = 320;
    info->roi.height = 200;
  }
  image_geometry::StereoCameraModel model;
  ASSERT_TRUE(model.fromCameraInfo(pair.left_info, pair.right_info));
  const auto ours = make_stereo_rectification(*to_calibration(pair.left_info, "left"),
                                              *to_calibration(pair.right_info, "right"), 0);
  ASSERT_TRUE(ours) << ours.error().message;
  EXPECT_EQ(ours->geometry.image_size, cv::Size(160, 100));
  EXPECT_DOUBLE_EQ(ours->geometry.fx, model.right().fx());
  EXPECT_DOUBLE_EQ(ours->geometry.fy, model.left().fy());
  EXPECT_DOUBLE_EQ(ours->geometry.cx, model.left().cx());
  EXPECT_DOUBLE_EQ(ours->geometry.cx_right, model.right().cx());
  EXPECT_DOUBLE_EQ(ours->geometry.cy, model.left().cy());
  EXPECT_DOUBLE_EQ(ours->geometry.baseline, model.baseline());
}

TEST(Conversions, DisparitiesShareThePixelsOfTheMessage) {
  const cv::Mat1w disparity(3, 4, std::uint16_t{7 * 32});
  const auto message = disparity_message(disparity, geometry({4, 3}), Parameters());
  const auto floats = to_disparities(message);
  ASSERT_TRUE(floats);
  EXPECT_EQ(floats->size(), cv::Size(4, 3));
  EXPECT_EQ(floats->data, message.image.data.data());
  EXPECT_EQ(cv::countNonZero(*floats != 7), 0);
}

TEST(Conversions, RefusesDisparityImagesWhoseFieldsDoNotDescribeTheirData) {
  using Message = stereo_msgs::DisparityImage;
  const cv::Mat1w disparity(120, 160, std::uint16_t{7 * 32});
  const Message good = disparity_message(disparity, geometry({160, 120}), Parameters());
  const auto expect_refused = [&](const std::function<void(Message&)>& damage,
                                  const std::string& words) {
    Message message = good;
    damage(message);
    const auto floats = to_disparities(message);
    ASSERT_FALSE(floats) << words;
    EXPECT_NE(floats.error().message.find(words), std::string::npos) << floats.error().message;
  };
  expect_refused([](Message& m) { m.image.encoding = "mono16"; }, "allowed is the encoding 32FC1");
  expect_refused([](Message& m) { m.image.width = 0; }, "it has no pixels");
  expect_refused([](Message& m) { m.image.height = 1U << 31; }, "allowed are up to 1920x1200");
  expect_refused([](Message& m) { m.image.step = 636; }, "a multiple of 4 from 640 on");
  expect_refused([](Message& m) { m.image.step = 641; }, "a multiple of 4 from 640 on");
  expect_refused([](Message& m) { m.image.step = 644; }, "the data must have 77280 bytes");
  // 120 rows of 2^29 bytes are 0 bytes in 32 bits.
  expect_refused([](Message& m) { m.image.step = 1U << 29; },
                 "the data must have 64424509440 bytes");
  expect_refused([](Message& m) { m.min_disparity = std::nanf(""); }, "min_disparity");
  EXPECT_TRUE(to_disparities(good));
}

sensor_msgs::ImagePtr image_message(const std::string& encoding, std::uint32_t width,
                                    std::uint32_t height, std::uint32_t step, std::size_t bytes) {
  auto image = boost::make_shared<sensor_msgs::Image>();
  image->encoding = encoding;
  image->width = width;
  image->height = height;
  image->step = step;
  image->data.resize(bytes);
  return image;
}

TEST(Conversions, RefusesImagesWhoseFieldsDoNotDescribeTheirData) {
  const auto expect_refused = [](const sensor_msgs::ImagePtr& image, const std::string& text) {
    for (const auto& decoded : {to_grey(image, "left"), to_bgr(image, "left")}) {
      ASSERT_FALSE(decoded) << text;
      EXPECT_EQ(decoded.error().message, text);
    }
  };
  // 120 rows of this step are 104 bytes in 32 bits.
  for (const std::string encoding : {"mono8", "rgba8"}) {
    expect_refused(
        image_message(encoding, 160, 120, 35791395, 104),
        "left image with encoding \"" + encoding +
            "\", 160x120, step 35791395, 104 bytes: the data must have 4294967400 bytes");
  }
  // A row of this width is 0 bytes in 32 bits.
  expect_refused(
      image_message("rgba8", 1U << 30, 1, 0, 0),
      "left image with encoding \"rgba8\", 1073741824x1, step 0, 0 bytes: allowed are up "
      "to 65535x65535");
  expect_refused(image_message("mono8", 4, 0, 4, 0),
                 "left image with encoding \"mono8\", 4x0, step 4, 0 bytes: it has no pixels");
  expect_refused(image_message("mono8", 4, 2, 3, 6),
                 "left image with encoding \"mono8\", 4x2, step 3, 6 bytes: the step must be 4 or "
                 "more");
  expect_refused(image_message("mono16", 4, 2, 9, 18),
                 "left image with encoding \"mono16\", 4x2, step 9, 18 bytes: the step must be a "
                 "multiple of 2 from 8 on");
  expect_refused(image_message("mono8", 4, 2, 4, 9),
                 "left image with encoding \"mono8\", 4x2, step 4, 9 bytes: the data must have 8 "
                 "bytes");
  expect_refused(image_message("8UC5", 4, 2, 20, 40),
                 "left image with encoding \"8UC5\", 4x2, step 20, 40 bytes: allowed are 1 to 4 "
                 "channels");
  const std::string unknown =
      ": the encoding is unknown; allowed are mono8, mono16, bgr8, rgb8, bgra8, rgba8, bayer_*8 "
      "and "
      "the others of sensor_msgs/image_encodings.h";
  expect_refused(image_message("\x1b[2J", 4, 2, 4, 8),
                 "left image with encoding \"\\x1b[2J\", 4x2, step 4, 8 bytes" + unknown);
  expect_refused(image_message("8UC" + std::string(1000000, '0') + "1", 4, 2, 4, 8),
                 "left image with encoding \"8UC" + std::string(77, '0') +
                     "...\", 4x2, step 4, 8 bytes" + unknown);
  const auto deep = to_grey(image_message("64FC1", 4, 2, 32, 64), "left");
  ASSERT_FALSE(deep);
  EXPECT_NE(deep.error().message.find("allowed are mono8, mono16"), std::string::npos)
      << deep.error().message;
}

TEST(Conversions, ReadsBothByteOrders) {
  const auto image = image_message("mono16", 3, 1, 8, 8);
  image->data = {0x00, 0x80, 0xFF, 0xFF, 0x01, 0x10, 0xAA, 0xAA};
  const auto little = pixels_of(*image, "left");
  ASSERT_TRUE(little);
  EXPECT_EQ(cv::countNonZero(*little != (cv::Mat1w(1, 3) << 0x8000, 0xFFFF, 0x1001)), 0);
  EXPECT_EQ(little->data, image->data.data());
  image->is_bigendian = 1;
  const auto big = pixels_of(*image, "left");
  ASSERT_TRUE(big);
  EXPECT_EQ(cv::countNonZero(*big != (cv::Mat1w(1, 3) << 0x0080, 0xFFFF, 0x0110)), 0);
  const auto grey = to_grey(image, "left");
  ASSERT_TRUE(grey);
  EXPECT_EQ(grey->type(), CV_8UC1);
  EXPECT_EQ(cv::countNonZero(*grey != (cv::Mat1b(1, 3) << 0, 255, 1)), 0);

  const auto color = image_message("bgr16", 1, 1, 6, 6);
  color->data = {1, 2, 3, 4, 5, 6};
  color->is_bigendian = 1;
  const auto swapped = pixels_of(*color, "left");
  ASSERT_TRUE(swapped);
  EXPECT_EQ(swapped->at<cv::Vec3w>(0, 0), cv::Vec3w(0x0102, 0x0304, 0x0506));
}

TEST(Conversions, RefusesCameraInfosThatNoCameraHas) {
  using Info = sensor_msgs::CameraInfo;
  const auto expect_refused = [](const std::function<void(Info&)>& damage,
                                 const std::string& text) {
    Info info = synthetic_pair({64, 48}, 3).left_info;
    damage(info);
    const auto calibration = to_calibration(info, "left");
    ASSERT_FALSE(calibration) << text;
    EXPECT_EQ(calibration.error().message, "left camera_info " + text);
    EXPECT_EQ(calibration.error().kind, ErrorKind::kCalibration);
  };
  expect_refused([](Info& i) { i.width = 4294967295; },
                 "width = 4294967295: allowed are 0 to 65535");
  expect_refused([](Info& i) { i.height = 65536; }, "height = 65536: allowed are 0 to 65535");
  expect_refused([](Info& i) { i.binning_x = 1U << 31; },
                 "binning_x = 2147483648: allowed are 0 to 65535");
  expect_refused([](Info& i) { i.binning_y = 65536; }, "binning_y = 65536: allowed are 0 to 65535");
  expect_refused([](Info& i) { i.roi.x_offset = 65536; },
                 "roi.x_offset = 65536: allowed are 0 to 65535");
  expect_refused([](Info& i) { i.roi.y_offset = 65536; },
                 "roi.y_offset = 65536: allowed are 0 to 65535");
  expect_refused([](Info& i) { i.roi.width = 65536; }, "roi.width = 65536: allowed are 0 to 65535");
  expect_refused([](Info& i) { i.roi.height = 4294967295; },
                 "roi.height = 4294967295: allowed are 0 to 65535");
  expect_refused([](Info& i) { i.D.assign(1000000, 0); },
                 "D has 1000000 values: allowed are up to 14");
  expect_refused([](Info& i) { i.distortion_model.assign(1000000, 'x'); },
                 "distortion_model = \"" + std::string(80, 'x') +
                     "...\": allowed are plumb_bob and rational_polynomial");
}

TEST(Conversions, Scales16BitGreyTo8Bit) {
  cv_bridge::CvImage image({}, "mono16", (cv::Mat1w(1, 3) << 0, 32768, 65535));
  const auto grey = to_grey(image.toImageMsg(), "left");
  ASSERT_TRUE(grey);
  EXPECT_EQ(grey->at<std::uint8_t>(0, 0), 0);
  EXPECT_EQ(grey->at<std::uint8_t>(0, 1), 128);
  EXPECT_EQ(grey->at<std::uint8_t>(0, 2), 255);
}

TEST(Conversions, SharesThePixelsOfMono8) {
  const auto message =
      cv_bridge::CvImage({}, "mono8", cv::Mat1b(4, 4, std::uint8_t{9})).toImageMsg();
  const auto grey = to_grey(message, "left");
  ASSERT_TRUE(grey);
  EXPECT_EQ(grey->data, message->data.data());
}

TEST(Conversions, ImageRoundTrips) {
  std_msgs::Header header;
  header.frame_id = "somewhere";
  for (const int type : {CV_8UC1, CV_8UC3, CV_16UC1, CV_32FC1}) {
    cv::Mat image(5, 7, type);
    cv::randu(image, 0, 200);
    const auto message = to_image(image, header);
    EXPECT_EQ(message->header.frame_id, "somewhere");
    EXPECT_EQ(cv::norm(cv_bridge::toCvCopy(*message)->image, image, cv::NORM_INF), 0);
  }
}

}  // namespace
}  // namespace fpga_stereo::test
