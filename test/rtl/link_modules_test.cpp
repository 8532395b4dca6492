// Unit tests of the link's small modules.
#include <gtest/gtest.h>

#include <cstdint>
#include <random>
#include <vector>

#include "Crc32.h"
#include "Crc8.h"
#include "Heartbeat.h"
#include "InputSelect.h"
#include "Time.h"
#include "fpga_stereo/core/spec.hpp"
#include "link/packet.hpp"

namespace fpga_stereo::test {
namespace {

constexpr std::uint32_t kCrcStart = 0xFFFFFFFF;

/// Returns the CRC register after these bytes and, in `residue`, whether they end with their CRC.
template <class Model>
std::uint32_t register_after(const std::vector<std::uint8_t>& bytes, bool* residue = nullptr) {
  Model model;
  model.crc_i = kCrcStart;
  constexpr std::size_t kStep = sizeof(model.data_i);
  for (std::size_t at = 0; at < bytes.size(); at += kStep) {
    model.data_i = kStep == 4 ? link::get_u32(&bytes[at]) : bytes[at];
    model.eval();
    model.crc_i = model.crc_o;
  }
  model.eval();
  if (residue != nullptr) *residue = model.residue_o != 0;
  return model.crc_i;
}

TEST(RtlCrc32c, EqualsTheHostsCrc) {
  std::mt19937 random(1);
  for (std::size_t size = 0; size < 200; size += 4) {
    std::vector<std::uint8_t> bytes(size);
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
    const std::uint32_t crc = link::crc32c(bytes.data(), bytes.size());
    EXPECT_EQ(~register_after<Crc8>(bytes), crc);
    EXPECT_EQ(~register_after<Crc32>(bytes), crc);
    bytes.resize(size + 4);
    link::put_u32(&bytes[size], crc);
    bool right = false;
    register_after<Crc8>(bytes, &right);
    EXPECT_TRUE(right);
    register_after<Crc32>(bytes, &right);
    EXPECT_TRUE(right);
    bytes[random() % bytes.size()] ^= 0x10;
    register_after<Crc8>(bytes, &right);
    EXPECT_FALSE(right);
  }
}

template <class Model>
void clock(Model& model) {
  model.clk_i = 0;
  model.eval();
  model.clk_i = 1;
  model.eval();
}

TEST(RtlTime, CountsMicrosecondsWithoutDrift) {
  Time time;
  time.rst_ni = 0;
  clock(time);
  time.rst_ni = 1;
  constexpr std::uint64_t kClockHz = 3333333, kMicro = 1000000;
  std::uint64_t ms = 0;
  for (std::uint64_t clocks = 1; clocks <= 200000; ++clocks) {
    clock(time);
    ms += time.ms_o;
    // us_o lags by one clock.
    ASSERT_EQ(time.us_o, (clocks - 1) * kMicro / kClockHz) << clocks;
    ASSERT_EQ(ms, time.us_o / 1000);
  }
}

/// fs_heartbeat with one clock per millisecond and an output that is always ready.
struct HeartbeatRig {
  HeartbeatRig() {
    model.rst_ni = 0;
    clock(model);
    model.rst_ni = 1;
    model.ms_i = 1;
    model.ready_i = 1;
  }
  void receive_packet() {
    model.intact_i = 1;
    run(1);
    model.intact_i = 0;
  }
  void run(int ms) {
    for (; ms > 0; --ms) {
      clock(model);
      packets += model.valid_o != 0 && model.last_o != 0 ? 1 : 0;
    }
  }
  Heartbeat model;
  int packets = 0;
};

TEST(RtlHeartbeat, SendsOnlyWhileAHostIsHeard) {
  HeartbeatRig rig;
  rig.run(2 * kHeartbeatMs);
  EXPECT_FALSE(rig.model.alive_o);
  EXPECT_EQ(rig.packets, 0) << "no host has been heard";
  rig.receive_packet();
  rig.run(10);
  EXPECT_EQ(rig.packets, 1);
  rig.run(kHostTimeoutMs - 15);
  EXPECT_TRUE(rig.model.alive_o);
  EXPECT_EQ(rig.packets, kHostTimeoutMs / kHeartbeatMs);
  rig.receive_packet();
  rig.run(kHostTimeoutMs - 5);
  EXPECT_TRUE(rig.model.alive_o);
  EXPECT_EQ(rig.packets, 2 * kHostTimeoutMs / kHeartbeatMs);
  rig.run(10);
  EXPECT_FALSE(rig.model.alive_o);
  const int before = rig.packets;
  rig.run(4 * kHeartbeatMs);
  EXPECT_EQ(rig.packets, before);
  rig.receive_packet();
  rig.run(10);
  EXPECT_TRUE(rig.model.alive_o);
  EXPECT_EQ(rig.packets, before + 1);
}

/// fs_input_select with camera frames of 4 lines by 3 pixels.
class SelectRig {
 public:
  SelectRig() {
    model_.rst_ni = 0;
    clock(model_);
    model_.rst_ni = 1;
    model_.height_i = kLines;
    model_.ready_i = 1;
  }
  /// Offers pixel `at` of the camera stream; returns whether it was passed on.
  bool offer_camera_pixel(int at) {
    constexpr int kWidth = 3;
    at %= kWidth * kLines;
    model_.camera_i = (at == 0 ? 1 << 17 : 0) | (at % kWidth == kWidth - 1 ? 1 << 16 : 0) | at;
    model_.camera_valid_i = 1;
    model_.eval();
    const bool passed = model_.valid_o != 0 && model_.host_o == 0;
    EXPECT_TRUE(model_.camera_ready_o);
    step();
    model_.camera_valid_i = 0;
    return passed;
  }
  void step() {
    clock(model_);
    model_.frame_in_i = 0;
  }
  void run_ms(int ms) {
    for (; ms > 0; --ms) {
      model_.ms_i = 1;
      step();
      model_.ms_i = 0;
    }
  }
  InputSelect& model() { return model_; }
  static constexpr int kLines = 4, kFrame = 12;

