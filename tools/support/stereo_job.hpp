// What match and simulate have in common: LEFT RIGHT OUT, a calibration, a colour picture and the
// parameters of the pipeline.
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
  std::string out_path, color_path;  // color_path is empty where none is asked for
};

/// Arguments and options of a job; `about` is the second line of the help. The program may add
/// options; parameter_options() is for it to add, last.
CommandLine job_command_line(const std::string& program, const std::string& about);

/// Refuses what can be refused before any work, then reads the files and makes the meshes.
StereoJob read_job(const Parsed& parsed);

/// Writes OUT and the colour picture.
void write_result(const StereoJob& job, const cv::Mat1w& disparity);

/// What the meshes are like and what they need of a line buffer, on stderr.
void print_rectification(const StereoRectification& rectification);

}  // namespace fpga_stereo::tools
