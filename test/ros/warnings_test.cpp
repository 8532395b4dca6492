// What the node says, and does, if something is wrong when it starts. The nodelet is loaded into
// this process: nothing ends the manager.
#include <gtest/gtest.h>
#include <nodelet/loader.h>
#include <rosgraph_msgs/Log.h>
#include <std_srvs/Trigger.h>
#include <stereo_msgs/DisparityImage.h>

#include "ros/rig.hpp"

namespace fpga_stereo::test {
namespace {

using rosgraph_msgs::Log;

constexpr const char* kName = "/stereo/fpga_stereo";

class Warnings : public testing::Test {
 protected:
  void SetUp() override {
    ros::param::del(kName);
    ASSERT_TRUE(eventually([] {
      ROS_INFO("waiting for the log");
      return log_->count() > 0;
    }));
  }
  void TearDown() override {
    loader_.unload(kName);
    ros::param::del(kName);
    // A running callback keeps the nodelet alive until it returns.
    eventually([] { return !ros::service::exists(std::string(kName) + "/set_parameters", false); });
  }
  static void SetUpTestSuite() {
    ros::NodeHandle nh;
    log_ = std::make_unique<Listener<Log>>(nh, "/rosout");
  }
  static void TearDownTestSuite() { log_.reset(); }

  template <class Value>
  static void set(const std::string& name, const Value& value) {
    ros::param::set(std::string(kName) + "/" + name, value);
  }
  void load() {
    logged_before_ = log_->count();
    ASSERT_TRUE(loader_.load(kName, "fpga_stereo/stereo", {}, {}));
  }
  /// Returns how many messages since load() have this level and contain all parts.
  std::size_t count_logged(std::uint8_t level, const std::vector<std::string>& parts) const {
    std::size_t index = 0;
    return log_->count_if([&](const Log& line) {
      const bool contains = std::all_of(parts.begin(), parts.end(), [&](const std::string& part) {
        return line.msg.find(part) != std::string::npos;
      });
      return index++ >= logged_before_ && line.level == level && contains;
    });
  }
  bool is_logged(std::uint8_t level, const std::vector<std::string>& parts) const {
    return eventually([&] { return count_logged(level, parts) > 0; });
  }

  static std::unique_ptr<Listener<Log>> log_;
  std::size_t logged_before_ = 0;
  Rig rig_;
  nodelet::Loader loader_{false};
};
std::unique_ptr<Listener<Log>> Warnings::log_;

TEST_F(Warnings, AMissingImageTransportIsReplacedByRaw) {
  set("backend", "software");
  set("image_transport", "foo");
  load();
  Listener<stereo_msgs::DisparityImage> disparity(rig_.nh(), "disparity");
  ASSERT_TRUE(rig_.node_listens());
  EXPECT_TRUE(is_logged(Log::ERROR, {"image_transport = foo",
                                     "cannot be loaded; using raw for /stereo/left/image_raw"}));
  EXPECT_TRUE(disparity.with_stamp(rig_.publish(synthetic_pair({160, 120}, 12))));
}

TEST_F(Warnings, ParametersThatAreUnknownOrOutOfRange) {
  set("backend", "software");
  set("disparity_range", 512);
  set("disparty_range", 96);
  set("speckle_size", "many");
  load();
  EXPECT_TRUE(is_logged(Log::WARN, {"parameter disparity_range = 512: allowed 8 to 256 in steps "
                                    "of 4; using 256"}));
  EXPECT_TRUE(is_logged(Log::WARN, {"parameter disparty_range is unknown and has no effect: did "
                                    "you mean disparity_range?"}));
  EXPECT_TRUE(is_logged(Log::ERROR, {"parameter speckle_size = many (text): allowed 0 to"}));
  int range = 0;
  EXPECT_TRUE(ros::param::get(std::string(kName) + "/disparity_range", range));
  EXPECT_EQ(range, 256);
}

TEST_F(Warnings, ABadDeviceIsAnErrorAndOpensNoBoard) {
  set("device", "sreial:/dev/ttyUSB0");
  load();
  EXPECT_TRUE(is_logged(Log::ERROR, {"'sreial:/dev/ttyUSB0' is not a transport",
                                     "usb:serial=NUMBER", "the node opens no board"}));
  EXPECT_TRUE(is_logged(Log::WARN, {"there is no board, so the software makes the disparity",
                                    "'sreial:/dev/ttyUSB0' is not a transport"}));
  const StereoStatus status = rig_.status_when(
      [](const StereoStatus& s) { return s.board.find("sreial") != std::string::npos; });
  EXPECT_EQ(status.board.rfind("none: 'sreial:/dev/ttyUSB0' is not a transport", 0), 0U)
      << status.board;
}

TEST_F(Warnings, ABoardThatIsRequiredIsMissedWithoutASubscriber) {
  set("backend", "board");
  set("device", "serial:/dev/does_not_exist");
  load();
  EXPECT_TRUE(
      is_logged(Log::WARN, {"there is no board, so there is no disparity, because backend is board",
                            "/dev/does_not_exist"}));
  EXPECT_EQ(rig_.status().state, StereoStatus::IDLE);
}

TEST_F(Warnings, ResetFailsWithoutABoard) {
  set("device", "serial:/dev/does_not_exist");
  load();
  std_srvs::Trigger call;
  const std::string service = std::string(kName) + "/reset";
  ASSERT_TRUE(eventually([&] {
    return ros::service::call(service, call) &&
           call.response.message.find("/dev/does_not_exist") != std::string::npos;
  })) << call.response.message;
  EXPECT_FALSE(call.response.success);
  EXPECT_EQ(call.response.message.rfind("no board is connected: ", 0), 0U) << call.response.message;
}

TEST_F(Warnings, ResetFailsWithTheSoftware) {
  set("backend", "software");
  load();
  std_srvs::Trigger call;
  ASSERT_TRUE(ros::service::call(std::string(kName) + "/reset", call));
  EXPECT_FALSE(call.response.success);
  EXPECT_EQ(call.response.message, "there is no board: backend is software");
}

}  // namespace
}  // namespace fpga_stereo::test
