// evaluate_raw DIR: measures disparities of raw pairs that have no ground truth.
#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <iostream>

#include "evaluate_raw/collectors.hpp"
#include "evaluate_raw/raw_pairs.hpp"
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
      "Usage: evaluate_raw DIR [options]\n"
      "Measures disparities of raw pairs that have no ground truth: those of window, sgm, sgm "
      "dense\n"
      "and OpenCV's StereoBM and StereoSGBM (also with MODE_SGBM_3WAY and MODE_HH) on the same\n"
      "rectified images. --stereo-algorithm and --dense leave out those of ours with other "
      "values.\n"
      "DIR is one of\n"
      "  a sequence of EuRoC: cam0 and cam1, each with sensor.yaml and data/<time>.png.\n"
      "    The left image is predicted from the right one by the disparity, after both were given\n"
      "    the same brightness and contrast. The table shows the percentage of pixels with a\n"
      "    disparity (coverage), and mean and median of the absolute difference in grey levels:\n"
      "    over all pixels that are predicted, and over those that all predict (common). No\n"
      "    disparity predicts what the right camera does not see.\n"
      "  chessboards: left*, right*, intrinsics.yml and extrinsics.yml, as the sample "
      "stereo_calib\n"
      "    of OpenCV writes them. The range begins at 90 px and has 128 disparities unless given.\n"
      "    The table shows, on average: the percentage of pixels of the board that have a "
      "disparity\n"
      "    (coverage), RMS and median distance of their points from a plane, the percentage of\n"
      "    corners with a disparity, and by how much the mean distance of neighbouring corners\n"
      "    differs from --square.\n";
  line.positional = {"DIR"};
  line.options.add_options()("first", po::value<int>()->value_name("N")->default_value(1000),
                             "use only the first N pairs [1 to 1000]");
  line.options.add_options()("board",
                             po::value<std::string>()->value_name("CxR")->default_value("9x6"),
                             "inner corners of the chessboard, columns x rows");
  line.options.add_options()("square",
                             po::value<double>()->value_name("METRES")->default_value(0.025),
                             "side of a square of the chessboard, m [0.0001 to 100]");
  line.options.add_options()("csv", po::value<std::string>()->value_name("FILE"),
                             "also write the table as comma-separated values");
  add_threads_option(line.options);
  line.options.add(parameter_options());
  return line;
}

/// Returns "window", "sgm", "sgm dense".
std::string name_of(const Parameters& p) {
  return to_text(p.stereo_algorithm) + (p.dense ? " dense" : "");
}

/// Computes disparities in 1/32 px from min_disparity on.
struct Contender {
  std::string name;
  std::function<cv::Mat1w(const Images&)> compute;
};

/// The result of a contender.
struct Row {
  std::string name;
  std::vector<double> values;
};

std::vector<Contender> make_contenders(const po::variables_map& options, const Parameters& defaults,
                                       const StereoRectification& rectification, Pipeline& pipeline,
                                       int num_threads) {
  std::vector<Contender> contenders;
  std::vector<Parameters> ours(3, defaults);
  ours[0].stereo_algorithm = StereoAlgorithm::kWindow;
  ours[2].dense = true;
  for (const Parameters& each : ours) {
    const Parameters p = parameters_from(options, each);
    if (name_of(p) != name_of(each)) continue;
    contenders.push_back(
        {name_of(p), [&, p, num_threads](const Images& images) {
           return pipeline.process(images.left_raw, images.right_raw, rectification, p, num_threads)
               .disparity.clone();
         }});
  }
  const Parameters p = parameters_from(options, defaults);
  for (const OpencvMatcher matcher : kOpencvMatchers) {
    contenders.push_back({to_text(matcher), [p, matcher](const Images& images) {
                            return opencv_disparity(matcher, images.left, images.right,
                                                    p.min_disparity, p.disparity_range);
                          }});
  }
  return contenders;
}

template <class Titles>
void print_table(const Titles& titles, const std::vector<Row>& rows) {
  std::cout << fmt::format("{:17}", "contender");
  for (const char* title : titles) std::cout << fmt::format("{:>16}", title);
  std::cout << "\n";
  for (const Row& row : rows) {
    std::cout << fmt::format("{:17}", row.name);
    for (const double value : row.values) std::cout << fmt::format("{:16.2f}", value);
    std::cout << "\n";
  }
}

