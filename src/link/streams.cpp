#include "fpga_stereo/link/streams.hpp"

#include <array>

namespace fpga_stereo::link {

const char* name(Stream stream) {
  static constexpr std::array<const char*, kNumStreams> kNames{
      "no stream", "disparity", "rectified left", "rectified right",
      "raw left",  "raw right", "input"};
  const auto number = static_cast<std::size_t>(stream);
  return number < kNames.size() ? kNames[number] : "unknown stream";
}

std::string to_text(StreamSet streams) {
  std::string text;
  for (const Stream stream : streams)
    text += (text.empty() ? "" : ", ") + std::string(name(stream));
  return text.empty() ? "none" : text;
}

}  // namespace fpga_stereo::link
