// The SIMD data path on one screen, in data order. Each stage computes the same bits as its scalar
// twin in core/stages.hpp, with the instructions of target(). Pipeline (pipeline.hpp) runs them.
//
//   rectify -> census -> match -------------> select -> check -> subpixel -> speckle
//                    `-> cost -> aggregate -'                      (dense) -> fill -> median
//
// rectify, census, speckle, fill and median process rows of images. match and its select process
// kBlockColumns columns of a row at a time, so that window sums stay in the L1 cache; the others
// process a row. layout.hpp has the types that stages pass to each other.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

#include "core/simd/aggregate.hpp"
#include "core/simd/cost.hpp"
#include "core/simd/fit.hpp"
#include "core/simd/layout.hpp"
#include "core/simd/match.hpp"
#include "core/simd/median.hpp"
#include "core/simd/rectify.hpp"
#include "core/simd/smooth.hpp"
#include "core/simd/speckle.hpp"
#include "fpga_stereo/core/parameters.hpp"

namespace fpga_stereo::simd {

/// raw (8UC1 or 8UC3) -> rectified, which must have its size and type. SourceTable holds what the
/// stage computes from a mesh once; with a Mesh, it is computed for every row.
void rectify(const cv::Mat& raw, const SourceTable& sources, cv::Range rows, cv::Mat& rectified);
void rectify(const cv::Mat& raw, const Mesh& mesh, cv::Range rows, cv::Mat& rectified);

/// image -> census bits; `bits` must have been created.
void census(const CensusImage& image, const Parameters& p, cv::Range rows, CensusPlanes& bits);

// match: class Match (match.hpp): census bits -> window sums, block by block.

// cost: class Cost (cost.hpp): census bits and smoothed grey values (smooth.hpp) -> matching costs.
// aggregate: classes VerticalPaths and HorizontalPaths (aggregate.hpp): matching costs -> sums.

/// Window sums of a block -> the winners, runners-up and neighbours of its pixels, and the right
/// winners of the pixels whose left partners are all known by now. The blocks of a row must come in
/// order.
void select(const WindowSums& sums, const SelectionRow& out);
/// Does the same for the sums of a row of semi-global matching, but for the neighbours.
void select(const PathSums& sums, const SelectionRow& out);

/// Left-right check and uniqueness check -> kept, 1 where a pixel passes, else 0. `kept` has
/// kBorder elements behind the row.
void check(const SelectionRow& s, const Parameters& p, std::uint8_t* kept);

/// Parabola through five sums -> disparity in 1/32 px, kNoDisparity where not kept. `disparity` has
/// kBorder elements behind the row.
void subpixel(const SelectionRow& s, const std::uint8_t* kept, const Parameters& p,
              std::uint16_t* disparity);

// subpixel for semi-global matching: class Fit (fit.hpp).

// speckle: class SpeckleFilter (speckle.hpp): small regions become kNoDisparity, in place.

// fill: fpga_stereo::fill() (core/stages.hpp), which takes little time as it is.

// median: masked_median() and median() (median.hpp).

}  // namespace fpga_stereo::simd
