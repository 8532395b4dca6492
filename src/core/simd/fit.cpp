#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/simd/fit.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/simd/fit.hpp"
#include "core/simd/lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace fpga_stereo::simd::HWY_NAMESPACE {

void interleave_planes(const std::uint8_t* plane, std::ptrdiff_t plane_pitch, int width,
                       std::uint16_t* bits) {
  const Block8 d;
  const hn::Repartition<std::uint16_t, Block8> words;
  const int step = static_cast<int>(hn::Lanes(d));
  for (int x = 0; x < width; x += step) {
    const auto low = hn::LoadU(d, plane + x), high = hn::LoadU(d, plane + plane_pitch + x);
    hn::StoreU(hn::BitCast(words, hn::InterleaveLower(d, low, high)), words, bits + x);
    hn::StoreU(hn::BitCast(words, hn::InterleaveUpper(d, low, high)), words, bits + x + step / 2);
  }
}

using BlockWords = hn::Repartition<std::uint16_t, Block8>;

/// Returns the distances of pixel `x` as words in descending order of the disparity, 8 of which 5
/// count. `right` points to the pixel that disparity 0 compares it with.
HWY_INLINE hn::Vec<BlockWords> pixel_distances(std::uint16_t left, const std::uint16_t* right,
                                               int winner) {
  const BlockWords words;
  const auto differing = hn::Xor(hn::Set(words, left), hn::LoadU(words, right - winner - 2));
  const auto counts = hn::BitCast(words, hn::PopulationCount(hn::BitCast(Block8(), differing)));
  return hn::Add(hn::And(counts, hn::Set(words, std::uint16_t{0xFF})), hn::ShiftRight<8>(counts));
}

/// Computes the distances of 16 pixels. Interleaving pixels that are 8, 4, 2 and 1 apart brings the
/// values of each disparity together.
HWY_INLINE void distances_of_16(const std::uint16_t* left, const std::uint16_t* right,
                                const std::uint8_t* winner, const std::uint8_t* kept, int x,
                                std::uint8_t* const out[5]) {
  const Block8 d;
  const auto pair = [&](int i) HWY_ATTR {  // pixels i and i + 8, interleaved
    const int a = x + i, b = x + i + 8;
    const auto low = pixel_distances(left[a], right + a, winner[a]);
    const auto high = pixel_distances(left[b], right + b, winner[b]);
    return hn::BitCast(d, hn::Or(low, hn::ShiftLeft<8>(high)));
  };
  const auto low = [&](VBlock8 a, VBlock8 b) HWY_ATTR { return hn::InterleaveLower(d, a, b); };
  const auto high = [&](VBlock8 a, VBlock8 b) HWY_ATTR { return hn::InterleaveUpper(d, a, b); };
  const VBlock8 p0 = pair(0), p1 = pair(1), p2 = pair(2), p3 = pair(3), p4 = pair(4), p5 = pair(5),
                p6 = pair(6), p7 = pair(7);
  const VBlock8 p04 = low(p0, p4), p26 = low(p2, p6), p15 = low(p1, p5), p37 = low(p3, p7);
  const VBlock8 even = low(p04, p26), even_next = high(p04, p26);
  const VBlock8 odd = low(p15, p37), odd_next = high(p15, p37);
  const VBlock8 even_last = low(high(p0, p4), high(p2, p6));
  const VBlock8 odd_last = low(high(p1, p5), high(p3, p7));
  const VBlock8 mask = hn::Sub(hn::Zero(d), hn::LoadU(d, kept + x));
  const auto store = [&](VBlock8 v, int k)
                         HWY_ATTR { hn::StoreU(hn::And(v, mask), d, out[k] + x); };
  store(low(even, odd), 4);
  store(high(even, odd), 3);
  store(low(even_next, odd_next), 2);
  store(high(even_next, odd_next), 1);
  store(low(even_last, odd_last), 0);
}

/// Returns whether all five disparities of the 16 pixels from `x` on exist.
HWY_INLINE bool all_exist(const std::uint8_t* winner, int x, int range) {
  const Block8 d;
  const auto winners = hn::LoadU(d, winner + x);
  const auto column = hn::SaturatedAdd(hn::Set(d, static_cast<std::uint8_t>(std::min(x, 255))),
                                       hn::Iota(d, std::uint8_t{0}));
  const auto last = hn::Min(hn::Set(d, static_cast<std::uint8_t>(range - 1)), column);
  const auto two = hn::Set(d, std::uint8_t{2});
  const auto inside = hn::And(
      hn::Eq(hn::Max(winners, two), winners),
      hn::Eq(hn::Min(hn::SaturatedAdd(winners, two), last), hn::SaturatedAdd(winners, two)));
  return hn::AllTrue(d, inside);
}

