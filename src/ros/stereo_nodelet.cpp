// The nodelet: wires sources, outputs, settings and health together.
#include <diagnostic_updater/diagnostic_updater.h>
#include <dynamic_reconfigure/server.h>
#include <nodelet/nodelet.h>
#include <std_srvs/Trigger.h>

#include <array>
#include <memory>
#include <mutex>
#include <pluginlib/class_list_macros.hpp>
#include <string>
#include <utility>
#include <vector>

#include "fpga_stereo/core/target.hpp"
#include "ros/board_report.hpp"
#include "ros/board_source.hpp"
#include "ros/health.hpp"
#include "ros/outputs.hpp"
#include "ros/settings.hpp"
#include "ros/software_source.hpp"
#include "ros/stamp_gate.hpp"

namespace fpga_stereo {

class StereoNodelet : public nodelet::Nodelet {
 public:
  ~StereoNodelet() override;

 private:
  void onInit() override;
  void make_sources(const SyncSettings& sync);
  void on_reconfigure(StereoConfig& config, std::uint32_t level);
  void on_subscribers();
  void on_pair(const InputPair& pair);
  void on_frame(const StereoFrame& frame, const char* source);
  void on_timer();
  bool on_reset(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response);
  bool on_device_info(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response);
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& report);
  void diagnose_board(diagnostic_updater::DiagnosticStatusWrapper& report);
  /// Who is to make the disparity now.
  const char* source() const;
  void announce_source();
  /// Images come from topics: not where the cameras of a board deliver them.
  bool wants_topics() const;
  /// Why there is no disparity; empty where there is.
  std::string complaint() const;
  std::string state() const;

  Health health_;
  mutable std::mutex mutex_;  // of the settings, and of everything below while it is being built
  Settings settings_;
  BoardSettings board_settings_;
  StereoConfig config_;
  std::unique_ptr<Outputs> outputs_;
  std::unique_ptr<SoftwareSource> software_;
  std::unique_ptr<CameraTopics> cameras_;
  std::unique_ptr<BoardSource> board_;  // none: software only
  std::unique_ptr<TopicInput> topics_;

  std::mutex publish_mutex_;  // frames come from more than one thread
  StampGate gate_;
  std::array<std::string, 3> announced_;  // source, why the board does not, why it is refused

  boost::recursive_mutex config_mutex_;
  std::unique_ptr<dynamic_reconfigure::Server<StereoConfig>> reconfigure_;
  std::unique_ptr<diagnostic_updater::Updater> updater_;
  ros::Publisher status_;
  ros::ServiceServer reset_, device_info_;
  ros::WallTimer timer_;
  std::string last_warning_;
  ros::WallTime last_warning_time_;
};

void StereoNodelet::onInit() {
  ros::NodeHandle& nh = getNodeHandle();
  ros::NodeHandle& private_nh = getPrivateNodeHandle();

  std::vector<std::string> refusals = refuse_bad_parameters(private_nh);
  const SyncSettings sync = load_sync_settings(private_nh, refusals);
  board_settings_ = load_board_settings(private_nh, refusals);
  for (const std::string& refusal : refusals) NODELET_ERROR_STREAM("parameter " << refusal);
  if (const Status known = check_target_variable(); !known) {
    NODELET_ERROR_STREAM(known.error().message << "; using " << target());
  }
  NODELET_INFO_STREAM("the software pipeline computes with " << target());
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
  if (board_settings_.backend != Backend::kSoftware) {
    updater_->add("board", this, &StereoNodelet::diagnose_board);
  }

  // Subscribers may come while the outputs are being advertised; the timer reads what is built
  // here.
  const std::lock_guard<std::mutex> lock(mutex_);
  make_sources(sync);
  outputs_ = std::make_unique<Outputs>(nh, [this] { on_subscribers(); });
  reset_ = private_nh.advertiseService("reset", &StereoNodelet::on_reset, this);
  device_info_ = private_nh.advertiseService("device_info", &StereoNodelet::on_device_info, this);
  timer_ = nh.createWallTimer(ros::WallDuration(1.0), [this](const auto&) { on_timer(); });
}

