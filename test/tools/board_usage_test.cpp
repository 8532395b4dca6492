// Errors of board before it opens a board, and the modes that need no board.
#include <filesystem>
#include <sstream>

#include "board_rig.hpp"

namespace fpga_stereo::tools {
namespace {

namespace fs = std::filesystem;

using BoardUsage = BoardTest;

TEST_F(BoardUsage, EveryModeHasHelp) {
  const Outcome all = board_alone({"--help"});
  EXPECT_EQ(all.code, 0);
  for (const std::string mode : {"list", "probe", "get", "set", "upload", "capture", "measure",
                                 "record", "selftest", "compare", "flash", "udev"}) {
    EXPECT_NE(all.out.find("\n  " + mode + " "), std::string::npos) << mode;
  }
  for (const std::string mode : {"set", "capture"}) {
    const Outcome help = board_alone({mode, "--help"});
    EXPECT_EQ(help.code, 0);
    EXPECT_EQ(help.out.find("Usage: board " + mode), 0U) << help.out;
  }
}

TEST_F(BoardUsage, WrongUsage) {
  const auto refused = [&](const Strings& arguments, const Strings& parts) {
    expect_refused("board", board_alone(arguments), 2, parts);
  };
  refused({}, {"a mode is missing", "selftest"});
  refused({"probe", "pcie:0"}, {"'pcie:0' is not a transport", "serial:PATH"});
  refused({"probe", "--device", "pcie:0"}, {"'pcie:0' is not a transport"});
  refused({"probe", "usb", "--device", "usb:serial=1"}, {"two devices are given", "usb:serial=1"});
  refused({"probe", "replay:" + at("x")}, {"a recording answers no requests", "capture"});
  refused({"compare", "one.png"}, {"1 image files are given: allowed 2"});
  refused({"get", "WIDHT"}, {"no register is called \"WIDHT\"", "did you mean WIDTH"});
  refused({"get", "CONTROL"}, {"CONTROL is write only"});
  refused({"set", "STATUS=1"}, {"STATUS is read only"});
  refused({"set", "WIDTH=0x1000"}, {"WIDTH = 0x00001000", "0x00000FFF"});
  refused({"set", "FLAGS.subpixels=1"}, {"no field \"subpixels\"", "did you mean subpixel"});
  refused({"set", "FLAGS.subpixel=2"}, {"allowed 0 to 1"});
  refused({"upload"}, {"--left-info (or --size) is missing"});
  refused({"upload", "--size", "64"}, {"--size = \"64\"", "16x1 to 1280x1200"});
  refused({"capture", "0", "--out", at("x")}, {"N = \"0\""});
  refused({"capture", "5"}, {"--out is missing"});
  refused({"capture", "5", "--out", at("x"), "--streams", "depth"}, {"\"depth\" is not a stream"});
}

TEST_F(BoardUsage, NoBoard) {
  expect_refused("board", board_alone({"probe", device()}), 1, {at("tty"), "cannot be opened"});
  expect_refused("board", board_alone({"measure", "replay:" + at("none")}), 1,
                 {at("none"), "cannot be opened"});
  // Paths and --device, as people type them.
  for (const Strings& line :
       {Strings{"/dev/does_not_exist"}, Strings{"--wait", "1", "/dev/does_not_exist"},
        Strings{"--device", "/dev/does_not_exist"},
        Strings{"--device=serial:/dev/does_not_exist"}}) {
    expect_refused("board", board_alone(with({"probe"}, line)), 1,
                   {"/dev/does_not_exist", "cannot be opened"});
  }
  write_text("text", "no recording\n");
  expect_refused("board", board_alone({"measure", "replay:" + at("text")}), 1,
                 {"is not a recording of a link"});
}

TEST_F(BoardUsage, UdevRule) {
  const Outcome printed = board_alone({"udev"});
  EXPECT_EQ(printed.code, 0);
  EXPECT_EQ(printed.out, bytes(FPGA_STEREO_RULES));
  fs::create_directories(at("rules.d"));
  const Outcome installed = board_alone({"udev", "--install", "--folder", at("rules.d")});
  EXPECT_EQ(installed.code, 0) << installed.err;
  EXPECT_EQ(bytes(at("rules.d/70-fpga-stereo.rules")), printed.out);
  expect_refused("board", board_alone({"udev", "--install", "--folder", at("none")}), 1,
                 {at("none") + "/70-fpga-stereo.rules: cannot be written"});
}

TEST_F(BoardUsage, UdevRuleIsForBoardsAlone) {
  std::istringstream rules(bytes(FPGA_STEREO_RULES));
  int count = 0;
  for (std::string line; std::getline(rules, line);) {
    if (line.find("\"6014\"") == std::string::npos) continue;
    ++count;
    EXPECT_NE(line.find("ATTR{manufacturer}==\"fpga_stereo\""), std::string::npos) << line;
  }
  EXPECT_EQ(count, 1);
}

TEST_F(BoardUsage, Flash) {
  const std::string file = write_text("-core 1;.bit", "bits");
  const auto flash = [&](const std::string& path, const Strings& arguments) {
    return run("env", with({"PATH=" + path, FPGA_STEREO_BOARD, "flash"}, arguments));
  };
  expect_refused("board", flash(at("bin"), {file}), 1,
                 {"openFPGALoader is missing", "apt install openfpgaloader"});
  write_text("bin/openFPGALoader", "#!/bin/sh\nfor a; do echo \"[$a]\"; done\nexit $CODE\n");
  fs::permissions(at("bin/openFPGALoader"), fs::perms::owner_all);
  const Outcome done = flash(at("bin"), {file});
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_EQ(done.out, "[--board]\n[ulx3s]\n[" + file + "]\n");
  const Outcome failed =
      run("env", {"CODE=3", "PATH=" + at("bin"), FPGA_STEREO_BOARD, "flash", file});
  EXPECT_EQ(failed.code, 1);
  EXPECT_NE(failed.err.find("openFPGALoader ended with code 3"), std::string::npos);
  expect_refused("board", board_alone({"flash", at("none.bit")}), 1, {"none.bit: cannot be read"});
}

}  // namespace
}  // namespace fpga_stereo::tools
