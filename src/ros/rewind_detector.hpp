// Decides whether time itself has moved back: a bag is played again, or a clock was set back.
#pragma once

#include <ros/time.h>

#include <cstddef>
#include <deque>
#include <optional>
#include <string>

namespace fpga_stereo {

/// Watches the stamps of one topic. One thread at a time.
///
/// Simulated time moves back when its clock does. Otherwise only the stamps show it, and messages
/// that are merely late must not be mistaken for it: reordering moves a message by a few places and
/// repeats none. So time has moved back when two messages in a row, the second later than the
/// first, each repeat a stamp, or come after 16 later ones, or are 30 s late.
class RewindDetector {
 public:
  static constexpr std::size_t kRemembered = 32;  // messages
  static constexpr int kMaxPlaces = 16;           // that reordering moves a message by
  static constexpr double kMaxLateness = 30;      // s

  /// Notes the stamp of a message, and the present simulated time if time is simulated. Returns
  /// what has moved back, for the log, if this message shows it: it belongs to the new time.
  std::optional<std::string> note(const ros::Time& stamp,
                                  const std::optional<ros::Time>& simulated_now);

 private:
  /// True if reordering does not explain this stamp after the remembered ones.
  bool is_unexplained(const ros::Time& stamp) const;

  std::deque<ros::Time> stamps_;            // of the last messages
  std::optional<ros::Time> unexplained_;    // stamp of the last message if it was unexplained
  std::optional<ros::Time> simulated_now_;  // at the last message
};

}  // namespace fpga_stereo
