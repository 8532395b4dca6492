// Models an image sensor as the FPGA sees it: a parallel port, and registers on a two-wire bus.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <deque>
#include <opencv2/core.hpp>
#include <utility>
#include <vector>

namespace fpga_stereo::test {

/// The parallel port: a queue of pin states, one for each clock. The pins change after the falling
/// edge.
class SensorPort {
 public:
  struct Pins {
    bool frame = false, line = false;
    std::uint8_t data = 0;
  };
  /// Clocks without pixels.
  struct Blanking {
    int before_first = 3, lines = 4, frame = 40;
  };

  /// Appends clocks between frames.
  void idle(int clocks) { pins_.insert(pins_.end(), clocks, Pins{}); }
  /// Appends clocks between lines.
  void blank(int clocks, bool frame = true) {
    pins_.insert(pins_.end(), clocks, Pins{frame, false, 0xEE});
  }
  /// Appends a line.
  void line(const std::uint8_t* pixels, int count) {
    for (int x = 0; x < count; ++x) pins_.push_back({true, true, pixels[x]});
  }
  /// Appends a whole frame and the clocks after it.
  void frame(const cv::Mat1b& image, const Blanking& blanking) {
    blank(blanking.before_first);
    for (int y = 0; y < image.rows; ++y) {
      line(image[y], image.cols);
      blank(blanking.lines);
    }
    idle(blanking.frame);
  }
  bool done() const { return pins_.empty(); }
  /// Returns the pin states of the next clock; the sensor is idle when the queue is empty.
  Pins next() {
    if (pins_.empty()) return {};
    const Pins pins = pins_.front();
    pins_.pop_front();
    return pins;
  }

 private:
  std::deque<Pins> pins_;
};

/// The registers: a two-wire slave that records all writes.
class TwoWireSensor {
 public:
  explicit TwoWireSensor(std::uint8_t address) : address_(address) {}

  /// Call it in each clock of a reset. Discards the current transfer.
  void reset() {
    scl_ = sda_ = true;
    in_transfer_ = false;
  }
  /// Call it in each clock with the levels of both lines; returns whether the sensor pulls SDA low.
  bool clock(bool scl, bool sda) {
    ++clocks_since_edge_;
    if (scl && scl_ && sda != sda_) {
      // SDA changes while SCL is high: a start or a stop condition.
      if (!sda) {
        bytes_.clear();
      } else if (in_transfer_ && is_addressed_) {
        EXPECT_EQ(bits_, 0) << "stop condition in the middle of a byte";
        EXPECT_EQ(bytes_.size(), 4U);
        if (bytes_.size() == 4) {
          writes.emplace_back(bytes_[1], static_cast<std::uint16_t>(bytes_[2] << 8 | bytes_[3]));
        }
      }
      in_transfer_ = !sda, is_addressed_ = true, bits_ = 0, shift_ = 0, pulls_low_ = false;
    }
    if (scl != scl_) {
      if (in_transfer_) min_phase_clocks = std::min(min_phase_clocks, clocks_since_edge_);
      clocks_since_edge_ = 0;
    }
    if (in_transfer_ && scl && !scl_) {
      if (bits_ < 8) shift_ = shift_ << 1 | (sda ? 1 : 0);
    }
    // The sensor acknowledges in the ninth bit: from the eighth falling edge after the start
    // condition's to the ninth.
    if (in_transfer_ && !scl && scl_) {
      if (has_fallen_) ++bits_;
      has_fallen_ = true;
      if (bits_ == 8) {
        bytes_.push_back(static_cast<std::uint8_t>(shift_));
        if (bytes_.size() == 1) is_addressed_ = bytes_[0] == address_ << 1;
        pulls_low_ = is_addressed_;
      } else {
        pulls_low_ = false;
        if (bits_ == 9) bits_ = 0, shift_ = 0;
      }
    }
    if (!in_transfer_) has_fallen_ = false;
    scl_ = scl, sda_ = sda;
    return pulls_low_;
  }

  std::vector<std::pair<int, int>> writes;  // register, value
  int min_phase_clocks = 1 << 30;           // of SCL high or low within a transfer

 private:
  std::uint8_t address_;  // 7 bits
  bool scl_ = true, sda_ = true, in_transfer_ = false, is_addressed_ = true, pulls_low_ = false,
       has_fallen_ = false;
  int bits_ = 0, clocks_since_edge_ = 0;
  unsigned shift_ = 0;
  std::vector<std::uint8_t> bytes_;
};

}  // namespace fpga_stereo::test
