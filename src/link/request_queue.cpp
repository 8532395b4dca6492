#include "link/request_queue.hpp"

#include <utility>

namespace fpga_stereo::link {
namespace {

constexpr std::uint64_t kSlowestLine = 1000;  // bytes per second: 9600 Bd

}  // namespace

void RequestQueue::push_back(Request request, OnAnswer on_answer) {
  requests_.push_back({std::move(request), std::move(on_answer), {}, {}});
}

void RequestQueue::push_front(Request request, OnAnswer on_answer, Time not_before) {
  requests_.push_front({std::move(request), std::move(on_answer), {}, not_before});
}

void RequestQueue::push_user_request(Request request, OnResult on_result) {
  requests_.push_back({std::move(request), {}, std::move(on_result), {}});
}

void RequestQueue::clear(const Error& error) {
  const std::deque<Entry> dropped = std::exchange(requests_, {});
  in_flight_.reset();
  for (const Entry& entry : dropped) {
    if (entry.on_result) entry.on_result(error);
  }
}

bool RequestQueue::tick(Time now) {
  if (requests_.empty()) return true;
  if (!in_flight_) {
    if (now < requests_.front().not_before) return true;
    in_flight_ = InFlight{};
    in_flight_->id = ++next_id_;
    in_flight_->sent = now;
    ++sent_count_;
    send(now);
    return true;
  }
  if (now < in_flight_->deadline) return true;
  if (in_flight_->is_accepted && in_flight_->tries < options_.tries) {
    // The id stays: an answer to either copy is the answer.
    ++in_flight_->tries;
    ++retry_count_;
    in_flight_->sent.reset();
    send(now);
    return true;
  }
  const Entry entry = std::move(requests_.front());
  requests_.pop_front();
  in_flight_.reset();
  if (entry.on_result) entry.on_result(Error{ErrorKind::kTimeout, "the board does not answer"});
  return false;
}

void RequestQueue::send(Time now) {
  const Request& request = requests_.front().request;
  Header header;
  header.type = request.type;
  header.index = in_flight_->id;
  outbox_.add_packet(header, request.payload);
  in_flight_->end = outbox_.queued();
  in_flight_->is_accepted = false;
  const std::uint64_t ahead = outbox_.queued() - outbox_.sent();
  in_flight_->deadline = now + options_.accept + std::chrono::seconds(ahead / kSlowestLine);
}

void RequestQueue::on_sent(Time now, Time began) {
  if (!in_flight_ || in_flight_->is_accepted || outbox_.sent() < in_flight_->end) return;
  in_flight_->is_accepted = true;
  in_flight_->deadline = now + options_.answer;
  if (in_flight_->tries == 1) in_flight_->sent = began;
}

/// Returns nullopt if the packet does not fit the request in flight.
std::optional<Result<RequestQueue::Values>> RequestQueue::unpack_answer(
    const Packet& packet) const {
  const Request& request = requests_.front().request;
  if (packet.header.type == PacketType::kRefused) {
    return Result<Values>(
        Error{ErrorKind::kIo, "the board refuses a request: " + refusal_text(packet)});
  }
  if (request.type != PacketType::kReadRegisters) {
    if (packet.header.type != PacketType::kWritten) return std::nullopt;
    return Result<Values>(Values{});
  }
  const auto values = unpack_registers(packet);
  if (!values || values->size() * 4 != request.payload.size()) return std::nullopt;
  for (std::size_t i = 0; i < values->size(); ++i) {
    if ((*values)[i].address != get_u32(&request.payload[4 * i])) return std::nullopt;
  }
  return Result<Values>(*values);
}

Status RequestQueue::complete(const Packet& packet, Time now) {
  auto result = unpack_answer(packet);
  if (!result) return {};
  // Removed first: the callback may add requests.
  const Entry entry = std::move(requests_.front());
  requests_.pop_front();
  in_flight_.reset();
  if (entry.on_result) {
    entry.on_result(std::move(*result));
    return {};
  }
  if (!*result) return result->error();
  return entry.on_answer(**result, now);
}

}  // namespace fpga_stereo::link
