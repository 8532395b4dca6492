#include "sim/gateware/system.hpp"

#include <algorithm>

namespace fpga_stereo::sim {
namespace {

constexpr std::size_t kReadBytes = 4096;  // enough for a read of the host

}  // namespace

Result<SystemModel> SystemModel::open(const std::string& path, std::uint32_t seed) {
  auto loaded = LoadedModel<SystemInterface>::open(path, kSystemSymbol, seed);
  if (!loaded) return loaded.error();
  SystemModel system(std::move(*loaded));
  system.reset();
  return system;
}

GatewareBuild SystemModel::build() const {
  const ModelParameters& p = parameters();
  GatewareBuild build;
  build.max_width = p.max_width;
  build.disparities = p.disparities;
  build.census_window = p.census_window;
  build.correlation_window = p.correlation_window;
  build.census_pattern = p.census_full != 0 ? CensusPattern::kFull : CensusPattern::kSparse;
  build.line_rows = p.line_rows;
  build.mesh_nodes = p.mesh_nodes;
  return build;
}

void SystemModel::set_flow(const Flow& flow) {
  rx_chance_ = Chance(flow.rx, flow.seed);
  tx_chance_ = Chance(flow.tx, flow.seed + 1);
  camera_chance_ = Chance(flow.camera, flow.seed + 2);
  buffer_bytes_ = flow.buffer_bytes;
}

void SystemModel::reset(int num_clocks) {
  SystemInputs in;
  in.rst_n = 0;
  for (int i = 0; i < num_clocks; ++i, ++clocks_) model_.clock(in);
  rx_.clear();
  tx_.clear();
  camera_.clear();
  is_rx_offered_ = is_camera_offered_ = false;
}

void SystemModel::receive(const std::uint8_t* bytes, std::size_t size) {
  rx_.insert(rx_.end(), bytes, bytes + size);
}

std::size_t SystemModel::transmit(std::uint8_t* bytes, std::size_t size) {
  const auto count = static_cast<std::ptrdiff_t>(std::min(size, tx_.size()));
  std::copy_n(tx_.begin(), count, bytes);
  tx_.erase(tx_.begin(), tx_.begin() + count);
  return static_cast<std::size_t>(count);
}

void SystemModel::feed(const std::vector<Pixel>& words) {
  camera_.insert(camera_.end(), words.begin(), words.end());
}

std::int64_t SystemModel::microseconds() const {
  constexpr double kPerSecond = 1e6;
  return static_cast<std::int64_t>(static_cast<double>(clocks_) * kPerSecond /
                                   parameters().clock_hz);
}

bool SystemModel::clock() {
  SystemInputs in;
  is_rx_offered_ = is_rx_offered_ || (!rx_.empty() && rx_chance_());
  if (is_rx_offered_) {
    in.rx_valid = 1;
    in.rx_data = rx_.front();
  }
  in.tx_ready = tx_.size() < buffer_bytes_ && tx_chance_() ? 1 : 0;
  is_camera_offered_ = is_camera_offered_ || (!camera_.empty() && camera_chance_());
  if (is_camera_offered_) {
    const Pixel& pixel = camera_.front();
    in.valid = 1;
    in.sof = pixel.sof ? 1 : 0;
    in.eol = pixel.eol ? 1 : 0;
    in.left = pixel.left;
    in.right = pixel.right;
  }
  const SystemOutputs out = model_.clock(in);
  ++clocks_;
  if (is_rx_offered_ && out.rx_ready != 0) {
    rx_.pop_front();
    is_rx_offered_ = false;
  }
  if (is_camera_offered_ && out.ready != 0) {
    camera_.pop_front();
    is_camera_offered_ = false;
  }
  if (out.tx_valid == 0 || in.tx_ready == 0) return false;
  for (int byte = 0; byte < 4; ++byte) {
    tx_.push_back(static_cast<std::uint8_t>(out.tx_data >> (8 * byte)));
  }
  return true;
}

bool SystemModel::run(std::int64_t max_clocks) {
  bool has_left = false;
  for (std::int64_t i = 0; i < max_clocks; ++i) {
    const bool leaves = clock();
    if (has_left && (!leaves || tx_.size() >= kReadBytes)) break;
    has_left = has_left || leaves;
  }
  return !tx_.empty();
}

}  // namespace fpga_stereo::sim
