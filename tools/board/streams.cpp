#include "board/streams.hpp"

#include <sstream>

#include "support/program.hpp"

namespace fpga_stereo::tools {

unsigned parse_streams(const std::string& text) {
  unsigned streams = 0;
  std::istringstream in(text);
  for (std::string name; std::getline(in, name, ',');) {
    unsigned bit = 0;
    std::string allowed;
    for (const StreamName& each : kStreamNames) {
      if (name == each.name) bit = 1U << static_cast<unsigned>(each.stream);
      allowed += (allowed.empty() ? "" : ",") + std::string(each.name);
    }
    if (bit == 0) {
      throw UsageError(
          concat("--streams: \"", name, "\" is no stream: allowed are some of ", allowed));
    }
    streams |= bit;
  }
  if (streams == 0) throw UsageError("--streams names no stream");
  return streams;
}

}  // namespace fpga_stereo::tools
