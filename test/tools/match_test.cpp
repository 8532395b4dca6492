// The output of match.
#include <algorithm>
#include <cstring>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>

#include "core/reference_pipeline.hpp"
#include "fpga_stereo/core/convert.hpp"
#include "programs.hpp"
#include "ros/conversions.hpp"

namespace fpga_stereo::tools {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
const cv::Size kSize(97, 61);

StereoRectification identity(int min_disparity) {
  StereoGeometry geometry;
  geometry.image_size = kSize;
  return identity_rectification(geometry, min_disparity);
}

cv::Mat1w expected(const NoisePair& pair, const StereoRectification& rectification,
                   const Parameters& parameters) {
  ReferencePipeline pipeline;
  return pipeline.process(pair.left, pair.right, rectification, parameters, 1).disparity.clone();
}

/// Reads a PFM file: text header, rows from bottom to top, little-endian.
cv::Mat1f read_pfm(const std::string& path) {
  const std::string file = bytes(path);
  int width = 0, height = 0, header = 0;
  double scale = 0;
  EXPECT_EQ(std::sscanf(file.c_str(), "Pf\n%d %d\n%lf%n", &width, &height, &scale, &header), 3);
  EXPECT_EQ(scale, -1);
  cv::Mat1f image(height, width);
  EXPECT_EQ(file.size(), header + 1 + image.total() * sizeof(float));
  if (testing::Test::HasFailure()) return image;
  const char* row = file.data() + header + 1;
  for (int y = height - 1; y >= 0; --y, row += width * sizeof(float)) {
    std::memcpy(image[y], row, width * sizeof(float));
  }
  return image;
}

class Match : public ProgramTest {
 protected:
  Match() : pair_(noise_pair(kSize, 7)) {
    left_ = write("left.png", pair_.left);
    right_ = write("right.png", pair_.right);
  }

