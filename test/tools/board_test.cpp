// board with a virtual board, as users run them.
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <regex>

#include "board_rig.hpp"
#include "core/reference_pipeline.hpp"
#include "fpga_stereo/core/spec.hpp"
#include "ros/conversions.hpp"

namespace fpga_stereo::tools {
namespace {

namespace fs = std::filesystem;

bool has_line(const std::string& text, const std::string& pattern) {
  return std::regex_search(text, std::regex("(^|\n)" + pattern + "\n"));
}

TEST_F(BoardTest, ProbeGetAndSet) {
  start();
  const Outcome probed = board("probe");
  ASSERT_EQ(probed.code, 0) << probed.err;
  for (const std::string line :
       {"line +.*/tty at 1000000 baud", "gateware +0\\.1, specification 0x[0-9A-F]{8}",
        "max_width +64 px", "disparities +16", "census +sparse 5 px", "correlation +5 px",
        "line buffer +20 rows", "mesh +600 nodes", "clock +100 MHz",
        "streams +disparity, left, right, raw_left, raw_right; accepts pairs from the host",
        "configured +not yet.*", "round trip +[0-9.]+ ms at best.*"}) {
    EXPECT_TRUE(has_line(probed.out, line)) << line << " in:\n" << probed.out;
  }

  for (const Strings& line :
       {Strings{at("tty"), "--wait", "20"}, Strings{"--wait", "20", at("tty")},
        Strings{"--device", at("tty"), "--wait", "20"},
        Strings{"--wait", "20", "--device=" + device()}}) {
    const Outcome again = board_alone(with({"probe"}, line));
    EXPECT_EQ(again.code, 0) << again.err;
    EXPECT_TRUE(has_line(again.out, "disparities +16")) << again.out;
  }

  const Outcome set =
      board("set", {"HEIGHT=0x30", "FLAGS.subpixel=0", "ERRORS=1", "CONTROL.clear=1"});
  EXPECT_EQ(set.code, 0) << set.err;
  EXPECT_TRUE(has_line(set.out, "written and read back: HEIGHT = 0x00000030.*")) << set.out;
  EXPECT_TRUE(has_line(set.out, "CONTROL: 0x00000002 was written; it cannot be read back"));
  const Outcome got = board("get", {"HEIGHT", "FLAGS", "BUILD_LINE_ROWS"});
  EXPECT_EQ(got.code, 0) << got.err;
  EXPECT_TRUE(has_line(got.out, "  HEIGHT.rows = 48 .*")) << got.out;
  EXPECT_TRUE(has_line(got.out, "FLAGS = 0x00000003 .*")) << got.out;
  EXPECT_TRUE(has_line(got.out, "  FLAGS.subpixel = 0 .*\\(subpixel\\)")) << got.out;
  EXPECT_TRUE(has_line(got.out, "BUILD_LINE_ROWS = 0x00000014 \\(20\\) .*")) << got.out;
  const Outcome all = board("get", {"--all"});
  for (const spec::Register& reg : spec::register_table()) {
    const bool shown = all.out.find(std::string(reg.name) + " = ") != std::string::npos;
    EXPECT_EQ(shown, reg.access != spec::Access::kWriteOnly) << reg.name;
  }
}

TEST_F(BoardTest, CaptureEqualsMatch) {
  start();
  expect_refused("board", board("capture", {"1", "--out", at("none")}), 1,
                 {"has not been configured", "board upload"});
  const Outcome uploaded = board("upload", settings());
  ASSERT_EQ(uploaded.code, 0) << uploaded.err;
  EXPECT_TRUE(has_line(uploaded.out,
                       "configuration 1 was sent and read back: 64x48, line buffer [0-9]+ of "
                       "20 rows, mesh 63 of 600 nodes"))
      << uploaded.out;
  EXPECT_TRUE(has_line(uploaded.out, "  speckle_size = 20"));

  const Outcome run = board("capture", {"5", "--out", at("captured"), "--streams",
                                        "disparity,left,right,raw_left,raw_right"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_TRUE(has_line(run.out, "disparity +5 frames, .* f/s")) << run.out;
  EXPECT_EQ(expect_matched("captured"), 5);
  for (const char* name : {"1", "2", "3", "4", "5"}) {
    EXPECT_TRUE(exists(std::string("captured/disparity/") + name + ".png")) << name;
  }

  // All files of all streams equal the pipeline.
  const auto rectification =
      make_stereo_rectification(*to_calibration(distorted_cameras(kSize).left, "left"),
                                *to_calibration(distorted_cameras(kSize).right, "right"), 1);
  ASSERT_TRUE(rectification);
  ReferencePipeline pipeline;
  Parameters parameters;
  for (const auto& entry : fs::directory_iterator(at("captured/left"))) {
    const std::string name = entry.path().filename().string();
    const auto read = [&](const std::string& stream) {
      return cv::imread(at("captured/" + stream + "/" + name), cv::IMREAD_UNCHANGED);
    };
    const cv::Mat raw = read("raw_left");
    std::size_t i = 0;
    while (i < pairs_.size() && !equal(raw, pairs_[i].left)) ++i;
    ASSERT_LT(i, pairs_.size()) << name;
    EXPECT_TRUE(equal(read("raw_right"), pairs_[i].right));
    const Taps& taps =
        pipeline.process(pairs_[i].left, pairs_[i].right, *rectification, parameters, 1);
    EXPECT_TRUE(equal(read("left"), taps.left));
    EXPECT_TRUE(equal(read("right"), taps.right));
  }
  const std::string table = bytes(at("captured/frames.csv"));
  EXPECT_EQ(table.find("file,frame_id,configuration,board_us,stamp,dropped\n"), 0U);
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 6);
  EXPECT_TRUE(has_line(table, "3\\.png,[0-9]+,1,[0-9]+,[0-9]+\\.[0-9]{6},\"\"")) << table;
}

TEST_F(BoardTest, CapturesARecording) {
  start();
  upload();
  const Outcome recorded = board("record", {at("line.rec"), "0.4", "--streams", "disparity,left"});
  ASSERT_EQ(recorded.code, 0) << recorded.err;
  EXPECT_TRUE(has_line(recorded.out, "watchdog +purge 0, restart 0, reopen 0, reset 0, opened 1.*"))
      << recorded.out;
  EXPECT_TRUE(has_line(recorded.out, "latency +median .*")) << recorded.out;
  EXPECT_EQ(stop(), 0);

  const std::string replay = "replay:" + at("line.rec") + ":0";
  const Outcome measured = board_alone({"measure", replay, "--streams", "disparity,left"});
  ASSERT_EQ(measured.code, 0) << measured.err;
  std::smatch frames;
  ASSERT_TRUE(std::regex_search(recorded.out, frames, std::regex("disparity +([0-9]+) frames")));
  EXPECT_GT(std::stoi(frames[1]), 3);
  EXPECT_TRUE(has_line(measured.out,
                       "packets +[0-9]+ good, 0 lost, 0 bad headers, 0 bad "
                       "payloads, 0 bytes skipped"))
      << measured.out;
  EXPECT_TRUE(has_line(measured.out, "dropped +0 by the board .*, 0 impossible time stamp, .*"))
      << measured.out;
  for (const std::string folder : {"first", "second"}) {
    const Outcome run =
        board_alone({"capture", replay, "4", "--out", at(folder), "--streams", "disparity,left"});
    ASSERT_EQ(run.code, 0) << run.err;
  }
  EXPECT_EQ(expect_matched("first"), 4);
  EXPECT_EQ(expect_matched("second"), 4);
  EXPECT_EQ(bytes(at("first/frames.csv")), bytes(at("second/frames.csv")));
  expect_refused("board", board_alone({"record", replay, at("x")}), 2, {"is a recording already"});
  const Outcome more = board_alone({"capture", replay, "9999", "--out", at("more")});
  EXPECT_EQ(more.code, 1);
  EXPECT_NE(more.err.find("of 9999 frame sets: the recording has ended"), std::string::npos)
      << more.err;
}

TEST_F(BoardTest, CompareFindsTheFirstStageThatDiffers) {
  start();
  const Strings pair{at("images/left/0.png"), at("images/right/0.png")};
  const Outcome equal = board("compare", with(pair, settings()));
  ASSERT_EQ(equal.code, 0) << equal.err << equal.out;
  EXPECT_TRUE(has_line(equal.out, "rectify +board (0x[0-9A-F]{8}), software \\2: equal"))
      << equal.out;
  EXPECT_TRUE(has_line(equal.out, "all 7 stages are equal")) << equal.out;
  const Outcome textured = board("compare", {"--speckle-size", "30"});
  EXPECT_EQ(textured.code, 0) << textured.err << textured.out;
  expect_refused("board", board("compare", with(pair, {"--size", "32x32"})), 1,
                 {"0.png is 64x48", "32x32"});
  EXPECT_EQ(stop(), 0);

  start({"--wrong", "SIGNATURE_SELECT=1", "SIGNATURE_SPECKLE=2"});
  const Outcome wrong = board("compare", with(pair, settings()));
  EXPECT_EQ(wrong.code, 1);
  EXPECT_NE(wrong.err.find("select is the first stage of this board that differs"),
            std::string::npos)
      << wrong.err;
  EXPECT_TRUE(has_line(wrong.out, "match .*: equal")) << wrong.out;
  EXPECT_TRUE(has_line(wrong.out, "select +board 0x00000001, software .*: different")) << wrong.out;
  EXPECT_TRUE(has_line(wrong.out, "check .*: equal")) << wrong.out;
}

TEST_F(BoardTest, SelfTest) {
  start();
  const Outcome run = board("selftest", {"--pairs", "2"});
  ASSERT_EQ(run.code, 0) << run.err << run.out;
  EXPECT_TRUE(has_line(run.out, "seed 2, 64x48, rectified: 9216 pixels compared, 0 differ"));
  EXPECT_TRUE(has_line(run.out, "all: 36864 pixels compared, 0 differ; 0 pairs were lost.*"))
      << run.out;
}

TEST_F(BoardTest, RefusesUnsupportedSettings) {
  start({"--streams", "14", "--line-rows", "4"});
  expect_refused("board", board("upload", settings()), 1,
                 {"does not support these settings", "line buffer", "the buffer has 4"});
  expect_refused("board", board("upload", {"--size", "96x48"}), 1, {"width", "96", "64"});
  expect_refused("board", board("upload", {"--size", "64x48", "--disparity_range", "32"}), 1,
                 {"disparity_range = 32", "16"});
  expect_refused("board", board("upload", {"--size", "64x48", "--stereo_algorithm", "sgm"}), 1,
                 {"stereo_algorithm = sgm: this gateware is built for window only"});
  expect_refused("board", board("upload", {"--size", "64x48", "--dense", "true"}), 1,
                 {"dense = true: this gateware is built for false only"});
  expect_refused("board", board("selftest"), 1, {"accepts no pairs from the host"});
  EXPECT_EQ(board("upload", {"--size", "64x48"}).code, 0);
  expect_refused("board", board("measure", {"1", "--streams", "raw_left"}), 1,
                 {"not built with stream raw_left"});
}

TEST_F(BoardTest, RefusesIncompatibleBoards) {
  const std::vector<std::pair<Strings, Strings>> cases{
      {{"--wrong-hash"}, {"was built for specification", "flash the gateware"}},
      {{"--wrong-identity"}, {"the device is not an fpga_stereo board", "IDENTITY = 0x12345678"}},
      {{"--wrong-version"}, {"gateware has version 1.0", "flash the gateware"}},
      {{"--packet-version", "2"}, {"packets have version 2"}},
  };
  for (const auto& [options, message] : cases) {
    start(options);
    expect_refused("board", board("probe"), 1, message);
    EXPECT_EQ(stop(), 0);
  }
  start({"--wrong", "SPECKLE_SIZE=7"});
  const Outcome held = board("upload", {"--size", "64x48"});
  EXPECT_EQ(held.code, 1);
  EXPECT_NE(held.err.find("SPECKLE_SIZE"), std::string::npos) << held.err;
  EXPECT_NE(board("set", {"SPECKLE_SIZE=9"})
                .err.find("register SPECKLE_SIZE holds 0x00000007 after 0x00000009 was written"),
            std::string::npos);
}

}  // namespace
}  // namespace fpga_stereo::tools
