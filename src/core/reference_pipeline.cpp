#include "core/reference_pipeline.hpp"

#include <chrono>
#include <functional>

#include "core/bands.hpp"

namespace fpga_stereo {
namespace {

using Clock = std::chrono::steady_clock;

double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

}  // namespace

const Taps& ReferencePipeline::process(const cv::Mat1b& left_raw, const cv::Mat1b& right_raw,
                                       const StereoRectification& rectification,
                                       const Parameters& parameters, int num_threads) {
  Taps& t = taps_;
  t.ms = {};
  const cv::Size size = rectification.geometry.image_size;
  const auto timed = [&](Stage stage, const std::function<void(cv::Range)>& work) {
    const auto start = Clock::now();
    for_each_band(size.height, num_threads, [&](int, cv::Range rows) { work(rows); });
    t.ms[static_cast<std::size_t>(stage)] += ms_since(start);
  };
  for (cv::Mat1b* image : {&t.left, &t.right, &t.kept}) image->create(size);
  t.refined.create(size);
  create(t.selection, size);

  timed(Stage::kRectify, [&](cv::Range rows) {
    rectify(left_raw, rectification.left.mesh, rows, t.left);
    rectify(right_raw, rectification.right.mesh, rows, t.right);
  });
  // These calls process no rows, but create the outputs before bands write to them in parallel.
  census(t.left, parameters, {0, 0}, t.left_bits);
  census(t.right, parameters, {0, 0}, t.right_bits);
  timed(Stage::kCensus, [&](cv::Range rows) {
    census(t.left, parameters, rows, t.left_bits);
    census(t.right, parameters, rows, t.right_bits);
  });
  const bool is_sgm = parameters.stereo_algorithm == StereoAlgorithm::kSgm;
  if (is_sgm) {
    aggregate_and_select(parameters);
  } else {
    match_and_select(parameters, num_threads);
  }
  timed(Stage::kCheck, [&](cv::Range rows) { check(t.selection, parameters, rows, t.kept); });
  timed(Stage::kSubpixel, [&](cv::Range rows) {
    if (is_sgm) {
      fit_subpixel(t.left_bits, t.right_bits, t.selection, t.kept, parameters, rows, t.refined);
    } else {
      subpixel(t.selection, t.kept, parameters, rows, t.refined);
    }
  });
  const auto start = Clock::now();
  t.refined.copyTo(t.filtered);
  speckle(parameters, t.filtered);
  t.ms[static_cast<std::size_t>(Stage::kSpeckle)] = ms_since(start);
  t.filled.release();
  t.disparity = t.filtered;
  if (parameters.dense) {
    t.filled = t.filtered.clone();
    timed(Stage::kFill, [&](cv::Range rows) { fill(rows, t.filled); });
    cv::Mat1w smooth(size);
    t.disparity = cv::Mat1w(size);
    timed(Stage::kMedian,
          [&](cv::Range rows) { masked_median(t.left, t.filled, parameters, rows, smooth); });
    timed(Stage::kMedian, [&](cv::Range rows) { median(smooth, rows, t.disparity); });
  }
  return t;
}

void ReferencePipeline::aggregate_and_select(const Parameters& parameters) {
  Taps& t = taps_;
  auto start = Clock::now();
  const auto lap = [&](Stage stage) {
    t.ms[static_cast<std::size_t>(stage)] += ms_since(start);
    start = Clock::now();
  };
  cost_.start(t.left, t.right, t.left_bits, t.right_bits, parameters, 0);
  aggregate_.start(t.left, parameters);
  for (int y = 0; y < t.left.rows; ++y) {
    const cv::Mat1b& costs = cost_.next();
    lap(Stage::kCost);
    const cv::Mat1w& sums = aggregate_.next(costs);
    lap(Stage::kAggregate);
    select(sums, y, t.selection);
    lap(Stage::kSelect);
  }
}

void ReferencePipeline::match_and_select(const Parameters& parameters, int num_threads) {
  Taps& t = taps_;
  const int height = t.left_bits.rows;
  matches_.resize(num_threads);
  std::vector<double> match_ms(num_threads), select_ms(num_threads);
  const auto begin = Clock::now();
  for_each_band(height, num_threads, [&](int band, cv::Range rows) {
    Match& match = matches_[band];
    auto start = Clock::now();
    match.start(t.left_bits, t.right_bits, parameters, rows.start);
    for (int y = rows.start; y < rows.end; ++y) {
      const cv::Mat1w& sums = match.next();
      match_ms[band] += ms_since(start);
      start = Clock::now();
      select(sums, y, t.selection);
      select_ms[band] += ms_since(start);
      start = Clock::now();
    }
  });
  // The stages take turns on each row, so the wall-clock time is split as the threads' times are.
  const double wall = ms_since(begin);
  double match_total = 0;
  double select_total = 0;
  for (int band = 0; band < num_threads; ++band) {
    match_total += match_ms[band];
    select_total += select_ms[band];
  }
  const double total = std::max(match_total + select_total, 1e-9);
  t.ms[static_cast<std::size_t>(Stage::kMatch)] = wall * match_total / total;
  t.ms[static_cast<std::size_t>(Stage::kSelect)] = wall * select_total / total;
}

}  // namespace fpga_stereo
