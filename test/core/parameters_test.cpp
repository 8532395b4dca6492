#include "fpga_stereo/core/parameters.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace fpga_stereo::test {
namespace {

bool is_integer(const ParameterInfo& info) {
  return std::holds_alternative<int Parameters::*>(info.member);
}

bool is_number(const ParameterInfo& info) {
  return is_integer(info) || std::holds_alternative<double Parameters::*>(info.member);
}

const ParameterInfo& info_of(const std::string& name) {
  for (const ParameterInfo& info : parameter_table()) {
    if (info.name == name) return info;
  }
  throw std::out_of_range(name);
}

/// Returns parameters with a number that set_parameter() might refuse.
Parameters with(const ParameterInfo& info, double value) {
  Parameters p;
  if (const auto* member = std::get_if<int Parameters::*>(&info.member)) {
    p.*(*member) = static_cast<int>(value);
  } else {
    p.*std::get<double Parameters::*>(info.member) = value;
  }
  return p;
}

std::string all_texts(const Parameters& p) {
  std::string text;
  for (const ParameterInfo& info : parameter_table()) text += to_text(p, info) + " ";
  return text;
}

/// Checks that validate() and set_parameter() refuse a value and name it, the parameter and the
/// range.
void expect_refused(const ParameterInfo& info, double value) {
  const Parameters p = with(info, value);
  const std::string text = to_text(p, info);
  SCOPED_TRACE(info.name + " = " + text);
  const Status validated = validate(p);
  ASSERT_FALSE(validated);
  EXPECT_EQ(validated.error().kind, ErrorKind::kInvalid);
  Parameters unchanged;
  const Status set = set_parameter(unchanged, info.name, text);
  ASSERT_FALSE(set);
  EXPECT_EQ(all_texts(unchanged), all_texts(Parameters()));
  for (const std::string& message : {validated.error().message, set.error().message}) {
    EXPECT_NE(message.find(info.name), std::string::npos) << message;
    EXPECT_NE(message.find(text), std::string::npos) << message;
    EXPECT_NE(message.find(allowed_values(info)), std::string::npos) << message;
  }
}

TEST(ParameterTable, HasTheDefaults) {
  const std::vector<std::pair<std::string, std::string>> expected{{"min_disparity", "0"},
                                                                  {"disparity_range", "64"},
                                                                  {"stereo_algorithm", "sgm"},
                                                                  {"sgm_build", "full"},
                                                                  {"dense", "false"},
                                                                  {"census_window_size", "11"},
                                                                  {"census_pattern", "sparse"},
                                                                  {"correlation_window_size", "15"},
                                                                  {"cost_difference_limit", "8"},
                                                                  {"cost_difference_shift", "2"},
                                                                  {"cost_outside", "5"},
                                                                  {"cost_shift", "2"},
                                                                  {"sgm_p1", "5"},
                                                                  {"sgm_p2", "15"},
                                                                  {"sgm_p2_edge", "10"},
                                                                  {"sgm_p2_strong_edge", "7"},
                                                                  {"sgm_edge", "5"},
                                                                  {"sgm_strong_edge", "14"},
                                                                  {"left_right_check", "true"},
                                                                  {"disp12MaxDiff", "1"},
                                                                  {"uniqueness_check", "true"},
                                                                  {"uniqueness_ratio", "33"},
                                                                  {"subpixel", "true"},
                                                                  {"speckle_size", "40"},
                                                                  {"speckle_range", "1"},
                                                                  {"median_difference", "8"}};
  ASSERT_EQ(parameter_table().size(), expected.size());
  for (const auto& [name, value] : expected) {
    EXPECT_EQ(to_text(Parameters(), info_of(name)), value) << name;
  }
}

TEST(ParameterTable, WindowParametersChangeTheAlgorithmOnly) {
  EXPECT_TRUE(validate(window_parameters()));
  for (const ParameterInfo& info : parameter_table()) {
    const std::string expected =
        info.name == "stereo_algorithm" ? "window" : to_text(Parameters(), info);
    EXPECT_EQ(to_text(window_parameters(), info), expected) << info.name;
  }
}

// A smaller penalty would allow the smallest path cost to decrease along a path.
TEST(ParameterTable, RefusesASmallPenaltyByName) {
  Parameters p;
  p.sgm_p2_edge = 5;
  const Status status = validate(p);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().message, "sgm_p2_edge = 5: allowed 6 to 15");
}

