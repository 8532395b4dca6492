#include "support/models.hpp"

#include <fmt/format.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

namespace fpga_stereo::tools {
namespace {

namespace fs = std::filesystem;

/// Image sizes that a gateware is built for. The width is the maximum; the height determines the
/// size of the mesh memory.
const std::array<cv::Size, 3> kSizes{{{640, 480}, {752, 480}, {kGatewareMaxWidth, 720}}};

/// Returns the path of build_model: in the install prefix if the package is installed, else in the
/// source tree.
std::string build_model_path() {
  const fs::path prefix =
      fs::read_symlink("/proc/self/exe").parent_path().parent_path().parent_path();
  const fs::path installed = prefix / "share/fpga_stereo/fpga_fw/sim/gateware/build_model";
  const fs::path source = fs::path(FPGA_STEREO_SIM_DIR) / "build_model";
  for (const fs::path& path : {installed, source}) {
    if (fs::exists(path)) return path.string();
  }
  throw std::runtime_error(fmt::format("build_model is missing: neither {} nor {} exists",
                                       installed.string(), source.string()));
}

/// Returns the pipeline parameters as build_model takes them.
std::string numbers(const GatewareBuild& build) {
  const int full = build.census_pattern == CensusPattern::kFull ? 1 : 0;
  return fmt::format("{} {} {} {} {} {} {}", build.max_width, build.disparities,
                     build.census_window, build.correlation_window, full, build.line_rows,
                     build.mesh_nodes);
}

/// Runs build_model. Returns the path of the model.
std::string run_build_model(const std::string& arguments, const std::string& folder, int jobs) {
  const std::string command =
      fmt::format("{} {} --jobs {} {}", shell_quoted(build_model_path()), arguments, jobs,
                  shell_quoted(fs::absolute(folder).string()));
  FILE* output = popen(command.c_str(), "r");
  if (output == nullptr) throw std::runtime_error(command + ": cannot be run");
  std::string path;
  for (int c = std::fgetc(output); c != EOF; c = std::fgetc(output)) {
    if (c != '\n') path += static_cast<char>(c);
  }
  const int status = pclose(output);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    throw std::runtime_error(fmt::format("the simulated gateware cannot be built in {}", folder));
  }
  return path;
}

}  // namespace

int default_line_rows(int max_width) {
  return max_width > kSizes.front().width ? 104 : kDefaultLineRows;
}

GatewareBuild smallest_build(const StereoJob& job, int line_rows) {
  constexpr int kNodesStep = 1024;  // capacity of a block RAM
  const cv::Size size = job.rectification.geometry.image_size;
  const auto fits = [&](cv::Size built) { return size.width <= built.width; };
  const auto found = std::find_if(kSizes.begin(), kSizes.end(), fits);
  const cv::Size built = found != kSizes.end() ? *found : kSizes.back();
  const int nodes = std::max(Mesh::node_count(size).area(), Mesh::node_count(built).area());
  GatewareBuild build;
  build.max_width = built.width;
  build.disparities = job.parameters.disparity_range;
  build.census_window = job.parameters.census_window_size;
  build.correlation_window = job.parameters.correlation_window_size;
  build.census_pattern = job.parameters.census_pattern;
  build.line_rows = line_rows != 0 ? line_rows : default_line_rows(build.max_width);
  build.mesh_nodes = (nodes + kNodesStep - 1) / kNodesStep * kNodesStep;
  return build;
}

std::string default_models_folder() {
  const char* cache = std::getenv("XDG_CACHE_HOME");
  if (cache != nullptr && *cache != '\0') return fmt::format("{}/fpga_stereo", cache);
  const char* home = std::getenv("HOME");
  if (home != nullptr && *home != '\0') return fmt::format("{}/.cache/fpga_stereo", home);
  throw UsageError("--models is missing, and neither XDG_CACHE_HOME nor HOME is set");
}

std::string require_model(const GatewareBuild& build, bool trace, const std::string& folder,
                          int jobs) {
  return run_build_model(fmt::format("{}{}", numbers(build), trace ? " --trace" : ""), folder,
                         jobs);
}

std::string require_system_model(const SystemBuild& build, const std::string& folder, int jobs) {
  return run_build_model(fmt::format("{} {} {} {}", numbers(build.gateware), build.clock_hz,
                                     build.streams, build.ring_rows),
                         folder, jobs);
}

}  // namespace fpga_stereo::tools
