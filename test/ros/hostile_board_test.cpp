// The running node with a board that lies.
#include "link/hostile_board.hpp"

#include <diagnostic_msgs/DiagnosticArray.h>
#include <gtest/gtest.h>
#include <rosgraph_msgs/Log.h>
#include <sensor_msgs/SetCameraInfo.h>
#include <stereo_msgs/DisparityImage.h>

#include <set>

#include "fpga_stereo/core/spec.hpp"
#include "ros/pty_board.hpp"
#include "ros/rig.hpp"

namespace fpga_stereo::test {
namespace {

using diagnostic_msgs::DiagnosticArray;
using diagnostic_msgs::DiagnosticStatus;
using link::PacketType;
using stereo_msgs::DisparityImage;

bool is_frame_packet(const link::Header& header) {
  return header.type == PacketType::kLeader || header.type == PacketType::kRows ||
         header.type == PacketType::kTrailer;
}

class Hostile : public testing::Test {
 protected:
  static std::string line() {
    std::string path;
    ros::param::get("~line", path);
    return path;
  }
  void SetUp() override { plug_in(); }
  void TearDown() override {
    pty_.reset();
    status_when([](const StereoStatus& s) { return s.link_state == StereoStatus::LINK_CLOSED; });
  }
  void plug_in() {
    auto board = std::make_unique<HostileBoard>(std::make_unique<sim::SoftwareBoard>());
    board_ = board.get();
    pty_ = std::make_unique<PtyBoard>(line(), std::move(board));
    const auto grey = [](const sensor_msgs::Image& image) {
      return cv::Mat1b(static_cast<int>(image.height), static_cast<int>(image.width),
                       const_cast<std::uint8_t*>(image.data.data()), image.step)
          .clone();
    };
    pty_->watch({grey(pair_.left), grey(pair_.right)});
    for (const auto& [side, info] :
         {std::pair("left", pair_.left_info), {"right", pair_.right_info}}) {
      sensor_msgs::SetCameraInfo call;
      call.request.camera_info = info;
      const std::string service = rig_.nh().resolveName(std::string(side) + "/set_camera_info");
      ASSERT_TRUE(ros::service::waitForService(service, ros::Duration(10)));
      ASSERT_TRUE(ros::service::call(service, call) && call.response.success);
    }
  }
  bool has_frames(std::size_t more = 3) {
    const std::size_t before = disparity_.count();
    return eventually([&] { return disparity_.count() >= before + more; });
  }
  StereoStatus status_when(const std::function<bool(const StereoStatus&)>& condition) {
    return rig_.status_when(condition);
  }
  /// Waits for a diagnostic of the node that is not OK and whose text contains `text`.
  bool is_diagnosed(const std::string& text) {
    Listener<DiagnosticArray> diagnostics(rig_.nh(), "/diagnostics");
    return diagnostics.any([&](const DiagnosticArray& array) {
      return std::any_of(array.status.begin(), array.status.end(), [&](const DiagnosticStatus& s) {
        return s.level != DiagnosticStatus::OK && s.message.find(text) != std::string::npos;
      });
    });
  }

  PairMessages pair_ = synthetic_pair({160, 120}, 12, true);
  Rig rig_;
  Listener<DisparityImage> disparity_{rig_.nh(), "disparity"};
  HostileBoard* board_ = nullptr;
  std::unique_ptr<PtyBoard> pty_;
};

// Before, the state was "streaming" and the diagnostics were OK for ever.
TEST_F(Hostile, SilentOutageIsReported) {
  ASSERT_TRUE(has_frames());
  board_->stop_reading(true);
  board_->lie([](link::Header& header, Bytes& payload) {
    header.type = PacketType::kHeartbeat;
    payload.clear();
    return true;
  });
  const auto is_reported = [](const StereoStatus& s) {
    return s.state == StereoStatus::BOARD_TROUBLE && s.board_recoveries > 0;
  };
  EXPECT_TRUE(is_reported(status_when(is_reported)));
  EXPECT_TRUE(is_diagnosed("board: "));
  board_->lie(nullptr);
  board_->stop_reading(false);
  EXPECT_TRUE(has_frames()) << "it recovers";
}

TEST_F(Hostile, FramesOfAnImpossibleTimeAreRefused) {
  ASSERT_TRUE(has_frames());
  board_->lie([](link::Header& header, Bytes&) {
    if (is_frame_packet(header)) header.timestamp += 315576000000000U;  // ten years
    return true;
  });
  const auto is_refused = [](const StereoStatus& s) {
    return s.state_text.find("its time stamp is ") != std::string::npos;
  };
  EXPECT_TRUE(is_refused(status_when(is_refused)));
  const std::size_t before = disparity_.count();
  EXPECT_TRUE(always([&] { return disparity_.count() == before; }));
  EXPECT_TRUE(is_diagnosed("its time stamp is "));
  board_->lie(nullptr);
  EXPECT_TRUE(has_frames());
}

TEST_F(Hostile, AFloodOfPacketsLogsALineOfEachKind) {
  ASSERT_TRUE(has_frames());
  Listener<rosgraph_msgs::Log> log(rig_.nh(), "/rosout");
  ASSERT_TRUE(eventually([&] { return log.count() > 0; }));
  const std::size_t before = log.count();
  std::uint32_t sequence = 0;
  link::Header header;
  header.stream = link::Stream::kDisparity;
  const cv::Mat1w image(1, 16, std::uint16_t{77});
  for (int i = 0; i < 30; ++i) {
    Bytes bytes;
    for (int frame = 0; frame < 500; ++frame) {
      ++header.frame_id;
      const auto foreign = static_cast<std::uint32_t>(header.frame_id + 1000);
      link::append_frame(header, image, foreign, 0, 8192, sequence, bytes);
      link::Header version;
      version.version = static_cast<std::uint8_t>(2 + frame % 200);
      link::append_packet(version, nullptr, 0, bytes);
    }
    board_->say(bytes);
    ros::WallDuration(0.1).sleep();
  }
  EXPECT_LE(log.count() - before, 40U) << "30,000 packets; a slow machine takes more than 10 s";
}

TEST_F(Hostile, AnImpossibleBuildIsRefused) {
  board_->lie([](link::Header& header, Bytes& payload) {
    if (header.type != PacketType::kRegisters) return true;
    for (std::size_t i = 0; i + 8 <= payload.size(); i += 8) {
      if (link::get_u32(&payload[i]) == spec::kRegBuild) link::put_u32(&payload[i + 4], 0);
    }
    return true;
  });
  pty_->plug(false);
  pty_->plug(true);
  const auto is_refused = [](const StereoStatus& s) {
    return s.link_state == StereoStatus::LINK_REFUSED;
  };
  EXPECT_TRUE(is_refused(status_when(is_refused)));
  EXPECT_TRUE(is_diagnosed("the board claims an impossible build: "));
}

}  // namespace
}  // namespace fpga_stereo::test
