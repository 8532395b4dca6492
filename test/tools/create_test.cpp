// make_bag create: the contents of the bag.
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sensor_msgs/Image.h>

#include <map>
#include <opencv2/imgproc.hpp>

#include "make_bag/stereo_info.hpp"
#include "programs.hpp"

namespace fpga_stereo::tools {
namespace {

const cv::Size kSize(48, 36);

template <class Message>
using ByTopic = std::map<std::string, std::vector<boost::shared_ptr<Message>>>;

template <class Message>
ByTopic<Message> read(const std::string& path) {
  rosbag::Bag bag(path);
  ByTopic<Message> messages;
  rosbag::View view(bag);
  for (const rosbag::MessageInstance& instance : view) {
    if (const auto message = instance.instantiate<Message>()) {
      EXPECT_EQ(message->header.stamp, instance.getTime());
      messages[instance.getTopic()].push_back(message);
    }
  }
  return messages;
}

class Create : public ProgramTest {
 protected:
  Create() {
    const InfoPair infos = distorted_cameras(kSize);
    info_ = {"--left-info", write_info("left.yaml", infos.left), "--right-info",
             write_info("right.yaml", infos.right)};
    for (const int i : {1, 2, 3}) {
      const NoisePair pair = noise_pair(kSize, 3, i);
      write("left/" + std::to_string(i) + ".png", pair.left);
      write("right/" + std::to_string(i) + ".png", pair.right);
    }
  }

  /// Runs make_bag create with both image folders and the calibration.
  Outcome create(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{"create",   at("out.bag"), "--left",
                                       at("left"), "--right",     at("right")};
    arguments.insert(arguments.end(), info_.begin(), info_.end());
    arguments.insert(arguments.end(), more.begin(), more.end());
    return make_bag(arguments);
  }
  void expect_refused(const Outcome& run, int code, const std::vector<std::string>& parts) const {
    EXPECT_EQ(run.code, code);
    EXPECT_EQ(run.err.rfind("make_bag: ", 0), 0U) << run.err;
    for (const std::string& part : parts) {
      EXPECT_NE(run.err.find(part), std::string::npos) << "\"" << part << "\" in: " << run.err;
    }
    EXPECT_FALSE(exists("out.bag"));
    EXPECT_FALSE(exists("out.bag.active"));
  }

