// Compares fs_packet_finder with the host's Decoder: both must find the same packets in any bytes
// and count the same errors.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "PacketFinder.h"
#include "link/decoder.hpp"
#include "link/faults.hpp"

namespace fpga_stereo::test {
namespace {

using link::Decoder;
using link::Header;

constexpr int kSilenceMs = 100;

/// fs_packet_finder with a source of bytes and a consumer that reads each packet to its end.
class FinderRig {
 public:
  explicit FinderRig(unsigned seed, double flow_chance = 1)
      : random_(seed), flow_chance_(flow_chance) {
    model_.rst_ni = 0;
    clock();
    model_.rst_ni = 1;
  }

  /// Sends bytes; runs the clock until the finder has accepted all of them.
  void push(const Bytes& bytes) {
    std::size_t at = 0;
    for (int waited = 0; at < bytes.size(); ++waited) {
      ASSERT_LT(waited, 40000);
      model_.valid_i = is_flowing();
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
  /// Lets the line be silent for longer than a packet may pause.
  void pass_silence() {
    settle();
    model_.ms_i = 1;
    for (int ms = 0; ms <= kSilenceMs; ++ms) clock();
    model_.ms_i = 0;
    settle();
  }
  /// Runs until the finder finds no more packets in the bytes received so far.
  void settle() {
    constexpr std::size_t kMaxPackets = 1000;  // in any test of this file
    for (int quiet = 0; quiet < 20000; ++quiet) {
      const std::size_t before = packets.size();
      ASSERT_LT(before, kMaxPackets) << "the finder returns more packets than were sent";
      clock();
      if (packets.size() != before || model_.packet_o != 0) quiet = 0;
    }
  }

  std::vector<Bytes> packets;  // header and payload
  std::uint64_t bad_packets = 0, lost_packets = 0, intact_packets = 0;

 private:
  bool is_flowing() { return flow_chance_ >= 1 || random_() % 1000 < flow_chance_ * 1000; }

  void clock() {
    // The consumer of packets, which stalls at random.
    model_.clk_i = 0;
    model_.done_i = 0;
    model_.byte_ready_i = is_flowing();
    model_.eval();
    if (model_.packet_o != 0 && !in_packet_) {
      in_packet_ = true;
      payload_.clear();
    }
    if (in_packet_) {
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
    bad_packets += model_.bad_o;
    intact_packets += model_.intact_o;
    if (model_.lost_o != 0) lost_packets += model_.lost_count_o;
  }
  void finish() {
    in_packet_ = false;
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
  double flow_chance_;
  bool in_packet_ = false;
  Bytes payload_;
};

/// Appends a packet with random header fields and `size` random payload bytes to the stream.
void append_random_packet(std::uint32_t sequence, std::size_t size, std::mt19937& random,
                          Bytes& stream) {
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

/// Takes all packets from the decoder, as FinderRig::packets has them: without sequence and flags.
void take_packets(Decoder& decoder, std::vector<Bytes>& out) {
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

/// Sends the stream, then silence, to both; expects equal packets and counts.
void expect_equal_results(const Bytes& stream, unsigned seed, double flow_chance) {
  Decoder decoder;
  std::vector<Bytes> expected;
  decoder.push(stream.data(), stream.size());
  take_packets(decoder, expected);
  std::uint64_t before = 0;
  do {
    before = decoder.counters().skipped_bytes;
    decoder.discard_partial_packet();
    take_packets(decoder, expected);
  } while (decoder.counters().skipped_bytes != before);
  FinderRig rig(seed, flow_chance);
  rig.push(stream);
  // The silence discards all partial packets, one after the other.
  rig.pass_silence();
  ASSERT_EQ(rig.packets.size(), expected.size()) << seed;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    for (auto* bytes : {&expected[i], &rig.packets[i]}) link::put_u32(&(*bytes)[12], 0);
    ASSERT_TRUE(rig.packets[i] == expected[i]) << "packet " << i << ", seed " << seed;
  }
  EXPECT_EQ(rig.bad_packets, decoder.counters().bad_headers + decoder.counters().bad_payloads)
      << seed;
  EXPECT_EQ(rig.lost_packets, decoder.counters().lost_packets) << seed;
  EXPECT_EQ(rig.intact_packets, decoder.counters().packets) << seed;
}

TEST(RtlPacketFinder, FindsPacketsOfAllSizes) {
  std::mt19937 random(1);
  for (const double flow_chance : {1.0, 0.6}) {
    Bytes stream;
    for (std::uint32_t i = 0; i < 20; ++i) {
      const std::size_t size = i % 8 == 3 ? kLinkMaxHostPayloadBytes : random() % 300;
      append_random_packet(kLinkFirstSequence + i, size, random, stream);
    }
    expect_equal_results(stream, 1, flow_chance);
  }
}

TEST(RtlPacketFinder, CountsLostPacketsAcrossTheSequenceWrap) {
  std::mt19937 random(2);
  Bytes stream;
  for (const std::uint32_t sequence : {0xFFFFFFFEU, 0xFFFFFFFFU, 2U, 3U, 3U, 1U, 4U, 0x80000003U}) {
    append_random_packet(sequence, 8, random, stream);
  }
  expect_equal_results(stream, 1, 1);
}

TEST(RtlPacketFinder, RejectsPacketsLongerThanAHostMaySend) {
  Bytes stream;
  std::mt19937 random(3);
  append_random_packet(0, kLinkMaxHostPayloadBytes + 4, random, stream);
  append_random_packet(1, 4, random, stream);
  FinderRig rig(1);
  rig.push(stream);
  rig.settle();
  EXPECT_EQ(rig.packets.size(), 1U);
  EXPECT_EQ(rig.bad_packets, 1U);
}

TEST(RtlPacketFinder, SearchesAPartialPacketAgainAfterASilence) {
  std::mt19937 random(3);
  Header header;
  header.length = kLinkMaxHostPayloadBytes;
  const auto fake = link::pack(header);
  Bytes stream(fake.begin(), fake.end());
  append_random_packet(5, 20, random, stream);
  FinderRig rig(1);
  rig.push(stream);
  rig.settle();
  EXPECT_TRUE(rig.packets.empty());  // the rest of the long packet may still arrive
  expect_equal_results(stream, 1, 1);
}

TEST(RtlPacketFinder, EqualsTheDecoderOnDamagedStreams) {
  std::mt19937 random(4);
  std::size_t bytes = 0;
  for (unsigned round = 0; round < 150; ++round) {
    Bytes stream;
    for (std::uint32_t i = 0; i < 6; ++i)
      append_random_packet(i, random() % 5 == 0 ? 800 : random() % 64, random, stream);
    const int times = 1 + static_cast<int>(random() % 4);
    for (int i = 0; i < times; ++i) {
      damage(stream, 0, stream.size(), static_cast<Fault>((round + i) % kNumFaults), random);
    }
    expect_equal_results(stream, round, round % 3 == 0 ? 0.7 : 1.0);
    if (::testing::Test::HasFatalFailure()) return;
    bytes += stream.size();
  }
  EXPECT_GT(bytes, 50000U);
}

}  // namespace
}  // namespace fpga_stereo::test
