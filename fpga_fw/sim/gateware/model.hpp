// The simulated gateware as a shared object: what model.cpp and model_system.cpp export, and
// Library loads. build_model makes one such object for each set of parameters of fs_top, or of
// fs_system.
#pragma once

#include <cstdint>

namespace fpga_stereo::sim {

/// Counts changes of this file: an object of another number is not loaded.
constexpr std::uint32_t kModelVersion = 2;

/// What the object was built with.
struct ModelParameters {
  std::int32_t max_width, disparities, census_window, correlation_window, census_full;
  std::int32_t line_rows, mesh_nodes;
  std::int32_t trace;                         // 1: open_trace works
  std::int32_t clock_hz, streams, ring_rows;  // of fs_system; else 0
};

/// What a module can be asked for, given its ports in one clock.
template <class PortInputs, class PortOutputs>
struct Interface {
  using Inputs = PortInputs;
  using Outputs = PortOutputs;
  std::uint32_t version;  // kModelVersion
  ModelParameters parameters;
  /// A gateware whose registers and memories hold random values of this seed. None where the
  /// gateware refuses its parameters: error() then says why.
  void* (*create)(std::uint32_t seed);
  const char* (*error)();
  void (*destroy)(void* model);
  /// One clock. The outputs are those that stand in it, before its rising edge.
  void (*clock)(void* model, const Inputs* inputs, Outputs* outputs);
  /// Every signal of the clocks to come, as VCD. 0 where that cannot be written.
  int (*open_trace)(void* model, const char* path);
  void (*close_trace)(void* model);
};

/// The ports of fs_top.sv, without _i and _o.
struct ModelInputs {
  std::uint8_t rst_n = 1;
  std::uint8_t write = 0, read = 0, address = 0;
  std::uint32_t data = 0;
  std::uint8_t valid = 0, sof = 0, eol = 0, left = 0, right = 0;  // raw pixels
  std::uint8_t ready = 0;                                         // for disparities
};

struct ModelOutputs {
  std::uint8_t read_valid;
  std::uint32_t data;
  std::uint8_t ready;                      // for raw pixels
  std::uint8_t valid, sof, eol, eof, bad;  // disparities
  std::uint16_t disparity;
};

using ModelInterface = Interface<ModelInputs, ModelOutputs>;
constexpr const char* kModelSymbol = "fs_top_model";  // a function that gives the interface

/// The ports of fs_system.sv, without _i and _o.
struct SystemInputs {
  std::uint8_t rst_n = 1;
  std::uint8_t rx_valid = 0, rx_data = 0;                         // from the host
  std::uint8_t tx_ready = 0;                                      // to the host
  std::uint8_t valid = 0, sof = 0, eol = 0, left = 0, right = 0;  // pixels of the cameras
};

struct SystemOutputs {
  std::uint8_t rx_ready;
  std::uint8_t tx_valid;
  std::uint32_t tx_data;
  std::uint8_t ready;  // for pixels of the cameras
};

using SystemInterface = Interface<SystemInputs, SystemOutputs>;
constexpr const char* kSystemSymbol = "fs_system_model";

}  // namespace fpga_stereo::sim
