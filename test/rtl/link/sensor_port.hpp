// Image sensors as the FPGA sees them: a parallel port, and registers on a two-wire bus.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <deque>
#include <opencv2/core.hpp>
#include <utility>
#include <vector>

namespace fpga_stereo::test {

/// The parallel port: what it shows, clock by clock. Outputs change behind the falling edge.
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

  void idle(int clocks) { pins_.insert(pins_.end(), clocks, Pins{}); }
  void blank(int clocks, bool frame = true) {
    pins_.insert(pins_.end(), clocks, Pins{frame, false, 0xEE});
  }
  void line(const std::uint8_t* pixels, int count) {
    for (int x = 0; x < count; ++x) pins_.push_back({true, true, pixels[x]});
  }
  void frame(const cv::Mat1b& image, const Blanking& blanking) {
    blank(blanking.before_first);
    for (int y = 0; y < image.rows; ++y) {
      line(image[y], image.cols);
      blank(blanking.lines);
    }
    idle(blanking.frame);
  }
  bool done() const { return pins_.empty(); }
  /// In the next clock.
  Pins next() {
    if (pins_.empty()) return {};
    const Pins pins = pins_.front();
    pins_.pop_front();
    return pins;
  }

 private:
  std::deque<Pins> pins_;
};

/// The registers: a two-wire slave that notes what is written.
class TwoWireSensor {
 public:
  explicit TwoWireSensor(std::uint8_t address) : address_(address) {}

  /// A reset that is under way: what was being written is forgotten.
  void reset() {
    scl_ = sda_ = true;
    open_ = false;
  }
  /// In each clock the lines as they are; gives whether the sensor pulls SDA low.
  bool clock(bool scl, bool sda) {
    ++since_;
    if (scl && scl_ && sda != sda_) {
      // SDA moves while SCL is high: a start or a stop.
      if (!sda) {
        bytes_.clear();
      } else if (open_ && chosen_) {
        EXPECT_EQ(bits_, 0) << "a stop within a byte";
        EXPECT_EQ(bytes_.size(), 4U);
        if (bytes_.size() == 4) {
          writes.emplace_back(bytes_[1], static_cast<std::uint16_t>(bytes_[2] << 8 | bytes_[3]));
        }
      }
      open_ = !sda, chosen_ = true, bits_ = 0, shift_ = 0, pulls_ = false;
    }
    if (scl != scl_) {
      if (open_) shortest = std::min(shortest, since_);
      since_ = 0;
    }
    if (open_ && scl && !scl_) {
      if (bits_ < 8) shift_ = shift_ << 1 | (sda ? 1 : 0);
    }
    // The ninth bit is ours: from the eighth falling edge behind the start's to the ninth.
    if (open_ && !scl && scl_) {
      if (fell_) ++bits_;
      fell_ = true;
      if (bits_ == 8) {
        bytes_.push_back(static_cast<std::uint8_t>(shift_));
        if (bytes_.size() == 1) chosen_ = bytes_[0] == address_ << 1;
        pulls_ = chosen_;
      } else {
        pulls_ = false;
        if (bits_ == 9) bits_ = 0, shift_ = 0;
      }
    }
    if (!open_) fell_ = false;
    scl_ = scl, sda_ = sda;
    return pulls_;
  }

  std::vector<std::pair<int, int>> writes;  // register, value
  int shortest = 1 << 30;                   // clocks of SCL high or low within a transfer

 private:
  std::uint8_t address_;  // 7 bits
  bool scl_ = true, sda_ = true, open_ = false, chosen_ = true, pulls_ = false, fell_ = false;
  int bits_ = 0, since_ = 0;
  unsigned shift_ = 0;
  std::vector<std::uint8_t> bytes_;
};

}  // namespace fpga_stereo::test
