// Input that is late, missing, mis-sized, mis-stamped, wrongly encoded or uncalibrated: never
// published, always counted and explained, and the next good frame comes out.
#include <gtest/gtest.h>
#include <stereo_msgs/DisparityImage.h>

#include <functional>

#include "ros/rig.hpp"

namespace fpga_stereo::test {
namespace {

using stereo_msgs::DisparityImage;

const cv::Size kSize(160, 120);

class Trouble : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(rig_.node_listens()); }

  /// A frame spoilt by `spoil` is not published, adds 1 to `counter` and is explained by `words`;
  /// a good frame then comes out.
  void expect_refused(const std::function<void(PairMessages&)>& spoil,
                      std::uint64_t StereoStatus::*counter, const std::string& words) {
    const StereoStatus before = rig_.status();
    PairMessages pair = synthetic_pair(kSize, 12);
    pair.set_stamp(ros::Time::now());
    spoil(pair);
    const std::size_t published = disparity_.count();
    rig_.publish(pair, true);
    const StereoStatus after =
        rig_.status_when([&](const StereoStatus& s) { return s.*counter > before.*counter; });
    EXPECT_EQ(after.*counter, before.*counter + 1);
    EXPECT_NE(after.state.find(words), std::string::npos) << "state is: " << after.state;
    EXPECT_EQ(disparity_.count(), published);
    EXPECT_EQ(after.frames_in, before.frames_in + 1);

    EXPECT_TRUE(disparity_.with_stamp(rig_.publish(synthetic_pair(kSize, 12))));
    EXPECT_EQ(rig_.status().state, "streaming");
  }

  Rig rig_;
  Listener<DisparityImage> disparity_{rig_.nh(), "disparity"};
};

TEST_F(Trouble, UnknownEncoding) {
  expect_refused([](PairMessages& p) { p.left.encoding = "jpeg"; }, &StereoStatus::dropped_encoding,
                 "left image with encoding \"jpeg\"");
}

TEST_F(Trouble, EncodingThatIsNoPicture) {
  expect_refused(
      [](PairMessages& p) {
        p.right.encoding = "32FC1";
        p.right.step = p.right.width * 4;
        p.right.data.resize(p.right.step * p.right.height);
      },
      &StereoStatus::dropped_encoding, "right image with encoding \"32FC1\"");
}

TEST_F(Trouble, DataShorterThanTheImage) {
  expect_refused([](PairMessages& p) { p.left.data.resize(100); }, &StereoStatus::dropped_encoding,
                 "100 bytes");
}

TEST_F(Trouble, StepBelowTheWidth) {
  expect_refused([](PairMessages& p) { p.left.step = 10; }, &StereoStatus::dropped_encoding,
                 "step 10");
}

TEST_F(Trouble, ImageWithoutPixels) {
  expect_refused(
      [](PairMessages& p) {
        p.left.width = p.left.height = p.left.step = 0;
        p.left.data.clear();
      },
      &StereoStatus::dropped_encoding, "no pixel");
}

TEST_F(Trouble, ImageSmallerThanItsCameraInfo) {
  expect_refused(
      [](PairMessages& p) {
        p.left = synthetic_pair({80, 60}, 12).left, p.left.header.stamp = p.right.header.stamp;
      },
      &StereoStatus::dropped_image_size, "left image is 80x60: its camera_info says 160x120");
}

TEST_F(Trouble, RightImageOfAnotherSize) {
  expect_refused(
      [](PairMessages& p) {
        p.right = synthetic_pair({160, 100}, 12).right, p.right.header.stamp = p.left.header.stamp;
      },
      &StereoStatus::dropped_image_size, "right image is 160x100");
}

TEST_F(Trouble, UncalibratedCamera) {
  expect_refused([](PairMessages& p) { p.left_info.K[0] = 0; }, &StereoStatus::dropped_uncalibrated,
                 "left camera is uncalibrated");
}

TEST_F(Trouble, NoBaseline) {
  expect_refused([](PairMessages& p) { p.right_info.P[3] = 0; }, &StereoStatus::dropped_calibration,
                 "P[3] = 0");
}

TEST_F(Trouble, FocalLengthsThatDiffer) {
  expect_refused([](PairMessages& p) { p.right_info.P[0] = 301; },
                 &StereoStatus::dropped_calibration, "fx of left and right");
}

TEST_F(Trouble, CalibrationThatIsNotANumber) {
  expect_refused([](PairMessages& p) { p.right_info.R[4] = std::nan(""); },
                 &StereoStatus::dropped_calibration, "right camera_info R");
}

TEST_F(Trouble, CameraInfosOfTwoSizes) {
  expect_refused([](PairMessages& p) { p.right_info.width = 200; },
                 &StereoStatus::dropped_calibration, "200x120");
}

