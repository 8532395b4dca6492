#include "ros/camera_topics.hpp"

#include <utility>

#include "ros/conversions.hpp"

namespace fpga_stereo {
namespace {

std::string name_of(Side side) { return side == Side::kLeft ? "left" : "right"; }

}  // namespace

CameraTopics::CameraTopics(const ros::NodeHandle& nh, const BoardSettings& settings,
                           std::function<void()> changed)
    : settings_(settings),
      changed_(std::move(changed)),
      nh_(nh),
      advertiser_(nh, changed_),
      store_(calibration_prefix(nh.getNamespace()), {settings.left_url, settings.right_url}) {}

CameraTopics::Camera CameraTopics::advertise(Side side) {
  const ros::SubscriberStatusCallback on_info = [this](const auto&) { changed_(); };
  const std::string name = name_of(side);
  Camera camera;
  camera.images = advertiser_.advertise(name + "/image_raw", ImageKind::kEightBit);
  camera.infos = nh_.advertise<sensor_msgs::CameraInfo>(name + "/camera_info", 1, on_info, on_info);
  using Call = sensor_msgs::SetCameraInfo;
  const boost::function<bool(Call::Request&, Call::Response&)> on_call =
      [this, side](Call::Request& request, Call::Response& response) {
        set_calibration(side, request.camera_info, response);
        return true;
      };
  camera.set_info = nh_.advertiseService(name + "/set_camera_info", on_call);
  return camera;
}

void CameraTopics::set_calibration(Side side, const sensor_msgs::CameraInfo& info,
                                   sensor_msgs::SetCameraInfoResponse& response) {
  const auto camera = to_calibration(info, name_of(side));
  const auto stored =
      camera ? store_.set(side, *camera, image_size()) : Result<std::string>(camera.error());
  response.success = stored ? 1 : 0;
  response.status_message = stored ? *stored : stored.error().message;
  std::optional<std::uint64_t> kept_back;
  {
    const MutexLock lock(mutex_);
    kept_back = log_.admit(stored ? response.status_message : "refused");
  }
  if (!kept_back) return;
  const std::string line =
      with_kept_back("set_camera_info: " + response.status_message, *kept_back);
  if (stored) {
    ROS_INFO_STREAM_NAMED("stereo", line);
  } else {
    ROS_ERROR_STREAM_NAMED("stereo", line);
  }
}

cv::Size CameraTopics::image_size() const {
  {
    const MutexLock lock(mutex_);
    if (seen_size_) return *seen_size_;
  }
  return calibration().left.image_size();
}

void CameraTopics::set_advertised(bool is_advertised) {
  {
    const MutexLock lock(mutex_);
    if (is_advertised == is_advertised_) return;
  }
  // Without the lock: advertising and withdrawing may wait for callbacks that need it.
  std::array<Camera, 2> cameras;
  if (is_advertised) {
    for (const Error& problem : store_.load()) {
      ROS_WARN_STREAM_NAMED("stereo", problem.message);
    }
    cameras = {advertise(Side::kLeft), advertise(Side::kRight)};
  }
  const MutexLock lock(mutex_);
  seen_size_.reset();
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
  StereoCalibration pair = store_.calibration();
  for (CameraCalibration* camera : {&pair.left, &pair.right}) {
    if (camera->K[0] != 0) continue;
    camera->width = settings_.image_size.width;
    camera->height = settings_.image_size.height;
  }
  return pair;
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
    for (const cv::Mat* image : {&pair.left, &pair.right}) {
      if (!image->empty()) seen_size_ = image->size();
    }
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
