#include "ros/board_report.hpp"

#include <fmt/format.h>

#include <numeric>
#include <utility>
#include <vector>

namespace fpga_stereo {
namespace {

using link::BoardAbility;
using link::Device;
using link::LinkState;
using link::LinkTrouble;

// StereoStatus.msg has the values of LinkState.
static_assert(static_cast<int>(LinkState::kClosed) == StereoStatus::LINK_CLOSED);
static_assert(static_cast<int>(LinkState::kIdentifying) == StereoStatus::LINK_IDENTIFYING);
static_assert(static_cast<int>(LinkState::kRefused) == StereoStatus::LINK_REFUSED);
static_assert(static_cast<int>(LinkState::kConfiguring) == StereoStatus::LINK_CONFIGURING);
static_assert(static_cast<int>(LinkState::kReady) == StereoStatus::LINK_READY);
static_assert(static_cast<int>(LinkState::kStreaming) == StereoStatus::LINK_STREAMING);

std::uint64_t recoveries(const Device::Snapshot& device) {
  const auto& steps = device.session.steps;
  return std::accumulate(steps.begin(), steps.end(), std::uint64_t{0});
}

using NamedValues = std::vector<std::pair<std::string, std::string>>;

NamedValues summary_of(const Device::Snapshot& device) {
  NamedValues values{{"state", name(device.state)},
                     {"connection", device.description.empty() ? "closed" : device.description}};
  if (device.identity) {
    values.emplace_back("gateware", device.identity->text());
    values.emplace_back("specification", fmt::format("0x{:X}", device.identity->spec_hash));
  }
  return values;
}

void fill_summary(const BoardReport& board,
                  diagnostic_updater::DiagnosticStatusWrapper& diagnostics) {
  using Level = diagnostic_msgs::DiagnosticStatus;
  if (board.verified.pixels_differ > 0) {
    diagnostics.summary(Level::ERROR, "the board's disparity differs from the software's");
  } else if (!board.is_expected) {
    diagnostics.summary(Level::OK, "no board; the software makes the disparity");
  } else if (const auto trouble = link_trouble(board.device)) {
    diagnostics.summary(severity(trouble->state) == Severity::kError ? Level::ERROR : Level::WARN,
                        trouble->text);
  } else if (board.ability != BoardAbility::kMakesDisparity) {
    diagnostics.summary(Level::WARN, "the board cannot make this disparity: " + board.limitation);
  } else {
    diagnostics.summary(Level::OK, name(board.device.state));
  }
}

}  // namespace

std::optional<StateReport> link_trouble(const Device::Snapshot& device) {
  const auto report = [&](NodeState state) {
    return StateReport{state, "board: " + device.trouble_text};
  };
  switch (device.trouble) {
    case LinkTrouble::kNone:
      return std::nullopt;
    case LinkTrouble::kIdentifying:
    case LinkTrouble::kConfiguring:
      return report(NodeState::kBoardStarting);
    case LinkTrouble::kIncompatible:
    case LinkTrouble::kRejected:
      return report(NodeState::kBoardRefused);
    case LinkTrouble::kUnconfigurable:
      return report(NodeState::kBoardUnsuitable);
    case LinkTrouble::kIo:
    case LinkTrouble::kReopening:
    case LinkTrouble::kSilent:
    case LinkTrouble::kStalled:
    case LinkTrouble::kNoImages:
      return report(NodeState::kBoardTrouble);
    default:
      return report(NodeState::kNoBoard);
  }
}

void fill_status(const BoardReport& board, StereoStatus& status) {
  const Device::Snapshot& device = board.device;
  if (device.state == LinkState::kClosed) {
    status.board = "none: " + device.trouble_text;
  } else {
    status.board = fmt::format("{}, {}", name(device.state), device.description);
    if (device.identity) status.board += ", " + device.identity->text();
  }
  status.link_state = static_cast<std::uint8_t>(device.state);
  status.board_opened = static_cast<std::uint32_t>(device.times_opened);
  status.board_recoveries = static_cast<std::uint32_t>(recoveries(device));
  status.board_bad_packets =
      device.decoder.bad_headers + device.decoder.bad_payloads + device.board.bad_packets;
  status.board_frames_dropped = device.board.frames_dropped;
  status.frames_undelivered = device.undelivered;
  status.verified_frames = board.verified.frames;
  status.verified_pixels_differ = board.verified.pixels_differ;
}

void fill_diagnostics(const BoardReport& board,
                      diagnostic_updater::DiagnosticStatusWrapper& diagnostics) {
  fill_summary(board, diagnostics);
  const Device::Snapshot& device = board.device;
  for (const auto& [name, value] : summary_of(device)) diagnostics.add(name, value);
  diagnostics.add("times opened", device.times_opened);
  for (int step = 0; step < link::kNumWatchdogSteps; ++step) {
    diagnostics.add(fmt::format("recovery: {}", name(static_cast<link::WatchdogStep>(step))),
                    device.session.steps[static_cast<std::size_t>(step)]);
  }
  diagnostics.add("requests", device.session.requests);
  diagnostics.add("request retries", device.session.retries);
  diagnostics.add("bytes in", device.transport.bytes_in);
  diagnostics.add("packets in", device.decoder.packets);
  diagnostics.add("packets lost", device.decoder.lost_packets);
  diagnostics.add("packets damaged", device.decoder.bad_headers + device.decoder.bad_payloads);
  diagnostics.add("frames good", device.frames.good);
  diagnostics.add("frames dropped", device.frames.dropped);
  diagnostics.add("frames dropped: node too slow", device.undelivered);
  diagnostics.add("board: frames in", device.board.frames_in);
  diagnostics.add("board: frames cut", device.board.cut_frames);
  diagnostics.add("board: frames too long", device.board.long_frames);
  diagnostics.add("board: frames with rectification errors", device.board.buffer_errors);
  diagnostics.add("board: frames dropped", device.board.frames_dropped);
  diagnostics.add("board: packets damaged", device.board.bad_packets);
  diagnostics.add("clock drift (us/s)", device.clock_drift * 1e6);
  diagnostics.add("clock uncertainty (ms)", device.clock_uncertainty * 1e3);
  diagnostics.add("verified frames", board.verified.frames);
  diagnostics.add("verified pixels that differ", board.verified.pixels_differ);
}

std::string device_info(const Device::Snapshot& device) {
  std::string lines;
  const auto add = [&lines](const std::string& name, const std::string& value) {
    lines += fmt::format("{}: {}\n", name, value);
  };
  for (const auto& [name, value] : summary_of(device)) add(name, value);
  if (const auto trouble = link_trouble(device)) add("trouble", trouble->text);
  if (device.identity) {
    const link::Identity& identity = *device.identity;
    for (int s = 1; s < link::kNumStreams; ++s) {
      const auto stream = static_cast<link::Stream>(s);
      add(fmt::format("stream {}", name(stream)), identity.supports(stream) ? "yes" : "no");
    }
    add("mesh nodes", std::to_string(identity.build.mesh_nodes));
  }
  return lines;
}

}  // namespace fpga_stereo
