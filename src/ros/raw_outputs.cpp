#include "ros/raw_outputs.hpp"

#include "ros/conversions.hpp"

namespace fpga_stereo {
namespace {

/// Holds a flag, if nobody else does.
class TryFlag {
 public:
  explicit TryFlag(std::atomic_flag& flag) : flag_(flag) {
    is_held_ = !flag_.test_and_set(std::memory_order_acquire);
  }
  ~TryFlag() {
    if (is_held_) flag_.clear(std::memory_order_release);
  }
  TryFlag(const TryFlag&) = delete;
  TryFlag& operator=(const TryFlag&) = delete;

  bool is_held() const { return is_held_; }

 private:
  std::atomic_flag& flag_;
  bool is_held_ = false;
};

}  // namespace

void RawOutputs::advertise(ImageAdvertiser& advertiser, const std::string& camera) {
  camera_ = camera;
  mono_ = ImageOutput(advertiser.advertise(camera + "/image_mono", ImageKind::kEightBit));
  color_ = ImageOutput(advertiser.advertise(camera + "/image_color", ImageKind::kEightBit));
}

void RawOutputs::add_demand(CameraDemand& demand) const {
  demand.mono = mono_.has_subscribers();
  demand.color = color_.has_subscribers();
}

Status RawOutputs::publish(const sensor_msgs::ImageConstPtr& message) {
  const TryFlag flag(is_publishing_);
  if (!flag.is_held()) return {};
  if (mono_.has_subscribers()) {
    const Result<cv::Mat> grey = to_grey(message, camera_);
    if (!grey) return grey.error();
    mono_.publish(message->header, *grey, message);
  }
  if (color_.has_subscribers()) {
    const Result<cv::Mat> color = to_bgr(message, camera_);
    if (!color) return color.error();
    color_.publish(message->header, *color, message);
  }
  return {};
}

void RawOutputs::publish(const std_msgs::Header& header, const cv::Mat1b& image) {
  const TryFlag flag(is_publishing_);
  if (!flag.is_held() || image.empty()) return;
  if (mono_.has_subscribers()) mono_.publish(header, image);
  if (color_.has_subscribers()) color_.publish(header, image);
}

}  // namespace fpga_stereo
