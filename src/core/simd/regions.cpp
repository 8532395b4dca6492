#include "core/simd/regions.hpp"

#include <algorithm>
#include <utility>

#include "core/simd/kernels.hpp"
#include "fpga_stereo/core/spec.hpp"

namespace fpga_stereo::simd {
namespace {

constexpr int kWord = 64;

int count_bits(std::uint64_t word) { return __builtin_popcountll(word); }

/// Calls with the number of each bit that is set, in order.
template <class Call>
void for_each_bit(std::uint64_t word, int first, const Call& call) {
  for (; word != 0; word &= word - 1) call(first + __builtin_ctzll(word));
}

}  // namespace

int Regions::Row::run(int x) const {
  const auto word = static_cast<std::size_t>(x / kWord);
  const std::uint64_t until = starts[word] << (kWord - 1 - x % kWord);
  return first + before[word] + count_bits(until) - 1;
}

int Regions::root(int run) {
  while (runs_[run].parent != run) {
    runs_[run].parent = runs_[runs_[run].parent].parent;
    run = runs_[run].parent;
  }
  return run;
}

void Regions::join(int a, int b) {
  a = root(a);
  b = root(b);
  if (a == b) return;
  if (runs_[a].area < runs_[b].area) std::swap(a, b);
  runs_[b].parent = a;
  runs_[a].area += runs_[b].area;
}

void Regions::add_runs(Row& row) {
  row.first = static_cast<int>(runs_.size());
  int starts = 0, ends = 0;
  for (std::size_t w = 0; w < row.valid.size(); ++w) {
    const std::uint64_t next_left = w + 1 < row.left.size() ? row.left[w + 1] << (kWord - 1) : 0;
    row.starts[w] = row.valid[w] & ~row.left[w];
    row.before[w] = starts;
    const auto at = static_cast<int>(w) * kWord;
    for_each_bit(row.starts[w], at, [&](int x) {
      const int run = static_cast<int>(runs_.size());
      runs_.push_back({static_cast<std::uint16_t>(x), 0, run, 0});
      ++starts;
    });
    for_each_bit(row.valid[w] & ~(row.left[w] >> 1 | next_left), at, [&](int x) {
      Run& run = runs_[row.first + ends++];
      run.end = static_cast<std::uint16_t>(x + 1);
      run.area = run.end - run.begin;
    });
  }
}

void Regions::join_rows(const Row& row, const Row& above) {
  bool carry = false;  // the pixel before is connected with that above it
  for (std::size_t w = 0; w < row.up.size(); ++w) {
    // Where that pixel's neighbours are this one's, so are the regions.
    const std::uint64_t before = row.up[w] << 1 | (carry ? 1 : 0);
    const std::uint64_t known = before & row.left[w] & above.left[w];
    for_each_bit(row.up[w] & ~known, static_cast<int>(w) * kWord,
                 [&](int x) { join(row.run(x), above.run(x)); });
    carry = row.up[w] >> (kWord - 1) != 0;
  }
}

void Regions::label(const cv::Mat1w& disparity, int y, int range) {
  Row& row = rows_[y % 2];
  const std::uint16_t* above = y > 0 ? disparity[y - 1] : none_.data();
  connect_row(disparity[y], above, disparity.cols, range,
              {row.valid.data(), row.left.data(), row.up.data()});
  first_run_.push_back(static_cast<int>(runs_.size()));
  add_runs(row);
  if (y > 0) join_rows(row, rows_[(y + 1) % 2]);
}

void Regions::decide(cv::Mat1w& disparity, int y, int size) {
  for (int run = first_run_[y]; run < first_run_[y + 1]; ++run) {
    if (runs_[root(run)].area >= size) continue;
    std::fill(disparity[y] + runs_[run].begin, disparity[y] + runs_[run].end, kNoDisparity);
  }
}

void Regions::remove_small(cv::Mat1w& disparity, int range, int size) {
  const auto words = static_cast<std::size_t>((disparity.cols + kWord - 1) / kWord);
  for (Row& row : rows_) {
    for (auto* bits : {&row.valid, &row.left, &row.up, &row.starts}) bits->assign(words, 0);
    row.before.assign(words, 0);
  }
  none_.assign(words * kWord, kNoDisparity);
  runs_.clear();
  first_run_.clear();
  for (int y = 0; y < disparity.rows + kSpeckleLookAhead; ++y) {
    if (y < disparity.rows) {
      label(disparity, y, range);
    } else if (y == disparity.rows) {
      first_run_.push_back(static_cast<int>(runs_.size()));
    }
    if (y >= kSpeckleLookAhead) decide(disparity, y - kSpeckleLookAhead, size);
  }
}

}  // namespace fpga_stereo::simd
