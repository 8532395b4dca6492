// fs_cameras and fs_input: a bad frame must not damage its neighbours. A frame is larger than all
// FIFOs between the sensors and the pipeline.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "CameraRaster.h"
#include "rtl/link/sensor_port.hpp"

namespace fpga_stereo::test {
namespace {

constexpr int kWidth = 32, kHeight = 48;
constexpr int kRowClocks = 4 * (kWidth + 4);  // core clocks per sensor row

struct Frame {
  std::vector<int> pixels;  // left << 8 | right
  bool is_cut = false, is_long = false;
  bool operator==(const Frame& other) const {
    return pixels == other.pixels && is_cut == other.is_cut && is_long == other.is_long;
  }
};
void PrintTo(const Frame& frame, std::ostream* out) {
  *out << frame.pixels.size() << " pixels" << (frame.is_cut ? ", cut" : "")
       << (frame.is_long ? ", long" : "");
}

class RasterRig {
 public:
  explicit RasterRig(unsigned seed) : random_(seed) {
    model.room_i = 1;
    run(50);
    model.rst_ni = 1;
    run(50);
  }

  cv::Mat1b image() {
    cv::Mat1b image(kHeight, kWidth);
    for (auto& pixel : image) pixel = static_cast<std::uint8_t>(1 + random_() % 255);
    return image;
  }
  /// Sends a pair and expects it to come out complete.
  void send() {
    const cv::Mat1b left = image(), right = image();
    sensors[1].frame(left, kBlanking);
    sensors[0].frame(right, kBlanking);
    Frame frame;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) frame.pixels.push_back(left(y, x) << 8 | right(y, x));
    }
    expected.push_back(frame);
  }
  /// Sends a pair in which the sensors of `damaged_sensors` (a bit for each) send only the first
  /// `pixels_left` pixels of a row.
  void send_damaged(int damaged_sensors, int row, int pixels_left) {
    for (int k = 0; k < 2; ++k) {
      const cv::Mat1b pixels = image();
      sensors[k].blank(kBlanking.before_first);
      for (int y = 0; y < kHeight; ++y) {
        const int kept = y == row && (damaged_sensors >> k & 1) != 0 ? pixels_left : kWidth;
        sensors[k].line(pixels[y], kept);
        sensors[k].blank(kWidth - kept + kBlanking.lines);
      }
      sensors[k].idle(kBlanking.frame);
    }
  }
  /// Runs until both sensors have sent everything and the pipeline has received it.
  void finish() {
    for (int i = 0; i < 40000 && !(sensors[0].done() && sensors[1].done()); ++i) run(10);
    ASSERT_TRUE(sensors[0].done() && sensors[1].done());
    run(kHeight * kWidth + 2000);
  }
  /// Runs core clocks; a sensor clock takes four of them.
  void run(int clocks) {
    for (; clocks > 0; --clocks) {
      model.eval();
      if (model.en_o && model.valid_o) {
        if (model.sof_o) frames.emplace_back();
        if (!frames.empty()) frames.back().pixels.push_back(model.left_o << 8 | model.right_o);
      }
      if (!frames.empty()) {
        frames.back().is_cut |= model.cut_frame_o != 0;
        frames.back().is_long |= model.long_frame_o != 0;
      }
      model.clk_i = 1;
      if (sensors_run) model.pixclk_i = clock_ == 0 ? 1 : clock_ == 2 ? 2 : 0;
      model.eval();
      model.clk_i = 0, model.pixclk_i = 0;
      model.eval();
      if (sensors_run && clock_ % 2 == 0) show(clock_ / 2);
      clock_ = (clock_ + 1) % 4;
    }
  }
  /// Returns the received frames that are neither cut nor long.
  std::vector<Frame> intact_frames() const {
    std::vector<Frame> intact;
    for (const Frame& frame : frames) {
      if (!frame.is_cut && !frame.is_long) intact.push_back(frame);
    }
    return intact;
  }

