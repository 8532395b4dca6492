// Packing and unpacking of packets, byte by byte.
#include "link/packet.hpp"

#include <gtest/gtest.h>

#include <string>

namespace fpga_stereo::link {
namespace {

TEST(Crc32c, HasTheCheckValueOfTheCatalogue) {
  const std::string text = "123456789";
  EXPECT_EQ(crc32c(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()), 0xE3069283U);
  EXPECT_EQ(crc32c(nullptr, 0), 0U);
}

TEST(Packet, PutsEachFieldInItsPlace) {
  Header header;
  header.type = PacketType::kRows;
  header.stream = Stream::kDisparity;
  header.length = 0x0504;
  header.index = 0x0706;
  header.sequence = 0x0B0A0908;
  header.frame_id = 0x1312111017161514;
  header.timestamp = 0x2322212027262524;
  const auto bytes = pack(header);
  const std::array<std::uint8_t, 32> expected{0xD5, 0x46, 0x53, 0xA7, 1,    0x11, 0,    1,
                                              0x04, 0x05, 0x06, 0x07, 0x08, 0x09, 0x0A, 0x0B,
                                              0x14, 0x15, 0x16, 0x17, 0x10, 0x11, 0x12, 0x13,
                                              0x24, 0x25, 0x26, 0x27, 0x20, 0x21, 0x22, 0x23};
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(bytes[i], expected[i]) << i;
  EXPECT_EQ(get_u32(&bytes[32]), crc32c(bytes.data(), 32));
}

TEST(Packet, UnpackReversesPack) {
  Header header;
  header.version = 7;
  header.type = static_cast<PacketType>(0x77);
  header.flags = 3;
  header.stream = static_cast<Stream>(200);
  header.length = kMaxPayloadBytes;
  header.index = 65535;
  header.sequence = 0xFFFFFFFF;
  header.frame_id = ~std::uint64_t{0};
  header.timestamp = 1;
  const auto found = unpack(pack(header).data());
  ASSERT_TRUE(found);
  EXPECT_EQ(found->version, header.version);
  EXPECT_EQ(found->type, header.type);
  EXPECT_EQ(found->flags, header.flags);
  EXPECT_EQ(found->stream, header.stream);
  EXPECT_EQ(found->length, header.length);
  EXPECT_EQ(found->index, header.index);
  EXPECT_EQ(found->sequence, header.sequence);
  EXPECT_EQ(found->frame_id, header.frame_id);
  EXPECT_EQ(found->timestamp, header.timestamp);
}

TEST(Packet, RefusesAHeaderWithAnyBitFlipped) {
  const auto right = pack(Header{});
  for (std::size_t bit = 0; bit < 8 * right.size(); ++bit) {
    auto wrong = right;
    wrong[bit / 8] = static_cast<std::uint8_t>(wrong[bit / 8] ^ 1U << bit % 8);
    EXPECT_FALSE(unpack(wrong.data())) << bit;
  }
}

TEST(Packet, RefusesImpossibleLengths) {
  Header header;
  for (const int length : {1, 2, 3, 4, 8192, 8193, 8196, 65532}) {
    header.length = static_cast<std::uint16_t>(length);
    EXPECT_EQ(unpack(pack(header).data()).has_value(), length == 4 || length == 8192) << length;
  }
}

TEST(Packet, PadsThePayloadAndAppendsItsCrc) {
  const std::uint8_t payload[5] = {1, 2, 3, 4, 5};
  std::vector<std::uint8_t> stream{99};
  append_packet(Header{}, payload, 5, stream);
  ASSERT_EQ(stream.size(), 1 + kHeaderBytes + 8 + kCrcBytes);
  EXPECT_EQ(unpack(&stream[1])->length, 8);
  const std::uint8_t filled[8] = {1, 2, 3, 4, 5, 0, 0, 0};
  for (int i = 0; i < 8; ++i) EXPECT_EQ(stream[1 + kHeaderBytes + i], filled[i]);
  EXPECT_EQ(get_u32(&stream[1 + kHeaderBytes + 8]), crc32c(&stream[1 + 32], 4 + 8));
}

TEST(Packet, RefusesAPayloadThatIsTooLong) {
  const std::vector<std::uint8_t> payload(kMaxPayloadBytes + 1);
  std::vector<std::uint8_t> stream;
  EXPECT_NO_THROW(append_packet(Header{}, payload.data(), kMaxPayloadBytes, stream));
  try {
    append_packet(Header{}, payload.data(), payload.size(), stream);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "payload has 8193 bytes; allowed are up to 8192");
  }
}

}  // namespace
}  // namespace fpga_stereo::link
