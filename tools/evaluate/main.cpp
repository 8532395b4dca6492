// evaluate DIR: counts bad pixels on the four pairs of the Middlebury stereo evaluation, version 2.
#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iostream>

#include "core/stages.hpp"
#include "evaluate/report.hpp"
#include "fpga_stereo/core/convert.hpp"
#include "fpga_stereo/core/pipeline.hpp"
#include "support/files.hpp"
#include "support/opencv_matcher.hpp"
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
      "Algorithms: window sparse, window full, sgm full, sgm small. --stereo-algorithm,\n"
      "--census-pattern and --sgm-build leave out those with other values.\n"
      "Configurations, with the given or default parameters:\n"
      "  dense       with dense = true; percentage of bad pixels in nonocc, all and disc\n"
      "  raw         with --raw: no checks, no speckle filter, no sub-pixel refinement; the same\n"
      "              percentages\n"
      "  filled      window matching; a hole takes the smaller of the nearest disparities to its\n"
      "              left and right; the same percentages\n"
      "  semi-dense  with dense = false; percentage of bad pixels among the nonocc pixels with a\n"
      "              disparity, and the percentage with a disparity (coverage)\n"
      "--dense true prints only the first of these, --dense false only the others.\n"
      "rms is the RMS error of the nonocc pixels that are not bad, in px. Its average leaves out\n"
      "tsukuba, whose ground truth is whole pixels.\n"
      "Every pair is searched over the range of the benchmark (16, 20, 60 and 60 disparities)\n"
      "unless --disparity-range is given.\n"
      "--opencv adds OpenCV's StereoBM (window 15) and StereoSGBM (block size 5; also with\n"
      "MODE_SGBM_3WAY and MODE_HH), semi-dense and filled.\n";
  line.positional = {"DIR"};
  line.options.add_options()("csv", po::value<std::string>()->value_name("FILE"),
                             "also write the table as comma-separated values");
  line.options.add_options()(
      "pictures", po::value<std::string>()->value_name("DIR"),
      "write pictures of all disparities and their errors: black = correct, white = bad, "
      "grey = not evaluated");
  line.options.add_options()("raw", po::bool_switch(), "add the configuration raw");
  line.options.add_options()("opencv", po::bool_switch(), "also evaluate OpenCV's matchers");
  add_threads_option(line.options);
  line.options.add(parameter_options());
  return line;
}

constexpr const char *kDense = "dense", *kRaw = "raw", *kFilled = "filled",
                     *kSemiDense = "semi-dense";

/// Returns "window full", "sgm small".
std::string name_of(const Parameters& p) {
  const bool is_window = p.stereo_algorithm == StereoAlgorithm::kWindow;
  return to_text(p.stereo_algorithm) + " " +
         (is_window ? to_text(p.census_pattern) : to_text(p.sgm_build));
}

/// Returns the algorithms that the options leave, with all given parameters.
std::vector<Parameters> algorithms(const po::variables_map& options) {
  std::vector<Parameters> all(4, window_parameters());
  all[1].census_pattern = CensusPattern::kFull;
  all[2] = all[3] = Parameters();
  all[3].sgm_build = SgmBuild::kSmall;
  std::vector<Parameters> left;
  for (const Parameters& algorithm : all) {
    const Parameters p = parameters_from(options, algorithm);
    if (name_of(p) == name_of(algorithm)) left.push_back(p);
  }
  return left;
}

class Evaluation {
 public:
  explicit Evaluation(const po::variables_map& options)
      : range_given_(options.count("disparity-range") != 0),
        given_(parameters_from(options)),
        num_threads_(threads(options)),
        wants_raw_(options["raw"].as<bool>()) {
    const bool dense_given = options.count("dense") != 0;
    wants_dense_ = !dense_given || given_.dense;
    wants_semi_dense_ = !dense_given || !given_.dense;
    if (options.count("pictures") == 0) return;
    pictures_ = options["pictures"].as<std::string>();
    create_folder(pictures_);
  }

  const Report& report() const { return report_; }

  /// Adds the rows of one of our algorithms.
  void add(const MiddleburyPair& pair, std::size_t scene, Parameters p) {
    const std::string algorithm = name_of(p);
    p.disparity_range = range(pair);
    p.dense = false;
    if (wants_dense_) {
      Parameters dense = p;
      dense.dense = true;
      add_filled(pair, scene, algorithm, kDense, compute(pair, dense), p);
    }
    if (wants_raw_) {
      Parameters raw = p;
      raw.left_right_check = raw.uniqueness_check = raw.subpixel = false;
      raw.speckle_size = 0;
      const cv::Mat1w disparity = compute(pair, raw);
      report_.add_regions(algorithm, kRaw, pair, scene, disparity, p.min_disparity);
      write_pictures(pair, algorithm, kRaw, kAll, true, disparity, p);
    }
    if (!wants_semi_dense_) return;
    cv::Mat1w disparity = compute(pair, p);
    if (p.stereo_algorithm == StereoAlgorithm::kWindow) {
      cv::Mat1w filled = disparity.clone();
      fill(cv::Range::all(), filled);
      add_filled(pair, scene, algorithm, kFilled, filled, p);
    }
    add_semi_dense(pair, scene, algorithm, disparity, p);
  }