/// Replaces the distances of disparities that do not exist.
HWY_INLINE void replace_missing(const std::uint8_t* winner, const std::uint8_t* kept, int begin,
                                int end, int range, std::uint8_t* const out[5]) {
  for (int x = begin; x < end; ++x) {
    const int d = winner[x], last = std::min(range - 1, x);
    if (d >= 2 && d + 2 <= last) continue;
    for (int k = 0; k < 5; ++k) {
      if (d + k - 2 >= 0 && d + k - 2 <= last) continue;
      out[k][x] = static_cast<std::uint8_t>(kSgmCensusBits / 2 * kept[x]);
    }
  }
}

void winner_distances(const std::uint16_t* left, const std::uint16_t* right,
                      const std::uint8_t* winner, const std::uint8_t* kept, int width, int range,
                      std::uint8_t* const out[5]) {
  constexpr int kPixels = 16;
  for (int x = 0; x < width; x += kPixels) {
    distances_of_16(left, right, winner, kept, x, out);
    if (all_exist(winner, x, range)) continue;
    replace_missing(winner, kept, x, std::min(x + kPixels, width), range, out);
  }
}

/// What a pixel adds to the sums of another whose winner is larger by `shift`.
struct Shifted {
  hn::Mask<Bytes> same, larger, smaller;

  HWY_INLINE Shifted(VBytes winner, VBytes other_winner) {
    const Bytes d;
    const auto shift = hn::Sub(winner, other_winner);
    same = hn::Eq(shift, hn::Zero(d));
    larger = hn::Eq(shift, hn::Set(d, std::uint8_t{1}));
    smaller = hn::Eq(shift, hn::Set(d, std::uint8_t{0xFF}));
  }
  /// Chooses the value that belongs to the same disparity, given three in ascending order.
  HWY_INLINE VBytes choose(VBytes before, VBytes here, VBytes after) const {
    return hn::IfThenElse(larger, after,
                          hn::IfThenElse(smaller, before, hn::IfThenElseZero(same, here)));
  }
};

void sum_columns(const std::uint8_t* winner, const std::uint8_t* kept, int width,
                 const FitColumns& from, std::uint8_t* const columns[5]) {
  const Bytes d;
  const int step = static_cast<int>(hn::Lanes(d)), rows = from.rows;
  for (int x = 0; x < width; x += step) {
    const auto here = hn::LoadU(d, winner + x);
    auto sum0 = hn::Zero(d), sum1 = sum0, sum2 = sum0, sum3 = sum0, sum4 = sum0;
    for (int row = 0; row < rows; ++row) {
      const Shifted shifted(here, hn::LoadU(d, from.winner[row] + x));
      const std::uint8_t* const h = from.distances[row] + x;
      const auto h0 = hn::LoadU(d, h), h1 = hn::LoadU(d, h + from.pitch),
                 h2 = hn::LoadU(d, h + 2 * from.pitch), h3 = hn::LoadU(d, h + 3 * from.pitch),
                 h4 = hn::LoadU(d, h + 4 * from.pitch);
      sum0 = hn::Add(sum0, shifted.choose(h0, h0, h1));
      sum1 = hn::Add(sum1, shifted.choose(h0, h1, h2));
      sum2 = hn::Add(sum2, shifted.choose(h1, h2, h3));
      sum3 = hn::Add(sum3, shifted.choose(h2, h3, h4));
      sum4 = hn::Add(sum4, shifted.choose(h3, h4, h4));
    }
    // Pixels that are not kept add nothing to their row.
    const auto mask = hn::Sub(hn::Zero(d), hn::LoadU(d, kept + x));
    hn::StoreU(hn::And(sum0, mask), d, columns[0] + x);
    hn::StoreU(hn::And(sum1, mask), d, columns[1] + x);
    hn::StoreU(hn::And(sum2, mask), d, columns[2] + x);
    hn::StoreU(hn::And(sum3, mask), d, columns[3] + x);
    hn::StoreU(hn::And(sum4, mask), d, columns[4] + x);
  }
}

/// Sums of two bytes in alternating words: the even lanes and the odd ones.
struct Sums {
  using Words = hn::Repartition<std::uint16_t, Bytes>;
  hn::Vec<Words> even, odd;

  HWY_INLINE Sums() { even = odd = hn::Zero(Words()); }
  HWY_INLINE void add(VBytes bytes) {
    const Words d;
    const auto words = hn::BitCast(d, bytes);
    even = hn::Add(even, hn::And(words, hn::Set(d, std::uint16_t{0xFF})));
    odd = hn::Add(odd, hn::ShiftRight<8>(words));
  }
};

