// The topics image_mono and image_color of one camera.
#pragma once

#include <atomic>
#include <string>

#include "fpga_stereo/core/result.hpp"
#include "ros/demand.hpp"
#include "ros/image_output.hpp"

namespace fpga_stereo {

/// Passes the images of one camera on as they arrive: they need neither the other camera nor a
/// calibration. Any thread; while one publishes, the images of others are dropped. That happens
/// only when a board takes over from a topic, or the other way round.
class RawOutputs {
 public:
  RawOutputs() = default;
  RawOutputs(const RawOutputs&) = delete;
  RawOutputs& operator=(const RawOutputs&) = delete;

  /// Advertises the topics; without this there are none. `camera` is left or right.
  void advertise(ImageAdvertiser& advertiser, const std::string& camera);

  void add_demand(CameraDemand& demand) const;
  /// Publishes the image, without a copy if it has the encoding already. Refuses an image that
  /// cannot be decoded.
  Status publish(const sensor_msgs::ImageConstPtr& message);
  /// Publishes the image of a grey camera.
  void publish(const std_msgs::Header& header, const cv::Mat1b& image);

 private:
  std::string camera_;
  ImageOutput mono_, color_;
  std::atomic_flag is_publishing_ = ATOMIC_FLAG_INIT;
};

}  // namespace fpga_stereo
