// What a board says about itself, and whether this software works with it.
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
  int major = 0, minor = 0;  // version of protocol and gateware
  GatewareBuild build;
  StreamSet streams;           // that the board can send, or take from the host
  std::uint32_t clock_hz = 0;  // pixel clock

  /// Returns the addresses of the registers that identify a board.
  static std::vector<std::uint32_t> registers();
  /// Builds an identity from those registers; missing ones count as 0.
  static Identity from_values(const std::vector<RegisterWrite>& values);

  /// Fails with kIncompatible if this software does not work with the board; the message says what
  /// to flash.
  Status check() const;
  bool supports(Stream stream) const { return streams.contains(stream); }

  /// Returns a text for people: "gateware 0.1, 640 px wide, 64 disparities, sparse census 11, ...".
  std::string text() const;
};

/// Returns a message for people about a board whose packets have another version.
std::string version_text(int version);

}  // namespace fpga_stereo::link
