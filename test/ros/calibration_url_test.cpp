// The URLs of calibration files.
#include "ros/calibration_url.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "link/test_folder.hpp"
#include "ros/calibration_store.hpp"
#include "ros/conversions.hpp"
#include "ros/rig.hpp"

namespace fpga_stereo::test {
namespace {

namespace fs = std::filesystem;

/// Returns the path that the URL of a camera names, or the error message.
std::string path_of(const std::string& url) {
  const auto path = path_of_url(url, "stereo_left");
  return path ? *path : path.error().message;
}

TEST(CalibrationUrl, NamesAPath) {
  EXPECT_EQ(path_of("file:///a/left.yaml"), "/a/left.yaml");
  EXPECT_EQ(path_of("/a/b c.yaml"), "/a/b c.yaml");
  EXPECT_EQ(path_of("file:///a/${NAME}_${NAME}.yaml"), "/a/stereo_left_stereo_left.yaml");
  const char* home = std::getenv("ROS_HOME");
  const std::string folder = home != nullptr ? home : std::getenv("HOME") + std::string("/.ros");
  EXPECT_EQ(path_of("file://${ROS_HOME}/left.yaml"), folder + "/left.yaml");
}

TEST(CalibrationUrl, RefusesOtherUrls) {
  const std::string allowed =
      ": allowed are file:///PATH, package://PACKAGE/PATH and absolute paths";
  for (const std::string url : {"", "left.yaml", "file://left.yaml", "http://camera/left.yaml",
                                "flash:///left.yaml", "FILE:///a/left.yaml", "$(left)"}) {
    EXPECT_EQ(path_of(url), url + allowed);
  }
  EXPECT_EQ(path_of("\x1b[2J"), "\\x1b[2J" + allowed);
}

TEST(CalibrationUrl, RefusesNamesThatAreNotPackages) {
  for (const std::string package : {"no_such_package", "", "..", "a b", "--help", "$(id)", "a;b"}) {
    EXPECT_EQ(path_of("package://" + package + "/left.yaml"),
              "package://" + package + "/left.yaml: there is no package " + package);
  }
  EXPECT_EQ(path_of("package://roscpp"), "package://roscpp: there is no package roscpp");
}

TEST(CalibrationUrl, IsNotRunByAShell) {
  const TestFolder top;
  const std::string mark = top / "executed";
  const PairMessages pair = synthetic_pair({64, 48}, 3);
  const auto left = to_calibration(pair.left_info, "left");
  const auto right = to_calibration(pair.right_info, "right");
  ASSERT_TRUE(left && right);
  for (const auto& [before, after] : {std::pair("x;touch ", ";"),
                                      {"$(touch ", ")"},
                                      {"`touch ", "`"},
                                      {"x'; touch ", "; '"},
                                      {"x\"; touch ", "; \""},
                                      {"x|touch ", ""},
                                      {"x\ntouch ", "\n"}}) {
    const std::string folder = top / (before + mark + after);
    CalibrationStore store("stereo_",
                           {"file://" + folder + "/${NAME}.yaml", folder + "/${NAME}.yaml"});
    EXPECT_EQ(store.load().size(), 2U);
    ASSERT_TRUE(store.set(Side::kLeft, *left, {64, 48}));
    const auto stored = store.set(Side::kRight, *right, {64, 48});
    ASSERT_TRUE(stored) << stored.error().message;
    EXPECT_TRUE(fs::exists(folder + "/stereo_left.yaml")) << "a folder of this name";
    EXPECT_FALSE(fs::exists(mark)) << folder;
  }
}

}  // namespace
}  // namespace fpga_stereo::test
