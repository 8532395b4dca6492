// fs_packet_finder beside the host's Decoder: of any bytes, the same packets and the same counts.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "PacketFinder.h"
#include "fpga_stereo/link/decoder.hpp"
#include "link/faults.hpp"

namespace fpga_stereo::test {
namespace {

using link::Decoder;
using link::Header;

constexpr int kSilenceMs = 100;

class FinderRig {
 public:
  explicit FinderRig(unsigned seed, double flowing = 1) : random_(seed), flowing_(flowing) {
    model_.rst_ni = 0;
    clock();
    model_.rst_ni = 1;
  }

  /// Gives bytes; lets the clock run until they are taken, and some more.
  void push(const Bytes& bytes) {
    std::size_t at = 0;
    for (int waited = 0; at < bytes.size(); ++waited) {
      ASSERT_LT(waited, 40000);
      model_.valid_i = flows();
      model_.data_i = bytes[at];
      model_.eval();
      if (model_.valid_i != 0 && model_.ready_o != 0) {
        ++at;
        waited = 0;
      }
      clock();
    }
    model_.valid_i = 0;
  }
  /// Nothing comes for longer than the line may be silent.
  void silence() {
    settle();
    model_.ms_i = 1;
    for (int ms = 0; ms <= kSilenceMs; ++ms) clock();
    model_.ms_i = 0;
    settle();
  }
  /// Until nothing more is found in what has come.
  void settle() {
    constexpr std::size_t kMostPackets = 1000;  // of any test here
    for (int quiet = 0; quiet < 20000; ++quiet) {
      const std::size_t before = packets.size();
      ASSERT_LT(before, kMostPackets) << "one is found again and again";
      clock();
      if (packets.size() != before || model_.packet_o != 0) quiet = 0;
    }
  }

  std::vector<Bytes> packets;  // header and payload
  std::uint64_t bad = 0, lost = 0, intact = 0;

 private:
  bool flows() { return flowing_ >= 1 || random_() % 1000 < flowing_ * 1000; }

  void clock() {
    // The one that takes packets: of some not all, of some nothing.
    model_.clk_i = 0;
    model_.done_i = 0;
    model_.byte_ready_i = flows();
    model_.eval();
    if (model_.packet_o != 0 && !open_) {
      open_ = true;
      payload_.clear();
    }
    if (open_) {
      if (payload_.size() == model_.length_o) {
        model_.done_i = 1;
        model_.byte_ready_i = 0;
        finish();
      }
      model_.eval();
      if (model_.byte_valid_o != 0 && model_.byte_ready_i != 0) payload_.push_back(model_.byte_o);
    }
    model_.clk_i = 1;
    model_.eval();
    bad += model_.bad_o;
    intact += model_.intact_o;
    if (model_.lost_o != 0) lost += model_.lost_count_o;
  }
  void finish() {
    open_ = false;
    Header header;
    header.version = model_.version_o;
    header.type = static_cast<link::PacketType>(model_.type_o);
    header.stream = static_cast<link::Stream>(model_.stream_o);
    header.length = model_.length_o;
    header.index = model_.index_o;
    header.frame_id = model_.frame_id_o;
    header.timestamp = model_.timestamp_o;
    const auto packed = link::pack(header);
    Bytes bytes(packed.begin(), packed.end());
    bytes.insert(bytes.end(), payload_.begin(), payload_.end());
    packets.push_back(bytes);
  }

