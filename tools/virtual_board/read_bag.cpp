#include "virtual_board/read_bag.hpp"

#include <fmt/format.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sensor_msgs/Image.h>

#include <array>
#include <map>

#include "ros/conversions.hpp"
#include "support/program.hpp"
#include "virtual_board/cameras.hpp"

namespace fpga_stereo::tools {
namespace {

using Images = std::map<ros::Time, sensor_msgs::ImageConstPtr>;

cv::Mat1b grey(const sensor_msgs::ImageConstPtr& message, const std::string& camera) {
  auto image = to_grey(message, camera);
  require(image);
  return image->clone();
}

}  // namespace

std::vector<sim::GreyPair> read_bag(const std::string& path, const std::string& camera,
                                    std::size_t max_pairs) {
  const std::string left_topic = fmt::format("/{}/left/image_raw", camera);
  const std::string right_topic = fmt::format("/{}/right/image_raw", camera);
  std::vector<sim::GreyPair> pairs;
  try {
    rosbag::Bag bag(path, rosbag::bagmode::Read);
    rosbag::View view(bag, rosbag::TopicQuery(std::vector<std::string>{left_topic, right_topic}));
    std::array<Images, 2> unpaired;  // left, right
    for (const rosbag::MessageInstance& instance : view) {
      if (pairs.size() == max_pairs) break;
      const auto message = instance.instantiate<sensor_msgs::Image>();
      if (message == nullptr) {
        throw std::runtime_error(
            fmt::format("topic {} has messages of type {}: allowed is "
                        "sensor_msgs/Image",
                        instance.getTopic(), instance.getDataType()));
      }
      const ros::Time& stamp = message->header.stamp;
      const bool is_right = instance.getTopic() == right_topic;
      unpaired[is_right ? 1 : 0][stamp] = message;
      const Images& others = unpaired[is_right ? 0 : 1];
      const auto partner = others.find(stamp);
      if (partner == others.end()) continue;
      const auto other = partner->second;
      append_pair(pairs, grey(is_right ? other : message, "left"),
                  grey(is_right ? message : other, "right"),
                  fmt::format("stamp {}.{:09d}", stamp.sec, stamp.nsec));
      for (Images& images : unpaired) images.erase(images.begin(), images.upper_bound(stamp));
    }
  } catch (const std::exception& e) {
    throw std::runtime_error(fmt::format("{}: cannot be used: {}", path, e.what()));
  }
  if (pairs.empty()) {
    throw std::runtime_error(
        fmt::format("{}: no images on {} and {} have equal stamps", path, left_topic, right_topic));
  }
  return pairs;
}

}  // namespace fpga_stereo::tools
