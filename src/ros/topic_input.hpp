// Receives pairs from topics: subscribes on demand, pairs by stamp, decodes.
#pragma once

#include <image_transport/subscriber_filter.h>
#include <message_filters/pass_through.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>

#include <array>
#include <functional>
#include <optional>
#include <set>

#include "core/thread_safety.hpp"
#include "ros/arrival_log.hpp"
#include "ros/calibration_url.hpp"
#include "ros/camera_info_input.hpp"
#include "ros/demand.hpp"
#include "ros/health.hpp"
#include "ros/message_sync.hpp"
#include "ros/settings.hpp"
#include "ros/source_pair.hpp"
#include "ros/stamp_gate.hpp"

namespace fpga_stereo {

/// Subscribes to left|right/image_raw (or image_rect) and left|right/camera_info, those that are
/// needed and have no calibration file. All messages arrive in one callback queue, one at a time.
/// The other functions may be called from any thread, but only one of them at a time. The lock is
/// not held while a pair is decoded or handed on.
class TopicInput {
 public:
  struct Callbacks {
    std::function<void(const SourcePair&)> pair;
    /// Publishes an image whose mono or colour image is in demand; refuses one that it cannot
    /// decode. The image comes at once, before it has found its partners.
    std::function<Status(Side, const sensor_msgs::ImageConstPtr&)> image;
  };

  /// An empty URL means that the topic camera_info has the calibration. `health` and `gate` must
  /// outlive the input.
  TopicInput(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh, PairKind kind,
             const SyncSettings& settings, const CalibrationUrls& urls, Health& health,
             StampGate& gate, Callbacks callbacks);
  ~TopicInput() { set_demand({}); }
  TopicInput(const TopicInput&) = delete;
  TopicInput& operator=(const TopicInput&) = delete;

  /// Subscribes to what the demand needs, and to nothing else.
  void set_demand(const Demand& demand) FPGA_STEREO_EXCLUDES(mutex_);
  /// Says which calibration file cannot be used, or what is missing on the topics; nullopt while
  /// they bring what is in demand.
  std::optional<StateReport> trouble() const;

 private:
  enum Topic { kLeftImage, kLeftInfo, kRightImage, kRightInfo, kTopics };
  using Image = sensor_msgs::Image;
  using Info = sensor_msgs::CameraInfo;
  using Event = ros::MessageEvent<const Image>;

  void subscribe(const std::set<std::size_t>& topics);
  void on_image(Topic topic, const Event& event) FPGA_STEREO_EXCLUDES(mutex_);
  /// Makes the camera_info of an image if it comes from a file.
  void calibrate(Side side, const Image& image) FPGA_STEREO_EXCLUDES(mutex_);
  /// Publishes an image that is not part of a pair. It counts as a frame.
  void pass_on(Side side, const sensor_msgs::ImageConstPtr& image);
  void on_pair(const sensor_msgs::ImageConstPtr& left,
               const sensor_msgs::CameraInfoConstPtr& left_info,
               const sensor_msgs::ImageConstPtr& right,
               const sensor_msgs::CameraInfoConstPtr& right_info) FPGA_STEREO_EXCLUDES(mutex_);
  Demand demand() const FPGA_STEREO_EXCLUDES(mutex_);

  ros::NodeHandle nh_, private_nh_;
  const PairKind kind_;
  const std::array<std::string, kTopics> names_;
  Health& health_;
  StampGate& gate_;
  const Callbacks callbacks_;
  ArrivalLog log_;

  image_transport::ImageTransport transport_;
  image_transport::SubscriberFilter left_image_, right_image_;
  CameraInfoInput left_info_, right_info_;
  // Images go on to the synchronizer only if pairs are in demand.
  message_filters::PassThrough<Image> left_of_pair_, right_of_pair_;
  MessageSync<Image, Info, Image, Info> sync_;
  std::set<std::size_t> subscribed_;  // used by set_demand() alone

  mutable Mutex mutex_;
  Demand demand_ FPGA_STEREO_GUARDED_BY(mutex_);
  std::string left_frame_ FPGA_STEREO_GUARDED_BY(mutex_);  // of the latest left image
};

}  // namespace fpga_stereo
