// The data path on one screen: one function per stage, in data order. fpga_fw/spec/pipeline.md
// defines what each computes, bit for bit. These functions implement that definition and are
// normative.
//
//   rectify -> census -> match -------------> select -> check -> subpixel -> speckle
//                    `-> cost -> aggregate -'                      (dense) -> fill -> median
//
// Images are W x H with any row pitch. A stage writes only the rows it is given (cv::Range::all() =
// the whole image). It creates its output if the size or type differs, so bands of rows may run in
// parallel once the output exists. Disparities d run from 0 to disparity_range - 1.
#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "fpga_stereo/core/mesh.hpp"
#include "fpga_stereo/core/parameters.hpp"
#include "fpga_stereo/core/spec.hpp"

namespace fpga_stereo {

/// The output of select, by left pixel; right_winner is by right pixel.
struct Selection {
  cv::Mat1b winner;                            // dL, the disparity with the smallest sum
  cv::Mat1b right_winner;                      // dR
  cv::Mat1w winner_sum;                        // v1 = S(dL)
  cv::Mat1w runner_up_sum;                     // v2, the smallest sum outside dL-1, dL, dL+1
  cv::Mat_<cv::Vec<std::uint16_t, 5>> around;  // S(dL-2) .. S(dL+2); 0 outside the search range
};

/// raw (8UC1 or 8UC3) -> rectified, with the size of the mesh.
void rectify(const cv::Mat& raw, const Mesh& mesh, cv::Range rows, cv::Mat& rectified);

/// image -> bits, 32SC(n): neighbour k in raster order is bit k % 32 of channel k / 32.
void census(const cv::Mat1b& image, const Parameters& p, cv::Range rows, cv::Mat& bits);

/// Census images -> window sums S(x, y, d), a row at a time from running sums.
class Match {
 public:
  /// Prepares the rows from `first_row` down. Keeps references to the images.
  void start(const cv::Mat& left_bits, const cv::Mat& right_bits, const Parameters& p,
             int first_row);
  /// Returns S of the next row: disparity_range x W. Valid until the next call.
  const cv::Mat1w& next();

 private:
  void hamming(int y, cv::Mat1b& row) const;

  cv::Mat left_, right_;            // census bits
  int half_ = 0;                    // of the census bits: h outside the right image
  int radius_ = 0;                  // of the correlation window
  int first_summed_ = 0, row_ = 0;  // image rows
  std::vector<cv::Mat1b> hamming_;  // per row of the window, D x W
  cv::Mat1w columns_, sums_;        // D x W
};

/// Rectified images and census bits -> matching costs C(x, y, d), a row at a time.
class Cost {
 public:
  /// Prepares the rows from `first_row` down. Keeps references to the census bits.
  void start(const cv::Mat1b& left, const cv::Mat1b& right, const cv::Mat& left_bits,
             const cv::Mat& right_bits, const Parameters& p, int first_row);
  /// Returns C of the next row, 0 .. kSgmMaxCost: disparity_range x W. Valid until the next call.
  const cv::Mat1b& next();

 private:
  void pixel_cost(int y);

  cv::Mat left_bits_, right_bits_;
  cv::Mat1b left_, right_;  // smoothed along the row
  Parameters parameters_;
  int row_ = 0;
  std::array<cv::Mat1w, 3> pixel_costs_;  // of rows y - 1, y, y + 1: D x W, at (y + 3) % 3
  cv::Mat1b costs_;                       // D x W
};

/// Matching costs -> sums of path costs S(x, y, d). Rows must come in order, from the first one.
class Aggregate {
 public:
  /// `left` is the rectified image, whose edges set the penalties.
  void start(const cv::Mat1b& left, const Parameters& p);
  /// Takes C of the next row; returns its S: disparity_range x W. Valid until the next call.
  const cv::Mat1w& next(const cv::Mat1b& costs);

 private:
  int p2(int x0, int y0, int x1, int y1) const;
  void horizontal_path(const cv::Mat1b& costs, int first, int step);
  void vertical_paths(const cv::Mat1b& costs);

  cv::Mat1b guide_;  // left image, smoothed
  Parameters parameters_;
  int row_ = 0;
  cv::Mat1b up_;            // N of the row above: W x D
  cv::Mat1w sums_;          // W x D
  cv::Mat1w by_disparity_;  // D x W
};

/// S of row y -> winner, right winner, runner-up and neighbours of row y. `out` is W x H.
void select(const cv::Mat1w& sums, int y, Selection& out);
/// Creates the images of `out` for an image size.
void create(Selection& out, cv::Size size);

/// Left-right check and, unless `dense`, uniqueness check -> kept, 1 where a pixel passes, else 0.
void check(const Selection& s, const Parameters& p, cv::Range rows, cv::Mat1b& kept);

/// Parabola through five sums -> disparity in 1/32 px, kNoDisparity where not kept.
void subpixel(const Selection& s, const cv::Mat1b& kept, const Parameters& p, cv::Range rows,
              cv::Mat1w& disparity);

/// Fit to the census bits around a pixel -> disparity in 1/32 px, kNoDisparity where not kept. This
/// is subpixel for semi-global matching, whose sums carry no fraction.
void fit_subpixel(const cv::Mat& left_bits, const cv::Mat& right_bits, const Selection& s,
                  const cv::Mat1b& kept, const Parameters& p, cv::Range rows, cv::Mat1w& disparity);

/// Small regions of `disparity` become kNoDisparity; in place, the whole image.
void speckle(const Parameters& p, cv::Mat1w& disparity);

/// Pixels without a disparity take the smaller of the nearest ones to the left and right; in place.
void fill(cv::Range rows, cv::Mat1w& disparity);

/// Median over pixels whose grey in the rectified image `left` is similar.
void masked_median(const cv::Mat1b& left, const cv::Mat1w& in, const Parameters& p, cv::Range rows,
                   cv::Mat1w& out);
/// Median of the square of radius kMedianRadius. Together they are the stage median.
void median(const cv::Mat1w& in, cv::Range rows, cv::Mat1w& out);

}  // namespace fpga_stereo
