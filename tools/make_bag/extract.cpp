// make_bag extract: writes images, calibration and disparities of a bag to files.
#include <fmt/format.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/image_encodings.h>
#include <stereo_msgs/DisparityImage.h>

#include <iomanip>
#include <iostream>
#include <limits>
#include <map>
#include <opencv2/imgproc.hpp>
#include <set>

#include "core/printable.hpp"
#include "make_bag/camera_info_files.hpp"
#include "make_bag/modes.hpp"
#include "ros/conversions.hpp"
#include "ros/image_pixels.hpp"
#include "support/files.hpp"

namespace fpga_stereo::tools {
namespace {

namespace enc = sensor_msgs::image_encodings;
using Stamps = std::set<ros::Time>;

CommandLine command_line() {
  CommandLine line;
  line.usage =
      "Usage: make_bag extract IN.bag OUT_DIR [options]\n"
      "Writes left/NNNNNN.png and right/NNNNNN.png (lossless) for all pairs of images with equal\n"
      "stamps on /CAMERA/left/image_raw and /CAMERA/right/image_raw, in the order of the stamps;\n"
      "left.yaml and right.yaml from camera_info; and, if the bag has /CAMERA/disparity,\n"
      "disparity/NNNNNN.pfm (float, px, inf = no disparity). Reports images without a partner. "
      "Bayer\n"
      "images are written without conversion, in grey.\n";
  line.positional = {"IN.bag", "OUT_DIR"};
  add_camera_option(line.options);
  return line;
}

std::string to_text(const ros::Time& stamp) {
  return fmt::format("{}.{:09d}", stamp.sec, stamp.nsec);
}

/// Returns an image for cv::imwrite. Throws if the conversion would lose data.
cv::Mat to_picture(const sensor_msgs::Image& message) {
  const std::string& encoding = message.encoding;
  const bool known = encoding == enc::TYPE_8UC1 || encoding == enc::TYPE_8UC3 ||
                     encoding == enc::TYPE_16UC1 || enc::isMono(encoding) ||
                     enc::isColor(encoding) || enc::isBayer(encoding);
  if (!known)
    throw std::runtime_error("encoding \"" + printable(encoding) + "\": allowed mono, bgr, rgb, " +
                             "bgra, rgba and bayer of 8 or 16 bits");
  const Result<cv::Mat> pixels = pixels_of(message, "the");
  require(pixels);
  cv::Mat image = *pixels;
  if (encoding == enc::RGB8 || encoding == enc::RGB16) {
    cv::cvtColor(image, image, cv::COLOR_RGB2BGR);
  } else if (encoding == enc::RGBA8 || encoding == enc::RGBA16) {
    cv::cvtColor(image, image, cv::COLOR_RGBA2BGRA);
  }
  return image;
}

/// Returns the disparities in px, infinite where there is none.
cv::Mat1f to_values(const stereo_msgs::DisparityImage& message) {
  const Result<cv::Mat1f> disparities = to_disparities(message);
  require(disparities);
  cv::Mat1f values = disparities->clone();
  // Values below min_disparity mark invalid pixels.
  for (float& value : values) {
    if (!(value >= message.min_disparity)) value = std::numeric_limits<float>::infinity();
  }
  return values;
}

/// Extracts one camera of a bag to a folder.
class Extraction {
 public:
  Extraction(std::string bag_path, std::string folder, const std::string& camera)
      : bag_path_(std::move(bag_path)), folder_(std::move(folder)), prefix_("/" + camera) {
    bag_.open(bag_path_, rosbag::bagmode::Read);
  }

  void run() {
    const Stamps left = stamps<sensor_msgs::Image>(topic("left/image_raw"));
    const Stamps right = stamps<sensor_msgs::Image>(topic("right/image_raw"));
    const Stamps disparities = stamps<stereo_msgs::DisparityImage>(topic("disparity"));
    require_topic(left, "left/image_raw");
    require_topic(right, "right/image_raw");
    for (const ros::Time& stamp : left) {
      if (right.count(stamp) != 0) numbers_.emplace(stamp, numbers_.size());
    }
    report_unpaired(left, "left/image_raw", "no right image");
    report_unpaired(right, "right/image_raw", "no left image");
    report_unpaired(disparities, "disparity", "no pair of images");
    if (numbers_.empty()) throw std::runtime_error("no left and right image have equal stamps");

    for (const std::string side : {"left", "right"}) {
      write<sensor_msgs::Image>(topic(side + "/image_raw"), side, ".png",
                                [](const auto& message) { return to_picture(message); });
      write_info(side);
    }
    if (disparities.empty()) return;
    write<stereo_msgs::DisparityImage>(topic("disparity"), "disparity", ".pfm",
                                       [](const auto& message) { return to_values(message); });
  }

