#include "support/euroc.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <iostream>
#include <map>
#include <stdexcept>

#include "core/printable.hpp"
#include "core/yaml_mapping.hpp"
#include "support/files.hpp"
#include "support/program.hpp"

namespace fpga_stereo::tools {
namespace {

namespace fs = std::filesystem;

struct Sensor {
  cv::Size size;
  Intrinsics camera;
  cv::Matx44d body_from_sensor;  // T_BS, metres
};

std::vector<double> numbers(const YamlMapping& file, const std::string& name, std::size_t count) {
  const auto values = file.numbers(name, count, "allowed are");
  require(values);
  return *values;
}

void require_text(const std::string& path, const YamlMapping& file, const std::string& name,
                  const std::vector<std::string>& allowed) {
  const auto value = file.text(name);
  require(value);
  if (std::find(allowed.begin(), allowed.end(), *value) != allowed.end()) return;
  throw std::runtime_error(fmt::format("{}: {} is \"{}\": allowed is \"{}\"", path, name,
                                       printable(*value), allowed[0]));
}

Sensor read_sensor(const std::string& path) {
  const auto file = YamlMapping::read(path, "the sensor.yaml of a camera");
  require(file);
  require_text(path, *file, "camera_model", {"pinhole"});
  require_text(path, *file, "distortion_model", {"radial-tangential", "radtan"});
  Sensor sensor;
  const auto size = numbers(*file, "resolution", 2);
  for (const double side : size) {
    if (side >= 1 && side <= kMaxCalibratedSide) continue;
    throw std::runtime_error(fmt::format("{}: resolution is {}x{}: allowed are 1x1 to {}x{}", path,
                                         size[0], size[1], kMaxCalibratedSide, kMaxCalibratedSide));
  }
  sensor.size = {static_cast<int>(size[0]), static_cast<int>(size[1])};
  const auto k = numbers(*file, "intrinsics", 4);
  sensor.camera.K = {k[0], 0, k[2], 0, k[1], k[3], 0, 0, 1};
  sensor.camera.D = numbers(*file, "distortion_coefficients", 4);
  const auto body_from_sensor = file->matrix("T_BS", 4, 4);
  require(body_from_sensor);
  sensor.body_from_sensor = cv::Matx44d(body_from_sensor->data());
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
