#include "ros/make_frame.hpp"

namespace fpga_stereo {
namespace {

void add_rectified(const Mesh& mesh, const CameraDemand& demand, int num_threads,
                   CameraImages& images) {
  const bool is_grey = images.color.channels() == 1;
  const bool needs_rect = demand.rect || (demand.rect_color && is_grey);
  if (needs_rect && images.rect.empty() && !images.mono.empty()) {
    rectify_image(images.mono, mesh, num_threads, images.rect);
  }
  if (!demand.rect_color || images.color.empty()) return;
  if (is_grey) {
    images.rect_color = images.rect;
  } else {
    rectify_image(images.color, mesh, num_threads, images.rect_color);
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

StereoFrame make_raw_frame(const SourcePair& pair, const Settings& settings) {
  StereoFrame frame;
  frame.left.header = pair.left_header();
  frame.right.header = pair.right_header();
  frame.left.mono = pair.raw.left;
  frame.left.color = pair.raw.left_color;
  frame.right.mono = pair.raw.right;
  frame.right.color = pair.raw.right_color;
  frame.left.message = pair.left_message;
  frame.right.message = pair.right_message;
  frame.left_info = pair.left_info;
  frame.settings = settings;
  frame.number = pair.number;
  return frame;
}

Status check_pair_size(const RawPair& pair, const StereoRectification& rectification) {
  const Status left = validate_image(pair.left, rectification, "left");
  return left ? validate_image(pair.right, rectification, "right") : left;
}

void add_rectified_images(const StereoRectification& rectification, const Demand& demand,
                          StereoFrame& frame) {
  const int num_threads = frame.settings.num_threads;
  add_rectified(rectification.left.mesh, demand.left, num_threads, frame.left);
  add_rectified(rectification.right_unshifted, demand.right, num_threads, frame.right);
}

}  // namespace fpga_stereo
