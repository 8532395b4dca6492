// match LEFT RIGHT OUT: the disparity of one pair of image files.
#include <iomanip>
#include <iostream>

#include "fpga_stereo/core/convert.hpp"
#include "fpga_stereo/core/pipeline.hpp"
#include "fpga_stereo/ros/conversions.hpp"
#include "support/files.hpp"
#include "support/parameter_options.hpp"
#include "support/program.hpp"

namespace fpga_stereo::tools {
namespace {

namespace po = boost::program_options;

CommandLine command_line() {
  CommandLine line;
  line.usage =
      "Usage: match LEFT RIGHT OUT [options]\n"
      "Computes the disparity of a stereo pair. LEFT and RIGHT are image files of one size.\n"
      "OUT is one of\n"
      "  FILE.png  16-bit grey, 1/32 px, 65535 = no disparity; min_disparity is not added\n"
      "  FILE.pfm  float, px, inf = no disparity; min_disparity is added\n";
  line.positional = {"LEFT", "RIGHT", "OUT"};
  line.options.add_options()("color", po::value<std::string>()->value_name("FILE"),
                             "write a picture, too: near is red, far is blue, none is black");
  line.options.add_options()("left-info", po::value<std::string>()->value_name("YAML"),
                             "camera_info of LEFT: rectify first; needs --right-info");
  line.options.add_options()("right-info", po::value<std::string>()->value_name("YAML"),
                             "camera_info of RIGHT");
  add_threads_option(line.options);
  line.options.add_options()("verbose", po::bool_switch(),
                             "print times and what rectification needs, on stderr");
  line.options.add(parameter_options());
  return line;
}

void print_rectification(const std::string& camera, const CameraRectification& r) {
  std::cerr << camera << " mesh: off the exact map by " << r.deviation.largest
            << " px at most, at (" << r.deviation.where.x << ", " << r.deviation.where.y << "), "
            << r.deviation.rms << " px RMS; line buffer: " << r.buffer.rows << " rows ("
            << r.buffer.rows_above << " above and " << r.buffer.rows_below
            << " below the output row), read start " << r.buffer.read_start << "\n";
}

void print_times(const StageTimes& ms) {
  double total = 0;
  std::cerr << std::fixed << std::setprecision(2);
  for (std::size_t stage = 0; stage < ms.size(); ++stage) {
    std::cerr << std::left << std::setw(10) << kStageNames[stage] << std::right << std::setw(10)
              << ms[stage] << " ms\n";
    total += ms[stage];
  }
  std::cerr << std::left << std::setw(10) << "total" << std::right << std::setw(10) << total
            << " ms\n";
}

StereoRectification rectification(const po::variables_map& options, cv::Size size,
                                  int min_disparity) {
  if (options.count("left-info") == 0) {
    StereoGeometry geometry;
    geometry.image_size = size;
    return no_rectification(geometry, min_disparity);
  }
  const std::string left = options["left-info"].as<std::string>();
  const std::string right = options["right-info"].as<std::string>();
  const auto made =
      make_stereo_rectification(to_calibration(read_camera_info(left)),
                                to_calibration(read_camera_info(right)), min_disparity);
  require(made, left + ", " + right + ": ");
  return *made;
}

void match(const Arguments& arguments) {
  const auto parsed = parse(command_line(), arguments);
  if (!parsed) return;
  const po::variables_map& options = parsed->options;
  const std::string left_path = parsed->positional[0];
  const std::string right_path = parsed->positional[1];
  const std::string out_path = parsed->positional[2];
  const bool verbose = options["verbose"].as<bool>();
  const bool color = options.count("color") != 0;

  // Everything that can be refused before any work.
  const Parameters parameters = parameters_from(options);
  const int num_threads = threads(options);
  require_disparity_extension(out_path);
  if (color) require_picture_extension("--color", options["color"].as<std::string>());
  if (options.count("left-info") != options.count("right-info")) {
    const bool left_given = options.count("left-info") != 0;
    throw UsageError(concat("--", left_given ? "left" : "right", "-info is given without --",
                            left_given ? "right" : "left", "-info: allowed are both or none"));
  }

  const cv::Mat1b left = read_grey(left_path);
  const cv::Mat1b right = read_grey(right_path);
  if (left.size() != right.size()) {
    throw std::runtime_error(concat(left_path, " is ", left.cols, "x", left.rows, " and ",
                                    right_path, " is ", right.cols, "x", right.rows,
                                    ": they must have one size"));
  }
  const StereoRectification pair = rectification(options, left.size(), parameters.min_disparity);
  require(validate_image(left, pair, "left"), left_path + ": ");
  require(validate_image(right, pair, "right"), right_path + ": ");

  Pipeline pipeline;
  const Taps& taps = pipeline.process(left, right, pair, parameters, num_threads);
  write_disparity(out_path, taps.disparity, parameters.min_disparity);
  if (color) {
    cv::Mat3b picture;
    to_color(taps.disparity, parameters.disparity_range, picture);
    write_image(options["color"].as<std::string>(), picture);
  }
  if (verbose) {
    print_rectification("left", pair.left);
    print_rectification("right", pair.right);
    print_times(taps.ms);
  }
}

}  // namespace
}  // namespace fpga_stereo::tools

int main(int argc, char** argv) {
  return fpga_stereo::tools::run_program("match", argc, argv, fpga_stereo::tools::match);
}
