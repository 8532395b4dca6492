// fs_signature, fs_fold_census and fs_fold_match against Signature, census_word() and match_word().
#include "core/signature.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <random>
#include <vector>

#include "FoldCensus120.h"
#include "FoldCensus24.h"
#include "FoldMatch20x16.h"
#include "FoldMatch64x13.h"
#include "SignatureModel.h"
#include "rtl/ports.hpp"

namespace fpga_stereo::test {
namespace {

template <class Model>
void clock(Model& model) {
  model.clk_i = 0;
  model.eval();
  model.clk_i = 1;
  model.eval();
}

class SignatureBench {
 public:
  SignatureModel model;

  explicit SignatureBench(double stalled) : stalled_(stalled) {
    model.stage_rst_ni = 1;
    reset();
  }
  void reset() {
    model.rst_ni = 0;
    model.en_i = model.valid_i = model.sof_i = model.busy_i = 0;
    clock(model);
    model.rst_ni = 1;
  }
  void tick(bool valid, bool sof, std::uint32_t word) {
    while (std::uniform_real_distribution<>()(random_) < stalled_) {
      model.en_i = 0;
      model.valid_i = random_() & 1;
      model.sof_i = random_() & 1;
      model.word_i = random_();
      clock(model);
    }
    model.en_i = 1;
    model.valid_i = valid ? 1 : 0;
    model.sof_i = sof ? 1 : 0;
    model.word_i = word;
    clock(model);
    model.en_i = 0;
  }
  /// Returns its signature.
  std::uint32_t frame(int pixels) {
    Signature signature;
    for (int i = 0; i < pixels; ++i) {
      const auto word = static_cast<std::uint32_t>(random_());
      tick(true, i == 0, word);
      signature.add(word);
    }
    return signature.value();
  }
  void bubbles(int ticks) {
    for (int i = 0; i < ticks; ++i) tick(false, false, random_());
  }

 private:
  double stalled_;
  std::mt19937 random_{1};
};

TEST(Signature, FramesWithAndWithoutBubbles) {
  for (const double stalled : {0., 0.4}) {
    SignatureBench bench(stalled);
    bench.model.busy_i = 1;
    EXPECT_EQ(bench.model.signature_o, 0U);
    std::uint32_t last = 0;
    for (int i = 0; i < 40; ++i) {
      const std::uint32_t expected = bench.frame(i == 0 ? 1 : 1 + i * 7 % 90);
      EXPECT_EQ(bench.model.signature_o, last) << "before the frame is over";
      if (i % 3 != 0) {
        bench.bubbles(i % 3);
        EXPECT_EQ(bench.model.signature_o, expected);
      }
      last = expected;
    }
    bench.bubbles(1);
    EXPECT_EQ(bench.model.signature_o, last);
  }
}

TEST(Signature, OfTheLastFrameWithoutAFurtherTick) {
  SignatureBench bench(0);
  bench.model.busy_i = 1;
  const std::uint32_t expected = bench.frame(50);
  clock(bench.model);
  EXPECT_EQ(bench.model.signature_o, 0U);
  bench.model.busy_i = 0;
  clock(bench.model);
  EXPECT_EQ(bench.model.signature_o, expected);
  clock(bench.model);
  EXPECT_EQ(bench.model.signature_o, expected);
}

TEST(Signature, Resets) {
  SignatureBench bench(0);
  bench.model.busy_i = 1;
  const std::uint32_t expected = bench.frame(50);
  bench.bubbles(1);
  // Ticks in a reset of the stages count for nothing; the signature stays.
  bench.model.stage_rst_ni = 0;
  bench.frame(3);
  bench.model.stage_rst_ni = 1;
  bench.bubbles(2);
  EXPECT_EQ(bench.model.signature_o, expected);
  // A reset within a frame: nothing of it is left.
  bench.frame(20);
  bench.reset();
  bench.bubbles(2);
  EXPECT_EQ(bench.model.signature_o, 0U);
  bench.model.busy_i = 1;
  const std::uint32_t next = bench.frame(9);
  bench.bubbles(1);
  EXPECT_EQ(bench.model.signature_o, next);
}

constexpr int kWords = 500;

/// Words of random inputs, with random stalls: `drive` sets the inputs and returns the word.
template <class Model>
void check_fold(int latency, const std::function<std::uint32_t(Model&, std::mt19937&)>& drive) {
  Model model;
  std::mt19937 random(1);
  model.en_i = model.valid_i = model.sof_i = model.rst_ni = 0;
  clock(model);
  model.rst_ni = 1;
  std::vector<std::uint32_t> words;
  std::vector<bool> valid, sof;
  while (words.size() < kWords) {
    model.en_i = random() % 3 != 0 ? 1 : 0;
    valid.push_back(random() & 1);
    sof.push_back(valid.back() && (random() & 1));
    words.push_back(drive(model, random));
    model.valid_i = valid.back() ? 1 : 0;
    model.sof_i = sof.back() ? 1 : 0;
    model.clk_i = 0;
    model.eval();
    // What is here now was driven `latency` ticks ago.
    const std::ptrdiff_t then = static_cast<std::ptrdiff_t>(words.size()) - 1 - latency;
    if (then >= 0) {
      ASSERT_EQ(model.word_o, words[then]) << "tick " << then;
      ASSERT_EQ(model.valid_o != 0, valid[then]);
      ASSERT_EQ(model.sof_o != 0, sof[then]);
    } else {
      ASSERT_FALSE(model.valid_o);
    }
    const bool tick = model.en_i;
    model.clk_i = 1;
    model.eval();
    if (!tick) {
      words.pop_back();
      valid.pop_back();
      sof.pop_back();
    }
  }
}

template <class Model>
void check_census(int bits) {
  check_fold<Model>(1, [&](Model& model, std::mt19937& random) {
    const int words = (bits + 31) / 32;
    std::vector<std::uint32_t> left(words), right(words);
    set_random(model.left_i, bits, random);
    set_random(model.right_i, bits, random);
    for (int i = 0; i < words; ++i) {
      const int count = std::min(32, bits - 32 * i);
      left[i] = get_bits(model.left_i, 32 * i, count);
      right[i] = get_bits(model.right_i, 32 * i, count);
    }
    return census_word(left.data(), right.data(), words);
  });
}

template <class Model>
void check_match(int disparities, int bits) {
  check_fold<Model>(2, [&](Model& model, std::mt19937& random) {
    cv::Mat1w sums(disparities, 1);
    for (int d = 0; d < disparities; ++d) {
      sums(d, 0) = random() % (1U << bits);
      set_bits(model.sums_i, d * bits, bits, sums(d, 0));
    }
    return match_word(sums, 0);
  });
}

TEST(Signature, FoldOfCensus) {
  check_census<FoldCensus24>(24);
  check_census<FoldCensus120>(120);
}

TEST(Signature, FoldOfMatch) {
  check_match<FoldMatch64x13>(64, 13);
  check_match<FoldMatch20x16>(20, 16);
}

}  // namespace
}  // namespace fpga_stereo::test
