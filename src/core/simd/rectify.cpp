#include <algorithm>
#include <array>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/simd/rectify.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/rectify_pixels.hpp"
#include "core/simd/kernels.hpp"

HWY_BEFORE_NAMESPACE();
namespace fpga_stereo::simd::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using D32 = hn::CappedTag<std::int32_t, kMeshPitch>;  // a cell of the mesh, or a part of it
using V32 = hn::Vec<D32>;

/// Where the 2 x 2 pixels of some rectified ones are, and their weights.
struct Taps {
  V32 left, top, wx, wy;
};

/// As MeshRow::source, of the pixels x .. x + lanes - 1 of one cell.
HWY_INLINE Taps taps(const cv::Point* columns, int x, int y) {
  const D32 d;
  const int cell = x / kMeshPitch;
  const cv::Point from = columns[cell], to = columns[cell + 1];
  const auto along = hn::Iota(d, x % kMeshPitch);
  const auto half_up = hn::Set(d, 1 << 7);
  const auto moved = [&](int start, int step, V32 at) {
    const auto exact = hn::Add(hn::Set(d, start * kMeshPitch), hn::Mul(hn::Set(d, step), along));
    return hn::Add(at, hn::ShiftRight<8>(hn::Add(exact, half_up)));
  };
  const auto source_x = moved(from.x, to.x - from.x, hn::ShiftLeft<kSourceShift>(hn::Iota(d, x)));
  const auto source_y = moved(from.y, to.y - from.y, hn::Set(d, y * kSourceScale));
  const auto fraction = hn::Set(d, kSourceScale - 1);
  return {hn::ShiftRight<kSourceShift>(source_x), hn::ShiftRight<kSourceShift>(source_y),
          hn::And(source_x, fraction), hn::And(source_y, fraction)};
}

/// Of one channel, from the upper and the lower two pixels: weighted mean, rounded half up.
HWY_INLINE V32 bilinear(const Taps& t, V32 a, V32 b, V32 c, V32 e) {
  const auto upper = hn::Add(hn::ShiftLeft<kSourceShift>(a), hn::Mul(hn::Sub(b, a), t.wx));
  const auto lower = hn::Add(hn::ShiftLeft<kSourceShift>(c), hn::Mul(hn::Sub(e, c), t.wx));
  const auto sum =
      hn::Add(hn::ShiftLeft<kSourceShift>(upper), hn::Mul(hn::Sub(lower, upper), t.wy));
  const auto half = hn::Set(D32(), kSourceScale * kSourceScale / 2);
  return hn::ShiftRight<2 * kSourceShift>(hn::Add(sum, half));
}

/// The pixels of a grey image.
HWY_INLINE V32 grey(const Taps& t, const cv::Mat& raw) {
  const D32 d;
  const auto byte = hn::Set(d, 0xFF);
  const auto pitch = hn::Set(d, static_cast<int>(raw.step[0]));
  const auto upper = hn::Add(hn::Mul(t.top, pitch), t.left);
  const auto* data = reinterpret_cast<const std::int32_t*>(raw.data);
  const auto a = hn::GatherOffset(d, data, upper);
  const auto c = hn::GatherOffset(d, data, hn::Add(upper, pitch));
  return bilinear(t, hn::And(a, byte), hn::And(hn::ShiftRight<8>(a), byte), hn::And(c, byte),
                  hn::And(hn::ShiftRight<8>(c), byte));
}

/// The pixels of a colour image, as blue, green and red bytes of words.
HWY_INLINE V32 color(const Taps& t, const cv::Mat& raw) {
  const D32 d;
  const auto byte = hn::Set(d, 0xFF), three = hn::Set(d, 3);
  const auto pitch = hn::Set(d, static_cast<int>(raw.step[0]));
  const auto upper = hn::Add(hn::Mul(t.top, pitch), hn::Mul(t.left, three));
  const auto lower = hn::Add(upper, pitch);
  const auto* data = reinterpret_cast<const std::int32_t*>(raw.data);
  const auto a = hn::GatherOffset(d, data, upper), c = hn::GatherOffset(d, data, lower);
  const auto b = hn::GatherOffset(d, data, hn::Add(upper, three));
  const auto e = hn::GatherOffset(d, data, hn::Add(lower, three));
  const auto channel = [&](const auto& shifted) {
    return bilinear(t, hn::And(shifted(a), byte), hn::And(shifted(b), byte),
                    hn::And(shifted(c), byte), hn::And(shifted(e), byte));
  };
  const auto blue = channel([](V32 v) { return v; });
  const auto green = channel([](V32 v) { return hn::ShiftRight<8>(v); });
  const auto red = channel([](V32 v) { return hn::ShiftRight<16>(v); });
  return hn::Or(hn::Or(blue, hn::ShiftLeft<8>(green)), hn::ShiftLeft<16>(red));
}

