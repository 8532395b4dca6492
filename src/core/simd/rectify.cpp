#include <algorithm>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/simd/rectify.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/rectify_pixels.hpp"
#include "core/simd/stages.hpp"

HWY_BEFORE_NAMESPACE();
namespace fpga_stereo::simd::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr int kColumns = 16, kRows = 3;  // of the raw image that are read for a cell

using D32 = hn::CappedTag<std::int32_t, kMeshPitch>;  // the pixels of a cell, or a part of them
using V32 = hn::Vec<D32>;

struct Source {
  V32 x, y;  // 1/32 px of the raw image
};

/// Computes MeshRow::source for the pixels from x + first on, a lane each, in the cell that starts
/// at column x.
HWY_INLINE Source source(const cv::Point* columns, int x, int y, int first) {
  const D32 d;
  const int cell = x / kMeshPitch;
  const cv::Point from = columns[cell], to = columns[cell + 1];
  const auto along = hn::Iota(d, first);
  const auto half_up = hn::Set(d, 1 << 7);
  const auto moved = [&](int start, int step, V32 at) HWY_ATTR {
    const auto exact = hn::Add(hn::Set(d, start * kMeshPitch), hn::Mul(hn::Set(d, step), along));
    return hn::Add(at, hn::ShiftRight<8>(hn::Add(exact, half_up)));
  };
  const auto column = hn::ShiftLeft<kSourceShift>(hn::Iota(d, x + first));
  return {moved(from.x, to.x - from.x, column),
          moved(from.y, to.y - from.y, hn::Set(d, y * kSourceScale))};
}

/// Computes the source cells of a row of the rectified image.
void source_cells(const cv::Point* columns, int y, int count, cv::Size raw, SourceCell* cells) {
  const D32 d;
  const hn::Rebind<std::uint8_t, D32> bytes;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const auto fraction = hn::Set(d, kSourceScale - 1);
  for (int i = 0; i < count; ++i) {
    SourceCell& cell = cells[i];
    const int x = i * kMeshPitch;
    auto least_x = hn::Set(d, raw.width << kSourceShift);
    auto least_y = hn::Set(d, raw.height << kSourceShift);
    for (int first = 0; first < kMeshPitch; first += lanes) {
      const Source s = source(columns, x, y, first);
      least_x = hn::Min(least_x, s.x);
      least_y = hn::Min(least_y, s.y);
    }
    const auto left = hn::ShiftRight<kSourceShift>(hn::MinOfLanes(d, least_x));
    const auto top = hn::ShiftRight<kSourceShift>(hn::MinOfLanes(d, least_y));
    const int raw_x = hn::GetLane(left), raw_y = hn::GetLane(top);
    cell.x = kScattered;
    if (raw_x < 0 || raw_y < 0 || raw_x + kColumns > raw.width || raw_y + kRows > raw.height) {
      continue;
    }
    bool is_near = true;
    for (int first = 0; first < kMeshPitch; first += lanes) {
      const Source s = source(columns, x, y, first);
      const auto column = hn::Sub(hn::ShiftRight<kSourceShift>(s.x), left);
      const auto row = hn::Sub(hn::ShiftRight<kSourceShift>(s.y), top);
      is_near = is_near && hn::AllTrue(d, hn::And(hn::Lt(column, hn::Set(d, kColumns - 1)),
                                                  hn::Lt(row, hn::Set(d, kRows - 1))));
      const auto second_row =
          hn::IfThenElseZero(hn::Gt(row, hn::Zero(d)), hn::Set(d, int{kSecondRow}));
      hn::StoreU(hn::DemoteTo(bytes, column), bytes, cell.column + first);
      hn::StoreU(hn::DemoteTo(bytes, hn::And(s.x, fraction)), bytes, cell.wx + first);
      hn::StoreU(hn::DemoteTo(bytes, hn::Or(hn::And(s.y, fraction), second_row)), bytes,
                 cell.wy + first);
    }
    if (!is_near) continue;
    cell.x = static_cast<std::int16_t>(raw_x);
    cell.y = static_cast<std::int16_t>(raw_y);
  }
}

using D16 = hn::Full128<std::int16_t>;  // the pixels of a cell
using V16 = hn::Vec<D16>;
using Bytes = hn::Full128<std::uint8_t>;  // kColumns pixels of a raw row
using VBytes = hn::Vec<Bytes>;
using CellBytes = hn::Half<Bytes>;