void StereoNodelet::make_sources(const SyncSettings& sync) {
  ros::NodeHandle& nh = getNodeHandle();
  software_ = std::make_unique<SoftwareSource>(
      health_, [this](const StereoFrame& f) { on_frame(f, SoftwareSource::kName); });
  software_->set_settings(settings_);
  topics_ = std::make_unique<TopicInput>(nh, getPrivateNodeHandle(), sync, health_,
                                         [this](const InputPair& pair) { on_pair(pair); });
  if (board_settings_.backend == Backend::kSoftware) return;
  cameras_ = std::make_unique<CameraTopics>(nh, board_settings_, [this] { on_subscribers(); });
  BoardSource::Callbacks callbacks;
  callbacks.frame = [this](const StereoFrame& f) { on_frame(f, BoardSource::kName); };
  callbacks.pair = [this](const InputPair& pair) { software_->receive(pair); };
  callbacks.changed = [this] { on_subscribers(); };
  board_ = std::make_unique<BoardSource>(board_settings_, *cameras_, health_, callbacks);
  board_->set_settings(settings_);
}

StereoNodelet::~StereoNodelet() {
  timer_.stop();
  reconfigure_.reset();
  updater_.reset();
  reset_.shutdown();
  device_info_.shutdown();
  // The sources first: their threads use the outputs. Outside the lock: they wait for callbacks
  // under way, and one of a subscriber may wait for the lock. Topics feed sources, the board feeds
  // the software.
  std::unique_ptr<TopicInput> topics;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    topics = std::move(topics_);  // from here on subscribers change nothing
  }
  if (topics) topics->stop();
  topics.reset();
  board_.reset();
  software_.reset();
  cameras_.reset();
  outputs_.reset();
}

void StereoNodelet::on_reconfigure(StereoConfig& config, std::uint32_t /*level*/) {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::vector<std::string> refusals;
  settings_ = to_settings(config, config_, refusals);
  config_ = config;
  for (const std::string& refusal : refusals) NODELET_ERROR_STREAM("parameter " << refusal);
  if (!topics_) return;
  software_->set_settings(settings_);
  if (board_) board_->set_settings(settings_);
  if (!outputs_) return;
  const Demand demand = outputs_->demand(settings_);
  software_->set_demand(demand);
  if (board_) board_->set_demand(demand);
}

bool StereoNodelet::wants_topics() const {
  if (!board_ || board_settings_.topic_input) return true;
  return board_settings_.backend == Backend::kAuto && !board_->present();
}

void StereoNodelet::on_subscribers() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!topics_ || !outputs_) return;
  const Demand demand = outputs_->demand(settings_);
  software_->set_demand(demand);
  if (board_) board_->set_demand(demand);
  if (demand.any() && wants_topics()) {
    topics_->start();
  } else {
    topics_->stop();
  }
  if (!demand.any()) software_->forget();
  health_.listening(demand.any() || (cameras_ && cameras_->demand().any()));
}

void StereoNodelet::on_pair(const InputPair& pair) {
  if (board_ && board_->takes_pairs() && board_->send(pair)) return;
  if (board_settings_.backend == Backend::kBoard) {
    std::string why = board_->complaint();
    if (why.empty()) why = board_->unable();
    if (why.empty()) why = "the board is being configured, or has not taken the pair before";
    health_.refused(DropCause::kLink, "pair dropped: " + why);
    return;
  }
  software_->receive(pair);
}

void StereoNodelet::on_frame(const StereoFrame& frame, const char* source) {
  const std::lock_guard<std::mutex> lock(publish_mutex_);
  const ros::Time& stamp = frame.left.header.stamp;
  // Here, behind both sources: the last frame of one may be slower than the first of the other.
  if (const auto why = gate_.check(stamp)) {
    const std::string refusal = "frame refused: " + *why;
    if (health_.refusal() != refusal) NODELET_WARN_STREAM(source << ": " << refusal);
    return health_.refused(DropCause::kStamp, refusal);
  }
  const ros::WallTime start = ros::WallTime::now();
  outputs_->publish(frame);
  const double publish_ms = (ros::WallTime::now() - start).toSec() * 1e3;
  const double latency_ms = (ros::Time::now() - stamp).toSec() * 1e3;
  health_.published(frame.ms, publish_ms, latency_ms);
  if (frame.arrived > 0) {
    health_.link_latency((ros::WallTime::now().toSec() - frame.arrived) * 1e3);
  }
}

