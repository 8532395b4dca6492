#include "fpga_stereo/core/camera_info_yaml.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

namespace fpga_stereo::test {
namespace {

// As cameracalibrator.py writes it.
constexpr const char* kFile = R"(image_width: 640
image_height: 480
camera_name: stereo/left
camera_matrix:
  rows: 3
  cols: 3
  data: [430.5, 0, 306.25, 0, 431, 227, 0, 0, 1]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [-0.3, 0.08, 0.0006, 0, -1e-3]
rectification_matrix:
  rows: 3
  cols: 3
  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]
projection_matrix:
  rows: 3
  cols: 4
  data: [392, 0, 311, -47.5,
         0, 392, 228, 0,
         0, 0, 1, 0]
)";

/// The file with the first `from` replaced by `to`.
std::string changed(const std::string& from, const std::string& to) {
  std::string text = kFile;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

/// Expects `text` to be refused with `message`.
void expect_error(const std::string& text, const std::string& message) {
  const auto read = parse_camera_info(text, "left.yaml");
  ASSERT_FALSE(read) << "not refused; expected: " << message;
  EXPECT_EQ(read.error().kind, ErrorKind::kCalibration);
  EXPECT_EQ(read.error().message, "left.yaml: " + message);
}

TEST(CameraInfoYaml, ReadsWhatCameracalibratorWrites) {
  const auto camera = parse_camera_info(kFile, "left.yaml");
  ASSERT_TRUE(camera) << camera.error().message;
  EXPECT_EQ(camera->width, 640);
  EXPECT_EQ(camera->height, 480);
  EXPECT_EQ(camera->distortion_model, "plumb_bob");
  EXPECT_EQ(camera->D, (std::vector<double>{-0.3, 0.08, 0.0006, 0, -1e-3}));
  EXPECT_EQ(camera->K, (std::array<double, 9>{430.5, 0, 306.25, 0, 431, 227, 0, 0, 1}));
  EXPECT_EQ(camera->R, (std::array<double, 9>{1, 0, 0, 0, 1, 0, 0, 0, 1}));
  EXPECT_EQ(camera->P, (std::array<double, 12>{392, 0, 311, -47.5, 0, 392, 228, 0, 0, 0, 1, 0}));
  EXPECT_EQ(camera->binning_x, 0);
  EXPECT_EQ(camera->roi, cv::Rect());
  EXPECT_TRUE(validate(*camera, "left"));
}

TEST(CameraInfoYaml, ReadsOptionalKeys) {
  const auto camera = parse_camera_info(
      std::string(kFile) +
          "binning_x: 2\nbinning_y: 1\n"
          "roi: {x_offset: 8, y_offset: 4, width: 320, height: 240, do_rectify: false}\n",
      "left.yaml");
  ASSERT_TRUE(camera) << camera.error().message;
  EXPECT_EQ(camera->binning_x, 2);
  EXPECT_EQ(camera->binning_y, 1);
  EXPECT_EQ(camera->roi, cv::Rect(8, 4, 320, 240));
}

TEST(CameraInfoYaml, DefaultsToPlumbBob) {
  const auto camera = parse_camera_info(changed("distortion_model: plumb_bob\n", ""), "left.yaml");
  ASSERT_TRUE(camera) << camera.error().message;
  EXPECT_EQ(camera->distortion_model, "plumb_bob");
}

TEST(CameraInfoYaml, AcceptsNoDistortionCoefficients) {
  const std::string text =
      changed("cols: 5\n  data: [-0.3, 0.08, 0.0006, 0, -1e-3]", "cols: 0\n  data: []");
  const auto camera = parse_camera_info(text, "left.yaml");
  ASSERT_TRUE(camera) << camera.error().message;
  EXPECT_TRUE(camera->D.empty());
}

TEST(CameraInfoYaml, AcceptsDistortionCoefficientsInOneColumn) {
  const auto camera =
      parse_camera_info(changed("rows: 1\n  cols: 5", "rows: 5\n  cols: 1"), "left.yaml");
  ASSERT_TRUE(camera) << camera.error().message;
  EXPECT_EQ(camera->D.size(), 5U);
}

TEST(CameraInfoYaml, RefusesEveryMissingKey) {
  for (const std::string key :
       {"image_width", "image_height", "camera_matrix", "distortion_coefficients",
        "rectification_matrix", "projection_matrix"}) {
    expect_error(changed(key + ":", "other:"), key + " is missing");
  }
  expect_error(changed("rows:", "other:"), "camera_matrix.rows is missing");
  expect_error(changed("cols:", "other:"), "camera_matrix.cols is missing");
  expect_error(changed("data:", "other:"), "camera_matrix.data is missing");
}

TEST(CameraInfoYaml, RefusesSizesOutOfRange) {
  const std::string allowed = ": allowed are whole numbers from 1 to 65535";
  for (const std::string value : {"0", "-640", "65536", "640.5", "99999999999999999999", "wide"}) {
    expect_error(changed("image_width: 640", "image_width: " + value),
                 "image_width = \"" + value + "\"" + allowed);
  }
  expect_error(changed("image_width: 640", "image_width:"), "image_width = (empty)" + allowed);
  expect_error(changed("image_width: 640", "image_width: [640]"),
               "image_width = (a list)" + allowed);
  expect_error(std::string(kFile) + "binning_x: -1\n",
               "binning_x = \"-1\": allowed are whole numbers from 0 to 65535");
  expect_error(std::string(kFile) + "roi: {x_offset: -1}\n",
               "roi.x_offset = \"-1\": allowed are whole numbers from 0 to 65535");
  expect_error(std::string(kFile) + "roi: 5\n", "roi = \"5\": allowed is a mapping");
}

TEST(CameraInfoYaml, RefusesMatricesOfOtherShape) {
  expect_error(changed("rows: 3", "rows: 4"), "camera_matrix.rows = \"4\": allowed is 3");
  expect_error(changed("cols: 4", "cols: 3"), "projection_matrix.cols = \"3\": allowed is 4");
  expect_error(changed("306.25, 0, ", "306.25, "),
               "camera_matrix.data has 8 values: rows = 3 and cols = 3 require 9");
  expect_error(changed("cols: 5", "cols: 8"),
               "distortion_coefficients.data has 5 values: rows = 1 and cols = 8 require 8");
  expect_error(changed("cols: 5", "cols: 15"),
               "distortion_coefficients.cols = \"15\": allowed are whole numbers from 0 to 14");
  expect_error(changed("rows: 1\n  cols: 5", "rows: 2\n  cols: 5"),
               "distortion_coefficients.cols = \"5\": allowed are whole numbers from 0 to 1");
  expect_error(changed("camera_matrix:", "camera_matrix: 7\nother:"),
               "camera_matrix = \"7\": allowed is a mapping");
  expect_error(changed("[430.5, 0, 306.25, 0, 431, 227, 0, 0, 1]", "{a: 1}"),
               "camera_matrix.data = (a mapping): allowed is a list of numbers");
}

TEST(CameraInfoYaml, RefusesValuesThatAreNotNumbers) {
  for (const std::string value : {".nan", ".inf", "-.inf", "wide", "\"\""}) {
    const std::string quoted = value == "\"\"" ? value : "\"" + value + "\"";
    expect_error(changed("306.25", value),
                 "camera_matrix.data[2] = " + quoted + ": allowed are finite numbers");
  }
  expect_error(
      changed("306.25", std::string(100, 'x')),
      "camera_matrix.data[2] = \"" + std::string(40, 'x') + "...\": allowed are finite numbers");
  expect_error(changed("plumb_bob", "[plumb_bob]"),
               "distortion_model = (a list): allowed is a name");
}

TEST(CameraInfoYaml, RefusesFilesThatAreNotCameraInfo) {
  const std::string expected =
      "is not a camera_info file: it must be a YAML mapping with the keys image_width, "
      "image_height, "
      "camera_matrix, distortion_coefficients, rectification_matrix and projection_matrix";
  for (const std::string text : {"", "hello", "[1, 2]", "# a comment"})
    expect_error(text, expected);
  expect_error(std::string(64 * 1024 + 1, ' '), "is larger than 65536 bytes, the limit");
  const auto read = parse_camera_info("a: [1, 2", "left.yaml");
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().message.rfind("left.yaml: is not valid YAML: ", 0), 0U)
      << read.error().message;
}

