#include "core/simd/pipeline.hpp"

#include <algorithm>
#include <numeric>

#include "core/bands.hpp"
#include "core/simd/stage_timer.hpp"

namespace fpga_stereo::simd {
namespace {

constexpr int kTimedRows = 16;  // one row in this many is timed: reading the clock costs time

}  // namespace

void Pipeline::process(const cv::Mat1b& left_raw, const cv::Mat1b& right_raw,
                       const StereoRectification& rectification, const Parameters& p,
                       int num_threads, DisparityFrame& out) {
  const cv::Size size = rectification.geometry.image_size;
  create(size, p, num_threads);

  out.ms = {};
  StageTimer timer(out.ms);
  left_.sources.create(rectification.left.mesh, left_raw.size());
  right_.sources.create(rectification.right.mesh, right_raw.size());
  for_each_band(size.height, num_threads, [&](int, cv::Range rows) {
    rectify(left_raw, left_.sources, rows, left_.rectified.image);
    rectify(right_raw, right_.sources, rows, right_.rectified.image);
  });
  timer.lap(Stage::kRectify);

  for_each_band(size.height, num_threads, [&](int, cv::Range rows) {
    census(left_.rectified, p, rows, left_.bits);
    census(right_.rectified, p, rows, right_.bits);
  });
  timer.lap(Stage::kCensus);

  for_each_band(size.height, num_threads, [&](int band, cv::Range rows) {
    match_to_subpixel(p, rows, bands_[static_cast<std::size_t>(band)]);
  });
  share_time(timer.restart(), out.ms);

  speckle_.apply(p, disparity_);
  timer.lap(Stage::kSpeckle);

  out.left = left_.rectified.image;
  out.right = right_.rectified.image;
  out.disparity = disparity_.image;
}

/// Runs match, select, check and subpixel on each row while it is in the cache.
void Pipeline::match_to_subpixel(const Parameters& p, cv::Range rows, Band& band) {
  const SelectionRow& selection = band.selection.row();
  band.match.start(left_.bits, right_.bits, p, rows.start);
  for (int y = rows.start; y < rows.end; ++y) {
    StageTimer timer(band.ms, y % kTimedRows == 0);
    for (int x = 0; x < selection.width; x += kBlockColumns) {
      const WindowSums& sums = band.match.next();
      timer.lap(Stage::kMatch);
      select(sums, selection);
      timer.lap(Stage::kSelect);
    }
    check(selection, p, band.kept.data());
    timer.lap(Stage::kCheck);
    subpixel(selection, band.kept.data(), p, disparity_.image[y]);
    timer.lap(Stage::kSubpixel);
  }
}

void Pipeline::create(cv::Size size, const Parameters& p, int num_threads) {
  for (Camera* camera : {&left_, &right_}) {
    camera->rectified.create(size);
    camera->bits.create(size, p);
  }
  bands_.resize(static_cast<std::size_t>(num_threads));
  for (Band& band : bands_) {
    band.selection.create(size.width, p.disparity_range);
    band.kept.resize(static_cast<std::size_t>(size.width) + kBorder);
    band.ms = {};
  }
  disparity_.create(size);
}

/// Splits the wall-clock time of match to subpixel in the proportions of the rows that were timed.
void Pipeline::share_time(double wall, StageTimes& ms) const {
  StageTimes sum{};
  for (const Band& band : bands_) {
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += band.ms[i];
  }
  const double total = std::max(std::accumulate(sum.begin(), sum.end(), 0.0), 1e-9);
  for (const Stage stage : {Stage::kMatch, Stage::kSelect, Stage::kCheck, Stage::kSubpixel}) {
    const auto i = static_cast<std::size_t>(stage);
    ms[i] = wall * sum[i] / total;
  }
}

}  // namespace fpga_stereo::simd
