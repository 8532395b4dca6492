// The streams of a board by the names that the command line, folders and tables use.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "fpga_stereo/link/packet.hpp"

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

/// "disparity,left": a bit for each stream. Throws UsageError.
unsigned parse_streams(const std::string& text);
inline bool has(unsigned streams, link::Stream stream) {
  return (streams >> static_cast<unsigned>(stream) & 1U) != 0;
}

}  // namespace fpga_stereo::tools
