// make_bag extract: the extracted files equal those that make_bag create was given.
#include <rosbag/bag.h>
#include <std_msgs/String.h>
#include <stereo_msgs/DisparityImage.h>

#include <limits>
#include <opencv2/imgcodecs.hpp>

#include "make_bag/camera_info_files.hpp"
#include "programs.hpp"
#include "ros/conversions.hpp"

namespace fpga_stereo::tools {
namespace {

const cv::Size kSize(33, 21);

std_msgs::Header header(double stamp) {
  std_msgs::Header result;
  result.stamp.fromSec(stamp);
  return result;
}

class Extract : public ProgramTest {
 protected:
  /// Writes images with the stamps in both lists.
  void write_bag(const std::vector<double>& left, const std::vector<double>& right,
                 const std::vector<double>& disparities = {}) const {
    rosbag::Bag bag(at("in.bag"), rosbag::bagmode::Write);
    for (const double stamp : left) write_image_message(bag, "/stereo/left/image_raw", stamp);
    for (const double stamp : right) write_image_message(bag, "/stereo/right/image_raw", stamp);
    for (const double stamp : disparities) {
      stereo_msgs::DisparityImage message;
      message.header = header(stamp);
      message.min_disparity = -2;
      message.image = *to_image(disparities_of(stamp), message.header);
      bag.write("/stereo/disparity", message.header.stamp, message);
    }
  }
  static cv::Mat1b image_of(double stamp) {
    return noise_pair(kSize, 2, static_cast<int>(10 * stamp)).left;
  }
  static cv::Mat1f disparities_of(double stamp) {
    cv::Mat1f disparity(kSize, static_cast<float>(stamp));
    disparity(0, 0) = -3;  // min_disparity - 1 is invalid
    disparity(1, 1) = -2;  // min_disparity itself is valid
    disparity(2, 2) = std::numeric_limits<float>::quiet_NaN();
    return disparity;
  }
  static void write_image_message(rosbag::Bag& bag, const std::string& topic, double stamp) {
    bag.write(topic, header(stamp).stamp, to_image(image_of(stamp), header(stamp)));
  }
  Outcome extract(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"extract", at("in.bag"), at("out")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return make_bag(arguments);
  }
  void expect_refused(const std::vector<std::string>& parts) const {
    const Outcome run = extract();
    EXPECT_EQ(run.code, 1);
    for (const std::string& part : parts) {
      EXPECT_NE(run.err.find(part), std::string::npos) << "\"" << part << "\" in: " << run.err;
    }
  }
};

TEST_F(Extract, InvertsCreate) {
  const InfoPair infos = distorted_cameras(kSize);
  cv::Mat3b color(kSize);
  cv::randu(color, 0, 256);
  const NoisePair grey = noise_pair(kSize, 2);
  write("l/a.png", grey.left);
  write("l/b.png", color);
  write("r/a.png", grey.right);
  write("r/b.png", color);
  ASSERT_EQ(make_bag({"create", at("in.bag"), "--left", at("l"), "--right", at("r"), "--left-info",
                      write_info("l.yaml", infos.left), "--right-info",
                      write_info("r.yaml", infos.right), "--camera", "rig"})
                .code,
            0);
  const Outcome run = extract({"--camera", "rig"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(run.err, "");
  const auto read = [&](const std::string& name) {
    return cv::imread(at(name), cv::IMREAD_UNCHANGED);
  };
  EXPECT_TRUE(equal(read("out/left/000000.png"), grey.left));
  EXPECT_TRUE(equal(read("out/right/000000.png"), grey.right));
  EXPECT_TRUE(equal(read("out/left/000001.png"), color));
  EXPECT_TRUE(equal(read("out/right/000001.png"), color));
  EXPECT_FALSE(exists("out/left/000002.png"));
  EXPECT_FALSE(exists("out/disparity"));
  for (const std::string side : {"left", "right"}) {
    const sensor_msgs::CameraInfo& given = side == "left" ? infos.left : infos.right;
    const sensor_msgs::CameraInfo got = read_camera_info_message(at("out/" + side + ".yaml"));
    EXPECT_TRUE(got.D == given.D && got.K == given.K && got.R == given.R && got.P == given.P);
    EXPECT_EQ(got.distortion_model, given.distortion_model);
    EXPECT_EQ(got.width, given.width);
    EXPECT_EQ(got.height, given.height);
  }
}

TEST_F(Extract, PairsByStampAndReportsTheRest) {
  write_bag({3, 1, 2, 5}, {2, 3, 4}, {3, 5});
  const Outcome run = extract();
  ASSERT_EQ(run.code, 0) << run.err;
  for (const std::string name :
       {"/stereo/left/image_raw of 1.000000000", "/stereo/left/image_raw of 5.000000000",
        "/stereo/right/image_raw of 4.000000000", "/stereo/disparity of 5.000000000",
        "left.yaml is not written"}) {
    EXPECT_NE(run.err.find(name), std::string::npos) << name << " in: " << run.err;
  }
  EXPECT_EQ(run.err.find("2.000000000"), std::string::npos) << run.err;
  for (const int number : {0, 1}) {  // stamps 2 and 3
    const std::string name = "00000" + std::to_string(number) + ".png";
    const cv::Mat1b expected = image_of(number + 2);
    EXPECT_TRUE(equal(cv::imread(at("out/left/" + name), cv::IMREAD_UNCHANGED), expected));
    EXPECT_TRUE(equal(cv::imread(at("out/right/" + name), cv::IMREAD_UNCHANGED), expected));
  }
  EXPECT_FALSE(exists("out/left/000002.png"));
  EXPECT_FALSE(exists("out/disparity/000000.pfm"));
  cv::Mat1f expected = disparities_of(3);
  expected(0, 0) = expected(2, 2) = std::numeric_limits<float>::infinity();
  EXPECT_TRUE(equal(cv::imread(at("out/disparity/000001.pfm"), cv::IMREAD_UNCHANGED), expected));
}

TEST_F(Extract, ConvertsRgb) {
  cv::Mat3b bgr(kSize, cv::Vec3b(10, 20, 30));
  {
    rosbag::Bag bag(at("in.bag"), rosbag::bagmode::Write);
    auto message = to_image(bgr, header(1));
    bag.write("/stereo/left/image_raw", header(1).stamp, message);
    message->encoding = "rgb8";
    bag.write("/stereo/right/image_raw", header(1).stamp, message);
  }
  ASSERT_EQ(extract().code, 0);
  EXPECT_TRUE(equal(cv::imread(at("out/left/000000.png")), bgr));
  EXPECT_TRUE(
      equal(cv::imread(at("out/right/000000.png")), cv::Mat3b(kSize, cv::Vec3b(30, 20, 10))));
}

TEST_F(Extract, RefusesLossyConversions) {
  {
    rosbag::Bag bag(at("in.bag"), rosbag::bagmode::Write);
    const auto message = to_image(disparities_of(1), header(1));
    bag.write("/stereo/left/image_raw", header(1).stamp, message);
    bag.write("/stereo/right/image_raw", header(1).stamp, message);
  }
  expect_refused({at("in.bag"), "32FC1"});
}

TEST_F(Extract, RefusesImagesWhoseFieldsDoNotDescribeTheirData) {
  const std::string fields =
      "160x120, step 35791395, 104 bytes: the data must have 4294967400 bytes";
  const auto damage = [](sensor_msgs::Image& image) {
    image.step = 35791395;  // 120 rows are 104 bytes in 32 bits
    image.data.resize(104);
  };
  const cv::Mat1b grey(120, 160, std::uint8_t{9});
  auto image = to_image(grey, header(1));
  stereo_msgs::DisparityImage disparity;
  disparity.header = header(1);
  disparity.image = *to_image(cv::Mat1f(grey), header(1));
  {
    rosbag::Bag bag(at("in.bag"), rosbag::bagmode::Write);
    bag.write("/stereo/right/image_raw", header(1).stamp, image);
    damage(*image);
    bag.write("/stereo/left/image_raw", header(1).stamp, image);
  }
  expect_refused(
      {"/stereo/left/image_raw of 1.000000000: the image with encoding \"mono8\", " + fields});
  {
    rosbag::Bag bag(at("in.bag"), rosbag::bagmode::Write);
    image = to_image(grey, header(1));
    bag.write("/stereo/left/image_raw", header(1).stamp, image);
    bag.write("/stereo/right/image_raw", header(1).stamp, image);
    disparity.image.data.resize(disparity.image.data.size() - 1);
    bag.write("/stereo/disparity", header(1).stamp, disparity);
  }
  expect_refused(
      {"/stereo/disparity of 1.000000000: disparity image with encoding \"32FC1\", "
       "160x120, step 640, 76799 bytes: the data must have 76800 bytes"});
}

TEST_F(Extract, RefusesInvalidBags) {
  expect_refused({at("in.bag")});  // missing
  write_text("in.bag", "no bag at all");
  expect_refused({at("in.bag")});
  write_text("in.bag", "");
  expect_refused({at("in.bag")});
  write_bag({1, 2, 3}, {1, 2, 3});
  const std::string whole = bytes(at("in.bag"));
  for (const double part : {0.999, 0.9, 0.5, 0.1}) {
    write_text("in.bag", whole.substr(0, static_cast<std::size_t>(part * whole.size())));
    expect_refused({at("in.bag")});
  }
}

TEST_F(Extract, NamesMissingTopics) {
  write_bag({1, 2}, {});
  expect_refused({at("in.bag"), "/stereo/right/image_raw", "topics are: /stereo/left/image_raw"});
  write_bag({1, 2}, {3});
  expect_refused({at("in.bag"), "no left and right image have equal stamps"});
  {
    rosbag::Bag bag(at("in.bag"), rosbag::bagmode::Write);
    bag.write("/stereo/left/image_raw", ros::Time(1), std_msgs::String());
  }
  expect_refused({at("in.bag"), "std_msgs/String", "sensor_msgs/Image"});
}

TEST_F(Extract, Usage) {
  EXPECT_EQ(make_bag({"extract", at("in.bag")}).code, 2);
  write_bag({1}, {1});
  write_text("file", "");
  const Outcome run = make_bag({"extract", at("in.bag"), at("file")});
  EXPECT_EQ(run.code, 1);
  EXPECT_NE(run.err.find(at("file")), std::string::npos) << run.err;
}

}  // namespace
}  // namespace fpga_stereo::tools
