#include "core/simd/frame.hpp"

#include <algorithm>
#include <chrono>
#include <numeric>

#include "core/bands.hpp"
#include "core/census_window.hpp"
#include "core/stages.hpp"

namespace fpga_stereo::simd {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kMostRadius = 5;          // of a census window, px
constexpr int kTimedRows = 16;          // one row in so many says how stages share the time
constexpr std::uint8_t kOutside = 255;  // smaller than no pixel: bit 0

double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

double& time_of(StageTimes& ms, Stage stage) { return ms[static_cast<std::size_t>(stage)]; }

/// Adds what passes between its laps to the times of stages.
class Watch {
 public:
  Watch(StageTimes& ms, bool on) : ms_(ms), on_(on) {
    if (on_) last_ = Clock::now();
  }
  bool on() const { return on_; }
  void lap(Stage stage) {
    if (!on_) return;
    const auto now = Clock::now();
    time_of(ms_, stage) += std::chrono::duration<double, std::milli>(now - last_).count();
    last_ = now;
  }

 private:
  StageTimes& ms_;
  const bool on_;
  Clock::time_point last_;
};

}  // namespace

void Frame::create(cv::Size size, const Parameters& p, int num_threads) {
  neighbours_ = census_neighbours(p);
  const int planes = (static_cast<int>(neighbours_.size()) + 7) / 8;
  for (Camera* camera : {&left_, &right_}) {
    if (camera->rectified.size() != size) {
      camera->padded.create(size.height + 2 * kMostRadius, size.width + 2 * kBorder);
      camera->padded = kOutside;
      camera->rectified = camera->padded(cv::Rect({kBorder, kMostRadius}, size));
    }
    camera->bits.create(size, planes, padded_range(p.disparity_range));
  }
  distances_.clear();
  const auto pitch = static_cast<std::ptrdiff_t>(left_.padded.step[0]);
  for (const cv::Point& n : neighbours_) distances_.push_back(n.y * pitch + n.x);
  if (disparity_.size() != size) {
    padded_disparity_.create(size.height, size.width + 2 * kBorder);
    padded_disparity_ = kNoDisparity;
    disparity_ = padded_disparity_(cv::Rect({kBorder, 0}, size));
  }
  bands_.resize(static_cast<std::size_t>(num_threads));
  for (Band& band : bands_) {
    band.kept.resize(static_cast<std::size_t>(size.width) + kBorder);
    band.ms = {};
  }
}

void Frame::process(const cv::Mat1b& left_raw, const cv::Mat1b& right_raw,
                    const StereoRectification& rectification, const Parameters& parameters,
                    int num_threads, DisparityFrame& out) {
  const cv::Size size = rectification.geometry.image_size;
  create(size, parameters, num_threads);
  const auto timed = [&](Stage stage, const auto& work) {
    const auto start = Clock::now();
    work();
    time_of(out.ms, stage) = ms_since(start);
  };

  timed(Stage::kRectify, [&] {
    left_.sources.make(rectification.left.mesh, left_raw.size(), left_raw.step[0]);
    right_.sources.make(rectification.right.mesh, right_raw.size(), right_raw.step[0]);
    for_each_band(size.height, num_threads, [&](int, cv::Range rows) {
      for (int y = rows.start; y < rows.end; ++y) {
        left_.sources.rectify(left_raw, y, left_.rectified[y]);
        right_.sources.rectify(right_raw, y, right_.rectified[y]);
      }
    });
  });
  timed(Stage::kCensus, [&] {
    for_each_band(size.height, num_threads, [&](int, cv::Range rows) {
      census(left_, rows);
      census(right_, rows);
    });
  });
  const auto start = Clock::now();
  for_each_band(size.height, num_threads, [&](int band, cv::Range rows) {
    disparity_rows(parameters, rows, bands_[static_cast<std::size_t>(band)]);
  });
  share_time(ms_since(start), out.ms);
  timed(Stage::kSpeckle, [&] {
    if (parameters.speckle_size == 0) return;
    regions_.remove_small(disparity_, parameters.speckle_range * kDisparityScale,
                          parameters.speckle_size);
  });
  out.left = left_.rectified;
  out.right = right_.rectified;
  out.disparity = disparity_;
}

void Frame::census(Camera& camera, cv::Range rows) {
  for (int y = rows.start; y < rows.end; ++y) {
    census_row(camera.rectified[y], camera.rectified.cols, distances_, camera.bits.row(y),
               camera.bits.pitch);
  }
}

/// match, select, check and subpixel, while the row is in the cache.
void Frame::disparity_rows(const Parameters& p, cv::Range rows, Band& band) {
  const int width = disparity_.cols;
  const int factor = uniqueness_factor(p);
  std::uint8_t* kept = band.kept.data();
  band.matcher.start(left_.bits, right_.bits, width, p, static_cast<int>(neighbours_.size()),
                     rows.start);
  for (int y = rows.start; y < rows.end; ++y) {
    Watch watch(band.ms, y % kTimedRows == 0);
    const SelectedRow& s =
        band.matcher.next(watch.on() ? &time_of(band.ms, Stage::kSelect) : nullptr);
    watch.lap(Stage::kMatch);
    check_row(s, width, p.left_right_check, p.disp12MaxDiff, p.uniqueness_check, factor, kept);
    watch.lap(Stage::kCheck);
    subpixel_row(s, kept, width, p.disparity_range, p.subpixel, disparity_[y]);
    watch.lap(Stage::kSubpixel);
  }
}

/// These stages share each row: the wall-clock time is split as that of some rows is.
void Frame::share_time(double wall, StageTimes& ms) const {
  StageTimes sum{};
  for (const Band& band : bands_) {
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += band.ms[i];
  }
  time_of(sum, Stage::kMatch) -= time_of(sum, Stage::kSelect);  // its laps have both
  const double total = std::max(std::accumulate(sum.begin(), sum.end(), 0.0), 1e-9);
  for (const Stage stage : {Stage::kMatch, Stage::kSelect, Stage::kCheck, Stage::kSubpixel}) {
    time_of(ms, stage) = wall * time_of(sum, stage) / total;
  }
}

}  // namespace fpga_stereo::simd
