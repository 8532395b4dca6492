// Implements the interface of model.hpp for any module, except for its ports. Only build_model
// compiles this file; it passes the build parameters as macros.
#pragma once

#include <verilated.h>

#include <cstdarg>
#include <cstdio>
#include <memory>
#include <string>

#include "model.hpp"
#if FS_TRACE
#include <verilated_vcd_c.h>
#endif

namespace fpga_stereo::sim {

inline std::string printed;  // by the model since the last create()

template <class Top>
struct Model {
  explicit Model(std::uint32_t seed) {
    context.fatalOnError(false);  // $fatal must not end the program
    context.randReset(2);
    context.randSeed(static_cast<int>(seed));
#if FS_TRACE
    context.traceEverOn(true);
#endif
    top = std::make_unique<Top>(&context, "gateware");
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

  static constexpr std::uint64_t kHalfPeriod = 4;  // ns, the unit of the VCD file

  VerilatedContext context;
  std::unique_ptr<Top> top;
#if FS_TRACE
  std::unique_ptr<VerilatedVcdC> vcd;
#endif
};

/// The interface of Top. `Ports` provides set() and get(), which copy between its ports and the
/// Inputs and Outputs of the interface.
template <class Top, class Ports, class Of>
struct Exported {
  using Inputs = typename Of::Inputs;
  using Outputs = typename Of::Outputs;
  static Model<Top>& of(void* model) { return *static_cast<Model<Top>*>(model); }

  static void* create(std::uint32_t seed) {
    printed.clear();
    auto model = std::make_unique<Model<Top>>(seed);
    return model->context.gotError() ? nullptr : model.release();
  }
  static const char* error() { return printed.c_str(); }
  static void destroy(void* model) { delete &of(model); }
  static void clock(void* model, const Inputs* in, Outputs* out) {
    Top& top = *of(model).top;
    top.rst_ni = in->rst_n;
    Ports::set(*in, top);
    of(model).edge(0);
    Ports::get(top, *out);
    of(model).edge(1);
  }
  static int open_trace(void* model, const char* path) {
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
  static void close_trace(void* model) { of(model).close_trace(); }

  static constexpr Of kInterface{
      kModelVersion,
      {FS_MAX_WIDTH, FS_DISPARITIES, FS_CENSUS_WINDOW, FS_CORRELATION_WINDOW, FS_CENSUS_FULL,
       FS_LINE_ROWS, FS_MESH_NODES, FS_TRACE, FS_CLOCK_HZ, FS_STREAMS, FS_RING_ROWS},
      create,
      error,
      destroy,
      clock,
      open_trace,
      close_trace};
};

}  // namespace fpga_stereo::sim
