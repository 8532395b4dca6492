#include "support/euroc.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <map>
#include <stdexcept>

#include "support/files.hpp"

namespace fpga_stereo::tools {
namespace {

namespace fs = std::filesystem;

struct Sensor {
  cv::Size size;
  Intrinsics camera;
  cv::Matx44d body_from_sensor;  // T_BS, metres
};

/// Returns the numbers of a YAML list. Throws unless there are `count`.
std::vector<double> numbers(const std::string& path, const cv::FileNode& node,
                            const std::string& name, std::size_t count) {
  std::vector<double> values;
  if (node.isSeq()) {
    for (const cv::FileNode& item : node) values.push_back(static_cast<double>(item));
  }
  if (values.size() != count) {
    throw std::runtime_error(
        fmt::format("{}: {} has {} numbers: allowed {}", path, name, values.size(), count));
  }
  return values;
}

void require_text(const std::string& path, const cv::FileStorage& file, const std::string& name,
                  const std::vector<std::string>& allowed) {
  const std::string value = file[name].isString() ? file[name].string() : "";
  if (std::find(allowed.begin(), allowed.end(), value) != allowed.end()) return;
  throw std::runtime_error(
      fmt::format("{}: {} is \"{}\": allowed is \"{}\"", path, name, value, allowed[0]));
}

Sensor read_sensor(const std::string& path) {
  std::ifstream stream(path);
  if (!stream) throw std::runtime_error(path + ": cannot be read");
  std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  // OpenCV requires this first line, which the files of the dataset lack.
  if (text.rfind("%YAML", 0) != 0) text.insert(0, "%YAML:1.0\n---\n");
  cv::FileStorage file;
  try {
    file.open(text, cv::FileStorage::READ | cv::FileStorage::MEMORY);
  } catch (const cv::Exception& e) {
    throw std::runtime_error(fmt::format("{}: is not valid YAML: {}", path, e.err));
  }
  require_text(path, file, "camera_model", {"pinhole"});
  require_text(path, file, "distortion_model", {"radial-tangential", "radtan"});
  Sensor sensor;
  const auto size = numbers(path, file["resolution"], "resolution", 2);
  sensor.size = {static_cast<int>(size[0]), static_cast<int>(size[1])};
  const auto k = numbers(path, file["intrinsics"], "intrinsics", 4);
  sensor.camera.K = {k[0], 0, k[2], 0, k[1], k[3], 0, 0, 1};
  sensor.camera.D = numbers(path, file["distortion_coefficients"], "distortion_coefficients", 4);
  sensor.body_from_sensor =
      cv::Matx44d(numbers(path, file["T_BS"]["data"], "T_BS data", 16).data());
  return sensor;
}

/// Returns the images of one camera by time.
std::map<std::int64_t, std::string> list_by_time(const fs::path& folder) {
  std::map<std::int64_t, std::string> images;
  for (const std::string& path : list_images("EuRoC folder", {folder.string()})) {
    const std::string stem = fs::path(path).stem().string();
    const bool digits =
        std::all_of(stem.begin(), stem.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
    // 19 digits fit into 64 bits until the year 2262.
    if (!digits || stem.size() > 19) {
      throw std::runtime_error(path + ": the file name must be the time in nanoseconds");
    }
    images[std::stoll(stem)] = path;
  }
  return images;
}

void report_unpaired(const std::map<std::int64_t, std::string>& images,
                     const std::map<std::int64_t, std::string>& others, const char* other_camera,
                     const std::string& program) {
  for (const auto& [stamp, path] : images) {
    if (others.count(stamp) != 0) continue;
    std::cerr << fmt::format("{}: {} is skipped: {} has no image of this time\n", program, path,
                             other_camera);
  }
}

}  // namespace

EurocFolder read_euroc_folder(const std::string& folder, const std::string& program) {
  const fs::path at(folder);
  const Sensor left = read_sensor((at / "cam0" / "sensor.yaml").string());
  const Sensor right = read_sensor((at / "cam1" / "sensor.yaml").string());
  if (left.size != right.size) {
    throw std::runtime_error(folder +
                             ": the resolutions in cam0/sensor.yaml and cam1/sensor.yaml differ");
  }
  const auto left_images = list_by_time(at / "cam0" / "data");
  const auto right_images = list_by_time(at / "cam1" / "data");
  report_unpaired(left_images, right_images, "cam1", program);
  report_unpaired(right_images, left_images, "cam0", program);

  EurocFolder euroc;
  for (const auto& [stamp, path] : left_images) {
    const auto other = right_images.find(stamp);
    if (other != right_images.end()) euroc.frames.push_back({stamp, path, other->second});
  }
  if (euroc.frames.empty()) {
    throw std::runtime_error(folder + ": cam0 and cam1 have no image of the same time");
  }
  const cv::Matx44d right_from_left = right.body_from_sensor.inv() * left.body_from_sensor;
  euroc.calibration = rectified_calibration(
      left.size, left.camera, right.camera, right_from_left.get_minor<3, 3>(0, 0),
      {right_from_left(0, 3), right_from_left(1, 3), right_from_left(2, 3)});
  return euroc;
}

}  // namespace fpga_stereo::tools
