// Makes recordings of a link, byte by byte.
#pragma once

#include <cstdint>

#include "link/faults.hpp"
#include "link/packet.hpp"
#include "link/recording.hpp"

namespace fpga_stereo::test {

inline Bytes recording_header() {
  Bytes bytes(link::kRecordingMagic, link::kRecordingMagic + 8);
  bytes.resize(link::kRecordingHeaderBytes);
  link::put_u32(bytes.data() + 8, 1);
  return bytes;
}

/// `direction`: 0 from the board, 1 from the host.
inline void append_record(Bytes& file, std::uint64_t time, std::uint8_t direction,
                          const Bytes& bytes) {
  const std::size_t at = file.size();
  file.resize(at + link::kRecordHeaderBytes);
  link::put_u64(file.data() + at, time);
  link::put_u32(file.data() + at + 8, static_cast<std::uint32_t>(bytes.size()));
  file[at + 12] = direction;
  file.insert(file.end(), bytes.begin(), bytes.end());
}

}  // namespace fpga_stereo::test
