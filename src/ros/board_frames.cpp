#include "ros/board_frames.hpp"

#include <limits>
#include <string>

#include "ros/conversions.hpp"
#include "ros/make_frame.hpp"

namespace fpga_stereo {
namespace {

using link::FrameSet;
using link::Stream;

std::string text(cv::Size size) {
  return std::to_string(size.width) + "x" + std::to_string(size.height);
}

/// The right image as others expect it: not shifted by min_disparity.
cv::Mat rectified_right(const FrameSet& set, const BoardPlan::Made& made) {
  const bool shifted = made.settings.pipeline.min_disparity != 0;
  return shifted ? cv::Mat() : set.image(Stream::kRectifiedRight);
}

/// What the set lacks, in the words of what dropped it.
Error lacking(const FrameSet& set, const std::string& what) {
  return {ErrorKind::kIo, set.dropped.empty() ? "frame of the board dropped: it has no " + what
                                              : set.dropped.front()};
}

}  // namespace

Result<ros::Time> to_stamp(double seconds) {
  constexpr double kMost = std::numeric_limits<std::uint32_t>::max();
  if (seconds > 0 && seconds < kMost) return ros::Time(seconds);
  return Error{ErrorKind::kInvalid, "frame of the board dropped: its stamp is " +
                                        std::to_string(seconds) + " s: allowed 0 to " +
                                        std::to_string(static_cast<std::uint32_t>(kMost))};
}

Status check_sizes(const FrameSet& set, cv::Size size) {
  for (int s = 0; s < link::kNumStreams; ++s) {
    const auto stream = static_cast<Stream>(s);
    const cv::Mat& image = set.image(stream);
    if (image.empty() || image.size() == size) continue;
    return Error{ErrorKind::kImageSize, "frame of the board dropped: its " +
                                            std::string(name(stream)) + " image is " +
                                            text(image.size()) + " instead of " + text(size)};
  }
  return {};
}

Result<StereoFrame> frame_of_pair(const link::ReceivedFrames& received, const BoardPlan::Made& made,
                                  const InputPair& pair, const Demand& demand) {
  const FrameSet& set = received.set;
  if (set.image(Stream::kDisparity).empty()) return lacking(set, "disparity");
  if (!made.rectification || !same_calibration({*pair.left_info, *pair.right_info}, made.infos)) {
    return Error{ErrorKind::kCalibration,
                 "frame of the board dropped: the calibration changed under way"};
  }
  auto begun = begin_frame(pair, *made.rectification, made.settings);
  if (!begun) return begun.error();
  StereoFrame& frame = *begun;
  frame.arrived = received.arrived;
  frame.disparity = set.image(Stream::kDisparity);
  frame.left.rect = set.image(Stream::kRectifiedLeft);
  frame.right.rect = rectified_right(set, made);
  if (const Status added = add_pictures(pair, *made.rectification, demand, frame); !added) {
    return added.error();
  }
  return begun;
}

StereoFrame frame_of_cameras(const link::ReceivedFrames& received, const BoardPlan::Made& made,
                             const Demand& demand, const std_msgs::Header& header) {
  const FrameSet& set = received.set;
  StereoFrame frame;
  frame.left.header = frame.right.header = header;
  frame.left_info = made.infos.left;
  frame.left_info.header = header;
  frame.settings = made.settings;
  frame.arrived = received.arrived;
  frame.left.mono = frame.left.color = set.image(Stream::kRawLeft);
  frame.right.mono = frame.right.color = set.image(Stream::kRawRight);
  if (!made.rectification) return frame;

  frame.geometry = made.rectification->geometry;
  frame.disparity = set.image(Stream::kDisparity);
  frame.left.rect = set.image(Stream::kRectifiedLeft);
  frame.right.rect = rectified_right(set, made);
  // What a board does not send, or only shifted, is made of its raw images.
  const auto rectify = [&](const CameraDemand& wanted, const Mesh& mesh, CameraImages& images) {
    if ((wanted.rect || wanted.rect_color) && images.rect.empty() && !images.mono.empty()) {
      rectify_image(images.mono, mesh, made.settings.num_threads, images.rect);
    }
    images.rect_color = images.rect;
  };
  rectify(demand.left, made.rectification->left.mesh, frame.left);
  rectify(demand.right, made.rectification->right_unshifted, frame.right);
  return frame;
}

Result<InputPair> raw_pair(const FrameSet& set, const BoardPlan::Made& made,
                           const std_msgs::Header& header) {
  const cv::Mat& left = set.image(Stream::kRawLeft);
  const cv::Mat& right = set.image(Stream::kRawRight);
  if (left.empty() || right.empty()) return lacking(set, "raw pair");
  const auto info = [&](const sensor_msgs::CameraInfo& from) {
    auto message = boost::make_shared<sensor_msgs::CameraInfo>(from);
    message->header = header;
    return message;
  };
  return InputPair{to_image(left, header), to_image(right, header), info(made.infos.left),
                   info(made.infos.right)};
}

}  // namespace fpga_stereo
