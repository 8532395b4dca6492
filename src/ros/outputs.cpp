#include "ros/outputs.hpp"

#include "fpga_stereo/core/convert.hpp"
#include "ros/conversions.hpp"

namespace fpga_stereo {

Outputs::Outputs(const ros::NodeHandle& nh, const std::function<void()>& changed) : transport_(nh) {
  const ros::SubscriberStatusCallback on_change = [changed](const auto&) { changed(); };
  const image_transport::SubscriberStatusCallback on_image_change = [changed](const auto&) {
    changed();
  };
  const auto advertise_image = [&](const std::string& topic) {
    return ImageOutput(transport_.advertise(topic, 1, on_image_change, on_image_change));
  };
  ros::NodeHandle handle(nh);
  const auto advertise_camera = [&](const std::string& side) -> CameraOutputs {
    return {advertise_image(side + "/image_mono"), advertise_image(side + "/image_color"),
            advertise_image(side + "/image_rect"), advertise_image(side + "/image_rect_color")};
  };
  left_ = advertise_camera("left");
  right_ = advertise_camera("right");
  depth_ = advertise_image("depth");
  disparity_color_ = advertise_image("disparity_color");
  depth_info_ =
      handle.advertise<sensor_msgs::CameraInfo>("depth/camera_info", 1, on_change, on_change);
  disparity_ = handle.advertise<stereo_msgs::DisparityImage>("disparity", 1, on_change, on_change);
  points2_ = handle.advertise<sensor_msgs::PointCloud2>("points2", 1, on_change, on_change);
}

CameraDemand Outputs::CameraOutputs::demand() const {
  CameraDemand demand;
  demand.mono = mono.has_subscribers();
  demand.color = color.has_subscribers();
  demand.rect = rect.has_subscribers();
  demand.rect_color = rect_color.has_subscribers();
  return demand;
}

Demand Outputs::demand(const Settings& settings) const {
  const bool cloud = points2_.getNumSubscribers() > 0;
  Demand demand;
  demand.left = left_.demand();
  demand.right = right_.demand();
  demand.left.rect = demand.left.rect || cloud;
  demand.left.rect_color =
      demand.left.rect_color || (cloud && settings.cloud.color == PointColor::kRgb);
  demand.disparity = cloud || disparity_.getNumSubscribers() > 0 || depth_.has_subscribers() ||
                     depth_info_.getNumSubscribers() > 0 || disparity_color_.has_subscribers();
  return demand;
}

void Outputs::CameraOutputs::publish(const CameraImages& images) {
  const auto publish_image = [&](ImageOutput& to, const cv::Mat& image) {
    if (to.has_subscribers() && !image.empty()) to.publish(images.header, image, images.message);
  };
  publish_image(mono, images.mono);
  publish_image(color, images.color);
  publish_image(rect, images.rect);
  publish_image(rect_color, images.rect_color);
}

void Outputs::publish(const StereoFrame& frame) {
  left_.publish(frame.left);
  right_.publish(frame.right);
  if (frame.disparity.empty()) return;

  const Parameters& parameters = frame.settings.pipeline;
  if (disparity_.getNumSubscribers() > 0) {
    const auto message = disparities_.take();
    to_disparity_image(frame.disparity, frame.geometry, parameters, frame.left.header, *message);
    disparity_.publish(message);
  }
  publish_depth(frame);
  if (disparity_color_.has_subscribers()) {
    cv::Mat3b picture;
    to_color(frame.disparity, parameters.disparity_range, picture);
    disparity_color_.publish(frame.left.header, picture);
  }
  publish_cloud(frame);
}

void Outputs::publish_depth(const StereoFrame& frame) {
  const Reprojection r = make_reprojection(frame.geometry, frame.settings.pipeline.min_disparity);
  const cv::Size size = frame.disparity.size();
  if (depth_.has_subscribers() && frame.settings.depth_encoding == DepthEncoding::kMetres) {
    depth_.publish(frame.left.header, size, CV_32FC1, [&](cv::Mat& to) {
      cv::Mat1f metres = to;
      to_depth(frame.disparity, r, metres);
    });
  } else if (depth_.has_subscribers()) {
    depth_.publish(frame.left.header, size, CV_16UC1, [&](cv::Mat& to) {
      cv::Mat1w millimetres = to;
      to_depth(frame.disparity, r, millimetres);
    });
  }
  if (depth_info_.getNumSubscribers() > 0) {
    sensor_msgs::CameraInfo info = *frame.left_info;
    info.header = frame.left.header;
    info.P[3] = 0;
    depth_info_.publish(info);
  }
}

void Outputs::publish_cloud(const StereoFrame& frame) {
  if (points2_.getNumSubscribers() == 0 || frame.left.rect.empty()) return;
  const Settings& settings = frame.settings;
  const double elapsed = (frame.left.header.stamp - last_cloud_).toSec();
  // Stamps jitter, so a tenth of a period early is in time. Time that went back is not early.
  const bool is_early = elapsed >= 0 && elapsed * settings.cloud_max_rate < 0.9;
  if (settings.cloud_max_rate > 0 && is_early) return;
  last_cloud_ = frame.left.header.stamp;
  const cv::Mat& color = frame.left.rect_color.empty() ? frame.left.rect : frame.left.rect_color;
  const auto message = clouds_.take();
  to_point_cloud2(frame.disparity,
                  make_reprojection(frame.geometry, settings.pipeline.min_disparity), color,
                  settings.cloud, frame.left.header, *message);
  points2_.publish(message);
}

}  // namespace fpga_stereo
