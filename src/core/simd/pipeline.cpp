#include "core/simd/pipeline.hpp"

#include <algorithm>
#include <numeric>

#include "core/bands.hpp"
#include "core/simd/stage_timer.hpp"
#include "core/stages.hpp"

namespace fpga_stereo::simd {
namespace {

constexpr int kTimedRows = 16;    // one row in this many is timed: reading the clock costs time
constexpr int kRowsTogether = 8;  // that a thread processes between its turns

}  // namespace

void Pipeline::process(const cv::Mat1b& left_raw, const cv::Mat1b& right_raw,
                       const StereoRectification& rectification, const Parameters& p,
                       int num_threads, DisparityFrame& out) {
  const cv::Size size = rectification.geometry.image_size;
  const bool is_sgm = p.stereo_algorithm == StereoAlgorithm::kSgm;
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
    if (!is_sgm) return;
    smooth_rows(left_.rectified, rows, left_.bits);
    smooth_rows(right_.rectified, rows, right_.bits);
    smooth_binomial(left_.rectified, rows, guide_);
  });
  timer.lap(Stage::kCensus);

  if (is_sgm) {
    cost_to_subpixel(p, num_threads, out.ms);
  } else {
    for_each_band(size.height, num_threads, [&](int band, cv::Range rows) {
      match_to_subpixel(p, rows, bands_[static_cast<std::size_t>(band)]);
    });
    share_time(timer.restart(), out.ms);
  }
  timer.restart();

  speckle_.apply(p, disparity_);
  timer.lap(Stage::kSpeckle);
  out.disparity = disparity_.image;

  if (p.dense) {
    fill(cv::Range::all(), disparity_.image);
    timer.lap(Stage::kFill);
    for_each_band(size.height, num_threads, [&](int, cv::Range rows) {
      masked_median(left_.rectified, disparity_, p, rows, smooth_);
      replicate_columns(smooth_, rows);
    });
    for_each_band(size.height, num_threads,
                  [&](int, cv::Range rows) { median(smooth_, rows, disparity_); });
    timer.lap(Stage::kMedian);
  }
  out.left = left_.rectified.image;
  out.right = right_.rectified.image;
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

/// Runs the stages of semi-global matching.
void Pipeline::cost_to_subpixel(const Parameters& p, int num_threads, StageTimes& ms) {
  const cv::Size size = disparity_.image.size();
  StageTimer timer(ms);
  turns_.start();
  vertical_paths_.start(size.width, p);
  // Alone, a thread processes a row at a time, which stays in the cache. Together, they take turns
  // on the paths from above, a few rows each.
  const int rows_together = num_threads == 1 ? 1 : kRowsTogether;
  const int workers = std::min(num_threads, size.height);
  for_each_band(workers, workers, [&](int worker, cv::Range) {
    Band& band = bands_[static_cast<std::size_t>(worker)];
    band.horizontal_paths.start(size.width, p);
    band.sums.create(size.width, p.disparity_range);
    for (int part = turns_.claim(); part * rows_together < size.height; part = turns_.claim()) {
      const int first = part * rows_together;
      cost_to_check(p, {first, std::min(first + rows_together, size.height)}, part, band);
    }
  });
  share_time(timer.restart(), ms);

  for_each_band(size.height, num_threads, [&](int i, cv::Range rows) {
    Fit& fit = bands_[static_cast<std::size_t>(i)].fit;
    fit.start(left_.bits, right_.bits, winner_, kept_, p, rows.start);
    for (int y = rows.start; y < rows.end; ++y) fit.next(disparity_.image[y]);
  });
  timer.lap(Stage::kSubpixel);
}

/// Runs cost, aggregate, select and check on a part of the rows.
void Pipeline::cost_to_check(const Parameters& p, cv::Range rows, int part, Band& band) {
  const SelectionRow& selection = band.selection.row();
  const int width = selection.width;
  StageTimer timer(band.ms, rows.size() > 1 || part % kTimedRows == 0);
  band.costs.create(rows.size(), width * lanes_per_pixel(p.disparity_range));
  const auto costs = [&](int y) { return band.costs[y - rows.start]; };
  if (band.next_cost_row != rows.start) band.cost.start(left_.bits, right_.bits, p, rows.start);
  for (int y = rows.start; y < rows.end; ++y) band.cost.next(costs(y));
  band.next_cost_row = rows.end;
  timer.lap(Stage::kCost);

  band.set = 1 - band.set;
  std::vector<VerticalCosts>& vertical = band.vertical_costs[band.set];
  vertical.resize(std::max(vertical.size(), static_cast<std::size_t>(rows.size())));
  for (VerticalCosts& row : vertical) row.create(width, p.disparity_range);
  const auto vertical_row = [&](int y) -> VerticalCosts& {
    return vertical[static_cast<std::size_t>(y - rows.start)];
  };
  turns_.wait_for(part);
  if (rows.start == 0) last_ = &vertical_row(0);  // ignored, but there must be one
  for (int y = rows.start; y < rows.end; ++y) {
    vertical_paths_.next(guide_.image, y, costs(y), *last_, vertical_row(y));
    last_ = &vertical_row(y);
  }
  turns_.pass(part);
  timer.lap(Stage::kAggregate);

  const PathSums& sums = band.sums.sums();
  for (int y = rows.start; y < rows.end; ++y) {
    band.horizontal_paths.next(guide_.image, y, costs(y), vertical_row(y), sums);
    timer.lap(Stage::kAggregate);
    select(sums, selection);
    timer.lap(Stage::kSelect);
    check(selection, p, kept_.image[y]);
    std::copy_n(selection.winner, width, winner_.image[y]);
    timer.lap(Stage::kCheck);
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
    band.next_cost_row = -1;
  }
  disparity_.create(size);
  if (p.stereo_algorithm == StereoAlgorithm::kSgm) {
    guide_.create(size);
    winner_.create(size);
    kept_.create(size);
  }
  if (p.dense) smooth_.create(size);
}

/// Splits the wall-clock time of the stages that take turns on rows in the proportions of the rows
/// that were timed.
void Pipeline::share_time(double wall, StageTimes& ms) const {
  StageTimes sum{};
  for (const Band& band : bands_) {
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += band.ms[i];
  }
  const double total = std::max(std::accumulate(sum.begin(), sum.end(), 0.0), 1e-9);
  for (std::size_t i = 0; i < sum.size(); ++i) ms[i] += wall * sum[i] / total;
}

}  // namespace fpga_stereo::simd
