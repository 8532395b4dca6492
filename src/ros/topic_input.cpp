#include "ros/topic_input.hpp"

#include <fmt/format.h>

#include <utility>

#include "ros/image_subscription.hpp"

namespace fpga_stereo {
namespace {

std::string image_topic(const std::string& camera, PairKind kind) {
  return camera + (kind == PairKind::kRaw ? "/image_raw" : "/image_rect");
}

}  // namespace

TopicInput::TopicInput(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh, PairKind kind,
                       const SyncSettings& settings, const CalibrationUrls& urls, Health& health,
                       StampGate& gate, Callbacks callbacks)
    : nh_(nh),
      private_nh_(private_nh),
      kind_(kind),
      names_{image_topic("left", kind), "left/camera_info", image_topic("right", kind),
             "right/camera_info"},
      health_(health),
      gate_(gate),
      callbacks_(std::move(callbacks)),
      log_({{nh.resolveName(names_[kLeftImage]), false},
            {nh.resolveName(names_[kLeftInfo]), true},
            {nh.resolveName(names_[kRightImage]), false},
            {nh.resolveName(names_[kRightInfo]), true}},
           settings, health),
      transport_(nh),
      left_info_(nh, "left", urls.left),
      right_info_(nh, "right", urls.right),
      sync_(settings, left_of_pair_, left_info_, right_of_pair_, right_info_,
            [this](const auto& left, const auto& left_info, const auto& right,
                   const auto& right_info) { on_pair(left, left_info, right, right_info); }) {
  left_image_.registerCallback(boost::function<void(const Event&)>(
      [this](const Event& event) { on_image(kLeftImage, event); }));
  right_image_.registerCallback(boost::function<void(const Event&)>(
      [this](const Event& event) { on_image(kRightImage, event); }));
  left_info_.registerCallback(boost::function<void(const sensor_msgs::CameraInfoConstPtr&)>(
      [this](const auto& m) { log_.arrived(kLeftInfo, m->header.stamp); }));
  right_info_.registerCallback(boost::function<void(const sensor_msgs::CameraInfoConstPtr&)>(
      [this](const auto& m) { log_.arrived(kRightInfo, m->header.stamp); }));
}

void TopicInput::set_demand(const Demand& demand) {
  {
    const MutexLock lock(mutex_);
    demand_ = demand;
  }
  const bool needs_pairs = demand.needs_pairs();
  std::set<std::size_t> topics;
  if (needs_pairs || demand.left.any_raw()) topics.insert(kLeftImage);
  if (needs_pairs || demand.right.any_raw()) topics.insert(kRightImage);
  if (needs_pairs) topics.insert({kLeftInfo, kRightInfo});
  if (topics == subscribed_) return;
  if (topics.empty()) {
    subscribe(topics);
    log_.stop();
  } else {
    std::set<std::size_t> awaited = topics;
    if (left_info_.is_from_file()) awaited.erase(kLeftInfo);
    if (right_info_.is_from_file()) awaited.erase(kRightInfo);
    log_.start(awaited, needs_pairs);
    subscribe(topics);
  }
}

void TopicInput::subscribe(const std::set<std::size_t>& topics) {
  // Queues of 1 as in image_pipeline: the synchronizer has the queue that matters.
  const auto change = [&](Topic topic, auto& subscriber, const auto& subscribe) {
    const bool is_subscribed = subscribed_.count(topic) != 0;
    if (topics.count(topic) == 0) {
      subscriber.unsubscribe();
    } else if (!is_subscribed) {
      subscribe(subscriber, names_[topic]);
    }
  };
  const auto subscribe_image = [&](auto& subscriber, const std::string& name) {
    subscribe_to_images(transport_, nh_, private_nh_, name, subscriber);
  };
  const auto subscribe_info = [](auto& subscriber, const auto&) { subscriber.subscribe(); };
  change(kLeftImage, left_image_, subscribe_image);
  change(kLeftInfo, left_info_, subscribe_info);
  change(kRightImage, right_image_, subscribe_image);
  change(kRightInfo, right_info_, subscribe_info);
  subscribed_ = topics;
}

Demand TopicInput::demand() const {
  const MutexLock lock(mutex_);
  return demand_;
}

void TopicInput::on_image(Topic topic, const Event& event) {
  const Side side = topic == kLeftImage ? Side::kLeft : Side::kRight;
  const sensor_msgs::ImageConstPtr& image = event.getConstMessage();
  const Demand demand = this->demand();
  // Noted before the pair that it completes.
  if (const auto rewind = log_.arrived(topic, image->header.stamp)) {
    sync_.restart();
    gate_.restart(*rewind);
  }
  if (!demand.needs_pairs()) {
    if (demand.of(side).any_raw()) pass_on(side, image);
    return;
  }
  // An image that cannot be decoded is refused with its pair.
  if (demand.of(side).any_raw()) (void)callbacks_.image(side, image);
  calibrate(side, *image);
  (side == Side::kLeft ? left_of_pair_ : right_of_pair_).add(event);
}

void TopicInput::calibrate(Side side, const Image& image) {
  std::string frame_id = image.header.frame_id;
  {
    const MutexLock lock(mutex_);
    if (side == Side::kLeft) left_frame_ = frame_id;
    // image_geometry requires the left camera's frame in both camera_infos.
    if (!left_frame_.empty()) frame_id = left_frame_;
  }
  (side == Side::kLeft ? left_info_ : right_info_).on_image(image, frame_id);
}

std::optional<StateReport> TopicInput::trouble() const {
  for (const auto& [side, info] : {std::pair("left", &left_info_), {"right", &right_info_}}) {
    if (const auto trouble = info->trouble()) {
      return StateReport{NodeState::kUncalibrated,
                         fmt::format("the {} camera is not calibrated: {}", side, *trouble)};
    }
  }
  return log_.trouble();
}

void TopicInput::pass_on(Side side, const sensor_msgs::ImageConstPtr& image) {
  health_.received();
  const ros::WallTime start = ros::WallTime::now();
  if (const Status published = callbacks_.image(side, image); !published) {
    return health_.refused(DropCause::kEncoding, published.error().message);
  }
  const ros::Time& stamp = image->header.stamp;
  health_.published({}, (ros::WallTime::now() - start).toSec() * 1e3,
                    stamp.isZero() ? 0 : (ros::Time::now() - stamp).toSec() * 1e3);
}

void TopicInput::on_pair(const sensor_msgs::ImageConstPtr& left,
                         const sensor_msgs::CameraInfoConstPtr& left_info,
                         const sensor_msgs::ImageConstPtr& right,
                         const sensor_msgs::CameraInfoConstPtr& right_info) {
  if (!log_.completed(left->header.stamp)) return;
  const Result<std::uint64_t> number = gate_.accept(left->header.stamp);
  if (!number) {
    return health_.refused(DropCause::kStamp, "pair refused: " + number.error().message);
  }
  Result<SourcePair> pair = decode_pair(left, left_info, right, right_info, demand(), kind_);
  if (!pair) return health_.refused(cause_of(pair.error().kind), pair.error().message);
  (*pair).number = *number;
  callbacks_.pair(*pair);
}

}  // namespace fpga_stereo
