// What a board made from one pair.
#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "fpga_stereo/link/streams.hpp"

namespace fpga_stereo::link {

/// The outcome of receiving one frame.
enum class FrameVerdict {
  kGood,
  kIncomplete,    // rows are missing and hold no disparity; only if the caller accepts such frames
  kRowsMissing,   // dropped: rows are missing
  kNoTrailer,     // dropped: the next frame began, or the link was lost, before the trailer came
  kFlagged,       // dropped: the board flagged the frame as bad
  kBadSignature,  // dropped: all rows came, but they are not what the board sent
  kBadStamp,      // dropped: the board took it at an impossible time
};

/// The frames that a board made from one pair. They share the pair's frame_id and timestamp.
struct FrameSet {
  std::uint64_t frame_id = 0;
  /// us. Mid-exposure by the board's clock; for host pairs the timestamp that the host sent.
  std::uint64_t timestamp = 0;
  std::uint32_t configuration = 0;  // configuration id that made the frames
  /// By stream. All images have one size; an image is empty if it did not come or was dropped.
  std::array<cv::Mat, kNumStreams> images;
  std::vector<std::string> dropped;    // one message per frame that was dropped or is incomplete
  std::vector<FrameVerdict> verdicts;  // the verdict that belongs to each of those messages

  const cv::Mat& image(Stream stream) const { return images[static_cast<std::size_t>(stream)]; }
};

/// A frame set as the host received it.
struct ReceivedFrames {
  FrameSet set;
  std::uint64_t tag = 0;  // configuration tag: DesiredState::tag of what made the frames
  /// Mid-exposure, s, by the host's clock; for host pairs the timestamp that the host sent.
  double stamp = 0;
  double arrived = 0;  // s, by the host's clock: arrival of the last byte
  /// How often the host's clock was set since the device was opened: the stamps of frames with
  /// different counts are not comparable.
  std::uint64_t clock_steps = 0;
};

}  // namespace fpga_stereo::link
