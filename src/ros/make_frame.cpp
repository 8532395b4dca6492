#include "ros/make_frame.hpp"

#include "ros/conversions.hpp"

namespace fpga_stereo {
namespace {

/// Of one camera. `image` has been read as grey before.
Status add_pictures(const sensor_msgs::ImageConstPtr& image, const std::string& camera,
                    const Mesh& mesh, const CameraDemand& demand, int num_threads,
                    CameraImages& images) {
  if (demand.rect && images.rect.empty()) {
    rectify_image(images.mono, mesh, num_threads, images.rect);
  }
  if (!demand.color && !demand.rect_color) return {};
  const auto color = to_bgr(image, camera);
  if (!color) return color.error();
  images.color = *color;
  if (demand.rect_color && color->channels() == 1 && !images.rect.empty()) {
    images.rect_color = images.rect;
  } else if (demand.rect_color) {
    rectify_image(*color, mesh, num_threads, images.rect_color);
  }
  return {};
}

}  // namespace

Result<StereoFrame> begin_frame(const InputPair& pair, const StereoRectification& rectification,
                                const Settings& settings) {
  const auto left = to_grey(pair.left, "left");
  if (!left) return left.error();
  const auto right = to_grey(pair.right, "right");
  if (!right) return right.error();
  if (Status s = validate_image(*left, rectification, "left"); !s) return s.error();
  if (Status s = validate_image(*right, rectification, "right"); !s) return s.error();

  StereoFrame frame;
  frame.left.header = pair.left->header;
  frame.right.header = pair.right->header;
  frame.right.header.stamp = frame.left.header.stamp;
  frame.left.mono = *left;
  frame.right.mono = *right;
  frame.left.raw = pair.left;
  frame.right.raw = pair.right;
  frame.left_info = *pair.left_info;
  frame.geometry = rectification.geometry;
  frame.settings = settings;
  return frame;
}

Status add_pictures(const InputPair& pair, const StereoRectification& rectification,
                    const Demand& demand, StereoFrame& frame) {
  const int threads = frame.settings.num_threads;
  Status added =
      add_pictures(pair.left, "left", rectification.left.mesh, demand.left, threads, frame.left);
  if (added) {
    added = add_pictures(pair.right, "right", rectification.right_unshifted, demand.right, threads,
                         frame.right);
  }
  return added;
}

}  // namespace fpga_stereo
