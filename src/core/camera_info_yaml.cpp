#include "fpga_stereo/core/camera_info_yaml.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <fstream>
#include <utility>
#include <vector>

namespace fpga_stereo {
namespace {

constexpr std::size_t kMaxFileBytes = std::size_t{64} * 1024;
constexpr int kMaxCoefficients = kMaxDistortionCoefficients;
constexpr std::size_t kMaxQuotedBytes = 40;

/// A mapping of the file, with the path of keys that leads to it.
struct Mapping {
  std::string name;  // of the file
  std::string path;  // "camera_matrix.", or empty at the top
  YAML::Node node;
};

Error format_error(const Mapping& mapping, const std::string& key, const std::string& problem) {
  return {ErrorKind::kCalibration,
          fmt::format("{}: {}{} {}", mapping.name, mapping.path, key, problem)};
}

Error missing_key(const Mapping& mapping, const std::string& key) {
  return format_error(mapping, key, "is missing");
}

/// Quotes a value for an error message, shortened if it is long.
std::string quoted(const YAML::Node& node) {
  if (!node.IsScalar())
    return node.IsSequence() ? "(a list)" : node.IsMap() ? "(a mapping)" : "(empty)";
  const std::string& text = node.Scalar();
  if (text.size() <= kMaxQuotedBytes) return fmt::format("\"{}\"", text);
  return fmt::format("\"{}...\"", text.substr(0, kMaxQuotedBytes));
}

/// Reads a whole number between `min` and `max`.
Result<int> read_int(const Mapping& mapping, const std::string& key, int min, int max) {
  const YAML::Node node = mapping.node[key];
  if (!node.IsDefined()) return missing_key(mapping, key);
  int value = 0;
  if (!node.IsScalar() || !YAML::convert<int>::decode(node, value) || value < min || value > max) {
    const std::string allowed =
        min == max ? fmt::format("allowed is {}", min)
                   : fmt::format("allowed are whole numbers from {} to {}", min, max);
    return format_error(mapping, key, fmt::format("= {}: {}", quoted(node), allowed));
  }
  return value;
}

Result<int> read_optional_int(const Mapping& mapping, const std::string& key, int max) {
  if (!mapping.node[key].IsDefined()) return 0;
  return read_int(mapping, key, 0, max);
}

Result<Mapping> read_mapping(const Mapping& parent, const std::string& key) {
  const YAML::Node node = parent.node[key];
  if (!node.IsDefined()) return missing_key(parent, key);
  if (!node.IsMap()) {
    return format_error(parent, key, fmt::format("= {}: allowed is a mapping", quoted(node)));
  }
  return Mapping{parent.name, parent.path + key + ".", node};
}

/// Reads `rows` times `cols` finite numbers, row-major, from `data` of a matrix.
Result<std::vector<double>> read_data(const Mapping& matrix, int rows, int cols) {
  const YAML::Node data = matrix.node["data"];
  if (!data.IsDefined()) return missing_key(matrix, "data");
  const std::size_t count = static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols);
  const bool is_empty = data.IsNull() || (data.IsSequence() && data.size() == 0);
  if (count == 0 && is_empty) return std::vector<double>{};
  if (!data.IsSequence()) {
    return format_error(matrix, "data",
                        fmt::format("= {}: allowed is a list of numbers", quoted(data)));
  }
  if (data.size() != count) {
    return format_error(matrix, "data",
                        fmt::format("has {} values: rows = {} and cols = {} require {}",
                                    data.size(), rows, cols, count));
  }
  std::vector<double> values(count);
  for (std::size_t i = 0; i < count; ++i) {
    const YAML::Node value = data[i];
    if (!value.IsScalar() || !YAML::convert<double>::decode(value, values[i]) ||
        !std::isfinite(values[i])) {
      return format_error(matrix, fmt::format("data[{}]", i),
                          fmt::format("= {}: allowed are finite numbers", quoted(value)));
    }
  }
  return values;
}

/// Reads a matrix that has exactly `rows` rows and `cols` columns.
template <std::size_t Count>
Status read_matrix(const Mapping& root, const std::string& key, int rows, int cols,
                   std::array<double, Count>& values) {
  const Result<Mapping> matrix = read_mapping(root, key);
  if (!matrix) return matrix.error();
  if (const auto read = read_int(*matrix, "rows", rows, rows); !read) return read.error();
  if (const auto read = read_int(*matrix, "cols", cols, cols); !read) return read.error();
  const auto data = read_data(*matrix, rows, cols);
  if (!data) return data.error();
  std::copy(data->begin(), data->end(), values.begin());
  return {};
}

/// Reads the distortion coefficients: one row or one column, or no value at all.
Status read_distortion(const Mapping& root, CameraCalibration& camera) {
  camera.distortion_model = "plumb_bob";
  if (const YAML::Node model = root.node["distortion_model"]; model.IsDefined()) {
    if (!model.IsScalar()) {
      return format_error(root, "distortion_model",
                          fmt::format("= {}: allowed is a name", quoted(model)));
    }
    camera.distortion_model = model.Scalar();
  }
  const Result<Mapping> matrix = read_mapping(root, "distortion_coefficients");
  if (!matrix) return matrix.error();
  const auto rows = read_int(*matrix, "rows", 0, kMaxCoefficients);
  if (!rows) return rows.error();
  const auto cols = read_int(*matrix, "cols", 0, *rows > 1 ? 1 : kMaxCoefficients);
  if (!cols) return cols.error();
  auto data = read_data(*matrix, *rows, *cols);
  if (!data) return data.error();
  camera.D = std::move(*data);
  return {};
}

Status read_roi(const Mapping& root, cv::Rect& roi) {
  if (!root.node["roi"].IsDefined()) return {};
  const Result<Mapping> mapping = read_mapping(root, "roi");
  if (!mapping) return mapping.error();
  const std::pair<const char*, int*> fields[] = {
      {"x_offset", &roi.x}, {"y_offset", &roi.y}, {"width", &roi.width}, {"height", &roi.height}};
  for (const auto& [key, field] : fields) {
    const auto value = read_optional_int(*mapping, key, kMaxCalibratedSide);
    if (!value) return value.error();
    *field = *value;
  }
  return {};
}

Status read_sizes(const Mapping& root, CameraCalibration& camera) {
  const std::pair<const char*, int*> required[] = {{"image_width", &camera.width},
                                                   {"image_height", &camera.height}};
  for (const auto& [key, field] : required) {
    const auto value = read_int(root, key, 1, kMaxCalibratedSide);
    if (!value) return value.error();
    *field = *value;
  }
  const std::pair<const char*, int*> optional[] = {{"binning_x", &camera.binning_x},
                                                   {"binning_y", &camera.binning_y}};
  for (const auto& [key, field] : optional) {
    const auto value = read_optional_int(root, key, kMaxCalibratedSide);
    if (!value) return value.error();
    *field = *value;
  }
  return read_roi(root, camera.roi);
}

Result<CameraCalibration> read_camera(const Mapping& root) {
  CameraCalibration camera;
  if (Status status = read_sizes(root, camera); !status) return status.error();
  if (Status status = read_matrix(root, "camera_matrix", 3, 3, camera.K); !status) {
    return status.error();
  }
  if (Status status = read_distortion(root, camera); !status) return status.error();
  if (Status status = read_matrix(root, "rectification_matrix", 3, 3, camera.R); !status) {
    return status.error();
  }
  if (Status status = read_matrix(root, "projection_matrix", 3, 4, camera.P); !status) {
    return status.error();
  }
  return camera;
}

}  // namespace

