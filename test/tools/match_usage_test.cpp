// Errors of match: exit code 2 for wrong usage, 1 for other failures.
#include "fpga_stereo/core/parameters.hpp"
#include "programs.hpp"
#include "support/program.hpp"

namespace fpga_stereo::tools {
namespace {

class MatchUsage : public ProgramTest {
 protected:
  MatchUsage() {
    const NoisePair pair = noise_pair({40, 30}, 3);
    left_ = write("left.png", pair.left);
    right_ = write("right.png", pair.right);
  }

  void expect_refused(const std::vector<std::string>& arguments, int code,
                      const std::vector<std::string>& parts) const {
    ProgramTest::expect_refused("match", match(arguments), code, parts);
  }

  std::string left_, right_;
};

TEST_F(MatchUsage, HelpNamesEveryParameterWithItsRange) {
  const Outcome run = match({"--help"});
  EXPECT_EQ(run.code, 0);
  EXPECT_EQ(run.err, "");
  const std::string text = on_one_line(run.out);
  for (const ParameterInfo& info : parameter_table()) {
    EXPECT_NE(text.find("--" + option_name(info.name) + " "), std::string::npos) << info.name;
    EXPECT_NE(text.find("[" + allowed_values(info)), std::string::npos) << info.name;
    EXPECT_NE(text.find("default " + to_text({}, info) + "]"), std::string::npos) << info.name;
  }
  EXPECT_NE(text.find("min_disparity is not added"), std::string::npos);
}

TEST_F(MatchUsage, LossyOutputIsRefusedFirst) {
  for (const std::string name : {"out.jpg", "out.JPEG", "out.bmp", "out.tiff", "out"}) {
    // The images do not exist: reading them would give another error.
    expect_refused({"no_left.png", "no_right.png", at(name)}, 2, {name, ".png and .pfm"});
    EXPECT_FALSE(exists(name));
  }
  expect_refused({"no_left.png", "no_right.png", at("out.png"), "--color", at("color.nothing")}, 2,
                 {"--color", "color.nothing"});
}

TEST_F(MatchUsage, UpperCaseExtension) { EXPECT_EQ(match({left_, right_, at("out.PNG")}).code, 0); }

TEST_F(MatchUsage, UnreadableFiles) {
  expect_refused({at("absent.png"), right_, at("out.png")}, 1,
                 {at("absent.png"), "No such file or directory"});
  expect_refused({left_, at("absent.png"), at("out.png")}, 1, {at("absent.png")});
  expect_refused({write_text("text.png", "no image"), right_, at("out.png")}, 1,
                 {at("text.png"), "is not an image"});
  expect_refused({write_text("empty.png", ""), right_, at("out.png")}, 1, {at("empty.png")});
  expect_refused({write_text("cut.png", bytes(left_).substr(0, 40)), right_, at("out.png")}, 1,
                 {at("cut.png")});
  const std::string most = bytes(left_).substr(0, bytes(left_).size() * 9 / 10);
  expect_refused({write_text("most.png", most), right_, at("out.png")}, 1, {at("most.png")});
  expect_refused({at(""), right_, at("out.png")}, 1, {"is a folder"});
  EXPECT_FALSE(exists("out.png"));
}

TEST_F(MatchUsage, UnwritableOutput) {
  expect_refused({left_, right_, at("absent/out.png")}, 1, {at("absent/out.png")});
  expect_refused({left_, right_, at("absent/out.pfm")}, 1, {at("absent/out.pfm")});
}

TEST_F(MatchUsage, UnequalSizes) {
  const std::string other = write("other.png", cv::Mat1b(30, 41, std::uint8_t{0}));
  expect_refused({left_, other, at("out.png")}, 1, {left_, other, "40x30", "41x30"});
}

TEST_F(MatchUsage, ExcessiveSize) {
  const std::string large = write("large.png", cv::Mat1b(8, 1921, std::uint8_t{0}));
  expect_refused({large, large, at("out.png")}, 1, {large, "1921x8", "1920x1200"});
}

TEST_F(MatchUsage, WrongNumberOfArguments) {
  expect_refused({}, 2, {"LEFT is missing"});
  expect_refused({left_, right_}, 2, {"OUT is missing"});
  expect_refused({left_, right_, at("out.png"), "more"}, 2, {"\"more\"", "one too many"});
}

TEST_F(MatchUsage, Options) {
  const std::string out = at("out.png");
  expect_refused({left_, right_, out, "--speckle", "3"}, 2, {"--speckle"});  // no abbreviations
  expect_refused({left_, right_, out, "--colour", "x.png"}, 2, {"--colour"});
  expect_refused({left_, right_, out, "--threads", "0"}, 2, {"--threads = 0", "1 to 256"});
  expect_refused({left_, right_, out, "--threads", "two"}, 2, {"--threads", "two"});
  expect_refused({left_, right_, out, "--disparity-range"}, 2, {"--disparity-range"});
  expect_refused({left_, right_, out, "--subpixel", "true", "--subpixel", "true"}, 2,
                 {"--subpixel"});
  EXPECT_FALSE(exists("out.png"));
}

TEST_F(MatchUsage, ParametersOutOfRange) {
  const std::string out = at("out.png");
  expect_refused({left_, right_, out, "--disparity-range", "7"}, 2,
                 {"--disparity-range", "\"7\"", "8 to 256 in steps of 4"});
  expect_refused({left_, right_, out, "--census-window-size", "6"}, 2,
                 {"--census-window-size", "\"6\"", "5 to 11 in steps of 2"});
  expect_refused({left_, right_, out, "--uniqueness-ratio", "nan"}, 2,
                 {"--uniqueness-ratio", "\"nan\"", "0 to 100"});
  expect_refused({left_, right_, out, "--subpixel", "yes"}, 2,
                 {"--subpixel", "\"yes\"", "true or false"});
  expect_refused({left_, right_, out, "--census-pattern", "dense"}, 2,
                 {"--census-pattern", "\"dense\"", "sparse or full"});
}

TEST_F(MatchUsage, Calibrations) {
  const InfoPair infos = distorted_cameras({40, 30});
  const std::string left_info = write_info("left.yaml", infos.left);
  const std::string right_info = write_info("right.yaml", infos.right);
  const std::string out = at("out.png");
  expect_refused({left_, right_, out, "--left-info", left_info}, 2,
                 {"--left-info is given without --right-info"});
  expect_refused({left_, right_, out, "--right-info", right_info}, 2,
                 {"--right-info is given without --left-info"});
  expect_refused({left_, right_, out, "--left-info", left_info, "--right-info", at("no.yaml")}, 1,
                 {at("no.yaml"), "No such file"});
  expect_refused({left_, right_, out, "--left-info", write_text("bad.yaml", "a: ["), "--right-info",
                  right_info},
                 1, {at("bad.yaml"), "not valid YAML"});
  expect_refused({left_, right_, out, "--left-info", write_text("few.yaml", "image_width: 40"),
                  "--right-info", right_info},
                 1, {at("few.yaml"), "is missing"});
  expect_refused({left_, right_, out, "--left-info", right_info, "--right-info", left_info}, 1,
                 {right_info, "swapped"});
  const InfoPair larger = distorted_cameras({80, 60});
  expect_refused({left_, right_, out, "--left-info", write_info("left2.yaml", larger.left),
                  "--right-info", write_info("right2.yaml", larger.right)},
                 1, {left_, "40x30", "80x60"});
}

}  // namespace
}  // namespace fpga_stereo::tools
