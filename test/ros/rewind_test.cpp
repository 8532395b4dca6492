// A bag that is played again and again, with and without simulated time, and messages that arrive
// in another order than that of their stamps.
#include <gtest/gtest.h>
#include <rosgraph_msgs/Clock.h>
#include <sensor_msgs/PointCloud2.h>
#include <stereo_msgs/DisparityImage.h>

#include <algorithm>
#include <random>

#include "ros/conversions.hpp"
#include "ros/graph.hpp"
#include "ros/rig.hpp"

namespace fpga_stereo::test {
namespace {

using stereo_msgs::DisparityImage;

const cv::Size kSize(64, 48);
constexpr std::size_t kPairs = 60;
constexpr std::size_t kUnpaired = 8;  // more than queue_size
constexpr int kLoops = 3;

ros::Time stamp_of(std::size_t i) {
  return ros::Time(1000) + ros::Duration(0.1 * static_cast<double>(i));
}

/// Moves the simulated clock, if there is one.
void set_time(const ros::Time& time) {
  static ros::NodeHandle nh;
  static const ros::Publisher publisher = nh.advertise<rosgraph_msgs::Clock>("/clock", 10);
  if (!ros::Time::isSimTime()) return;
  rosgraph_msgs::Clock clock;
  clock.clock = time;
  publisher.publish(clock);
  eventually([&] { return ros::Time::now() == time; });
}

/// Plays kLoops times what `publish` publishes for the pairs, then what `publish_unpaired` does.
/// Returns how many results each loop had. A result may come only with the next `delay` pairs.
std::vector<std::size_t> play(const std::function<void(const ros::Time&)>& publish,
                              const std::function<void(const ros::Time&)>& publish_unpaired,
                              const std::function<std::size_t()>& count, std::size_t delay) {
  std::vector<std::size_t> results;
  for (int loop = 0; loop < kLoops; ++loop) {
    const std::size_t before = count();
    for (std::size_t i = 0; i < kPairs; ++i) {
      set_time(stamp_of(i));
      publish(stamp_of(i));
      // Not faster than the node computes; two pairs may be needed to reveal the new loop.
      ros::WallDuration(0.02).sleep();
      eventually([&] { return count() + 2 + delay > before + i; }, 0.3);
    }
    for (std::size_t i = kPairs; i < kPairs + kUnpaired; ++i) {
      set_time(stamp_of(i));
      publish_unpaired(stamp_of(i));
      ros::WallDuration(0.01).sleep();
    }
    eventually([&] { return count() == before + kPairs; }, 1);
    results.push_back(count() - before);
  }
  return results;
}

void expect_all_but(std::size_t lost, const std::vector<std::size_t>& results) {
  for (const std::size_t published : results) {
    EXPECT_GE(published, kPairs - lost);
    EXPECT_LE(published, kPairs);
  }
}

class Rewind : public testing::TestWithParam<const char*> {};

TEST_P(Rewind, EveryLoopOfABagIsPublished) {
  Rig rig(GetParam());
  ros::NodeHandle& nh = rig.nh();
  const bool is_approximate = GetParam() == std::string("approximate");
  for (const std::string side : {"left", "right"}) {
    SCOPED_TRACE(side);
    Listener<DisparityImage> disparity(nh, "disparity");
    ros::Publisher image = nh.advertise<sensor_msgs::Image>(side + "/image_raw", 10);
    ros::Publisher info = nh.advertise<sensor_msgs::CameraInfo>(side + "/camera_info", 10);
    ASSERT_TRUE(rig.node_listens());
    PairMessages pair = synthetic_pair(kSize, 12);
    const auto results = play(
        [&](const ros::Time& stamp) {
          pair.set_stamp(stamp);
          rig.publish(pair, true);
        },
        [&](const ros::Time& stamp) {
          pair.set_stamp(stamp);
          info.publish(side == "left" ? pair.left_info : pair.right_info);
          image.publish(side == "left" ? pair.left : pair.right);
        },
        [&] { return disparity.count(); }, is_approximate ? 2 : 0);
    // The approximate synchronizer keeps the last pairs of a loop until others arrive.
    expect_all_but(is_approximate ? 4 : 2, results);
  }
}

INSTANTIATE_TEST_SUITE_P(Nodes, Rewind, testing::Values("exact", "approximate"));

TEST(RewindOfClouds, EveryLoopOfABagIsPublished) {
  Rig rig("cloud", "image_unused", "point_cloud2");
  ros::NodeHandle& nh = rig.nh();
  ros::Publisher disparity = nh.advertise<DisparityImage>("disparity", 10);
  ros::Publisher color = nh.advertise<sensor_msgs::Image>("left/image_rect_color", 10);
  Listener<sensor_msgs::PointCloud2> cloud(nh, "points2");
  ASSERT_TRUE(eventually([&] {
    return disparity.getNumSubscribers() > 0 && color.getNumSubscribers() > 0 && all_links_are_up();
  }));
  PairMessages pair = synthetic_pair(kSize, 12);
  DisparityImage message;
  message.image = *to_image(cv::Mat1f(kSize, 12.0F), {});
  const auto publish = [&](const ros::Time& stamp, bool is_paired) {
    pair.set_stamp(stamp);
    message.header.stamp = stamp;
    if (is_paired) rig.publish(pair, true);
    if (is_paired) color.publish(pair.left);
    disparity.publish(message);
  };
  expect_all_but(2, play([&](const ros::Time& stamp) { publish(stamp, true); },
                         [&](const ros::Time& stamp) { publish(stamp, false); },
                         [&] { return cloud.count(); }, 0));
}

TEST(Reordering, PublishesWhatIsLaterThanAllBefore) {
  Rig rig("exact");
  std::vector<ros::Time> stamps;
  for (std::size_t i = 0; i < 141; ++i) stamps.push_back(stamp_of(10000 + i));
  std::mt19937 random(5);
  for (auto at = stamps.begin(); at != stamps.end();) {
    const auto end = at + std::min<std::ptrdiff_t>(10, stamps.end() - at);
    std::shuffle(at, end, random);
    at = end;
  }
  Listener<DisparityImage> disparity(rig.nh(), "disparity");
  ASSERT_TRUE(rig.node_listens());
  const StereoStatus before = rig.status();
  PairMessages pair = synthetic_pair(kSize, 12);
  ros::Time latest;
  std::size_t rising = 0;
  for (const ros::Time& stamp : stamps) {
    set_time(std::max(latest, stamp));
    pair.set_stamp(stamp);
    rig.publish(pair, true);
    if (stamp > latest) {
      latest = stamp;
      ++rising;
      ASSERT_TRUE(disparity.with_stamp(stamp));
    } else {
      ros::WallDuration(0.01).sleep();
    }
  }
  EXPECT_EQ(disparity.last()->header.stamp, latest);
  const StereoStatus after = rig.status();
  EXPECT_EQ(disparity.count(), rising);
  EXPECT_EQ(after.frames_in, before.frames_in + stamps.size());
  EXPECT_EQ(after.frames_published, before.frames_published + rising);
  EXPECT_EQ(after.dropped_stamp + after.dropped_unsynchronized,
            before.dropped_stamp + before.dropped_unsynchronized + stamps.size() - rising);
}

}  // namespace
}  // namespace fpga_stereo::test
