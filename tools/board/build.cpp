#include "board/build.hpp"

#include <fmt/format.h>

#include <cstdio>

#include "fpga_stereo/core/spec.hpp"

namespace fpga_stereo::tools {

cv::Size parse_size(const std::string& text) {
  int width = 0, height = 0;
  char end = 0;
  const bool is_valid = std::sscanf(text.c_str(), "%4dx%4d%c", &width, &height, &end) == 2;
  if (is_valid && width >= kGatewareMinWidth && width <= kGatewareMaxWidth && height >= 1 &&
      height <= kGatewareMaxHeight) {
    return {width, height};
  }
  throw UsageError(fmt::format("--size = \"{}\": allowed WIDTHxHEIGHT, {}x1 to {}x{}", text,
                               kGatewareMinWidth, kGatewareMaxWidth, kGatewareMaxHeight));
}

void apply_configuration(Connection& board, const GatewareConfiguration& configuration,
                         std::uint64_t tag, link::StreamSet streams, bool host_input,
                         double seconds) {
  const std::uint64_t before = board.snapshot().session.configurations;
  link::DesiredState wanted;
  wanted.configuration = std::make_shared<const GatewareConfiguration>(configuration);
  wanted.tag = tag;
  wanted.streams = streams;
  wanted.host_input = host_input;
  board.set_desired_state(wanted);
  const auto state = streams.empty() ? link::LinkState::kReady : link::LinkState::kStreaming;
  const bool is_applied = board.wait_until(seconds, [&](const Connection::Snapshot& now) {
    return now.state == state && now.session.configurations > before;
  });
  if (is_applied) return;
  throw std::runtime_error(
      fmt::format("the board did not apply the configuration within {:g} s: {}", seconds,
                  board.snapshot().trouble_text));
}

}  // namespace fpga_stereo::tools
