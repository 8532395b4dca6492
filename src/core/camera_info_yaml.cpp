#include "fpga_stereo/core/camera_info_yaml.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdlib>
#include <utility>
#include <vector>

#include "core/printable.hpp"
#include "core/yaml_mapping.hpp"

namespace fpga_stereo {
namespace {

constexpr int kMaxCoefficients = kMaxDistortionCoefficients;
constexpr const char* kContent =
    "a camera_info file: it must be a YAML mapping with the keys image_width, image_height, "
    "camera_matrix, distortion_coefficients, rectification_matrix and projection_matrix";

/// Reads a whole number between `min` and the largest side of an image. Without the key, `value`
/// keeps its value if it may be missing.
Status read_size(const YamlMapping& parent, const char* key, int min, bool may_be_missing,
                 int& value) {
  if (may_be_missing && !parent.has(key)) return {};
  const auto read = parent.integer(key, min, kMaxCalibratedSide);
  if (!read) return read.error();
  value = *read;
  return {};
}

template <std::size_t Count>
Status read_matrix(const YamlMapping& root, const char* key, int rows, int cols,
                   std::array<double, Count>& values) {
  const auto read = root.matrix(key, rows, cols);
  if (!read) return read.error();
  std::copy(read->begin(), read->end(), values.begin());
  return {};
}

/// Reads the distortion coefficients: one row or one column, or no value at all.
Status read_distortion(const YamlMapping& root, CameraCalibration& camera) {
  camera.distortion_model = "plumb_bob";
  if (root.has("distortion_model")) {
    const auto model = root.text("distortion_model");
    if (!model) return model.error();
    camera.distortion_model = *model;
  }
  const auto matrix = root.mapping("distortion_coefficients");
  if (!matrix) return matrix.error();
  const auto rows = matrix->integer("rows", 0, kMaxCoefficients);
  if (!rows) return rows.error();
  const auto cols = matrix->integer("cols", 0, *rows > 1 ? 1 : kMaxCoefficients);
  if (!cols) return cols.error();
  auto data = root.matrix("distortion_coefficients", *rows, *cols);
  if (!data) return data.error();
  camera.D = std::move(*data);
  return {};
}

Status read_roi(const YamlMapping& root, cv::Rect& roi) {
  if (!root.has("roi")) return {};
  const auto mapping = root.mapping("roi");
  if (!mapping) return mapping.error();
  const std::pair<const char*, int*> fields[] = {
      {"x_offset", &roi.x}, {"y_offset", &roi.y}, {"width", &roi.width}, {"height", &roi.height}};
  for (const auto& [key, field] : fields) {
    if (Status read = read_size(*mapping, key, 0, true, *field); !read) return read;
  }
  return {};
}

Status read_camera(const YamlMapping& root, CameraCalibration& camera) {
  Status read = read_size(root, "image_width", 1, false, camera.width);
  if (read) read = read_size(root, "image_height", 1, false, camera.height);
  if (read) read = read_size(root, "binning_x", 0, true, camera.binning_x);
  if (read) read = read_size(root, "binning_y", 0, true, camera.binning_y);
  if (read) read = read_roi(root, camera.roi);
  if (read) read = read_matrix(root, "camera_matrix", 3, 3, camera.K);
  if (read) read = read_distortion(root, camera);
  if (read) read = read_matrix(root, "rectification_matrix", 3, 3, camera.R);
  if (read) read = read_matrix(root, "projection_matrix", 3, 4, camera.P);
  return read;
}

/// Returns the number with as few digits as identify it.
std::string number(double value) {
  for (const int digits : {15, 16}) {
    std::string text = fmt::format("{:.{}g}", value, digits);
    if (std::strtod(text.c_str(), nullptr) == value) return text;
  }
  return fmt::format("{:.17g}", value);
}

template <class Values>
std::string matrix(const char* key, std::size_t rows, std::size_t cols, const Values& values) {
  std::string text = fmt::format("{}:\n  rows: {}\n  cols: {}\n  data: [", key, rows, cols);
  for (std::size_t i = 0; i < values.size(); ++i) {
    text += (i == 0 ? "" : ", ") + number(values[i]);
  }
  return text + "]\n";
}

/// Returns a scalar with quotes and escapes if it needs them.
std::string scalar(const std::string& text) {
  YAML::Emitter emitter;
  emitter << text;
  return emitter.c_str();
}

/// Returns what camera_calibration_parsers does not write, and ignores.
std::string part_of_image(const CameraCalibration& camera) {
  std::string text;
  if (camera.binning_x != 0 || camera.binning_y != 0) {
    text += fmt::format("binning_x: {}\nbinning_y: {}\n", camera.binning_x, camera.binning_y);
  }
  if (camera.roi != cv::Rect()) {
    text += fmt::format("roi:\n  x_offset: {}\n  y_offset: {}\n  width: {}\n  height: {}\n",
                        camera.roi.x, camera.roi.y, camera.roi.width, camera.roi.height);
  }
  return text;
}

Result<CameraCalibration> to_camera(const Result<YamlMapping>& root) {
  if (!root) return root.error();
  CameraCalibration camera;
  if (Status read = read_camera(*root, camera); !read) return read.error();
  return camera;
}

}  // namespace

Result<CameraCalibration> parse_camera_info(const std::string& text, const std::string& name) {
  return to_camera(YamlMapping::parse(text, name, kContent));
}

Result<CameraCalibration> read_camera_info(const std::string& path) {
  return to_camera(YamlMapping::read(path, kContent));
}

Result<std::string> format_camera_info(const CameraCalibration& camera,
                                       const std::string& camera_name) {
  const std::string text = fmt::format("image_width: {}\nimage_height: {}\ncamera_name: {}\n",
                                       camera.width, camera.height, scalar(camera_name)) +
                           matrix("camera_matrix", 3, 3, camera.K) +
                           fmt::format("distortion_model: {}\n", scalar(camera.distortion_model)) +
                           matrix("distortion_coefficients", 1, camera.D.size(), camera.D) +
                           matrix("rectification_matrix", 3, 3, camera.R) +
                           matrix("projection_matrix", 3, 4, camera.P) + part_of_image(camera);
  const auto read = parse_camera_info(text, "camera_info of " + camera_name);
  if (!read) return read.error();
  if (!(*read == camera)) {
    return Error{ErrorKind::kCalibration,
                 fmt::format("camera_info of {}: YAML cannot represent its distortion_model \"{}\"",
                             camera_name, printable(camera.distortion_model))};
  }
  return text;
}

}  // namespace fpga_stereo
