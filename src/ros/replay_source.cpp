#include "ros/replay_source.hpp"

#include <fmt/format.h>
#include <ros/console.h>

#include <utility>

namespace fpga_stereo {
namespace {

using link::BoardAbility;
using link::LinkState;
using link::Stream;

constexpr std::chrono::milliseconds kTimeout{50};

bool has_raw_pair(const link::FrameSet& set) {
  return !set.image(Stream::kRawLeft).empty() && !set.image(Stream::kRawRight).empty();
}

/// Returns the size of the images of a set.
cv::Size size_of(const link::FrameSet& set) {
  for (const cv::Mat& image : set.images) {
    if (!image.empty()) return image.size();
  }
  return {};
}

/// Returns true if the set has what the demand needs of a board.
bool has_demanded(const link::FrameSet& set, const Demand& demand) {
  const auto lacks = [&](bool wanted, Stream stream) {
    return wanted && set.image(stream).empty();
  };
  return !lacks(demand.disparity, Stream::kDisparity) &&
         (!lacks(demand.left.any_rectified(), Stream::kRectifiedLeft) ||
          !set.image(Stream::kRawLeft).empty()) &&
         (!lacks(demand.right.any_rectified(), Stream::kRectifiedRight) ||
          !set.image(Stream::kRawRight).empty());
}

}  // namespace

ReplaySource::ReplaySource(const BoardSettings& settings, CameraTopics& cameras, Health& health,
                           StampGate& gate, Callbacks callbacks)
    : settings_(settings),
      cameras_(cameras),
      health_(health),
      gate_(gate),
      callbacks_(std::move(callbacks)),
      verifier_(static_cast<std::uint64_t>(settings.verify)) {
  auto opened = link::RecordingPlayer::open(settings_.device);
  report_.is_recording = true;
  report_.is_required = settings_.backend == Backend::kBoard;
  if (!opened) {
    report_.device.trouble = link::LinkTrouble::kNoDevice;
    report_.device.trouble_text = opened.error().message;
    ROS_ERROR_STREAM_NAMED("stereo", opened.error().message);
    return;
  }
  report_.device.state = LinkState::kReady;
  report_.device.trouble = link::LinkTrouble::kNone;
  report_.device.description = (*opened)->description();
  report_.device.times_opened = 1;
  report_.ability = BoardAbility::kNeedsCalibration;
  report_.limitation = "no frame has been played yet";
  cameras_.set_advertised(true);
  thread_ = std::thread([this] { play(); });
}

ReplaySource::~ReplaySource() {
  {
    const MutexLock lock(mutex_);
    is_stopping_ = true;
    changed_.notify_all();
  }
  if (thread_.joinable()) thread_.join();
}

bool ReplaySource::is_present() const {
  const MutexLock lock(mutex_);
  return report_.ability != BoardAbility::kNoBoard;
}

bool ReplaySource::makes_disparity() const {
  const MutexLock lock(mutex_);
  return report_.ability == BoardAbility::kMakesDisparity;
}

Parameters ReplaySource::parameters() const {
  const MutexLock lock(mutex_);
  return node_settings_.pipeline;
}

void ReplaySource::set_demand(const Demand& demand) {
  const bool is_wanted = demand.any() || cameras_.demand().any();
  const MutexLock lock(mutex_);
  demand_ = demand;
  is_wanted_ = is_wanted_ || is_wanted;
  changed_.notify_all();
}

void ReplaySource::set_settings(const Settings& settings) {
  const MutexLock lock(mutex_);
  node_settings_ = settings;
}

Status ReplaySource::reset() {
  return Error{ErrorKind::kInvalid, "no board is connected: device is a recording"};
}

std::optional<StateReport> ReplaySource::trouble() const {
  const MutexLock lock(mutex_);
  if (report_.ability == BoardAbility::kNoBoard) {
    return StateReport{NodeState::kNoBoard, report_.device.trouble_text};
  }
  if (!has_ended_) return std::nullopt;
  return StateReport{NodeState::kRecordingEnded, report_.device.trouble_text};
}

BoardReport ReplaySource::report() const {
  const MutexLock lock(mutex_);
  BoardReport report = report_;
  report.verified = verifier_.counters();
  return report;
}

bool ReplaySource::wait_for_demand() {
  const MutexLock lock(mutex_);
  while (!is_wanted_ && !is_stopping_) changed_.wait(mutex_);
  return !is_stopping_;
}

bool ReplaySource::is_stopping() const {
  const MutexLock lock(mutex_);
  return is_stopping_;
}

void ReplaySource::play() {
  if (!wait_for_demand()) return;
  // Opened again, because its time begins to run.
  auto opened = link::RecordingPlayer::open(settings_.device);
  if (!opened) return note_end(opened.error());
  player_ = std::move(*opened);
  while (!is_stopping()) {
    const auto played = player_->take(kTimeout);
    note_progress();
    if (!played) return note_end(played.error());
    for (const auto& frames : *played) take(frames);
  }
}

void ReplaySource::note_progress() {
  const MutexLock lock(mutex_);
  link::Device::Snapshot& device = report_.device;
  device.state = LinkState::kStreaming;
  device.identity = player_->identity();
  device.decoder = player_->decoder_counters();
  device.frames = player_->frame_counters();
  device.transport = player_->transport_counters();
}

void ReplaySource::note_end(const Error& why) {
  ROS_INFO_STREAM_NAMED("stereo", why.message);
  {
    const MutexLock lock(mutex_);
    has_ended_ = true;
    report_.device.state = LinkState::kReady;
    report_.device.trouble_text = why.message;
  }
  callbacks_.changed();
}

void ReplaySource::note_ability(BoardAbility ability, const std::string& limitation) {
  {
    const MutexLock lock(mutex_);
    if (report_.ability == ability && report_.limitation == limitation) return;
    report_.ability = ability;
    report_.limitation = limitation;
  }
  if (!limitation.empty()) {
    ROS_WARN_STREAM_NAMED("stereo", "the recorded disparity is not used: " << limitation);
  }
  callbacks_.changed();
}

Result<std::shared_ptr<const ReplaySource::Planned>> ReplaySource::plan(const Recorded& recorded,
                                                                        int min_disparity) const {
  if (!recorded) {
    return Error{ErrorKind::kInvalid,
                 "the recording does not contain the configuration that made it; 'board record' "
                 "with --left-info and --right-info records it, too"};
  }
  const auto& identity = player_->identity();
  if (const Status status = identity->check(); !status) return status.error();
  auto planned = std::make_shared<Planned>();
  planned->parameters = recorded->parameters();
  planned->parameters.min_disparity = min_disparity;
  planned->calibration = calibration_;
  auto rectification = make_stereo_rectification(calibration_.left, calibration_.right,
                                                 planned->parameters.min_disparity);
  if (!rectification) return rectification.error();
  const auto made =
      make_gateware_configuration(identity->build, planned->parameters, *rectification);
  if (!made) return made.error();
  if (!recorded->equals(*made)) {
    return Error{ErrorKind::kCalibration,
                 "left_info_url, right_info_url and min_disparity are not those that it was made "
                 "with"};
  }
  planned->image_size = rectification->geometry.image_size;
  planned->rectification = std::make_shared<const StereoRectification>(std::move(*rectification));
  return std::shared_ptr<const Planned>(std::move(planned));
}

void ReplaySource::take(const link::RecordingPlayer::Frames& frames) {
  const link::FrameSet& set = frames.set;
  Settings settings;
  Demand demand;
  {
    const MutexLock lock(mutex_);
    settings = node_settings_;
    demand = demand_;
  }
  health_.received();
  if (!set.dropped.empty()) return health_.refused(DropCause::kLink, set.dropped.front());
  const StereoCalibration calibration = cameras_.calibration();
  const int min_disparity = settings.pipeline.min_disparity;
  if (frames.configuration != recorded_ || !(calibration == calibration_) ||
      min_disparity != min_disparity_ || !has_planned_) {
    has_planned_ = true;
    recorded_ = frames.configuration;
    calibration_ = calibration;
    min_disparity_ = min_disparity;
    planned_ = plan(recorded_, min_disparity_);
  }
  const auto played = clock_.stamp(set.timestamp, player_->speed(), ros::Time::now());
  if (!played) {
    return health_.refused(DropCause::kStamp, "recorded frame dropped: " + played.error().message);
  }
  const ros::Time& stamp = *played;
  if (const auto rewind = rewinds_.note(stamp, std::nullopt)) gate_.restart(*rewind);
  const Result<std::uint64_t> number = gate_.accept(stamp);
  if (!number) {
    return health_.refused(DropCause::kStamp, "recorded frame dropped: " + number.error().message);
  }
  // Without a plan, the images are only what the cameras saw.
  Planned raw;
  raw.calibration = calibration;
  raw.image_size = size_of(set);
  if (calibration.left.K[0] == 0) {
    raw.calibration.left.width = raw.calibration.right.width = raw.image_size.width;
    raw.calibration.left.height = raw.calibration.right.height = raw.image_size.height;
  }
  const Planned& planned = planned_ ? **planned_ : raw;
  if (const Status sizes = check_sizes(set, planned.image_size); !sizes) {
    return health_.refused(DropCause::kLink, sizes.error().message);
  }
  const SourcePair pair = camera_pair(set, planned, stamp, settings_.frame_id, *number);
  cameras_.publish(pair.raw);
  callbacks_.images(pair);
  const bool is_recorded = planned_ && has_demanded(set, demand);
  if (demand.needs_pairs()) {
    note_ability(is_recorded ? BoardAbility::kMakesDisparity : BoardAbility::kSendsRawImages,
                 is_recorded ? ""
                 : planned_  ? "it was not recorded"
                             : planned_.error().message);
  }
  if (is_recorded || !demand.needs_pairs()) {
    const link::ReceivedFrames received{set, 0, stamp.toSec(), 0};
    if (planned.rectification && has_raw_pair(set) && !set.image(Stream::kDisparity).empty()) {
      verifier_.offer(set.frame_id, {pair, set.image(Stream::kDisparity), planned.rectification,
                                     planned.parameters});
    }
    return callbacks_.frame(frame_of_camera_pair(received, planned, pair, settings, demand));
  }
  if (has_raw_pair(set)) return callbacks_.pair(pair);
  health_.refused(
      DropCause::kLink,
      {NodeState::kBoardUnsuitable,
       fmt::format("recorded frame dropped: {}, and the raw images that the software "
                   "needs are not recorded",
                   planned_ ? "a stream in demand was not recorded" : planned_.error().message)});
}

}  // namespace fpga_stereo