 private:
  std::string topic(const std::string& name) const { return prefix_ + "/" + name; }

  template <class Message>
  Stamps stamps(const std::string& name) {
    Stamps found;
    rosbag::View view(bag_, rosbag::TopicQuery(name));
    for (const rosbag::MessageInstance& instance : view) {
      const auto message = instance.instantiate<Message>();
      if (message == nullptr) {
        throw std::runtime_error(fmt::format("topic {} has messages of type {}: allowed {}", name,
                                             instance.getDataType(),
                                             ros::message_traits::DataType<Message>::value()));
      }
      found.insert(message->header.stamp);
    }
    return found;
  }

  void require_topic(const Stamps& found, const std::string& name) {
    if (!found.empty()) return;
    std::set<std::string> known;
    for (const rosbag::ConnectionInfo* c : rosbag::View(bag_).getConnections()) {
      known.insert(c->topic);
    }
    std::string text = fmt::format("the bag has no messages on {}; its topics are:", topic(name));
    for (const std::string& each : known) text += " " + each;
    throw std::runtime_error(text);
  }

  void report_unpaired(const Stamps& found, const std::string& name, const std::string& missing) {
    for (const ros::Time& stamp : found) {
      if (numbers_.count(stamp) != 0) continue;
      std::cerr << fmt::format("make_bag: {} of {} is skipped: {} has this stamp\n", topic(name),
                               to_text(stamp), missing);
    }
  }

  template <class Message, class Convert>
  void write(const std::string& name, const std::string& subfolder, const std::string& extension,
             const Convert& convert) {
    create_folder(folder_ + "/" + subfolder);
    Progress progress("make_bag", numbers_.size());
    rosbag::View view(bag_, rosbag::TopicQuery(name));
    for (const rosbag::MessageInstance& instance : view) {
      const auto message = instance.instantiate<Message>();
      const auto number = numbers_.find(message->header.stamp);
      if (number == numbers_.end()) continue;
      std::ostringstream path;
      path << folder_ << "/" << subfolder << "/" << std::setw(6) << std::setfill('0')
           << number->second << extension;
      cv::Mat picture;
      try {
        picture = convert(*message);
      } catch (const std::exception& e) {
        throw std::runtime_error(
            fmt::format("{} of {}: {}", name, to_text(message->header.stamp), e.what()));
      }
      write_image(path.str(), picture);
      progress.done(path.str());
    }
  }

  void write_info(const std::string& side) {
    const std::string name = topic(side + "/camera_info");
    rosbag::View view(bag_, rosbag::TopicQuery(name));
    for (const rosbag::MessageInstance& instance : view) {
      const auto info = instance.instantiate<sensor_msgs::CameraInfo>();
      if (info == nullptr) break;
      return write_camera_info(folder_ + "/" + side + ".yaml", side, *info);
    }
    std::cerr << fmt::format("make_bag: the bag has no camera_info on {}: {}.yaml is not written\n",
                             name, side);
  }

  std::string bag_path_, folder_, prefix_;
  rosbag::Bag bag_;
  std::map<ros::Time, std::size_t> numbers_;  // of the pairs, by stamp
};

}  // namespace

void extract_bag(const Arguments& arguments) {
  const auto parsed = parse(command_line(), arguments);
  if (!parsed) return;
  const std::string camera = camera_name(parsed->options);
  const std::string& path = parsed->positional[0];
  try {
    Extraction(path, parsed->positional[1], camera).run();
  } catch (const UsageError&) {
    throw;
  } catch (const std::exception& e) {
    throw std::runtime_error(fmt::format("{}: cannot be extracted: {}", path, e.what()));
  }
}

}  // namespace fpga_stereo::tools
