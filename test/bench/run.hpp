// What the programs of Google Benchmark share.
#pragma once

#include <benchmark/benchmark.h>

#include "fpga_stereo/core/target.hpp"

namespace fpga_stereo::bench {

/// Runs what is registered, as the command line says; the exit status.
inline int run(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::AddCustomContext("target", target());
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}

}  // namespace fpga_stereo::bench