/// Returns the offset of the vertex in 1/32 px for words of sums c(-1), c(0), c(1).
template <class D, class V>
HWY_INLINE V vertex(D d, V before, V here, V after) {
  const auto depth = hn::SaturatedSub(hn::Max(before, after), here);
  const auto difference = hn::Sub(hn::Max(before, after), hn::Min(before, after));
  const auto divisor = hn::Add(hn::Add(depth, depth), hn::Set(d, std::uint16_t{kFitDamping}));
  const hn::Repartition<std::uint32_t, D> dw;
  const hn::RebindToSigned<decltype(dw)> di;
  const auto mask = hn::Set(dw, 0xFFFFU);
  static_assert(kDisparityScale == 32);
  const auto quotient = [&](auto a, auto b) HWY_ATTR {
    // round(32 a / b) = floor((32 a + b / 2) / b), as b is even.
    const auto dividend = hn::Add(hn::ShiftLeft<5>(a), hn::ShiftRight<1>(b));
    return hn::BitCast(dw, offset_quotient(di, hn::BitCast(di, dividend), hn::BitCast(di, b)));
  };
  const auto a = hn::BitCast(dw, difference), b = hn::BitCast(dw, divisor);
  const auto low = quotient(hn::And(a, mask), hn::And(b, mask));
  const auto high = quotient(hn::ShiftRight<16>(a), hn::ShiftRight<16>(b));
  const auto magnitude = hn::BitCast(d, hn::Or(low, hn::ShiftLeft<16>(high)));
  const auto offset =
      hn::IfThenElse(hn::Lt(before, after), hn::Sub(hn::Zero(d), magnitude), magnitude);
  return hn::IfThenZeroElse(hn::Eq(depth, hn::Zero(d)), offset);
}

void fit_row(const std::uint8_t* winner, const std::uint8_t* kept, int width, int range,
             const std::uint8_t* const columns[5], std::uint16_t* disparity) {
  const Bytes d;
  const Sums::Words words;
  const int step = static_cast<int>(hn::Lanes(d));
  const auto first = hn::Set(words, std::uint16_t{0});
  const auto last = hn::Set(words, static_cast<std::uint16_t>(range - 1));
  const auto none = hn::Set(words, kNoDisparity);
  const auto low_byte = hn::Set(words, std::uint16_t{0xFF});
  for (int x = 0; x < width; x += step) {
    const auto here = hn::LoadU(d, winner + x);
    Sums before, at, after;
    for (int i = x - kFitRadiusX; i <= x + kFitRadiusX; ++i) {
      const Shifted shifted(here, hn::LoadU(d, winner + i));
      const auto c0 = hn::LoadU(d, columns[0] + i), c1 = hn::LoadU(d, columns[1] + i),
                 c2 = hn::LoadU(d, columns[2] + i), c3 = hn::LoadU(d, columns[3] + i),
                 c4 = hn::LoadU(d, columns[4] + i);
      before.add(shifted.choose(c0, c1, c2));
      at.add(shifted.choose(c1, c2, c3));
      after.add(shifted.choose(c2, c3, c4));
    }
    const auto finish = [&](auto dl, auto is_kept, auto c0, auto c1, auto c2) HWY_ATTR {
      const auto is_inner = hn::And(hn::Gt(dl, first), hn::Lt(dl, last));
      const auto offset = hn::IfThenElseZero(is_inner, vertex(words, c0, c1, c2));
      const auto value = hn::Add(hn::ShiftLeft<5>(dl), offset);
      return hn::IfThenElse(hn::Eq(is_kept, hn::Zero(words)), none, value);
    };
    const auto winners = hn::BitCast(words, here);
    const auto kept_words = hn::BitCast(words, hn::LoadU(d, kept + x));
    const auto even = finish(hn::And(winners, low_byte), hn::And(kept_words, low_byte), before.even,
                             at.even, after.even);
    const auto odd = finish(hn::ShiftRight<8>(winners), hn::ShiftRight<8>(kept_words), before.odd,
                            at.odd, after.odd);
    hn::StoreInterleaved2(even, odd, words, disparity + x);
  }
}

void whole_row(const std::uint8_t* winner, const std::uint8_t* kept, int width,
               std::uint16_t* disparity) {
  const hn::CappedTag<std::uint16_t, kLaneGroup> d;
  const hn::Rebind<std::uint8_t, decltype(d)> bytes;
  const int step = static_cast<int>(hn::Lanes(d));
  for (int x = 0; x < width; x += step) {
    const auto dl = hn::PromoteTo(d, hn::LoadU(bytes, winner + x));
    const auto is_kept = hn::PromoteTo(d, hn::LoadU(bytes, kept + x));
    const auto none = hn::Set(d, kNoDisparity);
    hn::StoreU(hn::IfThenElse(hn::Eq(is_kept, hn::Zero(d)), none, hn::ShiftLeft<5>(dl)), d,
               disparity + x);
  }
}

}  // namespace fpga_stereo::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fpga_stereo::simd {

