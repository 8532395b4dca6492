// Where the pixels of a rectified image come from, in the form in which they are fetched fastest:
// made once per calibration.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "fpga_stereo/core/mesh.hpp"

namespace fpga_stereo::simd {

/// Eight rectified pixels of one cell of the mesh. Maps are smooth: their sources lie in 16 columns
/// of three rows, of which each pixel reads two.
struct SourceCell {
  std::int32_t offset;              // of the first byte, in the raw image; < 0: they do not
  std::uint8_t column[kMeshPitch];  // from there, 0 .. 14
  std::uint8_t wx[kMeshPitch];      // 1/32 px
  std::uint8_t wy[kMeshPitch];      // 1/32 px, + kSecondRow where the first row is not read
};
constexpr std::uint8_t kSecondRow = 0x80;

class SourceTable {
 public:
  /// For raw images of this size and row pitch; does nothing where it is made for them already.
  void make(const Mesh& mesh, cv::Size raw, std::size_t pitch);

  /// Row y of the rectified image; 8UC1. `out` has room for the row alone.
  void rectify(const cv::Mat1b& raw, int y, std::uint8_t* out) const;

 private:
  SourceCell make_cell(const MeshRow& row, int x) const;

  Mesh mesh_;
  cv::Size raw_;
  std::size_t pitch_ = 0;
  int cells_ = 0;  // of a row, without the last one if that is not full
  std::vector<SourceCell> table_;
};

}  // namespace fpga_stereo::simd
