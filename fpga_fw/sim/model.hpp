// The simulated gateware as a shared object: what model.cpp exports and gateware.cpp loads.
// build_model makes one such object for each set of parameters of fs_top.
#pragma once

#include <cstdint>

namespace fpga_stereo::sim {

/// Counts changes of this file: an object of another number is not loaded.
constexpr std::uint32_t kModelVersion = 1;
constexpr const char* kModelSymbol = "fs_top_model";

/// The ports of fs_top.sv in one clock, without _i and _o.
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

/// What the object was built with.
struct ModelParameters {
  std::int32_t max_width, disparities, census_window, correlation_window, census_full;
  std::int32_t line_rows, mesh_nodes;
  std::int32_t trace;  // 1: open_trace works
};

struct ModelInterface {
  std::uint32_t version;  // kModelVersion
  ModelParameters parameters;
  /// A gateware whose registers and memories hold random values of this seed. None where the
  /// gateware refuses its parameters: error() then says why.
  void* (*create)(std::uint32_t seed);
  const char* (*error)();
  void (*destroy)(void* model);
  /// One clock. The outputs are those that stand in it, before its rising edge.
  void (*clock)(void* model, const ModelInputs* inputs, ModelOutputs* outputs);
  /// Every signal of the clocks to come, as VCD. 0 where that cannot be written.
  int (*open_trace)(void* model, const char* path);
  void (*close_trace)(void* model);
};

}  // namespace fpga_stereo::sim

/// Type of what kModelSymbol names.
using fs_top_model_function = const fpga_stereo::sim::ModelInterface*();
