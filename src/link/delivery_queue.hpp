// What a device's link thread hands to its delivery thread.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <variant>

#include "core/thread_safety.hpp"
#include "fpga_stereo/link/frame_set.hpp"
#include "fpga_stereo/link/identity.hpp"

namespace fpga_stereo::link {

/// A board was identified.
struct IdentifiedEvent {
  Identity identity;
};
/// The link was closed; frames in flight are lost.
struct ClosedEvent {};
/// A message for people.
struct NoteEvent {
  std::string text;
};
using DeliveryEvent = std::variant<ReceivedFrames, IdentifiedEvent, ClosedEvent, NoteEvent>;

/// A queue of events in order, for one producer and one consumer thread. When the consumer is too
/// slow, the oldest frame sets are dropped and counted, and the oldest notes are dropped; other
/// events are always delivered.
class DeliveryQueue {
 public:
  explicit DeliveryQueue(std::size_t max_frame_sets) : max_frame_sets_(max_frame_sets) {}

  void push(DeliveryEvent event) FPGA_STEREO_EXCLUDES(mutex_);
  /// Blocks until there is an event. Returns nullopt once the queue is finished and empty.
  std::optional<DeliveryEvent> pop() FPGA_STEREO_EXCLUDES(mutex_);
  /// Discards the frame sets that wait; pop() ends after the events that remain.
  void finish() FPGA_STEREO_EXCLUDES(mutex_);
  /// Returns the number of frame sets dropped because the queue was full.
  std::uint64_t dropped() const FPGA_STEREO_EXCLUDES(mutex_);

 private:
  template <class Event>
  bool drop_oldest(std::size_t max) FPGA_STEREO_REQUIRES(mutex_);

  const std::size_t max_frame_sets_;
  mutable Mutex mutex_;
  ConditionVariable changed_;
  std::deque<DeliveryEvent> events_ FPGA_STEREO_GUARDED_BY(mutex_);
  bool is_finished_ FPGA_STEREO_GUARDED_BY(mutex_) = false;
  std::uint64_t dropped_ FPGA_STEREO_GUARDED_BY(mutex_) = 0;
};

}  // namespace fpga_stereo::link
