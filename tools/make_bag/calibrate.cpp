// make_bag calibrate: computes the camera_info files of a stereo camera from chessboard pairs.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <regex>

#include "make_bag/camera_info_files.hpp"
#include "make_bag/modes.hpp"
#include "make_bag/stereo_info.hpp"
#include "support/chessboard.hpp"
#include "support/files.hpp"

namespace fpga_stereo::tools {
namespace {

namespace po = boost::program_options;
using Strings = std::vector<std::string>;

constexpr std::size_t kMinPairs = 3;

CommandLine command_line() {
  CommandLine line;
  line.usage =
      "Usage: make_bag calibrate --left IMAGES --right IMAGES --board 9x6 --square METRES\n"
      "                          --left-info OUT.yaml --right-info OUT.yaml\n"
      "Calibrates a stereo camera from images of a chessboard: first each camera, then both, then\n"
      "rectification without black borders. Prints the reprojection error and the difference\n"
      "between the rows of left and right corners after rectification.\n"
      "IMAGES are files, folders or quoted patterns. Both sides are sorted by name; the n-th left "
      "and\n"
      "the n-th right image form a pair. At least 3 pairs must show the whole chessboard.\n";
  const auto option = [&](const char* name, auto* value, const char* about) {
    line.options.add_options()(name, value->required(), about);
  };
  option("left", po::value<Strings>()->multitoken()->value_name("IMAGES"), "left images");
  option("right", po::value<Strings>()->multitoken()->value_name("IMAGES"), "right images");
  option("board", po::value<std::string>()->value_name("CxR"),
         "inner corners of the chessboard, columns x rows");
  option("square", po::value<double>()->value_name("METRES"),
         "side of a square of the chessboard, m [0.0001 to 100]");
  option("left-info", po::value<std::string>()->value_name("YAML"),
         "camera_info file to write, left");
  option("right-info", po::value<std::string>()->value_name("YAML"),
         "camera_info file to write, right");
  return line;
}

void require_yaml(const std::string& option, const std::string& path) {
  if (std::regex_search(path, std::regex("\\.(yaml|yml)$"))) return;
  throw UsageError(fmt::format("{} \"{}\": allowed are .yaml and .yml files", option, path));
}

/// The corners of all pairs in which both cameras see the whole chessboard.
struct Views {
  cv::Size size;  // of the images
  std::vector<Corners> left, right;
};

Views find_boards(const Strings& left, const Strings& right, cv::Size board) {
  Views views;
  Progress progress("make_bag", left.size());
  for (std::size_t i = 0; i < left.size(); ++i) {
    Corners corners[2];
    for (const int side : {0, 1}) {
      const std::string& path = side == 0 ? left[i] : right[i];
      const cv::Mat1b image = read_grey(path);
      if (views.size.empty()) views.size = image.size();
      if (image.size() != views.size) {
        throw std::runtime_error(fmt::format("{}: is {}x{}: {} is {}x{}", path, image.cols,
                                             image.rows, left[0], views.size.width,
                                             views.size.height));
      }
      corners[side] = find_corners(image, board);
      if (corners[side].empty()) {
        std::cerr << "make_bag: " << path << ": shows no chessboard with " << board.width << "x"
                  << board.height << " inner corners: the pair is skipped\n";
      }
    }
    if (!corners[0].empty() && !corners[1].empty()) {
      views.left.push_back(corners[0]);
      views.right.push_back(corners[1]);
    }
    progress.done(left[i]);
  }
  return views;
}

/// Returns the RMS difference between the rows of left and right corners after rectification, px.
double row_difference(const Views& views, const StereoInfo& info) {
  const auto rectified = [](const Corners& corners, const sensor_msgs::CameraInfo& camera) {
    Corners result;
    cv::undistortPoints(corners, result, cv::Matx33d(camera.K.data()), camera.D,
                        cv::Matx33d(camera.R.data()), cv::Matx34d(camera.P.data()));
    return result;
  };
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < views.left.size(); ++i) {
    const Corners left = rectified(views.left[i], info.left);
    const Corners right = rectified(views.right[i], info.right);
    for (std::size_t k = 0; k < left.size(); ++k) {
      const double difference = left[k].y - right[k].y;
      sum += difference * difference;
    }
    count += left.size();
  }
  return std::sqrt(sum / static_cast<double>(count));
}

}  // namespace

void calibrate(const Arguments& arguments) {
  const auto parsed = parse(command_line(), arguments);
  if (!parsed) return;
  const po::variables_map& options = parsed->options;
  const auto text = [&](const char* name) { return options[name].as<std::string>(); };
  const cv::Size board = board_size(text("board"));
  const double square = options["square"].as<double>();
  require_range("--square", square, 0.0001, 100);
  require_yaml("--left-info", text("left-info"));
  require_yaml("--right-info", text("right-info"));
  const Strings left_paths = list_images("--left", options["left"].as<Strings>());
  const Strings right_paths = list_images("--right", options["right"].as<Strings>());
  if (left_paths.size() != right_paths.size()) {
    throw std::runtime_error(
        fmt::format("--left gives {} images and --right {}: the numbers must be equal",
                    left_paths.size(), right_paths.size()));
  }

  const Views views = find_boards(left_paths, right_paths, board);
  if (views.left.size() < kMinPairs) {
    throw std::runtime_error(
        fmt::format("the chessboard was found in {} of {} pairs: at least {} are needed",
                    views.left.size(), left_paths.size(), kMinPairs));
  }
  std::vector<cv::Point3f> corners;
  for (int row = 0; row < board.height; ++row) {
    for (int column = 0; column < board.width; ++column) {
      corners.emplace_back(static_cast<float>(column * square), static_cast<float>(row * square),
                           0.0F);
    }
  }
  const std::vector<std::vector<cv::Point3f>> world(views.left.size(), corners);
  Intrinsics left, right;
  std::vector<cv::Mat> rotations, translations;
  cv::calibrateCamera(world, views.left, views.size, left.K, left.D, rotations, translations);
  cv::calibrateCamera(world, views.right, views.size, right.K, right.D, rotations, translations);
  cv::Matx33d R;
  cv::Vec3d T;
  cv::Mat E, F;
  const cv::TermCriteria until(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 100, 1e-6);
  const double rms =
      cv::stereoCalibrate(world, views.left, views.right, left.K, left.D, right.K, right.D,
                          views.size, R, T, E, F, cv::CALIB_USE_INTRINSIC_GUESS, until);
  const StereoInfo info = calibrated_info(views.size, left, right, R, T);
  write_camera_info(text("left-info"), "left", info.left);
  write_camera_info(text("right-info"), "right", info.right);
  std::cout << "pairs used: " << views.left.size() << " of " << left_paths.size() << "\n"
            << "reprojection error: " << rms << " px RMS\n"
            << "row difference after rectification: " << row_difference(views, info) << " px RMS\n"
            << "rectified focal length: " << info.left.P[0]
            << " px, baseline: " << -info.right.P[3] / info.right.P[0] << " m\n";
}

}  // namespace fpga_stereo::tools
