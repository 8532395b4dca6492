// The nodelet: reads parameters, connects subscribers, settings and services with the sources.
#include <dynamic_reconfigure/server.h>
#include <nodelet/nodelet.h>
#include <std_srvs/Trigger.h>

#include <memory>
#include <pluginlib/class_list_macros.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/thread_safety.hpp"
#include "fpga_stereo/core/target.hpp"
#include "ros/frame_publisher.hpp"
#include "ros/health.hpp"
#include "ros/outputs.hpp"
#include "ros/settings.hpp"
#include "ros/sources.hpp"
#include "ros/status_reporter.hpp"

namespace fpga_stereo {
namespace {

constexpr const char* kAlgorithm = "stereo_algorithm";

}  // namespace

class StereoNodelet : public nodelet::Nodelet {
 public:
  ~StereoNodelet() override;

 private:
  using Trigger = std_srvs::Trigger;

  void onInit() override FPGA_STEREO_EXCLUDES(mutex_);
  void make_sources(const SyncSettings& sync, const BoardSettings& board)
      FPGA_STEREO_EXCLUDES(mutex_);
  void on_reconfigure(StereoConfig& config) FPGA_STEREO_EXCLUDES(mutex_);
  /// Deletes ~stereo_algorithm, which the reconfigure server has written, unless the user has
  /// chosen an algorithm: a node that starts again must not take it for a choice.
  void forget_default_algorithm() FPGA_STEREO_EXCLUDES(mutex_);
  void on_demand_change() FPGA_STEREO_EXCLUDES(mutex_);
  void on_timer() FPGA_STEREO_EXCLUDES(mutex_);
  bool on_reset(Trigger::Request&, Trigger::Response& response) FPGA_STEREO_EXCLUDES(mutex_);
  bool on_device_info(Trigger::Request&, Trigger::Response& response) FPGA_STEREO_EXCLUDES(mutex_);
  void apply_demand() FPGA_STEREO_REQUIRES(mutex_);
  /// Returns the sources, or null before onInit() has made them. The destructor stops all callers
  /// before it destroys the sources.
  Sources* sources() const FPGA_STEREO_EXCLUDES(mutex_);

  Health health_;
  std::unique_ptr<Outputs> outputs_;
  std::unique_ptr<FramePublisher> publisher_;

  /// Held while settings and demand are passed on, before all locks of the sources.
  mutable Mutex mutex_;
  Settings settings_ FPGA_STEREO_GUARDED_BY(mutex_);
  StereoConfig config_ FPGA_STEREO_GUARDED_BY(mutex_);
  bool is_default_algorithm_written_ FPGA_STEREO_GUARDED_BY(mutex_) = false;
  std::unique_ptr<Sources> sources_ FPGA_STEREO_GUARDED_BY(mutex_);