template <int kChannels>
HWY_INLINE void rectify_channels(const cv::Mat& raw, const MeshRow& row, int y, int width,
                                 std::uint8_t* out) {
  const D32 d;
  const hn::Rebind<std::uint8_t, D32> d8;
  const int lanes = static_cast<int>(hn::Lanes(d));
  // Four bytes are read at every pixel, so the last columns are left to the scalar twin.
  const auto end_left = hn::Set(d, raw.cols - 3), end_top = hn::Set(d, raw.rows - 1);
  int x = 0;
  for (; x + lanes <= width; x += lanes) {
    const Taps t = taps(row.columns().data(), x, y);
    const auto least = hn::Min(t.left, t.top);
    const auto inside = hn::And(hn::Gt(least, hn::Set(d, -1)),
                                hn::And(hn::Lt(t.left, end_left), hn::Lt(t.top, end_top)));
    if (HWY_UNLIKELY(!hn::AllTrue(d, inside))) {
      rectify_pixels<kChannels>(raw, row, x, x + lanes, out);
      continue;
    }
    if constexpr (kChannels == 1) {
      hn::StoreU(hn::DemoteTo(d8, grey(t, raw)), d8, out + x);
    } else {
      std::array<std::int32_t, kMeshPitch> pixels;
      hn::StoreU(color(t, raw), d, pixels.data());
      for (int i = 0; i < lanes; ++i) {
        std::memcpy(out + std::ptrdiff_t{3} * (x + i), &pixels[static_cast<std::size_t>(i)], 3);
      }
    }
  }
  rectify_pixels<kChannels>(raw, row, x, width, out);
}

void rectify_row(const cv::Mat& raw, const Mesh& mesh, int y, std::uint8_t* out) {
  const MeshRow row(mesh, y);
  if (raw.channels() == 1) {
    rectify_channels<1>(raw, row, y, mesh.size.width, out);
  } else {
    rectify_channels<3>(raw, row, y, mesh.size.width, out);
  }
}

using D16 = hn::Full128<std::int16_t>;  // a cell
using V16 = hn::Vec<D16>;
using Bytes = hn::Full128<std::uint8_t>;

/// Eight means of two pixels each of one raw row, in 1/32: of the pixels `pairs` says, by wx.
HWY_INLINE V16 means(const std::uint8_t* raw, hn::Vec<Bytes> pairs, V16 wx) {
  const D16 d;
  const hn::RebindToUnsigned<D16> du;
  const auto both = hn::BitCast(d, hn::TableLookupBytes(hn::LoadU(Bytes(), raw), pairs));
  const auto a = hn::And(both, hn::Set(d, 0xFF));
  const auto b = hn::BitCast(d, hn::ShiftRight<8>(hn::BitCast(du, both)));
  return hn::Add(hn::ShiftLeft<kSourceShift>(a), hn::Mul(hn::Sub(b, a), wx));
}

int rectify_cells(const cv::Mat1b& raw, const SourceCell* cells, int count, std::uint8_t* out) {
  const D16 d;
  const hn::Half<Bytes> eight;
  const auto pitch = static_cast<std::ptrdiff_t>(raw.step[0]);
  const auto unpack = [&](const std::uint8_t* from) {
    return hn::PromoteTo(d, hn::LoadU(eight, from));
  };
  int left_out = 0;
  for (int i = 0; i < count; ++i) {
    const SourceCell& cell = cells[i];
    if (HWY_UNLIKELY(cell.offset < 0)) {
      ++left_out;
      continue;
    }
    // Bytes c and c + 1 for each pixel.
    const auto pairs =
        hn::Add(hn::Mul(unpack(cell.column), hn::Set(d, 0x0101)), hn::Set(d, 0x0100));
    const auto wx = unpack(cell.wx), wy = unpack(cell.wy);
    const std::uint8_t* from = raw.data + cell.offset;
    const auto first = means(from, hn::BitCast(Bytes(), pairs), wx);
    const auto middle = means(from + pitch, hn::BitCast(Bytes(), pairs), wx);
    const auto last = means(from + 2 * pitch, hn::BitCast(Bytes(), pairs), wx);
    const auto second = hn::Gt(wy, hn::Set(d, kSecondRow - 1));
    const auto upper = hn::IfThenElse(second, middle, first);
    const auto lower = hn::IfThenElse(second, last, middle);
    // (32 upper + (lower - upper) wy + 512) >> 10, whose inner division by 32 floors as well: the
    // product fits into 16 bits as the high half of 4 (lower - upper) 512 wy. The flag of wy falls
    // off.
    const auto product = hn::MulHigh(hn::ShiftLeft<2>(hn::Sub(lower, upper)), hn::ShiftLeft<9>(wy));
    const auto sum = hn::Add(hn::Add(upper, hn::Set(d, kSourceScale / 2)), product);
    hn::StoreU(hn::DemoteTo(eight, hn::ShiftRight<kSourceShift>(sum)), eight,
               out + std::ptrdiff_t{kMeshPitch} * i);
  }
  return left_out;
}

}  // namespace fpga_stereo::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fpga_stereo::simd {

HWY_EXPORT(rectify_row);
HWY_EXPORT(rectify_cells);

void rectify_row(const cv::Mat& raw, const Mesh& mesh, int y, std::uint8_t* out) {
  HWY_DYNAMIC_DISPATCH(rectify_row)(raw, mesh, y, out);
}

int rectify_cells(const cv::Mat1b& raw, const SourceCell* cells, int count, std::uint8_t* out) {
  return HWY_DYNAMIC_DISPATCH(rectify_cells)(raw, cells, count, out);
}

}  // namespace fpga_stereo::simd
#endif
