#include "support/middlebury.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "fpga_stereo/core/spec.hpp"
#include "support/files.hpp"
#include "support/program.hpp"

namespace fpga_stereo::tools {
namespace {

constexpr int kEvaluated = 255;

/// The error of a pixel, in exact integers.
struct PixelError {
  int units;  // signed
  int scale;  // units per px

  bool is_bad() const { return std::abs(units) > scale; }
  double px() const { return static_cast<double>(units) / scale; }
};

PixelError pixel_error(std::uint16_t disparity, int min_disparity, std::uint8_t truth,
                       int truth_scale) {
  const int units = disparity + kDisparityScale * min_disparity;
  return {units * truth_scale - kDisparityScale * truth, kDisparityScale * truth_scale};
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
double Score::rms_of_good() const {
  const std::int64_t good = valid - bad;
  return good == 0 ? 0 : std::sqrt(squares / static_cast<double>(good));
}

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
      const PixelError error =
          pixel_error(disparity(y, x), min_disparity, pair.truth(y, x), pair.scene.truth_scale);
      if (error.is_bad()) {
        ++score.bad;
      } else {
        score.squares += error.px() * error.px();
      }
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
      const bool bad =
          hole || pixel_error(d, min_disparity, pair.truth(y, x), pair.scene.truth_scale).is_bad();
      picture(y, x) = bad ? kBad : kCorrect;
    }
  }
  return picture;
}

}  // namespace fpga_stereo::tools
