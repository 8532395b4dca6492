// Test fixture of the command-line programs, which run as child processes.
#pragma once

#include <gtest/gtest.h>
#include <sensor_msgs/CameraInfo.h>

#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace fpga_stereo::tools {

struct Outcome {
  int code = 0;  // exit code; 128 + signal if it was killed
  std::string out, err;
};

/// A test with an empty temporary folder.
class ProgramTest : public testing::Test {
 protected:
  ProgramTest();
  ~ProgramTest() override;

  /// Returns a path in the temporary folder.
  std::string at(const std::string& name) const { return folder_ + "/" + name; }
  bool exists(const std::string& name) const;

  Outcome match(const std::vector<std::string>& arguments) const;
  Outcome simulate(const std::vector<std::string>& arguments) const;
  Outcome evaluate(const std::vector<std::string>& arguments) const;
  Outcome make_bag(const std::vector<std::string>& arguments) const;

  /// Runs any program.
  Outcome run(const std::string& program, const std::vector<std::string>& arguments) const;

  /// Expects this exit code and a message of `program` that contains all `parts`.
  static void expect_refused(const std::string& program, const Outcome& run, int code,
                             const std::vector<std::string>& parts);

  /// Writes an image. Returns its path.
  std::string write(const std::string& name, const cv::Mat& image) const;
  /// Writes a text file. Returns its path.
  std::string write_text(const std::string& name, const std::string& text) const;
  /// Writes a camera_info file. Returns its path.
  std::string write_info(const std::string& name, const sensor_msgs::CameraInfo& info) const;

 private:
  std::string folder_;
};

/// Returns the bytes of a file. The test fails if it cannot be read.
std::string bytes(const std::string& path);

/// Returns the text of a help without its line breaks and indentation.
std::string on_one_line(const std::string& text);

/// Returns whether two images have equal size, type and values.
bool equal(const cv::Mat& a, const cv::Mat& b);

/// Returns the path of a folder of test images; empty if it does not exist.
std::string test_data(const std::string& name);

/// A noise pair with constant disparity: left pixel (x, y) equals right pixel (x - disparity, y).
struct NoisePair {
  cv::Mat1b left, right;
};
NoisePair noise_pair(cv::Size size, int disparity, int seed = 1);

/// Two cameras with distortion and different orientation.
struct InfoPair {
  sensor_msgs::CameraInfo left, right;
};
InfoPair distorted_cameras(cv::Size size);

}  // namespace fpga_stereo::tools
