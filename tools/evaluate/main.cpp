// evaluate DIR: counts bad pixels on the four pairs of the Middlebury stereo evaluation, version 2.
#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <iostream>

#include "evaluate/peers.hpp"
#include "evaluate/report.hpp"
#include "fpga_stereo/core/convert.hpp"
#include "fpga_stereo/core/pipeline.hpp"
#include "support/files.hpp"
#include "support/parameter_options.hpp"
#include "support/program.hpp"

namespace fpga_stereo::tools {
namespace {

namespace po = boost::program_options;

CommandLine command_line() {
  CommandLine line;
  line.usage =
      "Usage: evaluate DIR [options]\n"
      "Counts bad pixels on the Middlebury stereo evaluation, version 2. A pixel is bad if its\n"
      "error is above 1.0 px. DIR contains tsukuba, venus, teddy and cones; each of them contains\n"
      "imL.png, imR.png, groundtruth.png, nonocc.png, all.png and disc.png.\n"
      "Configurations, for both census patterns unless --census_pattern is given:\n"
      "  dense       no checks, no speckle filter, no sub-pixel refinement; percentage of bad\n"
      "              pixels in nonocc, all and disc\n"
      "  filled      the given or default parameters; a hole takes the smaller of the nearest\n"
      "              disparities to its left and right; the same percentages\n"
      "  semi-dense  the given or default parameters; percentage of bad pixels among the nonocc\n"
      "              pixels with a disparity, and the percentage with a disparity (coverage)\n"
      "Every pair is searched over the range of the benchmark (16, 20, 60 and 60 disparities)\n"
      "unless --disparity_range is given.\n"
      "--opencv adds OpenCV's StereoBM (window 15) and StereoSGBM (block size 5), with holes "
      "filled\n"
      "in the same way.\n";
  line.positional = {"DIR"};
  line.options.add_options()("csv", po::value<std::string>()->value_name("FILE"),
                             "also write the table as comma-separated values");
  line.options.add_options()(
      "pictures", po::value<std::string>()->value_name("DIR"),
      "write pictures of all disparities and their errors: black = correct, white = bad, "
      "grey = not evaluated");
  line.options.add_options()("opencv", "also evaluate OpenCV's block matchers");
  add_threads_option(line.options);
  line.options.add(parameter_options());
  return line;
}

struct Evaluation {
  std::string pictures;  // folder, or empty
  int num_threads = 1;
  Parameters given;
  bool range_given = false;
};

void write_pictures(const Evaluation& evaluation, const MiddleburyPair& pair,
                    const std::string& configuration, Region region, bool holes_count,
                    const cv::Mat1w& disparity, const Parameters& p) {
  if (evaluation.pictures.empty()) return;
  const std::string stem = fmt::format("{}/{}_{}_{}", evaluation.pictures, pair.scene.name,
                                       to_text(p.census_pattern), configuration);
  cv::Mat3b picture;
  to_color(disparity, p.disparity_range, picture);
  write_image(stem + "_disparity.png", picture);
  write_image(stem + "_errors.png",
              error_picture(pair, region, disparity, p.min_disparity, holes_count));
}

/// Fills the rows nonocc, all, disc and mean of a configuration in which every pixel has a
/// disparity.
void add_regions(const MiddleburyPair& pair, std::size_t scene, const cv::Mat1w& disparity,
                 int min_disparity, ReportRow* rows) {
  for (const Region region : {kNonOccluded, kAll, kDiscontinuities}) {
    const double bad = score(pair, region, disparity, min_disparity).bad_of_all();
    rows[region].scenes[scene] = bad;
    rows[kRegionNames.size()].scenes[scene] += bad / static_cast<double>(kRegionNames.size());
  }
}

void append_regions(const std::string& pattern, const std::string& configuration,
                    std::vector<ReportRow>& rows) {
  for (const char* region : kRegionNames) rows.push_back({pattern, configuration, region});
  rows.push_back({pattern, configuration, "mean"});
}

/// Returns the rows of one census pattern, all zero.
std::vector<ReportRow> empty_rows(const std::string& pattern) {
  std::vector<ReportRow> rows;
  append_regions(pattern, "dense", rows);
  append_regions(pattern, "filled", rows);
  rows.push_back({pattern, "semi-dense", "nonocc"});
  rows.push_back({pattern, "semi-dense", "coverage"});
  return rows;
}

void evaluate_pair(const Evaluation& evaluation, const MiddleburyPair& pair, std::size_t scene,
                   Parameters p, std::vector<ReportRow>& rows) {
  constexpr std::size_t kDenseRow = 0, kFilledRow = 4, kSemiDenseRow = 8, kCoverageRow = 9;
  if (!evaluation.range_given) p.disparity_range = pair.scene.disparity_range;
  StereoGeometry geometry;
  geometry.image_size = pair.left.size();
  const StereoRectification identity = identity_rectification(geometry, p.min_disparity);
  const std::string prefix = std::string(pair.scene.name) + ": ";
  require(validate_image(pair.left, identity, "left"), prefix);
  Pipeline pipeline;

  Parameters dense = p;
  dense.left_right_check = dense.uniqueness_check = dense.subpixel = false;
  dense.speckle_size = 0;
  cv::Mat1w disparity =
      pipeline.process(pair.left, pair.right, identity, dense, evaluation.num_threads).disparity;
  add_regions(pair, scene, disparity, p.min_disparity, &rows[kDenseRow]);
  write_pictures(evaluation, pair, "dense", kAll, true, disparity, p);

  disparity =
      pipeline.process(pair.left, pair.right, identity, p, evaluation.num_threads).disparity;
  const Score semi_dense = score(pair, kNonOccluded, disparity, p.min_disparity);
  rows[kSemiDenseRow].scenes[scene] = semi_dense.bad_of_valid();
  rows[kCoverageRow].scenes[scene] = semi_dense.coverage();
  write_pictures(evaluation, pair, "semi-dense", kNonOccluded, false, disparity, p);

  disparity = fill_holes(disparity);
  add_regions(pair, scene, disparity, p.min_disparity, &rows[kFilledRow]);
  write_pictures(evaluation, pair, "filled", kAll, true, disparity, p);
}

std::vector<ReportRow> evaluate_peer(const Evaluation& evaluation, const std::string& peer,
                                     const std::vector<MiddleburyPair>& pairs) {
  std::vector<ReportRow> rows;
  append_regions(peer, "filled", rows);
  for (std::size_t scene = 0; scene < pairs.size(); ++scene) {
    const MiddleburyPair& pair = pairs[scene];
    const int range =
        evaluation.range_given ? evaluation.given.disparity_range : pair.scene.disparity_range;
    const cv::Mat1w disparity = peer_disparity(peer, pair.left, pair.right, range);
    add_regions(pair, scene, fill_holes(disparity), 0, rows.data());
  }
  return rows;
}

void evaluate(const Arguments& arguments) {
  const auto parsed = parse(command_line(), arguments);
  if (!parsed) return;
  const po::variables_map& options = parsed->options;
  Evaluation evaluation;
  evaluation.given = parameters_from(options);
  evaluation.range_given = options.count("disparity_range") != 0;
  evaluation.num_threads = threads(options);
  std::vector<CensusPattern> patterns{CensusPattern::kSparse, CensusPattern::kFull};
  if (options.count("census_pattern") != 0) patterns = {evaluation.given.census_pattern};

  std::vector<MiddleburyPair> pairs;
  for (const MiddleburyScene& scene : kMiddleburyScenes) {
    pairs.push_back(read_pair(parsed->positional[0], scene));
  }
  if (options.count("pictures") != 0) {
    evaluation.pictures = options["pictures"].as<std::string>();
    create_folder(evaluation.pictures);
  }
  std::ofstream csv;
  if (options.count("csv") != 0) {
    csv.open(options["csv"].as<std::string>());
    if (!csv) throw std::runtime_error(options["csv"].as<std::string>() + ": cannot be written");
  }

  Progress progress("evaluate", patterns.size() * pairs.size());
  std::vector<ReportRow> all_rows;
  for (const CensusPattern pattern : patterns) {
    std::vector<ReportRow> rows = empty_rows(to_text(pattern));
    Parameters p = evaluation.given;
    p.census_pattern = pattern;
    for (std::size_t scene = 0; scene < pairs.size(); ++scene) {
      evaluate_pair(evaluation, pairs[scene], scene, p, rows);
      progress.done(fmt::format("{} {}", pairs[scene].scene.name, to_text(pattern)));
    }
    all_rows.insert(all_rows.end(), rows.begin(), rows.end());
  }
  for (const char* peer : kPeers) {
    if (options.count("opencv") == 0) break;
    const std::vector<ReportRow> rows = evaluate_peer(evaluation, peer, pairs);
    all_rows.insert(all_rows.end(), rows.begin(), rows.end());
  }
  std::cout << "Bad pixels (error above 1.0 px) and coverage, percent\n";
  print_table(all_rows, std::cout);
  if (csv.is_open()) {
    print_csv(all_rows, csv);
    csv.close();
    if (!csv) throw std::runtime_error(options["csv"].as<std::string>() + ": cannot be written");
  }
}

}  // namespace
}  // namespace fpga_stereo::tools

int main(int argc, char** argv) {
  return fpga_stereo::tools::run_program("evaluate", argc, argv, fpga_stereo::tools::evaluate);
}
