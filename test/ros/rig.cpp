#include "ros/rig.hpp"

#include <cv_bridge/cv_bridge.h>

#include "core/reference_pipeline.hpp"
#include "ros/conversions.hpp"
#include "ros/graph.hpp"
#include "support/images.hpp"

namespace fpga_stereo::test {
namespace {

constexpr double kFocal = 300;     // px
constexpr double kBaseline = 0.1;  // m

sensor_msgs::CameraInfo camera_info(cv::Size size, bool right, bool distorted) {
  sensor_msgs::CameraInfo info;
  info.header.frame_id = "stereo_left_optical_frame";
  info.width = static_cast<std::uint32_t>(size.width);
  info.height = static_cast<std::uint32_t>(size.height);
  info.distortion_model = "plumb_bob";
  info.D = {0, 0, 0, 0, 0};
  if (distorted) info.D = {-0.1, 0.02, 0.001, -0.0005, 0};
  const double cx = size.width / 2.0;
  const double cy = size.height / 2.0;
  info.K = {kFocal, 0, cx, 0, kFocal, cy, 0, 0, 1};
  info.R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  info.P = {kFocal, 0, cx, right ? -kFocal * kBaseline : 0, 0, kFocal, cy, 0, 0, 0, 1, 0};
  return info;
}

sensor_msgs::Image image_message(const cv::Mat1b& image) {
  std_msgs::Header header;
  header.frame_id = "stereo_left_optical_frame";
  return *cv_bridge::CvImage(header, "mono8", image).toImageMsg();
}

}  // namespace

bool eventually(const std::function<bool()>& condition, double seconds) {
  const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(seconds);
  while (ros::WallTime::now() < end) {
    if (condition()) return true;
    ros::WallDuration(0.01).sleep();
  }
  return condition();
}

bool always(const std::function<bool()>& condition, double seconds) {
  return !eventually([&] { return !condition(); }, seconds);
}

void PairMessages::set_stamp(const ros::Time& stamp) {
  left.header.stamp = right.header.stamp = stamp;
  left_info.header.stamp = right_info.header.stamp = stamp;
}

PairMessages synthetic_pair(cv::Size size, int disparity, bool distorted) {
  const SlantedPair images = slanted_pair(size, Texture(7), disparity, 0);
  return {image_message(images.left), image_message(images.right),
          camera_info(size, false, distorted), camera_info(size, true, distorted)};
}

cv::Mat1w core_disparity(const PairMessages& pair, const Parameters& parameters) {
  const auto rectification = make_stereo_rectification(*to_calibration(pair.left_info, "left"),
                                                       *to_calibration(pair.right_info, "right"),
                                                       parameters.min_disparity);
  const cv::Mat left = cv_bridge::toCvCopy(pair.left, "mono8")->image;
  const cv::Mat right = cv_bridge::toCvCopy(pair.right, "mono8")->image;
  ReferencePipeline pipeline;
  return pipeline.process(left, right, *rectification, parameters, 1).disparity.clone();
}

Rig::Rig(const std::string& ns, const std::string& image, const std::string& node)
    : nh_(ns),
      node_(node),
      left_(nh_.advertise<sensor_msgs::Image>("left/" + image, 10)),
      right_(nh_.advertise<sensor_msgs::Image>("right/" + image, 10)),
      left_info_(nh_.advertise<sensor_msgs::CameraInfo>("left/camera_info", 10)),
      right_info_(nh_.advertise<sensor_msgs::CameraInfo>("right/camera_info", 10)),
      status_(nh_, node + "/status") {}

ros::Time Rig::publish(PairMessages pair, bool keep_stamps) {
  // Strictly rising, even if the clock has not advanced.
  static ros::Time last;
  if (!keep_stamps) {
    last = std::max(ros::Time::now(), last + ros::Duration(0, 1000));
    pair.set_stamp(last);
  }
  left_info_.publish(pair.left_info);
  right_info_.publish(pair.right_info);
  left_.publish(pair.left);
  right_.publish(pair.right);
  return pair.left.header.stamp;
}

Rig::Subscribers Rig::subscribers() const {
  return {left_.getNumSubscribers(), left_info_.getNumSubscribers(), right_.getNumSubscribers(),
          right_info_.getNumSubscribers()};
}

bool Rig::node_listens() {
  return eventually([this] {
    const Subscribers s = subscribers();
    return s.left > 0 && s.left_info > 0 && s.right > 0 && s.right_info > 0 && all_links_are_up();
  });
}

bool Rig::node_is_unsubscribed() {
  return eventually([this] { return subscribers() == Subscribers(); });
}

dynamic_reconfigure::Config Rig::reconfigure(const std::string& name, const std::string& value) {
  dynamic_reconfigure::Reconfigure call;
  const std::string service = nh_.resolveName(node_ + "/set_parameters");
  ros::service::waitForService(service, ros::Duration(10));
  const bool number = value.find_first_not_of("0123456789.-") == std::string::npos;
  if (name == "uniqueness_ratio" || name == "cloud_max_rate") {
    dynamic_reconfigure::DoubleParameter real;
    real.name = name;
    real.value = std::stod(value);
    call.request.config.doubles.push_back(real);
  } else if (number) {
    dynamic_reconfigure::IntParameter integer;
    integer.name = name;
    integer.value = std::stoi(value);
    call.request.config.ints.push_back(integer);
  } else if (value == "true" || value == "false") {
    dynamic_reconfigure::BoolParameter flag;
    flag.name = name;
    flag.value = value == "true" ? 1 : 0;
    call.request.config.bools.push_back(flag);
  } else {
    dynamic_reconfigure::StrParameter text;
    text.name = name;
    text.value = value;
    call.request.config.strs.push_back(text);
  }
  ros::service::call(service, call);
  return call.response.config;
}

StereoStatus Rig::status_when(const std::function<bool(const StereoStatus&)>& condition,
                              double seconds) {
  eventually([&] { return status_.last() != nullptr && condition(*status_.last()); }, seconds);
  return status_.last() == nullptr ? StereoStatus() : *status_.last();
}

StereoStatus Rig::status() {
  // The node may have begun the next status before this call, but not the one after it.
  const std::size_t seen = status_.count();
  eventually([&] { return status_.count() >= seen + 2; });
  return *status_.last();
}

std::string value_of(const dynamic_reconfigure::Config& config, const std::string& name) {
  for (const auto& p : config.ints) {
    if (p.name == name) return std::to_string(p.value);
  }
  for (const auto& p : config.strs) {
    if (p.name == name) return p.value;
  }
  for (const auto& p : config.bools) {
    if (p.name == name) return p.value != 0 ? "true" : "false";
  }
  for (const auto& p : config.doubles) {
    if (p.name == name) return std::to_string(p.value);
  }
  return "";
}

}  // namespace fpga_stereo::test
