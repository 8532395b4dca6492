// make_bag calibrate, with rendered chessboards of known cameras and with real images.
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>

#include "make_bag/camera_info_files.hpp"
#include "programs.hpp"

namespace fpga_stereo::tools {
namespace {

const cv::Size kSize(320, 240);
constexpr double kSquare = 0.03;  // m
const cv::Matx33d kCamera(300, 0, 159.5, 0, 300, 119.5, 0, 0, 1);
constexpr double kBaseline = 0.08;  // m

/// Returns the number that follows `name` in a text.
double number_after(const std::string& text, const std::string& name) {
  const std::size_t at = text.find(name);
  EXPECT_NE(at, std::string::npos) << name << " in: " << text;
  return at == std::string::npos ? 0 : std::atof(text.c_str() + at + name.size());
}

/// Renders a chessboard of 7 x 5 inner corners as seen by a camera at `x` m.
cv::Mat1b draw_board(const cv::Vec3d& rotation, const cv::Vec3d& translation, double x) {
  constexpr int kCell = 40;  // px per square of the flat picture
  cv::Mat1b flat(8 * kCell, 10 * kCell, std::uint8_t{255});
  for (int row = 0; row < 6; ++row) {
    for (int column = row % 2; column < 8; column += 2) {
      flat(cv::Rect((column + 1) * kCell, (row + 1) * kCell, kCell, kCell)) = 0;
    }
  }
  cv::Matx33d R;
  cv::Rodrigues(rotation, R);
  const double scale = kSquare / kCell;
  // Pixel (u, v) of the flat picture is the point ((u + 0.5) scale, (v + 0.5) scale, 0) of the
  // board.
  const cv::Matx33d plane(scale, 0, scale * (0.5 - 5 * kCell),  //
                          0, scale, scale * (0.5 - 4 * kCell),  //
                          0, 0, 1);
  const cv::Matx33d pose(R(0, 0), R(0, 1), translation[0] - x,  //
                         R(1, 0), R(1, 1), translation[1],      //
                         R(2, 0), R(2, 1), translation[2]);
  cv::Mat1b image;
  cv::warpPerspective(flat, image, kCamera * pose * plane, kSize, cv::INTER_AREA,
                      cv::BORDER_CONSTANT, 200);
  cv::GaussianBlur(image, image, {3, 3}, 0);
  return image;
}

class Calibrate : public ProgramTest {
 protected:
  Outcome calibrate(const std::string& left, const std::string& right,
                    const std::string& board = "7x5", const std::string& square = "0.03") const {
    return make_bag({"calibrate", "--left", left, "--right", right, "--board", board, "--square",
                     square, "--left-info", at("left.yaml"), "--right-info", at("right.yaml")});
  }
  void write_boards(int count) const {
    const cv::Vec3d rotations[] = {{0.3, 0, 0},    {-0.3, 0.2, 0.1}, {0, 0.4, 0},
                                   {0.2, -0.4, 0}, {0.3, 0.3, -0.2}, {-0.2, -0.3, 0.2}};
    for (int i = 0; i < count; ++i) {
      const cv::Vec3d translation(0.04 + 0.02 * (i % 3 - 1), 0.02 * (i % 2), 0.42 + 0.02 * i);
      const std::string name = std::to_string(i) + ".png";
      write("l/" + name, draw_board(rotations[i], translation, 0));
      write("r/" + name, draw_board(rotations[i], translation, kBaseline));
    }
  }
};

TEST_F(Calibrate, RecoversTheCameras) {
  write_boards(6);
  write("l/6.png", cv::Mat1b(kSize, std::uint8_t{200}));
  write("r/6.png", draw_board({0.2, 0.1, 0}, {0.04, 0, 0.5}, kBaseline));
  const Outcome run = calibrate(at("l"), at("r"));
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_NE(run.out.find("pairs used: 6 of 7"), std::string::npos) << run.out;
  EXPECT_NE(run.err.find(at("l/6.png") + ": shows no chessboard with 7x5"), std::string::npos)
      << run.err;
  EXPECT_LT(number_after(run.out, "reprojection error: "), 0.2);
  EXPECT_LT(number_after(run.out, "row difference after rectification: "), 0.2);
  const sensor_msgs::CameraInfo left = read_camera_info_message(at("left.yaml"));
  const sensor_msgs::CameraInfo right = read_camera_info_message(at("right.yaml"));
  EXPECT_NEAR(left.K[0], 300, 6);
  EXPECT_NEAR(right.K[4], 300, 6);
  EXPECT_NEAR(-right.P[3] / right.P[0], kBaseline, 0.002);
  EXPECT_EQ(left.width, 320U);
  EXPECT_EQ(left.distortion_model, "plumb_bob");
}

TEST_F(Calibrate, NeedsThreePairs) {
  write_boards(2);
  write("l/2.png", cv::Mat1b(kSize, std::uint8_t{200}));
  write("r/2.png", cv::Mat1b(kSize, std::uint8_t{200}));
  const Outcome run = calibrate(at("l"), at("r"));
  EXPECT_EQ(run.code, 1);
  EXPECT_NE(run.err.find("found in 2 of 3 pairs: at least 3"), std::string::npos) << run.err;
  EXPECT_FALSE(exists("left.yaml"));
}

TEST_F(Calibrate, RefusesWrongUsage) {
  write_boards(3);
  Outcome run = calibrate(at("l"), at("r"), "7");
  EXPECT_EQ(run.code, 2);
  EXPECT_NE(run.err.find("--board = \"7\""), std::string::npos) << run.err;
  run = calibrate(at("l"), at("r"), "7x5", "0");
  EXPECT_EQ(run.code, 2);
  EXPECT_NE(run.err.find("--square = 0"), std::string::npos) << run.err;
  run = make_bag({"calibrate", "--left", at("l")});
  EXPECT_EQ(run.code, 2);
  EXPECT_NE(run.err.find("--"), std::string::npos) << run.err;
  write("l/3.png", cv::Mat1b(kSize, std::uint8_t{0}));
  run = calibrate(at("l"), at("r"));
  EXPECT_EQ(run.code, 1);
  EXPECT_NE(run.err.find("4 images and --right 3"), std::string::npos) << run.err;
  write("r/3.png", cv::Mat1b(10, 10, std::uint8_t{0}));
  run = calibrate(at("l"), at("r"));
  EXPECT_EQ(run.code, 1);
  EXPECT_NE(run.err.find(at("r/3.png") + ": is 10x10"), std::string::npos) << run.err;
}

TEST_F(Calibrate, RealImages) {
  const std::string folder = test_data("chessboard");
  if (folder.empty()) GTEST_SKIP() << "no folder chessboard in the test images";
  const Outcome run = calibrate(folder + "/left*.jpg", folder + "/right*.jpg", "9x6", "0.025");
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_LT(number_after(run.out, "reprojection error: "), 0.5);
  EXPECT_LT(number_after(run.out, "row difference after rectification: "), 0.3);
  EXPECT_NEAR(number_after(run.out, "baseline: "), 0.0832, 0.0005);
}

}  // namespace
}  // namespace fpga_stereo::tools