  std::vector<std::string> info_;
};

TEST_F(Create, TopicsStampsAndFrames) {
  const Outcome run =
      create({"--camera", "/rig/stereo", "--rate", "4", "--start", "12.5", "--repeat", "2"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_FALSE(exists("out.bag.active"));
  const auto images = read<sensor_msgs::Image>(at("out.bag"));
  const auto infos = read<sensor_msgs::CameraInfo>(at("out.bag"));
  ASSERT_EQ(images.size(), 2U);
  ASSERT_EQ(infos.size(), 2U);
  for (const std::string side : {"left", "right"}) {
    const auto& side_images = images.at("/rig/stereo/" + side + "/image_raw");
    const auto& side_infos = infos.at("/rig/stereo/" + side + "/camera_info");
    ASSERT_EQ(side_images.size(), 6U);
    ASSERT_EQ(side_infos.size(), 6U);
    for (std::size_t i = 0; i < 6; ++i) {
      EXPECT_EQ(side_images[i]->header.stamp.toNSec(), 12'500'000'000 + i * 250'000'000);
      EXPECT_EQ(side_infos[i]->header.stamp, side_images[i]->header.stamp);
      EXPECT_EQ(side_infos[i]->header.frame_id, "rig_stereo_left_optical_frame");
      EXPECT_EQ(side_images[i]->header.frame_id, "rig_stereo_left_optical_frame");
      EXPECT_EQ(side_images[i]->encoding, "mono8");
      EXPECT_EQ(side_images[i]->data, side_images[i % 3]->data);
    }
    EXPECT_NE(side_images[0]->data, side_images[1]->data);
  }
}

TEST_F(Create, ImagesMayBeFilesAndPatterns) {
  ASSERT_EQ(
      make_bag({"create", at("out.bag"), "--left", at("left/*.png"), "--right", at("right/3.png"),
                at("right/1.png"), at("right/2.png"), "--rectified", "50", "0.2"})
          .code,
      0);
  const auto images = read<sensor_msgs::Image>(at("out.bag"));
  for (const int i : {1, 2, 3}) {  // sorted
    const cv::Mat1b right = noise_pair(kSize, 3, i).right;
    EXPECT_EQ(images.at("/stereo/right/image_raw")[i - 1]->data,
              std::vector<std::uint8_t>(right.begin(), right.end()));
  }
}

TEST_F(Create, RectifiedPairsNeedNoCalibration) {
  ASSERT_EQ(make_bag({"create", at("out.bag"), "--left", at("left"), "--right", at("right"),
                      "--rectified", "50", "0.2"})
                .code,
            0);
  const auto infos = read<sensor_msgs::CameraInfo>(at("out.bag"));
  const auto left = *infos.at("/stereo/left/camera_info")[0];
  const auto right = *infos.at("/stereo/right/camera_info")[0];
  const boost::array<double, 9> K{{50, 0, 23.5, 0, 50, 17.5, 0, 0, 1}};
  const boost::array<double, 9> R{{1, 0, 0, 0, 1, 0, 0, 0, 1}};
  boost::array<double, 12> P{{50, 0, 23.5, 0, 0, 50, 17.5, 0, 0, 0, 1, 0}};
  EXPECT_TRUE(left.K == K && right.K == K && left.R == R && right.R == R);
  EXPECT_EQ(left.D, std::vector<double>(5, 0.0));
  EXPECT_TRUE(left.P == P);
  P[3] = -10;
  EXPECT_TRUE(right.P == P);
}

TEST_F(Create, ScaleResizesImagesAndCalibration) {
  ASSERT_EQ(create({"--scale", "0.5"}).code, 0);
  const auto image = *read<sensor_msgs::Image>(at("out.bag")).at("/stereo/right/image_raw")[0];
  const auto info =
      *read<sensor_msgs::CameraInfo>(at("out.bag")).at("/stereo/right/camera_info")[0];
  EXPECT_EQ(image.width, 24U);
  EXPECT_EQ(image.height, 18U);
  cv::Mat1b small;
  cv::resize(noise_pair(kSize, 3, 1).right, small, {24, 18}, 0, 0, cv::INTER_AREA);
  EXPECT_EQ(image.data, std::vector<std::uint8_t>(small.begin(), small.end()));
  const sensor_msgs::CameraInfo full = distorted_cameras(kSize).right;
  EXPECT_EQ(info.width, 24U);
  EXPECT_EQ(info.height, 18U);
  EXPECT_DOUBLE_EQ(info.K[0], full.K[0] / 2);
  EXPECT_DOUBLE_EQ(info.K[2], (full.K[2] + 0.5) / 2 - 0.5);
  EXPECT_DOUBLE_EQ(info.P[3], full.P[3] / 2);
  EXPECT_DOUBLE_EQ(info.P[6], (full.P[6] + 0.5) / 2 - 0.5);
  EXPECT_EQ(info.D, full.D);
}

TEST_F(Create, RefusesInconsistentPairs) {
  std::remove(at("right/2.png").c_str());
  expect_refused(create({}), 1, {"3 images", "2"});
  write("right/2.png", cv::Mat1b(10, 20, std::uint8_t{0}));
  expect_refused(create({}), 1, {at("right/2.png"), "20x10", "48x36"});
  write_text("right/2.png", "no image");
  expect_refused(create({}), 1, {at("right/2.png")});
}

TEST_F(Create, KeepsTheOldBagIfTheNewOneFails) {
  write_text("right/2.png", "no image");
  write_text("out.bag", "old");
  EXPECT_EQ(create({}).code, 1);
  EXPECT_EQ(bytes(at("out.bag")), "old");
}

TEST_F(Create, RefusesWrongUsage) {
  expect_refused(make_bag({}), 2, {"create, calibrate, extract"});
  expect_refused(make_bag({"copy"}), 2, {"\"copy\"", "create, calibrate, extract"});
  expect_refused(make_bag({"create"}), 2, {"OUT.bag is missing"});
  expect_refused(make_bag({"create", at("out.bag"), "--left", at("left")}), 2, {"--right"});
  expect_refused(make_bag({"create", at("out.bag"), "--left", at("left"), "--right", at("right")}),
                 2, {"--left-info"});
  expect_refused(make_bag({"create", at("out.bag"), "--left", at("left"), "--right", at("right"),
                           "--rectified", "50"}),
                 2, {"--rectified", "FOCAL and BASELINE"});
  expect_refused(make_bag({"create", at("out.bag"), "--euroc", at(""), "--rate", "5"}), 2,
                 {"--rate", "--euroc"});
  expect_refused(create({"--rectified", "50", "0.2"}), 2, {"--rectified"});
  expect_refused(create({"--rate", "0"}), 2, {"--rate = 0", "0.001 to 1000"});
  expect_refused(create({"--start", "0"}), 2, {"--start = 0"});
  expect_refused(create({"--repeat", "0"}), 2, {"--repeat = 0"});
  expect_refused(create({"--scale", "5"}), 2, {"--scale = 5", "0.01 to 4"});
  expect_refused(create({"--camera", "1/x"}), 2, {"--camera \"1/x\""});
}

TEST_F(Create, RefusesDamagedCalibrations) {
  const std::string text = bytes(at("left.yaml"));
  const auto expect_refused_with = [&](const std::string& from, const std::string& to,
                                       const std::string& words) {
    std::string changed = text;
    ASSERT_NE(changed.find(from), std::string::npos) << from;
    write_text("left.yaml", changed.replace(changed.find(from), from.size(), to));
    expect_refused(create({}), 1, {at("left.yaml") + ": " + words});
  };
  // A parser of ROS asserts these sizes, or allocates them.
  expect_refused_with("rows: 3", "rows: 2", "camera_matrix.rows = \"2\": allowed is 3");
  expect_refused_with("cols: 3", "cols: 500000000",
                      "camera_matrix.cols = \"500000000\": allowed is 3");
  expect_refused_with("image_width", "- image_width", "is not ");
}

TEST_F(Create, KeepsBinningAndRegionOfInterest) {
  InfoPair infos = distorted_cameras({2 * kSize.width + 8, kSize.height + 5});
  for (sensor_msgs::CameraInfo* info : {&infos.left, &infos.right}) {
    info->binning_x = 2;
    info->roi.x_offset = 8;
    info->roi.y_offset = 5;
    info->roi.width = static_cast<std::uint32_t>(2 * kSize.width);
    info->roi.height = static_cast<std::uint32_t>(kSize.height);
  }
  write_info("left.yaml", infos.left);
  write_info("right.yaml", infos.right);
  expect_refused(create({"--scale", "0.5"}), 1,
                 {"--scale 0.5: the left camera_info has binning or a region of interest"});
  ASSERT_EQ(create({}).code, 0);
  const auto created = read<sensor_msgs::CameraInfo>(at("out.bag"));
  const auto info = created.at("/stereo/left/camera_info").front();
  EXPECT_EQ(info->binning_x, 2U);
  EXPECT_EQ(info->roi.x_offset, 8U);
  EXPECT_EQ(info->roi.width, infos.left.roi.width);
  ASSERT_EQ(make_bag({"extract", at("out.bag"), at("out")}).code, 0);
  EXPECT_NE(bytes(at("out/right.yaml")).find("binning_x: 2"), std::string::npos);
}

TEST_F(Create, NamesMissingFiles) {
  expect_refused(make_bag({"create", at("out.bag"), "--left", at("no*.png"), "--right", at("right"),
                           "--rectified", "50", "0.2"}),
                 1, {"--left", at("no*.png")});
  info_[1] = at("absent.yaml");
  expect_refused(create({}), 1, {at("absent.yaml")});
  const Outcome run = make_bag({"create", at("no/out.bag"), "--left", at("left"), "--right",
                                at("right"), "--rectified", "50", "0.2"});
  expect_refused(run, 1, {at("no/out.bag")});
}

TEST_F(Create, Help) {
  for (const std::string mode : {"create", "calibrate", "extract"}) {
    const Outcome run = make_bag({mode, "--help"});
    EXPECT_EQ(run.code, 0);
    EXPECT_NE(run.out.find("Usage: make_bag " + mode), std::string::npos);
  }
  EXPECT_EQ(make_bag({"--help"}).code, 0);
}

}  // namespace
}  // namespace fpga_stereo::tools