  /// Adds the rows of a matcher of OpenCV.
  void add(const MiddleburyPair& pair, std::size_t scene, OpencvMatcher matcher) {
    if (!wants_semi_dense_) return;
    Parameters p;
    p.disparity_range = range(pair);
    const cv::Mat1w disparity =
        opencv_disparity(matcher, pair.left, pair.right, p.min_disparity, p.disparity_range);
    cv::Mat1w filled = disparity.clone();
    if (matcher == OpencvMatcher::kBm) extend_rows(filled);
    fill(cv::Range::all(), filled);
    add_filled(pair, scene, to_text(matcher), kFilled, filled, p);
    add_semi_dense(pair, scene, to_text(matcher), disparity, p);
  }

 private:
  int range(const MiddleburyPair& pair) const {
    return range_given_ ? given_.disparity_range : pair.scene.disparity_range;
  }

  cv::Mat1w compute(const MiddleburyPair& pair, const Parameters& p) {
    StereoGeometry geometry;
    geometry.image_size = pair.left.size();
    const StereoRectification identity = identity_rectification(geometry, p.min_disparity);
    require(validate_image(pair.left, identity, "left"), std::string(pair.scene.name) + ": ");
    return pipeline_.process(pair.left, pair.right, identity, p, num_threads_).disparity.clone();
  }

  void add_filled(const MiddleburyPair& pair, std::size_t scene, const std::string& algorithm,
                  const std::string& configuration, const cv::Mat1w& disparity,
                  const Parameters& p) {
    report_.add_regions(algorithm, configuration, pair, scene, disparity, p.min_disparity);
    const Score nonocc = score(pair, kNonOccluded, disparity, p.min_disparity);
    report_.add(algorithm, configuration, kRms, scene, nonocc.rms_of_good());
    write_pictures(pair, algorithm, configuration, kAll, true, disparity, p);
  }

  void add_semi_dense(const MiddleburyPair& pair, std::size_t scene, const std::string& algorithm,
                      const cv::Mat1w& disparity, const Parameters& p) {
    const Score nonocc = score(pair, kNonOccluded, disparity, p.min_disparity);
    report_.add(algorithm, kSemiDense, "nonocc", scene, nonocc.bad_of_valid());
    report_.add(algorithm, kSemiDense, "coverage", scene, nonocc.coverage());
    report_.add(algorithm, kSemiDense, kRms, scene, nonocc.rms_of_good());
    write_pictures(pair, algorithm, kSemiDense, kNonOccluded, false, disparity, p);
  }

  void write_pictures(const MiddleburyPair& pair, std::string algorithm,
                      const std::string& configuration, Region region, bool holes_count,
                      const cv::Mat1w& disparity, const Parameters& p) const {
    if (pictures_.empty()) return;
    std::replace(algorithm.begin(), algorithm.end(), ' ', '_');
    const std::string stem =
        fmt::format("{}/{}_{}_{}", pictures_, pair.scene.name, algorithm, configuration);
    cv::Mat3b picture;
    to_color(disparity, p.disparity_range, picture);
    write_image(stem + "_disparity.png", picture);
    write_image(stem + "_errors.png",
                error_picture(pair, region, disparity, p.min_disparity, holes_count));
  }

  const bool range_given_;
  const Parameters given_;
  const int num_threads_;
  const bool wants_raw_;
  bool wants_dense_ = true, wants_semi_dense_ = true;
  std::string pictures_;  // folder, or empty
  Pipeline pipeline_;
  Report report_;
};

void evaluate(const Arguments& arguments) {
  const auto parsed = parse(command_line(), arguments);
  if (!parsed) return;
  const po::variables_map& options = parsed->options;
  const std::vector<Parameters> ours = algorithms(options);
  const bool wants_peers = options["opencv"].as<bool>();

  std::vector<MiddleburyPair> pairs;
  for (const MiddleburyScene& scene : kMiddleburyScenes) {
    pairs.push_back(read_pair(parsed->positional[0], scene));
  }
  Evaluation evaluation(options);
  std::ofstream csv;
  if (options.count("csv") != 0) csv = create_file(options["csv"].as<std::string>());

  const std::size_t num_peers = wants_peers ? kOpencvMatchers.size() : 0;
  Progress progress("evaluate", (ours.size() + num_peers) * pairs.size());
  const auto evaluate_all = [&](const std::string& name, const auto& contender) {
    for (std::size_t scene = 0; scene < pairs.size(); ++scene) {
      evaluation.add(pairs[scene], scene, contender);
      progress.done(fmt::format("{}, {}", pairs[scene].scene.name, name));
    }
  };
  for (const Parameters& p : ours) evaluate_all(name_of(p), p);
  for (std::size_t i = 0; i < num_peers; ++i) {
    evaluate_all(to_text(kOpencvMatchers[i]), kOpencvMatchers[i]);
  }
  std::cout << "Bad pixels (error above 1.0 px) and coverage, percent; rms in px\n";
  evaluation.report().print_table(std::cout);
  if (csv.is_open()) {
    evaluation.report().print_csv(csv);
    close_file(csv, options["csv"].as<std::string>());
  }
}

}  // namespace
}  // namespace fpga_stereo::tools

int main(int argc, char** argv) {
  return fpga_stereo::tools::run_program("evaluate", argc, argv, fpga_stereo::tools::evaluate);
}