TEST(ParameterTable, AllowsTheDefaults) {
  EXPECT_TRUE(validate(Parameters()));
  for (const ParameterInfo& info : parameter_table()) {
    Parameters p;
    EXPECT_TRUE(set_parameter(p, info.name, to_text(Parameters(), info))) << info.name;
    EXPECT_FALSE(info.about.empty()) << info.name;
  }
}

TEST(ParameterTable, AllowsTheLimits) {
  for (const ParameterInfo& info : parameter_table()) {
    if (!is_number(info)) continue;
    EXPECT_TRUE(validate(with(info, info.min))) << info.name;
    EXPECT_TRUE(validate(with(info, info.max))) << info.name;
  }
}

TEST(ParameterTable, RefusesValuesOutOfRange) {
  for (const ParameterInfo& info : parameter_table()) {
    if (!is_number(info)) continue;
    const double step = is_integer(info) ? 1 : 0.25;
    expect_refused(info, info.min - step);
    expect_refused(info, info.max + step);
    if (info.step > 1) expect_refused(info, info.min + 1);
    if (info.step > 1) expect_refused(info, info.max - 1);
  }
}

TEST(ParameterTable, RefusesValuesFarOutOfRange) {
  for (const ParameterInfo& info : parameter_table()) {
    if (!is_integer(info)) continue;
    expect_refused(info, std::numeric_limits<int>::max());
    expect_refused(info, std::numeric_limits<int>::min() / 2);
  }
  EXPECT_FALSE(validate(with(info_of("uniqueness_ratio"), std::nan(""))));
  EXPECT_FALSE(validate(with(info_of("uniqueness_ratio"), INFINITY)));
}

TEST(ParameterTable, SaysTheAllowedValues) {
  EXPECT_EQ(allowed_values(info_of("disparity_range")), "8 to 256 in steps of 4");
  EXPECT_EQ(allowed_values(info_of("census_window_size")), "5 to 11 in steps of 2");
  EXPECT_EQ(allowed_values(info_of("correlation_window_size")), "5 to 21 in steps of 2");
  EXPECT_EQ(allowed_values(info_of("uniqueness_ratio")), "0 to 100");
  EXPECT_EQ(allowed_values(info_of("min_disparity")), "-128 to 128");
  EXPECT_EQ(allowed_values(info_of("subpixel")), "true or false");
  EXPECT_EQ(allowed_values(info_of("census_pattern")), "sparse or full");
  EXPECT_EQ(allowed_values(info_of("stereo_algorithm")), "window or sgm");
  EXPECT_EQ(allowed_values(info_of("sgm_build")), "full or small");
  EXPECT_EQ(allowed_values(info_of("sgm_p2")), "6 to 15");
}

TEST(ParameterTable, FindsTheNearestAllowedNumber) {
  const auto nearest = [](const char* name, double value) {
    return nearest_allowed(info_of(name), value);
  };
  EXPECT_EQ(nearest("disparity_range", 512), 256);
  EXPECT_EQ(nearest("disparity_range", -1), 8);
  EXPECT_EQ(nearest("disparity_range", 69), 68);
  EXPECT_EQ(nearest("disparity_range", 70), 72) << "halfway: the larger one";
  EXPECT_EQ(nearest("disparity_range", 64), 64);
  EXPECT_EQ(nearest("disparity_range", 64.7), 64);
  EXPECT_EQ(nearest("correlation_window_size", 14), 15);
  EXPECT_EQ(nearest("census_window_size", 10), 11);
  EXPECT_EQ(nearest("min_disparity", -1e9), -128);
  EXPECT_EQ(nearest("uniqueness_ratio", 100.5), 100);
  EXPECT_EQ(nearest("uniqueness_ratio", 12.25), 12.25);
}

