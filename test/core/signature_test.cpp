#include "core/signature.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <vector>

#include "support/images.hpp"
#include "support/naive.hpp"

namespace fpga_stereo::test {
namespace {

using Words = std::vector<std::uint32_t>;

std::uint32_t signature(const Words& words) {
  Signature s;
  for (const std::uint32_t word : words) s.add(word);
  return s.value();
}

/// Returns (start x^n + sum of words[i] x^(n - 1 - i)) mod (x^32 + polynomial) by long division.
std::uint32_t by_division(const Words& words) {
  const std::size_t n = words.size();
  std::vector<bool> dividend(n + 32);  // [k]: coefficient of x^k
  const auto add = [&](std::uint32_t factor, std::size_t power) {
    for (std::size_t k = 0; k < 32; ++k) {
      if ((factor >> k & 1) != 0) dividend[k + power] = !dividend[k + power];
    }
  };
  add(0xFFFFFFFF, n);
  for (std::size_t i = 0; i < n; ++i) add(words[i], n - 1 - i);
  for (std::size_t k = n + 31; k >= 32; --k) {
    if (!dividend[k]) continue;
    dividend[k] = false;
    add(0x1EDC6F41, k - 32);
  }
  std::uint32_t remainder = 0;
  for (std::size_t k = 0; k < 32; ++k) remainder |= std::uint32_t{dividend[k]} << k;
  return remainder;
}

Words random_words(std::size_t count, unsigned seed) {
  cv::RNG rng(seed);
  Words words(count);
  for (std::uint32_t& word : words) word = rng.next();
  return words;
}

TEST(Signature, ByHand) {
  EXPECT_EQ(signature({}), 0xFFFFFFFF);
  EXPECT_EQ(signature({0}), 0xE12390BF);     // FFFFFFFE ^ 1EDC6F41
  EXPECT_EQ(signature({0, 1}), 0xDC9B4E3E);  // C247217E ^ 1EDC6F41 ^ 1
  EXPECT_EQ(signature({0, 1, 0, 0}), 0x5109893B);
  EXPECT_EQ(signature({0, 1, 0, 0, 0x80000000}), 0x22131276) << "the last step has no carry";
}

TEST(Signature, EqualsTheRemainderOfADivision) {
  for (std::size_t count = 0; count < 300; count += 7) {
    const Words words = random_words(count, static_cast<unsigned>(1700 + count));
    ASSERT_EQ(signature(words), by_division(words)) << count << " words";
  }
}

TEST(Signature, DependsOnEveryBitAndTheOrder) {
  const Words words = random_words(50, 1800);
  const std::uint32_t expected = signature(words);
  for (std::size_t i = 0; i < words.size(); ++i) {
    for (int bit = 0; bit < 32; ++bit) {
      Words changed = words;
      changed[i] ^= 1U << bit;
      ASSERT_NE(signature(changed), expected) << "word " << i << ", bit " << bit;
    }
    if (i == 0) continue;
    Words swapped = words;
    std::swap(swapped[i], swapped[i - 1]);
    ASSERT_NE(signature(swapped), expected) << "words " << i - 1 << " and " << i;
  }
}

TEST(Signature, OfAnImageReadsPixelsInRasterOrder) {
  const cv::Mat1w wide = (cv::Mat1w(2, 3) << 1, 65535, 32, 7, 0, 40000);
  const cv::Mat1b narrow = (cv::Mat1b(2, 2) << 255, 3, 0, 128);
  EXPECT_EQ(image_signature(wide), by_division({1, 65535, 32, 7, 0, 40000}));
  EXPECT_EQ(image_signature(narrow), by_division({255, 3, 0, 128}));
  // The rows of a sub-image are not contiguous in memory.
  EXPECT_EQ(image_signature(wide.colRange(1, 3)), by_division({65535, 32, 0, 40000}));
}

TEST(SignatureWord, RectifyByHand) { EXPECT_EQ(rectify_word(0x12, 0xF4), 0x12F4U); }

TEST(SignatureWord, CensusByHand) {
  const std::uint32_t left[] = {0x00000F01, 0x80000000, 0x00000001, 0x00700000};
  const std::uint32_t right[] = {0x0012ABCD, 0x00000003, 0x40000000, 0x00000000};
  EXPECT_EQ(census_word(left, right, 1), 0x00000F01U ^ 0xABCD0012U);
  EXPECT_EQ(census_word(left, right, 4), 0x80700F00U ^ 0xABCE4012U);
}

TEST(SignatureWord, MatchByHand) {
  cv::Mat1w sums(40, 3, std::uint16_t{0});
  sums(0, 1) = 0x1234;
  EXPECT_EQ(match_word(sums, 1), 0x1234U);
  sums(4, 1) = 0x8001;
  EXPECT_EQ(match_word(sums, 1), 0x1234U ^ 0x80010U);
  sums(28, 1) = 0xABCD;
  EXPECT_EQ(match_word(sums, 1), 0x1234U ^ 0x80010U ^ 0xD0000ABCU);
  sums(36, 1) = 0x8001;
  EXPECT_EQ(match_word(sums, 1), 0x1234U ^ 0xD0000ABCU)
      << "a rotation by 36 is one by 4, so both cancel";
  EXPECT_EQ(match_word(sums, 0), 0U);
}

TEST(SignatureWord, SelectByHand) {
  Selection s;
  create(s, {2, 1});
  s.winner = 0x11;
  s.right_winner = 0x22;
  s.winner_sum = std::uint16_t{0x3344};
  s.runner_up_sum = std::uint16_t{0};
  s.around(0, 1) = {0, 0, 0, 0, 0};
  EXPECT_EQ(select_word(s, 1, 0), 0x33442211U);
  s.runner_up_sum(0, 1) = 0xABCD;
  EXPECT_EQ(select_word(s, 1, 0), 0x33442211U ^ 0x00ABCD00U);
  s.runner_up_sum(0, 1) = 0;
  s.around(0, 1) = {1, 1, 1, 1, 0x1234};  // at bits 0, 5, 10, 15; 0x1234 rotated by 20
  EXPECT_EQ(select_word(s, 1, 0), 0x33442211U ^ 0x00008421U ^ 0x23400001U);
}

struct Frame {
  Parameters parameters = window_parameters();
  Taps taps;
};

Frame frame(CensusPattern pattern) {
  Frame f;
  f.parameters.census_pattern = pattern;
  f.parameters.disparity_range = 40;
  f.parameters.speckle_size = 30;
  const SlantedPair pair = slanted_pair({70, 31}, Texture(1900), 3.2, 0.05);
  StereoGeometry geometry;
  geometry.image_size = pair.left.size();
  ReferencePipeline pipeline;
  f.taps =
      pipeline.process(pair.left, pair.right, identity_rectification(geometry, 0), f.parameters, 2);
  return f;
}

TEST(StageSignatures, EqualThoseOfTheWordsOfEveryPixel) {
  for (const CensusPattern pattern : {CensusPattern::kSparse, CensusPattern::kFull}) {
    const auto [p, t] = frame(pattern);
    const naive::Sums sums = naive::match(t.left_bits, t.right_bits, p);
    const int channels = t.left_bits.channels();
    std::array<Words, kNumGatewareStages> words;
    for (int y = 0; y < t.left.rows; ++y) {
      const cv::Mat1w row = cv::Mat_<std::uint16_t>(sums[y]);
      for (int x = 0; x < t.left.cols; ++x) {
        words[0].push_back(t.left(y, x) * 256U + t.right(y, x));
        words[1].push_back(census_word(t.left_bits.ptr<std::uint32_t>(y) + x * channels,
                                       t.right_bits.ptr<std::uint32_t>(y) + x * channels,
                                       channels));
        words[2].push_back(match_word(row, x));
        words[3].push_back(select_word(t.selection, x, y));
        words[4].push_back(t.kept(y, x));
        words[5].push_back(t.refined(y, x));
        words[6].push_back(t.filtered(y, x));
      }
    }
    const auto actual = stage_signatures(t, p);
    for (int stage = 0; stage < kNumGatewareStages; ++stage) {
      EXPECT_EQ(actual[stage], by_division(words[stage])) << gateware_stage_name(stage);
    }
  }
}

TEST(StageSignatures, NameTheStageThatDiffers) {
  const Frame f = frame(CensusPattern::kSparse);
  const auto expected = stage_signatures(f.taps, f.parameters);
  const auto differing = [&](const std::function<void(Taps&)>& change) {
    Taps taps = f.taps;
    change(taps);
    const auto actual = stage_signatures(taps, f.parameters);
    std::string names;
    for (int stage = 0; stage < kNumGatewareStages; ++stage) {
      if (actual[stage] != expected[stage]) names += std::string(gateware_stage_name(stage)) + " ";
    }
    return names;
  };
  const auto flipped = [](cv::Mat& image) {
    image = image.clone();
    image.ptr<std::uint8_t>(17)[5] ^= 1;
  };
  EXPECT_EQ(differing([](Taps&) {}), "");
  EXPECT_EQ(differing([&](Taps& t) { flipped(t.left); }), "rectify ");
  EXPECT_EQ(differing([&](Taps& t) { flipped(t.right_bits); }), "census match ");
  EXPECT_EQ(differing([&](Taps& t) { flipped(t.selection.runner_up_sum); }), "select ");
  EXPECT_EQ(differing([&](Taps& t) { flipped(t.kept); }), "check ");
  EXPECT_EQ(differing([&](Taps& t) { flipped(t.refined); }), "subpixel ");
  EXPECT_EQ(differing([&](Taps& t) { flipped(t.filtered); }), "speckle ");
  EXPECT_EQ(differing([&](Taps& t) { flipped(t.disparity); }), "") << "the result may be dense";
}

}  // namespace
}  // namespace fpga_stereo::test
