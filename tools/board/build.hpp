// Image sizes and configurations for the modes of board.
#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "board/connection.hpp"
#include "fpga_stereo/core/gateware_configuration.hpp"

namespace fpga_stereo::tools {

/// Parses "640x480". Throws UsageError.
cv::Size parse_size(const std::string& text);

constexpr double kConfigurationTimeout = 30;  // s, for two meshes over a slow serial port

/// Adds --left-info, --right-info, --size and the parameters of the pipeline.
void add_configuration_options(CommandLine& line);

/// Checks these options before anything is sent. Returns false if none of the first three is given.
/// Throws UsageError.
bool check_configuration_options(const boost::program_options::variables_map& options);

/// What these options mean for a board. Parameters that its build fixes default to those of the
/// build.
struct BoardConfiguration {
  Parameters parameters;
  StereoRectification rectification;
  GatewareConfiguration gateware;
};
/// `size` is that of images that are rectified already, if neither calibration nor --size is given.
/// Throws std::runtime_error if the board does not support the configuration.
BoardConfiguration board_configuration(const boost::program_options::variables_map& options,
                                       const GatewareBuild& build, cv::Size size = {});

/// Sends a configuration with a configuration tag and turns on these streams. Blocks until both are
/// in effect; throws std::runtime_error after `seconds`.
void apply_configuration(Connection& board, const GatewareConfiguration& configuration,
                         std::uint64_t tag, link::StreamSet streams, bool host_input,
                         double seconds);

}  // namespace fpga_stereo::tools
