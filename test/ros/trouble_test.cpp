// Bad input: late, missing, of a wrong size, stamp or encoding, or uncalibrated. It is not
// published, it is counted and explained, and the next good pair is published.
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

  /// Expects that a pair damaged by `damage` is not published, adds 1 to `counter` and is explained
  /// by `state` and `words`, and that the next good pair is published.
  void expect_refused(const std::function<void(PairMessages&)>& damage,
                      std::uint64_t StereoStatus::*counter, std::uint8_t state,
                      const std::string& words) {
    const StereoStatus before = rig_.status();
    PairMessages pair = synthetic_pair(kSize, 12);
    pair.set_stamp(ros::Time::now());
    damage(pair);
    const std::size_t published = disparity_.count();
    rig_.publish(pair, true);
    const StereoStatus after =
        rig_.status_when([&](const StereoStatus& s) { return s.*counter > before.*counter; });
    EXPECT_EQ(after.*counter, before.*counter + 1);
    EXPECT_EQ(after.state, state);
    EXPECT_NE(after.state_text.find(words), std::string::npos) << after.state_text;
    EXPECT_EQ(disparity_.count(), published);
    EXPECT_EQ(after.frames_in, before.frames_in + 1);

    EXPECT_TRUE(disparity_.with_stamp(rig_.publish(synthetic_pair(kSize, 12))));
    EXPECT_EQ(rig_.status().state, StereoStatus::STREAMING);
  }

  Rig rig_;
  Listener<DisparityImage> disparity_{rig_.nh(), "disparity"};
};

TEST_F(Trouble, UnknownEncoding) {
  expect_refused([](PairMessages& p) { p.left.encoding = "jpeg"; }, &StereoStatus::dropped_encoding,
                 StereoStatus::BAD_IMAGE, "left image with encoding \"jpeg\"");
}

TEST_F(Trouble, EncodingThatIsNotAnImage) {
  expect_refused(
      [](PairMessages& p) {
        p.right.encoding = "32FC1";
        p.right.step = p.right.width * 4;
        p.right.data.resize(p.right.step * p.right.height);
      },
      &StereoStatus::dropped_encoding, StereoStatus::BAD_IMAGE,
      "right image with encoding \"32FC1\"");
}

TEST_F(Trouble, DataShorterThanTheImage) {
  expect_refused([](PairMessages& p) { p.left.data.resize(100); }, &StereoStatus::dropped_encoding,
                 StereoStatus::BAD_IMAGE, "100 bytes");
}

TEST_F(Trouble, SizeThatOverflows32Bits) {
  for (const std::string encoding : {"mono8", "rgba8"}) {
    for (sensor_msgs::Image PairMessages::*side : {&PairMessages::left, &PairMessages::right}) {
      expect_refused(
          [&](PairMessages& p) {
            (p.*side).encoding = encoding;
            (p.*side).step = 35791395;  // 120 rows are 104 bytes in 32 bits
            (p.*side).data.resize(104);
          },
          &StereoStatus::dropped_encoding, StereoStatus::BAD_IMAGE,
          "the data must have 4294967400 bytes");
    }
  }
}

TEST_F(Trouble, SizeThatOverflows32BitsWhereImagesArePassedOn) {
  const Listener<sensor_msgs::Image> mono(rig_.nh(), "left/image_mono");
  const Listener<sensor_msgs::Image> color(rig_.nh(), "left/image_color");
  ASSERT_TRUE(rig_.node_listens());
  expect_refused(
      [](PairMessages& p) {
        p.left.step = 35791395;
        p.left.data.resize(104);
      },
      &StereoStatus::dropped_encoding, StereoStatus::BAD_IMAGE,
      "the data must have 4294967400 bytes");
  EXPECT_EQ(mono.count(), 1U) << "only the good image";
  EXPECT_EQ(color.count(), 1U);
}

TEST_F(Trouble, CameraInfoThatNoCameraHas) {
  expect_refused([](PairMessages& p) { p.left_info.width = 4294967295; },
                 &StereoStatus::dropped_calibration, StereoStatus::BAD_CALIBRATION,
                 "left camera_info width = 4294967295: allowed are 0 to 65535");
  expect_refused([](PairMessages& p) { p.right_info.D.assign(1000000, 0); },
                 &StereoStatus::dropped_calibration, StereoStatus::BAD_CALIBRATION,
                 "right camera_info D has 1000000 values: allowed are up to 14");
}

TEST_F(Trouble, StepBelowTheWidth) {
  expect_refused([](PairMessages& p) { p.left.step = 10; }, &StereoStatus::dropped_encoding,
                 StereoStatus::BAD_IMAGE, "step 10");
}

TEST_F(Trouble, ImageWithoutPixels) {
  expect_refused(
      [](PairMessages& p) {
        p.left.width = p.left.height = p.left.step = 0;
        p.left.data.clear();
      },
      &StereoStatus::dropped_encoding, StereoStatus::BAD_IMAGE, "no pixels");
}

