// rectify: a table of the sources of rectified pixels, laid out for fast access.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "fpga_stereo/core/mesh.hpp"

namespace fpga_stereo::simd {

/// The sources of the eight rectified pixels of one mesh cell. Maps are smooth, so these lie within
/// 16 columns and 3 rows of the raw image, of which each pixel reads 2 x 2. A scattered cell is one
/// for which this does not hold, or which reads outside the raw image.
struct SourceCell {
  std::int16_t x, y;                // top left pixel of these; x = kScattered for scattered cells
  std::uint8_t column[kMeshPitch];  // left column that a pixel reads, 0 .. 14 from x
  std::uint8_t wx[kMeshPitch];      // weight of the right column, 1/32
  std::uint8_t wy[kMeshPitch];      // weight of the lower row, 1/32; see kSecondRow
};
constexpr std::int16_t kScattered = -1;
/// Flag in wy: the pixel reads the second and third row, not the first and second.
constexpr std::uint8_t kSecondRow = 0x80;

/// The source cells of an image, for a mesh and a raw image size that many frames share.
class SourceTable {
 public:
  /// Computes the cells. Does nothing if mesh and size are those of the previous call.
  void create(const Mesh& mesh, cv::Size raw);

  const Mesh& mesh() const { return mesh_; }
  /// The width / 8 cells of row `y`; pixels to the right of the last whole cell have none.
  const SourceCell* row(int y) const;

 private:
  Mesh mesh_;
  cv::Size raw_;
  std::vector<SourceCell> cells_;
};

}  // namespace fpga_stereo::simd
