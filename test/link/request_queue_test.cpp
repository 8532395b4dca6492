#include "link/request_queue.hpp"

#include <gtest/gtest.h>

#include <optional>

#include "fpga_stereo/core/spec.hpp"
#include "link/decoder.hpp"

namespace fpga_stereo::test {
namespace {

using link::PacketType;
using link::RequestQueue;
using std::chrono::milliseconds;
using Values = RequestQueue::Values;

/// A queue whose bytes are accepted at once, and the packets that it sent.
class QueueRig {
 public:
  /// Lets time pass; returns what RequestQueue::tick() returns.
  bool run(int ms) {
    now_ += milliseconds(ms);
    const bool is_alive = queue.tick(now_);
    take_bytes();
    return is_alive;
  }
  void take_bytes() {
    auto& bytes = outbox.bytes();
    decoder_.push(bytes.data(), bytes.size());
    while (const auto packet = decoder_.next()) sent.push_back(packet->header);
    outbox.mark_sent(bytes.size());
    bytes.clear();
    queue.on_sent(now_, now_);
  }
  Status answer(PacketType type, std::uint16_t id, const Values& values = {}) {
    std::vector<std::uint8_t> payload(8 * values.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
      link::put_u32(&payload[8 * i], values[i].address);
      link::put_u32(&payload[8 * i + 4], values[i].value);
    }
    link::Packet packet;
    packet.header.type = type;
    packet.header.index = id;
    packet.header.length = static_cast<std::uint16_t>(payload.size());
    packet.payload = payload.data();
    if (!queue.is_answer(packet)) return Error{ErrorKind::kInvalid, "late"};
    return queue.complete(packet, now_);
  }

  link::Outbox outbox;
  RequestQueue queue{link::SessionOptions{}, outbox};
  std::vector<link::Header> sent;

