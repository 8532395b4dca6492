// Shared by the programs of Google Benchmark.
#pragma once

#include <benchmark/benchmark.h>

#include "fpga_stereo/core/target.hpp"

namespace fpga_stereo::bench {

/// Runs the registered benchmarks as the command line says. Returns the exit status.
inline int run(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::AddCustomContext("target", target());
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}

}  // namespace fpga_stereo::bench
