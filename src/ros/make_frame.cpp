#include "ros/make_frame.hpp"

namespace fpga_stereo {
namespace {

void add_rectified(const cv::Mat& grey, const cv::Mat& color, const Mesh& mesh,
                   const CameraDemand& demand, int num_threads, CameraImages& images) {
  const bool is_grey = color.channels() == 1;
  const bool needs_rect = demand.rect || (demand.rect_color && is_grey);
  if (needs_rect && images.rect.empty() && !grey.empty()) {
    rectify_image(grey, mesh, num_threads, images.rect);
  }
  if (!demand.rect_color || color.empty()) return;
  if (is_grey) {
    images.rect_color = images.rect;
  } else {
    rectify_image(color, mesh, num_threads, images.rect_color);
  }
}

}  // namespace

void StereoFrame::own_pixels() {
  disparity = disparity.clone();
  for (CameraImages* images : {&left, &right}) {
    images->rect = images->rect.clone();
    images->rect_color = images->rect_color.clone();
  }
}

StereoFrame make_empty_frame(const SourcePair& pair, const Settings& settings) {
  StereoFrame frame;
  frame.left.header = pair.left_header();
  frame.right.header = pair.right_header();
  frame.left_info = pair.left_info;
  frame.settings = settings;
  frame.number = pair.number;
  return frame;
}

Status check_pair_size(const RawPair& pair, const StereoRectification& rectification) {
  const Status left = validate_image(pair.left, rectification, "left");
  return left ? validate_image(pair.right, rectification, "right") : left;
}

void add_rectified_images(const RawPair& pair, const StereoRectification& rectification,
                          const Demand& demand, StereoFrame& frame) {
  const int num_threads = frame.settings.num_threads;
  add_rectified(pair.left, pair.left_color, rectification.left.mesh, demand.left, num_threads,
                frame.left);
  add_rectified(pair.right, pair.right_color, rectification.right_unshifted, demand.right,
                num_threads, frame.right);
}

}  // namespace fpga_stereo
