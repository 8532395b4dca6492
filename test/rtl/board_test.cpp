// The demonstration of fpga_fw/boards/ulx3s_85f: pattern, pipeline, SPI and LEDs, small.
#include "Board.h"

#include <gtest/gtest.h>

#include "fpga_stereo/core/pipeline.hpp"
#include "fpga_stereo/core/signature.hpp"
#include "fpga_stereo/core/spec.hpp"

namespace fpga_stereo::test {
namespace {

constexpr int kWidth = 64, kHeight = 480, kFar = 6, kNear = 12;

class BoardRig {
 public:
  BoardRig() {
    board_.btn = 1;
    board_.spi_cs_n = 1;
  }
  void run(std::int64_t clocks) {
    for (; clocks > 0; --clocks) {
      board_.clk_25mhz = 0;
      board_.eval();
      board_.clk_25mhz = 1;
      board_.eval();
    }
  }
  /// A transfer of spi_registers.
  std::uint32_t transfer(bool write, std::uint8_t address, std::uint32_t data) {
    std::uint64_t out = (std::uint64_t{write} << 47) | (std::uint64_t{address} << 32) | data;
    std::uint64_t in = 0;
    board_.spi_cs_n = 0;
    run(10);
    for (int bit = 47; bit >= 0; --bit) {
      board_.spi_mosi = (out >> bit) & 1;
      run(4);
      in = in << 1 | board_.spi_miso;
      board_.spi_sclk = 1;
      run(4);
      board_.spi_sclk = 0;
    }
    run(10);
    board_.spi_cs_n = 1;
    run(10);
    return static_cast<std::uint32_t>(in);
  }
  std::uint32_t read(std::uint8_t address) { return transfer(false, address, 0); }
  Board& board() { return board_; }

 private:
  Board board_;
};

/// The pattern as its header defines it.
std::pair<cv::Mat1b, cv::Mat1b> pattern() {
  std::uint32_t bits = 0x2C9F51B3;
  cv::Mat1b left(kHeight, kWidth), right(kHeight, kWidth);
  for (int k = 0; k < kWidth * kHeight; ++k) {
    const int x = k % kWidth, y = k / kWidth;
    right(y, x) = static_cast<std::uint8_t>((bits >> 23) ^ (bits >> 20));
    bits = ((bits << 8) | right(y, x)) & 0x7FFFFFFF;
    const bool middle =
        x >= kWidth / 4 && x < 3 * kWidth / 4 && y >= kHeight / 4 && y < 3 * kHeight / 4;
    const int from = k - (middle ? kNear : kFar);
    left(y, x) = from < 0 ? 0 : right(from / kWidth, from % kWidth);
  }
  return {left, right};
}

TEST(Board, ShowsWhatSoftwareComputes) {
  BoardRig rig;
  rig.run(100);
  EXPECT_EQ(rig.read(spec::kRegIdentity), 0x46535431U);
  rig.run(4 * kWidth * (kHeight + 60));
  const auto [left, right] = pattern();
  Parameters p;
  p.disparity_range = 16;
  StereoGeometry geometry;
  geometry.image_size = {kWidth, kHeight};
  Pipeline pipeline;
  const Taps& taps = pipeline.process(left, right, no_rectification(geometry, 0), p, 1);
  // The pattern is one that has disparities.
  int near = 0, far = 0;
  for (const std::uint16_t d : taps.disparity) {
    near += d == kDisparityScale * kNear ? 1 : 0;
    far += d == kDisparityScale * kFar ? 1 : 0;
  }
  EXPECT_GT(near, kWidth * kHeight / 16);
  EXPECT_GT(far, kWidth * kHeight / 16);
  const auto expected = stage_signatures(taps, p);
  rig.run(4 * kWidth * (kHeight + 60));
  for (int stage = 0; stage < kNumStages; ++stage) {
    EXPECT_EQ(rig.read(spec::kRegSignatureRectify + stage), expected[stage]) << kStageNames[stage];
    // The same on the LEDs.
    std::uint32_t shown = 0;
    for (int byte = 0; byte < 4; ++byte) {
      rig.board().sw = stage + 1;
      rig.board().btn = 1 | byte << 1;
      rig.run(20);
      shown |= std::uint32_t{rig.board().led} << 8 * byte;
    }
    EXPECT_EQ(shown, expected[stage]) << kStageNames[stage];
  }
  rig.board().sw = 0;
  rig.board().btn = 1;
  rig.run(20);
  EXPECT_EQ(rig.board().led, rig.read(spec::kRegFramesOut) >> 6);
  rig.run(60 * kWidth * kHeight);
  EXPECT_EQ(rig.read(spec::kRegErrors), 0U);
  EXPECT_EQ(rig.board().led, rig.read(spec::kRegFramesOut) >> 6);
  EXPECT_GT(rig.read(spec::kRegFramesOut), 64U);

  // Another threshold takes effect, is read back, and lights the LED: one frame differs.
  rig.transfer(true, spec::kRegUniqueness, 500);
  EXPECT_EQ(rig.read(spec::kRegUniqueness), 500U);
  rig.transfer(true, spec::kRegControl, 1);
  rig.run(3 * kWidth * (kHeight + 60));
  EXPECT_EQ(rig.board().led >> 7, 1);
  rig.board().btn = 0;
  rig.run(1000);
  rig.board().btn = 1;
  rig.run(2 * kWidth * (kHeight + 60));
  EXPECT_EQ(rig.board().led, 0);
  // A width that the pattern has not.
  rig.transfer(true, spec::kRegWidth, 60);
  rig.transfer(true, spec::kRegControl, 1);
  rig.run(3 * kWidth * (kHeight + 60));
  EXPECT_NE(rig.read(spec::kRegErrors), 0U);
  EXPECT_EQ(rig.board().led >> 7, 1);
}

}  // namespace
}  // namespace fpga_stereo::test
