// What a camera driver has on its topics: raw images, camera_info, set_camera_info. There while a
// board with cameras is.
#pragma once

#include <camera_info_manager/camera_info_manager.h>
#include <image_transport/image_transport.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>

#include <array>
#include <functional>
#include <memory>
#include <mutex>
#include <opencv2/core.hpp>
#include <string>

#include "ros/board_settings.hpp"

namespace fpga_stereo {

class CameraTopics {
 public:
  struct Infos {
    sensor_msgs::CameraInfo left, right;
  };

  /// `changed` is called when somebody begins or ceases to listen.
  CameraTopics(const ros::NodeHandle& nh, const BoardSettings& settings,
               std::function<void()> changed);

  /// Advertises the topics and services, or takes them back.
  void show(bool shown);
  /// Who listens.
  struct Demand {
    bool left = false, right = false;  // to the raw images
    bool info = false;                 // to a camera_info
    bool any() const { return left || right || info; }
  };
  Demand demand() const;

  /// The calibration as it is now: of set_camera_info, or of the files.
  Infos infos();

  /// What belongs to one pair; images may be empty.
  void publish(const cv::Mat& left, const cv::Mat& right, const Infos& infos,
               const ros::Time& stamp);

 private:
  struct Camera {
    ros::NodeHandle nh;
    std::string name, url;
    std::unique_ptr<camera_info_manager::CameraInfoManager> manager;
    image_transport::Publisher images;
    ros::Publisher infos;
  };
  sensor_msgs::CameraInfo info(Camera& camera);

  const BoardSettings& settings_;
  std::function<void()> changed_;
  ros::NodeHandle nh_;
  image_transport::ImageTransport transport_;
  mutable std::mutex mutex_;
  std::array<Camera, 2> cameras_;
  bool shown_ = false;
};

}  // namespace fpga_stereo
