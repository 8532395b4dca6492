// Compares fs_signature, fs_fold_census and fs_fold_match with Signature, census_word() and
// match_word().
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

class SignatureRig {
 public:
  SignatureModel model;

  explicit SignatureRig(double stall_chance) : stall_chance_(stall_chance) {
    model.stage_rst_ni = 1;
    reset();
  }
  void reset() {
    model.rst_ni = 0;
    model.en_i = model.valid_i = model.sof_i = model.busy_i = 0;
    clock(model);
    model.rst_ni = 1;
  }
  /// Runs one tick, preceded by random stalls.
  void tick(bool valid, bool sof, std::uint32_t word) {
    while (std::uniform_real_distribution<>()(random_) < stall_chance_) {
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
  /// Sends a frame of random words; returns its expected signature.
  std::uint32_t send_frame(int pixels) {
    Signature signature;
    for (int i = 0; i < pixels; ++i) {
      const auto word = static_cast<std::uint32_t>(random_());
      tick(true, i == 0, word);
      signature.add(word);
    }
    return signature.value();
  }
  void send_bubbles(int ticks) {
    for (int i = 0; i < ticks; ++i) tick(false, false, random_());
  }

 private:
  double stall_chance_;
  std::mt19937 random_{1};
};

TEST(Signature, UpdatesAfterEachFrameWithAndWithoutBubbles) {
  for (const double stall_chance : {0., 0.4}) {
    SignatureRig rig(stall_chance);
    rig.model.busy_i = 1;
    EXPECT_EQ(rig.model.signature_o, 0U);
    std::uint32_t last = 0;
    for (int i = 0; i < 40; ++i) {
      const std::uint32_t expected = rig.send_frame(i == 0 ? 1 : 1 + i * 7 % 90);
      EXPECT_EQ(rig.model.signature_o, last) << "changed before the frame ended";
      if (i % 3 != 0) {
        rig.send_bubbles(i % 3);
        EXPECT_EQ(rig.model.signature_o, expected);
      }
      last = expected;
    }
    rig.send_bubbles(1);
    EXPECT_EQ(rig.model.signature_o, last);
  }
}

TEST(Signature, UpdatesWithoutAFurtherTickWhenIdle) {
  SignatureRig rig(0);
  rig.model.busy_i = 1;
  const std::uint32_t expected = rig.send_frame(50);
  clock(rig.model);
  EXPECT_EQ(rig.model.signature_o, 0U);
  rig.model.busy_i = 0;
  clock(rig.model);
  EXPECT_EQ(rig.model.signature_o, expected);
  clock(rig.model);
  EXPECT_EQ(rig.model.signature_o, expected);
}

TEST(Signature, RecoversFromResets) {
  SignatureRig rig(0);
  rig.model.busy_i = 1;
  const std::uint32_t expected = rig.send_frame(50);
  rig.send_bubbles(1);
  // Ticks during a reset of the stages are ignored; the signature keeps its value.
  rig.model.stage_rst_ni = 0;
  rig.send_frame(3);
  rig.model.stage_rst_ni = 1;
  rig.send_bubbles(2);
  EXPECT_EQ(rig.model.signature_o, expected);
  // A reset in the middle of a frame discards that frame.
  rig.send_frame(20);
  rig.reset();
  rig.send_bubbles(2);
  EXPECT_EQ(rig.model.signature_o, 0U);
  rig.model.busy_i = 1;
  const std::uint32_t next = rig.send_frame(9);
  rig.send_bubbles(1);
  EXPECT_EQ(rig.model.signature_o, next);
}

constexpr int kWords = 500;

/// Compares the fold of random inputs, with random stalls: `drive` sets the inputs and returns the
/// expected word.
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
    // The present output belongs to the inputs of `latency` ticks ago.
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

TEST(Signature, FoldsCensusAsTheSoftwareDoes) {
  check_census<FoldCensus24>(24);
  check_census<FoldCensus120>(120);
}

TEST(Signature, FoldsMatchAsTheSoftwareDoes) {
  check_match<FoldMatch64x13>(64, 13);
  check_match<FoldMatch20x16>(20, 16);
}

}  // namespace
}  // namespace fpga_stereo::test
