// Settings: defaults and ranges equal those of core; values that are not allowed are refused.
#include "ros/settings.hpp"

#include <dynamic_reconfigure/Config.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "ros/board_settings.hpp"

namespace fpga_stereo::test {
namespace {

using Values = std::map<std::string, std::string>;

Values texts(const StereoConfig& config) {
  dynamic_reconfigure::Config message;
  config.__toMessage__(message);
  Values result;
  const auto text = [](auto value) {
    std::ostringstream out;
    out << value;
    return out.str();
  };
  for (const auto& p : message.ints) result[p.name] = text(p.value);
  for (const auto& p : message.doubles) result[p.name] = text(p.value);
  for (const auto& p : message.strs) result[p.name] = p.value;
  for (const auto& p : message.bools) result[p.name] = p.value != 0 ? "true" : "false";
  return result;
}

TEST(Settings, ReconfigureHasTheDefaultsAndRangesOfCore) {
  const auto defaults = texts(StereoConfig::__getDefault__());
  const auto min = texts(StereoConfig::__getMin__());
  const auto max = texts(StereoConfig::__getMax__());
  for (const ParameterInfo& info : parameter_table()) {
    ASSERT_EQ(defaults.count(info.name), 1U) << info.name;
    EXPECT_EQ(defaults.at(info.name), to_text(Parameters(), info)) << info.name;
    const bool number = std::holds_alternative<int Parameters::*>(info.member) ||
                        std::holds_alternative<double Parameters::*>(info.member);
    if (!number) continue;
    EXPECT_EQ(std::stod(min.at(info.name)), info.min) << info.name;
    EXPECT_EQ(std::stod(max.at(info.name)), info.max) << info.name;
  }
}

/// Returns the parameters that the node reads at its start with their defaults, in YAML notation.
Values start_parameters() {
  const BoardSettings board;
  const auto number = [](double value) {
    std::ostringstream text;
    text << value;
    return text.str();
  };
  const SyncSettings sync;
  return {{"sync_tolerance", number(sync.sync_tolerance)},
          {"approximate_sync", sync.approximate_sync ? "true" : "false"},
          {"queue_size", number(sync.queue_size)},
          {"image_transport", "raw"},
          {"backend", "auto"},
          {"device", board.device},
          {"board_input", board.topic_input ? "topics" : "cameras"},
          {"image_width", number(board.image_size.width)},
          {"image_height", number(board.image_size.height)},
          {"left_info_url", "\"" + board.left_url + "\""},
          {"right_info_url", "\"" + board.right_url + "\""},
          {"mid_exposure", number(board.mid_exposure_ms)},
          {"frame_interval", number(board.frame_interval)},
          {"verify", number(board.verify)},
          {"keep_incomplete", board.keep_incomplete ? "true" : "false"},
          {"publish_images", OutputTopics().images ? "true" : "false"}};
}

/// Returns the parameters in a file of the folder config.
Values values_in(const std::string& file) {
  std::ifstream stream(std::string(FPGA_STEREO_CONFIG_DIR) + "/" + file);
  Values values;
  for (std::string line; std::getline(stream, line);) {
    line = line.substr(0, line.find('#'));
    const auto colon = line.find(": ");
    if (colon == std::string::npos) continue;
    std::string value = line.substr(colon + 2);
    value.erase(value.find_last_not_of(' ') + 1);
    values[line.substr(0, colon)] = value;
  }
  return values;
}

/// Returns true if the YAML value means the default.
bool is_default(const std::string& value, const std::string& default_value) {
  const bool is_number =
      std::isdigit(static_cast<unsigned char>(value[0])) != 0 && value != "32FC1";
  return is_number ? std::stod(value) == std::stod(default_value) : value == default_value;
}

/// Returns true if only one algorithm reads the parameter, and not the one of `parameters`.
bool belongs_to_the_other_algorithm(const std::string& name, const Parameters& parameters) {
  const auto starts_with = [&](const char* start) { return name.rfind(start, 0) == 0; };
  return parameters.stereo_algorithm == StereoAlgorithm::kSgm
             ? starts_with("census_") || starts_with("correlation_")
             : starts_with("cost_") || starts_with("sgm_");
}

TEST(Settings, StereoYamlHasEveryParameterWithItsDefault) {
  Values defaults = texts(StereoConfig::__getDefault__());
  defaults.merge(start_parameters());
  // Without stereo_algorithm, a board's build decides. The default of frame_id depends on the name.
  ASSERT_EQ(defaults.erase("stereo_algorithm"), 1U);
  const Values values = values_in("stereo.yaml");
  EXPECT_EQ(values.size(), defaults.size());
  for (const auto& [name, value] : values) {
    ASSERT_EQ(defaults.count(name), 1U) << name;
    EXPECT_TRUE(is_default(value, defaults.at(name))) << name << ": " << value;
  }
}

struct Preset {
  std::string file;
  Values different;  // from the defaults
};

void PrintTo(const Preset& preset, std::ostream* out) { *out << preset.file; }

class Presets : public testing::TestWithParam<Preset> {};

TEST_P(Presets, AreCompleteAndDifferFromTheDefaultsAsDocumented) {
  const Values values = values_in(GetParam().file);
  Parameters parameters;
  Values different;
  for (const auto& [name, value] : values) {
    const Status set = set_parameter(parameters, name, value);
    EXPECT_TRUE(set) << set.error().message;
  }
  for (const ParameterInfo& info : parameter_table()) {
    const bool is_listed = values.count(info.name) != 0;
    EXPECT_NE(is_listed, belongs_to_the_other_algorithm(info.name, parameters)) << info.name;
    const std::string value = to_text(parameters, info);
    if (value != to_text(Parameters(), info)) different[info.name] = value;
  }
  EXPECT_EQ(different, GetParam().different);
}

INSTANTIATE_TEST_SUITE_P(
    Settings, Presets,
    testing::Values(
        Preset{
            "paper.yaml",
            {{"stereo_algorithm", "window"}, {"census_pattern", "full"}, {"speckle_size", "400"}}},
        Preset{"indoor.yaml", {}},
        Preset{"outdoor.yaml",
               {{"disparity_range", "96"},
                {"sgm_p2_strong_edge", "8"},
                {"speckle_size", "100"},
                {"uniqueness_ratio", "10"}}},
        Preset{"noisy.yaml",
               {{"cost_difference_limit", "16"},
                {"cost_outside", "7"},
                {"median_difference", "14"},
                {"sgm_edge", "6"},
                {"sgm_p1", "6"},
                {"speckle_size", "100"}}},
        Preset{"fast.yaml", {{"stereo_algorithm", "window"}, {"speckle_size", "400"}}}));

TEST(Settings, EveryFileInConfigIsTested) {
  std::set<std::string> found;
  for (const auto& entry : std::filesystem::directory_iterator(FPGA_STEREO_CONFIG_DIR)) {
    if (entry.path().extension() == ".yaml") found.insert(entry.path().filename());
  }
  EXPECT_EQ(found, (std::set<std::string>{"fast.yaml", "indoor.yaml", "noisy.yaml", "outdoor.yaml",
                                          "paper.yaml", "stereo.yaml"}));
}

TEST(Settings, RefusedValuesKeepTheOldOnesAndAreNamed) {
  const StereoConfig accepted = StereoConfig::__getDefault__();
  StereoConfig config = accepted;
  config.correlation_window_size = 14;
  config.disparity_range = 66;
  config.cloud_fields = "hsv";
  config.uniqueness_ratio = 20;
  std::vector<std::string> refusals;
  const Settings settings = to_settings(config, accepted, refusals);
  EXPECT_EQ(config.correlation_window_size, 15);
  EXPECT_EQ(config.disparity_range, 64);
  EXPECT_EQ(config.cloud_fields, "rgb");
  EXPECT_EQ(config.uniqueness_ratio, 20);
  EXPECT_EQ(settings.pipeline.correlation_window_size, 15);
  EXPECT_EQ(settings.pipeline.uniqueness_ratio, 20);
  ASSERT_EQ(refusals.size(), 3U);
  EXPECT_EQ(refusals[0], "cloud_fields = hsv: allowed rgb or mono or xyz; using rgb");
  EXPECT_EQ(refusals[1], "correlation_window_size = 14: allowed 5 to 21 in steps of 2; using 15");
  EXPECT_EQ(refusals[2], "disparity_range = 66: allowed 8 to 256 in steps of 4; using 64");
}

TEST(Settings, EveryValueReachesItsSetting) {
  StereoConfig config = StereoConfig::__getDefault__();
  config.min_disparity = 3;
  config.disparity_range = 128;
  config.stereo_algorithm = "window";
  config.sgm_build = "small";
  config.dense = true;
  config.census_window_size = 9;
  config.census_pattern = "full";
  config.correlation_window_size = 11;
  config.cost_difference_limit = 9;
  config.cost_difference_shift = 1;
  config.cost_outside = 5;
  config.cost_shift = 3;
  config.sgm_p1 = 4;
  config.sgm_p2 = 14;
  config.sgm_p2_edge = 11;
  config.sgm_p2_strong_edge = 8;
  config.sgm_edge = 7;
  config.sgm_strong_edge = 15;
  config.left_right_check = false;
  config.disp12MaxDiff = 2;
  config.uniqueness_check = false;
  config.uniqueness_ratio = 12.5;
  config.subpixel = false;
  config.speckle_size = 100;
  config.speckle_range = 4;
  config.median_difference = 5;
  config.cloud_fields = "mono";
  config.cloud_padded = false;
  config.cloud_organized = false;
  config.cloud_decimation = 2;
  config.cloud_max_rate = 7.5;
  config.depth_encoding = "16UC1";
  config.num_threads = 3;
  std::vector<std::string> refusals;
  const Settings s = to_settings(config, StereoConfig::__getDefault__(), refusals);
  EXPECT_TRUE(refusals.empty());
  EXPECT_EQ(s.pipeline.min_disparity, 3);
  EXPECT_EQ(s.pipeline.disparity_range, 128);
  EXPECT_EQ(s.pipeline.stereo_algorithm, StereoAlgorithm::kWindow);
  EXPECT_EQ(s.pipeline.sgm_build, SgmBuild::kSmall);
  EXPECT_TRUE(s.pipeline.dense);
  EXPECT_EQ(s.pipeline.census_window_size, 9);
  EXPECT_EQ(s.pipeline.census_pattern, CensusPattern::kFull);
  EXPECT_EQ(s.pipeline.correlation_window_size, 11);
  EXPECT_EQ(s.pipeline.cost_difference_limit, 9);
  EXPECT_EQ(s.pipeline.cost_difference_shift, 1);
  EXPECT_EQ(s.pipeline.cost_outside, 5);
  EXPECT_EQ(s.pipeline.cost_shift, 3);
  EXPECT_EQ(s.pipeline.sgm_p1, 4);
  EXPECT_EQ(s.pipeline.sgm_p2, 14);
  EXPECT_EQ(s.pipeline.sgm_p2_edge, 11);
  EXPECT_EQ(s.pipeline.sgm_p2_strong_edge, 8);
  EXPECT_EQ(s.pipeline.sgm_edge, 7);
  EXPECT_EQ(s.pipeline.sgm_strong_edge, 15);
  EXPECT_FALSE(s.pipeline.left_right_check);
  EXPECT_EQ(s.pipeline.disp12MaxDiff, 2);
  EXPECT_FALSE(s.pipeline.uniqueness_check);
  EXPECT_EQ(s.pipeline.uniqueness_ratio, 12.5);
  EXPECT_FALSE(s.pipeline.subpixel);
  EXPECT_EQ(s.pipeline.speckle_size, 100);
  EXPECT_EQ(s.pipeline.speckle_range, 4);
  EXPECT_EQ(s.pipeline.median_difference, 5);
  EXPECT_EQ(s.cloud.color, PointColor::kMono);
  EXPECT_FALSE(s.cloud.padded);
  EXPECT_FALSE(s.cloud.organized);
  EXPECT_EQ(s.cloud.decimation, 2);
  EXPECT_EQ(s.cloud_max_rate, 7.5);
  EXPECT_EQ(s.depth_encoding, DepthEncoding::kMillimetres);
  EXPECT_EQ(s.num_threads, 3);
}

}  // namespace
}  // namespace fpga_stereo::test
