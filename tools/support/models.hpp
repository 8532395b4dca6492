// Chooses and builds the simulated gateware for a pair of images.
#pragma once

#include <string>

#include "fpga_stereo/core/gateware_configuration.hpp"
#include "support/stereo_job.hpp"

namespace fpga_stereo::tools {

/// Returns the default number of line buffer rows for a build of this width.
int default_line_rows(int max_width);

/// Returns the smallest build for a job. `line_rows` 0 means the default.
GatewareBuild smallest_build(const StereoJob& job, int line_rows);

/// Returns the default folder for models: $XDG_CACHE_HOME/fpga_stereo or ~/.cache/fpga_stereo.
/// Throws UsageError if neither XDG_CACHE_HOME nor HOME is set.
std::string default_models_folder();

/// Returns the path of the model of fs_top for this build in `folder`. If necessary, builds the
/// model first with `jobs` parallel compilers; build_model reports this on stderr.
std::string require_model(const GatewareBuild& build, bool trace, const std::string& folder,
                          int jobs);

/// Build parameters of a whole board with its link: fs_system.
struct SystemBuild {
  GatewareBuild gateware;
  int clock_hz = 0;
  int streams = 126;  // bit s: stream s
  int ring_rows = 4;  // capacity of the buffer for rectified images, rows
};
/// Returns the path of the model of fs_system, built if necessary.
std::string require_system_model(const SystemBuild& build, const std::string& folder, int jobs);

}  // namespace fpga_stereo::tools
