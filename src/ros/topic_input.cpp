#include "ros/topic_input.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace fpga_stereo {
namespace {

constexpr std::array<const char*, 4> kTopicNames{"left/image_raw", "left/camera_info",
                                                 "right/image_raw", "right/camera_info"};
const ros::WallDuration kSilence(3.0);  // a topic without messages for this long is silent

}  // namespace

TopicInput::TopicInput(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh,
                       const SyncSettings& settings, Health& health, StampGate& gate,
                       Callback callback)
    : nh_(nh),
      private_nh_(private_nh),
      settings_(settings),
      health_(health),
      gate_(gate),
      callback_(std::move(callback)),
      transport_(nh) {
  using boost::placeholders::_1;
  using boost::placeholders::_2;
  using boost::placeholders::_3;
  using boost::placeholders::_4;
  // Registered before the synchronizer: a message is noted before the pair that it completes.
  left_image_.registerCallback(boost::function<void(const sensor_msgs::ImageConstPtr&)>(
      [this](const auto& m) { on_message(kLeftImage, m->header.stamp); }));
  right_image_.registerCallback(boost::function<void(const sensor_msgs::ImageConstPtr&)>(
      [this](const auto& m) { on_message(kRightImage, m->header.stamp); }));
  left_info_.registerCallback(boost::function<void(const sensor_msgs::CameraInfoConstPtr&)>(
      [this](const auto& m) { on_message(kLeftInfo, m->header.stamp); }));
  right_info_.registerCallback(boost::function<void(const sensor_msgs::CameraInfoConstPtr&)>(
      [this](const auto& m) { on_message(kRightInfo, m->header.stamp); }));

  const auto queue = static_cast<std::uint32_t>(settings_.queue_size);
  if (settings_.approximate_sync) {
    approximate_ = std::make_unique<message_filters::Synchronizer<Approximate>>(
        Approximate(queue), left_image_, left_info_, right_image_, right_info_);
    approximate_->setMaxIntervalDuration(ros::Duration(settings_.sync_tolerance));
    approximate_->registerCallback(boost::bind(&TopicInput::on_pair, this, _1, _2, _3, _4));
  } else {
    exact_ = std::make_unique<message_filters::Synchronizer<Exact>>(
        Exact(queue), left_image_, left_info_, right_image_, right_info_);
    exact_->registerCallback(boost::bind(&TopicInput::on_pair, this, _1, _2, _3, _4));
  }
}

void TopicInput::start() {
  {
    const MutexLock lock(mutex_);
    if (is_subscribed_) return;
    is_subscribed_ = true;
    started_ = last_pair_ = ros::WallTime::now();
    arrivals_ = {};
    unpaired_.clear();
  }
  // Queues of 1 as in image_pipeline: the synchronizer has the queue that matters.
  const image_transport::TransportHints hints("raw", ros::TransportHints(), private_nh_);
  left_image_.subscribe(transport_, kTopicNames[kLeftImage], 1, hints);
  left_info_.subscribe(nh_, kTopicNames[kLeftInfo], 1);
  right_image_.subscribe(transport_, kTopicNames[kRightImage], 1, hints);
  right_info_.subscribe(nh_, kTopicNames[kRightInfo], 1);
}

void TopicInput::stop() {
  left_image_.unsubscribe();
  left_info_.unsubscribe();
  right_image_.unsubscribe();
  right_info_.unsubscribe();
  const MutexLock lock(mutex_);
  is_subscribed_ = false;
  health_.dropped(DropCause::kUnwanted, unpaired_.size());
  unpaired_.clear();
}

void TopicInput::set_demand(const Demand& demand) {
  const MutexLock lock(mutex_);
  demand_ = demand;
}

