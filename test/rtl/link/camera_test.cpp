// fs_cameras with two sensors that may fail and an output that may stall.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "Cameras.h"
#include "rtl/link/sensor_port.hpp"

namespace fpga_stereo::test {
namespace {

constexpr int kWidth = 20, kHeight = 6;  // of the sensors
constexpr int kMaxSkew = 40;             // clocks
constexpr int kLeft = 1, kRight = 0;     // bit in vectors of ports

/// One word of the output stream.
struct Pair {
  bool sof, eol;
  std::uint8_t left, right;
  bool operator==(const Pair& other) const {
    return sof == other.sof && eol == other.eol && left == other.left && right == other.right;
  }
};
using Frame = std::vector<Pair>;

class CamerasRig {
 public:
  CamerasRig(int width, int height, unsigned seed) : random(seed) {
    model.width_i = width, model.height_i = height;
    for (auto& next : next_) next = random() % 400;
    model.rst_ni = 0;
    run(100);
    model.rst_ni = 1;
    run(100);
  }

  /// Returns a pair of random images.
  std::pair<cv::Mat1b, cv::Mat1b> images() {
    cv::Mat1b left(kHeight, kWidth), right(kHeight, kWidth);
    for (auto& pixel : left) pixel = static_cast<std::uint8_t>(random());
    for (auto& pixel : right) pixel = static_cast<std::uint8_t>(random());
    return {left, right};
  }
  /// Sends a random pair; returns the expected output.
  Frame send() {
    const auto [left, right] = images();
    sensors[kLeft].frame(left, blanking);
    sensors[kRight].frame(right, blanking);
    return expected(left, right);
  }
  /// Returns the expected output for a pair: the middle of both images.
  Frame expected(const cv::Mat1b& left, const cv::Mat1b& right) const {
    const int w = model.width_i, h = model.height_i;
    const int x0 = (kWidth - w) / 2, y0 = (kHeight - h) / 2;
    Frame frame;
    for (int y = 0; y < h; ++y) {
      for (int x = 0; x < w; ++x) {
        frame.push_back(
            {x == 0 && y == 0, x == w - 1, left(y0 + y, x0 + x), right(y0 + y, x0 + x)});
      }
    }
    return frame;
  }

  /// Runs until the sensors have sent everything and the FIFOs are empty.
  void finish() {
    for (int i = 0; i < 20000 && !(sensors[0].done() && sensors[1].done()); ++i) run(10);
    ASSERT_TRUE(sensors[0].done() && sensors[1].done());
    run(3000);
  }
  void run(int edges) {
    for (; edges > 0; --edges) step();
  }
  /// Returns the output split at sof, without frames that are too short.
  std::vector<Frame> complete_frames() const {
    std::vector<Frame> frames;
    for (const Pair& pair : out) {
      if (pair.sof) frames.emplace_back();
      if (!frames.empty()) frames.back().push_back(pair);
    }
    const auto pixels = static_cast<std::size_t>(model.width_i * model.height_i);
    frames.erase(std::remove_if(frames.begin(), frames.end(),
                                [&](const Frame& frame) { return frame.size() < pixels; }),
                 frames.end());
    return frames;
  }

  Cameras model;
  std::mt19937 random;
  SensorPort sensors[2];
  SensorPort::Blanking blanking;
  std::vector<Pair> out;
  double ready_chance = 1;
  bool pixclk_runs[2] = {true, true};
  int complete_pairs = 0;  // pulses of frame_o

 private:
  /// Runs to the next rising edge: 0 and 1 are the sensors' clocks, 2 is the core's.
  void step() {
    const auto which = std::min_element(next_, next_ + 3) - next_;
    next_[which] += which == 2 ? 97 + random() % 6 : 400;
    model.eval();
    const bool is_taken = model.valid_o && model.ready_i;
    if (which == 2) {
      if (is_taken) {
        out.push_back({model.sof_o != 0, model.eol_o != 0, model.left_o, model.right_o});
      }
      complete_pairs += model.frame_o;
      model.clk_i = 1;
    } else if (pixclk_runs[which]) {
      model.pixclk_i |= 1 << which;
    }
    model.eval();
    model.clk_i = 0, model.pixclk_i = 0;
    model.eval();
    if (which == 2) {
      model.ready_i = random() < ready_chance * 4294967296.;
    } else if (pixclk_runs[which]) {
      const SensorPort::Pins pins = sensors[which].next();
      const unsigned bit = 1U << which;
      model.frame_valid_i = (model.frame_valid_i & ~bit) | (pins.frame ? bit : 0);
      model.line_valid_i = (model.line_valid_i & ~bit) | (pins.line ? bit : 0);
      model.data_i = (model.data_i & ~(0xFF << 8 * which)) | pins.data << 8 * which;
    }
    model.eval();
  }

