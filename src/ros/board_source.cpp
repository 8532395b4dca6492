#include "ros/board_source.hpp"

#include <ros/console.h>

#include <algorithm>
#include <utility>

#include "fpga_stereo/link/transport.hpp"
#include "ros/make_frame.hpp"

namespace fpga_stereo {
namespace {

using link::Stream;

constexpr std::size_t kMostSent = 4;               // pairs under way in the board
constexpr std::chrono::seconds kLeastPatience{2};  // with pairs that do not come back

}  // namespace

BoardSource::BoardSource(const BoardSettings& settings, CameraTopics& cameras, Health& health,
                         Callbacks callbacks)
    : settings_(settings),
      cameras_(cameras),
      health_(health),
      callbacks_(std::move(callbacks)),
      plan_(settings_),
      device_(device_options(), device_callbacks()) {}

link::Device::Options BoardSource::device_options() {
  link::Device::Options options;
  options.open = [this] {
    auto opened = link::open_transport(settings_.device);
    none_found_ = !opened && opened.error().kind == ErrorKind::kNotFound;
    return opened;
  };
  options.hotplug = link::watch_for(settings_.device);
  options.session.keep_incomplete = settings_.keep_incomplete;
  return options;
}

link::Device::Callbacks BoardSource::device_callbacks() {
  link::Device::Callbacks callbacks;
  callbacks.received = [this](const std::vector<link::ReceivedFrames>& sets) {
    for (const link::ReceivedFrames& r : sets) received(r);
  };
  callbacks.identified = [this](const link::Identity& identity) { identified(identity); };
  callbacks.closed = [this] { closed(); };
  callbacks.note = [](const std::string& note) {
    ROS_INFO_STREAM_NAMED("stereo", "board: " << note);
  };
  return callbacks;
}

// What is wanted.

void BoardSource::tell() {
  if (!plan_.present()) return;
  // The board's numbers go on while nothing is sent.
  if (plan_.wanted().streams.empty()) last_frame_.reset();
  device_.set_desired_state(plan_.wanted());
}

void BoardSource::identified(const link::Identity& identity) {
  ROS_INFO_STREAM_NAMED("stereo", "board identified: " << identity.text());
  if (!settings_.topic_input) cameras_.show(true);
  SentPairs sent;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    last_frame_.reset();
    sent = std::exchange(sent_, {});
    if (!settings_.topic_input) plan_.set_calibration(cameras_.infos());
    plan_.set_identity(identity);
    tell();
  }
  hand_on(sent);
  callbacks_.changed();
}

void BoardSource::closed() {
  SentPairs sent;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!plan_.present()) return;
    plan_.set_identity(std::nullopt);
    sent = std::exchange(sent_, {});
  }
  hand_on(sent);
  cameras_.show(false);
  callbacks_.changed();
}

void BoardSource::hand_on(const SentPairs& sent) {
  if (settings_.backend == Backend::kBoard) return health_.dropped(DropCause::kLink, sent.size());
  for (const auto& [id, of_topics] : sent) callbacks_.pair(of_topics.pair);
}

void BoardSource::refresh() {
  if (device_.snapshot().state == link::LinkState::kRefused) return closed();
  if (settings_.topic_input || !present()) return;
  const CameraTopics::Infos infos = cameras_.infos();
  const std::lock_guard<std::mutex> lock(mutex_);
  const Result<bool> changed = plan_.offer_calibration(infos);
  if (!changed) {
    ROS_INFO_STREAM_THROTTLE_NAMED(10, "stereo",
                                   "new calibration waits: " << changed.error().message);
  } else if (*changed) {
    tell();
  }
}

void BoardSource::set_settings(const Settings& settings) {
  const std::lock_guard<std::mutex> lock(mutex_);
  plan_.set_settings(settings);
  tell();
}

void BoardSource::set_demand(const Demand& demand) {
  const CameraTopics::Demand cameras = cameras_.demand();
  const std::lock_guard<std::mutex> lock(mutex_);
  plan_.set_demand(demand, cameras);
  tell();
}

// Pairs from topics.

bool BoardSource::takes_pairs() const {
  if (!settings_.topic_input) return false;
  const std::lock_guard<std::mutex> lock(mutex_);
  return plan_.present();
}

void BoardSource::give_up_lost() {
  // A pair that comes back tells that those before it will not: this is for when all are lost.
  const auto now = Clock::now();
  const auto patience = kLeastPatience + static_cast<int>(kMostSent) * turnaround_;
  if (sent_.empty() || now - std::max(last_back_, sent_.begin()->second.when) < patience) return;
  health_.dropped(DropCause::kLink, sent_.size());
  sent_.clear();
}

bool BoardSource::send(const InputPair& pair) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!plan_.present()) return false;
  give_up_lost();
  const CameraTopics::Infos infos{*pair.left_info, *pair.right_info};
  if (!same_calibration(infos, plan_.calibration())) {
    plan_.set_calibration(infos);
    tell();
  }
  const std::uint64_t tag = plan_.wanted().tag;
  const auto made = plan_.made(tag);
  const link::Device::Snapshot now = device_.snapshot();
  const bool able = plan_.unable().empty() && made && made->rectification &&
                    now.state == link::LinkState::kStreaming && now.active_tag == tag;
  if (!able && sent_.empty()) return false;
  if (able) {
    const auto begun = begin_frame(pair, *made->rectification, made->settings);
    if (!begun) return false;  // the software says why
    const std::uint64_t stamp_us = pair.left->header.stamp.toNSec() / 1000;
    if (sent_.size() < kMostSent &&
        device_.send_pair(begun->left.mono, begun->right.mono, next_pair_, stamp_us)) {
      sent_[next_pair_++] = {pair, Clock::now()};
      return true;
    }
  }
  // The software would overtake those that are under way: frames would come out of order.
  health_.dropped(DropCause::kReplaced);
  return true;
}

