// Image sizes and configurations for the modes of board.
#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "board/connection.hpp"
#include "fpga_stereo/core/gateware_configuration.hpp"

namespace fpga_stereo::tools {

/// Parses "640x480". Throws UsageError.
cv::Size parse_size(const std::string& text);

/// Sends a configuration with a configuration tag and turns on these streams. Blocks until both are
/// in effect; throws std::runtime_error after `seconds`.
void apply_configuration(Connection& board, const GatewareConfiguration& configuration,
                         std::uint64_t tag, link::StreamSet streams, bool host_input,
                         double seconds);

}  // namespace fpga_stereo::tools