 private:
  InputSelect model_;
};

TEST(RtlInputSelect, SwitchesBetweenFrames) {
  SelectRig rig;
  // Camera pixels pass from the first pixel of a frame on.
  for (int at = 5; at < SelectRig::kFrame; ++at) EXPECT_FALSE(rig.offer_camera_pixel(at));
  for (int at = 0; at < 7; ++at) EXPECT_TRUE(rig.offer_camera_pixel(at));
  rig.model().host_i = 1;
  for (int at = 7; at < SelectRig::kFrame; ++at) EXPECT_TRUE(rig.offer_camera_pixel(at));
  // The camera frame has not begun in the pipeline: a switch now would give it the host's tags.
  for (int at = 0; at < SelectRig::kFrame; ++at) {
    EXPECT_FALSE(rig.offer_camera_pixel(at));
    EXPECT_FALSE(rig.model().host_o);
  }
  rig.model().frame_in_i = 1;
  rig.step();
  rig.step();
  EXPECT_TRUE(rig.model().host_o);
  rig.model().input_valid_i = 1;
  rig.model().input_i = 1 << 17 | 77;
  rig.model().open_i = 1;
  rig.model().eval();
  EXPECT_TRUE(rig.model().valid_o && rig.model().input_ready_o);
  EXPECT_EQ(rig.model().data_o, 1U << 17 | 77U);
  rig.step();
  rig.model().input_valid_i = 0;
  // No switch back while a frame of the host is open or has not begun in the pipeline.
  rig.model().host_i = 0;
  for (int at = 0; at < 5; ++at) EXPECT_FALSE(rig.offer_camera_pixel(at));
  rig.model().open_i = 0;
  for (int at = 5; at < 8; ++at) EXPECT_FALSE(rig.offer_camera_pixel(at));
  EXPECT_TRUE(rig.model().held_o);
  rig.model().frame_in_i = 1;
  rig.step();
  rig.step();
  EXPECT_FALSE(rig.model().host_o);
  for (int at = 8; at < SelectRig::kFrame; ++at) EXPECT_FALSE(rig.offer_camera_pixel(at));
  for (int at = 0; at < SelectRig::kFrame; ++at) EXPECT_TRUE(rig.offer_camera_pixel(at));
}

TEST(RtlInputSelect, SwitchesToTheHostWhenCamerasAreSilent) {
  SelectRig rig;
  for (int at = 0; at < 7; ++at) EXPECT_TRUE(rig.offer_camera_pixel(at));
  rig.model().frame_in_i = 1;
  rig.step();
  rig.model().host_i = 1;
  rig.run_ms(2);
  EXPECT_FALSE(rig.model().host_o);
  EXPECT_TRUE(rig.offer_camera_pixel(7));
  rig.run_ms(2);
  EXPECT_FALSE(rig.model().host_o);
  rig.run_ms(2);
  rig.step();
  EXPECT_TRUE(rig.model().host_o);
}

}  // namespace
}  // namespace fpga_stereo::test
