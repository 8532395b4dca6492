#include "ros/board_report.hpp"

#include <numeric>
#include <sstream>
#include <utility>
#include <vector>

namespace fpga_stereo {
namespace {

using link::Device;

std::uint64_t recoveries(const Device::Snapshot& board) {
  const auto& steps = board.session.steps;
  return std::accumulate(steps.begin(), steps.end(), std::uint64_t{0});
}

std::uint64_t bad_packets(const Device::Snapshot& board) {
  return board.decoder.bad_headers + board.decoder.bad_payloads + board.board.bad_packets;
}

template <class T>
std::string text(const T& value) {
  std::ostringstream stream;
  stream << value;
  return stream.str();
}

using Lines = std::vector<std::pair<std::string, std::string>>;

Lines lines(const Device::Snapshot& board) {
  Lines all{{"state", name(board.state)},
            {"line", board.description.empty() ? "closed" : board.description}};
  if (board.identity) {
    const link::Identity& id = *board.identity;
    std::ostringstream hash;
    hash << "0x" << std::hex << std::uppercase << id.spec_hash;
    all.insert(all.end(), {{"gateware", id.text()}, {"specification", hash.str()}});
  }
  return all;
}

}  // namespace

void fill(const Device::Snapshot& board, const Verifier::Counters& verified, StereoStatus& status) {
  if (board.state == link::LinkState::kClosed) {
    status.board = "none: " + board.trouble_text;
  } else {
    status.board = std::string(name(board.state)) + ", " + board.description;
    if (board.identity) status.board += ", " + board.identity->text();
  }
  status.board_opened = static_cast<std::uint32_t>(board.times_opened);
  status.board_recoveries = static_cast<std::uint32_t>(recoveries(board));
  status.board_bad_packets = bad_packets(board);
  status.board_frames_dropped = board.board.frames_dropped;
  status.verified_frames = verified.frames;
  status.verified_pixels_differ = verified.pixels_differ;
}

void report_board(const Device::Snapshot& board, const Verifier::Counters& verified,
                  const std::string& unable, bool expected,
                  diagnostic_updater::DiagnosticStatusWrapper& report) {
  using Level = diagnostic_msgs::DiagnosticStatus;
  if (verified.pixels_differ > 0) {
    report.summary(Level::ERROR, "the board's disparity is not that of the software");
  } else if (!expected) {
    report.summary(Level::OK, "no board; software");
  } else if (board.trouble != link::LinkTrouble::kNone) {
    report.summary(board.state == link::LinkState::kRefused ? Level::ERROR : Level::WARN,
                   board.trouble_text);
  } else if (!unable.empty()) {
    report.summary(Level::WARN, "the board cannot make this disparity: " + unable);
  } else {
    report.summary(Level::OK, name(board.state));
  }
  for (const auto& [key, value] : lines(board)) report.add(key, value);
  report.add("times opened", board.times_opened);
  for (int step = 0; step < link::kNumWatchdogSteps; ++step) {
    report.add(std::string("recovery: ") + name(static_cast<link::WatchdogStep>(step)),
               board.session.steps[static_cast<std::size_t>(step)]);
  }
  report.add("requests", board.session.requests);
  report.add("requests repeated", board.session.retries);
  report.add("bytes in", board.transport.bytes_in);
  report.add("packets in", board.decoder.packets);
  report.add("packets lost", board.decoder.lost_packets);
  report.add("packets damaged", board.decoder.bad_headers + board.decoder.bad_payloads);
  report.add("frames good", board.frames.good);
  report.add("frames dropped", board.frames.dropped);
  report.add("board: frames in", board.board.frames_in);
  report.add("board: frames cut", board.board.cut_frames);
  report.add("board: frames too long", board.board.long_frames);
  report.add("board: frames beyond the line buffer", board.board.buffer_errors);
  report.add("board: frames dropped", board.board.frames_dropped);
  report.add("board: packets damaged", board.board.bad_packets);
  report.add("clock drift (us/s)", board.clock_drift * 1e6);
  report.add("clock uncertainty (ms)", board.clock_uncertainty * 1e3);
  report.add("verified frames", verified.frames);
  report.add("verified pixels that differ", verified.pixels_differ);
}

std::string device_info(const Device::Snapshot& board) {
  std::string all;
  const auto line = [&all](const std::string& key, const std::string& value) {
    all.append(key).append(": ").append(value).append("\n");
  };
  for (const auto& [key, value] : lines(board)) line(key, value);
  if (board.trouble != link::LinkTrouble::kNone) line("complaint", board.trouble_text);
  if (board.identity) {
    const link::Identity& id = *board.identity;
    for (int s = 1; s < link::kNumStreams; ++s) {
      const auto stream = static_cast<link::Stream>(s);
      line(std::string("stream ") + name(stream), id.supports(stream) ? "yes" : "no");
    }
    line("mesh nodes", text(id.build.mesh_nodes));
  }
  return all;
}

}  // namespace fpga_stereo
