// One style of options in all programs: hyphens, -h and --help; older spellings are accepted.
#include <regex>

#include "fpga_stereo/core/parameters.hpp"
#include "programs.hpp"
#include "support/program.hpp"

namespace fpga_stereo::tools {
namespace {

using Strings = std::vector<std::string>;

class Options : public ProgramTest {
 protected:
  /// Every command line that has a help, as program and arguments.
  static std::vector<Strings> commands() {
    std::vector<Strings> all{{FPGA_STEREO_MATCH},         {FPGA_STEREO_SIMULATE},
                             {FPGA_STEREO_EVALUATE},      {FPGA_STEREO_EVALUATE_RAW},
                             {FPGA_STEREO_VIRTUAL_BOARD}, {FPGA_STEREO_MAKE_BAG},
                             {FPGA_STEREO_BOARD},         {FPGA_STEREO_NODE}};
    for (const char* mode : {"create", "calibrate", "extract"}) {
      all.push_back({FPGA_STEREO_MAKE_BAG, mode});
    }
    for (const char* mode : {"list", "probe", "get", "set", "upload", "capture", "measure",
                             "record", "selftest", "compare", "flash", "udev"}) {
      all.push_back({FPGA_STEREO_BOARD, mode});
    }
    return all;
  }
  Outcome run(Strings command, const std::string& argument) const {
    const std::string program = command[0];
    command.erase(command.begin());
    command.push_back(argument);
    return ProgramTest::run(program, command);
  }
};

TEST_F(Options, EveryProgramHasBothHelps) {
  for (const Strings& command : commands()) {
    const std::string name = command.back();
    const Outcome help = run(command, "--help"), h = run(command, "-h");
    EXPECT_EQ(help.code, 0) << name << help.err;
    EXPECT_EQ(help.out.find("Usage: "), 0U) << name << help.out;
    EXPECT_EQ(h.code, 0) << name << h.err;
    EXPECT_EQ(h.out, help.out) << name;
  }
}

TEST_F(Options, HelpsShowHyphensAndNoInternalOptions) {
  const std::regex underscore("--[a-z0-9-]*[_A-Z]");
  for (const Strings& command : commands()) {
    const std::string help = run(command, "--help").out;
    std::smatch found;
    EXPECT_FALSE(std::regex_search(help, found, underscore)) << command.back() << found.str();
    EXPECT_EQ(help.find("positional-arguments"), std::string::npos) << command.back();
  }
}

TEST_F(Options, NamesOfParametersAreSpelledAsOptions) {
  EXPECT_EQ(option_name("disparity_range"), "disparity-range");
  EXPECT_EQ(option_name("disp12MaxDiff"), "disp12-max-diff");
  EXPECT_EQ(option_name("left-info"), "left-info");
}

TEST_F(Options, BothSpellingsOfEveryParameterAreAccepted) {
  const NoisePair pair = noise_pair({40, 30}, 3);
  const std::string left = write("left.png", pair.left), right = write("right.png", pair.right);
  Strings old{left, right, at("old.png")}, present{left, right, at("new.png")};
  Parameters parameters = window_parameters();
  parameters.disparity_range = 32;
  parameters.disp12MaxDiff = 3;
  for (const ParameterInfo& info : parameter_table()) {
    old.push_back("--" + info.name + "=" + to_text(parameters, info));
    present.push_back("--" + option_name(info.name));
    present.push_back(to_text(parameters, info));
  }
  const Outcome old_run = match(old), new_run = match(present);
  EXPECT_EQ(old_run.code, 0) << old_run.err;
  EXPECT_EQ(new_run.code, 0) << new_run.err;
  EXPECT_EQ(bytes(at("old.png")), bytes(at("new.png")));
  expect_refused("match", match({left, right, at("x.png"), "--disparity_range", "7"}), 2,
                 {"--disparity-range = \"7\": allowed 8 to 256"});
  expect_refused("match", match({left, right, at("x.png"), "--left_info", "a.yaml"}), 2,
                 {"--left-info is given without --right-info"});
}

TEST_F(Options, TheNodeHelpsWithoutAMaster) {
  const Outcome help =
      ProgramTest::run("env", {"ROS_MASTER_URI=http://localhost:1", FPGA_STEREO_NODE, "--help"});
  EXPECT_EQ(help.code, 0) << help.err;
  for (const char* part : {"~disparity_range", "~backend", "config/stereo.yaml", "stereo.launch"}) {
    EXPECT_NE(help.out.find(part), std::string::npos) << part;
  }
}

}  // namespace
}  // namespace fpga_stereo::tools
