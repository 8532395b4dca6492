// The decoder on damaged streams: it returns intact packets and nothing else.
#include "link/decoder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "link/faults.hpp"

namespace fpga_stereo::test {
namespace {

using link::Decoder;
using link::Header;

struct Sent {
  Bytes whole;
  Bytes bytes;  // without the payload CRC
};

/// Appends a packet with random contents to `stream`.
Sent send(std::uint32_t sequence, std::size_t size, std::mt19937& random, Bytes& stream) {
  Header header;
  header.type = link::PacketType::kRows;
  header.index = static_cast<std::uint16_t>(random());
  header.sequence = sequence;
  header.frame_id = random();
  Bytes payload(size);
  for (auto& byte : payload) byte = static_cast<std::uint8_t>(random());
  const std::size_t begin = stream.size();
  link::append_packet(header, payload.data(), size, stream);
  const Bytes whole(stream.begin() + static_cast<std::ptrdiff_t>(begin), stream.end());
  return {whole, Bytes(whole.begin(), whole.end() - link::kCrcBytes)};
}

void take_out(Decoder& decoder, std::vector<Bytes>& out) {
  while (const auto packet = decoder.next()) {
    const auto header = link::pack(packet->header);
    Bytes bytes(header.begin(), header.end());
    bytes.insert(bytes.end(), packet->payload, packet->payload + packet->header.length);
    out.push_back(bytes);
  }
}

/// Feeds `stream` in pieces of up to `piece` bytes, then a silence.
std::vector<Bytes> decode(Decoder& decoder, const Bytes& stream, std::size_t piece,
                          std::mt19937& random) {
  std::vector<Bytes> out;
  for (std::size_t at = 0; at < stream.size();) {
    const std::size_t size = std::min(stream.size() - at, 1 + random() % piece);
    decoder.push(stream.data() + at, size);
    take_out(decoder, out);
    at += size;
  }
  std::uint64_t before = 0;
  do {
    before = decoder.counters().skipped_bytes;
    decoder.discard_partial_packet();
    take_out(decoder, out);
  } while (decoder.counters().skipped_bytes != before);
  return out;
}

TEST(Decoder, AcceptsAnySplitOfTheStream) {
  std::mt19937 random(1);
  Bytes stream;
  std::vector<Bytes> sent;
  for (std::uint32_t i = 0; i < 40; ++i) {
    const std::size_t size = i % 8 == 0 ? link::kMaxPayloadBytes : random() % 300;
    sent.push_back(send(0xFFFFFFF0U + i, size, random, stream).bytes);  // past the wrap
  }
  for (const std::size_t piece : {1, 2, 7, 36, 512, 4000, 65536, 1000000}) {
    Decoder decoder;
    EXPECT_EQ(decode(decoder, stream, piece, random), sent) << piece;
    EXPECT_EQ(decoder.counters().bytes, stream.size());
    EXPECT_EQ(decoder.counters().packets, sent.size());
    EXPECT_EQ(decoder.counters().skipped_bytes, 0U);
    EXPECT_EQ(decoder.counters().lost_packets, 0U);
  }
}

TEST(Decoder, CountsLostPacketsAcrossTheWrap) {
  std::mt19937 random(2);
  Bytes stream;
  for (const std::uint32_t sequence : {0xFFFFFFFEU, 0xFFFFFFFFU, 2U, 3U, 3U, 1U, 4U}) {
    send(sequence, 8, random, stream);
  }
  Decoder decoder;
  EXPECT_EQ(decode(decoder, stream, 100, random).size(), 7U);
  EXPECT_EQ(decoder.counters().lost_packets, 2U + 2U);  // 0 and 1; after 1 came late: 2 and 3
}

TEST(Decoder, SearchesAPartialPacketAfterASilence) {
  std::mt19937 random(3);
  Bytes stream;
  Header header;
  header.length = link::kMaxPayloadBytes;
  const auto fake = link::pack(header);
  stream.assign(fake.begin(), fake.end());
  const Bytes sent = send(5, 20, random, stream).bytes;
  Decoder decoder;
  decoder.push(stream.data(), stream.size());
  EXPECT_FALSE(decoder.next());  // it may still come
  decoder.discard_partial_packet();
  std::vector<Bytes> out;
  take_out(decoder, out);
  EXPECT_EQ(out, std::vector<Bytes>{sent});
  EXPECT_EQ(decoder.counters().bad_payloads, 1U);
  EXPECT_EQ(decoder.counters().skipped_bytes, link::kHeaderBytes);
}

TEST(Decoder, DeliversPacketsOfAnUnknownVersion) {
  Bytes stream;
  Header header;
  header.version = 9;
  header.type = static_cast<link::PacketType>(0xEE);
  link::append_packet(header, nullptr, 0, stream);
  Decoder decoder;
  decoder.push(stream.data(), stream.size());
  const auto packet = decoder.next();
  ASSERT_TRUE(packet);
  EXPECT_EQ(packet->header.version, 9);
}

// A packet loses its 32 bytes of payload and their CRC. The header that follows looks like them: it
// ends with a CRC of its own first 32 bytes.
TEST(Decoder, DoesNotTakeAHeaderForAPayload) {
  std::mt19937 random(6);
  Bytes stream;
  send(0, 32, random, stream);
  stream.resize(link::kHeaderBytes);
  const Bytes sent = send(1, 32, random, stream).bytes;
  Decoder decoder;
  EXPECT_EQ(decode(decoder, stream, 1000, random), std::vector<Bytes>{sent});
}

// Headers that claim the bytes of those after them: each is searched, none hides a packet.
TEST(Decoder, FindsPacketsAmongOverlappingOnes) {
  std::mt19937 random(5);
  Bytes stream;
  std::vector<Bytes> sent;
  Header header;
  header.length = link::kMaxPayloadBytes;
  for (int i = 0; i < 2000; ++i) {
    const auto claim = link::pack(header);
    stream.insert(stream.end(), claim.begin(), claim.end());
    if (i % 100 == 50) {
      sent.push_back(
          send(static_cast<std::uint32_t>(i), 4 * (random() % 80), random, stream).bytes);
    }
  }
  for (const std::size_t piece : {512, 65536}) {
    Decoder decoder;
    EXPECT_EQ(decode(decoder, stream, piece, random), sent) << piece;
  }
}

// After any damage the decoder finds the next intact packet, and never returns a damaged one.
TEST(Decoder, RecoversFromAMillionDamages) {
  std::mt19937 random(4);
  constexpr int kDamages = 1000000, kPackets = 5;
  std::uint64_t delivered = 0;
  for (int damages = 0; damages < kDamages;) {
    // Damages packets `first` to `last`, once or a few times.
    const std::size_t first = random() % kPackets;
    const std::size_t last = first + random() % std::min<std::size_t>(2, kPackets - first);
    Bytes stream;
    std::vector<Bytes> sent;
    Bytes whole;  // the last damaged packet, before the damage
    std::vector<std::size_t> begins;
    for (std::uint32_t i = 0; i < kPackets; ++i) {
      begins.push_back(stream.size());
      const Sent packet = send(i, random() % 64, random, stream);
      sent.push_back(packet.bytes);
      if (i <= last) whole = packet.whole;
    }
    begins.push_back(stream.size());
    const std::size_t bytes_after = stream.size() - begins[last + 1];
    const int times = 1 + static_cast<int>(random() % 3);
    for (int i = 0; i < times && stream.size() - bytes_after > begins[first]; ++i, ++damages) {
      damage(stream, begins[first], stream.size() - bytes_after,
             static_cast<Fault>(random() % kNumFaults), random);
    }
    Decoder decoder;
    const auto out = decode(decoder, stream, 1 + random() % 400, random);
    // Expects, in order: all packets before the damage, some of the damaged ones, all after it. A
    // repeated run of bytes may repeat a packet.
    std::size_t at = 0;
    for (std::size_t i = 0; i < first; ++i, ++at) ASSERT_EQ(out.at(at), sent[i]) << damages;
    // If a packet loses its last byte and that equals the first byte of the next sync word, either
    // of the two packets may count as the intact one.
    const auto found = std::search(stream.begin(), stream.end(), whole.begin(), whole.end());
    const bool borrows =
        found != stream.end() && stream.end() - found - static_cast<std::ptrdiff_t>(whole.size()) <
                                     static_cast<std::ptrdiff_t>(bytes_after);
    if (borrows) continue;
    std::size_t end = out.size();
    for (std::size_t i = kPackets - 1; i > last; --i) ASSERT_EQ(out.at(--end), sent[i]) << damages;
    ASSERT_LE(at, end);
    for (; at < end; ++at) {
      ASSERT_TRUE(std::find(sent.begin() + static_cast<std::ptrdiff_t>(first),
                            sent.begin() + static_cast<std::ptrdiff_t>(last) + 1,
                            out[at]) != sent.begin() + static_cast<std::ptrdiff_t>(last) + 1)
          << damages;
    }
    delivered += out.size();
  }
  EXPECT_GT(delivered, kDamages);
}

}  // namespace
}  // namespace fpga_stereo::test
