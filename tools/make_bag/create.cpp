// make_bag create: writes image files and a calibration to a bag.
#include <fmt/format.h>
#include <rosbag/bag.h>

#include <filesystem>
#include <iostream>
#include <opencv2/imgproc.hpp>
#include <regex>

#include "make_bag/camera_info_files.hpp"
#include "make_bag/modes.hpp"
#include "make_bag/sources.hpp"
#include "ros/conversions.hpp"
#include "support/files.hpp"

namespace fpga_stereo::tools {
namespace {

namespace fs = std::filesystem;
namespace po = boost::program_options;
using Strings = std::vector<std::string>;

CommandLine command_line() {
  CommandLine line;
  line.usage =
      "Usage: make_bag create OUT.bag --left IMAGES --right IMAGES\n"
      "                       --left-info YAML --right-info YAML [options]\n"
      "       make_bag create OUT.bag --left IMAGES --right IMAGES\n"
      "                       --rectified FOCAL BASELINE [options]\n"
      "       make_bag create OUT.bag --euroc DIR [options]\n"
      "Writes a bag with image_raw (mono8 or bgr8, depending on the files) and camera_info in\n"
      "/CAMERA/left and /CAMERA/right. Both images of a pair have the same stamp. IMAGES are "
      "files,\n"
      "folders or quoted patterns. Both sides are sorted by name; the n-th left and the n-th "
      "right\n"
      "image form a pair.\n";
  line.positional = {"OUT.bag"};
  const auto option = [&](const char* name, auto* value, const char* about) {
    line.options.add_options()(name, value, about);
  };
  option("left", po::value<Strings>()->multitoken()->value_name("IMAGES"), "left images");
  option("right", po::value<Strings>()->multitoken()->value_name("IMAGES"), "right images");
  option("left-info", po::value<std::string>()->value_name("YAML"),
         "camera_info file of the left camera");
  option("right-info", po::value<std::string>()->value_name("YAML"),
         "camera_info file of the right camera");
  option("rectified", po::value<std::vector<double>>()->multitoken()->value_name("FOCAL BASELINE"),
         "the images are rectified already: focal length in px and baseline in m");
  option("euroc", po::value<std::string>()->value_name("DIR"),
         "folder of the EuRoC MAV dataset with cam0 and cam1; its file names are the stamps");
  option("rate", po::value<double>()->value_name("HZ")->default_value(10),
         "pairs per second [0.001 to 1000]; not with --euroc");
  option("start", po::value<double>()->value_name("SECONDS")->default_value(1000),
         "stamp of the first pair [1 to 4000000000]; not with --euroc");
  option("repeat", po::value<int>()->value_name("N")->default_value(1),
         "write the sequence N times in a row [1 to 100000]");
  option("scale", po::value<double>()->value_name("FACTOR")->default_value(1),
         "resize images and calibration [0.01 to 4]");
  add_camera_option(line.options);
  return line;
}

/// Throws UsageError unless the options name exactly one complete source.
void require_one_source(const po::variables_map& options) {
  const auto given = [&](const char* name) {
    return options.count(name) != 0 && !options[name].defaulted();
  };
  if (given("euroc")) {
    for (const char* other :
         {"left", "right", "left-info", "right-info", "rectified", "rate", "start"}) {
      if (given(other)) {
        throw UsageError(fmt::format(
            "--{} is not allowed together with --euroc, which has images, calibration and "
            "stamps of its own",
            other));
      }
    }
    return;
  }
  for (const char* side : {"left", "right"}) {
    if (!given(side)) throw UsageError(fmt::format("--{} (or --euroc) is missing", side));
  }
  if (given("rectified")) {
    if (given("left-info") || given("right-info")) {
      throw UsageError("--rectified is not allowed together with --left-info and --right-info");
    }
    return;
  }
  for (const char* info : {"left-info", "right-info"}) {
    if (!given(info)) throw UsageError(fmt::format("--{} (or --rectified) is missing", info));
  }
}

StereoSource file_source(const po::variables_map& options) {
  const double rate = options["rate"].as<double>();
  const double start = options["start"].as<double>();
  require_range("--rate", rate, 0.001, 1000);
  require_range("--start", start, 1, 4e9);
  std::vector<double> rectified;
  if (options.count("rectified") != 0) {
    rectified = options["rectified"].as<std::vector<double>>();
    if (rectified.size() != 2) {
      throw UsageError(fmt::format("--rectified has {} numbers: allowed 2, FOCAL and BASELINE",
                                   rectified.size()));
    }
    require_range("--rectified FOCAL", rectified[0], 1, 1e6);
    require_range("--rectified BASELINE", rectified[1], 1e-6, 1e6);
  }
  StereoSource source =
      pair_files(list_images("--left", options["left"].as<Strings>()),
                 list_images("--right", options["right"].as<Strings>()), rate, start);
  if (!rectified.empty()) {
    const cv::Size size = read_image(source.frames[0].left).size();
    source.info = rectified_info(size, rectified[0], rectified[1]);
  } else {
    source.info = {read_camera_info_message(options["left-info"].as<std::string>()),
                   read_camera_info_message(options["right-info"].as<std::string>())};
  }
  return source;
}

/// Reads an image. Throws unless it has the size in its camera_info.
cv::Mat read_checked(const std::string& path, const sensor_msgs::CameraInfo& info) {
  cv::Mat image = read_image(path);
  const auto calibration = to_calibration(info, path + ":");
  require(calibration);
  const cv::Size size = calibration->image_size();
  if (image.size() != size) {
    throw std::runtime_error(fmt::format("{}: is {}x{}, but its camera_info says {}x{}", path,
                                         image.cols, image.rows, size.width, size.height));
  }
  return image;
}

class BagWriter {
 public:
  /// Until the bag is complete, its name has the suffix .active, as with rosbag record.
  BagWriter(std::string path, std::string camera, double scale)
      : path_(std::move(path)),
        active_(path_ + ".active"),
        camera_(std::move(camera)),
        scale_(scale) {
    frame_id_ = std::regex_replace(camera_, std::regex("/"), "_") + "_left_optical_frame";
    bag_.open(active_, rosbag::bagmode::Write);
  }
  ~BagWriter() {
    if (is_complete_) return;
    try {
      bag_.close();
    } catch (const std::exception&) {
      // The bag is deleted anyway.
    }
    std::error_code ignored;
    fs::remove(active_, ignored);
  }
  BagWriter(const BagWriter&) = delete;
  BagWriter& operator=(const BagWriter&) = delete;

