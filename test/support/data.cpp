#include "support/data.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

namespace fpga_stereo::test {
namespace {

const cv::Size kEurocSize(752, 480);
const cv::Size kChessboardSize(640, 480);

std::string path(const std::string& name) {
  const auto dir = data_dir();
  if (!dir) throw std::runtime_error(kNoData);
  return *dir + "/" + name;
}

cv::Mat1b load(const std::string& name) {
  const cv::Mat image = cv::imread(path(name), cv::IMREAD_GRAYSCALE);
  if (image.empty()) throw std::runtime_error("cannot read " + path(name));
  return image;
}

/// Loads an image whose channels, if there are several, are equal.
cv::Mat1b load_first_channel(const std::string& name) {
  const cv::Mat image = cv::imread(path(name), cv::IMREAD_UNCHANGED);
  if (image.empty()) throw std::runtime_error("cannot read " + path(name));
  cv::Mat1b channel;
  cv::extractChannel(image, channel, 0);
  return channel;
}

cv::FileStorage open(const std::string& name) {
  cv::FileStorage file(path(name), cv::FileStorage::READ);
  if (!file.isOpened()) throw std::runtime_error("cannot read " + path(name));
  return file;
}

std::vector<double> numbers(const cv::FileNode& node) {
  std::vector<double> values;
  for (const auto& value : node) values.push_back(static_cast<double>(value));
  return values;
}

template <std::size_t N>
void fill(std::array<double, N>& out, const cv::Mat& matrix) {
  const cv::Mat1d values = cv::Mat1d(matrix).clone();
  if (values.total() != N) throw std::runtime_error("calibration matrix of a wrong size");
  std::copy(values.begin(), values.end(), out.begin());
}

CameraCalibration camera(cv::Size size, const cv::Mat& K, const std::vector<double>& D,
                         const cv::Mat& R, const cv::Mat& P) {
  CameraCalibration out;
  out.width = size.width;
  out.height = size.height;
  out.distortion_model = "plumb_bob";
  out.D = D;
  out.D.resize(5, 0.0);
  fill(out.K, K);
  fill(out.R, R);
  fill(out.P, P);
  return out;
}

struct EurocSensor {
  cv::Mat1d K = cv::Mat1d::eye(3, 3);
  std::vector<double> D;
  cv::Mat1d body_from_camera;
};

EurocSensor euroc_sensor(const std::string& name) {
  const cv::FileStorage file = open("sequence/" + name + "/sensor.yaml");
  EurocSensor sensor;
  const auto f = numbers(file["intrinsics"]);
  sensor.K << f.at(0), 0, f.at(2), 0, f.at(1), f.at(3), 0, 0, 1;
  sensor.D = numbers(file["distortion_coefficients"]);
  sensor.body_from_camera = cv::Mat1d(numbers(file["T_BS"]["data"])).reshape(1, 4).clone();
  return sensor;
}

}  // namespace

const char* const kNoData =
    "no test images: set FPGA_STEREO_DATA to the folder that holds middlebury_v2, sequence and "
    "chessboard";

std::optional<std::string> data_dir() {
  const char* set = std::getenv("FPGA_STEREO_DATA");
  const std::string dir = set != nullptr ? set : FPGA_STEREO_DATA_DIR;
  if (!std::ifstream(dir + "/SOURCES.md")) return std::nullopt;
  return dir;
}

const std::vector<std::string>& middlebury_names() {
  static const std::vector<std::string> names{"tsukuba", "venus", "teddy", "cones"};
  return names;
}

MiddleburyPair middlebury_pair(const std::string& name) {
  const bool tsukuba = name == "tsukuba";
  const bool venus = name == "venus";
  const std::string dir = "middlebury_v2/" + name + "/";
  MiddleburyPair pair;
  pair.name = name;
  pair.left = load(dir + "imL.png");
  pair.right = load(dir + "imR.png");
  const double scale = tsukuba ? 16 : venus ? 8 : 4;
  load_first_channel(dir + "groundtruth.png").convertTo(pair.truth, CV_32F, 1 / scale);
  pair.nonocc = load_first_channel(dir + "nonocc.png");
  pair.all = load_first_channel(dir + "all.png");
  pair.disc = load_first_channel(dir + "disc.png");
  pair.disparity_range = tsukuba ? 16 : venus ? 20 : 60;
  return pair;
}

ImagePair euroc_pair(int index) {
  std::ifstream list(path("sequence/cam0/data.csv"));
  std::vector<std::string> files;
  for (std::string line; std::getline(list, line);) {
    if (line.empty() || line[0] == '#') continue;
    files.push_back(line.substr(0, line.find(',')) + ".png");
  }
  const std::string& file = files.at(static_cast<std::size_t>(index));
  return {load("sequence/cam0/data/" + file), load("sequence/cam1/data/" + file)};
}

CalibrationPair euroc_calibration() {
  const EurocSensor left = euroc_sensor("cam0");
  const EurocSensor right = euroc_sensor("cam1");
  const cv::Mat1d right_from_left = right.body_from_camera.inv() * left.body_from_camera;
  cv::Mat R1, R2, P1, P2, Q;
  cv::stereoRectify(left.K, left.D, right.K, right.D, kEurocSize,
                    right_from_left(cv::Rect(0, 0, 3, 3)), right_from_left(cv::Rect(3, 0, 1, 3)),
                    R1, R2, P1, P2, Q, cv::CALIB_ZERO_DISPARITY, 0);
  return {camera(kEurocSize, left.K, left.D, R1, P1), camera(kEurocSize, right.K, right.D, R2, P2)};
}

ImagePair chessboard_pair(int number) {
  const std::string digits = (number < 10 ? "0" : "") + std::to_string(number);
  return {load("chessboard/left" + digits + ".jpg"), load("chessboard/right" + digits + ".jpg")};
}

CalibrationPair chessboard_calibration() {
  const cv::FileStorage in = open("chessboard/intrinsics.yml");
  const cv::FileStorage ex = open("chessboard/extrinsics.yml");
  const auto calibration = [&](const std::string& i) {
    const cv::Mat1d D = in["D" + i].mat();
    return camera(kChessboardSize, in["M" + i].mat(), {D.begin(), D.end()}, ex["R" + i].mat(),
                  ex["P" + i].mat());
  };
  return {calibration("1"), calibration("2")};
}

}  // namespace fpga_stereo::test