TEST(CameraInfoYaml, NeverFailsOtherwiseOnTruncatedFiles) {
  const std::string text = kFile;
  for (std::size_t length = 0; length + 2 < text.size(); ++length) {
    EXPECT_FALSE(parse_camera_info(text.substr(0, length), "left.yaml")) << length << " bytes";
  }
}

TEST(CameraInfoYaml, RefusesDeepNesting) {
  const std::string expected = "is nested more deeply than 16 levels, the limit";
  const auto repeated = [](const std::string& text) {
    std::string all;
    while (all.size() < 60000) all += text;
    return all;
  };
  for (const std::string level : {"[", "{a: ", "- ", "? ", "[a: ", "[? ", "[[", "!!seq ["}) {
    expect_error(repeated(level), expected);
    expect_error(std::string(kFile) + "other: " +
                     (level[0] == '-' || level[0] == '?' ? "\n  " : "") + repeated(level),
                 expected);
  }
  std::string indented;
  for (int level = 0; indented.size() < 60000; ++level) {
    indented += std::string(static_cast<std::size_t>(level), ' ') + "a:\n";
  }
  expect_error(indented, expected);
  const std::string allowed(15, '[');
  EXPECT_TRUE(parse_camera_info(std::string(kFile) + "other: " + allowed + std::string(15, ']'),
                                "left.yaml"));
}

TEST(CameraInfoYaml, RefusesAliases) {
  expect_error(changed("rectification_matrix:", "a: &a [1, 1]\nb: &b [*a, *a]\nother:"),
               "has an alias (*), which is not allowed");
  expect_error("&a [*a]", "has an alias (*), which is not allowed");
}

