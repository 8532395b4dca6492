// The registers and meshes of a virtual board, with the side effects that
// fpga_fw/spec/registers.md defines.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "core/signature.hpp"
#include "fpga_stereo/core/gateware_configuration.hpp"
#include "fpga_stereo/link/streams.hpp"

namespace fpga_stereo::sim {

class BoardRegisters {
 public:
  struct Options {
    GatewareBuild build;
    link::StreamSet streams = link::StreamSet::all();  // of the build
    std::uint32_t clock_hz = 100000000;                // value of BUILD_CLOCK
    /// Fixed values by address, which writes do not change: wrong identity, version or hash, and
    /// defective registers.
    std::map<std::uint32_t, std::uint32_t> overrides;
  };

  /// The configuration in effect.
  struct Active {
    Parameters parameters = window_parameters();
    StereoRectification rectification;
    bool is_buffer_too_small = false;  // the meshes need more rows than the line buffer has
  };

  explicit BoardRegisters(const Options& options) : options_(options) { reset(); }

  /// Returns to the state after power-on. Nothing is configured.
  void reset();

  /// Accesses a register inside the board, without side effects. `address` is below 256.
  std::uint32_t operator[](std::uint32_t address) const { return values_[address]; }
  std::uint32_t& operator[](std::uint32_t address) { return values_[address]; }

  /// Returns what a host reads: 0 for write-only registers and addresses without a register.
  std::uint32_t read(std::uint32_t address) const;
  /// Writes as a host does.
  void write(std::uint32_t address, std::uint32_t value);

  /// While a frame is held in flight, an apply stays pending until it ends.
  void hold_frame(bool is_held);

  const Active& active() const { return active_; }
  /// Returns true from the first write to a mesh until an apply takes effect. Frames are bad then.
  bool is_uploading() const;

 private:
  void write_mesh(std::uint32_t word);
  void write_control(std::uint32_t value);
  void write_value(std::uint32_t address, std::uint32_t value);
  void clear_counters();
  int field(std::uint32_t address, spec::Field field) const;
  bool is_applicable(cv::Size size) const;
  Parameters parameters() const;
  void apply();

  const Options options_;
  std::array<std::uint32_t, 256> values_{};
  std::array<std::vector<std::uint32_t>, 2> mesh_;  // left, right; by node
  Signature mesh_signature_;
  bool is_frame_held_ = false;
  Active active_;
};

}  // namespace fpga_stereo::sim
