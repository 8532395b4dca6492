// Compares fs_top with the reference pipeline at its intended size and search range: VGA with 64
// disparities.
#include <gtest/gtest.h>

#include "support/data.hpp"
#include "top_rig.hpp"

namespace fpga_stereo::test {
namespace {

TEST(RtlTop, EqualsSoftwareAtVgaWith64Disparities) {
  const TopBuild build =
      top_build("vga", "640_64_11_15_0_102_5120", 64, 11, CensusPattern::kSparse, 15);
  const cv::Size size(640, 480);
  TopCase c;
  c.parameters.disparity_range = 64;
  if (data_dir()) {
    const CalibrationPair calibration = chessboard_calibration();
    const auto rectification = make_stereo_rectification(calibration.left, calibration.right, 0);
    ASSERT_TRUE(rectification) << rectification.error().message;
    const ImagePair pair = chessboard_pair(1);
    c.rectification = *rectification;
    c.pairs = {{pair.left, pair.right}};
    c.about = "chessboard";
  } else {
    c.rectification = distorted_rectification(size, 1);
    c.pairs = textured_pairs(size, 1, 1, 20);
    c.about = "texture";
  }
  sim::Gateware gateware = open_gateware(build);
  const auto frames = expect_equal(gateware, c);
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].last_out - frames[0].first_out, size.area() - 1);
  EXPECT_GT(cv::countNonZero(frames[0].disparity != kNoDisparity), size.area() / 50);
}

}  // namespace
}  // namespace fpga_stereo::test
