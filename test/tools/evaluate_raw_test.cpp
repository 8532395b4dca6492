// evaluate_raw: its measures on data of known answers, and the program on small folders.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <sstream>

#include "evaluate_raw/collectors.hpp"
#include "fpga_stereo/core/spec.hpp"
#include "programs.hpp"

namespace fpga_stereo::tools {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

TEST(MatchBrightness, UndoesGainAndOffset) {
  const cv::Mat1b left = (cv::Mat1b(1, 5) << 50, 60, 75, 90, 100);
  const cv::Mat1b right = (cv::Mat1b(1, 5) << 5, 7, 10, 13, 15);  // (left - 25) / 5
  const cv::Mat1f matched = match_brightness(left, right);
  for (int x = 0; x < left.cols; ++x) EXPECT_NEAR(matched(0, x), left(0, x), 1e-4);
  const cv::Mat1f flat = match_brightness(left, cv::Mat1b(1, 5, std::uint8_t{3}));
  for (const float value : flat) EXPECT_NEAR(value, 75, 1e-4);
}

TEST(PredictionError, InterpolatesTheRightImage) {
  const cv::Mat1f right = (cv::Mat1f(1, 6) << 0, 10, 30, 60, 100, 150);
  const cv::Mat1b left(1, 6, std::uint8_t{20});
  const cv::Mat1f disparity = (cv::Mat1f(1, 6) << 0, kNone, 0.5F, 3, 3.25F, -0.25F);
  const cv::Mat1f error = prediction_error(left, right, disparity);
  EXPECT_EQ(error(0, 0), 20);            // right(0) = 0
  EXPECT_TRUE(std::isnan(error(0, 1)));  // no disparity
  EXPECT_EQ(error(0, 2), 0);             // right(1.5) = 20
  EXPECT_EQ(error(0, 3), 20);            // right(0) = 0
  EXPECT_EQ(error(0, 4), 12.5);          // right(0.75) = 7.5
  EXPECT_TRUE(std::isnan(error(0, 5)));  // right(5.25) is outside
  EXPECT_EQ(prediction_error(left, right, cv::Mat1f(1, 6, 0.0F))(0, 5), 130);
  EXPECT_TRUE(std::isnan(prediction_error(left, right, cv::Mat1f(1, 6, 3.5F))(0, 3)));
}

TEST(Values, MeanAndLowerMedian) {
  Values values;
  EXPECT_TRUE(std::isnan(values.mean()));
  EXPECT_TRUE(std::isnan(values.median()));
  values.add((cv::Mat1f(1, 4) << 8, kNone, 1, 2));
  values.add((cv::Mat1f(1, 2) << 5, kNone));
  EXPECT_EQ(values.mean(), 4);
  EXPECT_EQ(values.median(), 2);
}

TEST(Predictions, CommonPixelsAreThoseOfEveryContender) {
  constexpr std::uint16_t kHole = kNoDisparity;
  Images images;
  images.left = (cv::Mat1b(1, 4) << 10, 20, 30, 40);
  images.right = images.left.clone();
  Predictions predictions(2, 1);  // the search begins at 1 px
  // Pixel x is predicted from x - 1 or x - 2; the first contender errs by 10, then by 20.
  predictions.add(images,
                  {(cv::Mat1w(1, 4) << 0, 0, kHole, 32), (cv::Mat1w(1, 4) << kHole, kHole, 0, 0)});
  EXPECT_EQ(predictions.values(0), (std::vector<double>{75, 15, 10, 20, 20}));
  EXPECT_EQ(predictions.values(1), (std::vector<double>{50, 10, 10, 10, 10}));
}

/// A chessboard that faces the cameras: f = 500 px, baseline 0.1 m, 100 px = 0.5 m away, so that
/// squares of 25 mm are 25 px wide.
class Board : public testing::Test {
 protected:
  Board() {
    reprojection_.fx = reprojection_.fy = 500;
    reprojection_.cx = 120;
    reprojection_.cy = 80;
    reprojection_.baseline = 0.1;
    for (int y = 0; y < kBoard.height; ++y) {
      for (int x = 0; x < kBoard.width; ++x) corners_.emplace_back(40 + 25 * x, 30 + 25 * y);
    }
  }
  BoardMeasures measure() const {
    return measure_board(corners_, kBoard, disparity_, reprojection_);
  }
  static std::uint16_t units(double px) {
    return static_cast<std::uint16_t>(std::lround(px * kDisparityScale));
  }