  NoisePair pair_;
  std::string left_, right_;
};

TEST_F(Match, PngEqualsThePipeline) {
  Parameters parameters = window_parameters();
  parameters.min_disparity = -3;
  parameters.disparity_range = 32;
  parameters.census_pattern = CensusPattern::kFull;
  parameters.subpixel = false;
  parameters.speckle_size = 10;
  const Outcome run = match({left_, right_, at("out.png"), "--stereo_algorithm", "window",
                             "--min_disparity", "-3", "--disparity_range", "32", "--census_pattern",
                             "full", "--subpixel", "false", "--speckle_size=10"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(run.out + run.err, "");
  const cv::Mat written = cv::imread(at("out.png"), cv::IMREAD_UNCHANGED);
  const cv::Mat1w disparity = expected(pair_, identity(-3), parameters);
  EXPECT_TRUE(equal(written, disparity));
  EXPECT_EQ(disparity(30, 50), 10 * kDisparityScale);  // 7 - min_disparity
  EXPECT_GT(cv::countNonZero(disparity == kNoDisparity), 0);
}

TEST_F(Match, PfmIsInPixelsWithInfinity) {
  Parameters parameters;
  parameters.min_disparity = 2;
  ASSERT_EQ(
      match({left_, right_, at("out.pfm"), "--min_disparity", "2", "--subpixel", "true"}).code, 0);
  const cv::Mat1w disparity = expected(pair_, identity(2), parameters);
  const cv::Mat1f written = read_pfm(at("out.pfm"));
  ASSERT_EQ(written.size(), kSize);
  int holes = 0;
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      const bool hole = disparity(y, x) == kNoDisparity;
      holes += hole;
      ASSERT_EQ(written(y, x), hole ? kInfinity : 2 + disparity(y, x) / 32.0F) << x << ", " << y;
    }
  }
  EXPECT_GT(holes, 0);
  EXPECT_NEAR(written(30, 50), 7, 0.5);
  EXPECT_TRUE(equal(cv::imread(at("out.pfm"), cv::IMREAD_UNCHANGED), written));
}

TEST_F(Match, IsDeterministicForAnyNumberOfThreads) {
  for (const std::string extension : {".png", ".pfm"}) {
    std::string first;
    for (const std::string threads : {"1", "2", "5", "1", "5"}) {
      const std::string out = at("out" + extension);
      ASSERT_EQ(match({left_, right_, out, "--threads", threads}).code, 0);
      if (first.empty()) first = bytes(out);
      EXPECT_EQ(bytes(out), first) << extension << ", threads " << threads;
    }
  }
}

TEST_F(Match, ColorPicture) {
  ASSERT_EQ(match({left_, right_, at("out.png"), "--color", at("color.png")}).code, 0);
  cv::Mat3b picture;
  to_color(expected(pair_, identity(0), {}), Parameters{}.disparity_range, picture);
  EXPECT_TRUE(equal(cv::imread(at("color.png")), picture));
}

TEST_F(Match, ConvertsColorImagesLikeTheNode) {
  cv::Mat3b left(kSize), right(kSize);
  cv::randu(left, 0, 256);
  cv::randu(right, 0, 256);
  NoisePair grey;
  cv::cvtColor(left, grey.left, cv::COLOR_BGR2GRAY);
  cv::cvtColor(right, grey.right, cv::COLOR_BGR2GRAY);
  ASSERT_EQ(match({write("l.png", left), write("r.ppm", right), at("out.png"), "--uniqueness_check",
                   "false", "--speckle_size", "0"})
                .code,
            0);
  Parameters parameters;
  parameters.uniqueness_check = false;
  parameters.speckle_size = 0;
  EXPECT_TRUE(equal(cv::imread(at("out.png"), cv::IMREAD_UNCHANGED),
                    expected(grey, identity(0), parameters)));
}

TEST_F(Match, RectifiesWithCameraInfo) {
  const InfoPair infos = distorted_cameras(kSize);
  for (const int min_disparity : {0, 4}) {
    const auto rectification = make_stereo_rectification(
        *to_calibration(infos.left, "left"), *to_calibration(infos.right, "right"), min_disparity);
    ASSERT_TRUE(rectification) << rectification.error().message;
    const Outcome run =
        match({left_, right_, at("out.png"), "--left-info", write_info("left.yaml", infos.left),
               "--right-info", write_info("right.yaml", infos.right), "--min_disparity",
               std::to_string(min_disparity), "--uniqueness_check", "false", "--speckle_size", "0",
               "--verbose"});
    ASSERT_EQ(run.code, 0) << run.err;
    Parameters parameters;
    parameters.min_disparity = min_disparity;
    parameters.uniqueness_check = false;
    parameters.speckle_size = 0;
    EXPECT_TRUE(equal(cv::imread(at("out.png"), cv::IMREAD_UNCHANGED),
                      expected(pair_, *rectification, parameters)));
    EXPECT_NE(run.err.find("right mesh: deviates from the exact map by at most 0.0"),
              std::string::npos)
        << run.err;
    EXPECT_NE(run.err.find("needs a line buffer of "), std::string::npos) << run.err;
  }
}

TEST_F(Match, ComputesDense) {
  Parameters parameters;
  parameters.disparity_range = 16;
  parameters.sgm_build = SgmBuild::kSmall;
  parameters.dense = true;
  const Outcome run = match({left_, right_, at("out.png"), "--disparity_range", "16", "--sgm_build",
                             "small", "--dense", "true"});
  ASSERT_EQ(run.code, 0) << run.err;
  const cv::Mat1w written = cv::imread(at("out.png"), cv::IMREAD_UNCHANGED);
  EXPECT_TRUE(equal(written, expected(pair_, identity(0), parameters)));
  EXPECT_EQ(cv::countNonZero(written == kNoDisparity), 0);
}

TEST_F(Match, VerbosePrintsTheTimesOfTheStagesThatRan) {
  const auto stages = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{left_, right_, at("out.png"), "--verbose"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome run = match(arguments);
    EXPECT_EQ(run.code, 0) << run.err;
    EXPECT_EQ(run.out, "");
    std::string found;
    std::istringstream lines(run.err);
    for (std::string line; std::getline(lines, line);) {
      const std::string word = line.substr(0, line.find(' '));
      const bool is_stage =
          std::find(kStageNames.begin(), kStageNames.end(), word) != kStageNames.end();
      if (is_stage) found += word + " ";
    }
    return found;
  };
  EXPECT_EQ(stages({}), "rectify census cost aggregate select check subpixel speckle ");
  EXPECT_EQ(stages({"--stereo_algorithm", "window", "--dense", "true"}),
            "rectify census match select check subpixel speckle fill median ");
}

}  // namespace
}  // namespace fpga_stereo::tools
