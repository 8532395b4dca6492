// Exports fs_top, translated by Verilator, through the interface of model.hpp.
#include "Vfs_top.h"
#include "model_base.hpp"

namespace fpga_stereo::sim {
namespace {

struct Ports {
  static void set(const ModelInputs& in, Vfs_top& top) {
    top.room_i = top.bubble_room_i = 1;  // no link limits it
    top.write_i = in.write;
    top.read_i = in.read;
    top.address_i = in.address;
    top.data_i = in.data;
    top.valid_i = in.valid;
    top.sof_i = in.sof;
    top.eol_i = in.eol;
    top.left_i = in.left;
    top.right_i = in.right;
    top.ready_i = in.ready;
  }
  static void get(const Vfs_top& top, ModelOutputs& out) {
    out.read_valid = top.read_valid_o;
    out.data = top.data_o;
    out.ready = top.ready_o;
    out.valid = top.valid_o;
    out.sof = top.sof_o;
    out.eol = top.eol_o;
    out.eof = top.eof_o;
    out.bad = top.bad_o;
    out.disparity = top.disparity_o;
  }
};

}  // namespace
}  // namespace fpga_stereo::sim

extern "C" __attribute__((visibility("default"))) const fpga_stereo::sim::ModelInterface*
fs_top_model() {
  using namespace fpga_stereo::sim;
  return &Exported<Vfs_top, Ports, ModelInterface>::kInterface;
}