  std::uint64_t next_[3] = {0, 0, 0};
};

TEST(RtlCameras, PutsOutTheMiddleOfEveryPair) {
  const int sizes[][2] = {{20, 6}, {16, 4}, {17, 5}, {19, 1}, {20, 3}, {16, 6}};
  for (unsigned seed = 0; seed < 36; ++seed) {
    SCOPED_TRACE(seed);
    CamerasRig rig(sizes[seed % 6][0], sizes[seed % 6][1], seed);
    rig.ready_chance = seed % 4 == 0 ? 0.5 : 1;
    rig.blanking = {static_cast<int>(1 + rig.random() % 5), static_cast<int>(1 + rig.random() % 9),
                    static_cast<int>(1 + rig.random() % 60)};
    // One sensor starts a few clocks after the other.
    rig.sensors[seed / 6 % 2].idle(static_cast<int>(rig.random() % 9));
    std::vector<Frame> expected;
    for (int i = 0; i < 4; ++i) expected.push_back(rig.send());
    rig.finish();
    ASSERT_EQ(rig.complete_frames(), expected);
    std::size_t pixels = 0;
    for (const Frame& frame : expected) pixels += frame.size();
    EXPECT_EQ(rig.out.size(), pixels);
    EXPECT_EQ(rig.complete_pairs, 4);
    EXPECT_EQ(rig.model.errors_o, 0);
    EXPECT_EQ(rig.model.overruns_o, 0);
  }
}

enum class Fault { kLostLine, kLostPixel, kSurplusPixel, kSplitLine, kSurplusLine, kFrameGlitch };

/// Sends an image with a fault in `row`.
void send_damaged(SensorPort& sensor, const cv::Mat1b& image, const SensorPort::Blanking& blanking,
                  Fault fault, int row) {
  sensor.blank(blanking.before_first);
  for (int y = 0; y < image.rows; ++y) {
    const std::uint8_t* const pixels = image[y];
    if (y != row) {
      sensor.line(pixels, kWidth);
    } else {
      switch (fault) {
        case Fault::kLostLine:
          sensor.blank(kWidth);
          break;
        case Fault::kLostPixel:
          sensor.line(pixels, kWidth - 1);
          sensor.blank(1);
          break;
        case Fault::kSurplusPixel:
          sensor.line(pixels, kWidth);
          sensor.line(pixels, 1);
          break;
        case Fault::kSplitLine:
          sensor.line(pixels, 7);
          sensor.blank(1);
          sensor.line(pixels + 8, kWidth - 8);
          break;
        case Fault::kSurplusLine:
          sensor.line(pixels, kWidth);
          sensor.blank(blanking.lines);
          sensor.line(pixels, kWidth);
          break;
        case Fault::kFrameGlitch:
          sensor.line(pixels, 5);
          sensor.idle(1);
          sensor.line(pixels + 6, kWidth - 6);
          break;
      }
    }
    sensor.blank(blanking.lines);
  }
  sensor.idle(blanking.frame);
}

TEST(RtlCameras, NeverCompletesAFrameThatASensorDamages) {
  // At 4 of 6 rows, the first and the last row are not put out, but their faults still count.
  for (const int height : {6, 4}) {
    for (int fault = 0; fault <= static_cast<int>(Fault::kFrameGlitch); ++fault) {
      for (int row = 0; row < kHeight; ++row) {
        for (int faulty_sensor = 0; faulty_sensor < 3; ++faulty_sensor) {  // 2: both
          SCOPED_TRACE(testing::Message() << height << " rows, fault " << fault << " in row " << row
                                          << " of sensor " << faulty_sensor);
          CamerasRig rig(16, height, fault * 100 + row * 10 + faulty_sensor);
          rig.blanking.frame = 200;
          std::vector<Frame> expected = {rig.send()};
          const auto [left, right] = rig.images();
          for (const int k : {kLeft, kRight}) {
            const cv::Mat1b& image = k == kLeft ? left : right;
            if (faulty_sensor == k || faulty_sensor == 2) {
              send_damaged(rig.sensors[k], image, rig.blanking, static_cast<Fault>(fault), row);
            } else {
              rig.sensors[k].frame(image, rig.blanking);
            }
          }
          // The intact sensor waits in the blanking if the fault took extra clocks.
          if (faulty_sensor != 2) {
            SensorPort& intact = rig.sensors[1 - faulty_sensor];
            intact.idle(static_cast<int>(fault == 4) * (kWidth + 4));
            intact.idle(static_cast<int>(fault == 2));
          }
          expected.push_back(rig.send());
          rig.finish();
          ASSERT_EQ(rig.complete_frames(), expected);
          EXPECT_GT(rig.model.errors_o, 0);
        }
      }
    }
  }
}

TEST(RtlCameras, NeverPairsFramesOfDifferentExposures) {
  for (const int faulty_sensor : {kLeft, kRight}) {
    CamerasRig rig(16, 4, faulty_sensor);
    std::vector<Frame> expected = {rig.send(), rig.send()};
    // One sensor skips a frame.
    const auto [left, right] = rig.images();
    rig.sensors[1 - faulty_sensor].frame(left, rig.blanking);
    rig.sensors[faulty_sensor].idle(3 + kHeight * (kWidth + 4) + 40);
    expected.push_back(rig.send());
    // One sensor is late for two frames; once in step again, they form pairs.
    rig.sensors[faulty_sensor].idle(kMaxSkew / 4 + 5);
    rig.send(), rig.send();
    rig.sensors[1 - faulty_sensor].idle(kMaxSkew / 4 + 5);
    expected.push_back(rig.send());
    rig.finish();
    EXPECT_EQ(rig.complete_frames(), expected);
    EXPECT_GE(rig.model.errors_o, 3);
    // One sensor's clock stops in the middle of a line for three frames.
    rig.send();
    rig.run(2000);
    rig.pixclk_runs[faulty_sensor] = false;
    for (int i = 0; i < 3; ++i) rig.sensors[1 - faulty_sensor].frame(left, rig.blanking);
    rig.run(20000);
    EXPECT_TRUE(rig.sensors[1 - faulty_sensor].done());
    rig.pixclk_runs[faulty_sensor] = true;
    rig.finish();
    rig.out.clear();
    const Frame last = rig.send();
    rig.finish();
    EXPECT_EQ(rig.complete_frames(), std::vector<Frame>{last});
  }
}

TEST(RtlCameras, LosesWholeFramesWhenTheOutputStalls) {
  CamerasRig rig(20, 6, 5);
  rig.model.rst_ni = 1;
  // Nothing is lost while the FIFO has space, 128 words and the registers before it.
  rig.ready_chance = 0;
  std::vector<Frame> expected = {rig.send()};
  rig.finish();
  rig.ready_chance = 1;
  rig.run(1000);
  expected.push_back(rig.send());
  rig.finish();
  EXPECT_EQ(rig.complete_frames(), expected);
  EXPECT_EQ(rig.model.overruns_o, 0);
  EXPECT_EQ(rig.model.errors_o, 0);
  // Longer stalls lose frames. The complete ones that come out were sent, in this order.
  std::vector<Frame> sent;
  rig.out.clear();
  for (int i = 0; i < 12; ++i) sent.push_back(rig.send());
  for (int i = 0; i < 400; ++i) {
    rig.ready_chance = i % 40 < 22 ? 0 : 1;
    rig.run(100);
  }
  rig.ready_chance = 1;
  rig.finish();
  EXPECT_GT(rig.model.overruns_o, 0);
  const auto frames = rig.complete_frames();
  EXPECT_GT(frames.size(), 2U);
  EXPECT_LT(frames.size(), sent.size());
  auto from = sent.begin();
  for (const Frame& frame : frames) {
    from = std::find(from, sent.end(), frame);
    ASSERT_NE(from, sent.end()) << "frame was not sent or is out of order";
    ++from;
  }
  rig.out.clear();
  const Frame last = rig.send();
  rig.finish();
  EXPECT_EQ(rig.complete_frames(), std::vector<Frame>{last});
}

TEST(RtlCameras, CountsAnOverrunOncePerFrameAndSensor) {
  CamerasRig rig(20, 6, 7);
  rig.ready_chance = 0;
  // The first frame occupies 120 words, so the FIFO has no space for all of the second one.
  for (int i = 0; i < 5; ++i) rig.send();
  rig.finish();
  EXPECT_EQ(rig.model.overruns_o, 8);
}

TEST(RtlCameras, ANewSizeAppliesToTheNextFrame) {
  CamerasRig rig(20, 6, 6);
  EXPECT_EQ((rig.finish(), rig.send(), rig.finish(), rig.complete_frames().size()), 1U);
  rig.out.clear();
  rig.model.width_i = 16, rig.model.height_i = 2;
  const Frame smaller = rig.send();
  rig.finish();
  EXPECT_EQ(rig.complete_frames(), std::vector<Frame>{smaller});
  // No frame is complete at a size larger than the sensors.
  rig.out.clear();
  rig.model.width_i = 21, rig.model.height_i = 6;
  rig.sensors[0].idle(1), rig.sensors[1].idle(1);
  const auto [left, right] = rig.images();
  rig.sensors[kLeft].frame(left, rig.blanking);
  rig.sensors[kRight].frame(right, rig.blanking);
  rig.finish();
  EXPECT_TRUE(rig.complete_frames().empty());
}

}  // namespace
}  // namespace fpga_stereo::test