  PacketFinder model_;
  std::mt19937 random_;
  double flowing_;
  bool open_ = false;
  Bytes payload_;
};

void send(std::uint32_t sequence, std::size_t size, std::mt19937& random, Bytes& stream) {
  Header header;
  header.version = static_cast<std::uint8_t>(random());
  header.type = static_cast<link::PacketType>(random() % 256);
  header.stream = static_cast<link::Stream>(random() % 256);
  header.index = static_cast<std::uint16_t>(random());
  header.sequence = sequence;
  header.frame_id = static_cast<std::uint64_t>(random()) << 32 | random();
  header.timestamp = static_cast<std::uint64_t>(random()) << 32 | random();
  Bytes payload(size);
  for (auto& byte : payload) byte = static_cast<std::uint8_t>(random());
  link::append_packet(header, payload.data(), size, stream);
}

/// As the finder gives a packet: sequence and flags are not told.
void take_out(Decoder& decoder, std::vector<Bytes>& out) {
  while (const auto packet = decoder.next()) {
    Header header = packet->header;
    header.sequence = 0;
    header.flags = 0;
    const auto packed = link::pack(header);
    Bytes bytes(packed.begin(), packed.end());
    bytes.insert(bytes.end(), packet->payload, packet->payload + packet->header.length);
    out.push_back(bytes);
  }
}

/// Both get the stream, and then silence, some times over.
void expect_same(const Bytes& stream, unsigned seed, double flowing) {
  Decoder decoder;
  std::vector<Bytes> expected;
  decoder.push(stream.data(), stream.size());
  take_out(decoder, expected);
  std::uint64_t before = 0;
  do {
    before = decoder.counters().skipped;
    decoder.give_up();
    take_out(decoder, expected);
  } while (decoder.counters().skipped != before);
  FinderRig rig(seed, flowing);
  rig.push(stream);
  // After silence all that waits is given up, one after the other.
  rig.silence();
  ASSERT_EQ(rig.packets.size(), expected.size()) << seed;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    for (auto* bytes : {&expected[i], &rig.packets[i]}) link::put_u32(&(*bytes)[12], 0);
    ASSERT_TRUE(rig.packets[i] == expected[i]) << "packet " << i << ", seed " << seed;
  }
  EXPECT_EQ(rig.bad, decoder.counters().bad_headers + decoder.counters().bad_payloads) << seed;
  EXPECT_EQ(rig.lost, decoder.counters().lost) << seed;
  EXPECT_EQ(rig.intact, decoder.counters().packets) << seed;
}

TEST(RtlPacketFinder, PacketsOfAllSizes) {
  std::mt19937 random(1);
  for (const double flowing : {1.0, 0.6}) {
    Bytes stream;
    for (std::uint32_t i = 0; i < 20; ++i) {
      const std::size_t size = i % 8 == 3 ? kLinkMaxHostPayloadBytes : random() % 300;
      send(kLinkFirstSequence + i, size, random, stream);
    }
    expect_same(stream, 1, flowing);
  }
}

TEST(RtlPacketFinder, GapsAreCountedAcrossTheWrap) {
  std::mt19937 random(2);
  Bytes stream;
  for (const std::uint32_t sequence : {0xFFFFFFFEU, 0xFFFFFFFFU, 2U, 3U, 3U, 1U, 4U, 0x80000003U}) {
    send(sequence, 8, random, stream);
  }
  expect_same(stream, 1, 1);
}

TEST(RtlPacketFinder, LongerThanAHostMaySend) {
  Bytes stream;
  std::mt19937 random(3);
  send(0, kLinkMaxHostPayloadBytes + 4, random, stream);
  send(1, 4, random, stream);
  FinderRig rig(1);
  rig.push(stream);
  rig.settle();
  EXPECT_EQ(rig.packets.size(), 1U);
  EXPECT_EQ(rig.bad, 1U);
}

TEST(RtlPacketFinder, SilenceEndsWhatLooksLikeALongPacket) {
  std::mt19937 random(3);
  Header header;
  header.length = kLinkMaxHostPayloadBytes;
  const auto fake = link::pack(header);
  Bytes stream(fake.begin(), fake.end());
  send(5, 20, random, stream);
  FinderRig rig(1);
  rig.push(stream);
  rig.settle();
  EXPECT_TRUE(rig.packets.empty());  // it may still come
  expect_same(stream, 1, 1);
}

TEST(RtlPacketFinder, AnyDamage) {
  std::mt19937 random(4);
  std::size_t whole = 0;
  for (unsigned round = 0; round < 150; ++round) {
    Bytes stream;
    for (std::uint32_t i = 0; i < 6; ++i)
      send(i, random() % 5 == 0 ? 800 : random() % 64, random, stream);
    const int times = 1 + static_cast<int>(random() % 4);
    for (int i = 0; i < times; ++i) {
      damage(stream, 0, stream.size(), static_cast<Fault>((round + i) % kNumFaults), random);
    }
    expect_same(stream, round, round % 3 == 0 ? 0.7 : 1.0);
    if (::testing::Test::HasFatalFailure()) return;
    whole += stream.size();
  }
  EXPECT_GT(whole, 50000U);
}

}  // namespace
}  // namespace fpga_stereo::test
