#include "core/signature.hpp"

#include <algorithm>

namespace fpga_stereo {
namespace {

std::uint32_t rotate_left(std::uint32_t word, int bits) {
  bits %= 32;
  return bits == 0 ? word : word << bits | word >> (32 - bits);
}

/// Returns the exclusive or of all words: bit k goes to bit k mod 32.
std::uint32_t fold(const std::uint32_t* bits, int words) {
  std::uint32_t folded = 0;
  for (int i = 0; i < words; ++i) folded ^= bits[i];
  return folded;
}

}  // namespace

std::uint32_t rectify_word(std::uint8_t left, std::uint8_t right) {
  return std::uint32_t{left} << kPixelBits | right;
}

std::uint32_t census_word(const std::uint32_t* left, const std::uint32_t* right, int words) {
  return fold(left, words) ^ rotate_left(fold(right, words), 16);
}

std::uint32_t match_word(const cv::Mat1w& sums, int x) {
  std::uint32_t word = 0;
  for (int d = 0; d < sums.rows; ++d) word ^= rotate_left(sums(d, x), d);
  return word;
}

std::uint32_t select_word(const Selection& s, int x, int y) {
  std::uint32_t word = s.winner(y, x) ^ std::uint32_t{s.right_winner(y, x)} << 8 ^
                       std::uint32_t{s.winner_sum(y, x)} << 16 ^
                       rotate_left(s.runner_up_sum(y, x), 8);
  for (int k = 0; k < 5; ++k) word ^= rotate_left(s.around(y, x)[k], 5 * k);
  return word;
}

std::uint32_t image_signature(const cv::Mat& image) {
  Signature s;
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      s.add(image.depth() == CV_16U ? image.at<std::uint16_t>(y, x) : image.at<std::uint8_t>(y, x));
    }
  }
  return s.value();
}

std::array<std::uint32_t, kNumGatewareStages> stage_signatures(const Taps& taps,
                                                               const Parameters& p) {
  std::array<Signature, kNumGatewareStages> signatures;
  const auto add = [&](Stage stage, std::uint32_t word) {
    const auto at = std::find(kGatewareStages.begin(), kGatewareStages.end(), stage);
    signatures[static_cast<std::size_t>(at - kGatewareStages.begin())].add(word);
  };
  const int words = taps.left_bits.channels();
  Match match;
  match.start(taps.left_bits, taps.right_bits, p, 0);
  for (int y = 0; y < taps.left.rows; ++y) {
    const auto* left_bits = taps.left_bits.ptr<std::uint32_t>(y);
    const auto* right_bits = taps.right_bits.ptr<std::uint32_t>(y);
    const cv::Mat1w& sums = match.next();
    for (int x = 0; x < taps.left.cols; ++x) {
      const int at = x * words;
      add(Stage::kRectify, rectify_word(taps.left(y, x), taps.right(y, x)));
      add(Stage::kCensus, census_word(left_bits + at, right_bits + at, words));
      add(Stage::kMatch, match_word(sums, x));
      add(Stage::kSelect, select_word(taps.selection, x, y));
      add(Stage::kCheck, taps.kept(y, x));
      add(Stage::kSubpixel, taps.refined(y, x));
      add(Stage::kSpeckle, taps.filtered(y, x));
    }
  }
  std::array<std::uint32_t, kNumGatewareStages> values{};
  for (std::size_t stage = 0; stage < values.size(); ++stage) {
    values[stage] = signatures[stage].value();
  }
  return values;
}

}  // namespace fpga_stereo
