#include "ros/camera_topics.hpp"

#include <utility>

#include "ros/conversions.hpp"

namespace fpga_stereo {

using camera_info_manager::CameraInfoManager;

CameraTopics::CameraTopics(const ros::NodeHandle& nh, const BoardSettings& settings,
                           std::function<void()> changed)
    : settings_(settings), changed_(std::move(changed)), nh_(nh), transport_(nh) {
  // Names by which camera_info_manager files a calibration: one for each pair of a robot.
  std::string pair = nh.getNamespace();
  pair.erase(0, pair.find_first_not_of('/'));
  for (char& c : pair) c = c == '/' ? '_' : c;
  const std::array<std::string, 2> sides{"left", "right"};
  const std::array<std::string, 2> urls{settings.left_url, settings.right_url};
  for (std::size_t i = 0; i < cameras_.size(); ++i) {
    cameras_[i].nh = ros::NodeHandle(nh, sides[i]);
    cameras_[i].name = pair + (pair.empty() ? "" : "_") + sides[i];
    cameras_[i].url = urls[i];
  }
}

void CameraTopics::show(bool shown) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (shown == shown_) return;
    shown_ = shown;
  }
  const std::array<std::string, 2> sides{"left", "right"};
  const image_transport::SubscriberStatusCallback on_image = [this](const auto&) { changed_(); };
  const ros::SubscriberStatusCallback on_info = [this](const auto&) { changed_(); };
  for (std::size_t i = 0; i < cameras_.size(); ++i) {
    // Made and unmade outside of the lock: both may wait for callbacks that need it.
    Camera camera;
    if (shown) {
      const ros::NodeHandle nh = cameras_[i].nh;
      camera.manager = std::make_unique<CameraInfoManager>(nh, cameras_[i].name, cameras_[i].url);
      camera.images = transport_.advertise(sides[i] + "/image_raw", 1, on_image, on_image);
      camera.infos = ros::NodeHandle(nh_).advertise<sensor_msgs::CameraInfo>(
          sides[i] + "/camera_info", 1, on_info, on_info);
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    std::swap(cameras_[i].manager, camera.manager);
    std::swap(cameras_[i].images, camera.images);
    std::swap(cameras_[i].infos, camera.infos);
  }
}

CameraTopics::Demand CameraTopics::demand() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!shown_) return {};
  Demand demand;
  demand.left = cameras_[0].images.getNumSubscribers() > 0;
  demand.right = cameras_[1].images.getNumSubscribers() > 0;
  demand.info =
      cameras_[0].infos.getNumSubscribers() > 0 || cameras_[1].infos.getNumSubscribers() > 0;
  return demand;
}

sensor_msgs::CameraInfo CameraTopics::info(Camera& camera) {
  sensor_msgs::CameraInfo info;
  if (camera.manager) info = camera.manager->getCameraInfo();
  // image_geometry wants one frame for both.
  info.header.frame_id = settings_.frame_id;
  if (info.K[0] == 0) {
    info.width = static_cast<std::uint32_t>(settings_.image_size.width);
    info.height = static_cast<std::uint32_t>(settings_.image_size.height);
  }
  return info;
}

CameraTopics::Infos CameraTopics::infos() {
  const std::lock_guard<std::mutex> lock(mutex_);
  return {info(cameras_[0]), info(cameras_[1])};
}

void CameraTopics::publish(const cv::Mat& left, const cv::Mat& right, const Infos& infos,
                           const ros::Time& stamp) {
  const std::array<const cv::Mat*, 2> images{&left, &right};
  std::array<sensor_msgs::CameraInfo, 2> all{infos.left, infos.right};
  const std::lock_guard<std::mutex> lock(mutex_);
  for (std::size_t i = 0; i < cameras_.size(); ++i) {
    if (!shown_) continue;
    all[i].header.stamp = stamp;
    all[i].header.frame_id = settings_.frame_id;
    const bool viewed = cameras_[i].images.getNumSubscribers() > 0;
    if (viewed && images[i]->empty()) continue;  // nor a camera_info that waits for it
    if (cameras_[i].infos.getNumSubscribers() > 0) cameras_[i].infos.publish(all[i]);
    if (viewed) cameras_[i].images.publish(to_image(*images[i], all[i].header));
  }
}

}  // namespace fpga_stereo