TEST_F(Trouble, StampOfZero) {
  expect_refused([](PairMessages& p) { p.set_stamp(ros::Time(0)); }, &StereoStatus::dropped_stamp,
                 "stamp is 0");
}

TEST_F(Trouble, LateFrame) {
  ASSERT_TRUE(disparity_.with_stamp(rig_.publish(synthetic_pair(kSize, 12))));
  expect_refused([](PairMessages& p) { p.set_stamp(ros::Time::now() - ros::Duration(60)); },
                 &StereoStatus::dropped_stamp, "not later");
}

TEST_F(Trouble, StampsThatDifferAreNoPair) {
  const StereoStatus before = rig_.status();
  PairMessages pair = synthetic_pair(kSize, 12);
  for (int i = 0; i < 20; ++i) {
    pair.set_stamp(ros::Time::now());
    pair.right.header.stamp += ros::Duration(0.0123);
    rig_.publish(pair, true);
    ros::WallDuration(0.2).sleep();
  }
  const StereoStatus after = rig_.status();
  EXPECT_EQ(after.frames_published, before.frames_published);
  EXPECT_GE(after.dropped_unsynchronized, before.dropped_unsynchronized + 20 - 5);
  EXPECT_NE(after.state.find("not synchronised"), std::string::npos) << after.state;
  EXPECT_NE(after.state.find("/stereo/right/image_raw are 0.0123 s apart"), std::string::npos)
      << after.state;
  EXPECT_TRUE(disparity_.with_stamp(rig_.publish(synthetic_pair(kSize, 12))));
}

TEST_F(Trouble, MissingTopicsAreNamed) {
  // Nothing at all.
  const auto none =
      rig_.status_when([](const StereoStatus& s) { return s.state.find("no images") == 0; });
  EXPECT_NE(none.state.find("/stereo/left/image_raw"), std::string::npos) << none.state;
  EXPECT_NE(none.state.find("/stereo/right/image_raw"), std::string::npos) << none.state;

  // Images without calibration.
  ros::Publisher left = rig_.nh().advertise<sensor_msgs::Image>("left/image_raw", 1);
  ros::Publisher right = rig_.nh().advertise<sensor_msgs::Image>("right/image_raw", 1);
  PairMessages pair = synthetic_pair(kSize, 12);
  StereoStatus status;
  for (int i = 0; i < 40 && status.state.find("no camera_info") != 0; ++i) {
    pair.set_stamp(ros::Time::now());
    left.publish(pair.left);
    right.publish(pair.right);
    ros::WallDuration(0.2).sleep();
    status = rig_.status_when([](const StereoStatus&) { return true; });
  }
  EXPECT_EQ(status.state,
            "no camera_info: nothing arrives on /stereo/left/camera_info, "
            "/stereo/right/camera_info");
}

TEST_F(Trouble, TimeThatStartsOverIsFollowed) {
  PairMessages pair = synthetic_pair(kSize, 12);
  ASSERT_TRUE(disparity_.with_stamp(rig_.publish(pair)));
  const ros::Time begin = ros::Time::now() - ros::Duration(1000);
  for (int i = 0; i < 6; ++i) {
    pair.set_stamp(begin + ros::Duration(0.1 * i));
    rig_.publish(pair, true);
    ros::WallDuration(0.1).sleep();
  }
  EXPECT_TRUE(disparity_.with_stamp(begin + ros::Duration(0.5)));
  EXPECT_FALSE(disparity_.with_stamp(begin, 0.1));
  // And back: an ordinary frame.
  EXPECT_TRUE(disparity_.with_stamp(rig_.publish(pair)));
}

TEST_F(Trouble, EveryFrameIsAccountedForUnderOverload) {
  const StereoStatus before = rig_.status();
  const PairMessages pair = synthetic_pair({1280, 720}, 12);
  constexpr int kFrames = 40;
  for (int i = 0; i < kFrames; ++i) {
    rig_.publish(pair);
    ros::WallDuration(0.01).sleep();
  }
  const auto sum = [](const StereoStatus& s) {
    return s.frames_published + s.dropped_replaced + s.dropped_unsynchronized;
  };
  const StereoStatus after = rig_.status_when([&](const StereoStatus& s) {
    return s.frames_in > before.frames_in && sum(s) - sum(before) == s.frames_in - before.frames_in;
  });
  EXPECT_EQ(sum(after) - sum(before), after.frames_in - before.frames_in);
  EXPECT_GT(after.dropped_replaced, before.dropped_replaced);
  EXPECT_GT(after.frames_published, before.frames_published);
}

}  // namespace
}  // namespace fpga_stereo::test
