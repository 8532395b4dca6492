#include "link/delivery_queue.hpp"

#include <gtest/gtest.h>

#include <thread>

namespace fpga_stereo::test {
namespace {

using link::ClosedEvent;
using link::DeliveryEvent;
using link::DeliveryQueue;
using link::IdentifiedEvent;
using link::NoteEvent;
using link::ReceivedFrames;

ReceivedFrames frames(std::uint64_t id) {
  ReceivedFrames made;
  made.set.frame_id = id;
  return made;
}

/// Takes all events after finish(): "7" for frame set 7, "identified", "closed", or a note's text.
std::vector<std::string> drain(DeliveryQueue& queue) {
  std::vector<std::string> all;
  while (const auto event = queue.pop()) {
    if (const auto* set = std::get_if<ReceivedFrames>(&*event)) {
      all.push_back(std::to_string(set->set.frame_id));
    } else if (const auto* note = std::get_if<NoteEvent>(&*event)) {
      all.push_back(note->text);
    } else {
      all.emplace_back(std::holds_alternative<ClosedEvent>(*event) ? "closed" : "identified");
    }
  }
  return all;
}

TEST(DeliveryQueue, KeepsTheOrder) {
  DeliveryQueue queue(8);
  queue.push(NoteEvent{"opened"});
  queue.push(IdentifiedEvent{});
  queue.push(frames(1));
  queue.push(ClosedEvent{});
  for (const std::size_t index : {3, 1, 0, 2}) {
    EXPECT_EQ(queue.pop()->index(), index);
  }
  queue.finish();
  EXPECT_FALSE(queue.pop());
}

TEST(DeliveryQueue, DropsTheOldestFrameSetsAndNothingElse) {
  DeliveryQueue queue(2);
  queue.push(frames(1));
  queue.push(IdentifiedEvent{});
  for (std::uint64_t id = 2; id <= 5; ++id) queue.push(frames(id));
  queue.push(ClosedEvent{});
  EXPECT_EQ(queue.dropped(), 3U);
  EXPECT_TRUE(std::holds_alternative<IdentifiedEvent>(*queue.pop()));
  EXPECT_EQ(std::get<ReceivedFrames>(*queue.pop()).set.frame_id, 4U);
  EXPECT_EQ(std::get<ReceivedFrames>(*queue.pop()).set.frame_id, 5U);
  EXPECT_TRUE(std::holds_alternative<ClosedEvent>(*queue.pop()));
}

TEST(DeliveryQueue, FinishDiscardsFrameSetsAndDeliversTheRest) {
  DeliveryQueue queue(8);
  queue.push(NoteEvent{"first"});
  queue.push(frames(1));
  queue.push(ClosedEvent{});
  queue.finish();
  EXPECT_EQ(drain(queue), (std::vector<std::string>{"first", "closed"}));
  EXPECT_EQ(queue.dropped(), 0U);
}

TEST(DeliveryQueue, FinishWakesTheConsumer) {
  DeliveryQueue queue(8);
  std::thread consumer([&] { EXPECT_FALSE(queue.pop()); });
  queue.finish();
  consumer.join();
}

}  // namespace
}  // namespace fpga_stereo::test
