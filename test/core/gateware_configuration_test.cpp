#include "fpga_stereo/core/gateware_configuration.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <variant>

#include "fpga_stereo/core/spec.hpp"

namespace fpga_stereo::test {
namespace {

TEST(Hex, HasEightDigits) {
  EXPECT_EQ(hex(0x1F), "0x0000001F");
  EXPECT_EQ(hex(0xDEADBEEF), "0xDEADBEEF");
}

TEST(GatewareBuild, IsReadBackFromItsRegisters) {
  for (const int disparities : {4, 64, 256}) {
    for (const auto pattern : {CensusPattern::kSparse, CensusPattern::kFull}) {
      GatewareBuild build;
      build.disparities = disparities;
      build.census_pattern = pattern;
      const auto read = GatewareBuild::from_registers(build.build_register(), 102, 5120);
      EXPECT_EQ(read.max_width, 640);
      EXPECT_EQ(read.disparities, disparities);
      EXPECT_EQ(read.census_window, 11);
      EXPECT_EQ(read.correlation_window, 15);
      EXPECT_EQ(read.census_pattern, pattern);
      EXPECT_EQ(read.line_rows, 102);
      EXPECT_EQ(read.mesh_nodes, 5120);
    }
  }
}

/// Checks that registers and back keep the value of a parameter.
void expect_round_trip(const ParameterInfo& info, const std::string& text) {
  Parameters in, out;
  ASSERT_TRUE(set_parameter(in, info.name, text)) << info.name << " = " << text;
  for (const RegisterWrite& r : parameter_registers(in)) set_parameters(out, r.address, r.value);
  set_parameters(out, spec::kRegBuild, build_fields(in));
  EXPECT_EQ(to_text(out, info), text) << info.name;
}

/// Returns the names of the parameters that a register field holds.
std::set<std::string> held_parameters() {
  std::set<std::string> names;
  for (const spec::Register& r : spec::register_table()) {
    for (const spec::FieldInfo& f : r.fields) names.insert(f.parameter);
  }
  names.erase("");
  return names;
}

TEST(ParameterRegisters, HoldEveryAllowedValue) {
  const std::set<std::string> held = held_parameters();
  std::set<std::string> others;  // min_disparity is in the mesh; the rest is for software only
  for (const ParameterInfo& info : parameter_table()) {
    if (held.count(info.name) == 0) {
      others.insert(info.name);
      continue;
    }
    if (std::holds_alternative<int Parameters::*>(info.member)) {
      for (int v = static_cast<int>(info.min); v <= static_cast<int>(info.max); v += info.step) {
        expect_round_trip(info, std::to_string(v));
      }
    } else if (std::holds_alternative<bool Parameters::*>(info.member)) {
      expect_round_trip(info, "false");
      expect_round_trip(info, "true");
    } else {
      for (const std::string& name : info.choices) expect_round_trip(info, name);
    }
  }
  EXPECT_EQ(others, (std::set<std::string>{"min_disparity", "stereo_algorithm", "sgm_build",
                                           "dense", "cost_difference_limit",
                                           "cost_difference_shift", "cost_outside", "cost_shift",
                                           "sgm_p1", "sgm_p2", "sgm_p2_edge", "sgm_p2_strong_edge",
                                           "sgm_edge", "sgm_strong_edge", "median_difference"}));
}

TEST(ParameterRegisters, HoldTheUniquenessFactor) {
  Parameters in, out;
  for (in.uniqueness_ratio = 0; in.uniqueness_ratio <= 100; in.uniqueness_ratio += 0.25) {
    for (const RegisterWrite& r : parameter_registers(in)) set_parameters(out, r.address, r.value);
    EXPECT_EQ(uniqueness_factor(out), uniqueness_factor(in)) << in.uniqueness_ratio << " percent";
  }
}

TEST(ParameterRegisters, KeepTheirAddressesInTheConfiguration) {
  std::uint32_t last = spec::kRegReadStart;
  for (const RegisterWrite& r : parameter_registers({})) {
    EXPECT_EQ(r.address, last + 1);
    last = r.address;
  }
}

TEST(ParameterRegisters, IgnoreOtherRegisters) {
  Parameters p = window_parameters();
  set_parameters(p, spec::kRegWidth, 0xFFFFFFFF);
  set_parameters(p, 0xFFFFFFFF, 0);
  for (const ParameterInfo& info : parameter_table()) {
    EXPECT_EQ(to_text(p, info), to_text(window_parameters(), info)) << info.name;
  }
}

TEST(GatewareBuild, FixesItsParameters) {
  GatewareBuild build;
  build.disparities = 256;
  build.census_window = 7;
  build.correlation_window = 21;
  build.census_pattern = CensusPattern::kFull;
  const Parameters p = parameters_of(build);
  EXPECT_EQ(p.disparity_range, 256);
  EXPECT_EQ(p.census_window_size, 7);
  EXPECT_EQ(p.correlation_window_size, 21);
  EXPECT_EQ(p.census_pattern, CensusPattern::kFull);
  EXPECT_EQ(p.stereo_algorithm, StereoAlgorithm::kWindow);
  EXPECT_FALSE(p.dense);
  std::set<std::string> fixed;
  for (const ParameterInfo& info : parameter_table()) {
    if (info.is_fixed_by_build) fixed.insert(info.name);
  }
  EXPECT_EQ(fixed, (std::set<std::string>{"disparity_range", "stereo_algorithm", "sgm_build",
                                          "dense", "census_window_size", "census_pattern",
                                          "correlation_window_size"}));
}

TEST(GatewareConfiguration, WritesShadowThenMeshesThenApply) {
  StereoGeometry geometry;
  geometry.image_size = {64, 16};
  const auto made = make_gateware_configuration(GatewareBuild{}, window_parameters(),
                                                identity_rectification(geometry, 3));
  ASSERT_TRUE(made);
  const std::size_t nodes = 9 * 3;
  ASSERT_EQ(made->mesh[0].size(), nodes);
  EXPECT_EQ(made->mesh[0][0], 0U);
  EXPECT_EQ(made->mesh[1][0], spec::kMeshDataDx.put(-3U * kMeshScale))
      << "min_disparity moves the right image";
  const auto writes = made->writes();
  ASSERT_EQ(writes.size(), made->registers.size() + 2 * (nodes + 1) + 1);
  EXPECT_EQ(writes.front().address, spec::kRegWidth);
  EXPECT_EQ(writes.front().value, 64U);
  EXPECT_EQ(writes[made->registers.size() + nodes + 1].value, spec::kMeshAddressCamera.put(1));
  EXPECT_EQ(writes.back().address, spec::kRegControl);
  EXPECT_EQ(writes.back().value, spec::kControlApply.put(1));
}

TEST(GatewareConfiguration, RefusesWhatTheBuildDoesNotSupport) {
  StereoGeometry geometry;
  geometry.image_size = {656, 16};
  const auto wide = make_gateware_configuration(GatewareBuild{}, window_parameters(),
                                                identity_rectification(geometry, 0));
  ASSERT_FALSE(wide);
  EXPECT_EQ(wide.error().message, "image width = 656: this gateware allows 16 to 640");
  geometry.image_size = {640, 16};
  Parameters parameters = window_parameters();
  parameters.disparity_range = 96;
  const auto deep =
      make_gateware_configuration(GatewareBuild{}, parameters, identity_rectification(geometry, 0));
  ASSERT_FALSE(deep);
  EXPECT_EQ(deep.error().message, "disparity_range = 96: this gateware is built for 64 only");
}

TEST(GatewareConfiguration, RefusesWhatOnlySoftwareComputes) {
  StereoGeometry geometry;
  geometry.image_size = {640, 16};
  const StereoRectification rectification = identity_rectification(geometry, 0);
  const auto refusal = [&](const Parameters& p) {
    const auto made = make_gateware_configuration(GatewareBuild{}, p, rectification);
    return made ? "" : made.error().message;
  };
  Parameters dense = window_parameters();
  dense.dense = true;
  EXPECT_EQ(refusal(window_parameters()), "");
  EXPECT_EQ(refusal(Parameters()),
            "stereo_algorithm = sgm: this gateware is built for window only");
  EXPECT_EQ(refusal(dense), "dense = true: this gateware is built for false only");
  // What window matching does not use may have any value.
  Parameters other = window_parameters();
  other.sgm_p1 = other.cost_shift = 0;
  other.median_difference = 255;
  other.sgm_build = SgmBuild::kSmall;
  EXPECT_EQ(refusal(other), "");
}

}  // namespace
}  // namespace fpga_stereo::test