const char* StereoNodelet::source() const {
  if (!board_) return SoftwareSource::kName;
  if (board_settings_.backend == Backend::kBoard && board_settings_.topic_input) {
    return BoardSource::kName;
  }
  if (board_settings_.backend == Backend::kBoard && !board_->present()) return BoardSource::kName;
  return board_->present() && board_->unable().empty() ? BoardSource::kName : SoftwareSource::kName;
}

std::string StereoNodelet::complaint() const {
  if (board_ && !wants_topics()) {
    const std::string board = board_->complaint();
    return board.empty() ? health_.refusal() : board;
  }
  const std::string topics = topics_ ? topics_->complaint() : "";
  return topics.empty() ? health_.refusal() : topics;
}

std::string StereoNodelet::state() const {
  if (!health_.anyone_listens()) return "idle: nobody listens";
  const std::string why = complaint();
  return why.empty() ? "streaming" : why;
}

void StereoNodelet::on_timer() {
  if (board_) board_->refresh();
  // A subscriber that vanishes while the outputs are built is seen here at the latest.
  on_subscribers();
  StereoStatus status = health_.report(true);
  status.header.stamp = ros::Time::now();
  status.source = source();
  status.state = state();
  if (board_) fill(board_->snapshot(), board_->verified(), status);
  status_.publish(status);
  // Forced: update() keeps to ROS time, which stands still while a bag is paused.
  updater_->force_update();

  const bool waits = health_.anyone_listens() && topics_;
  const std::string why = !waits ? "" : wants_topics() ? topics_->complaint() : board_->complaint();
  const ros::WallTime now = ros::WallTime::now();
  const bool again = why != last_warning_ && (why.empty() || last_warning_.empty());
  if (!why.empty() && (again || now - last_warning_time_ > ros::WallDuration(60.0))) {
    NODELET_WARN_STREAM("no disparity: " << why);
    last_warning_time_ = now;
  }
  last_warning_ = why;
  announce_source();
}

void StereoNodelet::announce_source() {
  if (!board_) return;
  const link::Device::Snapshot board = board_->snapshot();
  const bool refused = board.state == link::LinkState::kRefused;
  const std::string now = source(), unable = board_->unable();
  const std::array<std::string, 3> all{now, unable, refused ? board.trouble_text : ""};
  if (std::exchange(announced_, all) == all) return;
  if (refused) NODELET_ERROR_STREAM("board: " << board.trouble_text);
  const std::string why = board_->present() ? unable : board_->complaint();
  if (now == BoardSource::kName && board_->present()) {
    NODELET_INFO_STREAM("the disparity comes from the board: " << board.description);
  } else if (now == SoftwareSource::kName) {
    NODELET_INFO_STREAM("the disparity comes from the software pipeline"
                        << (why.empty() ? "" : ": ") << why);
  }
}

bool StereoNodelet::on_reset(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
  response.success = board_ != nullptr;
  response.message = board_ ? "the board's line is being reset" : "backend is software";
  if (board_) board_->reset();
  return true;
}

bool StereoNodelet::on_device_info(std_srvs::Trigger::Request&,
                                   std_srvs::Trigger::Response& response) {
  response.success = board_ && board_->present();
  response.message = board_ ? device_info(board_->snapshot()) : "backend is software";
  return true;
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
  report.add("source", source());
  report.add("rate (Hz)", s.rate);
  report.add("latency (ms)", s.latency_ms);
  report.add("frames in", s.frames_in);
  report.add("frames published", s.frames_published);
  for (const DropCauseInfo& cause : kDropCauses) {
    report.add(std::string("dropped: ") + cause.words, s.*cause.field);
  }
}

void StereoNodelet::diagnose_board(diagnostic_updater::DiagnosticStatusWrapper& report) {
  if (!board_) return;
  report_board(board_->snapshot(), board_->verified(), board_->unable(), board_->expected(),
               report);
}

}  // namespace fpga_stereo

PLUGINLIB_EXPORT_CLASS(fpga_stereo::StereoNodelet, nodelet::Nodelet)
