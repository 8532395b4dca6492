#include "ros/board_frames.hpp"

#include <fmt/format.h>

#include <boost/make_shared.hpp>
#include <limits>

#include "ros/conversions.hpp"
#include "ros/make_frame.hpp"

namespace fpga_stereo {
namespace {

using link::FrameSet;
using link::PlannedConfiguration;
using link::ReceivedFrames;
using link::Stream;

/// Returns an error that names the missing image and, if known, why the link dropped it.
Error missing(const FrameSet& set, const char* image) {
  return {ErrorKind::kIo, set.dropped.empty()
                              ? fmt::format("board frame dropped: it has no {}", image)
                              : set.dropped.front()};
}

/// Adds what the board computed.
void add_board_images(const ReceivedFrames& received, const PlannedConfiguration& planned,
                      StereoFrame& frame) {
  const FrameSet& set = received.set;
  frame.settings.pipeline = planned.parameters;
  frame.arrived = received.arrived;
  if (!planned.rectification) return;
  frame.geometry = planned.rectification->geometry;
  frame.disparity = set.image(Stream::kDisparity);
  frame.left.rect = set.image(Stream::kRectifiedLeft);
  // Others expect a right image that is not shifted by min_disparity.
  if (planned.parameters.min_disparity == 0) {
    frame.right.rect = set.image(Stream::kRectifiedRight);
  }
}

}  // namespace

Result<ros::Time> to_stamp(double seconds) {
  constexpr std::uint32_t kMaxSeconds = std::numeric_limits<std::uint32_t>::max();
  if (seconds > 0 && seconds < kMaxSeconds) return ros::Time(seconds);
  return Error{ErrorKind::kInvalid,
               fmt::format("board frame dropped: its stamp is {:f} s, allowed are 0 to {} s",
                           seconds, kMaxSeconds)};
}

Status check_sizes(const FrameSet& set, cv::Size size) {
  for (int s = 0; s < link::kNumStreams; ++s) {
    const auto stream = static_cast<Stream>(s);
    const cv::Mat& image = set.image(stream);
    if (image.empty() || image.size() == size) continue;
    return Error{ErrorKind::kImageSize,
                 fmt::format("board frame dropped: its {} image is {}x{} instead of {}x{}",
                             name(stream), image.cols, image.rows, size.width, size.height)};
  }
  return {};
}

Status check_raw_images(const FrameSet& set) {
  if (set.image(Stream::kRawLeft).empty()) return missing(set, "raw left image");
  if (set.image(Stream::kRawRight).empty()) return missing(set, "raw right image");
  return {};
}

SourcePair camera_pair(const FrameSet& set, const PlannedConfiguration& planned,
                       const ros::Time& stamp, const std::string& frame_id, std::uint64_t number) {
  SourcePair pair;
  RawPair& raw = pair.raw;
  raw.left = raw.left_color = set.image(Stream::kRawLeft);
  raw.right = raw.right_color = set.image(Stream::kRawRight);
  raw.calibration = planned.calibration;
  raw.stamp_ns = static_cast<std::int64_t>(stamp.toNSec());
  raw.left_frame_id = raw.right_frame_id = frame_id;
  pair.number = number;
  pair.right_stamp_ns = raw.stamp_ns;
  pair.left_info = boost::make_shared<sensor_msgs::CameraInfo>(
      to_camera_info(planned.calibration.left, pair.left_header()));
  return pair;
}

Result<StereoFrame> frame_of_host_pair(const ReceivedFrames& received,
                                       const PlannedConfiguration& planned, const SourcePair& pair,
                                       const Settings& settings, const Demand& demand) {
  if (received.set.image(Stream::kDisparity).empty()) return missing(received.set, "disparity");
  if (!planned.rectification || pair.raw.calibration != planned.calibration) {
    return Error{ErrorKind::kCalibration,
                 "board frame dropped: the calibration changed while it was in flight"};
  }
  StereoFrame frame = make_empty_frame(pair, settings);
  add_board_images(received, planned, frame);
  add_rectified_images(pair.raw, *planned.rectification, demand, frame);
  return frame;
}

StereoFrame frame_of_camera_pair(const ReceivedFrames& received,
                                 const PlannedConfiguration& planned, const SourcePair& pair,
                                 const Settings& settings, const Demand& demand) {
  StereoFrame frame = make_empty_frame(pair, settings);
  add_board_images(received, planned, frame);
  if (!planned.rectification) return frame;
  add_rectified_images(pair.raw, *planned.rectification, demand, frame);
  // The board's cameras are grey.
  frame.left.rect_color = frame.left.rect;
  frame.right.rect_color = frame.right.rect;
  return frame;
}

}  // namespace fpga_stereo
