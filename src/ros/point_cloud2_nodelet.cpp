// fpga_stereo/point_cloud2: disparity and colour image to a point cloud.
#include <fmt/format.h>
#include <nodelet/nodelet.h>

#include <memory>
#include <pluginlib/class_list_macros.hpp>
#include <string>
#include <vector>

#include "core/thread_safety.hpp"
#include "ros/cloud_input.hpp"
#include "ros/cloud_output.hpp"
#include "ros/conversions.hpp"
#include "ros/health.hpp"
#include "ros/settings.hpp"
#include "ros/stamp_gate.hpp"
#include "ros/status_reporter.hpp"

namespace fpga_stereo {
namespace {

/// Refuses an image that has not the size of the left camera_info.
Status check_cloud_size(const cv::Mat& image, const std::string& name, cv::Size expected) {
  if (image.size() == expected) return {};
  return Error{ErrorKind::kImageSize,
               fmt::format("{} image is {}x{}: camera_info says {}x{}", name, image.cols,
                           image.rows, expected.width, expected.height)};
}

}  // namespace

class PointCloud2Nodelet : public nodelet::Nodelet, public StatusSource {
 public:
  ~PointCloud2Nodelet() override;

 private:
  void onInit() override FPGA_STEREO_EXCLUDES(mutex_);
  void on_demand_change() FPGA_STEREO_EXCLUDES(mutex_);
  void on_messages(const CloudMessages& messages);
  Status publish(const CloudMessages& messages);

  const char* product() const override { return "cloud"; }
  const Health& health() const override { return health_; }
  std::optional<StateReport> input_trouble() const override FPGA_STEREO_EXCLUDES(mutex_);

  Health health_;
  StampGate gate_;
  Settings settings_;  // set by onInit() alone
  CloudOutput output_;

  mutable Mutex mutex_;
  std::unique_ptr<CloudInput> input_ FPGA_STEREO_GUARDED_BY(mutex_);

  std::unique_ptr<StatusReporter> reporter_;  // used by the timer alone
  ros::WallTimer timer_;
};

void PointCloud2Nodelet::onInit() {
  ros::NodeHandle& nh = getNodeHandle();
  ros::NodeHandle& private_nh = getPrivateNodeHandle();
  ParameterReport report;
  const SyncSettings sync = load_sync_settings(private_nh, report);
  settings_ = load_settings(private_nh, report);
  for (const std::string& error : report.errors) NODELET_ERROR_STREAM("parameter " << error);
  for (const std::string& warning : report.warnings) NODELET_WARN_STREAM("parameter " << warning);
  know_parameters_of_stereo(private_nh, report);
  for (const std::string& message : unknown_parameters(private_nh, report.names)) {
    NODELET_WARN_STREAM(message);
  }

  // A subscriber that comes meanwhile changes nothing yet: there is no input.
  output_ = CloudOutput(nh, [this] { on_demand_change(); });
  {
    const MutexLock lock(mutex_);
    input_ = std::make_unique<CloudInput>(nh, private_nh, sync, health_, gate_,
                                          [this](const CloudMessages& m) { on_messages(m); });
  }
  on_demand_change();
  reporter_ = std::make_unique<StatusReporter>(nh, private_nh, getName(), health_, *this);
  timer_ = nh.createWallTimer(ros::WallDuration(1.0), [this](const auto&) {
    // A subscriber that left while the output was being advertised is noticed here.
    on_demand_change();
    reporter_->report();
  });
}

PointCloud2Nodelet::~PointCloud2Nodelet() {
  timer_.stop();
  reporter_.reset();
  std::unique_ptr<CloudInput> input;
  {
    const MutexLock lock(mutex_);
    input = std::move(input_);
  }
  input.reset();  // without the lock: this waits for a callback
}

std::optional<StateReport> PointCloud2Nodelet::input_trouble() const {
  const MutexLock lock(mutex_);
  return input_ ? input_->trouble() : std::nullopt;
}

void PointCloud2Nodelet::on_demand_change() {
  const MutexLock lock(mutex_);
  if (!input_) return;
  input_->set_subscribed(output_.has_subscribers());
  health_.set_has_subscribers(output_.has_subscribers());
}

void PointCloud2Nodelet::on_messages(const CloudMessages& messages) {
  const ros::Time& stamp = messages.disparity->header.stamp;
  if (const Result<std::uint64_t> number = gate_.accept(stamp); !number) {
    return health_.refused(DropCause::kStamp, "disparity image refused: " + number.error().message);
  }
  const ros::WallTime start = ros::WallTime::now();
  if (const Status published = publish(messages); !published) {
    return health_.refused(cause_of(published.error().kind), published.error().message);
  }
  health_.published({}, (ros::WallTime::now() - start).toSec() * 1e3,
                    (ros::Time::now() - stamp).toSec() * 1e3);
}

Status PointCloud2Nodelet::publish(const CloudMessages& messages) {
  const auto disparities = to_disparities(*messages.disparity);
  if (!disparities) return disparities.error();
  const auto left = to_calibration(*messages.left_info, "left");
  if (!left) return left.error();
  const auto right = to_calibration(*messages.right_info, "right");
  if (!right) return right.error();
  const auto geometry =
      make_stereo_geometry(rectified_calibration(*left), rectified_calibration(*right));
  if (!geometry) return geometry.error();
  if (Status size = check_cloud_size(*disparities, "disparity", geometry->image_size); !size) {
    return size;
  }
  cv::Mat color;
  if (settings_.cloud.color != PointColor::kNone) {
    const auto decoded = to_bgr(messages.color, "left/image_rect_color");
    if (!decoded) return decoded.error();
    color = *decoded;
    if (Status size = check_cloud_size(color, "left/image_rect_color", geometry->image_size);
        !size) {
      return size;
    }
  }
  const std_msgs::Header& header = messages.disparity->header;
  output_.publish(header.stamp, settings_, [&](sensor_msgs::PointCloud2& message) {
    to_point_cloud2(*disparities, messages.disparity->min_disparity,
                    make_reprojection(*geometry, 0), color, settings_.cloud, header, message);
  });
  return {};
}

}  // namespace fpga_stereo

PLUGINLIB_EXPORT_CLASS(fpga_stereo::PointCloud2Nodelet, nodelet::Nodelet)
