// Exact comparison of images. A mismatch reports stage, pixel, both values, parameters and seed.
#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <opencv2/core.hpp>
#include <sstream>
#include <string>

#include "core/stages.hpp"
#include "fpga_stereo/core/parameters.hpp"

namespace fpga_stereo::test {

/// The circumstances of a comparison, which a mismatch reports.
struct Case {
  Parameters parameters;
  unsigned seed = 0;
  std::string about;
};

inline std::ostream& operator<<(std::ostream& out, const Case& c) {
  out << c.about << ", seed " << c.seed;
  for (const ParameterInfo& info : parameter_table()) {
    out << ", " << info.name << " " << to_text(c.parameters, info);
  }
  return out;
}

inline std::string values_at(const cv::Mat& image, int x, int y) {
  const cv::Mat pixel = image(cv::Rect(x, y, 1, 1)).clone();
  std::ostringstream text;
  text << pixel.reshape(1);
  return text.str();
}

/// Succeeds if size, type and pixels are equal. A failure reports the first difference in raster
/// order.
inline ::testing::AssertionResult same(const std::string& stage, const cv::Mat& expected,
                                       const cv::Mat& actual, const Case& c = {}) {
  if (expected.size() != actual.size() || expected.type() != actual.type()) {
    return ::testing::AssertionFailure()
           << stage << ": expected " << expected.size() << " of type " << expected.type()
           << ", got " << actual.size() << " of type " << actual.type() << "; " << c;
  }
  const std::size_t pixel = expected.elemSize();
  for (int y = 0; y < expected.rows; ++y) {
    if (std::memcmp(expected.ptr(y), actual.ptr(y), pixel * expected.cols) == 0) continue;
    int x = 0;
    while (std::memcmp(expected.ptr(y, x), actual.ptr(y, x), pixel) == 0) ++x;
    return ::testing::AssertionFailure()
           << stage << " at x " << x << ", y " << y << ": expected " << values_at(expected, x, y)
           << ", got " << values_at(actual, x, y) << "; " << c;
  }
  return ::testing::AssertionSuccess();
}

inline ::testing::AssertionResult same(const std::string& stage, const Selection& expected,
                                       const Selection& actual, const Case& c = {}) {
  auto result = same(stage + " winner", expected.winner, actual.winner, c);
  if (result) result = same(stage + " right_winner", expected.right_winner, actual.right_winner, c);
  if (result) result = same(stage + " winner_sum", expected.winner_sum, actual.winner_sum, c);
  if (result)
    result = same(stage + " runner_up_sum", expected.runner_up_sum, actual.runner_up_sum, c);
  if (result) result = same(stage + " around", expected.around, actual.around, c);
  return result;
}

}  // namespace fpga_stereo::test
