#include "support/stereo_job.hpp"

#include <fmt/format.h>

#include <iostream>

#include "fpga_stereo/core/camera_info_yaml.hpp"
#include "fpga_stereo/core/convert.hpp"
#include "fpga_stereo/core/pipeline.hpp"
#include "support/files.hpp"
#include "support/parameter_options.hpp"

namespace fpga_stereo::tools {
namespace {

namespace po = boost::program_options;

void print_rectification(const std::string& camera, const CameraRectification& r) {
  std::cerr << fmt::format(
      "{} mesh: deviates from the exact map by at most {:.3g} px, at ({}, {}), and by {:.3g} px "
      "RMS; needs a line buffer of {} rows ({} above and {} below the output row), read start {}\n",
      camera, r.deviation.max, r.deviation.max_at.x, r.deviation.max_at.y, r.deviation.rms,
      r.line_buffer.rows, r.line_buffer.rows_above, r.line_buffer.rows_below,
      r.line_buffer.read_start);
}

StereoRectification rectification(const po::variables_map& options, cv::Size size,
                                  int min_disparity) {
  if (options.count("left-info") == 0) {
    StereoGeometry geometry;
    geometry.image_size = size;
    return identity_rectification(geometry, min_disparity);
  }
  return read_rectification(options["left-info"].as<std::string>(),
                            options["right-info"].as<std::string>(), min_disparity);
}

}  // namespace

CommandLine job_command_line(const std::string& program, const std::string& about) {
  CommandLine line;
  line.usage = fmt::format(
      "Usage: {} LEFT RIGHT OUT [options]\n"
      "{}"
      "LEFT and RIGHT are image files of equal size.\n"
      "OUT is one of\n"
      "  FILE.png  16-bit grey, 1/32 px, 65535 = no disparity; min_disparity is not added\n"
      "  FILE.pfm  float, px, inf = no disparity; min_disparity is added\n",
      program, about);
  line.positional = {"LEFT", "RIGHT", "OUT"};
  line.options.add_options()(
      "color", po::value<std::string>()->value_name("FILE"),
      "also write a colour picture: near is red, far is blue, invalid is black");
  line.options.add_options()("left-info", po::value<std::string>()->value_name("YAML"),
                             "camera_info file of the left camera: rectify the images first");
  line.options.add_options()("right-info", po::value<std::string>()->value_name("YAML"),
                             "camera_info file of the right camera");
  return line;
}

StereoJob read_job(const Parsed& parsed, const Parameters& defaults) {
  const po::variables_map& options = parsed.options;
  const std::string& left_path = parsed.positional[0];
  const std::string& right_path = parsed.positional[1];

  // Check everything that needs no file first.
  StereoJob job;
  job.parameters = parameters_from(options, defaults);
  job.out_path = parsed.positional[2];
  require_disparity_extension(job.out_path);
  if (options.count("color") != 0) {
    job.color_path = options["color"].as<std::string>();
    require_picture_extension("--color", job.color_path);
  }
  if (options.count("left-info") != options.count("right-info")) {
    const bool left_given = options.count("left-info") != 0;
    throw UsageError(fmt::format("--{}-info is given without --{}-info: allowed are both or none",
                                 left_given ? "left" : "right", left_given ? "right" : "left"));
  }

  job.left = read_grey(left_path);
  job.right = read_grey(right_path);
  if (job.left.size() != job.right.size()) {
    throw std::runtime_error(fmt::format("{} is {}x{} and {} is {}x{}: the sizes must be equal",
                                         left_path, job.left.cols, job.left.rows, right_path,
                                         job.right.cols, job.right.rows));
  }
  job.rectification = rectification(options, job.left.size(), job.parameters.min_disparity);
  require(validate_image(job.left, job.rectification, "left"), left_path + ": ");
  require(validate_image(job.right, job.rectification, "right"), right_path + ": ");
  return job;
}

StereoRectification read_rectification(const std::string& left_path, const std::string& right_path,
                                       int min_disparity) {
  const auto left = read_camera_info(left_path);
  require(left);
  const auto right = read_camera_info(right_path);
  require(right);
  auto rectification = make_stereo_rectification(*left, *right, min_disparity);
  require(rectification, fmt::format("{}, {}: ", left_path, right_path));
  return std::move(*rectification);
}

void write_result(const StereoJob& job, const cv::Mat1w& disparity) {
  write_disparity(job.out_path, disparity, job.parameters.min_disparity);
  if (job.color_path.empty()) return;
  cv::Mat3b picture;
  to_color(disparity, job.parameters.disparity_range, picture);
  write_image(job.color_path, picture);
}

void print_rectification(const StereoRectification& rectification) {
  print_rectification("left", rectification.left);
  print_rectification("right", rectification.right);
}

}  // namespace fpga_stereo::tools
