// Loads and unloads the nodelet many times with frames in flight. A build with AddressSanitizer
// finds leaks and use after free here.
#include <gtest/gtest.h>
#include <nodelet/loader.h>
#include <stereo_msgs/DisparityImage.h>

#include <atomic>
#include <cstdlib>
#include <fstream>
#include <thread>

#include "ros/rig.hpp"

namespace fpga_stereo::test {
namespace {

constexpr int kCycles = 500;
constexpr int kWarmUp = 100;  // cycles until caches are full

/// Returns the resident memory in MiB.
[[maybe_unused]] double resident() {
  std::ifstream statm("/proc/self/statm");
  double total = 0;
  double pages = 0;
  statm >> total >> pages;
  return pages * 4096 / (1 << 20);
}

TEST(StartStop, FiveHundredTimesWithFramesInFlight) {
  Rig rig;
  // Counts without keeping messages, because the test measures memory.
  std::atomic<int> disparities{0};
  const ros::Subscriber subscriber = rig.nh().subscribe<stereo_msgs::DisparityImage>(
      "disparity", 1, [&](const stereo_msgs::DisparityImage::ConstPtr&) { ++disparities; });
  std::atomic<bool> stop{false};
  std::thread camera([&] {
    const PairMessages pair = synthetic_pair({64, 48}, 5);
    while (!stop) {
      rig.publish(pair);
      ros::WallDuration(0.002).sleep();
    }
  });
  nodelet::Loader loader(false);
  [[maybe_unused]] double settled = 0;
  int seen_output = 0;
  for (int cycle = 0; cycle < kCycles; ++cycle) {
    if (cycle == kWarmUp) settled = resident();
    const int before = disparities;
    ASSERT_TRUE(loader.load("/stereo/fpga_stereo", "fpga_stereo/stereo", {}, {})) << cycle;
    // Unload at once, while connecting, and with frames in flight.
    if (cycle % 3 == 1) ros::WallDuration(0.01).sleep();
    if (cycle % 3 == 2) {
      seen_output += eventually([&] { return disparities > before; }, 5);
    }
    ASSERT_TRUE(loader.unload("/stereo/fpga_stereo")) << cycle;
    // A running callback keeps the nodelet alive until it returns; until then its services exist.
    ASSERT_TRUE(eventually([] {
      return !ros::service::exists("/stereo/fpga_stereo/set_parameters", false);
    })) << cycle;
  }
  stop = true;
  camera.join();
  EXPECT_EQ(seen_output, kCycles / 3) << "every node that was started publishes";
#ifndef __SANITIZE_ADDRESS__  // it delays freeing, and reports leaks itself
  // A leak of one small frame in each of the 400 cycles would be 5 MiB.
  EXPECT_LT(resident() - settled, 4) << "MiB";
#endif
}

}  // namespace
}  // namespace fpga_stereo::test
