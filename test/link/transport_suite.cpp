#include "link/transport_suite.hpp"

#include <algorithm>
#include <chrono>
#include <random>
#include <thread>

namespace fpga_stereo::test {

using Clock = std::chrono::steady_clock;
using link::Recovery;

Bytes random_bytes(std::size_t size, unsigned seed) {
  std::mt19937 random(seed);
  Bytes bytes(size);
  for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
  return bytes;
}

Bytes read_all(link::Transport& transport, std::size_t size, std::size_t piece) {
  Bytes bytes;
  Bytes part(piece);
  while (bytes.size() < size) {
    const std::size_t most = std::min(piece, size - bytes.size());
    const auto got = transport.read(part.data(), most, Milliseconds(5000));
    if (!got || *got == 0 || *got > most) break;
    bytes.insert(bytes.end(), part.begin(), part.begin() + static_cast<std::ptrdiff_t>(*got));
  }
  return bytes;
}

std::size_t write_all(link::Transport& transport, const Bytes& bytes, std::size_t piece) {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const auto went = transport.write(bytes.data() + done, std::min(piece, bytes.size() - done),
                                      Milliseconds(5000));
    if (!went || *went == 0) break;
    done += *went;
  }
  return done;
}

void TransportTest::open() {
  auto opened = line_->open();
  ASSERT_TRUE(opened) << opened.error().message;
  transport_ = std::move(*opened);
}

