// One simulated gateware: fs_top as Verilator translated it, behind the interface of model.hpp.
// Compiled by build_model, with the parameters of the build as macros.
#include "model.hpp"

#include <verilated.h>

#include <cstdarg>
#include <cstdio>
#include <memory>
#include <string>

#include "Vfs_top.h"
#if FS_TRACE
#include <verilated_vcd_c.h>
#endif

namespace fpga_stereo::sim {
namespace {

std::string printed;  // since the last create()

struct Model {
  explicit Model(std::uint32_t seed) {
    context.fatalOnError(false);  // $fatal shall not end the program
    context.randReset(2);
    context.randSeed(static_cast<int>(seed));
#if FS_TRACE
    context.traceEverOn(true);
#endif
    top = std::make_unique<Vfs_top>(&context, "fs_top");
    top->clk_i = 0;
    top->rst_ni = 0;
    top->eval();
  }
  ~Model() {
    close_trace();
    top->final();
  }

  void edge(int clk) {
    top->clk_i = clk;
    top->eval();
#if FS_TRACE
    if (vcd) vcd->dump(context.time());
#endif
    context.timeInc(kHalfPeriod);
  }

  void close_trace() {
#if FS_TRACE
    vcd.reset();
#endif
  }

  static constexpr std::uint64_t kHalfPeriod = 4;  // ns, as VCD says

  VerilatedContext context;
  std::unique_ptr<Vfs_top> top;
#if FS_TRACE
  std::unique_ptr<VerilatedVcdC> vcd;
#endif
};

Model& of(void* model) { return *static_cast<Model*>(model); }

void* create(std::uint32_t seed) {
  printed.clear();
  auto model = std::make_unique<Model>(seed);
  return model->context.gotError() ? nullptr : model.release();
}

void destroy(void* model) { delete &of(model); }

void clock(void* model, const ModelInputs* in, ModelOutputs* out) {
  Vfs_top& top = *of(model).top;
  top.rst_ni = in->rst_n;
  top.write_i = in->write;
  top.read_i = in->read;
  top.address_i = in->address;
  top.data_i = in->data;
  top.valid_i = in->valid;
  top.sof_i = in->sof;
  top.eol_i = in->eol;
  top.left_i = in->left;
  top.right_i = in->right;
  top.ready_i = in->ready;
  of(model).edge(0);
  out->read_valid = top.read_valid_o;
  out->data = top.data_o;
  out->ready = top.ready_o;
  out->valid = top.valid_o;
  out->sof = top.sof_o;
  out->eol = top.eol_o;
  out->eof = top.eof_o;
  out->bad = top.bad_o;
  out->disparity = top.disparity_o;
  of(model).edge(1);
}

int open_trace(void* model, const char* path) {
#if FS_TRACE
  constexpr int kAllLevels = 99;
  of(model).vcd = std::make_unique<VerilatedVcdC>();
  of(model).top->trace(of(model).vcd.get(), kAllLevels);
  of(model).vcd->open(path);
  return of(model).vcd->isOpen() ? 1 : 0;
#else
  (void)model, (void)path;
  return 0;
#endif
}

void close_trace(void* model) { of(model).close_trace(); }

const ModelInterface interface {
  kModelVersion, {FS_MAX_WIDTH,   FS_DISPARITIES, FS_CENSUS_WINDOW, FS_CORRELATION_WINDOW,
                  FS_CENSUS_FULL, FS_LINE_ROWS,   FS_MESH_NODES,    FS_TRACE},
      create, [] { return printed.c_str(); }, destroy, clock, open_trace, close_trace
};

}  // namespace
}  // namespace fpga_stereo::sim

int fs_top_print(const char* format, ...) {
  char text[1024];
  std::va_list arguments;
  va_start(arguments, format);
  const int length = std::vsnprintf(text, sizeof(text), format, arguments);
  va_end(arguments);
  fpga_stereo::sim::printed += text;
  return length;
}

double sc_time_stamp() { return 0; }

/// FS_SOURCES is what build_model knows an object by that need not be built again.
extern "C" __attribute__((visibility("default"), used)) const char fs_top_sources[] = FS_SOURCES;

extern "C" __attribute__((visibility("default"))) const fpga_stereo::sim::ModelInterface*
fs_top_model() {
  return &fpga_stereo::sim::interface;
}