  CameraRaster model;
  SensorPort sensors[2];  // right, left
  std::vector<Frame> frames, expected;
  bool sensors_run = true;

 private:
  static constexpr SensorPort::Blanking kBlanking = {3, 4, 60};

  void show(int k) {
    const SensorPort::Pins pins = sensors[k].next();
    const unsigned bit = 1U << k;
    model.frame_valid_i = (model.frame_valid_i & ~bit) | (pins.frame ? bit : 0);
    model.line_valid_i = (model.line_valid_i & ~bit) | (pins.line ? bit : 0);
    model.data_i = (model.data_i & ~(0xFF << 8 * k)) | pins.data << 8 * k;
  }

  std::mt19937 random_;
  int clock_ = 0;
};

TEST(RtlCameraRaster, ADamagedFrameLeavesOthersIntact) {
  // {row, pixels sent of it}: early and late in the frame, the last pixel or the last two missing,
  // and a first line of one pixel.
  const int damages[][2] = {
      {2, kWidth - 1}, {30, 7}, {kHeight - 1, kWidth - 1}, {kHeight - 1, kWidth - 2}, {0, 1}};
  for (const auto& [row, pixels] : damages) {
    for (int damaged_sensors = 1; damaged_sensors <= 3; ++damaged_sensors) {
      SCOPED_TRACE(testing::Message() << "row " << row << ", sensors " << damaged_sensors);
      RasterRig rig(10 * row + damaged_sensors);
      rig.send();
      rig.send_damaged(damaged_sensors, row, pixels);
      for (int i = 0; i < 3; ++i) rig.send();
      rig.finish();
      EXPECT_EQ(rig.intact_frames(), rig.expected);
      // A frame goes out only once its first line has more than one pixel.
      ASSERT_EQ(rig.frames.size(), row == 0 ? 4U : 5U);
      EXPECT_EQ(rig.frames[1].is_cut, row != 0);
    }
  }
}

TEST(RtlCameraRaster, AFrameStalledTooLongLeavesOthersIntact) {
  for (const int row : {0, 5, 20}) {
    SCOPED_TRACE(row);
    RasterRig rig(row);
    rig.send();
    rig.send();
    rig.expected.pop_back();
    rig.send();
    rig.send();
    const auto run_until_begun = [&](std::size_t frames) {
      for (int i = 0; i < 100000 && rig.frames.size() < frames; ++i) rig.run(1);
      ASSERT_EQ(rig.frames.size(), frames);
    };
    run_until_begun(2);
    rig.run(row * kRowClocks);
    rig.model.room_i = 0;
    rig.run(12 * kRowClocks);
    rig.model.room_i = 1;
    rig.finish();
    EXPECT_EQ(rig.intact_frames(), rig.expected);
    ASSERT_EQ(rig.frames.size(), 4U);
    EXPECT_TRUE(rig.frames[1].is_cut);
  }
}

TEST(RtlCameraRaster, CompletesAFrameWhoseSensorsStop) {
  RasterRig rig(1);
  rig.send();
  rig.send();
  rig.expected.pop_back();
  for (int i = 0; i < 100000 && rig.frames.size() < 2; ++i) rig.run(1);
  rig.run(3 * kRowClocks);
  rig.sensors_run = false;
  rig.run(1000 + kHeight * kWidth + 200);
  ASSERT_EQ(rig.frames.size(), 2U);
  EXPECT_EQ(rig.frames[1].pixels.size(), std::size_t{kWidth * kHeight});
  EXPECT_TRUE(rig.frames[1].is_cut);
  // The rest of the frame is dropped when the sensors continue.
  rig.sensors_run = true;
  rig.send();
  rig.finish();
  EXPECT_EQ(rig.intact_frames(), rig.expected);
  EXPECT_EQ(rig.frames.size(), 3U);
}

}  // namespace
}  // namespace fpga_stereo::test
