// simulate: its output equals that of match; errors.
#include <filesystem>
#include <regex>

#include "fpga_stereo/core/parameters.hpp"
#include "programs.hpp"
#include "support/program.hpp"

namespace fpga_stereo::tools {
namespace {

namespace fs = std::filesystem;

const cv::Size kSize(97, 61);
const char* const kModels = FPGA_STEREO_MODELS;

/// Arguments of both programs. The tests build gateware for 16 disparities.
std::vector<std::string> with(std::vector<std::string> arguments,
                              const std::vector<std::string>& more) {
  arguments.insert(arguments.end(), {"--disparity_range", "16", "--speckle_size", "20"});
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

class SimulateUsage : public ProgramTest {
 protected:
  SimulateUsage() {
    const NoisePair pair = noise_pair(kSize, 7);
    left_ = write("left.png", pair.left);
    right_ = write("right.png", pair.right);
  }

  void expect_refused(const Outcome& run, int code, const std::vector<std::string>& parts) const {
    ProgramTest::expect_refused("simulate", run, code, parts);
    EXPECT_FALSE(exists("out.png"));
  }

  void expect_refused(const std::vector<std::string>& more, int code,
                      const std::vector<std::string>& parts) const {
    std::vector<std::string> arguments{left_, right_, at("out.png"), "--models", at("models")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    expect_refused(simulate(arguments), code, parts);
    EXPECT_FALSE(exists("models")) << "refused before any work";
  }

  std::string left_, right_;
};

/// Tests that need a simulated gateware.
class Simulate : public SimulateUsage {
 protected:
  void SetUp() override {
    if (!fs::exists(kModels)) GTEST_SKIP() << "Verilator 5 was missing when the tests were built";
  }

  Outcome simulated(const std::string& out, const std::vector<std::string>& more = {}) const {
    return simulate(with({left_, right_, at(out), "--models", kModels}, more));
  }
  Outcome matched(const std::string& out, const std::vector<std::string>& more = {}) const {
    return match(with({left_, right_, at(out), "--stereo_algorithm", "window"}, more));
  }
  void expect_equal(const std::vector<std::string>& more) const {
    for (const std::string extension : {".png", ".pfm"}) {
      const Outcome run = simulated("simulated" + extension, more);
      ASSERT_EQ(run.code, 0) << run.err;
      EXPECT_EQ(run.out + run.err, "");
      ASSERT_EQ(matched("matched" + extension, more).code, 0);
      EXPECT_EQ(bytes(at("simulated" + extension)), bytes(at("matched" + extension)));
    }
  }
};

TEST_F(Simulate, SameFilesAsMatch) {
  expect_equal({});
  expect_equal({"--min_disparity", "-3", "--subpixel", "false", "--uniqueness_ratio", "12.5"});
}

TEST_F(Simulate, SameFilesAsMatchWithCameraInfo) {
  const InfoPair infos = distorted_cameras(kSize);
  expect_equal({"--left-info", write_info("left.yaml", infos.left), "--right-info",
                write_info("right.yaml", infos.right), "--min_disparity", "4", "--uniqueness_check",
                "false"});
}

TEST_F(Simulate, SameColorPictureAsMatch) {
  ASSERT_EQ(simulated("out.png", {"--color", at("simulated.ppm")}).code, 0);
  ASSERT_EQ(matched("out.png", {"--color", at("matched.ppm")}).code, 0);
  EXPECT_EQ(bytes(at("simulated.ppm")), bytes(at("matched.ppm")));
}

TEST_F(Simulate, Cycles) {
  const Outcome run = simulated("out.png", {"--cycles"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(run.err, "");
  for (const std::string line :
       {"latency +[0-9]+ clocks = [0-9]+\\.[0-9]+ lines.*",
        "clocks per frame +6596, for 5917 pixels and 679 of gap between frames",
        "simulated +[0-9]+ clocks per second",
        "build +width 640, 16 disparities, sparse census 11, correlation 15",
        "line buffer +3 of 102 rows needed; 1020 kbit",
        "mesh +126 of 5120 nodes needed; 320 kbit"}) {
    EXPECT_TRUE(std::regex_search(run.out, std::regex("(^|\n)" + line + "\n"))) << line << " in:\n"
                                                                                << run.out;
  }
  ASSERT_EQ(matched("matched.png").code, 0);
  EXPECT_EQ(bytes(at("out.png")), bytes(at("matched.png")));
}

TEST_F(Simulate, WritesAllSignals) {
  const std::string image = write("small.png", cv::Mat1b(5, 20, std::uint8_t{7}));
  const Outcome run =
      simulate(with({image, image, at("out.png"), "--models", kModels, "--vcd", at("waves.vcd")},
                    {"--census_window_size", "5", "--correlation_window_size", "5"}));
  ASSERT_EQ(run.code, 0) << run.err;
  const std::string vcd = bytes(at("waves.vcd"));
  for (const std::string name : {"$timescale", "u_rectify", "u_speckle", "disparity_o"}) {
    EXPECT_NE(vcd.find(name), std::string::npos) << name;
  }
}

TEST_F(Simulate, ModelsAreCached) {
  fs::create_directories(at("cache"));
  fs::create_directory_symlink(kModels, at("cache/fpga_stereo"));
  const Outcome done = run("env", with({"XDG_CACHE_HOME=" + at("cache"), FPGA_STEREO_SIMULATE,
                                        left_, right_, at("out.png")},
                                       {}));
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_EQ(done.err, "") << "nothing was built";
}

TEST_F(Simulate, LineBufferTooSmall) {
  const InfoPair infos = distorted_cameras(kSize);
  expect_refused({"--disparity_range", "16", "--left-info", write_info("left.yaml", infos.left),
                  "--right-info", write_info("right.yaml", infos.right), "--line-rows", "4"},
                 1, {"left camera", "line buffer", "the buffer has 4"});
}

TEST_F(SimulateUsage, HelpNamesEveryOption) {
  const Outcome run = simulate({"--help"});
  EXPECT_EQ(run.code, 0);
  for (const std::string option : {"LEFT RIGHT OUT", "--left-info", "--right-info", "--color",
                                   "--vcd", "--cycles", "--models", "--line-rows", "default 102",
                                   "104", "--threads", "--verbose", "min_disparity is not added"}) {
    EXPECT_NE(run.out.find(option), std::string::npos) << option;
  }
  for (const ParameterInfo& info : parameter_table()) {
    EXPECT_NE(run.out.find("--" + option_name(info.name) + " "), std::string::npos) << info.name;
  }
  EXPECT_NE(on_one_line(run.out).find("[window or sgm; default window]"), std::string::npos);
}

TEST_F(SimulateUsage, WrongUsage) {
  expect_refused(simulate({left_, right_}), 2, {"OUT is missing"});
  expect_refused(simulate({left_, right_, at("out.jpg")}), 2, {"out.jpg", ".png and .pfm"});
  expect_refused({"--disparity_range", "7"}, 2, {"--disparity-range", "8 to 256 in steps of 4"});
  for (const std::string rows : {"0", "3", "5", "256", "-2"}) {
    expect_refused({"--line-rows=" + rows}, 2,
                   {"--line-rows = " + rows, "allowed 4 to 254 in steps of 2"});
  }
  expect_refused({"--left-info", "left.yaml"}, 2, {"--left-info is given without --right-info"});
  expect_refused({"--cycle"}, 2, {"--cycle"});
}

TEST_F(SimulateUsage, WhatNoGatewareHas) {
  expect_refused({"--stereo_algorithm", "sgm"}, 1,
                 {"stereo_algorithm = sgm: this gateware is built for window only"});
  expect_refused({"--dense", "true"}, 1, {"dense = true: this gateware is built for false only"});
}

TEST_F(SimulateUsage, UnsupportedSizes) {
  const auto refused = [&](cv::Size size, const std::vector<std::string>& parts) {
    const std::string image = write("sized.png", cv::Mat1b(size, std::uint8_t{0}));
    expect_refused(simulate({image, image, at("out.png"), "--models", at("models")}), 1, parts);
    EXPECT_FALSE(exists("models"));
  };
  refused({15, 20}, {"image width = 15", "allows 16 to 640"});
  refused({1281, 20}, {"image width = 1281", "allows 16 to 1280"});
  const std::string image = write("other.png", cv::Mat1b(61, 98, std::uint8_t{0}));
  expect_refused(simulate({left_, image, at("out.png")}), 1,
                 {"97x61", "98x61", "the sizes must be equal"});
}

TEST_F(SimulateUsage, WithoutVerilator) {
  fs::create_directories(at("bin"));
  for (const std::string program : {"bash", "dirname", "nproc"}) {
    fs::create_symlink("/usr/bin/" + program, at("bin/" + program));
  }
  expect_refused(run("env", {"PATH=" + at("bin"), FPGA_STEREO_SIMULATE, left_, right_,
                             at("out.png"), "--models", at("models")}),
                 1, {"build_model: verilator is missing", "install", "cannot be built"});
}

TEST_F(SimulateUsage, UnwritableFolder) {
  write_text("file", "");
  expect_refused(simulate({left_, right_, at("out.png"), "--models", at("file/models")}), 1,
                 {at("file/models"), "cannot be created"});
}

}  // namespace
}  // namespace fpga_stereo::tools
