// The results of an evaluation and their output.
#pragma once

#include <array>
#include <iosfwd>
#include <string>
#include <vector>

#include "support/middlebury.hpp"

namespace fpga_stereo::tools {

/// The measure that is in px; all others are in percent.
constexpr const char* kRms = "rms";

/// One measure for all scenes.
struct ReportRow {
  std::string algorithm;      // sgm full
  std::string configuration;  // dense, raw, filled, semi-dense
  std::string measure;        // nonocc, all, disc, mean, coverage, rms
  std::array<double, kMiddleburyScenes.size()> scenes{};

  /// Returns the mean over the scenes. That of kRms leaves out scenes whose truth is whole pixels.
  double average() const;
};

/// Rows in the order in which they were added.
class Report {
 public:
  /// Sets a value; adds its row if necessary. `scene` is an index of kMiddleburyScenes.
  void add(const std::string& algorithm, const std::string& configuration,
           const std::string& measure, std::size_t scene, double value);
  /// Adds nonocc, all, disc and their mean: percentages of pixels that are bad or have no
  /// disparity.
  void add_regions(const std::string& algorithm, const std::string& configuration,
                   const MiddleburyPair& pair, std::size_t scene, const cv::Mat1w& disparity,
                   int min_disparity);

  /// Prints aligned columns: percentages with two decimals, px with three.
  void print_table(std::ostream& out) const;
  /// Prints comma-separated values with four decimals.
  void print_csv(std::ostream& out) const;

 private:
  std::vector<ReportRow> rows_;
};

}  // namespace fpga_stereo::tools