/// The weights of a cell, unpacked.
struct Weights {
  VBytes pairs;  // the bytes of both columns that each pixel reads
  V16 wx, wy;

  HWY_INLINE explicit Weights(const SourceCell& cell) {
    const D16 d;
    const auto unpack = [&](const std::uint8_t* from)
                            HWY_ATTR { return hn::PromoteTo(d, hn::LoadU(CellBytes(), from)); };
    const auto columns = hn::Mul(unpack(cell.column), hn::Set(d, 0x0101));
    pairs = hn::BitCast(Bytes(), hn::Add(columns, hn::Set(d, 0x0100)));
    wx = unpack(cell.wx);
    wy = unpack(cell.wy);
  }
};

/// Interpolates between the columns of a raw row. Returns eight values in 1/32.
HWY_INLINE V16 interpolate_columns(VBytes raw, const Weights& w) {
  const D16 d;
  const hn::RebindToUnsigned<D16> du;
  const auto both = hn::BitCast(d, hn::TableLookupBytes(raw, w.pairs));
  const auto a = hn::And(both, hn::Set(d, 0xFF));
  const auto b = hn::BitCast(d, hn::ShiftRight<8>(hn::BitCast(du, both)));
  return hn::Add(hn::ShiftLeft<kSourceShift>(a), hn::Mul(hn::Sub(b, a), w.wx));
}

/// Computes one channel of a cell from its kRows raw rows.
HWY_INLINE hn::Vec<CellBytes> interpolate(VBytes row0, VBytes row1, VBytes row2, const Weights& w) {
  const D16 d;
  const auto first = interpolate_columns(row0, w);
  const auto middle = interpolate_columns(row1, w);
  const auto last = interpolate_columns(row2, w);
  const auto second_row = hn::Gt(w.wy, hn::Set(d, kSecondRow - 1));
  const auto upper = hn::IfThenElse(second_row, middle, first);
  const auto lower = hn::IfThenElse(second_row, last, middle);
  // The result is (32 upper + (lower - upper) wy + 512) >> 10. Dividing by 32 first does not change
  // it, because both divisions round down: (upper + ((lower - upper) wy >> 5) + 16) >> 5. The high
  // half of 4 (lower - upper) 512 wy is the inner shift. Shifting wy left drops kSecondRow.
  const auto product = hn::MulHigh(hn::ShiftLeft<2>(hn::Sub(lower, upper)), hn::ShiftLeft<9>(w.wy));
  const auto sum = hn::Add(hn::Add(upper, hn::Set(d, kSourceScale / 2)), product);
  return hn::DemoteTo(CellBytes(), hn::ShiftRight<kSourceShift>(sum));
}

template <int kChannels>
HWY_INLINE void rectify_cell(const std::uint8_t* raw, std::ptrdiff_t pitch, const Weights& w,
                             std::uint8_t* out) {
  const Bytes d;
  if constexpr (kChannels == 1) {
    const auto row0 = hn::LoadU(d, raw), row1 = hn::LoadU(d, raw + pitch);
    hn::StoreU(interpolate(row0, row1, hn::LoadU(d, raw + 2 * pitch), w), CellBytes(), out);
  } else {
    VBytes blue0, blue1, blue2, green0, green1, green2, red0, red1, red2;
    hn::LoadInterleaved3(d, raw, blue0, green0, red0);
    hn::LoadInterleaved3(d, raw + pitch, blue1, green1, red1);
    hn::LoadInterleaved3(d, raw + 2 * pitch, blue2, green2, red2);
    hn::StoreInterleaved3(interpolate(blue0, blue1, blue2, w),
                          interpolate(green0, green1, green2, w), interpolate(red0, red1, red2, w),
                          CellBytes(), out);
  }
}