TEST(CameraInfoYaml, RefusesHugeMatricesBeforeItReadsThem) {
  expect_error(changed("cols: 3", "cols: 500000000"),
               "camera_matrix.cols = \"500000000\": allowed is 3");
  expect_error(changed("rows: 3", "rows: 2"), "camera_matrix.rows = \"2\": allowed is 3");
  expect_error(changed("cols: 5", "cols: 500000000"),
               "distortion_coefficients.cols = \"500000000\": allowed are whole numbers from 0 to "
               "14");
}

TEST(CameraInfoYaml, EscapesWhatATerminalWouldObey) {
  expect_error(changed("306.25", "\"\\e[2J\""),
               "camera_matrix.data[2] = \"\\x1b[2J\": allowed are finite numbers");
}

CameraCalibration some_camera() {
  CameraCalibration camera;
  camera.width = 752;
  camera.height = 480;
  camera.distortion_model = "plumb_bob";
  camera.D = {-0.283, 0.1, 1.0 / 3, 1e-300, 0};
  camera.K = {458.654, 0, 367.215, 0, 457.296, 248.375, 0, 0, 1};
  camera.R = {0.9999663475300330, -0.0014225824427, 0.008077, 0.1, 0.2, 0.3, -0.1, 2.0 / 3, 1};
  camera.P = {
      435.2046959714599, 0, 367.4517211914062, -47.90639384423901, 0, 1e22, 252.2, 0, 0, 0, 1, 0};
  return camera;
}

TEST(CameraInfoYaml, WritesWhatItReads) {
  CameraCalibration camera = some_camera();
  const auto text = format_camera_info(camera, "stereo_left");
  ASSERT_TRUE(text) << text.error().message;
  EXPECT_EQ(*text, R"(image_width: 752
image_height: 480
camera_name: stereo_left
camera_matrix:
  rows: 3
  cols: 3
  data: [458.654, 0, 367.215, 0, 457.296, 248.375, 0, 0, 1]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [-0.283, 0.1, 0.3333333333333333, 1e-300, 0]
rectification_matrix:
  rows: 3
  cols: 3
  data: [0.999966347530033, -0.0014225824427, 0.008077, 0.1, 0.2, 0.3, -0.1, 0.6666666666666666, 1]
projection_matrix:
  rows: 3
  cols: 4
  data: [435.2046959714599, 0, 367.4517211914062, -47.90639384423901, 0, 1e+22, 252.2, 0, 0, 0, 1, 0]
)");
  EXPECT_EQ(*parse_camera_info(*text, ""), camera);
  camera.binning_x = 2;
  camera.binning_y = 1;
  camera.roi = {8, 4, 320, 240};
  camera.D.clear();
  EXPECT_EQ(*parse_camera_info(*format_camera_info(camera, ""), ""), camera);
}

TEST(CameraInfoYaml, WritesAnyName) {
  CameraCalibration camera = some_camera();
  for (const std::string name :
       {"", "a: b", "- c", "#d", "e\nimage_width: 1", "'f'", "\"g\"", "\t"}) {
    camera.distortion_model = name;
    const auto text = format_camera_info(camera, name);
    ASSERT_TRUE(text) << name << ": " << text.error().message;
    EXPECT_EQ(*parse_camera_info(*text, ""), camera) << *text;
  }
  camera.distortion_model = "\"\xff\"";
  const auto refused = format_camera_info(camera, "left");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message,
            "camera_info of left: YAML cannot represent its distortion_model \"\"\\xff\"\"");
}

TEST(CameraInfoYaml, DoesNotWriteWhatItWouldRefuse) {
  CameraCalibration camera = some_camera();
  camera.K[2] = std::nan("");
  const auto nan = format_camera_info(camera, "left");
  ASSERT_FALSE(nan);
  EXPECT_EQ(nan.error().message,
            "camera_info of left: camera_matrix.data[2] = \"nan\": allowed are finite numbers");
  camera = some_camera();
  camera.width = 0;
  EXPECT_FALSE(format_camera_info(camera, "left"));
  camera = some_camera();
  camera.D.resize(15);
  EXPECT_FALSE(format_camera_info(camera, "left"));
}

TEST(CameraInfoYaml, ReadsFiles) {
  char path[] = "/tmp/camera_info_yaml_XXXXXX";
  const int descriptor = mkstemp(path);
  ASSERT_GE(descriptor, 0);
  close(descriptor);
  std::ofstream(path) << kFile;
  const auto camera = read_camera_info(path);
  ASSERT_TRUE(camera) << camera.error().message;
  EXPECT_EQ(camera->width, 640);
  std::ofstream(path) << std::string(200000, '#');
  const auto large = read_camera_info(path);
  ASSERT_FALSE(large);
  EXPECT_EQ(large.error().message, std::string(path) + ": is larger than 65536 bytes, the limit");
  std::remove(path);

  const auto missing = read_camera_info(path);
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().kind, ErrorKind::kInvalid);
  EXPECT_EQ(missing.error().message,
            std::string(path) + ": cannot be read: No such file or directory");
  const auto directory = read_camera_info("/tmp");
  ASSERT_FALSE(directory);
  EXPECT_EQ(directory.error().message, "/tmp: cannot be read: Is a directory");
}

}  // namespace
}  // namespace fpga_stereo::test