  const cv::Size kBoard{6, 4};  // 126 x 76 px between the outer corners
  Corners corners_;
  Reprojection reprojection_;
  cv::Mat1w disparity_ = cv::Mat1w(160, 240, units(100));
};

TEST_F(Board, FlatAndRight) {
  const BoardMeasures m = measure();
  EXPECT_EQ(m.coverage, 100);
  EXPECT_EQ(m.corners, 100);
  EXPECT_NEAR(m.rms_distance, 0, 1e-9);
  EXPECT_NEAR(m.median_distance, 0, 1e-9);
  EXPECT_NEAR(m.pitch, 0.025, 1e-9);
}

TEST_F(Board, OffsetIsAdded) {
  reprojection_.offset = 60;
  disparity_ = units(40);
  EXPECT_NEAR(measure().pitch, 0.025, 1e-9);
  disparity_ = units(64);  // 124 px
  EXPECT_NEAR(measure().pitch, 0.025 * 100 / 124, 1e-9);
}

TEST_F(Board, NeighboursAlongRowsAndColumns) {
  reprojection_.fy = 250;  // squares are 25 x 50 mm: 20 neighbours along rows, 18 along columns
  EXPECT_NEAR(measure().pitch, (20 * 0.025 + 18 * 0.05) / 38, 1e-9);
}

TEST_F(Board, SlantedPlaneIsFlat) {
  for (int y = 0; y < disparity_.rows; ++y) {
    for (int x = 0; x < disparity_.cols; ++x) disparity_(y, x) = units(100 + x / 8.0 - y / 16.0);
  }
  const BoardMeasures m = measure();
  EXPECT_LT(m.rms_distance, 1e-4);  // 1/32 px is 0.16 mm
  EXPECT_GT(m.rms_distance, 0);
}

TEST_F(Board, StepsAreNotFlat) {
  // Every second row is 1/2 px nearer: 500 * 0.1 / 100.5 = 0.497512 m, 2.488 mm from the others.
  for (int y = 1; y < disparity_.rows; y += 2) disparity_.row(y) = units(100.5);
  const BoardMeasures m = measure();
  EXPECT_NEAR(m.rms_distance, 0.002488 / 2, 1e-6);
  EXPECT_NEAR(m.median_distance, 0.002488 / 2, 2e-5);
}

TEST_F(Board, HolesAreLeftOut) {
  // Rows 30 to 105 and columns 40 to 165 are inside.
  disparity_(cv::Rect(0, 0, 103, 160)) = kNoDisparity;  // of 126 columns, 63 remain
  const BoardMeasures m = measure();
  EXPECT_NEAR(m.coverage, 50, 1e-9);
  EXPECT_EQ(m.corners, 50);  // columns 40, 65, 90 lack a disparity within 2 px
  EXPECT_NEAR(m.pitch, 0.025, 1e-9);
  disparity_ = kNoDisparity;
  const BoardMeasures none = measure();
  EXPECT_EQ(none.coverage, 0);
  EXPECT_EQ(none.corners, 0);
  EXPECT_TRUE(std::isnan(none.rms_distance));
  EXPECT_TRUE(std::isnan(none.median_distance));
  EXPECT_TRUE(std::isnan(none.pitch));
}

TEST_F(Board, CornerTakesTheMedianAroundIt) {
  // A hole and outliers at the corner itself do not matter.
  for (const cv::Point2f& corner : corners_) {
    disparity_(cv::Rect(cv::Point(corner), cv::Size(2, 2))) = units(200);
    disparity_(cv::Point(corner)) = kNoDisparity;
  }
  EXPECT_NEAR(measure().pitch, 0.025, 1e-9);
}

class EvaluateRaw : public ProgramTest {
 protected:
  Outcome evaluate_raw(const std::vector<std::string>& arguments) const {
    return run(FPGA_STEREO_EVALUATE_RAW, arguments);
  }
  /// Writes a sequence of EuRoC with one pair of parallel cameras and constant disparity.
  void write_sequence() const {
    const cv::Size size(160, 80);
    for (const int i : {0, 1}) {
      const std::string camera = i == 0 ? "e/cam0/" : "e/cam1/";
      const std::string x = i == 0 ? "0.0" : "0.1";
      write_text(camera + "sensor.yaml",
                 "T_BS:\n  cols: 4\n  rows: 4\n  data: [1.0, 0.0, 0.0, " + x +
                     ",\n    0.0, 1.0, 0.0, 0.0,\n    0.0, 0.0, 1.0, 0.0,\n"
                     "    0.0, 0.0, 0.0, 1.0]\nresolution: [160, 80]\ncamera_model: pinhole\n"
                     "intrinsics: [160.0, 160.0, 79.5, 39.5]\n"
                     "distortion_model: radial-tangential\n"
                     "distortion_coefficients: [0.0, 0.0, 0.0, 0.0]\n");
      const NoisePair pair = noise_pair(size, 9);
      write(camera + "data/1403715273262142976.png", i == 0 ? pair.left : pair.right);
    }
  }
  /// contender -> values of the table that the program writes as CSV.
  std::map<std::string, std::vector<double>> rows(const std::string& title) const {
    std::istringstream file(bytes(at("out.csv")));
    std::string line;
    std::getline(file, line);
    EXPECT_EQ(line, title);
    std::map<std::string, std::vector<double>> found;
    while (std::getline(file, line)) {
      std::istringstream cells(line);
      std::string name, cell;
      std::getline(cells, name, ',');
      while (std::getline(cells, cell, ',')) found[name].push_back(std::stod(cell));
    }
    return found;
  }
};

constexpr const char* kSequenceTitle = "contender,coverage %,mean,median,mean common,median common";
constexpr const char* kChessboardTitle =
    "contender,coverage %,RMS mm,median mm,corners %,pitch error %";

TEST_F(EvaluateRaw, Sequence) {
  write_sequence();
  const Outcome run =
      evaluate_raw({at("e"), "--disparity_range", "16", "--csv", at("out.csv"), "--threads", "1"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_NE(run.out.find("1 pairs"), std::string::npos) << run.out;
  const auto found = rows(kSequenceTitle);
  EXPECT_EQ(found.size(), 7U);
  for (const auto& [name, values] : found) {
    ASSERT_EQ(values.size(), 5U) << name;
    EXPECT_GT(values[0], 60) << name;
    EXPECT_LT(values[2], 8) << name;  // the grey values are 0 to 255
    EXPECT_LT(values[4], 8) << name;
  }
  EXPECT_EQ(found.at("sgm dense")[0], 100);
  EXPECT_LT(found.at("StereoBM")[0], 100);
}

TEST_F(EvaluateRaw, OptionsLeaveRowsOut) {
  write_sequence();
  const auto names = [&](const std::string& option, const std::string& value) {
    EXPECT_EQ(
        evaluate_raw({at("e"), "--disparity_range", "16", "--csv", at("out.csv"), option, value})
            .code,
        0);
    std::string all;
    for (const auto& [name, values] : rows(kSequenceTitle)) {
      if (name.find("Stereo") != 0) all += name + ";";
    }
    return all;
  };
  EXPECT_EQ(names("--stereo_algorithm", "window"), "window;");
  EXPECT_EQ(names("--dense", "true"), "sgm dense;");
  EXPECT_EQ(names("--dense", "false"), "sgm;window;");
  EXPECT_EQ(names("--sgm_build", "small"), "sgm;sgm dense;window;");
}

TEST_F(EvaluateRaw, NamesWhatIsMissing) {
  expect_refused("evaluate_raw", evaluate_raw({at("nowhere")}), 1,
                 {at("nowhere"), "neither cam0", "nor intrinsics.yml"});
  write_text("c/intrinsics.yml", "%YAML:1.0\n---\nM1: 3\n");
  expect_refused("evaluate_raw", evaluate_raw({at("c")}), 1, {at("c/left*")});
  write("c/left1.png", cv::Mat1b(30, 40, std::uint8_t{0}));
  write("c/right1.png", cv::Mat1b(30, 40, std::uint8_t{0}));
  expect_refused("evaluate_raw", evaluate_raw({at("c")}), 1, {at("c/extrinsics.yml")});
  write_text("c/extrinsics.yml", "%YAML:1.0\n---\nR1: 3\n");
  expect_refused("evaluate_raw", evaluate_raw({at("c")}), 1,
                 {at("c/intrinsics.yml"), "M1 = \"3\": allowed is a mapping"});
  write_text("c/intrinsics.yml",
             "%YAML:1.0\n---\nM1: !!opencv-matrix\n   rows: 3\n   cols: 500000000\n   dt: d\n"
             "   data: [ 1., 0. ]\n");
  expect_refused("evaluate_raw", evaluate_raw({at("c")}), 1,
                 {at("c/intrinsics.yml") + ": M1.cols = \"500000000\": allowed is 3"});
  write("c/right2.png", cv::Mat1b(30, 40, std::uint8_t{0}));
  expect_refused("evaluate_raw", evaluate_raw({at("c")}), 1, {"1 left and 2 right images"});
  write_sequence();
  std::remove(at("e/cam1/sensor.yaml").c_str());
  expect_refused("evaluate_raw", evaluate_raw({at("e")}), 1, {at("e/cam1/sensor.yaml")});
}

TEST_F(EvaluateRaw, Usage) {
  const Outcome help = evaluate_raw({"--help"});
  EXPECT_EQ(help.code, 0);
  EXPECT_NE(help.out.find("--square"), std::string::npos);
  expect_refused("evaluate_raw", evaluate_raw({}), 2, {"DIR is missing"});
  expect_refused("evaluate_raw", evaluate_raw({at("e"), "--first", "0"}), 2, {"--first = 0"});
  expect_refused("evaluate_raw", evaluate_raw({at("e"), "--board", "9"}), 2, {"--board = \"9\""});
  expect_refused("evaluate_raw", evaluate_raw({at("e"), "--sgm_p1", "16"}), 2, {"0 to 15"});
}

TEST_F(EvaluateRaw, RealImages) {
  const std::string boards = test_data("chessboard"), sequence = test_data("sequence");
  if (boards.empty()) GTEST_SKIP() << "the test images have no folder chessboard";
  Outcome run = evaluate_raw({boards, "--first", "1", "--csv", at("out.csv")});
  ASSERT_EQ(run.code, 0) << run.err;
  const auto board = rows(kChessboardTitle).at("sgm dense");
  EXPECT_EQ(board[0], 100);
  EXPECT_LT(board[2], 10);  // mm
  EXPECT_LT(board[4], 2);   // percent
  if (sequence.empty()) GTEST_SKIP() << "the test images have no folder sequence";
  run = evaluate_raw({sequence, "--first", "1", "--csv", at("out.csv")});
  ASSERT_EQ(run.code, 0) << run.err;
  const auto frame = rows(kSequenceTitle).at("sgm");
  EXPECT_GT(frame[0], 70);
  EXPECT_LT(frame[2], 5);
}

}  // namespace
}  // namespace fpga_stereo::tools
