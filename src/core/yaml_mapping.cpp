#include "core/yaml_mapping.hpp"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <sstream>
#include <utility>

#include "core/printable.hpp"

namespace fpga_stereo {
namespace {

constexpr std::size_t kMaxYamlBytes = std::size_t{64} * 1024;
constexpr int kMaxLevels = 16;
constexpr std::size_t kMaxValueBytes = 40;
constexpr std::size_t kMaxParserBytes = 200;  // of an error of yaml-cpp

/// Throws a text if a document has what no calibration file needs. yaml-cpp would recurse into any
/// number of levels.
class StructureCheck : public YAML::EventHandler {
 public:
  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
  void OnScalar(const YAML::Mark&, const std::string&, YAML::anchor_t,
                const std::string&) override {}
  void OnAlias(const YAML::Mark&, YAML::anchor_t) override {
    throw std::string("has an alias (*), which is not allowed");
  }
  void OnSequenceStart(const YAML::Mark&, const std::string&, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {
    enter();
  }
  void OnSequenceEnd() override { --levels_; }
  void OnMapStart(const YAML::Mark&, const std::string&, YAML::anchor_t,
                  YAML::EmitterStyle::value) override {
    enter();
  }
  void OnMapEnd() override { --levels_; }

 private:
  void enter() {
    if (++levels_ > kMaxLevels) {
      throw fmt::format("is nested more deeply than {} levels, the limit", kMaxLevels);
    }
  }

  int levels_ = 0;
};

/// Quotes a value for an error message.
std::string quoted(const YAML::Node& node) {
  if (node.IsSequence()) return "(a list)";
  if (node.IsMap()) return "(a mapping)";
  if (!node.IsScalar()) return "(empty)";
  return fmt::format("\"{}\"", printable(node.Scalar(), kMaxValueBytes));
}

Error file_error(const std::string& name, const std::string& problem) {
  return {ErrorKind::kCalibration, fmt::format("{}: {}", name, problem)};
}

}  // namespace

YamlMapping::YamlMapping(std::string name, std::string path, const YAML::Node& node)
    : name_(std::move(name)), path_(std::move(path)), node_(node) {}

Result<YamlMapping> YamlMapping::parse(const std::string& text, const std::string& name,
                                       const std::string& content) {
  if (text.size() > kMaxYamlBytes) {
    return file_error(name, fmt::format("is larger than {} bytes, the limit", kMaxYamlBytes));
  }
  try {
    std::istringstream stream(text);
    StructureCheck check;
    YAML::Parser(stream).HandleNextDocument(check);
    const YAML::Node top = YAML::Load(text);
    if (!top.IsMap()) return file_error(name, "is not " + content);
    return YamlMapping(name, "", top);
  } catch (const std::string& problem) {
    return file_error(name, problem);
  } catch (const YAML::Exception& e) {
    return file_error(name, "is not valid YAML: " + printable(e.what(), kMaxParserBytes));
  }
}

Result<YamlMapping> YamlMapping::read(const std::string& path, const std::string& content) {
  std::ifstream file(path, std::ios::binary);
  std::string text(kMaxYamlBytes + 1, '\0');
  // Opening a directory succeeds; reading it fails.
  if (!file ||
      (!file.read(text.data(), static_cast<std::streamsize>(text.size())) && !file.eof())) {
    return Error{ErrorKind::kInvalid,
                 fmt::format("{}: cannot be read: {}", path, std::strerror(errno))};
  }
  text.resize(static_cast<std::size_t>(file.gcount()));
  return parse(text, path, content);
}

Error YamlMapping::error(const std::string& key, const std::string& problem) const {
  return file_error(name_, fmt::format("{}{} {}", path_, key, problem));
}

Error YamlMapping::missing(const std::string& key) const { return error(key, "is missing"); }

bool YamlMapping::has(const std::string& key) const { return node_[key].IsDefined(); }

Result<YamlMapping> YamlMapping::mapping(const std::string& key) const {
  const YAML::Node node = node_[key];
  if (!node.IsDefined()) return missing(key);
  if (!node.IsMap()) return error(key, fmt::format("= {}: allowed is a mapping", quoted(node)));
  return YamlMapping(name_, path_ + key + ".", node);
}

Result<std::string> YamlMapping::text(const std::string& key) const {
  const YAML::Node node = node_[key];
  if (!node.IsDefined()) return missing(key);
  if (!node.IsScalar()) return error(key, fmt::format("= {}: allowed is a name", quoted(node)));
  return node.Scalar();
}

Result<int> YamlMapping::integer(const std::string& key, int min, int max) const {
  const YAML::Node node = node_[key];
  if (!node.IsDefined()) return missing(key);
  int value = 0;
  if (!node.IsScalar() || !YAML::convert<int>::decode(node, value) || value < min || value > max) {
    const std::string allowed =
        min == max ? fmt::format("allowed is {}", min)
                   : fmt::format("allowed are whole numbers from {} to {}", min, max);
    return error(key, fmt::format("= {}: {}", quoted(node), allowed));
  }
  return value;
}

Result<std::vector<double>> YamlMapping::numbers(const std::string& key, std::size_t count,
                                                 const std::string& reason) const {
  const YAML::Node list = node_[key];
  if (!list.IsDefined()) return missing(key);
  const bool is_empty = list.IsNull() || (list.IsSequence() && list.size() == 0);
  if (count == 0 && is_empty) return std::vector<double>{};
  if (!list.IsSequence()) {
    return error(key, fmt::format("= {}: allowed is a list of numbers", quoted(list)));
  }
  if (list.size() != count) {
    return error(key, fmt::format("has {} values: {} {}", list.size(), reason, count));
  }
  std::vector<double> values(count);
  for (std::size_t i = 0; i < count; ++i) {
    const YAML::Node value = list[i];
    if (!value.IsScalar() || !YAML::convert<double>::decode(value, values[i]) ||
        !std::isfinite(values[i])) {
      return error(fmt::format("{}[{}]", key, i),
                   fmt::format("= {}: allowed are finite numbers", quoted(value)));
    }
  }
  return values;
}

Result<std::vector<double>> YamlMapping::matrix(const std::string& key, int rows, int cols) const {
  const Result<YamlMapping> matrix = mapping(key);
  if (!matrix) return matrix.error();
  if (const auto read = matrix->integer("rows", rows, rows); !read) return read.error();
  if (const auto read = matrix->integer("cols", cols, cols); !read) return read.error();
  return matrix->numbers("data", static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols),
                         fmt::format("rows = {} and cols = {} require", rows, cols));
}

}  // namespace fpga_stereo
