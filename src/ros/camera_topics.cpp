#include "ros/camera_topics.hpp"

#include <utility>

#include "ros/calibration_url.hpp"
#include "ros/conversions.hpp"

namespace fpga_stereo {
namespace {

using camera_info_manager::CameraInfoManager;

const std::array<std::string, 2> kSides{"left", "right"};
/// What an empty URL means to the manager.
const std::string kDefaultUrl = "file://${ROS_HOME}/camera_info/${NAME}.yaml";

}  // namespace

CameraTopics::CameraTopics(const ros::NodeHandle& nh, const BoardSettings& settings,
                           std::function<void()> changed)
    : settings_(settings),
      changed_(std::move(changed)),
      nh_(nh),
      advertiser_(nh, changed_),
      calibration_prefix_(calibration_prefix(nh.getNamespace())) {}

CameraTopics::Camera CameraTopics::advertise(std::size_t side) {
  const ros::SubscriberStatusCallback on_info = [this](const auto&) { changed_(); };
  const std::string& url = side == 0 ? settings_.left_url : settings_.right_url;
  const std::string name = calibration_prefix_ + kSides[side];
  Camera camera;
  camera.manager =
      std::make_unique<CameraInfoManager>(ros::NodeHandle(nh_, kSides[side]), name, url);
  // The manager reads the file only if we cannot: it warns about a camera that is called otherwise.
  const auto read = read_calibration_url(url.empty() ? kDefaultUrl : url, name);
  if (read) camera.manager->setCameraInfo(to_camera_info(*read, {}));
  camera.images = advertiser_.advertise(kSides[side] + "/image_raw", ImageKind::kEightBit);
  camera.infos =
      nh_.advertise<sensor_msgs::CameraInfo>(kSides[side] + "/camera_info", 1, on_info, on_info);
  return camera;
}

void CameraTopics::set_advertised(bool is_advertised) {
  {
    const MutexLock lock(mutex_);
    if (is_advertised == is_advertised_) return;
  }
  // Without the lock: advertising and withdrawing may wait for callbacks that need it.
  std::array<Camera, 2> cameras;
  if (is_advertised) cameras = {advertise(0), advertise(1)};
  const MutexLock lock(mutex_);
  std::swap(cameras_, cameras);
  is_advertised_ = is_advertised;
}

CameraTopics::Demand CameraTopics::demand() const {
  const MutexLock lock(mutex_);
  Demand demand;
  demand.left = cameras_[0].images.getNumSubscribers() > 0;
  demand.right = cameras_[1].images.getNumSubscribers() > 0;
  demand.info =
      cameras_[0].infos.getNumSubscribers() > 0 || cameras_[1].infos.getNumSubscribers() > 0;
  return demand;
}

StereoCalibration CameraTopics::calibration() const {
  const auto calibration_of = [this](const Camera& camera) {
    CameraCalibration calibration;
    if (camera.manager) {
      const auto info = to_calibration(camera.manager->getCameraInfo(), "board");
      if (info) calibration = *info;
    }
    if (calibration.K[0] == 0) {
      calibration.width = settings_.image_size.width;
      calibration.height = settings_.image_size.height;
    }
    return calibration;
  };
  const MutexLock lock(mutex_);
  return {calibration_of(cameras_[0]), calibration_of(cameras_[1])};
}

void CameraTopics::publish(const RawPair& pair) {
  struct Publishers {
    image_transport::Publisher images;
    ros::Publisher infos;
  };
  // Copies stay valid if another thread withdraws the topics meanwhile.
  std::array<Publishers, 2> publishers;
  {
    const MutexLock lock(mutex_);
    publishers = {Publishers{cameras_[0].images, cameras_[0].infos},
                  Publishers{cameras_[1].images, cameras_[1].infos}};
  }
  const std::array<const cv::Mat*, 2> images{&pair.left, &pair.right};
  const std::array<const CameraCalibration*, 2> calibrations{&pair.calibration.left,
                                                             &pair.calibration.right};
  // image_geometry requires the left camera's frame in both camera_infos.
  const std_msgs::Header header = to_header(pair.stamp_ns, pair.left_frame_id);
  for (std::size_t side = 0; side < publishers.size(); ++side) {
    const Publishers& to = publishers[side];
    const bool has_viewers = to.images.getNumSubscribers() > 0;
    // A camera_info without its image would wait for it in every synchronizer.
    if (has_viewers && images[side]->empty()) continue;
    if (to.infos.getNumSubscribers() > 0) {
      to.infos.publish(to_camera_info(*calibrations[side], header));
    }
    if (has_viewers) to.images.publish(to_image(*images[side], header));
  }
}

}  // namespace fpga_stereo
