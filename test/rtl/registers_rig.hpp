// Drives fs_registers over its register bus and reads the settings that it puts out.
#pragma once

#include <cstdint>
#include <vector>

#include "fpga_stereo/core/spec.hpp"
#include "rtl/configuration.hpp"
#include "rtl/register_bus.hpp"

namespace fpga_stereo::test {

/// A model of fs_registers with idle inputs.
template <class Model>
class RegistersRig {
 public:
  Model model;

  RegistersRig() {
    model.write_i = model.read_i = model.apply_i = model.busy_i = 0;
    model.frame_in_i = model.frame_out_i = model.cut_frame_i = model.long_frame_i = 0;
    model.buffer_left_i = model.buffer_right_i = model.buffer_frame_i = 0;
    for (int i = 0; i < kNumGatewareStages; ++i) model.signatures_i[i] = 0;
    reset();
  }
  void reset() {
    model.rst_ni = 0;
    clock();
    model.rst_ni = 1;
  }
  void clock(int n = 1) {
    for (int i = 0; i < n; ++i) {
      model.clk_i = 0;
      model.eval();
      model.clk_i = 1;
      model.eval();
    }
  }
  void write(std::uint32_t address, std::uint32_t data) {
    write_register(
        model, [this] { clock(); }, address, data);
  }
  std::uint32_t read(std::uint32_t address) {
    return read_register(
        model, [this] { clock(); }, address);
  }
  /// Writes CONTROL.apply.
  void apply() { write(spec::kRegControl, spec::kControlApply.put(1)); }
  /// Pulses apply_i, as fs_input does when it accepts CONTROL.apply.
  void accept_apply() {
    model.apply_i = 1;
    clock();
    model.apply_i = 0;
  }
  std::uint32_t status() { return read(spec::kRegStatus); }
  bool is_pending() { return spec::kStatusPending.get(status()) != 0; }

  /// Returns the settings that the stages see.
  std::vector<std::uint32_t> active_settings() {
    return settings([this](std::uint32_t address) { return active(address); });
  }
  /// Returns the word of a register in the configuration in effect.
  std::uint32_t active(std::uint32_t address) { return model.config_o[config_word(address)]; }
  /// Returns the same settings as the registers hold them.
  std::vector<std::uint32_t> register_settings() {
    return settings([this](std::uint32_t address) { return read(address); });
  }

 private:
  template <class Word>
  static std::vector<std::uint32_t> settings(const Word& word) {
    const std::uint32_t start = word(spec::kRegReadStart), flags = word(spec::kRegFlags);
    return {spec::kWidthPixels.get(word(spec::kRegWidth)),
            spec::kHeightRows.get(word(spec::kRegHeight)),
            spec::kReadStartPixels.get(start),
            spec::kReadStartRows.get(start),
            spec::kFlagsLeftRightCheck.get(flags),
            spec::kFlagsUniquenessCheck.get(flags),
            spec::kFlagsSubpixel.get(flags),
            spec::kDisp12MaxDiffPixels.get(word(spec::kRegDisp12MaxDiff)),
            spec::kUniquenessFactor.get(word(spec::kRegUniqueness)),
            spec::kSpeckleSizePixels.get(word(spec::kRegSpeckleSize)),
            spec::kSpeckleRangeUnits.get(word(spec::kRegSpeckleRange))};
  }
};

}  // namespace fpga_stereo::test
