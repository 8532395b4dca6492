// Measures the kernels that take most of a frame, each alone on one thread, for a row of 640 pixels
// with 64 disparities that is in the caches. An item is a pixel; an item of `cycles` is a cycle of
// the processor. Names are kernel/variant.
#include <benchmark/benchmark.h>

#include <opencv2/core.hpp>
#include <vector>

#include "bench/run.hpp"
#include "core/simd/select.hpp"
#include "core/simd/stages.hpp"

namespace fpga_stereo::bench {
namespace {

constexpr int kWidth = 640, kRange = 64, kRadius = 7;
constexpr int kLanes = simd::lanes_per_pixel(kRange);
constexpr int kMargin = 2 * kLanes;  // around a row, in bytes or lanes
constexpr int kRingRows = 128;

cv::Mat1b random_bytes(int rows, int cols, int end) {
  cv::Mat1b bytes(rows, cols);
  cv::randu(bytes, 0, end);
  return bytes;
}

Parameters parameters(CensusPattern pattern = CensusPattern::kSparse) {
  Parameters p = window_parameters();
  p.disparity_range = kRange;
  p.census_pattern = pattern;
  return p;
}

/// What the kernels read and write, as the pipeline arranges it.
struct Row {
  cv::Mat1b planes = random_bytes(2 * 15, kMargin + kWidth + kMargin, 256);
  cv::Mat1b distances = random_bytes(2 * kRadius + 1, kWidth* kLanes, 25);
  cv::Mat1s columns = cv::Mat1s(1, (kWidth + 4 * kRadius) * kLanes, std::int16_t{100});
  cv::Mat1w ring =
      cv::Mat1w(1, kRingRows*(kLanes + simd::kLaneGroup) + simd::kLaneGroup, std::uint16_t{0xFFFF});
  simd::WindowSums sums{ring[0] + simd::kLaneGroup,
                        kLanes + simd::kLaneGroup,
                        kRingRows - 1,
                        kRange,
                        kLanes,
                        kWidth + kRange,
                        0,
                        0};
  simd::SelectionBuffer selection;
  simd::CensusImage image;
  simd::CensusPlanes sparse, full;
  std::vector<std::uint8_t> kept = std::vector<std::uint8_t>(kWidth + simd::kBorder);
  std::vector<std::uint16_t> disparity = std::vector<std::uint16_t>(kWidth + simd::kBorder);
  int distances_row = 0;

  Row() {
    for (int x = 0; x < kRingRows; ++x) {
      for (int i = 0; i < kLanes; ++i) {
        sums.column(x)[i] = static_cast<std::uint16_t>(cv::theRNG().uniform(0, 5400));
      }
    }
    selection.create(kWidth, kRange);
    const simd::SelectionRow& row = selection.row();
    for (int x = 0; x < kWidth; ++x) {
      row.winner[x] = static_cast<std::uint8_t>(cv::theRNG().uniform(0, kRange));
      row.right_winner[x] = static_cast<std::uint8_t>(cv::theRNG().uniform(0, kRange));
      row.winner_sum[x] = row.runner_up_sum[x] = 1000;
      for (auto* sum : row.around) sum[x] = 1000;
    }
    image.create({kWidth, 1});
    cv::randu(image.all, 0, 256);
    sparse.create({kWidth, 1}, parameters());
    full.create({kWidth, 1}, parameters(CensusPattern::kFull));
  }
  std::int16_t* first_column() { return columns[0] + (kRadius + 1) * kLanes; }

  void census(CensusPattern pattern) {
    simd::CensusPlanes& bits = pattern == CensusPattern::kFull ? full : sparse;
    simd::census(image, parameters(pattern), {0, 1}, bits);
  }
  void hamming(int count) {
    const simd::HammingRow row{planes[0] + kMargin,
                               planes[count] + kMargin,
                               static_cast<std::ptrdiff_t>(planes.step[0]),
                               count,
                               kRange,
                               kLanes,
                               4 * count};
    distances_row = (distances_row + 1) % distances.rows;
    simd::hamming_distances(row, 0, kWidth, distances[distances_row], first_column());
  }
  /// Calls work() for each block of the row.
  template <class Work>
  void for_each_block(const Work& work) {
    for (sums.begin = 0; sums.begin < kWidth; sums.begin += simd::kBlockColumns) {
      sums.end = sums.begin + simd::kBlockColumns;
      work();
    }
  }
};

template <class Work>
void add(const char* name, Work work) {
  benchmark::RegisterBenchmark(name, [work](benchmark::State& state) {
    Row row;
    for (auto _ : state) work(row);
    state.SetItemsProcessed(kWidth * state.iterations());
  });
}

/// Additions of which each waits for the one before: a cycle each, to compare the kernels with.
void cycles(benchmark::State& state) {
  constexpr int kAdditions = 64;
  std::uint64_t sum = 1, step = 3;
  for (auto _ : state) {
    for (int i = 0; i < kAdditions; ++i) {
      sum += step;
      asm volatile("" : "+r"(sum), "+r"(step));
    }
  }
  state.SetItemsProcessed(kAdditions * state.iterations());
}

void add_all() {
  benchmark::RegisterBenchmark("cycles", cycles);
  add("census/sparse", [](Row& r) { r.census(CensusPattern::kSparse); });
  add("census/full", [](Row& r) { r.census(CensusPattern::kFull); });
  add("hamming/sparse", [](Row& r) { r.hamming(3); });
  add("hamming/full", [](Row& r) { r.hamming(15); });
  add("window_sums", [](Row& r) {
    r.for_each_block([&] { simd::window_sums(r.first_column(), kRadius, r.sums); });
  });
  add("select/left",
      [](Row& r) { r.for_each_block([&] { simd::select_left(r.sums, r.selection.row()); }); });
  add("select/right", [](Row& r) {
    r.for_each_block(
        [&] { simd::select_right(r.sums, r.sums.begin, r.selection.row().right_winner); });
  });
  add("check", [p = parameters()](Row& r) { simd::check(r.selection.row(), p, r.kept.data()); });
  add("subpixel", [p = parameters()](Row& r) {
    simd::subpixel(r.selection.row(), r.kept.data(), p, r.disparity.data());
  });
}

}  // namespace
}  // namespace fpga_stereo::bench

int main(int argc, char** argv) {
  fpga_stereo::bench::add_all();
  return fpga_stereo::bench::run(argc, argv);
}
