#include "ros/frame_publisher.hpp"

#include <gtest/gtest.h>

#include <future>
#include <thread>
#include <vector>

namespace fpga_stereo::test {
namespace {

StereoFrame frame(std::uint64_t number) {
  StereoFrame made;
  made.number = number;
  made.left.header.stamp = ros::Time(100 + static_cast<double>(number));
  made.disparity = cv::Mat1w(2, 2, static_cast<std::uint16_t>(number));
  return made;
}

class FramePublisherTest : public testing::Test {
 protected:
  static void SetUpTestSuite() { ros::Time::init(); }

  std::uint64_t replaced() { return health_.report(false).dropped_replaced; }

  Health health_;
};

TEST_F(FramePublisherTest, PublishesInOrderAndDropsOvertakenFrames) {
  std::vector<std::uint64_t> published;
  FramePublisher publisher([&](const StereoFrame& f) { published.push_back(f.number); }, health_);
  for (const std::uint64_t number : {1, 3, 2, 3, 4}) publisher.publish(frame(number));
  EXPECT_EQ(published, (std::vector<std::uint64_t>{1, 3, 4}));
  EXPECT_EQ(replaced(), 2U);
  EXPECT_EQ(health_.report(false).frames_published, 3U);
}

TEST_F(FramePublisherTest, AThreadDoesNotWaitForTheOtherOneToPublish) {
  std::promise<void> entered, release;
  std::vector<std::uint64_t> published;
  std::vector<std::uint16_t> pixels;
  FramePublisher publisher(
      [&](const StereoFrame& f) {
        if (published.empty()) {
          entered.set_value();
          release.get_future().wait();
        }
        published.push_back(f.number);
        pixels.push_back(f.disparity(0, 0));
      },
      health_);
  std::thread first([&] { publisher.publish(frame(1)); });
  entered.get_future().wait();
  for (const std::uint64_t number : {2, 3, 4}) {
    StereoFrame next = frame(number);
    publisher.publish(next);              // returns at once
    next.disparity.setTo(cv::Scalar(0));  // the source may reuse its memory now
  }
  release.set_value();
  first.join();
  EXPECT_EQ(published, (std::vector<std::uint64_t>{1, 3, 4})) << "the queue keeps the newest two";
  EXPECT_EQ(pixels, (std::vector<std::uint16_t>{1, 3, 4}));
  EXPECT_EQ(replaced(), 1U);
}

TEST_F(FramePublisherTest, CountsEveryFrameOfTwoThreads) {
  int count = 0;
  FramePublisher publisher([&](const StereoFrame&) { ++count; }, health_);
  std::vector<std::thread> sources;
  for (std::uint64_t source = 0; source < 2; ++source) {
    sources.emplace_back([&, source] {
      for (std::uint64_t i = 1; i <= 200; ++i) publisher.publish(frame(2 * i + source));
    });
  }
  for (std::thread& source : sources) source.join();
  const StereoStatus status = health_.report(false);
  EXPECT_EQ(status.frames_published, static_cast<std::uint64_t>(count));
  EXPECT_EQ(status.frames_published + status.dropped_replaced, 400U) << "every frame is counted";
}

}  // namespace
}  // namespace fpga_stereo::test
