// What ~status and diagnostics say about a node.
#pragma once

#include <optional>
#include <string>

#include "ros/board_report.hpp"
#include "ros/health.hpp"
#include "ros/node_state.hpp"

namespace fpga_stereo {

/// Thread-safe.
class StatusSource {
 public:
  enum class Maker { kSoftware, kBoard };

  virtual ~StatusSource() = default;

  /// What the node makes, for people.
  virtual const char* product() const = 0;
  virtual const Health& health() const = 0;
  /// Says why no pairs or frames arrive, apart from refused ones; nullopt if they do.
  virtual std::optional<StateReport> input_trouble() const = 0;
  /// Where frames come from that are not new, for people; empty for others.
  virtual std::string origin() const { return ""; }
  /// Returns what makes the disparity now.
  virtual Maker active() const { return Maker::kSoftware; }
  /// Returns nullopt if the node uses no board.
  virtual std::optional<BoardReport> board_report() const { return std::nullopt; }

  StateReport state() const {
    if (!health().has_subscribers()) return {NodeState::kIdle, "idle: no output has a subscriber"};
    if (const auto trouble = input_trouble()) return *trouble;
    if (const auto refusal = health().refusal()) return *refusal;
    if (!health().has_published()) {
      return {NodeState::kStarting, "starting: the first frame is still expected"};
    }
    const std::string from = origin();
    return {NodeState::kStreaming, from.empty() ? "streaming" : "streaming from " + from};
  }

 protected:
  StatusSource() = default;
  StatusSource(const StatusSource&) = default;
  StatusSource& operator=(const StatusSource&) = default;
};

/// "software" or "board".
inline const char* name(StatusSource::Maker maker) {
  return maker == StatusSource::Maker::kBoard ? "board" : "software";
}

}  // namespace fpga_stereo
