// The simulated gateware with its end of the link (fpga_fw/rtl/link/fs_system.sv), clock by clock:
// bytes in both directions, and pixels from the cameras.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <utility>
#include <vector>

#include "fpga_stereo/core/gateware_configuration.hpp"
#include "fpga_stereo/core/result.hpp"
#include "sim/gateware/chance.hpp"
#include "sim/gateware/gateware.hpp"
#include "sim/gateware/library.hpp"

namespace fpga_stereo::sim {

/// Not thread-safe.
class SystemModel {
 public:
  /// The speed of the line and the cameras.
  struct Flow {
    double rx = 1;      // fraction of the clocks in which the next byte from the host comes
    double tx = 1;      // fraction of the clocks in which the line takes a word (4 bytes)
    double camera = 1;  // fraction of the clocks in which the next pixel comes
    unsigned seed = 1;
    /// Capacity of the line's buffer to the host. While it is full, the line takes no words.
    std::size_t buffer_bytes = std::size_t{1} << 16;
  };

  /// Loads a model of fs_system and resets it. Registers and memories start with random values from
  /// `seed`. Refuses a file that is not such a model.
  static Result<SystemModel> open(const std::string& model, std::uint32_t seed = 1);

  /// Build parameters, from the model: hosts read them from registers.
  const ModelParameters& parameters() const { return model_.parameters(); }
  GatewareBuild build() const;

  void set_flow(const Flow& flow);
  void reset(int num_clocks = 4);

  /// Queues bytes from the host; they enter as the clock runs.
  void receive(const std::uint8_t* bytes, std::size_t size);
  /// Writes up to `size` bytes that the board has sent to `bytes`. Returns how many it wrote.
  std::size_t transmit(std::uint8_t* bytes, std::size_t size);

  /// Queues the pixels of a camera pair; they enter as the clock runs.
  void feed(const GreyPair& pair) { feed(to_pixels({pair})); }
  void feed(const std::vector<Pixel>& words);

  /// Runs the clock until the board pauses after having sent something, has sent enough for a read,
  /// or `max_clocks` have passed. Returns whether there are bytes to transmit().
  bool run(std::int64_t max_clocks);

  /// Returns whether all bytes of the host and all pixels have entered.
  bool is_idle() const { return rx_.empty() && camera_.empty(); }
  /// Returns the number of bytes from the host that have not entered yet.
  std::size_t bytes_left() const { return rx_.size(); }
  /// Returns the number of camera pixels that have not entered yet.
  std::size_t pixels_left() const { return camera_.size(); }
  /// Returns the number of clocks since construction.
  std::int64_t clocks() const { return clocks_; }
  /// Returns the simulated time, us.
  std::int64_t microseconds() const;

  /// Writes all signals from now on to a VCD file. Works only for models built with --trace.
  Status open_trace(const std::string& path) { return model_.open_trace(path); }
  void close_trace() { model_.close_trace(); }

 private:
  explicit SystemModel(LoadedModel<SystemInterface> model) : model_(std::move(model)) {}
  /// Simulates one clock. Returns whether a word left.
  bool clock();

  LoadedModel<SystemInterface> model_;
  std::int64_t clocks_ = 0;
  std::size_t buffer_bytes_ = Flow{}.buffer_bytes;
  Chance rx_chance_{1, 1}, tx_chance_{1, 1}, camera_chance_{1, 1};
  std::deque<std::uint8_t> rx_, tx_;
  std::deque<Pixel> camera_;
  bool is_rx_offered_ = false, is_camera_offered_ = false;  // stay set until taken
};

}  // namespace fpga_stereo::sim
