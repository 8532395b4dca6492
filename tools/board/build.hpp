// What a board was built for, and its configuration.
#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "board/connection.hpp"
#include "fpga_stereo/core/gateware_configuration.hpp"

namespace fpga_stereo::tools {

/// "640x480". Throws UsageError.
cv::Size parse_size(const std::string& text);

/// Has a board take a configuration, with `tag`, and these streams; throws where it does not within
/// `seconds`.
void configure(Connection& board, const GatewareConfiguration& configuration, std::uint64_t tag,
               link::StreamSet streams, bool host_input, double seconds);

}  // namespace fpga_stereo::tools