// What comes.

bool BoardSource::present() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return plan_.present();
}

std::string BoardSource::unable() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return plan_.unable();
}

std::string BoardSource::complaint() const {
  const link::Device::Snapshot now = device_.snapshot();
  return now.trouble == link::LinkTrouble::kNone ? "" : "board: " + now.trouble_text;
}

bool BoardSource::expected() const {
  const bool asked_for = settings_.backend == Backend::kBoard || settings_.device != "usb";
  return asked_for || !none_found_ || device_.snapshot().times_opened > 0;
}

void BoardSource::refuse(DropCause cause, const std::string& why) {
  if (health_.refusal() != why) ROS_WARN_STREAM_NAMED("stereo", why);
  health_.refused(cause, why);
}

void BoardSource::count_lost(const link::FrameSet& set) {
  // Gaps in the frames' numbers: lost on the way, or dropped by a board whose link was too slow.
  if (last_frame_) {
    const auto step = static_cast<std::uint64_t>(settings_.frame_interval);
    const std::uint64_t gap = (set.frame_id - *last_frame_) / step;
    for (std::uint64_t i = 1; i < gap && gap < 1000; ++i) {
      health_.received();
      health_.dropped(DropCause::kLink);
    }
  }
  last_frame_ = set.frame_id;
}

std::optional<InputPair> BoardSource::take_sent(std::uint64_t frame_id) {
  const auto found = sent_.find(frame_id);
  if (found == sent_.end()) return std::nullopt;
  const Sent sent = found->second;
  last_back_ = Clock::now();
  turnaround_ = last_back_ - sent.when;
  // Those before it will not come any more.
  health_.dropped(DropCause::kLink,
                  static_cast<std::uint64_t>(std::distance(sent_.begin(), found)));
  sent_.erase(sent_.begin(), std::next(found));
  return sent.pair;
}

void BoardSource::received(const link::ReceivedFrames& r) {
  std::shared_ptr<const BoardPlan::Made> made;
  std::optional<InputPair> pair;
  Demand demand;
  bool lacks = false;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    made = plan_.made(r.tag);
    demand = plan_.demand();
    if (settings_.topic_input) {
      pair = take_sent(r.set.frame_id);
      if (!pair) return;
    } else {
      if (plan_.wanted().streams.empty()) return;  // sent before the last listener went
      lacks = plan_.lacks(r.set);
      count_lost(r.set);
    }
  }
  if (!pair) health_.received();
  if (!made) {
    return refuse(DropCause::kLink, "frame of the board dropped: its configuration is long gone");
  }
  if (lacks) return refuse(DropCause::kLink, r.set.dropped.front());
  if (const Status fits = check_sizes(r.set, made->image_size); !fits) {
    return refuse(DropCause::kLink, fits.error().message);
  }
  if (pair) return take_pair(r, *made, *pair, demand);
  take_camera_frame(r, *made, demand);
}

void BoardSource::verify(const link::FrameSet& set, const BoardPlan::Made& made,
                         const cv::Mat& left, const cv::Mat& right) {
  if (settings_.verify == 0 || !set.verdicts.empty() || left.empty() || right.empty()) return;
  if (!made.rectification || set.image(Stream::kDisparity).empty()) return;
  // By number: of a board's own cameras, raw images may come of some frames only.
  const int step = settings_.topic_input ? 1 : settings_.frame_interval;
  const auto every = static_cast<std::uint64_t>(settings_.verify) * static_cast<unsigned>(step);
  if (last_verified_ && set.frame_id - *last_verified_ < every) return;
  last_verified_ = set.frame_id;
  // Those of topics may lie in messages, which do not last.
  const bool owned = !settings_.topic_input;
  verifier_.offer({owned ? left : left.clone(), owned ? right : right.clone(),
                   set.image(Stream::kDisparity), made.rectification, made.settings.pipeline});
}

void BoardSource::take_pair(const link::ReceivedFrames& r, const BoardPlan::Made& made,
                            const InputPair& pair, const Demand& demand) {
  const auto frame = frame_of_pair(r, made, pair, demand);
  if (!frame) return refuse(DropCause::kLink, frame.error().message);
  verify(r.set, made, frame->left.mono, frame->right.mono);
  callbacks_.frame(*frame);
}

void BoardSource::take_camera_frame(const link::ReceivedFrames& r, const BoardPlan::Made& made,
                                    const Demand& demand) {
  const auto stamp = to_stamp(r.stamp);
  if (!stamp) return refuse(DropCause::kStamp, stamp.error().message);
  if (const auto why = gate_.check(*stamp)) {
    return refuse(DropCause::kStamp, "frame of the board dropped: " + *why);
  }
  const cv::Mat& left = r.set.image(Stream::kRawLeft);
  const cv::Mat& right = r.set.image(Stream::kRawRight);
  cameras_.publish(left, right, made.infos, *stamp);
  std_msgs::Header header;
  header.stamp = *stamp;
  header.frame_id = settings_.frame_id;
  if (demand.any() && !made.rectification) {
    const auto pair = raw_pair(r.set, made, header);
    if (!pair) return refuse(DropCause::kLink, pair.error().message);
    return callbacks_.pair(*pair);
  }
  verify(r.set, made, left, right);
  callbacks_.frame(frame_of_cameras(r, made, demand, header));
}

}  // namespace fpga_stereo
