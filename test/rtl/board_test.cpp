// The top module of fpga_fw/boards/ulx3s_85f with small build parameters, connected to models of
// the chips at its pins: two sensors, the FT232H and a serial line.
#include <gtest/gtest.h>

#include <random>
#include <utility>
#include <vector>

#include "rtl/board_rig.hpp"
#include "support/compare.hpp"
#include "support/images.hpp"

namespace fpga_stereo::test {
namespace {

constexpr int kFarDisparity = 6, kNearDisparity = 12;  // of the test pattern
constexpr int kSensorWidth = 72, kSensorHeight = 52;
constexpr int kLeft = 1, kRight = 0;  // bit in vectors of ports
constexpr std::uint32_t kDisparityStream = 1U << 1;

/// The sensor registers and values that fs_mt9v034 writes.
const std::vector<std::pair<int, int>> kSensorTable = {
    {0x07, 0x0388}, {0x01, 1},  {0x02, 4},      {0x03, 480}, {0x04, 752},
    {0x05, 835},    {0x06, 45}, {0x0D, 0x0300}, {0x0B, 236}, {0xAF, 0x0002}};

/// Returns the test pattern as the header of test_pattern.sv defines it.
std::pair<cv::Mat1b, cv::Mat1b> make_pattern() {
  std::uint32_t bits = 0x2C9F51B3;
  cv::Mat1b left(kHeight, kWidth), right(kHeight, kWidth);
  for (int k = 0; k < kWidth * kHeight; ++k) {
    const int x = k % kWidth, y = k / kWidth;
    right(y, x) = static_cast<std::uint8_t>((bits >> 23) ^ (bits >> 20));
    bits = ((bits << 8) | right(y, x)) & 0x7FFFFFFF;
    const bool is_near =
        x >= kWidth / 4 && x < 3 * (kWidth / 4) && y >= kHeight / 4 && y < 3 * (kHeight / 4);
    const int from = k - (is_near ? kNearDisparity : kFarDisparity);
    left(y, x) = from < 0 ? 0 : right(from / kWidth, from % kWidth);
  }
  return {left, right};
}

void expect_build(const link::Identity& identity) {
  EXPECT_TRUE(identity.check()) << identity.check().error().message;
  EXPECT_EQ(identity.build.max_width, 64);
  EXPECT_EQ(identity.build.disparities, 16);
  EXPECT_EQ(identity.streams, link::StreamSet::all());
  EXPECT_EQ(identity.clock_hz, 10000000U);
}

TEST(Board, SendsCameraFramesOverUsb) {
  BoardRig rig;
  const link::Identity identity = rig.identity();
  expect_build(identity);
  rig.apply_configuration(identity.build);
  rig.write(spec::kRegStreams, kDisparityStream);
  std::mt19937 random(3);
  for (int i = 0; i < 3; ++i) {
    SCOPED_TRACE(i);
    // The right image is the left one shifted by 5 px; the board uses the middle of both.
    cv::Mat1b left(kSensorHeight, kSensorWidth), right(kSensorHeight, kSensorWidth);
    for (auto& pixel : left) pixel = static_cast<std::uint8_t>(random());
    for (int x = 0; x < kSensorWidth; ++x) left.col((x + 5) % kSensorWidth).copyTo(right.col(x));
    const SensorPort::Blanking blanking = {5, 20, 2000};
    rig.sensors[kLeft].frame(left, blanking);
    rig.sensors[kRight].frame(right, blanking);
    const AssembledFrame frame = rig.next_frame();
    ASSERT_EQ(frame.verdict, link::FrameVerdict::kGood) << frame.text();
    const cv::Rect window((kSensorWidth - kWidth) / 2, (kSensorHeight - kHeight) / 2, kWidth,
                          kHeight);
    const cv::Mat1w expected = rig.run_reference(left(window).clone(), right(window).clone());
    EXPECT_TRUE(same("disparity", expected, cv::Mat1w(frame.image)));
    EXPECT_GT(cv::countNonZero(expected == 5 * kDisparityScale), kWidth * kHeight / 2);
  }
  EXPECT_EQ(rig.read(spec::kRegFramesOut), 3U);
  EXPECT_EQ(rig.read(spec::kRegErrors), 0U);

  rig.run_until([&] { return rig.registers[0].writes.size() == kSensorTable.size(); });
  rig.run(1000);
  for (const auto& sensor : rig.registers) EXPECT_EQ(sensor.writes, kSensorTable);
  // LEDs: no errors, both sensors answer, the USB clock runs, bytes flow both ways.
  EXPECT_EQ(rig.board.led_o & 0xBE, 0x3E);
  EXPECT_EQ(rig.board.wifi_en_o, 0);
  // A line is missing: the frame is flagged as cut and the error LED lights.
  const cv::Mat1b black(kSensorHeight, kSensorWidth, std::uint8_t{0});
  rig.sensors[kLeft].frame(black.rowRange(1, kSensorHeight), {5, 20, 2000});
  rig.sensors[kRight].frame(black, {5, 20, 2000});
  rig.sensors[kLeft].idle(kSensorWidth + 20);
  for (auto& sensor : rig.sensors) sensor.frame(black, {5, 20, 2000});
  const AssembledFrame cut = rig.next_frame();
  EXPECT_EQ(cut.verdict, link::FrameVerdict::kFlagged);
  EXPECT_EQ(cut.flags, link::kCutFrame);
  EXPECT_EQ(rig.next_frame().verdict, link::FrameVerdict::kGood);
  EXPECT_EQ(rig.board.led_o >> 7, 1);
  rig.board.btn_i = 3;
  rig.run(20);
  EXPECT_GT(rig.board.led_o, 0);
  EXPECT_LT(rig.board.led_o, 4);
  rig.board.btn_i = 5;
  rig.run(20);
  EXPECT_EQ(rig.board.led_o, 0);
}

TEST(Board, SendsThePatternOverUsbAndResets) {
  BoardRig rig(1);
  const link::Identity identity = rig.identity();
  rig.apply_configuration(identity.build);
  rig.write(spec::kRegStreams, kDisparityStream);
  const auto [left, right] = make_pattern();
  const cv::Mat1w expected = rig.run_reference(left, right);
  // Both disparities of the pattern must appear.
  EXPECT_GT(cv::countNonZero(expected == kDisparityScale * kNearDisparity), kWidth * kHeight / 16);
  EXPECT_GT(cv::countNonZero(expected == kDisparityScale * kFarDisparity), kWidth * kHeight / 16);
  for (int i = 0; i < 3; ++i) {
    const AssembledFrame frame = rig.next_frame();
    ASSERT_EQ(frame.verdict, link::FrameVerdict::kGood) << frame.text();
    EXPECT_TRUE(same("disparity", expected, cv::Mat1w(frame.image)));
  }
  rig.board.btn_i = 0;
  rig.run(50);
  rig.board.btn_i = 1;
  rig.run(300);
  rig.discard_partial_packet();
  EXPECT_EQ(rig.read(spec::kRegStreams), 0U);
}

TEST(Board, SwitchesInputBetweenFrames) {
  BoardRig rig;
  rig.apply_configuration(rig.identity().build);
  rig.write(spec::kRegStreams, kDisparityStream);
  const cv::Mat1b black(kSensorHeight, kSensorWidth, std::uint8_t{0});
  const auto send = [&] {
    for (auto& sensor : rig.sensors) sensor.frame(black, {5, 20, 2000});
  };
  const cv::Mat1w dark = rig.run_reference(cv::Mat1b(kHeight, kWidth, std::uint8_t{0}),
                                           cv::Mat1b(kHeight, kWidth, std::uint8_t{0}));
  const auto [left, right] = make_pattern();
  const cv::Mat1w bright = rig.run_reference(left, right);
  // Switching to the pattern cuts the camera frame; all pattern frames are complete.
  send();
  rig.run(5000);
  rig.board.sw_i = 1;
  EXPECT_EQ(rig.next_frame().flags, link::kCutFrame);
  for (int i = 0; i < 2; ++i) {
    const AssembledFrame frame = rig.next_frame();
    ASSERT_EQ(frame.verdict, link::FrameVerdict::kGood) << frame.text();
    EXPECT_TRUE(same("disparity", bright, cv::Mat1w(frame.image)));
  }
  // Switching back happens in the middle of a pattern frame and of a camera frame.
  send();
  rig.run(5000);
  rig.board.sw_i = 0;
  send();
  const std::size_t from = rig.frames.size();
  rig.run_until([&] { return rig.sensors[0].done(); });
  rig.run(20000);
  ASSERT_GE(rig.frames.size(), from + 2);
  for (std::size_t i = from; i < rig.frames.size(); ++i) {
    SCOPED_TRACE(i - from);
    const AssembledFrame& frame = rig.frames[i];
    ASSERT_EQ(frame.verdict, link::FrameVerdict::kGood) << frame.text();
    const bool last = i + 1 == rig.frames.size();
    EXPECT_TRUE(same("disparity", last ? dark : bright, cv::Mat1w(frame.image)));
  }
}

TEST(Board, AppliesSettingsQuicklyWithThePatternOnTheSerialLine) {
  BoardRig rig(2);
  // Time that the serial line needs for one frame at two bytes per pixel.
  const std::int64_t line_clocks = std::int64_t{kWidth} * kHeight * 20 * kBitClocks;
  // Applying takes two requests, which need less than a tenth of that time.
  const auto apply = [&] {
    const std::uint32_t before = rig.read(spec::kRegConfiguration);
    const std::int64_t start = rig.clocks();
    rig.write(spec::kRegControl, 1);
    EXPECT_EQ(rig.read(spec::kRegConfiguration), before + 1);
    EXPECT_LT(rig.clocks() - start, line_clocks / 10);
  };
  rig.write(spec::kRegWidth, kWidth);
  rig.write(spec::kRegHeight, kHeight);
  apply();
  rig.board.sw_i = 3;
  rig.run(10000);
  apply();
  rig.write(spec::kRegStreams, kDisparityStream);
  rig.run(10000);
  // A frame with a stream enabled is as slow as the line, unless settings wait for its end.
  const std::uint32_t frames = rig.read(spec::kRegFramesIn);
  rig.run(20000);
  EXPECT_EQ(rig.read(spec::kRegFramesIn), frames);
  rig.write(spec::kRegUniqueness, 500);
  apply();
  EXPECT_GT(rig.read(spec::kRegFramesIn), frames);
}

TEST(Board, AccessesRegistersOverTheSerialLine) {
  BoardRig rig(2);
  expect_build(rig.identity());
  rig.write(spec::kRegUniqueness, 500);
  EXPECT_EQ(rig.read(spec::kRegUniqueness), 500U);
  // Over USB the registers have kept their values.
  rig.board.sw_i = 0;
  rig.run(300);
  EXPECT_EQ(rig.read(spec::kRegUniqueness), 500U);
}

}  // namespace
}  // namespace fpga_stereo::test
