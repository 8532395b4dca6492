// The nodelet: wires source, outputs, settings and health together.
#include <diagnostic_updater/diagnostic_updater.h>
#include <dynamic_reconfigure/server.h>
#include <nodelet/nodelet.h>

#include <memory>
#include <mutex>
#include <pluginlib/class_list_macros.hpp>
#include <string>
#include <vector>

#include "fpga_stereo/ros/health.hpp"
#include "fpga_stereo/ros/outputs.hpp"
#include "fpga_stereo/ros/settings.hpp"
#include "fpga_stereo/ros/software_source.hpp"

namespace fpga_stereo {

class StereoNodelet : public nodelet::Nodelet {
 public:
  ~StereoNodelet() override;

 private:
  void onInit() override;
  void on_reconfigure(StereoConfig& config, std::uint32_t level);
  void on_subscribers();
  void on_frame(const StereoFrame& frame);
  void on_timer();
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& report);
  /// Why there is no disparity; empty where there is.
  std::string complaint() const;
  std::string state() const;

  Health health_;
  std::mutex mutex_;  // of the settings, and of everything below while it is being built
  Settings settings_;
  StereoConfig config_;
  std::unique_ptr<Outputs> outputs_;
  std::unique_ptr<SoftwareSource> source_;

  boost::recursive_mutex config_mutex_;
  std::unique_ptr<dynamic_reconfigure::Server<StereoConfig>> reconfigure_;
  std::unique_ptr<diagnostic_updater::Updater> updater_;
  ros::Publisher status_;
  ros::WallTimer timer_;
  std::string last_warning_;
  ros::WallTime last_warning_time_;
};

void StereoNodelet::onInit() {
  ros::NodeHandle& nh = getNodeHandle();
  ros::NodeHandle& private_nh = getPrivateNodeHandle();

  std::vector<std::string> refusals = refuse_bad_parameters(private_nh);
  const SyncSettings sync = load_sync_settings(private_nh, refusals);
  for (const std::string& refusal : refusals) NODELET_ERROR_STREAM("parameter " << refusal);
  for (const std::string& name : ignored_parameters(private_nh)) {
    NODELET_WARN_STREAM("parameter " << name << " of stereo_image_proc has no meaning here");
  }

  config_ = StereoConfig::__getDefault__();
  reconfigure_ =
      std::make_unique<dynamic_reconfigure::Server<StereoConfig>>(config_mutex_, private_nh);
  reconfigure_->setCallback(
      [this](StereoConfig& c, std::uint32_t level) { on_reconfigure(c, level); });

  status_ = private_nh.advertise<StereoStatus>("status", 1, true);
  updater_ = std::make_unique<diagnostic_updater::Updater>(nh, private_nh, getName());
  updater_->setHardwareID("none");
  updater_->add("disparity", this, &StereoNodelet::diagnose);

  // Subscribers may come while the outputs are being advertised; the timer reads what is built
  // here.
  const std::lock_guard<std::mutex> lock(mutex_);
  source_ = std::make_unique<SoftwareSource>(nh, private_nh, sync, health_,
                                             [this](const StereoFrame& f) { on_frame(f); });
  source_->set_settings(settings_);
  outputs_ = std::make_unique<Outputs>(nh, [this] { on_subscribers(); });
  timer_ = nh.createWallTimer(ros::WallDuration(1.0), [this](const auto&) { on_timer(); });
}

StereoNodelet::~StereoNodelet() {
  timer_.stop();
  reconfigure_.reset();
  updater_.reset();
  // The source first: its thread uses the outputs. Outside the lock: it waits for callbacks under
  // way, and one of a subscriber may wait for the lock.
  std::unique_ptr<SoftwareSource> source;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    source = std::move(source_);  // from here on subscribers change nothing
  }
  source.reset();
  outputs_.reset();
}

void StereoNodelet::on_reconfigure(StereoConfig& config, std::uint32_t /*level*/) {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::vector<std::string> refusals;
  settings_ = to_settings(config, config_, refusals);
  config_ = config;
  for (const std::string& refusal : refusals) NODELET_ERROR_STREAM("parameter " << refusal);
  if (source_) source_->set_settings(settings_);
  if (source_ && outputs_) source_->set_demand(outputs_->demand(settings_));
}

void StereoNodelet::on_subscribers() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!source_ || !outputs_) return;
  const Demand demand = outputs_->demand(settings_);
  source_->set_demand(demand);
  source_->listen(demand.any());
  health_.listening(demand.any());
}

void StereoNodelet::on_frame(const StereoFrame& frame) {
  const ros::WallTime start = ros::WallTime::now();
  outputs_->publish(frame);
  const double publish_ms = (ros::WallTime::now() - start).toSec() * 1e3;
  const double latency_ms = (ros::Time::now() - frame.left.header.stamp).toSec() * 1e3;
  health_.published(frame.ms, publish_ms, latency_ms);
}

std::string StereoNodelet::complaint() const {
  const std::string topics = source_ ? source_->complaint() : "";
  return topics.empty() ? health_.refusal() : topics;
}

std::string StereoNodelet::state() const {
  if (!health_.anyone_listens()) return "idle: nobody listens";
  const std::string why = complaint();
  return why.empty() ? "streaming" : why;
}

void StereoNodelet::on_timer() {
  // A subscriber that vanishes while the outputs are built is seen here at the latest.
  on_subscribers();
  StereoStatus status = health_.report(true);
  status.header.stamp = ros::Time::now();
  status.source = SoftwareSource::kName;
  status.state = state();
  status_.publish(status);
  // Forced: update() keeps to ROS time, which stands still while a bag is paused.
  updater_->force_update();

  const std::string why = health_.anyone_listens() && source_ ? source_->complaint() : "";
  const ros::WallTime now = ros::WallTime::now();
  const bool again = why != last_warning_ && (why.empty() || last_warning_.empty());
  if (!why.empty() && (again || now - last_warning_time_ > ros::WallDuration(60.0))) {
    NODELET_WARN_STREAM("no disparity: " << why);
    last_warning_time_ = now;
  }
  last_warning_ = why;
}

void StereoNodelet::diagnose(diagnostic_updater::DiagnosticStatusWrapper& report) {
  using Level = diagnostic_msgs::DiagnosticStatus;
  const std::string why = complaint();
  const bool refused = !health_.refusal().empty();
  const auto level = !health_.anyone_listens() || why.empty() ? Level::OK
                     : refused                                ? Level::ERROR
                                                              : Level::WARN;
  report.summary(level, state());
  const StereoStatus s = health_.report(false);
  report.add("source", SoftwareSource::kName);
  report.add("rate (Hz)", s.rate);
  report.add("latency (ms)", s.latency_ms);
  report.add("frames in", s.frames_in);
  report.add("frames published", s.frames_published);
  for (const DropCauseInfo& cause : kDropCauses) {
    report.add(std::string("dropped: ") + cause.words, s.*cause.field);
  }
}

}  // namespace fpga_stereo

PLUGINLIB_EXPORT_CLASS(fpga_stereo::StereoNodelet, nodelet::Nodelet)
