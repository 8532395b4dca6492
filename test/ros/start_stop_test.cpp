// The nodelet loaded and unloaded again and again, with frames under way. Run in a build with
// AddressSanitizer this shows leaks and use after free.
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
constexpr int kWarmUp = 100;  // caches fill

/// Resident memory, MiB.
[[maybe_unused]] double resident() {
  std::ifstream statm("/proc/self/statm");
  double total = 0;
  double pages = 0;
  statm >> total >> pages;
  return pages * 4096 / (1 << 20);
}

TEST(StartStop, FiveHundredTimesWithFramesUnderWay) {
  Rig rig;
  // Counts and keeps nothing: memory is what is measured.
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
    // Every way to be unloaded: at once, while connecting, and with frames under way.
    if (cycle % 3 == 1) ros::WallDuration(0.01).sleep();
    if (cycle % 3 == 2) {
      seen_output += eventually([&] { return disparities > before; }, 5);
    }
    ASSERT_TRUE(loader.unload("/stereo/fpga_stereo")) << cycle;
    // A callback under way keeps the nodelet alive for its time: the next one would find its
    // services taken.
    ASSERT_TRUE(eventually([] {
      return !ros::service::exists("/stereo/fpga_stereo/set_parameters", false);
    })) << cycle;
  }
  stop = true;
  camera.join();
  EXPECT_EQ(seen_output, kCycles / 3) << "every started node must produce";
#ifndef __SANITIZE_ADDRESS__  // it keeps freed memory for a while, and finds leaks by itself
  // 400 cycles; a leak of one small frame per cycle would be 5 MiB.
  EXPECT_LT(resident() - settled, 4) << "MiB";
#endif
}

}  // namespace
}  // namespace fpga_stereo::test
