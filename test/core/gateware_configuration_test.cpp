#include "fpga_stereo/core/gateware_configuration.hpp"

#include <gtest/gtest.h>

#include "fpga_stereo/core/spec.hpp"

namespace fpga_stereo::test {
namespace {

GatewareBuild vga() {
  GatewareBuild build;
  build.max_width = 640;
  build.disparities = 64;
  build.census_window = 11;
  build.correlation_window = 15;
  build.line_rows = 102;
  build.mesh_nodes = 5120;
  return build;
}

TEST(Hex, EightDigits) {
  EXPECT_EQ(hex(0x1F), "0x0000001F");
  EXPECT_EQ(hex(0xDEADBEEF), "0xDEADBEEF");
}

TEST(GatewareBuild, ReadsWhatItSays) {
  for (const int disparities : {4, 64, 256}) {
    for (const auto pattern : {CensusPattern::kSparse, CensusPattern::kFull}) {
      GatewareBuild build = vga();
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

TEST(GatewareConfiguration, WritesShadowThenMeshesThenApply) {
  StereoGeometry geometry;
  geometry.image_size = {64, 16};
  const auto made =
      make_gateware_configuration(vga(), Parameters{}, identity_rectification(geometry, 3));
  ASSERT_TRUE(made);
  const std::size_t nodes = 9 * 3;
  ASSERT_EQ(made->mesh[0].size(), nodes);
  EXPECT_EQ(made->mesh[0][0], 0U);
  EXPECT_EQ(made->mesh[1][0], spec::kMeshDataDx.put(-3U * kMeshScale))
      << "the right image is moved by min_disparity";
  const auto writes = made->writes();
  ASSERT_EQ(writes.size(), made->registers.size() + 2 * (nodes + 1) + 1);
  EXPECT_EQ(writes.front().address, spec::kRegWidth);
  EXPECT_EQ(writes.front().value, 64U);
  EXPECT_EQ(writes[made->registers.size() + nodes + 1].value, spec::kMeshAddressCamera.put(1));
  EXPECT_EQ(writes.back().address, spec::kRegControl);
  EXPECT_EQ(writes.back().value, spec::kControlApply.put(1));
}

TEST(GatewareConfiguration, RefusesWhatTheBuildHasNot) {
  StereoGeometry geometry;
  geometry.image_size = {656, 16};
  const auto wide =
      make_gateware_configuration(vga(), Parameters{}, identity_rectification(geometry, 0));
  ASSERT_FALSE(wide);
  EXPECT_EQ(wide.error().message, "image width = 656: this gateware allows 16 to 640");
  geometry.image_size = {640, 16};
  Parameters parameters;
  parameters.disparity_range = 96;
  const auto deep =
      make_gateware_configuration(vga(), parameters, identity_rectification(geometry, 0));
  ASSERT_FALSE(deep);
  EXPECT_EQ(deep.error().message, "disparity_range = 96: this gateware is built for 64 only");
}

}  // namespace
}  // namespace fpga_stereo::test
