#include "support/middlebury.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "core/stages.hpp"
#include "support/files.hpp"
#include "support/program.hpp"

namespace fpga_stereo::tools {
namespace {

constexpr int kEvaluated = 255;

/// Returns whether the error is above 1.0 px, computed in exact integers.
bool is_bad(std::uint16_t disparity, int min_disparity, std::uint8_t truth, int truth_scale) {
  const int units = disparity + kDisparityScale * min_disparity;
  return std::abs(units * truth_scale - kDisparityScale * truth) > kDisparityScale * truth_scale;
}

double percent(std::int64_t part, std::int64_t whole) {
  return whole == 0 ? 0 : 100.0 * static_cast<double>(part) / static_cast<double>(whole);
}

void require_size(const std::string& path, const cv::Mat1b& image, cv::Size expected) {
  if (image.size() == expected) return;
  throw std::runtime_error(fmt::format("{}: is {}x{}: imL.png is {}x{}", path, image.cols,
                                       image.rows, expected.width, expected.height));
}

}  // namespace

MiddleburyPair read_pair(const std::string& folder, const MiddleburyScene& scene) {
  namespace fs = std::filesystem;
  const fs::path at = fs::path(folder) / scene.name;
  if (!fs::is_directory(at)) {
    throw std::runtime_error(
        fmt::format("{}: there is no such folder; a Middlebury v2 folder holds tsukuba, venus, "
                    "teddy and cones",
                    at.string()));
  }
  MiddleburyPair pair;
  pair.scene = scene;
  pair.left = read_grey((at / "imL.png").string());
  const auto read = [&](const std::string& name, auto reader) {
    const std::string path = (at / (name + ".png")).string();
    cv::Mat1b image = reader(path);
    require_size(path, image, pair.left.size());
    return image;
  };
  pair.right = read("imR", read_grey);
  pair.truth = read("groundtruth", read_first_channel);
  for (std::size_t i = 0; i < kRegionNames.size(); ++i) {
    pair.masks[i] = read(kRegionNames[i], read_first_channel);
  }
  return pair;
}

double Score::bad_of_all() const { return percent(bad + evaluated - valid, evaluated); }
double Score::bad_of_valid() const { return percent(bad, valid); }
double Score::coverage() const { return percent(valid, evaluated); }

Score score(const MiddleburyPair& pair, Region region, const cv::Mat1w& disparity,
            int min_disparity) {
  const cv::Mat1b& mask = pair.masks[region];
  Score score;
  for (int y = 0; y < mask.rows; ++y) {
    for (int x = 0; x < mask.cols; ++x) {
      if (mask(y, x) != kEvaluated) continue;
      ++score.evaluated;
      if (disparity(y, x) == kNoDisparity) continue;
      ++score.valid;
      score.bad += is_bad(disparity(y, x), min_disparity, pair.truth(y, x), pair.scene.truth_scale);
    }
  }
  return score;
}

cv::Mat1b error_picture(const MiddleburyPair& pair, Region region, const cv::Mat1w& disparity,
                        int min_disparity, bool holes_count) {
  constexpr std::uint8_t kCorrect = 0, kNotEvaluated = 128, kBad = 255;
  const cv::Mat1b& mask = pair.masks[region];
  cv::Mat1b picture(mask.size(), kNotEvaluated);
  for (int y = 0; y < mask.rows; ++y) {
    for (int x = 0; x < mask.cols; ++x) {
      const std::uint16_t d = disparity(y, x);
      const bool hole = d == kNoDisparity;
      if (mask(y, x) != kEvaluated || (hole && !holes_count)) continue;
      const bool bad = hole || is_bad(d, min_disparity, pair.truth(y, x), pair.scene.truth_scale);
      picture(y, x) = bad ? kBad : kCorrect;
    }
  }
  return picture;
}

cv::Mat1w fill_holes(const cv::Mat1w& disparity) {
  cv::Mat1w filled = disparity.clone();
  for (int y = 0; y < filled.rows; ++y) {
    // kNoDisparity is the largest value, so min() prefers a disparity.
    static_assert(kNoDisparity == 0xFFFF);
    std::uint16_t nearest = kNoDisparity;
    for (int x = 0; x < filled.cols; ++x) {
      if (disparity(y, x) != kNoDisparity) nearest = disparity(y, x);
      filled(y, x) = nearest;
    }
    nearest = kNoDisparity;
    for (int x = filled.cols - 1; x >= 0; --x) {
      if (disparity(y, x) != kNoDisparity) nearest = disparity(y, x);
      filled(y, x) = std::min(filled(y, x), nearest);
    }
  }
  return filled;
}

}  // namespace fpga_stereo::tools
