#include "fpga_stereo/core/spec.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "fpga_stereo/core/mesh.hpp"
#include "fpga_stereo/core/parameters.hpp"

namespace fpga_stereo::test {
namespace {

using namespace fpga_stereo::spec;

/// Returns the register with this name.
const Register& named(const std::string& name) {
  for (const Register& r : register_table()) {
    if (r.name == name) return r;
  }
  throw std::invalid_argument("no register " + name);
}

/// Returns the largest value that the field holds.
std::uint32_t largest(Field field) { return field.get(0xFFFFFFFFU); }

TEST(Field, GetsAndPutsItsBitsOnly) {
  constexpr Field field{8, 5};
  static_assert(field.mask() == 0x1F00);
  static_assert(field.get(0xFFFFF3FF) == 0x13);
  static_assert(field.put(0x13) == 0x1300);
  static_assert(field.put(0xFF) == 0x1F00, "bits outside the field stay 0");
  constexpr Field whole{0, 32};
  static_assert(whole.get(0x89ABCDEF) == 0x89ABCDEF);
  static_assert(whole.put(0x89ABCDEF) == 0x89ABCDEF);
}

TEST(Registers, HaveAscendingAddressesAndUniqueNames) {
  std::set<std::string> names;
  int last = -1;
  for (const Register& r : register_table()) {
    EXPECT_GT(static_cast<int>(r.address), last) << r.name;
    last = static_cast<int>(r.address);
    EXPECT_TRUE(names.insert(r.name).second) << r.name;
  }
  EXPECT_LT(last, 1 << kRegisterAddressBits);
}

TEST(Registers, HaveFieldsThatFitAndDoNotOverlap) {
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

TEST(Registers, HaveAResetValueUnlessTheBuildGivesIt) {
  for (const Register& r : register_table()) {
    EXPECT_EQ(!r.reset, std::string(r.name).rfind("BUILD", 0) == 0) << r.name;
    EXPECT_TRUE(r.reset || r.access == Access::kReadOnly) << r.name;
    EXPECT_TRUE(r.access != Access::kWriteOnly || r.reset == 0U) << r.name << " must read 0";
  }
}

TEST(Registers, MatchTheirGeneratedConstants) {
  EXPECT_EQ(kRegIdentityReset, std::uint32_t{'F'} << 24 | 'S' << 16 | 'T' << 8 | '1');
  EXPECT_EQ(kRegSpecHashReset, kSpecHash);
  EXPECT_EQ(named("READ_START").address, kRegReadStart);
  EXPECT_EQ(named("READ_START").reset, kRegReadStartReset);
  EXPECT_EQ(named("ERRORS").access, Access::kWriteOneToClear);
}

TEST(Registers, NameOnlyParametersOfThePipeline) {
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

TEST(Registers, ResetToTheDefaultParameters) {
  const Parameters p;
  EXPECT_EQ(kFlagsLeftRightCheck.get(kRegFlagsReset), p.left_right_check ? 1U : 0U);
  EXPECT_EQ(kFlagsUniquenessCheck.get(kRegFlagsReset), p.uniqueness_check ? 1U : 0U);
  EXPECT_EQ(kFlagsSubpixel.get(kRegFlagsReset), p.subpixel ? 1U : 0U);
  EXPECT_EQ(kRegDisp12MaxDiffReset, p.disp12MaxDiff);
  EXPECT_EQ(kRegUniquenessReset, std::lround(kUniquenessScale * (1 + p.uniqueness_ratio / 100)));
  EXPECT_EQ(kRegSpeckleSizeReset, p.speckle_size);
  EXPECT_EQ(kRegSpeckleRangeReset, p.speckle_range * kDisparityScale);
}

TEST(Registers, HoldEveryAllowedParameterValue) {
  const auto max = [](const std::string& name) {
    for (const ParameterInfo& info : parameter_table()) {
      if (info.name == name) return info.max;
    }
    throw std::invalid_argument("no parameter " + name);
  };
  EXPECT_GE(largest(kDisp12MaxDiffPixels), max("disp12MaxDiff"));
  EXPECT_GE(largest(kUniquenessFactor), kUniquenessScale * (1 + max("uniqueness_ratio") / 100));
  EXPECT_GE(largest(kSpeckleSizePixels), max("speckle_size"));
  EXPECT_GE(largest(kSpeckleRangeUnits), max("speckle_range") * kDisparityScale);
  EXPECT_GE(largest(kBuildCensusWindow), max("census_window_size"));
  EXPECT_GE(largest(kBuildCorrelationWindow), max("correlation_window_size"));
  EXPECT_EQ(largest(kBuildDisparities) + 1, max("disparity_range")) << "0 stands for 2^width";
  EXPECT_GE(largest(kBuildMaxWidth), kGatewareMaxWidth);
  EXPECT_GE(largest(kWidthPixels), kGatewareMaxWidth);
  EXPECT_GE(largest(kHeightRows), kGatewareMaxHeight);
  EXPECT_GE(largest(kReadStartPixels), kGatewareMaxWidth - 1);
  EXPECT_GE(largest(kMeshAddressNode) + 1,
            Mesh::node_count({kGatewareMaxWidth, kGatewareMaxHeight}).area());
  EXPECT_EQ(kMeshDataDx.bits, kMeshBits);
  EXPECT_EQ(kMeshDataDy.bits, kMeshBits);
}

TEST(Registers, HaveOneSignaturePerStageInDataOrder) {
  for (int stage = 0; stage < kNumGatewareStages; ++stage) {
    std::string name = std::string("SIGNATURE_") + gateware_stage_name(stage);
    for (char& c : name) c = static_cast<char>(std::toupper(c));
    EXPECT_EQ(named(name).address, kRegSignatureRectify + stage);
  }
}

TEST(GatewareStages, AreThoseOfWindowMatchingInDataOrder) {
  const std::vector<std::string> expected{"rectify", "census",   "match",  "select",
                                          "check",   "subpixel", "speckle"};
  std::vector<std::string> names;
  for (int stage = 0; stage < kNumGatewareStages; ++stage) {
    names.emplace_back(gateware_stage_name(stage));
  }
  EXPECT_EQ(names, expected);
  EXPECT_TRUE(std::is_sorted(kGatewareStages.begin(), kGatewareStages.end()));
}

// Boards that are in use report this hash. Stages and constants of the software alone are not part
// of it. If it changes on purpose, every gateware must be built again.
TEST(SpecHash, IsThatOfTheGatewaresInUse) { EXPECT_EQ(kSpecHash, 0xB7A06FF4U); }

/// Checks that fields of these ascending offsets fill a packet without overlaps.
void expect_layout(std::vector<std::pair<int, int>> fields, int bytes) {
  int end = 0;
  for (const auto& [offset, size] : fields) {
    EXPECT_GE(offset, end);
    end = offset + size;
  }
  EXPECT_LE(end, bytes);
  EXPECT_EQ(bytes % 4, 0);
}

TEST(Packets, HaveFieldsThatFitAndDoNotOverlap) {
  expect_layout({{kLinkHeaderSyncAt, 4},
                 {kLinkHeaderVersionAt, 1},
                 {kLinkHeaderTypeAt, 1},
                 {kLinkHeaderFlagsAt, 1},
                 {kLinkHeaderStreamAt, 1},
                 {kLinkHeaderLengthAt, 2},
                 {kLinkHeaderIndexAt, 2},
                 {kLinkHeaderSequenceAt, 4},
                 {kLinkHeaderFrameIdAt, 8},
                 {kLinkHeaderTimestampAt, 8},
                 {kLinkHeaderCrcAt, 4}},
                kLinkHeaderBytes);
  expect_layout({{kLinkLeaderWidthAt, 2},
                 {kLinkLeaderHeightAt, 2},
                 {kLinkLeaderFormatAt, 1},
                 {kLinkLeaderConfigurationAt, 4}},
                kLinkLeaderBytes);
  expect_layout({{kLinkTrailerRowsAt, 4}, {kLinkTrailerFlagsAt, 4}, {kLinkTrailerSignatureAt, 4}},
                kLinkTrailerBytes);
}

}  // namespace
}  // namespace fpga_stereo::test