  std::unique_ptr<StatusReporter> reporter_;  // used by the timer alone
  boost::recursive_mutex config_mutex_;       // of the reconfigure server, before mutex_
  std::unique_ptr<dynamic_reconfigure::Server<StereoConfig>> reconfigure_;
  ros::ServiceServer reset_, device_info_;
  ros::WallTimer timer_;
};

void StereoNodelet::onInit() {
  ros::NodeHandle& private_nh = getPrivateNodeHandle();
  if (const auto translation = translate_algorithm(private_nh)) {
    NODELET_INFO_STREAM("parameter " << *translation);
  }
  std::vector<std::string> refusals = refuse_bad_parameters(private_nh);
  const SyncSettings sync = load_sync_settings(private_nh, refusals);
  const BoardSettings board = load_board_settings(private_nh, refusals);
  for (const std::string& refusal : refusals) NODELET_ERROR_STREAM("parameter " << refusal);
  for (const std::string& message : ignored_parameters(private_nh)) NODELET_WARN_STREAM(message);
  if (const Status known = check_target_variable(); !known) {
    NODELET_ERROR_STREAM(known.error().message << "; using " << target());
  }
  NODELET_INFO_STREAM("the software pipeline uses the instruction set " << target());

  {
    const MutexLock lock(mutex_);
    config_ = StereoConfig::__getDefault__();
    settings_.is_algorithm_chosen = private_nh.hasParam(kAlgorithm);
  }
  reconfigure_ =
      std::make_unique<dynamic_reconfigure::Server<StereoConfig>>(config_mutex_, private_nh);
  reconfigure_->setCallback(
      [this](StereoConfig& config, std::uint32_t) { on_reconfigure(config); });
  forget_default_algorithm();
  make_sources(sync, board);
  reporter_ =
      std::make_unique<StatusReporter>(getNodeHandle(), private_nh, getName(), health_, *sources());
  reset_ = private_nh.advertiseService("reset", &StereoNodelet::on_reset, this);
  device_info_ = private_nh.advertiseService("device_info", &StereoNodelet::on_device_info, this);
  timer_ =
      getNodeHandle().createWallTimer(ros::WallDuration(1.0), [this](const auto&) { on_timer(); });
}

void StereoNodelet::make_sources(const SyncSettings& sync, const BoardSettings& board) {
  // Subscribers that come meanwhile change nothing yet: there are no sources.
  outputs_ = std::make_unique<Outputs>(getNodeHandle(), [this] { on_demand_change(); });
  publisher_ = std::make_unique<FramePublisher>(
      [this](const StereoFrame& frame) { outputs_->publish(frame); }, health_);
  auto sources = std::make_unique<Sources>(getNodeHandle(), getPrivateNodeHandle(), sync, board,
                                           health_, *publisher_, [this] { on_demand_change(); });
  const MutexLock lock(mutex_);
  sources_ = std::move(sources);
  sources_->set_settings(settings_);
  apply_demand();
}

StereoNodelet::~StereoNodelet() {
  timer_.stop();
  reconfigure_.reset();
  reporter_.reset();
  reset_.shutdown();
  device_info_.shutdown();
  std::unique_ptr<Sources> sources;
  {
    const MutexLock lock(mutex_);
    sources = std::move(sources_);
  }
  // Without the lock: this waits for threads and callbacks that may need it.
  sources.reset();
  publisher_.reset();
  outputs_.reset();
}

Sources* StereoNodelet::sources() const {
  const MutexLock lock(mutex_);
  return sources_.get();
}

void StereoNodelet::apply_demand() {
  if (sources_) sources_->set_demand(outputs_->demand(settings_));
}

void StereoNodelet::on_reconfigure(StereoConfig& config) {
  const MutexLock lock(mutex_);
  std::vector<std::string> refusals;
  const bool was_algorithm_chosen = settings_.is_algorithm_chosen;
  settings_ = to_settings(config, config_, refusals);
  settings_.is_algorithm_chosen =
      was_algorithm_chosen || config.stereo_algorithm != config_.stereo_algorithm;
  is_default_algorithm_written_ = !settings_.is_algorithm_chosen;
  config_ = config;
  for (const std::string& refusal : refusals) NODELET_ERROR_STREAM("parameter " << refusal);
  if (!sources_) return;
  sources_->set_settings(settings_);
  apply_demand();  // cloud_fields decides whether the cloud needs colour
}

void StereoNodelet::forget_default_algorithm() {
  // The server holds this lock from the callback until it has written the parameters.
  const boost::recursive_mutex::scoped_lock server_lock(config_mutex_);
  const MutexLock lock(mutex_);
  if (!std::exchange(is_default_algorithm_written_, false)) return;
  getPrivateNodeHandle().deleteParam(kAlgorithm);
}

void StereoNodelet::on_demand_change() {
  const MutexLock lock(mutex_);
  apply_demand();
}

void StereoNodelet::on_timer() {
  Sources* const all = sources();
  if (all == nullptr) return;
  forget_default_algorithm();
  all->refresh();
  // A subscriber that left while the outputs were being advertised is noticed here.
  on_demand_change();
  reporter_->report();
}

bool StereoNodelet::on_reset(Trigger::Request&, Trigger::Response& response) {
  Sources* const all = sources();
  response.success = all != nullptr && all->reset_board();
  response.message = response.success ? "the link to the board is being reset"
                                      : "there is no board: backend is software";
  return true;
}

bool StereoNodelet::on_device_info(Trigger::Request&, Trigger::Response& response) {
  const Sources* const all = sources();
  const auto board = all == nullptr ? std::nullopt : all->board_report();
  response.success = board && board->ability != link::BoardAbility::kNoBoard;
  response.message = board ? device_info(board->device) : "there is no board: backend is software";
  return true;
}

}  // namespace fpga_stereo

PLUGINLIB_EXPORT_CLASS(fpga_stereo::StereoNodelet, nodelet::Nodelet)
