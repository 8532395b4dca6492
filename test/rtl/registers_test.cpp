// Checks fs_registers against the register table in fpga_stereo/core/spec.hpp.
#include "Registers.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include "RegistersLarge.h"
#include "RegistersSmall.h"
#include "core/signature.hpp"
#include "fpga_stereo/core/spec.hpp"
#include "rtl/registers_rig.hpp"

namespace fpga_stereo::test {
namespace {

using spec::Access;
using spec::Register;

/// Returns the registers that fs_registers holds: all but those of the link.
std::vector<Register> own_registers() {
  std::vector<Register> own;
  for (const Register& r : spec::register_table()) {
    if (r.address < kLinkFirstRegister) own.push_back(r);
  }
  return own;
}

constexpr std::uint32_t kErrorConfig = spec::kErrorsConfig.put(1);

/// Returns a mask of the bits that a write to `r` changes.
std::uint32_t writable_mask(const Register& r) {
  std::uint32_t mask = 0;
  for (const spec::FieldInfo& f : r.fields) mask |= f.field.mask();
  return r.fields.empty() ? 0xFFFFFFFF : mask;
}

TEST(Registers, HaveTheirResetValuesAfterAReset) {
  RegistersRig<Registers> rig;
  for (int i = 0; i < 2; ++i) {
    for (const Register& r : own_registers()) {
      if (!r.reset) continue;
      EXPECT_EQ(rig.read(r.address), *r.reset) << r.name;
    }
    rig.write(spec::kRegWidth, 100);
    rig.write(spec::kRegMeshAddress, 0x10005);
    rig.write(spec::kRegFlags, 0);
    rig.apply();
    rig.reset();
  }
  EXPECT_EQ(rig.active_settings(), rig.register_settings());
  EXPECT_EQ(rig.active_settings()[0], 640U);
}

TEST(Registers, StartWithAWidthThatTheBuildSupports) {
  RegistersRig<RegistersLarge> large;
  EXPECT_EQ(large.active_settings(), large.register_settings());
  RegistersRig<RegistersSmall> small;
  EXPECT_EQ(small.read(spec::kRegWidth), spec::kRegWidthReset);
  EXPECT_EQ(small.active(spec::kRegWidth), 64U);
}

TEST(Registers, ReportTheBuildParameters) {
  RegistersRig<Registers> rig;
  const std::uint32_t build = rig.read(spec::kRegBuild);
  EXPECT_EQ(spec::kBuildMaxWidth.get(build), 640U);
  EXPECT_EQ(spec::kBuildDisparities.get(build), 64U);
  EXPECT_EQ(spec::kBuildCensusWindow.get(build), 11U);
  EXPECT_EQ(spec::kBuildCorrelationWindow.get(build), 15U);
  EXPECT_EQ(spec::kBuildCensusFull.get(build), 0U);
  EXPECT_EQ(rig.read(spec::kRegBuildLineRows), 102U);
  EXPECT_EQ(rig.read(spec::kRegBuildMeshNodes), 5120U);

  RegistersRig<RegistersLarge> large;
  const std::uint32_t large_build = large.read(spec::kRegBuild);
  EXPECT_EQ(spec::kBuildMaxWidth.get(large_build), 1280U);
  EXPECT_EQ(spec::kBuildDisparities.get(large_build), 0U);  // 256 wraps to 0
  EXPECT_EQ(spec::kBuildCensusWindow.get(large_build), 9U);
  EXPECT_EQ(spec::kBuildCorrelationWindow.get(large_build), 21U);
  EXPECT_EQ(spec::kBuildCensusFull.get(large_build), 1U);
  EXPECT_EQ(large.read(spec::kRegBuildLineRows), 256U);
  EXPECT_EQ(large.read(spec::kRegBuildMeshNodes), 65536U);
}

TEST(Registers, ReadAndWriteAsTheTableSpecifies) {
  std::map<std::uint32_t, const Register*> table;
  const std::vector<Register> own = own_registers();
  for (const Register& r : own) table[r.address] = &r;
  std::mt19937 random(1);
  RegistersRig<Registers> rig;
  for (int i = 0; i < 4000; ++i) {
    const std::uint32_t address = random() % 256, data = random();
    if (address == spec::kRegControl) continue;
    std::map<std::uint32_t, std::uint32_t> before;
    for (const auto& [at, r] : table) before[at] = rig.read(at);
    rig.write(address, data);
    for (const auto& [at, r] : table) {
      std::uint32_t expected = before[at];
      if (at == address && r->access == Access::kReadWrite) expected = data & writable_mask(*r);
      if (at == spec::kRegMeshAddress && address == spec::kRegMeshData) {
        expected =
            (expected & ~spec::kMeshAddressNode.mask()) | spec::kMeshAddressNode.put(expected + 1);
      }
      const bool has_node = spec::kMeshAddressNode.get(before[spec::kRegMeshAddress]) < 5120;
      if (at == spec::kRegStatus && address == spec::kRegMeshData && has_node) {
        expected |= spec::kStatusUploading.mask();
      }
      if (at == spec::kRegMeshSignature && address == spec::kRegMeshAddress) {
        expected = kSignatureStart;
      }
      if (at == spec::kRegMeshSignature && address == spec::kRegMeshData) {
        const std::uint32_t carried = (expected >> 31) != 0 ? kSignaturePolynomial : 0;
        expected = (expected << 1) ^ carried ^ data;
      }
      ASSERT_EQ(rig.read(at), expected) << r->name << " after a write to " << address;
    }
    if (table.count(address) != 0) continue;
    ASSERT_EQ(rig.read(address), 0U) << address;
  }
  EXPECT_EQ(rig.active_settings()[0], 640U);
}

TEST(Registers, AnswerAReadInTheNextClockOnly) {
  RegistersRig<Registers> rig;
  EXPECT_FALSE(rig.model.read_valid_o);
  rig.read(spec::kRegIdentity);
  rig.clock();
  EXPECT_FALSE(rig.model.read_valid_o);
  // A read in the same clock as a write returns the old value.
  rig.model.read_i = 1;
  rig.write(spec::kRegWidth, 99);
  EXPECT_TRUE(rig.model.read_valid_o);
  EXPECT_EQ(rig.model.data_o, 640U);
  rig.model.read_i = 0;
  EXPECT_EQ(rig.read(spec::kRegWidth), 99U);
}

TEST(Registers, TakeEffectTogetherAndOnlyAfterApply) {
  std::mt19937 random(2);
  RegistersRig<Registers> rig;
  const std::uint32_t shadows[] = {
      spec::kRegWidth,         spec::kRegHeight,     spec::kRegReadStart,   spec::kRegFlags,
      spec::kRegDisp12MaxDiff, spec::kRegUniqueness, spec::kRegSpeckleSize, spec::kRegSpeckleRange};
  for (int i = 0; i < 300; ++i) {
    const auto before = rig.active_settings();
    for (const std::uint32_t address : shadows) rig.write(address, random());
    rig.write(spec::kRegWidth, 16 + random() % 625);
    rig.write(spec::kRegHeight, 1 + random() % 1200);
    rig.write(spec::kRegReadStart,
              spec::kReadStartPixels.put(random() % 16) | spec::kReadStartRows.put(random() % 102));
    rig.accept_apply();  // without CONTROL.apply
    EXPECT_EQ(rig.active_settings(), before);
    rig.apply();
    rig.clock(static_cast<int>(random() % 5));
    EXPECT_EQ(rig.active_settings(), before);
    EXPECT_TRUE(rig.is_pending());
    EXPECT_TRUE(rig.model.pending_o);
    rig.accept_apply();
    const auto after = rig.active_settings();
    EXPECT_EQ(after, rig.register_settings());
    EXPECT_FALSE(rig.is_pending());
    EXPECT_FALSE(rig.model.pending_o);
    EXPECT_EQ(rig.read(spec::kRegErrors), 0U);
  }
}

struct RangeCase {
  int width, height, pixels, rows;
  bool is_allowed;
};

template <class Model>
void check_ranges(const std::vector<RangeCase>& cases) {
  RegistersRig<Model> rig;
  for (const RangeCase& c : cases) {
    SCOPED_TRACE(::testing::Message() << c.width << " x " << c.height << ", T_s " << c.rows
                                      << " rows, " << c.pixels << " pixels");
    const auto before = rig.active_settings();
    rig.write(spec::kRegErrors, kErrorConfig);
    rig.write(spec::kRegWidth, c.width);
    rig.write(spec::kRegHeight, c.height);
    rig.write(spec::kRegReadStart,
              spec::kReadStartPixels.put(c.pixels) | spec::kReadStartRows.put(c.rows));
    rig.apply();
    rig.clock(2);
    EXPECT_EQ(rig.is_pending(), c.is_allowed);
    EXPECT_EQ(rig.read(spec::kRegErrors), c.is_allowed ? 0 : kErrorConfig);
    rig.accept_apply();
    EXPECT_EQ(rig.active_settings() == before, !c.is_allowed);
    if (!c.is_allowed) continue;
    EXPECT_EQ(rig.active_settings(), rig.register_settings());
  }
}

TEST(Registers, RefuseSettingsOutOfRange) {
  check_ranges<Registers>({{15, 480, 2, 1, false},
                           {16, 480, 2, 1, true},
                           {640, 480, 2, 1, true},
                           {641, 480, 2, 1, false},
                           {0, 480, 2, 1, false},
                           {4095, 480, 2, 1, false},
                           {640, 0, 2, 1, false},
                           {640, 1, 2, 1, true},
                           {640, 1200, 2, 1, true},
                           {640, 1201, 2, 1, false},
                           {640, 480, 639, 1, true},
                           {640, 480, 640, 1, false},
                           {17, 480, 17, 1, false},
                           {17, 480, 16, 1, true},
                           {640, 480, 2, 101, true},
                           {640, 480, 2, 102, false},
                           {640, 480, 0, 0, true},
                           {640, 480, 0, 255, false}});
  // With a correlation window of 21, an image needs at least 22 columns.
  check_ranges<RegistersLarge>({{21, 480, 2, 1, false},
                                {22, 480, 2, 1, true},
                                {1280, 480, 2, 255, true},
                                {1281, 480, 2, 1, false}});
}

TEST(Registers, KeepUploadingAfterARefusedApply) {
  RegistersRig<Registers> rig;
  const auto before = rig.active_settings();
  rig.write(spec::kRegMeshData, 1);
  rig.write(spec::kRegHeight, 0);
  rig.apply();
  rig.clock(3);
  EXPECT_FALSE(rig.is_pending());
  rig.accept_apply();
  EXPECT_EQ(rig.active_settings(), before);
  EXPECT_TRUE(rig.model.uploading_o);
  rig.write(spec::kRegHeight, 5);
  rig.apply();
  rig.clock();
  rig.accept_apply();
  EXPECT_EQ(rig.active(spec::kRegHeight), 5U);
  EXPECT_FALSE(rig.model.uploading_o);
  EXPECT_EQ(rig.read(spec::kRegErrors), kErrorConfig);
}

TEST(Registers, WithdrawAnApplyWhenASettingIsWritten) {
  RegistersRig<Registers> rig;
  for (const auto& [address, withdraws] : {std::pair{spec::kRegWidth, true},
                                           {spec::kRegSpeckleRange, true},
                                           {spec::kRegMeshData, true},
                                           {spec::kRegMeshAddress, false},
                                           {spec::kRegErrors, false}}) {
    for (int wait = 0; wait < 4; ++wait) {  // the range check takes a clock
      SCOPED_TRACE(::testing::Message()
                   << "write to " << address << " after " << wait << " clocks");
      rig.write(spec::kRegHeight, 50);
      rig.apply();
      rig.clock(wait);
      rig.write(address, 100);
      rig.clock(2);
      EXPECT_EQ(rig.is_pending(), !withdraws);
      const auto before = rig.active_settings();
      rig.write(spec::kRegHeight, 60);
      rig.accept_apply();
      EXPECT_EQ(rig.active_settings(), before);
      EXPECT_EQ(rig.read(spec::kRegErrors), 0U);
    }
  }
  // A write in the clock that accepts the apply does not take effect with it.
  rig.write(spec::kRegHeight, 70);
  rig.apply();
  rig.clock(2);
  rig.model.apply_i = 1;
  rig.write(spec::kRegHeight, 0);
  rig.model.apply_i = 0;
  EXPECT_EQ(rig.active(spec::kRegHeight), 70U);
  EXPECT_FALSE(rig.is_pending());
}

TEST(Registers, WriteMeshNodesAndSignThem) {
  RegistersRig<Registers> rig;
  EXPECT_FALSE(rig.model.mesh_we_o);
  for (const std::uint32_t right : {0U, 1U}) {
    rig.write(spec::kRegMeshAddress,
              spec::kMeshAddressCamera.put(right) | spec::kMeshAddressNode.put(5117));
    EXPECT_FALSE(rig.model.mesh_we_o);
    Signature signature;
    EXPECT_EQ(rig.read(spec::kRegMeshSignature), signature.value());
    for (std::uint32_t node = 5117; node < 5123; ++node) {
      rig.write(spec::kRegMeshData, 0x12340000 + node);
      signature.add(0x12340000 + node);
      EXPECT_EQ(rig.model.mesh_we_o, node < 5120) << node;
      if (node < 5120) {
        EXPECT_EQ(rig.model.mesh_right_o, right);
        EXPECT_EQ(rig.model.mesh_node_o, node);
        EXPECT_EQ(rig.model.mesh_data_o, 0x12340000 + node);
      }
      rig.clock();
      EXPECT_FALSE(rig.model.mesh_we_o);
    }
    EXPECT_EQ(spec::kMeshAddressNode.get(rig.read(spec::kRegMeshAddress)), 5123U);
    EXPECT_EQ(spec::kMeshAddressCamera.get(rig.read(spec::kRegMeshAddress)), right);
    EXPECT_EQ(rig.read(spec::kRegMeshSignature), signature.value());
  }
}

TEST(Registers, AreUploadingFromAWriteToAMeshToTheApply) {
  RegistersRig<Registers> rig;
  const auto apply = [&] {
    rig.apply();
    rig.clock();
    rig.accept_apply();
  };
  const auto is_uploading = [&] {
    const bool is = rig.model.uploading_o != 0;
    EXPECT_EQ(spec::kStatusUploading.get(rig.status()), is ? 1U : 0U);
    return is;
  };
  for (std::uint32_t uploads = 0; uploads < 3; ++uploads) {
    apply();
    EXPECT_FALSE(is_uploading());
    EXPECT_EQ(rig.read(spec::kRegMeshUploads), uploads);
    // A node out of range is not written.
    rig.write(spec::kRegMeshAddress, 5120);
    rig.write(spec::kRegMeshData, 1);
    rig.clock();
    EXPECT_FALSE(is_uploading());
    rig.write(spec::kRegMeshAddress, 0);
    rig.write(spec::kRegMeshData, 1);
    rig.clock();
    EXPECT_TRUE(is_uploading());
    apply();
  }
  // A node written in the clock of the apply belongs to the next upload.
  rig.write(spec::kRegMeshAddress, 0);
  rig.write(spec::kRegMeshData, 1);
  rig.apply();
  rig.clock();
  rig.model.apply_i = 1;
  rig.write(spec::kRegMeshData, 2);
  rig.model.apply_i = 0;
  EXPECT_TRUE(rig.model.mesh_we_o);
  EXPECT_EQ(rig.read(spec::kRegMeshUploads), 4U);
  rig.clock();
  EXPECT_TRUE(is_uploading());
  apply();
  EXPECT_FALSE(is_uploading());
}

TEST(Registers, KeepErrorsUntilCleared) {
  RegistersRig<Registers> rig;
  auto& m = rig.model;
  const std::vector<std::pair<CData*, spec::Field>> inputs = {
      {&m.cut_frame_i, spec::kErrorsCutFrame},
      {&m.long_frame_i, spec::kErrorsLongFrame},
      {&m.buffer_left_i, spec::kErrorsBufferLeft},
      {&m.buffer_right_i, spec::kErrorsBufferRight}};
  std::uint32_t expected = 0;
  for (const auto& [input, field] : inputs) {
    *input = 1;
    rig.clock();
    *input = 0;
    expected |= field.put(1);
    rig.clock(3);
    EXPECT_EQ(rig.read(spec::kRegErrors), expected);
  }
  for (const auto& [input, field] : inputs) {
    rig.write(spec::kRegErrors, field.put(1));
    expected &= ~field.mask();
    EXPECT_EQ(rig.read(spec::kRegErrors), expected);
    // An error raised in the clock that clears it is kept.
    *input = 1;
    rig.write(spec::kRegErrors, field.put(1));
    *input = 0;
    EXPECT_EQ(rig.read(spec::kRegErrors), expected | field.put(1));
    rig.write(spec::kRegControl, spec::kControlClear.put(1));
    EXPECT_EQ(rig.read(spec::kRegErrors), 0U);
    expected = 0;
  }
}

TEST(Registers, CountEvents) {
  RegistersRig<Registers> rig;
  auto& m = rig.model;
  const std::vector<std::pair<CData*, std::uint32_t>> inputs = {
      {&m.frame_in_i, spec::kRegFramesIn},
      {&m.frame_out_i, spec::kRegFramesOut},
      {&m.cut_frame_i, spec::kRegCutFrames},
      {&m.long_frame_i, spec::kRegLongFrames},
      {&m.buffer_frame_i, spec::kRegBufferErrors}};
  std::mt19937 random(3);
  for (int i = 0; i < 3; ++i) {
    std::vector<std::uint32_t> expected(inputs.size(), 0);
    for (int clock = 0; clock < 1000; ++clock) {
      for (std::size_t k = 0; k < inputs.size(); ++k) {
        *inputs[k].first = random() % (k + 2) == 0 ? 1 : 0;
        expected[k] += *inputs[k].first;
      }
      rig.clock();
    }
    for (const auto& [input, address] : inputs) *input = 0;
    for (std::size_t k = 0; k < inputs.size(); ++k) {
      EXPECT_EQ(rig.read(inputs[k].second), expected[k]);
    }
    rig.write(spec::kRegControl, spec::kControlClear.put(1));
    for (const auto& [input, address] : inputs) EXPECT_EQ(rig.read(address), 0U);
  }
  EXPECT_EQ(rig.read(spec::kRegLabelExhaustion), 0U);
  // An event in the clock that clears the counters is counted.
  m.frame_in_i = 1;
  rig.write(spec::kRegControl, spec::kControlClear.put(1));
  m.frame_in_i = 0;
  EXPECT_EQ(rig.read(spec::kRegFramesIn), 1U);
}

TEST(Registers, ReportStatusAndSignatures) {
  RegistersRig<Registers> rig;
  rig.model.busy_i = 1;
  EXPECT_EQ(rig.status(), spec::kStatusBusy.put(1));
  rig.model.busy_i = 0;
  EXPECT_EQ(rig.status(), 0U);
  for (int i = 0; i < kNumGatewareStages; ++i) rig.model.signatures_i[i] = 0x1000000 * (i + 1) + 7;
  for (std::uint32_t i = 0; i < kNumGatewareStages; ++i) {
    EXPECT_EQ(rig.read(spec::kRegSignatureRectify + i), 0x1000000 * (i + 1) + 7);
  }
}

}  // namespace
}  // namespace fpga_stereo::test
