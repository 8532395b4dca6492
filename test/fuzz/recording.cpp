// libFuzzer target for recordings of a link: the player, and the transport. The first byte selects
// whether the rest is a file, or the contents of records and of packets with right CRCs.
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <string>

#include "fpga_stereo/link/recording_player.hpp"
#include "fuzz/budget.hpp"
#include "link/packet.hpp"
#include "link/recording_file.hpp"

namespace {

namespace link = fpga_stereo::link;
using fpga_stereo::test::Bytes;
using fpga_stereo::test::require;

/// Makes records from the input: 4 bytes for time, direction, type and stream, 4 for index, size,
/// frame_id and configuration; then the payload of a packet.
Bytes records(const std::uint8_t* data, std::size_t size) {
  Bytes file = fpga_stereo::test::recording_header();
  std::uint64_t time = 0;
  while (size >= 8) {
    time += data[0];
    const std::uint8_t kinds[]{0x01, 0x02, 0x03, 0x10, 0x11, 0x12, 0x81, 0x82};
    link::Header header;
    header.type = static_cast<link::PacketType>(kinds[data[2] % 8]);
    header.stream = static_cast<link::Stream>(data[3] % 8);
    header.index = data[4];
    header.frame_id = data[6];
    const std::size_t length = std::min<std::size_t>(size - 8, data[5] * 4U);
    Bytes packet;
    link::append_packet(header, data + 8, length, packet);
    fpga_stereo::test::append_record(file, time, data[1] % 2, packet);
    data += 8 + length;
    size -= 8 + length;
  }
  return file;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 1) return 0;
  const Bytes file = data[0] % 2 == 0 ? Bytes(data + 1, data + size) : records(data + 1, size - 1);
  static const int fd = memfd_create("recording", 0);
  require(ftruncate(fd, 0) == 0 &&
              pwrite(fd, file.data(), file.size(), 0) == static_cast<ssize_t>(file.size()),
          "the file is written");
  const std::string path = "/proc/self/fd/" + std::to_string(fd);
  const fpga_stereo::test::Budget budget(file.size());
  auto player = link::RecordingPlayer::open("replay:" + path + ":0");
  if (!player) return 0;
  std::size_t packets = 0;
  while (true) {
    const auto frames = (*player)->take(std::chrono::milliseconds(0));
    if (!frames) break;
    for (const auto& each : *frames) {
      packets += 1;
      for (const std::string& text : each.set.dropped) require(!text.empty(), "a loss has a text");
      if (each.configuration) (void)each.configuration->parameters();
    }
  }
  require(packets <= file.size(), "frames come from packets");
  return 0;
}
