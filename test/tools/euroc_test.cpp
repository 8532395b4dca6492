// make_bag create --euroc.
#include <rosbag/bag.h>
#include <rosbag/view.h>

#include <opencv2/imgcodecs.hpp>

#include "make_bag/camera_info_files.hpp"
#include "programs.hpp"
#include "ros/conversions.hpp"
#include "support/files.hpp"

namespace fpga_stereo::tools {
namespace {

const cv::Size kSize(64, 48);

/// Returns the sensor.yaml of a camera that is `x` m to the right of the body.
std::string sensor(double x, const std::string& model = "radial-tangential") {
  return "# General sensor definitions.\n"
         "sensor_type: camera\n"
         "T_BS:\n  cols: 4\n  rows: 4\n"
         "  data: [1.0, 0.0, 0.0, " +
         std::to_string(x) +
         ",\n"
         "         0.0, 1.0, 0.0, 0.0,\n"
         "         0.0, 0.0, 1.0, 0.0,\n"
         "         0.0, 0.0, 0.0, 1.0]\n"
         "rate_hz: 20\n"
         "resolution: [64, 48]\n"
         "camera_model: pinhole\n"
         "intrinsics: [60.0, 60.0, 31.5, 23.5] #fu, fv, cu, cv\n"
         "distortion_model: " +
         model +
         "\n"
         "distortion_coefficients: [0.0, 0.0, 0.0, 0.0]\n";
}

class Euroc : public ProgramTest {
 protected:
  void write_tree() const {
    write_text("e/cam0/sensor.yaml", "%YAML:1.0\n" + sensor(0.1));
    write_text("e/cam1/sensor.yaml", sensor(0.35));  // no %YAML line, as in the dataset
    for (const std::string stamp : {"1403715273262142976", "1403715273312142976"}) {
      write("e/cam0/data/" + stamp + ".png", noise_pair(kSize, 3).left);
      write("e/cam1/data/" + stamp + ".png", noise_pair(kSize, 3).right);
    }
  }
  Outcome create(const std::string& folder) const {
    return make_bag({"create", at("out.bag"), "--euroc", folder});
  }
  void expect_refused(const std::vector<std::string>& parts) const {
    const Outcome run = create(at("e"));
    EXPECT_EQ(run.code, 1);
    for (const std::string& part : parts) {
      EXPECT_NE(run.err.find(part), std::string::npos) << "\"" << part << "\" in: " << run.err;
    }
  }
  std::vector<std::uint64_t> stamps() const {
    std::vector<std::uint64_t> found;
    rosbag::Bag bag(at("out.bag"));
    rosbag::View view(bag, rosbag::TopicQuery("/stereo/right/image_raw"));
    for (const rosbag::MessageInstance& instance : view) {
      found.push_back(instance.instantiate<sensor_msgs::Image>()->header.stamp.toNSec());
    }
    return found;
  }
};

TEST_F(Euroc, StampsAndCalibration) {
  write_tree();
  const Outcome run = make_bag({"create", at("out.bag"), "--euroc", at("e"), "--repeat", "2"});
  ASSERT_EQ(run.code, 0) << run.err;
  const std::vector<std::uint64_t> expected{1403715273262142976, 1403715273312142976,
                                            1403715273362142976, 1403715273412142976};
  EXPECT_EQ(stamps(), expected);
  ASSERT_EQ(make_bag({"extract", at("out.bag"), at("out")}).code, 0);
  const sensor_msgs::CameraInfo right = read_camera_info_message(at("out/right.yaml"));
  EXPECT_NEAR(-right.P[3] / right.P[0], 0.25, 1e-9);  // baseline
  EXPECT_EQ(right.K[0], 60);
}

TEST_F(Euroc, ReportsImagesWithoutPartner) {
  write_tree();
  write("e/cam0/data/1403715273362142976.png", noise_pair(kSize, 3).left);
  write("e/cam1/data/1403715273212142976.png", noise_pair(kSize, 3).right);
  const Outcome run = create(at("e"));
  EXPECT_EQ(run.code, 0);
  EXPECT_NE(run.err.find("1403715273362142976.png is skipped: cam1"), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("1403715273212142976.png is skipped: cam0"), std::string::npos) << run.err;
  EXPECT_EQ(stamps().size(), 2U);
}

TEST_F(Euroc, RefusesInvalidFiles) {
  expect_refused({at("e/cam0/sensor.yaml")});  // missing
  write_tree();
  write_text("e/cam1/sensor.yaml", sensor(0.35, "equidistant"));
  expect_refused({at("e/cam1/sensor.yaml"), "distortion_model", "\"equidistant\""});
  write_text("e/cam1/sensor.yaml", "camera_model: pinhole\ndistortion_model: radtan\n");
  expect_refused({at("e/cam1/sensor.yaml"), "resolution is missing"});
  std::string text = sensor(0.35);
  const auto expect_refused_with = [&](const std::string& from, const std::string& to,
                                       const std::string& words) {
    std::string changed = text;
    ASSERT_NE(changed.find(from), std::string::npos) << from;
    write_text("e/cam1/sensor.yaml", changed.replace(changed.find(from), from.size(), to));
    expect_refused({at("e/cam1/sensor.yaml") + ": " + words});
  };
  expect_refused_with("cols: 4", "cols: 500000000", "T_BS.cols = \"500000000\": allowed is 4");
  expect_refused_with("resolution: [64", "resolution: [1e99",
                      "resolution is 1e+99x48: allowed are 1x1 to 65535x65535");
  write_text("e/cam1/sensor.yaml", "a: [1, 2");
  expect_refused({at("e/cam1/sensor.yaml")});
  write_text("e/cam1/sensor.yaml", sensor(0.35));
  write("e/cam1/data/first.png", noise_pair(kSize, 3).right);
  expect_refused({at("e/cam1/data/first.png"), "nanoseconds"});
}

TEST_F(Euroc, RealSequence) {
  const std::string folder = test_data("sequence");
  if (folder.empty()) GTEST_SKIP() << "the test images have no folder sequence";
  const Outcome run = create(folder);
  ASSERT_EQ(run.code, 0) << run.err;
  ASSERT_EQ(make_bag({"extract", at("out.bag"), at("out")}).code, 0);
  const sensor_msgs::CameraInfo left = read_camera_info_message(at("out/left.yaml"));
  const sensor_msgs::CameraInfo right = read_camera_info_message(at("out/right.yaml"));
  EXPECT_NEAR(left.P[0], 436.23, 0.01);
  EXPECT_NEAR(left.P[2], 364.44, 0.01);
  EXPECT_NEAR(left.P[6], 256.95, 0.01);
  EXPECT_NEAR(-right.P[3] / right.P[0], 0.11008, 1e-5);
  const auto list = list_images("", {folder + "/cam0/data"});
  EXPECT_EQ(stamps().size(), list.size());
  EXPECT_TRUE(equal(cv::imread(at("out/left/000000.png"), cv::IMREAD_UNCHANGED),
                    cv::imread(list[0], cv::IMREAD_UNCHANGED)));
  // match on the extracted files: most pixels get a disparity between 15 and 45 px.
  ASSERT_EQ(match({at("out/left/000000.png"), at("out/right/000000.png"), at("out.pfm"),
                   "--left-info", at("out/left.yaml"), "--right-info", at("out/right.yaml")})
                .code,
            0);
  const cv::Mat1f disparity = cv::imread(at("out.pfm"), cv::IMREAD_UNCHANGED);
  const int valid = cv::countNonZero(disparity < 1000);
  const int usual = cv::countNonZero((disparity >= 15) & (disparity <= 45));
  EXPECT_GT(valid, static_cast<int>(disparity.total()) / 2);
  EXPECT_GT(usual, valid * 9 / 10);
}

}  // namespace
}  // namespace fpga_stereo::tools
