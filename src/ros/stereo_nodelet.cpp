#include "ros/stereo_nodelet.hpp"

#include <pluginlib/class_list_macros.hpp>
#include <string>
#include <utility>
#include <vector>

#include "fpga_stereo/core/target.hpp"

namespace fpga_stereo {
namespace {

constexpr const char* kAlgorithm = "stereo_algorithm";

}  // namespace

void StereoNodelet::onInit() {
  ros::NodeHandle& private_nh = getPrivateNodeHandle();
  if (const auto translation = translate_algorithm(private_nh)) {
    NODELET_INFO_STREAM("parameter " << *translation);
  }
  ParameterReport report;
  check_parameters(private_nh, report);
  const Sources::Options options = load_options(report);
  const OutputTopics topics = load_topics(report);
  for (const std::string& error : report.errors) NODELET_ERROR_STREAM("parameter " << error);
  for (const std::string& warning : report.warnings) NODELET_WARN_STREAM("parameter " << warning);
  for (const std::string& message : ignored_parameters(private_nh)) NODELET_WARN_STREAM(message);
  if (kind_ == PairKind::kRectified) know_parameters_of_stereo(private_nh, report);
  for (const std::string& message : unknown_parameters(private_nh, report.names)) {
    NODELET_WARN_STREAM(message);
  }
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
  make_sources(options, topics);
  reporter_ =
      std::make_unique<StatusReporter>(getNodeHandle(), private_nh, getName(), health_, *sources());
  if (kind_ == PairKind::kRaw) {
    reset_ = private_nh.advertiseService("reset", &StereoNodelet::on_reset, this);
    device_info_ = private_nh.advertiseService("device_info", &StereoNodelet::on_device_info, this);
  }
  timer_ =
      getNodeHandle().createWallTimer(ros::WallDuration(1.0), [this](const auto&) { on_timer(); });
}

Sources::Options StereoNodelet::load_options(ParameterReport& report) const {
  Sources::Options options;
  options.topics = kind_;
  options.sync = load_sync_settings(getPrivateNodeHandle(), report);
  if (kind_ == PairKind::kRaw) {
    options.board = load_board_settings(getPrivateNodeHandle(), report);
  } else {
    options.board.backend = Backend::kSoftware;  // boards rectify by themselves
  }
  return options;
}

OutputTopics StereoNodelet::load_topics(ParameterReport& report) const {
  if (kind_ == PairKind::kRectified) return {false, false};
  return load_output_topics(getPrivateNodeHandle(), report);
}

void StereoNodelet::make_sources(const Sources::Options& options, const OutputTopics& topics) {
  // Subscribers that come meanwhile change nothing yet: there are no sources.
  outputs_ = std::make_unique<Outputs>(getNodeHandle(), topics, [this] { on_demand_change(); });
  publisher_ = std::make_unique<FramePublisher>(
      [this](const StereoFrame& frame) { outputs_->publish(frame); }, health_);
  auto sources =
      std::make_unique<Sources>(getNodeHandle(), getPrivateNodeHandle(), options, health_,
                                *outputs_, *publisher_, [this] { on_demand_change(); });
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
  const Status reset = all != nullptr ? all->reset_board()
                                      : Error{ErrorKind::kNotFound, "the node is being shut down"};
  response.success = static_cast<bool>(reset);
  response.message = reset ? "the link to the board is being reset" : reset.error().message;
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
PLUGINLIB_EXPORT_CLASS(fpga_stereo::DisparityNodelet, nodelet::Nodelet)
