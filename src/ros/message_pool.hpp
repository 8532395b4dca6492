// Messages that are used again when nobody holds them any more: a large one costs more to allocate
// and to fill with zeros than to write.
#pragma once

#include <atomic>
#include <boost/make_shared.hpp>
#include <boost/shared_ptr.hpp>
#include <vector>

namespace fpga_stereo {

/// Of one topic; used by one thread. Who gets a message may keep it for as long as it likes.
template <class Message>
class MessagePool {
 public:
  /// One that nobody else holds, with what was in it before.
  boost::shared_ptr<Message> take() {
    for (const auto& message : messages_) {
      if (message.use_count() != 1) continue;
      std::atomic_thread_fence(std::memory_order_acquire);  // behind the reads of its last holder
      return message;
    }
    auto made = boost::make_shared<Message>();
    if (messages_.size() < kMost) messages_.push_back(made);
    return made;
  }

 private:
  static constexpr std::size_t kMost = 4;  // kept; subscribers with longer queues get new ones

  std::vector<boost::shared_ptr<Message>> messages_;
};

}  // namespace fpga_stereo
