#include "ros/source_pair.hpp"

#include "ros/conversions.hpp"

namespace fpga_stereo {
namespace {

Status decode(const sensor_msgs::ImageConstPtr& message, const char* camera, bool wants_color,
              cv::Mat1b& grey, cv::Mat& color) {
  const auto decoded = to_grey(message, camera);
  if (!decoded) return decoded.error();
  grey = *decoded;
  if (is_grey(*message)) {
    color = grey;
  } else if (wants_color) {
    const auto bgr = to_bgr(message, camera);
    if (!bgr) return bgr.error();
    color = *bgr;
  }
  return {};
}

}  // namespace

std_msgs::Header SourcePair::left_header() const {
  return to_header(raw.stamp_ns, raw.left_frame_id);
}

std_msgs::Header SourcePair::right_header() const {
  return to_header(right_stamp_ns, raw.right_frame_id);
}

Result<SourcePair> decode_pair(const sensor_msgs::ImageConstPtr& left,
                               const sensor_msgs::CameraInfoConstPtr& left_info,
                               const sensor_msgs::ImageConstPtr& right,
                               const sensor_msgs::CameraInfoConstPtr& right_info,
                               const Demand& demand, PairKind kind) {
  SourcePair pair;
  RawPair& raw = pair.raw;
  Status decoded = decode(left, "left", demand.left.rect_color, raw.left, raw.left_color);
  if (decoded) {
    decoded = decode(right, "right", demand.right.rect_color, raw.right, raw.right_color);
  }
  if (!decoded) return decoded.error();
  const Result<CameraCalibration> left_camera = to_calibration(*left_info, "left");
  if (!left_camera) return left_camera.error();
  const Result<CameraCalibration> right_camera = to_calibration(*right_info, "right");
  if (!right_camera) return right_camera.error();
  raw.calibration = {*left_camera, *right_camera};
  if (kind == PairKind::kRectified) {
    raw.calibration = {rectified_calibration(raw.calibration.left),
                       rectified_calibration(raw.calibration.right)};
  }
  raw.stamp_ns = static_cast<std::int64_t>(left->header.stamp.toNSec());
  pair.right_stamp_ns = static_cast<std::int64_t>(right->header.stamp.toNSec());
  raw.left_frame_id = left->header.frame_id;
  raw.right_frame_id = right->header.frame_id;
  pair.left_message = left;
  pair.right_message = right;
  pair.left_info = left_info;
  return pair;
}

}  // namespace fpga_stereo
