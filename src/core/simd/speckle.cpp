#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/simd/speckle.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/simd/speckle.hpp"
#include "fpga_stereo/core/spec.hpp"

HWY_BEFORE_NAMESPACE();
namespace fpga_stereo::simd::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

void connect_row(const std::uint16_t* row, const std::uint16_t* above, int width, int range,
                 const ConnectedRow& out) {
  const hn::CappedTag<std::uint16_t, 32> d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const auto invalid = hn::Set(d, kNoDisparity);
  const auto end = hn::Set(d, static_cast<std::uint16_t>(range + 1));
  const auto bits = [&](auto mask) {
    std::array<std::uint8_t, 8> bytes{};
    hn::StoreMaskBits(d, mask, bytes.data());
    std::uint64_t word = 0;
    std::memcpy(&word, bytes.data(), sizeof word);
    return word;
  };
  const auto difference = [](auto a, auto b) { return hn::Sub(hn::Max(a, b), hn::Min(a, b)); };
  for (int x = 0; x < width; x += 64) {
    std::uint64_t valid = 0, left = 0, up = 0;
    for (int i = 0; i < 64; i += lanes) {
      const auto here = hn::LoadU(d, row + x + i);
      // kNoDisparity differs from every disparity by more than any range.
      valid |= bits(hn::Ne(here, invalid)) << i;
      left |= bits(hn::Lt(difference(here, hn::LoadU(d, row + x + i - 1)), end)) << i;
      up |= bits(hn::Lt(difference(here, hn::LoadU(d, above + x + i)), end)) << i;
    }
    if (width - x < 64) valid &= (std::uint64_t{1} << (width - x)) - 1;
    out.valid[x / 64] = valid;
    out.left[x / 64] = left & valid;
    out.up[x / 64] = up & valid;
  }
}

}  // namespace fpga_stereo::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fpga_stereo::simd {

HWY_EXPORT(connect_row);

void connect_row(const std::uint16_t* row, const std::uint16_t* above, int width, int range,
                 const ConnectedRow& out) {
  HWY_DYNAMIC_DISPATCH(connect_row)(row, above, width, range, out);
}

namespace {

constexpr int kWord = 64;  // bits

int count_bits(std::uint64_t word) { return __builtin_popcountll(word); }

/// Calls work(first + k) for each bit k that is set, in order.
template <class Work>
void for_each_bit(std::uint64_t word, int first, const Work& work) {
  for (; word != 0; word &= word - 1) work(first + __builtin_ctzll(word));
}

}  // namespace

int SpeckleFilter::Row::run(int x) const {
  const auto word = static_cast<std::size_t>(x / kWord);
  const std::uint64_t until = starts[word] << (kWord - 1 - x % kWord);
  return first_run + runs_before[word] + count_bits(until) - 1;
}

int SpeckleFilter::root(int run) {
  while (runs_[run].parent != run) {
    runs_[run].parent = runs_[runs_[run].parent].parent;
    run = runs_[run].parent;
  }
  return run;
}

void SpeckleFilter::join(int a, int b) {
  a = root(a);
  b = root(b);
  if (a == b) return;
  if (runs_[a].area < runs_[b].area) std::swap(a, b);
  runs_[b].parent = a;
  runs_[a].area += runs_[b].area;
}

void SpeckleFilter::add_runs(Row& row) {
  row.first_run = static_cast<int>(runs_.size());
  int starts = 0, ends = 0;
  for (std::size_t w = 0; w < row.valid.size(); ++w) {
    const std::uint64_t next_left = w + 1 < row.left.size() ? row.left[w + 1] << (kWord - 1) : 0;
    row.starts[w] = row.valid[w] & ~row.left[w];
    row.runs_before[w] = starts;
    const auto at = static_cast<int>(w) * kWord;
    for_each_bit(row.starts[w], at, [&](int x) {
      const int run = static_cast<int>(runs_.size());
      runs_.push_back({static_cast<std::uint16_t>(x), 0, run, 0});
      ++starts;
    });
    for_each_bit(row.valid[w] & ~(row.left[w] >> 1 | next_left), at, [&](int x) {
      Run& run = runs_[row.first_run + ends++];
      run.end = static_cast<std::uint16_t>(x + 1);
      run.area = run.end - run.begin;
    });
  }
}

void SpeckleFilter::join_rows(const Row& row, const Row& above) {
  bool carry = false;  // the last pixel of the previous word is connected upwards
  for (std::size_t w = 0; w < row.up.size(); ++w) {
    // If the left neighbour joined the same two runs, this pixel need not.
    const std::uint64_t left_up = row.up[w] << 1 | (carry ? 1 : 0);
    const std::uint64_t known = left_up & row.left[w] & above.left[w];
    for_each_bit(row.up[w] & ~known, static_cast<int>(w) * kWord,
                 [&](int x) { join(row.run(x), above.run(x)); });
    carry = row.up[w] >> (kWord - 1) != 0;
  }
}

void SpeckleFilter::label(const cv::Mat1w& disparity, int y, int range) {
  Row& row = rows_[y % 2];
  const std::uint16_t* above = y > 0 ? disparity[y - 1] : empty_row_.data();
  connect_row(disparity[y], above, disparity.cols, range,
              {row.valid.data(), row.left.data(), row.up.data()});
  first_run_.push_back(static_cast<int>(runs_.size()));
  add_runs(row);
  if (y > 0) join_rows(row, rows_[(y + 1) % 2]);
}

void SpeckleFilter::decide(cv::Mat1w& disparity, int y, int size) {
  for (int run = first_run_[y]; run < first_run_[y + 1]; ++run) {
    if (runs_[root(run)].area >= size) continue;
    std::fill(disparity[y] + runs_[run].begin, disparity[y] + runs_[run].end, kNoDisparity);
  }
}

void SpeckleFilter::apply(const Parameters& p, DisparityImage& image) {
  if (p.speckle_size == 0) return;
  cv::Mat1w& disparity = image.image;
  const int range = p.speckle_range * kDisparityScale;
  const auto words = static_cast<std::size_t>((disparity.cols + kWord - 1) / kWord);
  for (Row& row : rows_) {
    for (auto* bits : {&row.valid, &row.left, &row.up, &row.starts}) bits->assign(words, 0);
    row.runs_before.assign(words, 0);
  }
  empty_row_.assign(words * kWord, kNoDisparity);
  runs_.clear();
  first_run_.clear();
  for (int y = 0; y < disparity.rows + kSpeckleLookAhead; ++y) {
    if (y < disparity.rows) {
      label(disparity, y, range);
    } else if (y == disparity.rows) {
      first_run_.push_back(static_cast<int>(runs_.size()));
    }
    if (y >= kSpeckleLookAhead) decide(disparity, y - kSpeckleLookAhead, p.speckle_size);
  }
}

}  // namespace fpga_stereo::simd
#endif
