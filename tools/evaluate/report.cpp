#include "evaluate/report.hpp"

#include <iomanip>
#include <numeric>
#include <ostream>

namespace fpga_stereo::tools {

double ReportRow::average() const {
  return std::accumulate(scenes.begin(), scenes.end(), 0.0) / static_cast<double>(scenes.size());
}

void print_table(const std::vector<ReportRow>& rows, std::ostream& out) {
  const auto text = [&](const std::string& value, int width) {
    out << std::left << std::setw(width) << value;
  };
  const auto number = [&](const auto& value) { out << std::right << std::setw(9) << value; };
  out << std::fixed << std::setprecision(2);
  text("pattern", 9), text("configuration", 15), text("measure", 9);
  for (const MiddleburyScene& scene : kMiddleburyScenes) number(scene.name);
  number("average");
  out << "\n";
  const ReportRow* last = nullptr;
  for (const ReportRow& row : rows) {
    const bool same_pattern = last != nullptr && last->pattern == row.pattern;
    const bool same = same_pattern && last->configuration == row.configuration;
    text(same ? "" : row.pattern, 9);
    text(same ? "" : row.configuration, 15);
    text(row.measure, 9);
    for (const double value : row.scenes) number(value);
    number(row.average());
    out << "\n";
    last = &row;
  }
}

void print_csv(const std::vector<ReportRow>& rows, std::ostream& out) {
  out << "pattern,configuration,measure";
  for (const MiddleburyScene& scene : kMiddleburyScenes) out << "," << scene.name;
  out << ",average\n" << std::fixed << std::setprecision(4);
  for (const ReportRow& row : rows) {
    out << row.pattern << "," << row.configuration << "," << row.measure;
    for (const double value : row.scenes) out << "," << value;
    out << "," << row.average() << "\n";
  }
}

}  // namespace fpga_stereo::tools
