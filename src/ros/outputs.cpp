#include "ros/outputs.hpp"

#include "fpga_stereo/core/convert.hpp"
#include "ros/conversions.hpp"

namespace fpga_stereo {

Outputs::Outputs(const ros::NodeHandle& nh, const OutputTopics& topics,
                 const std::function<void()>& changed) {
  ros::NodeHandle handle(nh);
  const ros::SubscriberStatusCallback on_change = [changed](const auto&) { changed(); };
  ImageAdvertiser advertiser(nh, changed);
  if (topics.images) advertise_images(advertiser);
  if (topics.conversions) {
    // Subscribers of depth/image_rect find camera_info beside it.
    depth_ = ImageOutput({advertiser.advertise("depth", ImageKind::kDepth),
                          advertiser.advertise("depth/image_rect", ImageKind::kDepth)});
    depth_info_ =
        handle.advertise<sensor_msgs::CameraInfo>("depth/camera_info", 1, on_change, on_change);
    disparity_color_ = ImageOutput(advertiser.advertise("disparity_color", ImageKind::kEightBit));
    points2_ = CloudOutput(nh, changed);
  }
  disparity_ = handle.advertise<stereo_msgs::DisparityImage>("disparity", 1, on_change, on_change);
}

void Outputs::advertise_images(ImageAdvertiser& advertiser) {
  const auto rectified = [&](const std::string& camera) -> RectifiedOutputs {
    const auto advertise = [&](const std::string& topic) {
      return ImageOutput(advertiser.advertise(camera + topic, ImageKind::kEightBit));
    };
    return {advertise("/image_rect"), advertise("/image_rect_color")};
  };
  left_raw_.advertise(advertiser, "left");
  right_raw_.advertise(advertiser, "right");
  left_ = rectified("left");
  right_ = rectified("right");
}

void Outputs::RectifiedOutputs::add_demand(CameraDemand& demand) const {
  demand.rect = rect.has_subscribers();
  demand.rect_color = rect_color.has_subscribers();
}

Demand Outputs::demand(const Settings& settings) const {
  const bool cloud = points2_.has_subscribers();
  Demand demand;
  left_raw_.add_demand(demand.left);
  left_.add_demand(demand.left);
  right_raw_.add_demand(demand.right);
  right_.add_demand(demand.right);
  demand.left.rect = demand.left.rect || cloud;
  demand.left.rect_color =
      demand.left.rect_color || (cloud && settings.cloud.color == PointColor::kRgb);
  demand.disparity = cloud || disparity_.getNumSubscribers() > 0 || depth_.has_subscribers() ||
                     depth_info_.getNumSubscribers() > 0 || disparity_color_.has_subscribers();
  return demand;
}

Status Outputs::publish_image(Side side, const sensor_msgs::ImageConstPtr& message) {
  return (side == Side::kLeft ? left_raw_ : right_raw_).publish(message);
}

void Outputs::publish_images(const SourcePair& pair) {
  left_raw_.publish(pair.left_header(), pair.raw.left);
  right_raw_.publish(pair.right_header(), pair.raw.right);
}

void Outputs::RectifiedOutputs::publish(const CameraImages& images) {
  const auto publish_image = [&](ImageOutput& to, const cv::Mat& image) {
    if (to.has_subscribers() && !image.empty()) to.publish(images.header, image);
  };
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
  if (frame.left.rect.empty()) return;
  const CameraImages& left = frame.left;
  points2_.publish(left.header.stamp, frame.settings, [&](sensor_msgs::PointCloud2& message) {
    to_point_cloud2(frame.disparity,
                    make_reprojection(frame.geometry, frame.settings.pipeline.min_disparity),
                    left.rect_color.empty() ? left.rect : left.rect_color, frame.settings.cloud,
                    left.header, message);
  });
}

}  // namespace fpga_stereo