void TopicInput::on_message(Topic topic, const ros::Time& stamp) {
  const MutexLock lock(mutex_);
  arrivals_[topic] = {ros::WallTime::now(), stamp};
  if (topic != kLeftImage) return;
  health_.received();
  const bool is_duplicate = !unpaired_.insert(stamp).second;
  if (is_duplicate) health_.dropped(DropCause::kUnsynchronized);
  if (unpaired_.size() > static_cast<std::size_t>(settings_.queue_size)) {
    unpaired_.erase(unpaired_.begin());
    health_.dropped(DropCause::kUnsynchronized);
  }
}

std::optional<Demand> TopicInput::note_pair(const ros::Time& stamp) {
  const MutexLock lock(mutex_);
  last_pair_ = ros::WallTime::now();
  const auto found = unpaired_.find(stamp);
  if (found == unpaired_.end()) return std::nullopt;
  // Older images will not find a partner any more.
  health_.dropped(DropCause::kUnsynchronized,
                  static_cast<std::uint64_t>(std::distance(unpaired_.begin(), found)));
  unpaired_.erase(unpaired_.begin(), std::next(found));
  return demand_;
}

void TopicInput::on_pair(const sensor_msgs::ImageConstPtr& left,
                         const sensor_msgs::CameraInfoConstPtr& left_info,
                         const sensor_msgs::ImageConstPtr& right,
                         const sensor_msgs::CameraInfoConstPtr& right_info) {
  const std::optional<Demand> demand = note_pair(left->header.stamp);
  if (!demand) return;
  const Result<std::uint64_t> number = gate_.accept(left->header.stamp);
  if (!number) {
    return health_.refused(DropCause::kStamp, "pair refused: " + number.error().message);
  }
  Result<SourcePair> pair = decode_pair(left, left_info, right, right_info, *demand);
  if (!pair) return health_.refused(DropCause::kEncoding, pair.error().message);
  (*pair).number = *number;
  callback_(*pair);
}

std::optional<StateReport> TopicInput::trouble() const {
  std::array<Arrival, kTopics> arrivals;
  const ros::WallTime now = ros::WallTime::now();
  {
    const MutexLock lock(mutex_);
    if (!is_subscribed_ || now - std::max(started_, last_pair_) < kSilence) return std::nullopt;
    arrivals = arrivals_;
  }
  std::vector<std::string> silent;
  bool has_images = true;
  for (int topic = 0; topic < kTopics; ++topic) {
    const ros::WallTime& when = arrivals[topic].when;
    if (!when.isZero() && now - when < kSilence) continue;
    if (topic == kLeftImage || topic == kRightImage) has_images = false;
    silent.push_back(nh_.resolveName(kTopicNames[topic]));
  }
  return silent.empty() ? stamps_differ(arrivals) : silent_topics(silent, has_images);
}

StateReport TopicInput::silent_topics(const std::vector<std::string>& topics,
                                      bool has_images) const {
  const std::string names = fmt::format("{}", fmt::join(topics, ", "));
  if (has_images) {
    return {NodeState::kWaitingForCameraInfo, "no camera_info: nothing arrives on " + names};
  }
  return {NodeState::kWaitingForImages, "no images: nothing arrives on " + names};
}

StateReport TopicInput::stamps_differ(const std::array<Arrival, kTopics>& arrivals) const {
  const auto [first, last] =
      std::minmax_element(arrivals.begin(), arrivals.end(),
                          [](const Arrival& a, const Arrival& b) { return a.stamp < b.stamp; });
  const std::string rule = settings_.approximate_sync
                               ? fmt::format("sync_tolerance is {:.4f} s", settings_.sync_tolerance)
                               : "all four must be equal unless approximate_sync is set";
  return {NodeState::kUnsynchronised,
          fmt::format("not synchronised: the latest stamps of {} and {} are {:.4f} s apart; {}",
                      nh_.resolveName(kTopicNames[first - arrivals.begin()]),
                      nh_.resolveName(kTopicNames[last - arrivals.begin()]),
                      (last->stamp - first->stamp).toSec(), rule)};
}

}  // namespace fpga_stereo
