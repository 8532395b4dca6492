// Reads values from YAML files that anybody may have written.
#pragma once

#include <yaml-cpp/yaml.h>

#include <cstddef>
#include <string>
#include <vector>

#include "fpga_stereo/core/result.hpp"

namespace fpga_stereo {

/// A mapping of a YAML file. Errors are of the kind kCalibration and name the file, the key, its
/// value and what is allowed.
class YamlMapping {
 public:
  /// Parses the text of a file; errors call it `name`. The top must be a mapping: `content` says in
  /// the error what it should be. Refuses more than 64 KiB, more than 16 levels, and aliases.
  static Result<YamlMapping> parse(const std::string& text, const std::string& name,
                                   const std::string& content);
  /// Reads and parses the file at `path`.
  static Result<YamlMapping> read(const std::string& path, const std::string& content);

  bool has(const std::string& key) const;
  Result<YamlMapping> mapping(const std::string& key) const;
  Result<std::string> text(const std::string& key) const;
  /// Reads a whole number between `min` and `max`.
  Result<int> integer(const std::string& key, int min, int max) const;
  /// Reads a list of `count` finite numbers. The error says that `reason` requires so many.
  Result<std::vector<double>> numbers(const std::string& key, std::size_t count,
                                      const std::string& reason) const;
  /// Reads a matrix of exactly this size: a mapping with rows, cols and data, row-major.
  Result<std::vector<double>> matrix(const std::string& key, int rows, int cols) const;

 private:
  YamlMapping(std::string name, std::string path, const YAML::Node& node);

  Error error(const std::string& key, const std::string& problem) const;
  Error missing(const std::string& key) const;

  std::string name_;  // of the file
  std::string path_;  // of keys: "camera_matrix.", or empty at the top
  YAML::Node node_;
};

}  // namespace fpga_stereo
