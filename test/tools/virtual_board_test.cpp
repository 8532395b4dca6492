// A virtual board with faults, on USB and with scripts; errors.
#include <chrono>
#include <csignal>
#include <regex>
#include <thread>

#include "board_rig.hpp"
#include "support/program.hpp"

namespace fpga_stereo::tools {
namespace {

using VirtualBoard = BoardTest;

TEST_F(VirtualBoard, CapturesOnlyGoodFramesUnderAllFaults) {
  start({"--flip",      "15",      "--drop",     "15",      "--insert",  "15",
         "--double",    "15",      "--lose",     "15",      "--repeat",  "15",
         "--swap",      "15",      "--truncate", "15",      "--garbage", "15",
         "--both-ways", "--seed",  "5",          "--rate",  "100",       "--unplug",
         "0.9:30",      "--stall", "0.4:60",     "--reset", "1.1"});
  // A reset discards the configuration: upload again. How often one has to depends on the load of
  // this machine, because the board is unplugged by the clock.
  int compared = 0;
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::minutes(3);
  for (int i = 0; compared < 50 && std::chrono::steady_clock::now() < deadline; ++i) {
    const std::string folder = "captured" + std::to_string(i);
    if (board("upload", settings()).code != 0) continue;
    board("capture", {"30", "--out", at(folder), "--timeout", "0.5"});
    if (exists(folder)) compared += expect_matched(folder, true);
  }
  EXPECT_GE(compared, 50);
  EXPECT_EQ(stop(), 0);
  const auto has_printed = [&](const std::string& pattern) {
    return std::regex_search(statistics(), std::regex(pattern));
  };
  EXPECT_TRUE(has_printed("[1-9][0-9]* resets, [1-9][0-9]* times unplugged, [1-9][0-9]* stalls"))
      << statistics();
  EXPECT_TRUE(has_printed("faults to the host: flip [1-9].* lose [1-9]")) << statistics();
}

TEST_F(VirtualBoard, ScriptAndStatistics) {
  write_text("script",
             "# what happens\nat 0.1 stall 20\nat 0.2 unplug 50\n\nflip 3 to-board\n"
             "at 0.3 reset  # and then\nat 1.6 quit\n");
  start({"--script", at("script")});
  EXPECT_EQ(child().wait(), 0);
  for (const std::string text :
       {"[1-9][0-9]* pairs from the cameras", "1 resets, 1 times unplugged, 1 stalls"}) {
    EXPECT_TRUE(std::regex_search(statistics(), std::regex(text))) << statistics();
  }
  EXPECT_FALSE(exists("tty"));
}

TEST_F(VirtualBoard, InterruptsEndBothWithStatistics) {
  start();
  upload();
  {
    const std::string command = "exec " + shell_quoted(FPGA_STEREO_BOARD) + " measure " +
                                shell_quoted(device()) + " --wait 20 --verbose >" +
                                shell_quoted(at("out")) + " 2>" + shell_quoted(at("err"));
    Child measure({"sh", "-c", command}, {}, "sh is missing");
    for (int i = 0; i < 400 && (!exists("err") || bytes(at("err")).empty()); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    measure.send_signal(SIGINT);
    EXPECT_EQ(measure.wait(), 0) << bytes(at("err"));
  }
  EXPECT_NE(bytes(at("out")).find("\ndisparity "), std::string::npos) << bytes(at("out"));
  EXPECT_EQ(stop(), 0);
  EXPECT_NE(statistics().find(" pairs from the cameras"), std::string::npos);
  EXPECT_FALSE(exists("tty"));
}

TEST_F(VirtualBoard, OnUsb) {
  const Strings small{"--max-width",   "64", "--disparities", "16", "--census",     "5",
                      "--correlation", "5",  "--line-rows",   "20", "--mesh-nodes", "600"};
  const auto with_command = [&](const Strings& options, const Strings& command) {
    return run(FPGA_STEREO_VIRTUAL_BOARD, with(with(with({"--usb=AB7"}, small), options),
                                               with({"--", FPGA_STEREO_BOARD}, command)));
  };
  const Outcome listed = with_command({}, {"list"});
  if (listed.err.find("built without umockdev") != std::string::npos) GTEST_SKIP() << listed.err;
  EXPECT_EQ(listed.code, 0) << listed.err;
  EXPECT_EQ(listed.out, "usb:port=1-1  fpga_stereo board, serial number AB7 at port 1-1\n");
  const Outcome tested =
      with_command({"--short", "100", "--empty", "0.1:3", "--halt", "0.5", "--flip", "10"},
                   {"selftest", "usb:serial=AB7", "--pairs", "1", "--wait", "20"});
  EXPECT_EQ(tested.code, 0) << tested.err << tested.out;
  EXPECT_NE(tested.out.find("all: 18432 pixels compared, 0 differ"), std::string::npos);
  const Outcome refused = with_command({"--wrong-hash"}, {"probe", "usb", "--wait", "20"});
  EXPECT_EQ(refused.code, 1);
  EXPECT_NE(refused.err.find("flash the gateware"), std::string::npos) << refused.err;
}

TEST_F(VirtualBoard, FromABag) {
  ASSERT_EQ(make_bag({"create", at("pairs.bag"), "--left", at("images/left"), "--right",
                      at("images/right"), "--left-info", at("left.yaml"), "--right-info",
                      at("right.yaml")})
                .code,
            0);
  const Outcome run = this->run(FPGA_STEREO_VIRTUAL_BOARD,
                                {"--pty", at("tty"), "--bag", at("pairs.bag"), "--rate", "100",
                                 "--script", write_text("script", "at 0.05 quit\n")});
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_NE(run.err.find(" pairs from the cameras"), std::string::npos) << run.err;
  expect_refused("virtual_board",
                 this->run(FPGA_STEREO_VIRTUAL_BOARD,
                           {"--pty", at("tty"), "--bag", at("pairs.bag"), "--camera", "other"}),
                 1, {"equal stamps", "/other/left/image_raw"});
}

TEST_F(VirtualBoard, WrongUsage) {
  const auto refused = [&](const Strings& arguments, int code, const Strings& parts) {
    expect_refused("virtual_board", run(FPGA_STEREO_VIRTUAL_BOARD, arguments), code, parts);
  };
  const std::string tty = at("tty");
  refused({}, 2, {"exactly one of --pty, --usb and --gadget"});
  refused({"--pty", tty, "--gadget"}, 2, {"exactly one of --pty, --usb and --gadget"});
  refused({"--pty", tty, "--", "ls"}, 2, {"allowed for --usb only"});
  refused({"--gadget", "--", "ls"}, 2, {"allowed for --usb only"});
  refused({"--pty", tty, "--engine", "steam"}, 2, {"\"steam\"", "software"});
  refused({"--pty", tty, "--census", "4"}, 2, {"--census", "census_window_size = \"4\""});
  refused({"--pty", tty, "--wrong", "NAME=1"}, 2, {"no register is called \"NAME\""});
  refused({"--pty", tty, "--rate", "5"}, 2, {"--rate needs"});
  refused({"--pty", tty, "--unplug", "5"}, 2, {"unplug"});
  refused({"--pty", tty, "--script", write_text("script", "at 1 explode\n")}, 2,
          {"at 1 explode", "\"explode\" is not an event", "unplug"});
  refused({"--pty", write_text("file", "")}, 1, {at("file"), "is not a symbolic link"});
  write("odd/left/1.png", cv::Mat1b(48, 64, std::uint8_t{0}));
  refused({"--pty", tty, "--folder", at("odd")}, 1, {"odd/right"});
  write("odd/right/1.png", cv::Mat1b(48, 65, std::uint8_t{0}));
  refused({"--pty", tty, "--folder", at("odd")}, 1, {"65x48", "equal size"});
}

}  // namespace
}  // namespace fpga_stereo::tools