namespace {

/// Starts a thread that calls `action` after a pause.
template <class Action>
std::thread after(Milliseconds pause, Action action) {
  return std::thread([=] {
    std::this_thread::sleep_for(pause);
    action();
  });
}

ErrorKind kind_of_read(link::Transport& transport, Milliseconds timeout = Milliseconds(5000)) {
  std::uint8_t byte = 0;
  const auto got = transport.read(&byte, 1, timeout);
  return got ? ErrorKind::kInvalid : got.error().kind;
}

TEST_P(TransportTest, DeliversBytesUnchangedInPiecesOfAnySize) {
  const std::size_t pieces[] = {1, 61, 62, 63, 509, 510, 511, 512, 1020, 4096, 65536, 300000};
  unsigned seed = 1;
  for (const std::size_t piece : pieces) {
    const Bytes sent = random_bytes(std::min<std::size_t>(piece * 8 + 3, 350000), ++seed);
    line_->send(sent);
    ASSERT_EQ(read_all(*transport_, sent.size(), piece), sent) << piece;
    ASSERT_EQ(write_all(*transport_, sent, piece), sent.size()) << piece;
    ASSERT_EQ(line_->take(sent.size()), sent) << piece;
  }
}

TEST_P(TransportTest, DeliversASmallWriteAtOnce) {
  for (unsigned i = 0; i < 20; ++i) {
    const Bytes sent = random_bytes(1 + i * 7, i);
    line_->send(sent);
    ASSERT_EQ(read_all(*transport_, sent.size()), sent) << i;
  }
}

TEST_P(TransportTest, ReadBlocksForItsTimeout) {
  std::uint8_t byte = 0;
  for (const int timeout : {0, 1, 40}) {
    const auto begin = Clock::now();
    const auto got = transport_->read(&byte, 1, Milliseconds(timeout));
    ASSERT_TRUE(got) << got.error().message;
    EXPECT_EQ(*got, 0U);
    EXPECT_GE(Clock::now() - begin, Milliseconds(timeout));
    EXPECT_LT(Clock::now() - begin, Milliseconds(timeout + 2000));
  }
  auto sender = after(Milliseconds(20), [&] { line_->send({7}); });
  EXPECT_EQ(read_all(*transport_, 1), Bytes{7});
  sender.join();
}

TEST_P(TransportTest, WriteEndsInTimeAndLosesNothing) {
  const Bytes sent = random_bytes(1500000, 3);
  line_->listen(false);
  const auto begin = Clock::now();
  const auto went = transport_->write(sent.data(), sent.size(), Milliseconds(50));
  ASSERT_TRUE(went) << went.error().message;
  EXPECT_LT(*went, sent.size());
  EXPECT_GE(Clock::now() - begin, Milliseconds(50));
  EXPECT_LT(Clock::now() - begin, Milliseconds(2500));
  line_->listen(true);
  const Bytes rest(sent.begin() + static_cast<std::ptrdiff_t>(*went), sent.end());
  EXPECT_EQ(write_all(*transport_, rest), rest.size());
  EXPECT_EQ(line_->take(sent.size()), sent);
}

TEST_P(TransportTest, WritesWithShortTimeoutsLoseNothing) {
  const Bytes sent = random_bytes(400000, 7);
  std::thread reader([&] { EXPECT_TRUE(line_->take(sent.size()) == sent); });
  std::size_t done = 0;
  for (int i = 0; done < sent.size() && i < 20000; ++i) {
    const auto went = transport_->write(&sent[done], sent.size() - done, Milliseconds(i % 2));
    ASSERT_TRUE(went) << went.error().message;
    done += *went;
  }
  reader.join();
  EXPECT_EQ(done, sent.size());
}

TEST_P(TransportTest, CarriesMuchDataBothWaysAtOnce) {
  const Bytes in = random_bytes(3000000, 4), out = random_bytes(2000000, 5);
  std::size_t went = 0;
  std::thread writer([&] { went = write_all(*transport_, out, 100000); });
  line_->send(in);
  const Bytes got = read_all(*transport_, in.size());
  const Bytes taken = line_->take(out.size());
  writer.join();
  EXPECT_EQ(went, out.size());
  EXPECT_TRUE(got == in);
  EXPECT_TRUE(taken == out);
  EXPECT_EQ(transport_->counters().bytes_in, in.size());
  EXPECT_EQ(transport_->counters().bytes_out, out.size());
  EXPECT_EQ(transport_->counters().stalls, 0U);
}

TEST_P(TransportTest, ALateReaderLosesNothing) {
  const Bytes sent = random_bytes(5500000, 6);
  line_->send(sent);
  std::this_thread::sleep_for(Milliseconds(300));
  EXPECT_TRUE(read_all(*transport_, sent.size()) == sent);
}

TEST_P(TransportTest, FailsIfUnpluggedWhileReading) {
  auto hand = after(Milliseconds(20), [&] { line_->unplug(); });
  EXPECT_EQ(kind_of_read(*transport_), ErrorKind::kUnplugged);
  hand.join();
  EXPECT_EQ(kind_of_read(*transport_, Milliseconds(0)), ErrorKind::kUnplugged);
  const auto went = transport_->write(Bytes{1}.data(), 1, Milliseconds(100));
  ASSERT_FALSE(went);
  EXPECT_EQ(went.error().kind, ErrorKind::kUnplugged);
  EXPECT_FALSE(transport_->recover(Recovery::kPurge));
}

TEST_P(TransportTest, FailsIfUnpluggedWhileWriting) {
  line_->listen(false);
  auto hand = after(Milliseconds(50), [&] { line_->unplug(); });
  const Bytes sent(1500000);
  auto went = transport_->write(sent.data(), sent.size(), Milliseconds(5000));
  // Bytes in flight may still be counted, but only once.
  if (went) went = transport_->write(sent.data(), sent.size(), Milliseconds(5000));
  hand.join();
  ASSERT_FALSE(went);
  EXPECT_EQ(went.error().kind, ErrorKind::kUnplugged);
  EXPECT_FALSE(went.error().message.empty());
}

TEST_P(TransportTest, ClosesDuringATransfer) {
  for (const bool unplugged : {false, true}) {
    line_->send(Bytes(1000000));
    line_->listen(false);
    const auto went = transport_->write(Bytes(1000).data(), 1000, Milliseconds(1));
    EXPECT_TRUE(went);
    const auto begin = Clock::now();
    std::thread hand;
    if (unplugged) hand = std::thread([&] { line_->unplug(); });
    transport_.reset();
    EXPECT_LT(Clock::now() - begin, Milliseconds(1500));
    if (hand.joinable()) hand.join();
    line_->listen(true);
    if (!unplugged) open();
  }
}

TEST_P(TransportTest, OpensAgainAfterReplugging) {
  for (int i = 0; i < 3; ++i) {
    line_->unplug();
    EXPECT_EQ(kind_of_read(*transport_), ErrorKind::kUnplugged);
    const auto absent = line_->open();
    ASSERT_FALSE(absent);
    EXPECT_EQ(absent.error().kind, ErrorKind::kNotFound) << absent.error().message;
    line_->plug();
    transport_.reset();
    open();
    line_->send({1, 2, 3});
    EXPECT_EQ(read_all(*transport_, 3), (Bytes{1, 2, 3}));
  }
}

TEST_P(TransportTest, Recovers) {
  for (const auto step : {Recovery::kPurge, Recovery::kRestart}) {
    line_->send(Bytes(1000, 9));
    EXPECT_EQ(read_all(*transport_, 1), Bytes{9});
    const auto begin = Clock::now();
    const Status recovered = transport_->recover(step);
    EXPECT_TRUE(recovered) << recovered.error().message;
    EXPECT_LT(Clock::now() - begin, Milliseconds(2000));
    line_->send({1, 2, 3});
    EXPECT_EQ(read_all(*transport_, 3), (Bytes{1, 2, 3}));
    EXPECT_EQ(write_all(*transport_, {4, 5}), 2U);
    EXPECT_EQ(line_->take(2), (Bytes{4, 5}));
  }
  EXPECT_TRUE(transport_->recover(Recovery::kReset));
  EXPECT_EQ(kind_of_read(*transport_), ErrorKind::kUnplugged);
  transport_.reset();
  open();
  line_->send({6});
  EXPECT_EQ(read_all(*transport_, 1), Bytes{6});
}

TEST_P(TransportTest, OpensForOneProgramOnly) {
  if (!GetParam().exclusive) GTEST_SKIP() << "any program may open this line";
  const auto second = line_->open();
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().kind, ErrorKind::kBusy);
  EXPECT_NE(second.error().message.find("another program"), std::string::npos);
  // The refused attempt must not disturb the open one.
  line_->send({8});
  EXPECT_EQ(read_all(*transport_, 1), Bytes{8});
}

}  // namespace
}  // namespace fpga_stereo::test
