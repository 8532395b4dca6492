#include "evaluate/report.hpp"

#include <algorithm>
#include <iomanip>
#include <ostream>

namespace fpga_stereo::tools {

double ReportRow::average() const {
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    if (measure == kRms && kMiddleburyScenes[i].has_whole_truth) continue;
    sum += scenes[i];
    ++count;
  }
  return sum / count;
}

void Report::add(const std::string& algorithm, const std::string& configuration,
                 const std::string& measure, std::size_t scene, double value) {
  const auto found = std::find_if(rows_.begin(), rows_.end(), [&](const ReportRow& row) {
    return row.algorithm == algorithm && row.configuration == configuration &&
           row.measure == measure;
  });
  if (found == rows_.end()) {
    rows_.push_back({algorithm, configuration, measure});
    rows_.back().scenes[scene] = value;
  } else {
    found->scenes[scene] = value;
  }
}

void Report::add_regions(const std::string& algorithm, const std::string& configuration,
                         const MiddleburyPair& pair, std::size_t scene, const cv::Mat1w& disparity,
                         int min_disparity) {
  double sum = 0;
  for (const Region region : {kNonOccluded, kAll, kDiscontinuities}) {
    const double bad = score(pair, region, disparity, min_disparity).bad_of_all();
    add(algorithm, configuration, kRegionNames[region], scene, bad);
    sum += bad;
  }
  add(algorithm, configuration, "mean", scene, sum / static_cast<double>(kRegionNames.size()));
}

void Report::print_table(std::ostream& out) const {
  const auto text = [&](const std::string& value, int width) {
    out << std::left << std::setw(width) << value;
  };
  const auto number = [&](const auto& value) { out << std::right << std::setw(9) << value; };
  constexpr int kAlgorithm = 17, kConfiguration = 15, kMeasure = 9;
  text("algorithm", kAlgorithm), text("configuration", kConfiguration), text("measure", kMeasure);
  for (const MiddleburyScene& scene : kMiddleburyScenes) number(scene.name);
  number("average");
  out << "\n" << std::fixed;
  const ReportRow* last = nullptr;
  for (const ReportRow& row : rows_) {
    const bool same_algorithm = last != nullptr && last->algorithm == row.algorithm;
    const bool same = same_algorithm && last->configuration == row.configuration;
    text(same_algorithm ? "" : row.algorithm, kAlgorithm);
    text(same ? "" : row.configuration, kConfiguration);
    text(row.measure, kMeasure);
    out << std::setprecision(row.measure == kRms ? 3 : 2);
    for (const double value : row.scenes) number(value);
    number(row.average());
    out << "\n";
    last = &row;
  }
}

void Report::print_csv(std::ostream& out) const {
  out << "algorithm,configuration,measure";
  for (const MiddleburyScene& scene : kMiddleburyScenes) out << "," << scene.name;
  out << ",average\n" << std::fixed << std::setprecision(4);
  for (const ReportRow& row : rows_) {
    out << row.algorithm << "," << row.configuration << "," << row.measure;
    for (const double value : row.scenes) out << "," << value;
    out << "," << row.average() << "\n";
  }
}

}  // namespace fpga_stereo::tools
