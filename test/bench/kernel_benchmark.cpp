// The kernels that take most of a frame, alone, on one thread, for a row of 640 pixels with 64
// disparities that is in the caches: items are pixels; those of `cycles` are the processor's.
// Names are kernel/variant.
#include <benchmark/benchmark.h>

#include <opencv2/core.hpp>
#include <vector>

#include "bench/run.hpp"
#include "core/simd/kernels.hpp"

namespace fpga_stereo::bench {
namespace {

constexpr int kWidth = 640, kRange = 64, kRadius = 7, kColumns = 32;
constexpr int kPadded = simd::padded_range(kRange);
constexpr int kMargin = 2 * kPadded;  // around a row, bytes or lanes
constexpr int kRows = 128;            // of the ring

cv::Mat1b random_bytes(int rows, int cols, int end) {
  cv::Mat1b bytes(rows, cols);
  cv::randu(bytes, 0, end);
  return bytes;
}

/// What the kernels read and write, as RowMatcher arranges it.
struct Row {
  cv::Mat1b planes = random_bytes(2 * 15, kMargin + kWidth + kMargin, 256);
  cv::Mat1b slots = random_bytes(2 * kRadius + 1, kWidth* kPadded, 25);
  cv::Mat1s columns = cv::Mat1s(1, (kWidth + 4 * kRadius) * kPadded, std::int16_t{100});
  cv::Mat1w ring =
      cv::Mat1w(1, kRows*(kPadded + simd::kLaneGroup) + simd::kLaneGroup, std::uint16_t{0xFFFF});
  cv::Mat1w words = cv::Mat1w(7, kWidth + simd::kBorder, std::uint16_t{1000});
  cv::Mat1b bytes = random_bytes(2, kMargin + kWidth + simd::kBorder, kRange);
  cv::Mat1b image = random_bytes(11, kMargin + kWidth + kMargin, 256);
  std::vector<std::uint8_t> kept = std::vector<std::uint8_t>(kWidth + simd::kBorder);
  std::vector<std::uint16_t> disparity = std::vector<std::uint16_t>(kWidth + simd::kBorder);
  simd::SumRing sums{ring[0] + simd::kLaneGroup, kPadded + simd::kLaneGroup, kRows - 1, kRange,
                     kPadded};
  simd::SelectedRow selected{bytes[0] + kMargin,
                             bytes[1] + kMargin,
                             words[0],
                             words[1],
                             {words[2], words[3], words[4], words[5], words[6]}};
  int slot = 0;

  Row() {
    for (int x = 0; x < kRows; ++x) {
      std::uint16_t* sum = sums.row(x);
      for (int i = 0; i < kPadded; ++i)
        sum[i] = static_cast<std::uint16_t>(cv::theRNG().uniform(0, 5400));
    }
  }
  std::int16_t* first_column() { return columns[0] + (kRadius + 1) * kPadded; }

  void hamming(int count) {
    const simd::HammingRow row{planes[0] + kMargin,
                               planes[count] + kMargin,
                               static_cast<std::ptrdiff_t>(planes.step[0]),
                               count,
                               kRange,
                               kPadded,
                               4 * count};
    slot = (slot + 1) % slots.rows;
    simd::hamming(row, 0, kWidth, slots[slot], first_column());
  }
  void census(int neighbours) {
    std::vector<std::ptrdiff_t> distances;
    const auto pitch = static_cast<std::ptrdiff_t>(image.step[0]);
    for (int i = 0; i < neighbours; ++i) distances.push_back((i / 11 - 5) * pitch + i % 11 - 5);
    simd::census_row(image[5] + kMargin, kWidth, distances, planes[0], planes.cols);
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

/// Additions that wait for each other: cycles, to compare the kernels with.
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
  add("census/sparse", [](Row& r) { r.census(24); });
  add("census/full", [](Row& r) { r.census(120); });
  add("hamming/sparse", [](Row& r) { r.hamming(3); });
  add("hamming/full", [](Row& r) { r.hamming(15); });
  add("box", [](Row& r) {
    for (int x = 0; x < kWidth; x += kColumns) {
      simd::box(r.first_column(), kRadius, x, x + kColumns, r.sums);
    }
  });
  add("select/left", [](Row& r) {
    for (int x = 0; x < kWidth; x += kColumns) {
      simd::select_left(r.sums, x, x + kColumns, r.selected);
    }
  });
  add("select/right", [](Row& r) {
    for (int x = 0; x < kWidth; x += simd::kLaneGroup) {
      simd::select_right(r.sums, x, kWidth + kRange, r.selected.right_winner);
    }
  });
  add("check",
      [](Row& r) { simd::check_row(r.selected, kWidth, true, 1, true, 282, r.kept.data()); });
  add("subpixel", [](Row& r) {
    simd::subpixel_row(r.selected, r.kept.data(), kWidth, kRange, true, r.disparity.data());
  });
}

}  // namespace
}  // namespace fpga_stereo::bench

int main(int argc, char** argv) {
  fpga_stereo::bench::add_all();
  return fpga_stereo::bench::run(argc, argv);
}
