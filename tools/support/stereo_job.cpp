#include "support/stereo_job.hpp"

#include <iostream>

#include "fpga_stereo/core/convert.hpp"
#include "fpga_stereo/core/pipeline.hpp"
#include "ros/conversions.hpp"
#include "support/files.hpp"
#include "support/parameter_options.hpp"

namespace fpga_stereo::tools {
namespace {

namespace po = boost::program_options;

void print_rectification(const std::string& camera, const CameraRectification& r) {
  std::cerr << camera << " mesh: off the exact map by " << r.deviation.max << " px at most, at ("
            << r.deviation.max_at.x << ", " << r.deviation.max_at.y << "), " << r.deviation.rms
            << " px RMS; line buffer: " << r.line_buffer.rows << " rows ("
            << r.line_buffer.rows_above << " above and " << r.line_buffer.rows_below
            << " below the output row), read start " << r.line_buffer.read_start << "\n";
}

StereoRectification rectification(const po::variables_map& options, cv::Size size,
                                  int min_disparity) {
  if (options.count("left-info") == 0) {
    StereoGeometry geometry;
    geometry.image_size = size;
    return identity_rectification(geometry, min_disparity);
  }
  const std::string left = options["left-info"].as<std::string>();
  const std::string right = options["right-info"].as<std::string>();
  const auto made =
      make_stereo_rectification(to_calibration(read_camera_info(left)),
                                to_calibration(read_camera_info(right)), min_disparity);
  require(made, left + ", " + right + ": ");
  return *made;
}

}  // namespace

CommandLine job_command_line(const std::string& program, const std::string& about) {
  CommandLine line;
  line.usage = concat("Usage: ", program, " LEFT RIGHT OUT [options]\n", about,
                      "LEFT and RIGHT are image files of one size.\n"
                      "OUT is one of\n"
                      "  FILE.png  16-bit grey, 1/32 px, 65535 = no disparity; min_disparity is "
                      "not added\n"
                      "  FILE.pfm  float, px, inf = no disparity; min_disparity is added\n");
  line.positional = {"LEFT", "RIGHT", "OUT"};
  line.options.add_options()("color", po::value<std::string>()->value_name("FILE"),
                             "write a picture, too: near is red, far is blue, none is black");
  line.options.add_options()("left-info", po::value<std::string>()->value_name("YAML"),
                             "camera_info of LEFT: rectify first; needs --right-info");
  line.options.add_options()("right-info", po::value<std::string>()->value_name("YAML"),
                             "camera_info of RIGHT");
  return line;
}

StereoJob read_job(const Parsed& parsed) {
  const po::variables_map& options = parsed.options;
  const std::string& left_path = parsed.positional[0];
  const std::string& right_path = parsed.positional[1];

  // Everything that can be refused before any work.
  StereoJob job;
  job.parameters = parameters_from(options);
  job.out_path = parsed.positional[2];
  require_disparity_extension(job.out_path);
  if (options.count("color") != 0) {
    job.color_path = options["color"].as<std::string>();
    require_picture_extension("--color", job.color_path);
  }
  if (options.count("left-info") != options.count("right-info")) {
    const bool left_given = options.count("left-info") != 0;
    throw UsageError(concat("--", left_given ? "left" : "right", "-info is given without --",
                            left_given ? "right" : "left", "-info: allowed are both or none"));
  }

  job.left = read_grey(left_path);
  job.right = read_grey(right_path);
  if (job.left.size() != job.right.size()) {
    throw std::runtime_error(concat(left_path, " is ", job.left.cols, "x", job.left.rows, " and ",
                                    right_path, " is ", job.right.cols, "x", job.right.rows,
                                    ": they must have one size"));
  }
  job.rectification = rectification(options, job.left.size(), job.parameters.min_disparity);
  require(validate_image(job.left, job.rectification, "left"), left_path + ": ");
  require(validate_image(job.right, job.rectification, "right"), right_path + ": ");
  return job;
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
