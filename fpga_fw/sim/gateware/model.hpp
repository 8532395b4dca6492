// The interface of a model: the simulated gateware as a shared object. build_model makes one object
// for each set of build parameters, of fs_top from model.cpp or of fs_system from model_system.cpp;
// LoadedModel loads it.
#pragma once

#include <cstdint>

namespace fpga_stereo::sim {

/// Increases with every change of the interface: a model of another version is not loaded.
constexpr std::uint32_t kModelVersion = 2;

/// Build parameters.
struct ModelParameters {
  std::int32_t max_width, disparities, census_window, correlation_window, census_full;
  std::int32_t line_rows, mesh_nodes;
  std::int32_t trace;                         // 1: built with --trace
  std::int32_t clock_hz, streams, ring_rows;  // fs_system only; else 0
};

/// The functions of a model, given the ports of its module.
template <class PortInputs, class PortOutputs>
struct Interface {
  using Inputs = PortInputs;
  using Outputs = PortOutputs;
  std::uint32_t version;  // kModelVersion
  ModelParameters parameters;
  /// Creates an instance whose registers and memories hold random values from `seed`. Returns null
  /// if the gateware refuses its build parameters; error() then returns the reason.
  void* (*create)(std::uint32_t seed);
  const char* (*error)();
  void (*destroy)(void* model);
  /// Simulates one clock. The outputs are those before its rising edge.
  void (*clock)(void* model, const Inputs* inputs, Outputs* outputs);
  /// Writes all signals from now on to a VCD file. Returns 0 on failure.
  int (*open_trace)(void* model, const char* path);
  void (*close_trace)(void* model);
};

/// The ports of fs_top.sv, without _i and _o.
struct ModelInputs {
  std::uint8_t rst_n = 1;
  std::uint8_t write = 0, read = 0, address = 0;
  std::uint32_t data = 0;
  std::uint8_t valid = 0, sof = 0, eol = 0, left = 0, right = 0;  // raw pixels
  std::uint8_t ready = 0;                                         // the receiver takes disparities
};

struct ModelOutputs {
  std::uint8_t read_valid;
  std::uint32_t data;
  std::uint8_t ready;                      // the gateware takes raw pixels
  std::uint8_t valid, sof, eol, eof, bad;  // disparities
  std::uint16_t disparity;
};

using ModelInterface = Interface<ModelInputs, ModelOutputs>;
constexpr const char* kModelSymbol = "fs_top_model";  // a function that returns the interface

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
  std::uint8_t ready;  // the gateware takes pixels of the cameras
};

using SystemInterface = Interface<SystemInputs, SystemOutputs>;
constexpr const char* kSystemSymbol = "fs_system_model";

}  // namespace fpga_stereo::sim
