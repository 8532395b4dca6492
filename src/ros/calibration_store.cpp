#include "ros/calibration_store.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <utility>

#include "core/pending_file.hpp"
#include "fpga_stereo/core/camera_info_yaml.hpp"

namespace fpga_stereo {
namespace {

namespace fs = std::filesystem;

const std::array<std::string, 2> kSideNames{"left", "right"};
constexpr const char* kDefaultUrl = "file://${ROS_HOME}/camera_info/${NAME}.yaml";

CameraCalibration& of(StereoCalibration& pair, std::size_t side) {
  return side == 0 ? pair.left : pair.right;
}

bool exists(const std::string& path) {
  std::error_code failed;
  return fs::exists(path, failed);
}

/// Writes the temporary file of a calibration and reads it back. Refuses other formats than YAML.
Result<PendingFile> write(const std::string& path, const CameraCalibration& camera,
                          const std::string& name) {
  const std::string extension = fs::path(path).extension().string();
  if (extension != ".yaml" && extension != ".yml") {
    return Error{ErrorKind::kInvalid, path + ": allowed are .yaml and .yml files"};
  }
  const auto text = format_camera_info(camera, name);
  if (!text) return text.error();
  auto file = PendingFile::write(path, *text);
  if (!file) return file;
  const auto written = read_camera_info(PendingFile::temporary(path));
  if (!written) return written.error();
  if (*written == camera) return file;
  return Error{ErrorKind::kIo, path + ": was not written correctly"};
}

/// Puts back what was in a file; removes the file if there was nothing.
void restore(const std::string& path, const std::optional<std::string>& text) {
  if (!text) {
    std::remove(path.c_str());
    return;
  }
  if (auto file = PendingFile::write(path, *text)) (void)(*file).commit();
}

std::optional<std::string> contents(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return std::nullopt;
  return std::string(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
}

/// Refuses a calibration that the node could not use, as far as one side shows it.
Status check_side(const CameraCalibration& camera, const std::string& name, cv::Size image_size) {
  if (Status valid = validate(camera, name); !valid) return valid;
  const cv::Size size = camera.image_size();
  if (size == image_size) return {};
  return Error{ErrorKind::kImageSize,
               fmt::format("{} camera_info is for images of {}x{}: those of the camera are {}x{}",
                           name, size.width, size.height, image_size.width, image_size.height)};
}

}  // namespace

CalibrationStore::CalibrationStore(std::string prefix, CalibrationUrls urls)
    : prefix_(std::move(prefix)), urls_{std::move(urls.left), std::move(urls.right)} {}

std::string CalibrationStore::camera_name(std::size_t side) const {
  return prefix_ + kSideNames[side];
}

Result<std::string> CalibrationStore::path(std::size_t side) const {
  return path_of_url(urls_[side].empty() ? kDefaultUrl : urls_[side], camera_name(side));
}

std::vector<Error> CalibrationStore::load() {
  const MutexLock io(io_mutex_);
  waiting_ = {};
  complete_save();
  std::vector<Error> problems;
  StereoCalibration pair;
  for (std::size_t side = 0; side < kSideNames.size(); ++side) {
    const auto path = this->path(side);
    const auto camera = path ? read_camera_info(*path) : Result<CameraCalibration>(path.error());
    if (camera) {
      of(pair, side) = *camera;
    } else {
      problems.push_back(
          {camera.error().kind, fmt::format("the {} camera is not calibrated: {}", kSideNames[side],
                                            camera.error().message)});
    }
  }
  const MutexLock lock(mutex_);
  calibration_ = pair;
  return problems;
}

Result<std::string> CalibrationStore::set(Side side, const CameraCalibration& camera,
                                          cv::Size image_size) {
  const std::size_t own = side == Side::kLeft ? 0 : 1;
  const std::size_t other = 1 - own;
  if (Status valid = check_side(camera, kSideNames[own], image_size); !valid) return valid.error();
  const MutexLock io(io_mutex_);
  if (!waiting_[other]) {
    waiting_[own] = camera;
    return fmt::format(
        "the {0} calibration is accepted; it takes effect, and is saved, together with that of the "
        "{1} camera, which {1}/set_camera_info must bring next",
        kSideNames[own], kSideNames[other]);
  }
  StereoCalibration pair;
  of(pair, own) = camera;
  of(pair, other) = *waiting_[other];
  waiting_ = {};
  if (const auto usable = make_stereo_rectification(pair.left, pair.right, 0); !usable) {
    return Error{usable.error().kind,
                 "neither calibration takes effect: " + usable.error().message};
  }
  if (Status saved = save(pair); !saved) {
    return Error{saved.error().kind, "neither calibration takes effect: " + saved.error().message};
  }
  const MutexLock lock(mutex_);
  calibration_ = pair;
  return std::string("both calibrations are saved and take effect");
}

Status CalibrationStore::save(const StereoCalibration& pair) const {
  const auto left = path(0), right = path(1);
  if (!left) return left.error();
  if (!right) return right.error();
  if (*left == *right) {
    return Error{ErrorKind::kInvalid,
                 fmt::format("{}: allowed are two files, one for each camera", *left)};
  }
  auto new_left = write(*left, pair.left, camera_name(0));
  if (!new_left) return new_left.error();
  auto new_right = write(*right, pair.right, camera_name(1));
  if (!new_right) return new_right.error();
  const auto old_left = contents(*left);
  if (Status renamed = (*new_left).commit(); !renamed) return renamed;
  Status renamed = (*new_right).commit();
  if (!renamed) restore(*left, old_left);
  return renamed;
}

void CalibrationStore::complete_save() const {
  const auto left = path(0), right = path(1);
  if (!left || !right) return;
  const std::string new_right = PendingFile::temporary(*right);
  // The left file is renamed first: if its new contents still wait, those of the right may be cut.
  if (!exists(new_right) || exists(PendingFile::temporary(*left))) return;
  const auto left_camera = read_camera_info(*left), right_camera = read_camera_info(new_right);
  if (!left_camera || !right_camera) return;
  if (!make_stereo_geometry(*left_camera, *right_camera)) return;
  (void)PendingFile::take_over(*right).commit();
}

StereoCalibration CalibrationStore::calibration() const {
  const MutexLock lock(mutex_);
  return calibration_;
}

}  // namespace fpga_stereo
