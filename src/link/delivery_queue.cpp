#include "link/delivery_queue.hpp"

#include <algorithm>
#include <utility>

namespace fpga_stereo::link {
namespace {

constexpr std::size_t kMaxNotes = 256;

template <class Event>
bool holds(const DeliveryEvent& event) {
  return std::holds_alternative<Event>(event);
}

}  // namespace

/// Removes the oldest event of this type if more than `max` wait. Returns true if it did.
template <class Event>
bool DeliveryQueue::drop_oldest(std::size_t max) {
  const auto count = std::count_if(events_.begin(), events_.end(), holds<Event>);
  if (static_cast<std::size_t>(count) <= max) return false;
  events_.erase(std::find_if(events_.begin(), events_.end(), holds<Event>));
  return true;
}

void DeliveryQueue::push(DeliveryEvent event) {
  const MutexLock lock(mutex_);
  events_.push_back(std::move(event));
  if (drop_oldest<ReceivedFrames>(max_frame_sets_)) ++dropped_;
  drop_oldest<NoteEvent>(kMaxNotes);
  changed_.notify_one();
}

std::optional<DeliveryEvent> DeliveryQueue::pop() {
  const MutexLock lock(mutex_);
  while (events_.empty() && !is_finished_) changed_.wait(mutex_);
  if (events_.empty()) return std::nullopt;
  DeliveryEvent event = std::move(events_.front());
  events_.pop_front();
  return event;
}

void DeliveryQueue::finish() {
  const MutexLock lock(mutex_);
  is_finished_ = true;
  events_.erase(std::remove_if(events_.begin(), events_.end(), holds<ReceivedFrames>),
                events_.end());
  changed_.notify_one();
}

std::uint64_t DeliveryQueue::dropped() const {
  const MutexLock lock(mutex_);
  return dropped_;
}

}  // namespace fpga_stereo::link
