// Exports fs_system, translated by Verilator, through the interface of model.hpp.
#include "Vfs_system.h"
#include "model_base.hpp"

namespace fpga_stereo::sim {
namespace {

struct Ports {
  static void set(const SystemInputs& in, Vfs_system& top) {
    top.rx_valid_i = in.rx_valid;
    top.rx_data_i = in.rx_data;
    top.tx_ready_i = in.tx_ready;
    top.valid_i = in.valid;
    top.sof_i = in.sof;
    top.eol_i = in.eol;
    top.left_i = in.left;
    top.right_i = in.right;
  }
  static void get(const Vfs_system& top, SystemOutputs& out) {
    out.rx_ready = top.rx_ready_o;
    out.tx_valid = top.tx_valid_o;
    out.tx_data = top.tx_data_o;
    out.ready = top.ready_o;
  }
};

}  // namespace
}  // namespace fpga_stereo::sim

extern "C" __attribute__((visibility("default"))) const fpga_stereo::sim::SystemInterface*
fs_system_model() {
  using namespace fpga_stereo::sim;
  return &Exported<Vfs_system, Ports, SystemInterface>::kInterface;
}
