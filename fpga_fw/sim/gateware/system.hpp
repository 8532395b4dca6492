// A simulated board, clock by clock, as its host and its cameras see the real one: bytes both ways,
// and pixels (fpga_fw/rtl/link/fs_system.sv).
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

class SystemModel {
 public:
  /// How fast the line and the cameras are.
  struct Flow {
    double rx = 1;      // share of the clocks in which a byte of the host comes, if there is one
    double tx = 1;      // share of the clocks in which the line takes a word (4 bytes)
    double camera = 1;  // share of the clocks in which a pixel comes, if there is one
    unsigned seed = 1;
    /// Bytes that may wait to be taken by to_host(); then the line takes none.
    std::size_t buffer_bytes = std::size_t{1} << 16;
  };

  /// Loads what build_model made of ten numbers, and resets it. Registers and memories start with
  /// random values of `seed`. Refuses a file that is no such model.
  static Result<SystemModel> open(const std::string& model, std::uint32_t seed = 1);

  /// What it was made with. Hosts ask its registers.
  const ModelParameters& parameters() const { return model_.parameters(); }
  GatewareBuild build() const;

  void set_flow(const Flow& flow);
  void reset(int num_clocks = 4);

  /// Bytes that the host sends; they go in as the clock runs.
  void receive(const std::uint8_t* bytes, std::size_t size);
  /// Takes bytes that the board has sent: how many, 0 to `size`.
  std::size_t transmit(std::uint8_t* bytes, std::size_t size);

  /// A pair of images that the cameras see; its pixels come behind those fed before.
  void feed(const GreyPair& pair) { feed(pixels({pair})); }
  void feed(const std::vector<Pixel>& words);

  /// Lets the clock run, `max_clocks` at most, up to the first pause behind something that has left
  /// the board, or until a good portion has. True if there is something for to_host().
  bool run(std::int64_t max_clocks);

  /// Nothing that was fed or sent by the host is left.
  bool idle() const { return rx_.empty() && camera_.empty(); }
  /// Bytes of the host that have not gone in.
  std::size_t bytes_left() const { return rx_.size(); }
  /// Pixels of the cameras that have not gone in.
  std::size_t pixels_left() const { return camera_.size(); }
  std::int64_t clocks() const { return clocks_; }
  /// Of simulated time, us, as the board's clock runs.
  std::int64_t microseconds() const;

  /// Every signal from now on, as VCD; for models built with --trace.
  Status open_trace(const std::string& path) { return model_.open_trace(path); }
  void close_trace() { model_.close_trace(); }

 private:
  explicit SystemModel(LoadedModel<SystemInterface> model) : model_(std::move(model)) {}
  bool clock();

  LoadedModel<SystemInterface> model_;
  std::int64_t clocks_ = 0;
  std::size_t buffer_bytes_ = Flow{}.buffer_bytes;
  Chance rx_comes_{1, 1}, tx_takes_{1, 1}, camera_comes_{1, 1};
  std::deque<std::uint8_t> rx_, tx_;
  std::deque<Pixel> camera_;
  bool rx_offered_ = false, camera_offered_ = false;  // and not yet taken: they must stay
};

}  // namespace fpga_stereo::sim
