#include "fpga_stereo/core/spec.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <set>
#include <string>

#include "fpga_stereo/core/mesh.hpp"
#include "fpga_stereo/core/parameters.hpp"

namespace fpga_stereo::test {
namespace {

using namespace fpga_stereo::spec;

const Register& named(const std::string& name) {
  for (const Register& r : register_table()) {
    if (r.name == name) return r;
  }
  throw std::invalid_argument("no register " + name);
}

std::uint32_t largest(Field field) { return field.get(0xFFFFFFFFU); }

TEST(Field, ByHand) {
  constexpr Field field{8, 5};
  static_assert(field.mask() == 0x1F00);
  static_assert(field.get(0xFFFFF3FF) == 0x13);
  static_assert(field.put(0x13) == 0x1300);
  static_assert(field.put(0xFF) == 0x1F00, "never beside the field");
  constexpr Field whole{0, 32};
  static_assert(whole.get(0x89ABCDEF) == 0x89ABCDEF);
  static_assert(whole.put(0x89ABCDEF) == 0x89ABCDEF);
}

TEST(Registers, AddressesAscendAndFit) {
  std::set<std::string> names;
  int last = -1;
  for (const Register& r : register_table()) {
    EXPECT_GT(static_cast<int>(r.address), last) << r.name;
    last = static_cast<int>(r.address);
    EXPECT_TRUE(names.insert(r.name).second) << r.name;
  }
  EXPECT_LT(last, 1 << kRegisterAddressBits);
}

TEST(Registers, FieldsLieInTheWordAndDoNotOverlap) {
  for (const Register& r : register_table()) {
    std::uint32_t used = 0;
    std::set<std::string> names;
    for (const FieldInfo& f : r.fields) {
      EXPECT_TRUE(f.field.lsb >= 0 && f.field.bits > 0) << r.name << "." << f.name;
      EXPECT_LE(f.field.lsb + f.field.bits, kRegisterBits) << r.name << "." << f.name;
      EXPECT_EQ(used & f.field.mask(), 0U) << r.name << "." << f.name;
      EXPECT_TRUE(names.insert(f.name).second) << r.name << "." << f.name;
      used |= f.field.mask();
    }
    const std::uint32_t unused = r.fields.empty() ? 0 : ~used;
    EXPECT_EQ(r.reset.value_or(0) & unused, 0U) << r.name;
    EXPECT_FALSE(std::string(r.about).empty()) << r.name;
  }
}

TEST(Registers, OnlyBuildParametersHaveNoReset) {
  for (const Register& r : register_table()) {
    EXPECT_EQ(!r.reset, std::string(r.name).rfind("BUILD", 0) == 0) << r.name;
    EXPECT_TRUE(r.reset || r.access == Access::kReadOnly) << r.name;
    EXPECT_TRUE(r.access != Access::kWriteOnly || r.reset == 0U) << r.name << " reads 0";
  }
}

TEST(Registers, SayWhoTheyAre) {
  EXPECT_EQ(kRegIdentityReset, std::uint32_t{'F'} << 24 | 'S' << 16 | 'T' << 8 | '1');
  EXPECT_EQ(kRegSpecHashReset, kSpecHash);
  EXPECT_EQ(named("READ_START").address, kRegReadStart);
  EXPECT_EQ(named("READ_START").reset, kRegReadStartReset);
  EXPECT_EQ(named("ERRORS").access, Access::kWriteOneToClear);
}

TEST(Registers, EveryParameterIsOne) {
  for (const Register& r : register_table()) {
    for (const FieldInfo& f : r.fields) {
      const auto& table = parameter_table();
      const bool known = std::any_of(table.begin(), table.end(), [&](const ParameterInfo& info) {
        return info.name == f.parameter;
      });
      EXPECT_TRUE(known || std::string(f.parameter).empty()) << r.name << "." << f.name;
    }
  }
}

TEST(Registers, ResetToTheDefaultsOfTheSoftware) {
  const Parameters p;
  EXPECT_EQ(kFlagsLeftRightCheck.get(kRegFlagsReset), p.left_right_check ? 1U : 0U);
  EXPECT_EQ(kFlagsUniquenessCheck.get(kRegFlagsReset), p.uniqueness_check ? 1U : 0U);
  EXPECT_EQ(kFlagsSubpixel.get(kRegFlagsReset), p.subpixel ? 1U : 0U);
  EXPECT_EQ(kRegDisp12MaxDiffReset, p.disp12MaxDiff);
  EXPECT_EQ(kRegUniquenessReset, std::lround(kUniquenessScale * (1 + p.uniqueness_ratio / 100)));
  EXPECT_EQ(kRegSpeckleSizeReset, p.speckle_size);
  EXPECT_EQ(kRegSpeckleRangeReset, p.speckle_range * kDisparityScale);
}

TEST(Registers, HoldEveryAllowedValue) {
  const auto most = [](const std::string& name) {
    for (const ParameterInfo& info : parameter_table()) {
      if (info.name == name) return info.max;
    }
    throw std::invalid_argument("no parameter " + name);
  };
  EXPECT_GE(largest(kDisp12MaxDiffPixels), most("disp12MaxDiff"));
  EXPECT_GE(largest(kUniquenessFactor), kUniquenessScale * (1 + most("uniqueness_ratio") / 100));
  EXPECT_GE(largest(kSpeckleSizePixels), most("speckle_size"));
  EXPECT_GE(largest(kSpeckleRangeUnits), most("speckle_range") * kDisparityScale);
  EXPECT_GE(largest(kBuildCensusWindow), most("census_window_size"));
  EXPECT_GE(largest(kBuildCorrelationWindow), most("correlation_window_size"));
  EXPECT_EQ(largest(kBuildDisparities) + 1, most("disparity_range")) << "0 stands for the largest";
  EXPECT_GE(largest(kBuildMaxWidth), kGatewareMaxWidth);
  EXPECT_GE(largest(kWidthPixels), kGatewareMaxWidth);
  EXPECT_GE(largest(kHeightRows), kGatewareMaxHeight);
  EXPECT_GE(largest(kReadStartPixels), kGatewareMaxWidth - 1);
  EXPECT_GE(largest(kMeshAddressNode) + 1,
            Mesh::node_count({kGatewareMaxWidth, kGatewareMaxHeight}).area());
  EXPECT_EQ(kMeshDataDx.bits, kMeshBits);
  EXPECT_EQ(kMeshDataDy.bits, kMeshBits);
}

TEST(Registers, OneSignaturePerStageInOrder) {
  for (int stage = 0; stage < kNumStages; ++stage) {
    std::string name = std::string("SIGNATURE_") + kStageNames[stage];
    for (char& c : name) c = static_cast<char>(std::toupper(c));
    EXPECT_EQ(named(name).address, kRegSignatureRectify + stage);
  }
}

}  // namespace
}  // namespace fpga_stereo::test