TEST(SetParameter, SetsEveryType) {
  Parameters p;
  EXPECT_TRUE(set_parameter(p, "disparity_range", "128"));
  EXPECT_TRUE(set_parameter(p, "min_disparity", "-7"));
  EXPECT_TRUE(set_parameter(p, "uniqueness_ratio", "12.5"));
  EXPECT_TRUE(set_parameter(p, "census_pattern", "full"));
  EXPECT_TRUE(set_parameter(p, "stereo_algorithm", "window"));
  EXPECT_TRUE(set_parameter(p, "sgm_build", "small"));
  EXPECT_TRUE(set_parameter(p, "subpixel", "false"));
  EXPECT_EQ(p.disparity_range, 128);
  EXPECT_EQ(p.min_disparity, -7);
  EXPECT_EQ(p.uniqueness_ratio, 12.5);
  EXPECT_EQ(p.census_pattern, CensusPattern::kFull);
  EXPECT_EQ(p.stereo_algorithm, StereoAlgorithm::kWindow);
  EXPECT_EQ(p.sgm_build, SgmBuild::kSmall);
  EXPECT_FALSE(p.subpixel);
  EXPECT_TRUE(set_parameter(p, "census_pattern", "sparse"));
  EXPECT_TRUE(set_parameter(p, "subpixel", "true"));
  EXPECT_EQ(p.census_pattern, CensusPattern::kSparse);
  EXPECT_TRUE(p.subpixel);
}

TEST(SetParameter, TakesTheTextOfEveryValue) {
  for (const ParameterInfo& info : parameter_table()) {
    std::vector<std::string> texts{"true", "false"};
    if (!info.choices.empty()) texts = info.choices;
    if (is_integer(info)) {
      texts.clear();
      for (int v = static_cast<int>(info.min); v <= static_cast<int>(info.max); v += info.step) {
        texts.push_back(std::to_string(v));
      }
    } else if (is_number(info)) {
      texts = {"0", "0.5", "33", "99.75", "100"};
    }
    for (const std::string& text : texts) {
      Parameters p;
      ASSERT_TRUE(set_parameter(p, info.name, text)) << info.name << " " << text;
      ASSERT_EQ(to_text(p, info), text) << info.name;
      ASSERT_TRUE(validate(p)) << info.name << " " << text;
    }
  }
}

TEST(SetParameter, RefusesGarbage) {
  const char* const texts[] = {
      "", " ", "x", "12x", "12 ", "1.5.2", "--3", "nan", "0x10", "TRUE?", "99999999999999999999"};
  for (const ParameterInfo& info : parameter_table()) {
    for (const std::string text : texts) {
      Parameters p;
      const Status status = set_parameter(p, info.name, text);
      ASSERT_FALSE(status) << info.name << " \"" << text << "\"";
      EXPECT_EQ(status.error().kind, ErrorKind::kInvalid);
      EXPECT_NE(status.error().message.find(info.name), std::string::npos);
      EXPECT_NE(status.error().message.find("\"" + text + "\""), std::string::npos);
      EXPECT_NE(status.error().message.find(allowed_values(info)), std::string::npos);
      EXPECT_EQ(all_texts(p), all_texts(Parameters()));
    }
  }
  Parameters p;
  EXPECT_FALSE(set_parameter(p, "disparity_range", "64.0")) << "64.0 is not an integer";
}

TEST(SetParameter, RefusesUnknownNames) {
  Parameters p;
  const Status status = set_parameter(p, "disparity_rang", "64");
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().message.find("\"disparity_rang\""), std::string::npos);
  EXPECT_NE(status.error().message.find("disparity_range"), std::string::npos)
      << "the message lists all names";
  EXPECT_FALSE(set_parameter(p, "", "1"));
  EXPECT_FALSE(set_parameter(p, "Disparity_Range", "64"));
}

}  // namespace
}  // namespace fpga_stereo::test
