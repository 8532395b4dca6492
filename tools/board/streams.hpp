// The streams of a board by the names that the command line, folders and tables use.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "fpga_stereo/link/streams.hpp"

namespace fpga_stereo::tools {

struct StreamName {
  link::Stream stream;
  const char* name;
};
constexpr std::array<StreamName, 5> kStreamNames{{{link::Stream::kDisparity, "disparity"},
                                                  {link::Stream::kRectifiedLeft, "left"},
                                                  {link::Stream::kRectifiedRight, "right"},
                                                  {link::Stream::kRawLeft, "raw_left"},
                                                  {link::Stream::kRawRight, "raw_right"}}};

/// Parses "disparity,left". Throws UsageError.
link::StreamSet parse_streams(const std::string& text);

}  // namespace fpga_stereo::tools
