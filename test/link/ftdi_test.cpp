#include "link/ftdi.hpp"

#include <gtest/gtest.h>

#include "link/faults.hpp"

namespace fpga_stereo::test {
namespace {

/// Strips the status bytes one by one, unlike the code under test.
Bytes payload_of(const Bytes& transfer, std::size_t packet) {
  Bytes payload;
  for (std::size_t i = 0; i < transfer.size(); ++i) {
    if (i % packet >= 2) payload.push_back(transfer[i]);
  }
  return payload;
}

TEST(Ftdi, StripsStatusOfTransfersOfAllSizes) {
  for (const std::size_t packet : {64, 512}) {
    for (std::size_t size = 0; size <= 3 * packet + 3; ++size) {
      Bytes transfer(size);
      for (std::size_t i = 0; i < size; ++i)
        transfer[i] = static_cast<std::uint8_t>(i * 7 + i / 256);
      // Only status bytes may set the overrun bit.
      for (std::size_t i = 1; i < size; i += packet) transfer[i] = 0x60;
      const Bytes expected = payload_of(transfer, packet);
      const auto stripped = link::strip_status(transfer.data(), size, packet);
      ASSERT_EQ(stripped.size, expected.size()) << size;
      ASSERT_EQ(stripped.overruns, 0U) << size;
      transfer.resize(stripped.size);
      ASSERT_EQ(transfer, expected) << size;
    }
  }
}

TEST(Ftdi, CountsOverruns) {
  Bytes transfer(512 * 3 + 2, 0xFF);
  for (std::size_t i = 1; i < transfer.size(); i += 512) transfer[i] = 0x60;
  transfer[513] = 0x62;
  transfer[3 * 512 + 1] = 0x02;  // a packet without payload
  EXPECT_EQ(link::strip_status(transfer.data(), transfer.size(), 512).overruns, 2U);
}

TEST(Ftdi, ChecksTheModeInTheEeprom) {
  EXPECT_TRUE(link::check_fifo_mode(0x0001, "it"));
  EXPECT_TRUE(link::check_fifo_mode(0x0811, "it"));  // with its driver and other bits
  for (const int word : {0x0000, 0x0002, 0x0004, 0x0008, 0x0810, 0xFFFF}) {
    const Status status = link::check_fifo_mode(static_cast<std::uint16_t>(word), "the board");
    ASSERT_FALSE(status) << word;
    EXPECT_EQ(status.error().kind, ErrorKind::kIo);
    EXPECT_EQ(status.error().message.find("the board "), 0U);
    EXPECT_NE(status.error().message.find("ftdi_eeprom"), std::string::npos);
  }
}

}  // namespace
}  // namespace fpga_stereo::test