template <class Titles>
void write_csv(const std::string& path, const Titles& titles, const std::vector<Row>& rows) {
  std::ofstream csv = create_file(path);
  csv << "contender";
  for (std::string title : titles) {
    title.erase(std::remove(title.begin(), title.end(), ','), title.end());
    csv << "," << title;
  }
  csv << "\n";
  for (const Row& row : rows) {
    csv << row.name;
    for (const double value : row.values) csv << fmt::format(",{:.4f}", value);
    csv << "\n";
  }
  close_file(csv, path);
}

void evaluate_raw(const Arguments& arguments) {
  const auto parsed = parse(command_line(), arguments);
  if (!parsed) return;
  const po::variables_map& options = parsed->options;
  const int first = options["first"].as<int>();
  require_range("--first", first, 1, 1000);
  const double square = options["square"].as<double>();
  require_range("--square", square, 0.0001, 100);
  const cv::Size board = board_size(options["board"].as<std::string>());
  parameters_from(options);  // checks them

  RawPairs pairs = read_raw_pairs(parsed->positional[0]);
  if (pairs.frames.size() > static_cast<std::size_t>(first)) pairs.frames.resize(first);
  Parameters defaults;
  if (pairs.is_chessboard) {
    defaults.min_disparity = 90;
    defaults.disparity_range = 128;
  }
  const int min_disparity = parameters_from(options, defaults).min_disparity;
  const auto rectification =
      make_stereo_rectification(pairs.calibration.left, pairs.calibration.right, min_disparity);
  require(rectification, parsed->positional[0] + ": ");
  Pipeline pipeline;
  const int num_threads = threads(options);
  const std::vector<Contender> contenders =
      make_contenders(options, defaults, *rectification, pipeline, num_threads);
  Predictions predictions(contenders.size(), min_disparity);
  Boards boards(contenders.size(), board, square,
                make_reprojection(rectification->geometry, min_disparity));

  Progress progress("evaluate_raw", pairs.frames.size());
  std::size_t num_used = 0;
  for (const FramePaths& frame : pairs.frames) {
    Images images{read_grey(frame.left), read_grey(frame.right), {}, {}};
    require(validate_image(images.left_raw, *rectification, "left"), frame.left + ": ");
    require(validate_image(images.right_raw, *rectification, "right"), frame.right + ": ");
    rectify_image(images.left_raw, rectification->left.mesh, num_threads, images.left);
    rectify_image(images.right_raw, rectification->right_unshifted, num_threads, images.right);
    std::vector<cv::Mat1w> disparities;
    for (const Contender& contender : contenders) disparities.push_back(contender.compute(images));
    bool used = true;
    if (pairs.is_chessboard) {
      used = boards.add(images, disparities);
    } else {
      predictions.add(images, disparities);
    }
    if (!used) {
      std::cerr << fmt::format("evaluate_raw: {}: shows no chessboard with {}x{} inner corners\n",
                               frame.left, board.width, board.height);
    }
    num_used += used;
    progress.done(frame.left);
  }
  if (num_used == 0) throw std::runtime_error(parsed->positional[0] + ": no pair can be used");

  std::vector<Row> rows;
  for (std::size_t i = 0; i < contenders.size(); ++i) {
    rows.push_back(
        {contenders[i].name, pairs.is_chessboard ? boards.values(i) : predictions.values(i)});
  }
  const auto print = [&](const auto& titles) {
    print_table(titles, rows);
    if (options.count("csv") != 0) write_csv(options["csv"].as<std::string>(), titles, rows);
  };
  if (pairs.is_chessboard) {
    std::cout << fmt::format("Chessboards, {} pairs\n", num_used);
    print(Boards::kTitles);
  } else {
    std::cout << fmt::format("Grey difference from the predicted left image, {} pairs\n", num_used);
    print(Predictions::kTitles);
  }
}

}  // namespace
}  // namespace fpga_stereo::tools

int main(int argc, char** argv) {
  return fpga_stereo::tools::run_program("evaluate_raw", argc, argv,
                                         fpga_stereo::tools::evaluate_raw);
}
