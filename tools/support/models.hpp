// Which simulated gateware a pair of images needs, and where it comes from.
#pragma once

#include <string>

#include "fpga_stereo/core/gateware_configuration.hpp"
#include "support/stereo_job.hpp"

namespace fpga_stereo::tools {

/// Rows of the line buffer that a build of this width has unless another number is asked for.
int default_line_rows(int max_width);

/// The smallest build for a job. `line_rows` 0: the default.
GatewareBuild smallest_build(const StereoJob& job, int line_rows);

/// Folder for models: ~/.cache/fpga_stereo, or in XDG_CACHE_HOME.
std::string default_models_folder();

/// Path of the model of a build in `folder`. It is built first where it is not there, by `jobs`
/// compilers at once; fpga_fw/sim/gateware/build_model says so on stderr.
std::string model(const GatewareBuild& build, bool trace, const std::string& folder, int jobs);

/// The same of a whole board, with its link: fs_system.
struct SystemBuild {
  GatewareBuild gateware;
  int clock_hz = 0;   // of its clock
  int streams = 126;  // bit s: stream s
  int ring_rows = 4;  // rows of an image that wait for the line
};
std::string system_model(const SystemBuild& build, const std::string& folder, int jobs);

}  // namespace fpga_stereo::tools
