// A second model of the pipeline, written from fpga_fw/spec/pipeline.md alone and as simply as
// possible: no running sums, no tables, no early exits. Only fast enough for tests.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "core/stages.hpp"
#include "fpga_stereo/core/mesh.hpp"
#include "fpga_stereo/core/parameters.hpp"

namespace fpga_stereo::naive {

/// S(x, y, d) of a whole image; [y] is disparity_range x W.
using Sums = std::vector<cv::Mat1i>;

/// Returns the source of rectified pixel (x, y) in 1/32 px.
cv::Point source(const Mesh& mesh, int x, int y);

/// 8UC1 or 8UC3; taps outside the raw image are 0.
cv::Mat rectify(const cv::Mat& raw, const Mesh& mesh);

/// Returns the census bits of a pixel, in raster order.
std::vector<int> census_bits(const cv::Mat1b& image, const Parameters& p, int x, int y);

/// Returns the census bits of every pixel, packed as the stage does: bit k % 32 of channel k / 32.
cv::Mat census(const cv::Mat1b& image, const Parameters& p);

/// Returns h(x, y, d) for packed census images of `bits` bits.
int hamming(const cv::Mat& left, const cv::Mat& right, int bits, int x, int y, int d);

/// Returns all window sums, each added up on its own.
Sums match(const cv::Mat& left, const cv::Mat& right, const Parameters& p);

/// Returns the matching costs C of semi-global matching.
Sums cost(const cv::Mat1b& left, const cv::Mat1b& right, const cv::Mat& left_bits,
          const cv::Mat& right_bits, const Parameters& p);

struct Path {
  cv::Mat1i costs;          // L(n, d), D x W
  std::vector<int> minima;  // M(n)
};
/// Returns the path from the left through the costs of a row, D x W. p2[n] belongs to the pixels
/// n - 1 and n.
Path path_from_left(const cv::Mat1i& costs, const std::vector<int>& p2, int p1);

/// Returns the sums of path costs S of semi-global matching. `left` is the rectified image.
Sums aggregate(const cv::Mat1b& left, const Sums& costs, const Parameters& p);

Selection select(const Sums& sums);

cv::Mat1b check(const Selection& s, const Parameters& p);

/// Returns the vertex of the parabola through five sums in 1/32 px, clamped and rounded.
/// numerator / denominator is the factor of num / den; 7 / 10 gives the vertex.
int parabola_offset(const cv::Vec<std::uint16_t, 5>& sums, int numerator = 7, int denominator = 10);

cv::Mat1w subpixel(const Selection& s, const cv::Mat1b& kept, const Parameters& p);

/// The same for semi-global matching.
cv::Mat1w fit_subpixel(const cv::Mat& left_bits, const cv::Mat& right_bits, const Selection& s,
                       const cv::Mat1b& kept, const Parameters& p);

cv::Mat1w speckle(const cv::Mat1w& disparity, const Parameters& p);

cv::Mat1w fill(const cv::Mat1w& disparity);

/// The two medians of the stage median.
cv::Mat1w masked_median(const cv::Mat1b& left, const cv::Mat1w& disparity, const Parameters& p);
cv::Mat1w median(const cv::Mat1w& disparity);

}  // namespace fpga_stereo::naive
