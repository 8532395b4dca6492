#include "ros/arrival_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace fpga_stereo {
namespace {

const ros::WallDuration kSilence(3.0);  // a topic without messages for this long is silent

}  // namespace

ArrivalLog::ArrivalLog(std::vector<Topic> topics, const SyncSettings& settings, Health& health)
    : topics_(std::move(topics)), settings_(settings), health_(health), arrivals_(topics_.size()) {}

void ArrivalLog::start(std::set<std::size_t> subscribed, bool needs_sets) {
  const MutexLock lock(mutex_);
  drop_unpaired(DropCause::kUnwanted);
  subscribed_ = std::move(subscribed);
  needs_sets_ = needs_sets;
  started_ = last_set_ = ros::WallTime::now();
  arrivals_.assign(topics_.size(), {});
}

void ArrivalLog::stop() {
  const MutexLock lock(mutex_);
  drop_unpaired(DropCause::kUnwanted);
  subscribed_.clear();
}

void ArrivalLog::drop_unpaired(DropCause cause) {
  health_.dropped(cause, unpaired_.size());
  unpaired_.clear();
}

std::optional<std::string> ArrivalLog::arrived(std::size_t topic, const ros::Time& stamp) {
  const MutexLock lock(mutex_);
  arrivals_[topic] = {ros::WallTime::now(), stamp};
  if (topic != 0 || !needs_sets_) return std::nullopt;
  health_.received();
  std::optional<ros::Time> simulated_now;
  if (ros::Time::isSimTime()) simulated_now = ros::Time::now();
  auto rewind = rewinds_.note(stamp, simulated_now);
  if (rewind) drop_unpaired(DropCause::kUnsynchronized);
  const bool is_duplicate = !unpaired_.insert(stamp).second;
  if (is_duplicate) health_.dropped(DropCause::kUnsynchronized);
  if (unpaired_.size() > static_cast<std::size_t>(settings_.queue_size)) {
    unpaired_.erase(unpaired_.begin());
    health_.dropped(DropCause::kUnsynchronized);
  }
  return rewind;
}

bool ArrivalLog::completed(const ros::Time& stamp) {
  const MutexLock lock(mutex_);
  last_set_ = ros::WallTime::now();
  const auto found = unpaired_.find(stamp);
  if (found == unpaired_.end()) return false;
  // Older messages will not find a partner any more.
  health_.dropped(DropCause::kUnsynchronized,
                  static_cast<std::uint64_t>(std::distance(unpaired_.begin(), found)));
  unpaired_.erase(unpaired_.begin(), std::next(found));
  return true;
}

std::optional<StateReport> ArrivalLog::trouble() const {
  const ros::WallTime now = ros::WallTime::now();
  std::vector<Arrival> arrivals;
  std::vector<std::size_t> silent;
  {
    const MutexLock lock(mutex_);
    const ros::WallTime since = needs_sets_ ? std::max(started_, last_set_) : started_;
    if (subscribed_.empty() || now - since < kSilence) return std::nullopt;
    arrivals = arrivals_;
    for (const std::size_t topic : subscribed_) {
      const ros::WallTime& when = arrivals[topic].when;
      if (when.isZero() || now - when >= kSilence) silent.push_back(topic);
    }
    if (silent.empty() && !needs_sets_) return std::nullopt;
  }
  return silent.empty() ? stamps_differ(arrivals) : silent_topics(silent);
}

StateReport ArrivalLog::silent_topics(const std::vector<std::size_t>& silent) const {
  std::string names;
  bool has_images = true;
  for (const std::size_t topic : silent) {
    names += (names.empty() ? "" : ", ") + topics_[topic].name;
    has_images = has_images && topics_[topic].is_camera_info;
  }
  if (has_images) {
    return {NodeState::kWaitingForCameraInfo, "no camera_info: nothing arrives on " + names};
  }
  return {NodeState::kWaitingForImages, "no images: nothing arrives on " + names};
}

StateReport ArrivalLog::stamps_differ(const std::vector<Arrival>& arrivals) const {
  const auto [first, last] =
      std::minmax_element(arrivals.begin(), arrivals.end(),
                          [](const Arrival& a, const Arrival& b) { return a.stamp < b.stamp; });
  const std::string rule = settings_.approximate_sync
                               ? fmt::format("sync_tolerance is {:.4f} s", settings_.sync_tolerance)
                               : "all four must be equal unless approximate_sync is set";
  return {NodeState::kUnsynchronised,
          fmt::format("not synchronised: the latest stamps of {} and {} are {:.4f} s apart; {}",
                      topics_[static_cast<std::size_t>(first - arrivals.begin())].name,
                      topics_[static_cast<std::size_t>(last - arrivals.begin())].name,
                      (last->stamp - first->stamp).toSec(), rule)};
}

}  // namespace fpga_stereo
