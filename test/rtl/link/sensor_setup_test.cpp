// fs_sensor_setup with two sensors on its two-wire buses.
#include <gtest/gtest.h>

#include <cstdint>
#include <utility>
#include <vector>

#include "SensorSetup.h"
#include "rtl/link/sensor_port.hpp"

namespace fpga_stereo::test {
namespace {

/// fs_sensor_setup and two sensors. A quarter of a bit takes 4 clocks, a millisecond 400.
class SensorSetupRig {
 public:
  using Writes = std::vector<std::pair<int, int>>;

  SensorSetupRig(std::uint8_t left, std::uint8_t right)
      : sensors{TwoWireSensor(right), TwoWireSensor(left)} {
    clock(4);
    model.rst_ni = 1;
  }
  void clock(int clocks) {
    for (; clocks > 0; --clocks) {
      model.register_i = 0x30 + model.index_o;
      model.value_i = 0xA55A ^ (model.index_o << 6);
      model.last_i = model.index_o == 2;
      bool pulls[2];
      for (int k = 0; k < 2; ++k) {
        pulls[k] = sensors[k].clock(!model.scl_low_o, !model.sda_low_o && !pulls_[k]);
      }
      for (int k = 0; k < 2; ++k) pulls_[k] = pulls[k] && connected[k];
      model.sda_i = (model.sda_low_o || pulls_[0] ? 0 : 1) | (model.sda_low_o || pulls_[1] ? 0 : 2);
      if (!model.sensor_rst_no) ++reset_clocks;
      model.eval();
      model.clk_i = 1;
      model.eval();
      model.clk_i = 0;
      model.eval();
    }
  }
  void run_ms(int count) { clock(400 * count); }

  SensorSetup model;
  TwoWireSensor sensors[2];
  bool connected[2] = {true, true};
  int reset_clocks = 0;

 private:
  bool pulls_[2] = {false, false};
};

const SensorSetupRig::Writes kExpectedWrites = {{0x30, 0xA55A}, {0x31, 0xA51A}, {0x32, 0xA5DA}};

TEST(RtlSensorSetup, WritesTheTableToBothSensors) {
  SensorSetupRig rig(0x48, 0x48);
  rig.run_ms(10);
  EXPECT_EQ(rig.model.answered_o, 3);
  EXPECT_EQ(rig.sensors[0].writes, kExpectedWrites);
  EXPECT_EQ(rig.sensors[1].writes, kExpectedWrites);
  EXPECT_GE(rig.reset_clocks, 400);
  EXPECT_LE(rig.reset_clocks, 820);
  EXPECT_EQ(rig.sensors[0].min_phase_clocks, 8);  // half a bit
  // It idles while frames arrive and writes the table again when they stop.
  for (int i = 0; i < 10; ++i) {
    rig.run_ms(15);
    rig.model.frame_i = 1;
    rig.clock(1);
    rig.model.frame_i = 0;
  }
  EXPECT_EQ(rig.sensors[0].writes, kExpectedWrites);
  rig.run_ms(30);
  EXPECT_EQ(rig.sensors[0].writes.size(), 6U);
  EXPECT_EQ(rig.sensors[1].writes.size(), 6U);
  EXPECT_GE(rig.reset_clocks, 800);
}

TEST(RtlSensorSetup, FindsTheAddress) {
  for (const int address : {0x4C, 0x58, 0x5C}) {
    SensorSetupRig rig(address, address);
    rig.run_ms(350);
    EXPECT_EQ(rig.model.answered_o, 3);
    ASSERT_GE(rig.sensors[1].writes.size(), 3U);
    EXPECT_EQ(
        SensorSetupRig::Writes(rig.sensors[1].writes.begin(), rig.sensors[1].writes.begin() + 3),
        kExpectedWrites);
  }
}

TEST(RtlSensorSetup, ReportsWhichSensorDoesNotAnswer) {
  for (const int missing : {0, 1}) {
    SensorSetupRig rig(0x48, 0x48);
    rig.connected[missing] = false;
    rig.run_ms(50);
    EXPECT_EQ(rig.model.answered_o, 3 & ~(1 << missing));
    rig.connected[missing] = true;
    rig.run_ms(500);
    EXPECT_EQ(rig.model.answered_o, 3);
  }
}

}  // namespace
}  // namespace fpga_stereo::test