TEST_F(Trouble, ImageSmallerThanItsCameraInfo) {
  expect_refused(
      [](PairMessages& p) {
        p.left = synthetic_pair({80, 60}, 12).left, p.left.header.stamp = p.right.header.stamp;
      },
      &StereoStatus::dropped_image_size, StereoStatus::BAD_IMAGE,
      "left image is 80x60: its camera_info says 160x120");
}

TEST_F(Trouble, RightImageOfAnotherSize) {
  expect_refused(
      [](PairMessages& p) {
        p.right = synthetic_pair({160, 100}, 12).right, p.right.header.stamp = p.left.header.stamp;
      },
      &StereoStatus::dropped_image_size, StereoStatus::BAD_IMAGE, "right image is 160x100");
}

TEST_F(Trouble, UncalibratedCamera) {
  expect_refused([](PairMessages& p) { p.left_info.K[0] = 0; }, &StereoStatus::dropped_uncalibrated,
                 StereoStatus::UNCALIBRATED, "left camera is uncalibrated");
}

TEST_F(Trouble, NoBaseline) {
  expect_refused([](PairMessages& p) { p.right_info.P[3] = 0; }, &StereoStatus::dropped_calibration,
                 StereoStatus::BAD_CALIBRATION, "P[3] = 0");
}

TEST_F(Trouble, FocalLengthsThatDiffer) {
  expect_refused([](PairMessages& p) { p.right_info.P[0] = 301; },
                 &StereoStatus::dropped_calibration, StereoStatus::BAD_CALIBRATION,
                 "fx of left and right");
}

TEST_F(Trouble, CalibrationThatIsNotANumber) {
  expect_refused([](PairMessages& p) { p.right_info.R[4] = std::nan(""); },
                 &StereoStatus::dropped_calibration, StereoStatus::BAD_CALIBRATION,
                 "right camera_info R");
}

TEST_F(Trouble, CameraInfosOfTwoSizes) {
  expect_refused([](PairMessages& p) { p.right_info.width = 200; },
                 &StereoStatus::dropped_calibration, StereoStatus::BAD_CALIBRATION, "200x120");
}

TEST_F(Trouble, StampOfZero) {
  expect_refused([](PairMessages& p) { p.set_stamp(ros::Time(0)); }, &StereoStatus::dropped_stamp,
                 StereoStatus::BAD_STAMP, "stamp is 0");
}

TEST_F(Trouble, LateFrame) {
  ASSERT_TRUE(disparity_.with_stamp(rig_.publish(synthetic_pair(kSize, 12))));
  expect_refused([](PairMessages& p) { p.set_stamp(ros::Time::now() - ros::Duration(60)); },
                 &StereoStatus::dropped_stamp, StereoStatus::BAD_STAMP, "not later");
}

TEST_F(Trouble, ImagesWithDifferentStampsAreNotPaired) {
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
  EXPECT_EQ(after.state, StereoStatus::UNSYNCHRONISED);
  EXPECT_NE(after.state_text.find("not synchronised"), std::string::npos) << after.state_text;
  EXPECT_NE(after.state_text.find("/stereo/right/image_raw are 0.0123 s apart"), std::string::npos)
      << after.state_text;
  EXPECT_TRUE(disparity_.with_stamp(rig_.publish(synthetic_pair(kSize, 12))));
}

TEST_F(Trouble, MissingTopicsAreNamed) {
  const StereoStatus none = rig_.status_when(
      [](const StereoStatus& s) { return s.state == StereoStatus::WAITING_FOR_IMAGES; });
  EXPECT_EQ(none.state, StereoStatus::WAITING_FOR_IMAGES);
  EXPECT_NE(none.state_text.find("/stereo/left/image_raw"), std::string::npos) << none.state_text;
  EXPECT_NE(none.state_text.find("/stereo/right/image_raw"), std::string::npos) << none.state_text;

  // Images without camera_info.
  ros::Publisher left = rig_.nh().advertise<sensor_msgs::Image>("left/image_raw", 1);
  ros::Publisher right = rig_.nh().advertise<sensor_msgs::Image>("right/image_raw", 1);
  PairMessages pair = synthetic_pair(kSize, 12);
  StereoStatus status;
  for (int i = 0; i < 40 && status.state != StereoStatus::WAITING_FOR_CAMERA_INFO; ++i) {
    pair.set_stamp(ros::Time::now());
    left.publish(pair.left);
    right.publish(pair.right);
    ros::WallDuration(0.2).sleep();
    status = rig_.status_when([](const StereoStatus&) { return true; });
  }
  EXPECT_EQ(status.state, StereoStatus::WAITING_FOR_CAMERA_INFO);
  EXPECT_EQ(status.state_text,
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
  // And back to the present.
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
