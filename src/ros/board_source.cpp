#include "fpga_stereo/ros/board_source.hpp"

#include <ros/console.h>

#include <utility>

#include "fpga_stereo/link/transport.hpp"
#include "fpga_stereo/ros/conversions.hpp"
#include "fpga_stereo/ros/make_frame.hpp"

namespace fpga_stereo {
namespace {

using link::Session;
using link::Stream;

constexpr std::size_t kMostSent = 4;  // pairs under way in the board

link::Device::Options device_options(const BoardSettings& settings) {
  link::Device::Options options;
  options.open = [name = settings.device] { return link::open_transport(name); };
  options.hotplug = link::watch_for(settings.device);
  options.session.frames.keep_incomplete = settings.keep_incomplete;
  return options;
}

sensor_msgs::ImageConstPtr to_message(const cv::Mat& image, const std_msgs::Header& header) {
  return to_image(image, header);
}

}  // namespace

BoardSource::BoardSource(const BoardSettings& settings, CameraTopics& cameras, Health& health,
                         Callbacks callbacks)
    : settings_(settings),
      cameras_(cameras),
      health_(health),
      callbacks_(std::move(callbacks)),
      plan_(settings_),
      device_(device_options(settings), device_callbacks()) {}

link::Device::Callbacks BoardSource::device_callbacks() {
  link::Device::Callbacks callbacks;
  callbacks.received = [this](const std::vector<Session::Received>& sets) { received(sets); };
  callbacks.identified = [this](const link::Identity& identity) { identified(identity); };
  callbacks.closed = [this] { closed(); };
  callbacks.note = [](const std::string& note) {
    ROS_INFO_STREAM_NAMED("stereo", "board: " << note);
  };
  return callbacks;
}

// What is wanted.

void BoardSource::tell() {
  if (plan_.present()) device_.want(plan_.wanted());
}

void BoardSource::identified(const link::Identity& identity) {
  ROS_INFO_STREAM_NAMED("stereo", "board identified: " << identity.text());
  if (!settings_.topic_input) cameras_.show(true);
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    last_frame_.reset();
    sent_.clear();
    if (!settings_.topic_input) plan_.set_calibration(cameras_.infos());
    plan_.set_identity(identity);
    tell();
  }
  callbacks_.changed();
}

void BoardSource::closed() {
  std::map<std::uint64_t, InputPair> sent;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!plan_.present()) return;
    plan_.set_identity(std::nullopt);
    sent = std::exchange(sent_, {});
  }
  // What the board has not answered the software does.
  for (const auto& [id, pair] : sent) callbacks_.pair(pair);
  cameras_.show(false);
  callbacks_.changed();
}

