// What match and simulate share: the arguments LEFT RIGHT OUT, the calibration, the colour picture
// and the parameters of the pipeline.
#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "fpga_stereo/core/calibration.hpp"
#include "fpga_stereo/core/parameters.hpp"
#include "support/program.hpp"

namespace fpga_stereo::tools {

struct StereoJob {
  Parameters parameters;
  cv::Mat1b left, right;
  StereoRectification rectification;
  std::string out_path;
  std::string color_path;  // empty: no colour picture
};

/// Returns the arguments and options of a job. `about` follows the usage line in the help. The
/// program adds its own options and, last, parameter_options().
CommandLine job_command_line(const std::string& program, const std::string& about);

/// Checks the command line, reads the files and makes the rectification meshes. `defaults` are the
/// values of parameters that are not given.
StereoJob read_job(const Parsed& parsed, const Parameters& defaults = {});

/// Makes the rectification of two camera_info files. Throws std::runtime_error.
StereoRectification read_rectification(const std::string& left_path, const std::string& right_path,
                                       int min_disparity);

/// Writes OUT and the colour picture.
void write_result(const StereoJob& job, const cv::Mat1w& disparity);

/// Prints the deviation of the meshes and the line buffer that they need to stderr.
void print_rectification(const StereoRectification& rectification);

}  // namespace fpga_stereo::tools
