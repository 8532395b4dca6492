// Reuses messages that no subscriber holds any more. Allocating a large message and filling it with
// zeros costs more than writing it.
#pragma once

#include <atomic>
#include <boost/make_shared.hpp>
#include <boost/shared_ptr.hpp>
#include <vector>

namespace fpga_stereo {

/// The messages of one topic. One thread at a time. Subscribers may keep a message for as long as
/// they like.
template <class Message>
class MessagePool {
 public:
  /// Returns a message that nobody else holds. It still has its old content.
  boost::shared_ptr<Message> take() {
    for (const auto& message : messages_) {
      if (message.use_count() != 1) continue;
      std::atomic_thread_fence(std::memory_order_acquire);  // after the last holder's reads
      return message;
    }
    auto message = boost::make_shared<Message>();
    if (messages_.size() < kMaxKept) messages_.push_back(message);
    return message;
  }

 private:
  static constexpr std::size_t kMaxKept = 4;  // if subscribers hold more, they get new messages

  std::vector<boost::shared_ptr<Message>> messages_;
};

}  // namespace fpga_stereo
