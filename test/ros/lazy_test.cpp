// The node computes nothing without a subscriber. Settings change while it runs.
#include <diagnostic_msgs/DiagnosticArray.h>
#include <gtest/gtest.h>
#include <sensor_msgs/PointCloud2.h>
#include <stereo_msgs/DisparityImage.h>

#include <memory>

#include "ros/graph.hpp"
#include "ros/rig.hpp"

namespace fpga_stereo::test {
namespace {

using sensor_msgs::Image;
using stereo_msgs::DisparityImage;

const cv::Size kSize(160, 120);

TEST(Lazy, WithoutSubscribersTheNodeDoesNotSubscribe) {
  Rig rig;
  EXPECT_TRUE(rig.node_is_unsubscribed());
  const StereoStatus status = rig.status();
  EXPECT_EQ(status.state, StereoStatus::IDLE);
  EXPECT_EQ(status.source, "software");
}

TEST(Lazy, UnsubscribesWhenTheLastSubscriberLeaves) {
  Rig rig;
  auto first = std::make_unique<Listener<DisparityImage>>(rig.nh(), "disparity");
  auto second = std::make_unique<Listener<Image>>(rig.nh(), "left/image_rect");
  ASSERT_TRUE(rig.node_listens());
  ASSERT_TRUE(first->with_stamp(rig.publish(synthetic_pair(kSize, 12))));
  first.reset();
  EXPECT_TRUE(second->with_stamp(rig.publish(synthetic_pair(kSize, 12))));
  second.reset();
  ASSERT_TRUE(rig.node_is_unsubscribed());
  const StereoStatus before = rig.status();
  rig.publish(synthetic_pair(kSize, 12));
  const StereoStatus after = rig.status();
  EXPECT_EQ(after.frames_in, before.frames_in);
  EXPECT_EQ(after.state, StereoStatus::IDLE);
}

TEST(Lazy, AnImageOfOneCameraNeedsNeitherTheOtherNorACalibration) {
  Rig rig;
  PairMessages pair = synthetic_pair(kSize, 12);
  pair.left_info = pair.right_info = sensor_msgs::CameraInfo();  // uncalibrated
  for (const std::string camera : {"left", "right"}) {
    for (const std::string topic : {"image_mono", "image_color"}) {
      SCOPED_TRACE(camera + "/" + topic);
      const bool is_left = camera == "left";
      // Until the node has ended the subscription for the topic before, it counts as the new one.
      ASSERT_TRUE(rig.node_is_unsubscribed());
      Listener<Image> images(rig.nh(), camera + "/" + topic);
      Rig::Subscribers expected;
      (is_left ? expected.left : expected.right) = 1;
      ASSERT_TRUE(eventually([&] { return rig.subscribers() == expected; }));
      ASSERT_TRUE(eventually(all_links_are_up));
      ros::Time stamp = ros::Time::now();
      pair.left.header.stamp = stamp;
      pair.right.header.stamp = stamp + ros::Duration(1);
      if (!is_left) stamp = pair.right.header.stamp;
      rig.publish(pair, true);
      const auto image = images.with_stamp(stamp);
      ASSERT_TRUE(image);
      EXPECT_EQ(image->data, is_left ? pair.left.data : pair.right.data);
      EXPECT_TRUE(always([&] { return rig.subscribers() == expected; }, 0.2));
      const StereoStatus status =
          rig.status_when([](const StereoStatus& s) { return s.state == StereoStatus::STREAMING; });
      EXPECT_EQ(status.state, StereoStatus::STREAMING) << status.state_text;
    }
  }
  ASSERT_TRUE(rig.node_is_unsubscribed());
}

TEST(Lazy, SaysWhichImageOfOneCameraIsMissingOrCannotBeDecoded) {
  Rig rig;
  Listener<Image> mono(rig.nh(), "right/image_mono");
  const StereoStatus silent = rig.status_when(
      [](const StereoStatus& s) { return s.state == StereoStatus::WAITING_FOR_IMAGES; });
  EXPECT_EQ(silent.state_text, "no images: nothing arrives on /stereo/right/image_raw");
  PairMessages pair = synthetic_pair(kSize, 12);
  pair.right.encoding = "jpeg";
  rig.publish(pair);
  const StereoStatus bad =
      rig.status_when([](const StereoStatus& s) { return s.state == StereoStatus::BAD_IMAGE; });
  EXPECT_EQ(bad.state_text.rfind("right image with encoding \"jpeg\"", 0), 0U) << bad.state_text;
}

TEST(Lazy, ImagesOfOneCameraComeBesidePairsWithTheirOwnStamps) {
  Rig rig;
  Listener<DisparityImage> disparity(rig.nh(), "disparity");
  Listener<Image> mono(rig.nh(), "right/image_mono");
  ASSERT_TRUE(rig.node_listens());
  PairMessages pair = synthetic_pair(kSize, 12);
  const ros::Time stamp = rig.publish(pair);
  EXPECT_TRUE(disparity.with_stamp(stamp));
  EXPECT_TRUE(mono.with_stamp(stamp));
  pair.set_stamp(stamp + ros::Duration(1));
  pair.right.header.stamp += ros::Duration(0.5);  // without a partner
  rig.publish(pair, true);
  EXPECT_TRUE(mono.with_stamp(pair.right.header.stamp));
  EXPECT_EQ(disparity.count(), 1U);
}

TEST(Lazy, StreamsOnlyAfterTheFirstFrame) {
  Rig rig;
  ASSERT_TRUE(rig.node_is_unsubscribed());
  // A refusal that an earlier subscriber was told about is forgotten.
  ASSERT_EQ(
      rig.status_when([](const StereoStatus& s) { return s.state == StereoStatus::IDLE; }).state,
      StereoStatus::IDLE);
  Listener<DisparityImage> disparity(rig.nh(), "disparity");
  ASSERT_TRUE(rig.node_listens());
  const StereoStatus before =
      rig.status_when([](const StereoStatus& s) { return s.state != StereoStatus::IDLE; });
  EXPECT_EQ(before.state, StereoStatus::STARTING) << before.state_text;
  EXPECT_EQ(before.state_text, "starting: the first frame is still expected");
  ASSERT_TRUE(disparity.with_stamp(rig.publish(synthetic_pair(kSize, 12))));
  EXPECT_EQ(rig.status().state, StereoStatus::STREAMING);
}

TEST(Lazy, RectifiedImagesAloneNeedNoMatching) {
  Rig rig;
  Listener<Image> rect(rig.nh(), "right/image_rect");
  ASSERT_TRUE(rig.node_listens());
  for (int i = 0; i < 5; ++i) {
    ASSERT_TRUE(rect.with_stamp(rig.publish(synthetic_pair(kSize, 12, true))));
    ros::WallDuration(0.3).sleep();
  }
  const StereoStatus status =
      rig.status_when([](const StereoStatus& s) { return s.publish_ms > 0; });
  EXPECT_GT(status.publish_ms, 0);
  EXPECT_EQ(status.match_ms, 0);
  EXPECT_EQ(status.cost_ms, 0);
  EXPECT_EQ(status.speckle_ms, 0);
}

TEST(Status, HasTheTimeOfEveryStageThatRuns) {
  Rig rig;
  Listener<DisparityImage> disparity(rig.nh(), "disparity");
  ASSERT_TRUE(rig.node_listens());
  const auto status_of = [&](const std::string& algorithm, const std::string& dense) {
    rig.reconfigure("stereo_algorithm", algorithm);
    rig.reconfigure("dense", dense);
    rig.status();  // ends the means over earlier frames
    EXPECT_TRUE(disparity.with_stamp(rig.publish(synthetic_pair(kSize, 12))));
    return rig.status_when([](const StereoStatus& s) { return s.rate > 0; });
  };
  const StereoStatus sgm = status_of("sgm", "true");
  EXPECT_GT(sgm.cost_ms, 0);
  EXPECT_GT(sgm.aggregate_ms, 0);
  EXPECT_GT(sgm.select_ms, 0);
  EXPECT_GT(sgm.fill_ms, 0);
  EXPECT_GT(sgm.median_ms, 0);
  EXPECT_EQ(sgm.match_ms, 0);
  const StereoStatus window = status_of("window", "false");
  EXPECT_GT(window.match_ms, 0);
  EXPECT_GT(window.select_ms, 0);
  EXPECT_EQ(window.cost_ms, 0);
  EXPECT_EQ(window.aggregate_ms, 0);
  EXPECT_EQ(window.fill_ms, 0);
  EXPECT_EQ(window.median_ms, 0);
  rig.reconfigure("stereo_algorithm", "sgm");
}

TEST(Reconfigure, TakesEffectWhileTheNodeRuns) {
  Rig rig;
  Listener<DisparityImage> disparity(rig.nh(), "disparity");
  ASSERT_TRUE(rig.node_listens());
  for (const int range : {32, 128, 64}) {
    rig.reconfigure("disparity_range", std::to_string(range));
    const auto message = disparity.with_stamp(rig.publish(synthetic_pair(kSize, 12)));
    ASSERT_TRUE(message);
    EXPECT_EQ(message->max_disparity, range - 1);
  }
  rig.reconfigure("subpixel", "false");
  const auto whole = disparity.with_stamp(rig.publish(synthetic_pair(kSize, 12)));
  ASSERT_TRUE(whole);
  EXPECT_EQ(whole->delta_d, 1);
  rig.reconfigure("subpixel", "true");
}

TEST(Reconfigure, RefusedValuesAreWrittenBack) {
  Rig rig;
  EXPECT_EQ(value_of(rig.reconfigure("correlation_window_size", "12"), "correlation_window_size"),
            "15");
  EXPECT_EQ(value_of(rig.reconfigure("disparity_range", "50"), "disparity_range"), "64");
  EXPECT_EQ(value_of(rig.reconfigure("census_pattern", "dense"), "census_pattern"), "sparse");
  EXPECT_EQ(value_of(rig.reconfigure("stereo_algorithm", "bm"), "stereo_algorithm"), "sgm");
  EXPECT_EQ(value_of(rig.reconfigure("depth_encoding", "8UC1"), "depth_encoding"), "32FC1");
  EXPECT_EQ(value_of(rig.reconfigure("census_pattern", "full"), "census_pattern"), "full");
  EXPECT_EQ(value_of(rig.reconfigure("census_pattern", "sparse"), "census_pattern"), "sparse");
}

TEST(Reconfigure, LosesNoFrameInFlight) {
  Rig rig;
  Listener<DisparityImage> disparity(rig.nh(), "disparity");
  ASSERT_TRUE(rig.node_listens());
  for (int i = 0; i < 60; ++i) {
    const ros::Time stamp = rig.publish(synthetic_pair(kSize, 12));
    rig.reconfigure("disparity_range", std::to_string(16 + 8 * (i % 10)));
    rig.reconfigure("census_window_size", std::to_string(5 + 2 * (i % 4)));
    ASSERT_TRUE(disparity.with_stamp(stamp));
  }
  rig.reconfigure("disparity_range", "64");
  rig.reconfigure("census_window_size", "11");
}

TEST(Diagnostics, ReportTheStateOfTheStatus) {
  Rig rig;
  ros::NodeHandle root;
  Listener<diagnostic_msgs::DiagnosticArray> diagnostics(root, "/diagnostics");
  Listener<DisparityImage> disparity(rig.nh(), "disparity");
  ASSERT_TRUE(rig.node_listens());
  const auto has = [&](int level, const std::string& words) {
    return eventually([&] {
      const auto last = diagnostics.last();
      if (!last || last->status.empty()) return false;
      const auto& status = last->status.front();
      return status.level == level && status.message.find(words) != std::string::npos;
    });
  };
  EXPECT_TRUE(has(diagnostic_msgs::DiagnosticStatus::WARN, "no images"));
  PairMessages pair = synthetic_pair(kSize, 12);
  rig.publish(pair);
  EXPECT_TRUE(has(diagnostic_msgs::DiagnosticStatus::OK, "streaming"));
  pair.left_info.K[0] = 0;
  rig.publish(pair);
  EXPECT_TRUE(has(diagnostic_msgs::DiagnosticStatus::ERROR, "uncalibrated"));
}

}  // namespace
}  // namespace fpga_stereo::test
