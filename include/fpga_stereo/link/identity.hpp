// Who answers at the other end, and whether this software can work with it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "fpga_stereo/core/gateware_configuration.hpp"
#include "fpga_stereo/core/result.hpp"
#include "fpga_stereo/core/spec.hpp"
#include "fpga_stereo/link/streams.hpp"

namespace fpga_stereo::link {

struct Identity {
  std::uint32_t identity = 0, spec_hash = 0;
  int major = 0, minor = 0;  // of protocol and gateware
  GatewareBuild build;
  StreamSet streams;           // that the board can send, or take from the host
  std::uint32_t clock_hz = 0;  // of the pixels

  /// The registers that tell, in the order that from_values() takes.
  static std::vector<std::uint32_t> registers();
  static Identity from_values(const std::vector<RegisterWrite>& values);

  /// kIncompatible where this software cannot work with it; the message says what to flash.
  Status check() const;
  bool supports(Stream stream) const { return streams.contains(stream); }

  /// For people: "gateware 0.1, 640 px wide, 64 disparities, sparse census 11, ...".
  std::string text() const;
};

/// The board speaks another version of the packets: what to do, for people.
std::string version_text(int version);

}  // namespace fpga_stereo::link
