// For tests of the command-line programs: they run as child processes in a folder of their own.
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

  /// A path in the temporary folder.
  std::string at(const std::string& name) const { return folder_ + "/" + name; }
  bool exists(const std::string& name) const;

  Outcome match(const std::vector<std::string>& arguments) const;
  Outcome simulate(const std::vector<std::string>& arguments) const;
  Outcome evaluate(const std::vector<std::string>& arguments) const;
  Outcome make_bag(const std::vector<std::string>& arguments) const;

  /// Any program.
  Outcome run(const std::string& program, const std::vector<std::string>& arguments) const;

  /// `program` has refused with this exit code and a message that has all of `parts`.
  static void expect_refused(const std::string& program, const Outcome& run, int code,
                             const std::vector<std::string>& parts);

  /// Writes an image and gives its path.
  std::string write(const std::string& name, const cv::Mat& image) const;
  /// Writes text and gives the path.
  std::string write_text(const std::string& name, const std::string& text) const;
  /// Writes camera_info as YAML and gives its path.
  std::string write_info(const std::string& name, const sensor_msgs::CameraInfo& info) const;

 private:
  std::string folder_;
};

/// The bytes of a file; a failure of the test if it cannot be read.
std::string bytes(const std::string& path);

/// Every value and type.
bool equal(const cv::Mat& a, const cv::Mat& b);

/// The folder of the test images called `name`; empty where it is absent.
std::string test_data(const std::string& name);

/// Noise, and the same moved: left pixel (x, y) is right pixel (x - disparity, y).
struct NoisePair {
  cv::Mat1b left, right;
};
NoisePair noise_pair(cv::Size size, int disparity, int seed = 1);

/// A pair of cameras with distortion and different orientation.
struct InfoPair {
  sensor_msgs::CameraInfo left, right;
};
InfoPair distorted_cameras(cv::Size size);

}  // namespace fpga_stereo::tools
