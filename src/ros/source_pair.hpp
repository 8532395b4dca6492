// A raw pair on its way to a source.
#pragma once

#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <std_msgs/Header.h>

#include <cstdint>

#include "fpga_stereo/core/raw_pair.hpp"
#include "fpga_stereo/core/result.hpp"
#include "ros/demand.hpp"

namespace fpga_stereo {

/// A decoded pair with the messages that it came in. Images of mono8 messages lie in the memory of
/// the message: copy the SourcePair, not its RawPair, to keep the pixels.
struct SourcePair {
  RawPair raw;
  std::uint64_t number = 0;  // rises from pair to pair, even if stamps go back; see StampGate
  std::int64_t right_stamp_ns = 0;  // of the right image; approximate_sync pairs different stamps
  sensor_msgs::ImageConstPtr left_message, right_message;  // null for a board's cameras
  sensor_msgs::CameraInfoConstPtr left_info;               // never null

  std_msgs::Header left_header() const;
  std_msgs::Header right_header() const;
};

enum class PairKind {
  kRaw,        // image_raw: camera_info describes how to rectify it
  kRectified,  // image_rect: P of camera_info describes it
};

/// Decodes the four messages of a pair. The stamp is that of the left image; colour is decoded only
/// for cameras whose rectified colour images are in demand. Refuses images that cannot be decoded
/// and camera_infos with impossible sizes.
Result<SourcePair> decode_pair(const sensor_msgs::ImageConstPtr& left,
                               const sensor_msgs::CameraInfoConstPtr& left_info,
                               const sensor_msgs::ImageConstPtr& right,
                               const sensor_msgs::CameraInfoConstPtr& right_info,
                               const Demand& demand, PairKind kind = PairKind::kRaw);

}  // namespace fpga_stereo
