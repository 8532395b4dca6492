// What a user wants a board to do.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>

#include "fpga_stereo/core/gateware_configuration.hpp"
#include "fpga_stereo/link/streams.hpp"

namespace fpga_stereo::link {

struct DesiredState {
  /// Must be made for the build of the identified board; until it is, no frames come. Shared: the
  /// session keeps the pointer and never copies registers or meshes.
  std::shared_ptr<const GatewareConfiguration> configuration;
  /// Leaves the board's configuration alone and accepts frames made by any; `configuration` is
  /// ignored.
  bool keep_configuration = false;
  /// Configuration tag, chosen by the user. Returned with every frame set that this configuration
  /// made.
  std::uint64_t tag = 0;
  StreamSet streams;                          // that the board sends
  int frame_interval = 1;                     // the board sends every n-th pair
  int raw_interval = 1;                       // raw images accompany every n-th pair that is sent
  bool host_input = false;                    // the pairs come from the host, not from cameras
  std::chrono::microseconds mid_exposure{0};  // from mid-exposure to the first pixel
};

}  // namespace fpga_stereo::link
