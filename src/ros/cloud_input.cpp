#include "ros/cloud_input.hpp"

#include <array>
#include <utility>
#include <vector>

#include "ros/image_subscription.hpp"

namespace fpga_stereo {
namespace {

enum CloudTopic { kDisparity, kColor, kLeftInfo, kRightInfo };
constexpr std::array<const char*, 4> kCloudTopicNames{"disparity", "left/image_rect_color",
                                                      "left/camera_info", "right/camera_info"};

std::vector<ArrivalLog::Topic> logged_topics(const ros::NodeHandle& nh) {
  std::vector<ArrivalLog::Topic> topics;
  topics.reserve(kCloudTopicNames.size());
  for (const char* name : kCloudTopicNames) topics.push_back({nh.resolveName(name), false});
  topics[kLeftInfo].is_camera_info = topics[kRightInfo].is_camera_info = true;
  return topics;
}

}  // namespace

CloudInput::CloudInput(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh,
                       const SyncSettings& settings, Health& health, StampGate& gate,
                       Callback callback)
    : nh_(nh),
      private_nh_(private_nh),
      gate_(gate),
      callback_(std::move(callback)),
      log_(logged_topics(nh), settings, health),
      transport_(nh) {
  const auto note = [this](auto& subscriber, CloudTopic topic, auto message) {
    using Message = typename decltype(message)::element_type;
    subscriber.registerCallback(boost::function<void(const boost::shared_ptr<Message>&)>(
        [this, topic](const auto& m) { log_.arrived(topic, m->header.stamp); }));
  };
  disparity_.registerCallback(boost::function<void(const ros::MessageEvent<const Disparity>&)>(
      [this](const auto& event) { on_disparity(event); }));
  note(color_, kColor, sensor_msgs::ImageConstPtr());
  note(left_info_, kLeftInfo, sensor_msgs::CameraInfoConstPtr());
  note(right_info_, kRightInfo, sensor_msgs::CameraInfoConstPtr());
  // Registered last: a message is noted before the set that it completes.
  sync_.emplace(settings, disparity_of_set_, color_, left_info_, right_info_,
                [this](const auto& disparity, const auto& color, const auto& left_info,
                       const auto& right_info) {
                  if (!log_.completed(disparity->header.stamp)) return;
                  callback_({disparity, color, left_info, right_info});
                });
}

void CloudInput::on_disparity(const ros::MessageEvent<const Disparity>& event) {
  if (const auto rewind = log_.arrived(kDisparity, event.getConstMessage()->header.stamp)) {
    sync_->restart();
    gate_.restart(*rewind);
  }
  disparity_of_set_.add(event);
}

void CloudInput::set_subscribed(bool is_subscribed) {
  if (std::exchange(is_subscribed_, is_subscribed) == is_subscribed) return;
  if (!is_subscribed) {
    disparity_.unsubscribe();
    color_.unsubscribe();
    left_info_.unsubscribe();
    right_info_.unsubscribe();
    return log_.stop();
  }
  log_.start({kDisparity, kColor, kLeftInfo, kRightInfo}, true);
  // Queues of 1 as in image_pipeline: the synchronizer has the queue that matters.
  disparity_.subscribe(nh_, kCloudTopicNames[kDisparity], 1);
  subscribe_to_images(transport_, nh_, private_nh_, kCloudTopicNames[kColor], color_);
  left_info_.subscribe(nh_, kCloudTopicNames[kLeftInfo], 1);
  right_info_.subscribe(nh_, kCloudTopicNames[kRightInfo], 1);
}

}  // namespace fpga_stereo
