// Measures our pipeline and OpenCV's block matching side by side. Names are who/what/WxHxD/threads.
// test/bench/README.md explains how to run it.
#include <benchmark/benchmark.h>
#include <malloc.h>

#include <map>
#include <memory>
#include <opencv2/core/utility.hpp>
#include <string>

#include "bench/contenders.hpp"
#include "bench/run.hpp"

namespace fpga_stereo::bench {
namespace {

struct Size {
  int width, height, disparities;
};
constexpr Size kSizes[] = {{640, 480, 64},  {640, 480, 128}, {752, 480, 64},
                           {752, 480, 128}, {1280, 720, 64}, {1280, 720, 128}};

/// More sizes for our pipeline, to show how time and memory grow.
constexpr Size kMoreSizes[] = {{320, 240, 64}, {640, 360, 64},  {640, 360, 256},
                               {640, 480, 32}, {640, 480, 256}, {1280, 960, 64}};

/// Returns the memory that is allocated and not yet freed.
double heap_mib() {
#if __GLIBC_PREREQ(2, 33)
  const auto info = mallinfo2();
#else
  const auto info = mallinfo();
#endif
  return static_cast<double>(info.uordblks + info.hblkhd) / (1 << 20);
}

const Scene& scene_of(cv::Size size) {
  static std::map<std::pair<int, int>, std::unique_ptr<Scene>> scenes;
  auto& scene = scenes[{size.width, size.height}];
  if (!scene) scene = std::make_unique<Scene>(make_scene(size));
  return *scene;
}

void measure(benchmark::State& state, const std::string& name, const Size& size, int threads) {
  cv::setNumThreads(threads);
  const Scene& scene = scene_of({size.width, size.height});
  const double heap_before = heap_mib();
  const Contender contender = make_contender(name, scene, size.disparities, threads);
  StageTimes ms{}, sum{};
  contender(ms);  // allocates memory and touches its pages
  state.counters["MiB"] = heap_mib() - heap_before;
  for (auto _ : state) {
    contender(ms);
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += ms[i];
  }
  const auto frames = static_cast<double>(state.iterations());
  // Millions of disparity evaluations per second, and per core.
  const double evaluations = 1e-6 * size.width * size.height * size.disparities;
  state.counters["MDE/s"] = benchmark::Counter(evaluations * frames, benchmark::Counter::kIsRate);
  state.counters["MDE/s/core"] =
      benchmark::Counter(evaluations * frames / threads, benchmark::Counter::kIsRate);
  state.counters["real_scene"] = scene.is_real ? 1 : 0;
  for (std::size_t i = 0; i < sum.size(); ++i) {
    const bool ran = sum[i] > 0;
    if (!ran) continue;
    state.counters[std::string("ms_") + kStageNames[i]] = sum[i] / frames;
  }
}

void add(const std::string& contender, const Size& size) {
  for (const int threads : {1, 2}) {
    const std::string name = contender + "/" + std::to_string(size.width) + "x" +
                             std::to_string(size.height) + "x" + std::to_string(size.disparities) +
                             "/" + std::to_string(threads);
    benchmark::RegisterBenchmark(name.c_str(),
                                 [contender, size, threads](benchmark::State& state) {
                                   measure(state, contender, size, threads);
                                 })
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime();
  }
}

void add_all() {
  for (const Size& size : kSizes) {
    for (const std::string& name : contender_names()) add(name, size);
  }
  for (const Size& size : kMoreSizes) {
    for (const char* name : {"fpga_stereo/sgm", "fpga_stereo/sparse"}) add(name, size);
  }
}

}  // namespace
}  // namespace fpga_stereo::bench

int main(int argc, char** argv) {
  fpga_stereo::bench::add_all();
  benchmark::AddCustomContext("opencv", cv::getVersionString());
  return fpga_stereo::bench::run(argc, argv);
}