 private:
  link::Decoder decoder_;
  link::Time now_{std::chrono::seconds(100)};
};

TEST(RequestQueue, KeepsOneRequestInFlight) {
  QueueRig rig;
  std::vector<std::uint32_t> read;
  const auto keep = [&](const Values& values, link::Time) {
    read.push_back(values.at(0).value);
    return Status{};
  };
  rig.queue.push_back(link::read_request({3}), keep);
  rig.queue.push_back(link::read_request({4}), keep);
  rig.run(1);
  rig.run(1);
  ASSERT_EQ(rig.sent.size(), 1U);
  EXPECT_TRUE(rig.answer(PacketType::kRegisters, rig.sent[0].index, {{3, 30}}));
  rig.run(1);
  ASSERT_EQ(rig.sent.size(), 2U);
  EXPECT_NE(rig.sent[0].index, rig.sent[1].index);
  EXPECT_FALSE(rig.answer(PacketType::kRegisters, rig.sent[0].index, {{3, 31}})) << "late";
  EXPECT_TRUE(rig.answer(PacketType::kRegisters, rig.sent[1].index, {{4, 40}}));
  EXPECT_EQ(read, (std::vector<std::uint32_t>{30, 40}));
  EXPECT_TRUE(rig.queue.empty());
  EXPECT_EQ(rig.queue.sent_count(), 2U);
}

TEST(RequestQueue, RetriesWithTheSameIdUntilItsTriesAreUsedUp) {
  QueueRig rig;
  std::optional<ErrorKind> kind;
  rig.queue.push_user_request(link::read_request({3}),
                              [&](const Result<Values>& result) { kind = result.error().kind; });
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(rig.run(251)) << i;
  ASSERT_EQ(rig.sent.size(), 4U);
  EXPECT_EQ(rig.queue.retry_count(), 3U);
  EXPECT_EQ(rig.sent[0].index, rig.sent[3].index);
  EXPECT_NE(rig.sent[0].sequence, rig.sent[3].sequence);
  EXPECT_FALSE(kind);
  EXPECT_FALSE(rig.run(251));
  EXPECT_EQ(kind, ErrorKind::kTimeout);
  EXPECT_TRUE(rig.queue.empty());
}

TEST(RequestQueue, StartsTheTimeoutOnceTheTransportHasAcceptedTheRequest) {
  QueueRig rig;
  rig.queue.push_back(link::read_request({3}), [](const Values&, link::Time) { return Status{}; });
  link::Time now{std::chrono::seconds(200)};
  EXPECT_TRUE(rig.queue.tick(now));
  now += milliseconds(999);
  EXPECT_TRUE(rig.queue.tick(now));
  EXPECT_EQ(rig.queue.retry_count(), 0U);
  rig.outbox.mark_sent(rig.outbox.bytes().size());
  rig.queue.on_sent(now, now - milliseconds(1));
  EXPECT_EQ(rig.queue.sent_at(), now - milliseconds(1));
  EXPECT_TRUE(rig.queue.tick(now + milliseconds(251)));
  EXPECT_EQ(rig.queue.retry_count(), 1U);
  EXPECT_FALSE(rig.queue.sent_at()) << "no round trip for the clock";
}

TEST(RequestQueue, GivesUpARequestThatTheTransportDoesNotAccept) {
  QueueRig rig;
  std::optional<ErrorKind> kind;
  rig.queue.push_user_request(link::read_request({3}),
                              [&](const Result<Values>& result) { kind = result.error().kind; });
  link::Time now{std::chrono::seconds(200)};
  EXPECT_TRUE(rig.queue.tick(now));
  EXPECT_TRUE(rig.queue.tick(now + milliseconds(999)));
  EXPECT_FALSE(rig.queue.tick(now + milliseconds(1000)));
  EXPECT_EQ(kind, ErrorKind::kTimeout);
}

TEST(RequestQueue, IsPatientIfMuchWaitsBeforeTheRequest) {
  QueueRig rig;
  rig.outbox.add_frame({}, cv::Mat1b(48, 1280, std::uint8_t{0}));
  rig.queue.push_back(link::read_request({3}), [](const Values&, link::Time) { return Status{}; });
  link::Time now{std::chrono::seconds(200)};
  EXPECT_TRUE(rig.queue.tick(now));
  EXPECT_TRUE(rig.queue.tick(now + std::chrono::seconds(60)));
  EXPECT_FALSE(rig.queue.tick(now + std::chrono::seconds(70)));
}

TEST(RequestQueue, IgnoresAnswersThatDoNotFit) {
  QueueRig rig;
  bool is_answered = false;
  rig.queue.push_back(link::read_request({3}), [&](const Values&, link::Time) {
    is_answered = true;
    return Status{};
  });
  rig.run(1);
  const std::uint16_t id = rig.sent.at(0).index;
  EXPECT_TRUE(rig.answer(PacketType::kWritten, id));
  EXPECT_TRUE(rig.answer(PacketType::kRegisters, id, {{4, 1}}));
  EXPECT_TRUE(rig.answer(PacketType::kRegisters, id, {{3, 1}, {3, 1}}));
  EXPECT_FALSE(is_answered);
  EXPECT_TRUE(rig.answer(PacketType::kRegisters, id, {{3, 1}}));
  EXPECT_TRUE(is_answered);
}

TEST(RequestQueue, ReturnsTheErrorOfACallback) {
  QueueRig rig;
  rig.queue.push_back(link::write_request({{3, 1}}), [](const Values&, link::Time) -> Status {
    return Error{ErrorKind::kIo, "wrong"};
  });
  rig.run(1);
  const Status status = rig.answer(PacketType::kWritten, rig.sent.at(0).index);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().message, "wrong");
}

TEST(RequestQueue, InsertsAtTheFrontAndWaits) {
  QueueRig rig;
  const auto ignore = [](const Values&, link::Time) { return Status{}; };
  rig.queue.push_back(link::read_request({3}), ignore);
  rig.queue.push_front(link::write_request({{4, 1}}), ignore,
                       link::Time(std::chrono::seconds(100)) + milliseconds(10));
  rig.run(9);
  EXPECT_TRUE(rig.sent.empty());
  rig.run(1);
  ASSERT_EQ(rig.sent.size(), 1U);
  EXPECT_EQ(rig.sent[0].type, PacketType::kWriteRegisters);
}

TEST(RequestQueue, ClearAnswersUserRequestsOnly) {
  QueueRig rig;
  int errors = 0;
  rig.queue.push_back(link::read_request({3}), [&](const Values&, link::Time) {
    ADD_FAILURE();
    return Status{};
  });
  rig.queue.push_user_request(link::read_request({3}), [&](const Result<Values>& result) {
    EXPECT_EQ(result.error().message, "gone");
    ++errors;
  });
  rig.run(1);
  rig.queue.clear({ErrorKind::kUnplugged, "gone"});
  EXPECT_EQ(errors, 1);
  EXPECT_TRUE(rig.queue.empty());
}

}  // namespace
}  // namespace fpga_stereo::test
