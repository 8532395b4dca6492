// The results of an evaluation and their output.
#pragma once

#include <array>
#include <iosfwd>
#include <string>
#include <vector>

#include "support/middlebury.hpp"

namespace fpga_stereo::tools {

/// One measure for all scenes, percent.
struct ReportRow {
  std::string pattern;        // census pattern
  std::string configuration;  // dense, filled, semi-dense
  std::string measure;        // nonocc, all, disc, mean, coverage
  std::array<double, kMiddleburyScenes.size()> scenes{};

  double average() const;
};

/// Prints aligned columns with two decimals.
void print_table(const std::vector<ReportRow>& rows, std::ostream& out);
/// Prints comma-separated values with four decimals.
void print_csv(const std::vector<ReportRow>& rows, std::ostream& out);

}  // namespace fpga_stereo::tools
