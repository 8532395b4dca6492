#include "ros/camera_info_input.hpp"

#include <fmt/format.h>

#include <boost/make_shared.hpp>
#include <utility>

#include "ros/calibration_url.hpp"
#include "ros/conversions.hpp"

namespace fpga_stereo {
namespace {

/// Returns true if any node publishes the topic, this one included.
bool has_publisher(const std::string& topic) {
  XmlRpc::XmlRpcValue request, response, state;
  request[0] = ros::this_node::getName();
  if (!ros::master::execute("getSystemState", request, response, state, false)) return false;
  XmlRpc::XmlRpcValue& published = state[0];  // pairs of topic and publishers
  for (int i = 0; i < published.size(); ++i) {
    if (static_cast<std::string&>(published[i][0]) == topic) return true;
  }
  return false;
}

}  // namespace

CameraInfoInput::CameraInfoInput(const ros::NodeHandle& nh, const std::string& side,
                                 const std::string& url)
    : nh_(nh), side_(side), topic_(nh_.resolveName(side + "/camera_info")), url_(url) {}

void CameraInfoInput::subscribe() {
  if (is_from_file()) return read_file();
  // A queue of 1 as in image_pipeline: the synchronizer has the queue that matters.
  subscriber_ = nh_.subscribe<sensor_msgs::CameraInfo>(
      side_ + "/camera_info", 1,
      [this](const sensor_msgs::CameraInfoConstPtr& info) { signalMessage(info); });
}

void CameraInfoInput::read_file() {
  const std::string name = calibration_prefix(nh_.getNamespace()) + side_;
  const Result<CameraCalibration> read = read_calibration_url(url_, name);
  if (!read) {
    const auto line = admit("unusable", fmt::format("the {} camera is not calibrated: {}", side_,
                                                    read.error().message));
    if (line) ROS_ERROR_STREAM(*line);
    const MutexLock lock(mutex_);
    trouble_ = read.error().message;
    return;
  }
  ros::Publisher publisher;
  if (has_publisher(topic_)) {
    const auto line = admit("not published",
                            fmt::format("the calibration in {} is not published, because {} has a "
                                        "publisher; this node uses the file",
                                        url_, topic_));
    if (line) ROS_WARN_STREAM(*line);
  } else {
    publisher = nh_.advertise<sensor_msgs::CameraInfo>(side_ + "/camera_info", 1);
  }
  const MutexLock lock(mutex_);
  calibration_ = *read;
  trouble_.reset();
  is_size_checked_ = false;
  publisher_ = publisher;
}

void CameraInfoInput::unsubscribe() {
  subscriber_.shutdown();
  ros::Publisher publisher;
  const MutexLock lock(mutex_);
  calibration_.reset();
  trouble_.reset();
  std::swap(publisher_, publisher);
}

void CameraInfoInput::on_image(const sensor_msgs::Image& image, const std::string& frame_id) {
  sensor_msgs::CameraInfoPtr info;
  ros::Publisher publisher;
  cv::Size calibrated;
  {
    const MutexLock lock(mutex_);
    if (!calibration_) return;
    std_msgs::Header header = image.header;
    header.frame_id = frame_id;
    info = boost::make_shared<sensor_msgs::CameraInfo>(to_camera_info(*calibration_, header));
    publisher = publisher_;
    calibrated = calibration_->image_size();
  }
  check_size(image, calibrated);
  if (publisher) publisher.publish(info);
  signalMessage(info);
}

void CameraInfoInput::check_size(const sensor_msgs::Image& image, cv::Size calibrated) {
  {
    const MutexLock lock(mutex_);
    if (std::exchange(is_size_checked_, true)) return;
  }
  if (image.width == static_cast<std::uint32_t>(calibrated.width) &&
      image.height == static_cast<std::uint32_t>(calibrated.height)) {
    return;
  }
  const auto line = admit(
      "size",
      fmt::format("the images of the {} camera are {}x{}, but the calibration in {} is for "
                  "{}x{}: calibrate at this size",
                  side_, image.width, image.height, url_, calibrated.width, calibrated.height));
  if (line) ROS_ERROR_STREAM(*line);
}

std::optional<std::string> CameraInfoInput::admit(const char* cause, const std::string& line) {
  const MutexLock lock(mutex_);
  const auto kept_back = log_.admit(cause);
  if (!kept_back) return std::nullopt;
  return with_kept_back(line, *kept_back);
}

std::optional<std::string> CameraInfoInput::trouble() const {
  const MutexLock lock(mutex_);
  return trouble_;
}

}  // namespace fpga_stereo
