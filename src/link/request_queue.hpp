// The requests of a session: one in flight, sent again until the board answers or the tries are
// used up.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <vector>

#include "fpga_stereo/core/result.hpp"
#include "fpga_stereo/link/session_options.hpp"
#include "link/clock.hpp"
#include "link/outbox.hpp"
#include "link/request.hpp"

namespace fpga_stereo::link {

class RequestQueue {
 public:
  using Values = std::vector<RegisterWrite>;
  /// Receives the values of a read; no values answer a write. An error that it returns is returned
  /// by complete().
  using OnAnswer = std::function<Status(const Values& values, Time now)>;
  /// Receives the values of a read, or why there are none. Called exactly once.
  using OnResult = std::function<void(Result<Values>)>;

  RequestQueue(const SessionOptions& options, Outbox& outbox)
      : options_(options), outbox_(outbox) {}
  RequestQueue(const RequestQueue&) = delete;
  RequestQueue& operator=(const RequestQueue&) = delete;

  /// Appends a request of the session. clear() and timeouts drop `on_answer` without a call.
  void push_back(Request request, OnAnswer on_answer);
  /// Inserts a request before all others; it is not sent before `not_before`. No request may be in
  /// flight.
  void push_front(Request request, OnAnswer on_answer, Time not_before);
  /// Appends a request of a user of the session.
  void push_user_request(Request request, OnResult on_result);
  bool empty() const { return requests_.empty(); }

  /// Drops all requests. User requests receive `error`.
  void clear(const Error& error);

  /// Sends what is due. Returns false if the request in flight has used up its tries, or the
  /// transport does not accept it in time; it is dropped then, and a user request receives
  /// kTimeout.
  [[nodiscard]] bool tick(Time now);
  /// Starts the timeout of the request in flight once the transport has accepted all of its bytes.
  /// `began`: when the transport began to accept them. Call after Outbox::mark_sent().
  void on_sent(Time now, Time began);

  /// Returns true if the packet answers the request in flight; otherwise it is a late answer.
  bool is_answer(const Packet& packet) const {
    return in_flight_ && packet.header.index == in_flight_->id;
  }
  /// Returns when the request in flight was sent; nullopt for a request that was retried, because
  /// nobody knows which copy is answered.
  std::optional<Time> sent_at() const { return in_flight_->sent; }
  /// Finishes the request in flight with its answer and calls its callback. Returns the callback's
  /// error, or kIo if the board refused a request of the session. Ignores answers that do not fit
  /// the request: it will be retried.
  Status complete(const Packet& packet, Time now);

  std::uint64_t sent_count() const { return sent_count_; }
  std::uint64_t retry_count() const { return retry_count_; }

 private:
  struct Entry {
    Request request;
    OnAnswer on_answer;  // of the session's requests
    OnResult on_result;  // of user requests
    Time not_before{};
  };
  struct InFlight {
    std::uint16_t id = 0;
    int tries = 1;
    std::optional<Time> sent;
    std::uint64_t end = 0;     // Outbox::queued() after the request
    bool is_accepted = false;  // by the transport, all of it
    Time deadline{};           // of the answer; before, of the transport
  };
  void send(Time now);
  std::optional<Result<Values>> unpack_answer(const Packet& packet) const;

  const SessionOptions options_;
  Outbox& outbox_;
  std::deque<Entry> requests_;  // the first one may be in flight
  std::optional<InFlight> in_flight_;
  std::uint16_t next_id_ = 0;
  std::uint64_t sent_count_ = 0, retry_count_ = 0;
};

}  // namespace fpga_stereo::link