  void write(const FramePaths& frame, const StereoInfo& info) {
    write_side("left", frame.stamp_ns, frame.left, info.left);
    write_side("right", frame.stamp_ns, frame.right, info.right);
    ++seq_;
  }
  void finish() {
    bag_.close();
    fs::rename(active_, path_);
    is_complete_ = true;
  }

 private:
  void write_side(const std::string& side, std::int64_t stamp_ns, const std::string& path,
                  sensor_msgs::CameraInfo info) {
    cv::Mat image = read_checked(path, info);
    if (scale_ != 1) {
      if (info.binning_x > 1 || info.binning_y > 1 || info.roi.width != 0) {
        throw std::runtime_error(fmt::format(
            "--scale {}: the {} camera_info has binning or a region of interest", scale_, side));
      }
      const cv::Size size(std::max(1, cvRound(image.cols * scale_)),
                          std::max(1, cvRound(image.rows * scale_)));
      cv::resize(image, image, size, 0, 0, cv::INTER_AREA);
      resize(size, info);
    }
    // image_geometry requires the same frame for both cameras.
    info.header.frame_id = frame_id_;
    info.header.seq = seq_;
    info.header.stamp.fromNSec(static_cast<std::uint64_t>(stamp_ns));
    const std::string topic = "/" + camera_ + "/" + side;
    bag_.write(topic + "/camera_info", info.header.stamp, info);
    bag_.write(topic + "/image_raw", info.header.stamp, to_image(image, info.header));
  }

  std::string path_, active_, camera_, frame_id_;
  double scale_;
  std::uint32_t seq_ = 0;
  rosbag::Bag bag_;
  bool is_complete_ = false;
};

}  // namespace

void create_bag(const Arguments& arguments) {
  const auto parsed = parse(command_line(), arguments);
  if (!parsed) return;
  const po::variables_map& options = parsed->options;
  const std::string& path = parsed->positional[0];
  const std::string camera = camera_name(options);
  const int repeat = options["repeat"].as<int>();
  const double scale = options["scale"].as<double>();
  require_range("--repeat", repeat, 1, 100000);
  require_range("--scale", scale, 0.01, 4);
  require_one_source(options);
  const StereoSource source = options.count("euroc") != 0
                                  ? read_euroc(options["euroc"].as<std::string>())
                                  : file_source(options);

  Progress progress("make_bag", source.frames.size() * static_cast<std::size_t>(repeat));
  try {
    BagWriter bag(path, camera, scale);
    for (int pass = 0; pass < repeat; ++pass) {
      for (FramePaths frame : source.frames) {
        frame.stamp_ns += pass * source.duration_ns;
        bag.write(frame, source.info);
        progress.done(frame.left);
      }
    }
    bag.finish();
  } catch (const rosbag::BagException& e) {
    throw std::runtime_error(fmt::format("{}: cannot be written: {}", path, e.what()));
  }
}

}  // namespace fpga_stereo::tools
