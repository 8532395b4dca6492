#include "virtual_board/cameras.hpp"

#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sensor_msgs/Image.h>

#include <map>

#include "ros/conversions.hpp"
#include "support/files.hpp"
#include "support/program.hpp"

namespace fpga_stereo::tools {
namespace {

void append(std::vector<sim::GreyPair>& pairs, const cv::Mat1b& left, const cv::Mat1b& right,
            const std::string& what) {
  const cv::Size size = pairs.empty() ? left.size() : pairs[0].left.size();
  if (left.size() != size || right.size() != size) {
    throw std::runtime_error(concat(what, ": left is ", left.cols, "x", left.rows, ", right ",
                                    right.cols, "x", right.rows, ", expected ", size.width, "x",
                                    size.height, ": all images must have one size"));
  }
  pairs.push_back({left, right});
}

cv::Mat1b grey(const sensor_msgs::ImageConstPtr& message, const std::string& camera) {
  auto image = to_grey(message, camera);
  require(image);
  return image->clone();
}

}  // namespace

std::vector<sim::GreyPair> read_image_pair(const std::string& left, const std::string& right) {
  std::vector<sim::GreyPair> pairs;
  append(pairs, read_grey(left), read_grey(right), left + ", " + right);
  return pairs;
}

std::vector<sim::GreyPair> read_folder(const std::string& folder, std::size_t most) {
  const auto left = list_images("--folder", {folder + "/left"});
  const auto right = list_images("--folder", {folder + "/right"});
  if (left.size() != right.size()) {
    throw std::runtime_error(concat(folder, ": has ", left.size(), " left and ", right.size(),
                                    " right images: they must be pairs"));
  }
  std::vector<sim::GreyPair> pairs;
  for (std::size_t i = 0; i < std::min(most, left.size()); ++i) {
    append(pairs, read_grey(left[i]), read_grey(right[i]), left[i]);
  }
  return pairs;
}

std::vector<sim::GreyPair> read_bag(const std::string& path, const std::string& camera,
                                    std::size_t most) {
  const std::string left_topic = "/" + camera + "/left/image_raw";
  const std::string right_topic = "/" + camera + "/right/image_raw";
  std::vector<sim::GreyPair> pairs;
  try {
    rosbag::Bag bag(path, rosbag::bagmode::Read);
    rosbag::View view(bag, rosbag::TopicQuery(std::vector<std::string>{left_topic, right_topic}));
    std::map<ros::Time, sensor_msgs::ImageConstPtr> waiting[2];  // left, right
    for (const rosbag::MessageInstance& instance : view) {
      if (pairs.size() == most) break;
      const auto message = instance.instantiate<sensor_msgs::Image>();
      if (message == nullptr) {
        throw std::runtime_error(concat("topic ", instance.getTopic(), " has messages of type ",
                                        instance.getDataType(), ": allowed sensor_msgs/Image"));
      }
      const bool is_right = instance.getTopic() == right_topic;
      waiting[is_right ? 1 : 0][message->header.stamp] = message;
      const auto partner = waiting[is_right ? 0 : 1].find(message->header.stamp);
      if (partner == waiting[is_right ? 0 : 1].end()) continue;
      const auto other = partner->second;
      append(pairs, grey(is_right ? other : message, "left"),
             grey(is_right ? message : other, "right"), concat("stamp ", message->header.stamp));
      for (auto& side : waiting) side.erase(side.begin(), side.upper_bound(message->header.stamp));
    }
  } catch (const std::exception& e) {
    throw std::runtime_error(concat(path, ": cannot be used: ", e.what()));
  }
  if (pairs.empty()) {
    throw std::runtime_error(concat(path, ": has no pair of images with one stamp on ", left_topic,
                                    " and ", right_topic));
  }
  return pairs;
}

}  // namespace fpga_stereo::tools