Result<CameraCalibration> parse_camera_info(const std::string& text, const std::string& name) {
  if (text.size() > kMaxFileBytes) {
    return Error{ErrorKind::kCalibration,
                 fmt::format("{}: is larger than {} bytes, the limit for a camera_info file", name,
                             kMaxFileBytes)};
  }
  try {
    const Mapping root{name, "", YAML::Load(text)};
    if (!root.node.IsMap()) {
      return Error{
          ErrorKind::kCalibration,
          fmt::format("{}: is not a camera_info file: it must be a YAML mapping with the keys "
                      "image_width, image_height, camera_matrix, distortion_coefficients, "
                      "rectification_matrix and projection_matrix",
                      name)};
    }
    return read_camera(root);
  } catch (const YAML::Exception& e) {
    return Error{ErrorKind::kCalibration, fmt::format("{}: is not valid YAML: {}", name, e.what())};
  }
}

Result<CameraCalibration> read_camera_info(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text(kMaxFileBytes + 1, '\0');
  // Opening a directory succeeds; reading it fails.
  if (!file ||
      (!file.read(text.data(), static_cast<std::streamsize>(text.size())) && !file.eof())) {
    return Error{ErrorKind::kInvalid,
                 fmt::format("{}: cannot be read: {}", path, std::strerror(errno))};
  }
  text.resize(static_cast<std::size_t>(file.gcount()));
  return parse_camera_info(text, path);
}

}  // namespace fpga_stereo
