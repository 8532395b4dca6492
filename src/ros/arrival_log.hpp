// Notes which messages arrive on topics whose messages belong together.
#pragma once

#include <ros/time.h>

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/thread_safety.hpp"
#include "ros/health.hpp"
#include "ros/rewind_detector.hpp"
#include "ros/settings.hpp"

namespace fpga_stereo {

/// Counts the messages of the first topic that never find the messages of the other topics, and
/// says what is missing. Thread-safe; its lock is a leaf.
class ArrivalLog {
 public:
  struct Topic {
    std::string name;
    bool is_camera_info = false;
  };

  /// `health` must outlive the log.
  ArrivalLog(std::vector<Topic> topics, const SyncSettings& settings, Health& health);

  /// Begins anew with these topics, given by index. `needs_sets`: their messages must find each
  /// other; otherwise each stands for itself.
  void start(std::set<std::size_t> subscribed, bool needs_sets) FPGA_STEREO_EXCLUDES(mutex_);
  /// Ends; messages without partners count as unwanted.
  void stop() FPGA_STEREO_EXCLUDES(mutex_);

  /// Notes a message. If the first topic shows that time has moved back, drops all messages that
  /// wait for partners and returns what moved back, for the log: the caller starts over, too.
  std::optional<std::string> arrived(std::size_t topic, const ros::Time& stamp)
      FPGA_STEREO_EXCLUDES(mutex_);
  /// Notes that the message of the first topic with this stamp has found its partners. Returns
  /// false if the message is counted as dropped already.
  bool completed(const ros::Time& stamp) FPGA_STEREO_EXCLUDES(mutex_);

  /// Says what is missing if no set has come for 3 s, or no message where each stands for itself.
  std::optional<StateReport> trouble() const FPGA_STEREO_EXCLUDES(mutex_);

 private:
  /// The latest message of a topic since start().
  struct Arrival {
    ros::WallTime when;  // zero: none yet
    ros::Time stamp;
  };

  void drop_unpaired(DropCause cause) FPGA_STEREO_REQUIRES(mutex_);
  StateReport silent_topics(const std::vector<std::size_t>& silent) const;
  StateReport stamps_differ(const std::vector<Arrival>& arrivals) const;

  const std::vector<Topic> topics_;
  const SyncSettings settings_;
  Health& health_;

  mutable Mutex mutex_;
  std::set<std::size_t> subscribed_ FPGA_STEREO_GUARDED_BY(mutex_);  // empty: stopped
  bool needs_sets_ FPGA_STEREO_GUARDED_BY(mutex_) = false;
  ros::WallTime started_ FPGA_STEREO_GUARDED_BY(mutex_);
  ros::WallTime last_set_ FPGA_STEREO_GUARDED_BY(mutex_);
  std::vector<Arrival> arrivals_ FPGA_STEREO_GUARDED_BY(mutex_);  // by topic
  std::set<ros::Time> unpaired_ FPGA_STEREO_GUARDED_BY(mutex_);   // stamps of the first topic
  RewindDetector rewinds_ FPGA_STEREO_GUARDED_BY(mutex_);         // of the first topic
};

}  // namespace fpga_stereo
