#include "board/streams.hpp"

#include <fmt/format.h>

#include <sstream>

#include "support/program.hpp"

namespace fpga_stereo::tools {

link::StreamSet parse_streams(const std::string& text) {
  link::StreamSet streams;
  std::istringstream in(text);
  for (std::string name; std::getline(in, name, ',');) {
    link::StreamSet found;
    std::string allowed;
    for (const StreamName& each : kStreamNames) {
      if (name == each.name) found = each.stream;
      allowed += (allowed.empty() ? "" : ",") + std::string(each.name);
    }
    if (found.empty()) {
      throw UsageError(
          fmt::format("--streams: \"{}\" is not a stream: allowed are {}", name, allowed));
    }
    streams |= found;
  }
  if (streams.empty()) throw UsageError("--streams is empty: name at least one stream");
  return streams;
}

}  // namespace fpga_stereo::tools
