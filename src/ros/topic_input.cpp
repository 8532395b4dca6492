#include "ros/topic_input.hpp"

#include <algorithm>
#include <iomanip>
#include <sstream>
#include <utility>

namespace fpga_stereo {
namespace {

constexpr std::array<const char*, 4> kTopicNames{"left/image_raw", "left/camera_info",
                                                 "right/image_raw", "right/camera_info"};
const ros::WallDuration kSilence(3.0);  // a topic or pair this old has stopped

}  // namespace

TopicInput::TopicInput(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh,
                       const SyncSettings& settings, Health& health, Callback callback)
    : nh_(nh),
      private_nh_(private_nh),
      settings_(settings),
      health_(health),
      callback_(std::move(callback)),
      transport_(nh) {
  using boost::placeholders::_1;
  using boost::placeholders::_2;
  using boost::placeholders::_3;
  using boost::placeholders::_4;
  // Before the synchronizer connects: an arrival is noted before the pair that it completes.
  left_image_.registerCallback(boost::function<void(const sensor_msgs::ImageConstPtr&)>(
      [this](const auto& m) { arrived(kLeftImage, m->header.stamp); }));
  right_image_.registerCallback(boost::function<void(const sensor_msgs::ImageConstPtr&)>(
      [this](const auto& m) { arrived(kRightImage, m->header.stamp); }));
  left_info_.registerCallback(boost::function<void(const sensor_msgs::CameraInfoConstPtr&)>(
      [this](const auto& m) { arrived(kLeftInfo, m->header.stamp); }));
  right_info_.registerCallback(boost::function<void(const sensor_msgs::CameraInfoConstPtr&)>(
      [this](const auto& m) { arrived(kRightInfo, m->header.stamp); }));

  const auto queue = static_cast<std::uint32_t>(settings_.queue_size);
  if (settings_.approximate_sync) {
    approximate_ = std::make_unique<message_filters::Synchronizer<Approximate>>(
        Approximate(queue), left_image_, left_info_, right_image_, right_info_);
    approximate_->setMaxIntervalDuration(ros::Duration(settings_.sync_tolerance));
    approximate_->registerCallback(boost::bind(&TopicInput::paired, this, _1, _2, _3, _4));
  } else {
    exact_ = std::make_unique<message_filters::Synchronizer<Exact>>(
        Exact(queue), left_image_, left_info_, right_image_, right_info_);
    exact_->registerCallback(boost::bind(&TopicInput::paired, this, _1, _2, _3, _4));
  }
}

void TopicInput::start() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (active_) return;
    active_ = true;
    started_ = last_pair_ = ros::WallTime::now();
    arrivals_ = {};
    waiting_.clear();
  }
  // As in image_pipeline: the queue that matters is the synchronizer's.
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
  const std::lock_guard<std::mutex> lock(mutex_);
  active_ = false;
  health_.dropped(DropCause::kUnwanted, waiting_.size());
  waiting_.clear();
}

void TopicInput::arrived(Topic topic, const ros::Time& stamp) {
  const std::lock_guard<std::mutex> lock(mutex_);
  arrivals_[topic] = {ros::WallTime::now(), stamp};
  if (topic != kLeftImage) return;
  health_.received();
  if (!waiting_.insert(stamp).second) health_.dropped(DropCause::kUnsynchronized);  // twice
  if (waiting_.size() > static_cast<std::size_t>(settings_.queue_size)) {
    waiting_.erase(waiting_.begin());
    health_.dropped(DropCause::kUnsynchronized);
  }
}

void TopicInput::paired(const sensor_msgs::ImageConstPtr& left,
                        const sensor_msgs::CameraInfoConstPtr& left_info,
                        const sensor_msgs::ImageConstPtr& right,
                        const sensor_msgs::CameraInfoConstPtr& right_info) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    last_pair_ = ros::WallTime::now();
    // Older images will not find a partner any more.
    const auto found = waiting_.find(left->header.stamp);
    if (found == waiting_.end()) return;  // counted as dropped already
    health_.dropped(DropCause::kUnsynchronized,
                    static_cast<std::uint64_t>(std::distance(waiting_.begin(), found)));
    waiting_.erase(waiting_.begin(), std::next(found));
  }
  callback_({left, right, left_info, right_info});
}

std::string TopicInput::complaint() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const ros::WallTime now = ros::WallTime::now();
  if (!active_ || now - std::max(started_, last_pair_) < kSilence) return "";

  std::string silent;
  bool images_missing = false;
  for (int topic = 0; topic < kTopics; ++topic) {
    if (!arrivals_[topic].when.isZero() && now - arrivals_[topic].when < kSilence) continue;
    images_missing = images_missing || topic == kLeftImage || topic == kRightImage;
    silent += (silent.empty() ? "" : ", ") + nh_.resolveName(kTopicNames[topic]);
  }
  if (!silent.empty()) {
    return (images_missing ? "no images: nothing arrives on "
                           : "no camera_info: nothing arrives on ") +
           silent;
  }
  const auto [first, last] =
      std::minmax_element(arrivals_.begin(), arrivals_.end(),
                          [](const Arrival& a, const Arrival& b) { return a.stamp < b.stamp; });
  std::ostringstream text;
  text << std::fixed << std::setprecision(4) << "not synchronised: the latest stamps of "
       << nh_.resolveName(kTopicNames[first - arrivals_.begin()]) << " and "
       << nh_.resolveName(kTopicNames[last - arrivals_.begin()]) << " are "
       << (last->stamp - first->stamp).toSec() << " s apart; ";
  if (settings_.approximate_sync) {
    text << "sync_tolerance is " << settings_.sync_tolerance << " s";
  } else {
    text << "all four must be equal, unless approximate_sync is set";
  }
  return text.str();
}

}  // namespace fpga_stereo