HWY_EXPORT(interleave_planes);
HWY_EXPORT(winner_distances);
HWY_EXPORT(sum_columns);
HWY_EXPORT(fit_row);
HWY_EXPORT(whole_row);

void interleave_planes(const std::uint8_t* plane, std::ptrdiff_t plane_pitch, int width,
                       std::uint16_t* bits) {
  HWY_DYNAMIC_DISPATCH(interleave_planes)(plane, plane_pitch, width, bits);
}
void sum_columns(const std::uint8_t* winner, const std::uint8_t* kept, int width,
                 const FitColumns& from, std::uint8_t* const columns[5]) {
  HWY_DYNAMIC_DISPATCH(sum_columns)(winner, kept, width, from, columns);
}
void fit_row(const std::uint8_t* winner, const std::uint8_t* kept, int width, int range,
             const std::uint8_t* const columns[5], std::uint16_t* disparity) {
  HWY_DYNAMIC_DISPATCH(fit_row)(winner, kept, width, range, columns, disparity);
}
void whole_row(const std::uint8_t* winner, const std::uint8_t* kept, int width,
               std::uint16_t* disparity) {
  HWY_DYNAMIC_DISPATCH(whole_row)(winner, kept, width, disparity);
}

void winner_distances(const std::uint16_t* left, const std::uint16_t* right,
                      const std::uint8_t* winner, const std::uint8_t* kept, int width, int range,
                      std::uint8_t* const out[5]) {
  HWY_DYNAMIC_DISPATCH(winner_distances)(left, right, winner, kept, width, range, out);
}

void FiveRows::create(int width, int rows) {
  bytes_.create(5 * rows, width + 2 * kBorder);
  bytes_ = 0;
}

void Fit::start(const CensusPlanes& left, const CensusPlanes& right, const ByteImage& winner,
                const ByteImage& kept, const Parameters& p, int first_row) {
  left_ = &left;
  right_ = &right;
  winner_ = &winner;
  kept_ = &kept;
  parameters_ = p;
  row_ = first_row;
  distances_.create(left.width, kFitRows);
  columns_.create(left.width, 1);
  left_bits_.assign(static_cast<std::size_t>(left.width) + kBorder, 0);
  // The border of a winner may hold anything, so a pixel there may be compared with one up to 257
  // px to its left or 2 px to its right.
  right_bits_.assign(static_cast<std::size_t>(left.width) + 256 + std::size_t{2} * kBorder, 0);
  for (int y = std::max(first_row - kFitRadiusY, 0); y < first_row + kFitRadiusY; ++y) enter(y);
}

/// Computes the distances of a row that enters the window.
void Fit::enter(int y) {
  if (!parameters_.subpixel || y >= left_->height) return;
  const int width = left_->width, slot = y % kFitRows;
  std::uint16_t* const right = right_bits_.data() + 256 + kBorder;
  interleave_planes(left_->row(y), left_->pitch, width, left_bits_.data());
  interleave_planes(right_->row(y), right_->pitch, width, right);
  std::uint8_t* const out[5] = {distances_.row(slot, 0), distances_.row(slot, 1),
                                distances_.row(slot, 2), distances_.row(slot, 3),
                                distances_.row(slot, 4)};
  winner_distances(left_bits_.data(), right, winner_->image[y], kept_->image[y], width,
                   parameters_.disparity_range, out);
}

void Fit::next(std::uint16_t* disparity) {
  const int width = left_->width, y = row_++;
  const std::uint8_t *winner = winner_->image[y], *kept = kept_->image[y];
  if (!parameters_.subpixel) return whole_row(winner, kept, width, disparity);
  enter(y + kFitRadiusY);
  std::uint8_t* const columns[5] = {columns_.row(0, 0), columns_.row(0, 1), columns_.row(0, 2),
                                    columns_.row(0, 3), columns_.row(0, 4)};
  FitColumns from;
  from.pitch = distances_.pitch();
  const int last = std::min(y + kFitRadiusY, left_->height - 1);
  for (int v = std::max(y - kFitRadiusY, 0); v <= last; ++v, ++from.rows) {
    from.winner[from.rows] = winner_->image[v];
    from.distances[from.rows] = distances_.row(v % kFitRows, 0);
  }
  sum_columns(winner, kept, width, from, columns);
  for (std::uint8_t* column : columns) std::fill_n(column + width, kBorder, std::uint8_t{0});
  fit_row(winner, kept, width, parameters_.disparity_range, columns, disparity);
}

}  // namespace fpga_stereo::simd
#endif