void BoardSource::refresh() {
  if (device_.snapshot().state == Session::State::kRefused) return closed();
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

bool BoardSource::send(const InputPair& pair) {
  std::unique_lock<std::mutex> lock(mutex_);
  if (!plan_.present()) return false;
  const CameraTopics::Infos infos{*pair.left_info, *pair.right_info};
  if (!same_calibration(infos, plan_.calibration())) {
    plan_.set_calibration(infos);
    tell();
    const bool unable = !plan_.unable().empty();
    lock.unlock();
    if (unable) callbacks_.changed();
    return false;  // the board is being configured
  }
  const std::uint64_t tag = plan_.wanted().tag;
  const auto made = plan_.made(tag);
  if (!plan_.unable().empty() || !made || !made->rectification || sent_.size() >= kMostSent)
    return false;
  const link::Device::Snapshot now = device_.snapshot();
  if (now.state != Session::State::kStreaming || !now.configured_tag ||
      *now.configured_tag != tag) {
    return false;
  }
  const auto begun = begin_frame(pair, *made->rectification, made->settings);
  if (!begun) return false;  // the software says why
  if (const auto why = gate_.check(pair.left->header.stamp)) {
    lock.unlock();
    health_.refused(DropCause::kStamp, "frame refused: " + *why);
    return true;
  }
  const std::uint64_t id = next_pair_++;
  const std::uint64_t stamp_us = pair.left->header.stamp.toNSec() / 1000;
  if (!device_.send_pair(begun->left.mono, begun->right.mono, id, stamp_us)) return false;
  sent_[id] = pair;
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
  const std::string why = device_.snapshot().complaint;
  return why.empty() ? "" : "board: " + why;
}

void BoardSource::received(const std::vector<Session::Received>& sets) {
  for (const Session::Received& r : sets) take(r);
}

void BoardSource::refuse(const std::string& why) {
  if (health_.refusal() != why) ROS_WARN_STREAM_NAMED("stereo", why);
  health_.refused(DropCause::kLink, why);
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

void BoardSource::take(const Session::Received& r) {
  std::shared_ptr<const BoardPlan::Made> made;
  bool disparity_wanted = false;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    made = plan_.made(r.tag);
    disparity_wanted = plan_.wants(Stream::kDisparity);
    if (!settings_.topic_input) count_lost(r.set);
  }
  if (!settings_.topic_input) health_.received();
  if (!made) return refuse("frame of the board dropped: its configuration is long gone");
  const bool lost = disparity_wanted && made->rectification &&
                    r.set.image(Stream::kDisparity).empty() && !r.set.dropped.empty();
  if (lost && !settings_.topic_input) return refuse(r.set.dropped.front());
  if (settings_.topic_input) return take_pair(r, *made);
  take_camera_frame(r, *made);
}

void BoardSource::take_pair(const Session::Received& r, const BoardPlan::Made& made) {
  const link::FrameSet& set = r.set;
  InputPair pair;
  Demand demand;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto found = sent_.find(set.frame_id);
    if (found == sent_.end()) return;
    pair = found->second;
    // Those before it will not come any more.
    health_.dropped(DropCause::kLink,
                    static_cast<std::uint64_t>(std::distance(sent_.begin(), found)));
    sent_.erase(sent_.begin(), std::next(found));
    demand = plan_.demand();
  }
  if (set.image(Stream::kDisparity).empty()) {
    return refuse(set.dropped.empty() ? "frame of the board dropped: it has no disparity"
                                      : set.dropped.front());
  }
  if (!same_calibration({*pair.left_info, *pair.right_info}, made.infos)) {
    return refuse("frame of the board dropped: the calibration changed under way");
  }
  auto begun = begin_frame(pair, *made.rectification, made.settings);
  if (!begun) return refuse(begun.error().message);
  StereoFrame& frame = *begun;
  frame.disparity = set.image(Stream::kDisparity);
  frame.left.rect = set.image(Stream::kRectifiedLeft);
  frame.right.rect = set.image(Stream::kRectifiedRight);
  frame.arrived = r.arrived;
  if (const Status added = add_pictures(pair, *made.rectification, demand, frame); !added) {
    return refuse(added.error().message);
  }
  if (settings_.verify > 0 && set.frame_id % static_cast<std::uint64_t>(settings_.verify) == 0) {
    // Copies: the grey images may be those of the messages.
    verifier_.offer({frame.left.mono.clone(), frame.right.mono.clone(), frame.disparity,
                     made.rectification, made.settings.pipeline});
  }
  callbacks_.frame(frame);
}

void BoardSource::take_camera_frame(const Session::Received& r, const BoardPlan::Made& made) {
  const link::FrameSet& set = r.set;
  const ros::Time stamp = ros::Time().fromSec(r.stamp);
  const cv::Mat& left = set.image(Stream::kRawLeft);
  const cv::Mat& right = set.image(Stream::kRawRight);
  cameras_.publish(left, right, made.infos, stamp);
  Demand demand;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    demand = plan_.demand();
  }
  std_msgs::Header header;
  header.stamp = stamp;
  header.frame_id = settings_.frame_id;
  if (!demand.any()) return health_.published({}, 0, 0);  // raw images alone

  if (!made.rectification) {
    if (left.empty() || right.empty()) {
      return refuse(set.dropped.empty() ? "raw pair of the board dropped: it lacks an image"
                                        : set.dropped.front());
    }
    const auto info = [&](const sensor_msgs::CameraInfo& from) {
      auto message = boost::make_shared<sensor_msgs::CameraInfo>(from);
      message->header = header;
      return message;
    };
    callbacks_.pair({to_message(left, header), to_message(right, header), info(made.infos.left),
                     info(made.infos.right)});
    return;
  }

  StereoFrame frame;
  frame.left.header = frame.right.header = header;
  frame.left_info = made.infos.left;
  frame.left_info.header = header;
  frame.geometry = made.rectification->geometry;
  frame.settings = made.settings;
  frame.arrived = r.arrived;
  frame.disparity = set.image(Stream::kDisparity);
  frame.left.mono = frame.left.color = left;
  frame.right.mono = frame.right.color = right;
  frame.left.rect = frame.left.rect_color = set.image(Stream::kRectifiedLeft);
  frame.right.rect = set.image(Stream::kRectifiedRight);
  const bool shifted = made.settings.pipeline.min_disparity != 0;
  if (shifted && (demand.right.rect || demand.right.rect_color) && !right.empty()) {
    rectify_in_bands(right, made.rectification->right_unshifted, made.settings.num_threads,
                     frame.right.rect);
  }
  frame.right.rect_color = frame.right.rect;
  if (settings_.verify > 0 && !left.empty() && !right.empty() && !frame.disparity.empty() &&
      set.verdicts.empty()) {
    verifier_.offer({left, right, frame.disparity, made.rectification, made.settings.pipeline});
  }
  callbacks_.frame(frame);
}

}  // namespace fpga_stereo