/// Rectifies the cells of a row that are not scattered. Returns the number of scattered cells.
template <int kChannels>
HWY_INLINE int rectify_channels(const cv::Mat& raw, const SourceCell* cells, int count,
                                std::uint8_t* out) {
  const auto pitch = static_cast<std::ptrdiff_t>(raw.step[0]);
  int scattered = 0;
  for (int i = 0; i < count; ++i, out += std::ptrdiff_t{kMeshPitch} * kChannels) {
    const SourceCell& cell = cells[i];
    if (HWY_UNLIKELY(cell.x == kScattered)) {
      ++scattered;
      continue;
    }
    const std::uint8_t* first = raw.data + cell.y * pitch + std::ptrdiff_t{cell.x} * kChannels;
    rectify_cell<kChannels>(first, pitch, Weights(cell), out);
  }
  return scattered;
}

int rectify_cells(const cv::Mat& raw, const SourceCell* cells, int count, std::uint8_t* out) {
  return raw.channels() == 1 ? rectify_channels<1>(raw, cells, count, out)
                             : rectify_channels<3>(raw, cells, count, out);
}

}  // namespace fpga_stereo::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fpga_stereo::simd {
namespace {

HWY_EXPORT(source_cells);
HWY_EXPORT(rectify_cells);

bool is_equal(const Mesh& a, const Mesh& b) {
  if (a.size != b.size || a.nodes.size() != b.nodes.size()) return false;
  const std::size_t bytes = static_cast<std::size_t>(a.nodes.cols) * a.nodes.elemSize();
  for (int y = 0; y < a.nodes.rows; ++y) {
    if (std::memcmp(a.nodes[y], b.nodes[y], bytes) != 0) return false;
  }
  return true;
}

int cells_per_row(const Mesh& mesh) { return mesh.size.width / kMeshPitch; }

/// Rectifies a row: most cells by SIMD; scattered cells and the pixels after the last whole cell by
/// scalar code.
void rectify_row(const cv::Mat& raw, const SourceCell* cells, const Mesh& mesh, int y,
                 std::uint8_t* out) {
  const int count = cells_per_row(mesh);
  const int scattered = HWY_DYNAMIC_DISPATCH(rectify_cells)(raw, cells, count, out);
  const int end = count * kMeshPitch;
  if (scattered == 0 && end == mesh.size.width) return;
  const MeshRow row(mesh, y);
  const auto rectify_scalar = [&](int x0, int x1) {
    raw.channels() == 1 ? rectify_pixels<1>(raw, row, x0, x1, out)
                        : rectify_pixels<3>(raw, row, x0, x1, out);
  };
  for (int i = 0; scattered > 0 && i < count; ++i) {
    if (cells[i].x == kScattered) rectify_scalar(i * kMeshPitch, (i + 1) * kMeshPitch);
  }
  rectify_scalar(end, mesh.size.width);
}

}  // namespace

void SourceTable::create(const Mesh& mesh, cv::Size raw) {
  if (raw == raw_ && is_equal(mesh, mesh_)) return;
  mesh_ = {mesh.size, mesh.nodes.clone()};
  raw_ = raw;
  const int count = cells_per_row(mesh);
  cells_.resize(static_cast<std::size_t>(count) * mesh.size.height);
  for (int y = 0; y < mesh.size.height; ++y) {
    SourceCell* cells = cells_.data() + static_cast<std::ptrdiff_t>(y) * count;
    const MeshRow row(mesh, y);
    HWY_DYNAMIC_DISPATCH(source_cells)(row.columns().data(), y, count, raw, cells);
  }
}

const SourceCell* SourceTable::row(int y) const {
  return cells_.data() + static_cast<std::ptrdiff_t>(y) * cells_per_row(mesh_);
}

void rectify(const cv::Mat& raw, const SourceTable& sources, cv::Range rows, cv::Mat& rectified) {
  for (int y = rows.start; y < rows.end; ++y) {
    rectify_row(raw, sources.row(y), sources.mesh(), y, rectified.ptr(y));
  }
}

void rectify(const cv::Mat& raw, const Mesh& mesh, cv::Range rows, cv::Mat& rectified) {
  const int count = cells_per_row(mesh);
  std::vector<SourceCell> cells(static_cast<std::size_t>(count));
  for (int y = rows.start; y < rows.end; ++y) {
    const MeshRow row(mesh, y);
    HWY_DYNAMIC_DISPATCH(source_cells)(row.columns().data(), y, count, raw.size(), cells.data());
    rectify_row(raw, cells.data(), mesh, y, rectified.ptr(y));
  }
}

}  // namespace fpga_stereo::simd
#endif
