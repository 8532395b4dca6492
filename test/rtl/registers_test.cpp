// fs_registers against fpga_stereo/core/spec.hpp.
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
#include "rtl/register_bus.hpp"

namespace fpga_stereo::test {
namespace {

using spec::Access;
using spec::Register;

template <class Model>
class Bus {
 public:
  Model model;

  Bus() {
    model.write_i = model.read_i = model.apply_i = model.busy_i = 0;
    model.frame_in_i = model.frame_out_i = model.cut_frame_i = model.long_frame_i = 0;
    model.buffer_left_i = model.buffer_right_i = model.buffer_frame_i = 0;
    for (int i = 0; i < kNumStages; ++i) model.signatures_i[i] = 0;
    reset();
  }
  void reset() {
    model.rst_ni = 0;
    clock();
    model.rst_ni = 1;
  }
  void clock(int n = 1) {
    for (int i = 0; i < n; ++i) {
      model.clk_i = 0;
      model.eval();
      model.clk_i = 1;
      model.eval();
    }
  }
  void write(std::uint32_t address, std::uint32_t data) {
    write_register(
        model, [this] { clock(); }, address, data);
  }
  std::uint32_t read(std::uint32_t address) {
    return read_register(
        model, [this] { clock(); }, address);
  }
  void apply() { write(spec::kRegControl, spec::kControlApply.put(1)); }
  /// As fs_input answers.
  void take() {
    model.apply_i = 1;
    clock();
    model.apply_i = 0;
  }
  std::uint32_t status() { return read(spec::kRegStatus); }
  bool pending() { return spec::kStatusPending.get(status()) != 0; }

  /// Everything that the stages see of the configuration.
  std::vector<std::uint32_t> active() {
    return {model.width_o,        model.height_o,           model.read_pixels_o,
            model.read_rows_o,    model.left_right_check_o, model.uniqueness_check_o,
            model.subpixel_o,     model.disp12_max_diff_o,  model.uniqueness_o,
            model.speckle_size_o, model.speckle_range_o};
  }
  /// The same of what the registers hold.
  std::vector<std::uint32_t> shadow() {
    const std::uint32_t start = read(spec::kRegReadStart), flags = read(spec::kRegFlags);
    return {spec::kWidthPixels.get(read(spec::kRegWidth)),
            spec::kHeightRows.get(read(spec::kRegHeight)),
            spec::kReadStartPixels.get(start),
            spec::kReadStartRows.get(start),
            spec::kFlagsLeftRightCheck.get(flags),
            spec::kFlagsUniquenessCheck.get(flags),
            spec::kFlagsSubpixel.get(flags),
            spec::kDisp12MaxDiffPixels.get(read(spec::kRegDisp12MaxDiff)),
            spec::kUniquenessFactor.get(read(spec::kRegUniqueness)),
            spec::kSpeckleSizePixels.get(read(spec::kRegSpeckleSize)),
            spec::kSpeckleRangeUnits.get(read(spec::kRegSpeckleRange))};
  }
};

/// Those of the link are not in fs_registers.
std::vector<Register> own_registers() {
  std::vector<Register> own;
  for (const Register& r : spec::register_table()) {
    if (r.address < kLinkFirstRegister) own.push_back(r);
  }
  return own;
}

constexpr std::uint32_t kErrorConfig = spec::kErrorsConfig.put(1);

std::uint32_t writable(const Register& r) {
  std::uint32_t mask = 0;
  for (const spec::FieldInfo& f : r.fields) mask |= f.field.mask();
  return r.fields.empty() ? 0xFFFFFFFF : mask;
}

TEST(Registers, ResetValues) {
  Bus<Registers> bus;
  for (int i = 0; i < 2; ++i) {
    for (const Register& r : own_registers()) {
      if (!r.reset) continue;
      EXPECT_EQ(bus.read(r.address), *r.reset) << r.name;
    }
    bus.write(spec::kRegWidth, 100);
    bus.write(spec::kRegMeshAddress, 0x10005);
    bus.write(spec::kRegFlags, 0);
    bus.apply();
    bus.reset();
  }
  EXPECT_EQ(bus.active(), bus.shadow());
  EXPECT_EQ(bus.active()[0], 640U);
}

TEST(Registers, SmallBuildStartsWithAWidthThatItHas) {
  Bus<RegistersLarge> large;
  EXPECT_EQ(large.active(), large.shadow());
  Bus<RegistersSmall> small;
  EXPECT_EQ(small.read(spec::kRegWidth), spec::kRegWidthReset);
  EXPECT_EQ(small.model.width_o, 64);
}

TEST(Registers, Build) {
  Bus<Registers> bus;
  const std::uint32_t build = bus.read(spec::kRegBuild);
  EXPECT_EQ(spec::kBuildMaxWidth.get(build), 640U);
  EXPECT_EQ(spec::kBuildDisparities.get(build), 64U);
  EXPECT_EQ(spec::kBuildCensusWindow.get(build), 11U);
  EXPECT_EQ(spec::kBuildCorrelationWindow.get(build), 15U);
  EXPECT_EQ(spec::kBuildCensusFull.get(build), 0U);
  EXPECT_EQ(bus.read(spec::kRegBuildLineRows), 102U);
  EXPECT_EQ(bus.read(spec::kRegBuildMeshNodes), 5120U);

  Bus<RegistersLarge> large;
  const std::uint32_t large_build = large.read(spec::kRegBuild);
  EXPECT_EQ(spec::kBuildMaxWidth.get(large_build), 1280U);
  EXPECT_EQ(spec::kBuildDisparities.get(large_build), 0U);  // 256
  EXPECT_EQ(spec::kBuildCensusWindow.get(large_build), 9U);
  EXPECT_EQ(spec::kBuildCorrelationWindow.get(large_build), 21U);
  EXPECT_EQ(spec::kBuildCensusFull.get(large_build), 1U);
  EXPECT_EQ(large.read(spec::kRegBuildLineRows), 256U);
  EXPECT_EQ(large.read(spec::kRegBuildMeshNodes), 65536U);
}

TEST(Registers, EveryAddressAsTheTableHasIt) {
  std::map<std::uint32_t, const Register*> table;
  const std::vector<Register> own = own_registers();
  for (const Register& r : own) table[r.address] = &r;
  std::mt19937 random(1);
  Bus<Registers> bus;
  for (int i = 0; i < 4000; ++i) {
    const std::uint32_t address = random() % 256, data = random();
    if (address == spec::kRegControl) continue;
    std::map<std::uint32_t, std::uint32_t> before;
    for (const auto& [at, r] : table) before[at] = bus.read(at);
    bus.write(address, data);
    for (const auto& [at, r] : table) {
      std::uint32_t expected = before[at];
      if (at == address && r->access == Access::kReadWrite) expected = data & writable(*r);
      if (at == spec::kRegMeshAddress && address == spec::kRegMeshData) {
        expected =
            (expected & ~spec::kMeshAddressNode.mask()) | spec::kMeshAddressNode.put(expected + 1);
      }
      if (at == spec::kRegMeshSignature && address == spec::kRegMeshAddress) {
        expected = kSignatureStart;
      }
      if (at == spec::kRegMeshSignature && address == spec::kRegMeshData) {
        const std::uint32_t carried = (expected >> 31) != 0 ? kSignaturePolynomial : 0;
        expected = (expected << 1) ^ carried ^ data;
      }
      ASSERT_EQ(bus.read(at), expected) << r->name << " after a write to " << address;
    }
    if (table.count(address) != 0) continue;
    ASSERT_EQ(bus.read(address), 0U) << address;
  }
  EXPECT_EQ(bus.active()[0], 640U);
}

TEST(Registers, ReadIsValidInTheNextClockOnly) {
  Bus<Registers> bus;
  EXPECT_FALSE(bus.model.read_valid_o);
  bus.read(spec::kRegIdentity);
  bus.clock();
  EXPECT_FALSE(bus.model.read_valid_o);
  // A write together with a read gives what was there before.
  bus.model.read_i = 1;
  bus.write(spec::kRegWidth, 99);
  EXPECT_TRUE(bus.model.read_valid_o);
  EXPECT_EQ(bus.model.data_o, 640U);
  bus.model.read_i = 0;
  EXPECT_EQ(bus.read(spec::kRegWidth), 99U);
}

TEST(Registers, TakeEffectAllAtOnceAndOnlyWhenAskedTo) {
  std::mt19937 random(2);
  Bus<Registers> bus;
  const std::uint32_t shadows[] = {
      spec::kRegWidth,         spec::kRegHeight,     spec::kRegReadStart,   spec::kRegFlags,
      spec::kRegDisp12MaxDiff, spec::kRegUniqueness, spec::kRegSpeckleSize, spec::kRegSpeckleRange};
  for (int i = 0; i < 300; ++i) {
    const auto before = bus.active();
    for (const std::uint32_t address : shadows) bus.write(address, random());
    bus.write(spec::kRegWidth, 16 + random() % 625);
    bus.write(spec::kRegHeight, 1 + random() % 1200);
    bus.write(spec::kRegReadStart,
              spec::kReadStartPixels.put(random() % 16) | spec::kReadStartRows.put(random() % 102));
    bus.take();  // nobody has asked
    EXPECT_EQ(bus.active(), before);
    bus.apply();
    bus.clock(static_cast<int>(random() % 5));
    EXPECT_EQ(bus.active(), before);
    EXPECT_TRUE(bus.pending());
    EXPECT_TRUE(bus.model.pending_o);
    bus.take();
    const auto after = bus.active();
    EXPECT_EQ(after, bus.shadow());
    EXPECT_FALSE(bus.pending());
    EXPECT_FALSE(bus.model.pending_o);
    EXPECT_EQ(bus.read(spec::kRegErrors), 0U);
  }
}

struct Ranged {
  int width, height, pixels, rows;
  bool good;
};

template <class Model>
void check_ranges(const std::vector<Ranged>& cases) {
  Bus<Model> bus;
  for (const Ranged& c : cases) {
    SCOPED_TRACE(::testing::Message() << c.width << " x " << c.height << ", T_s " << c.rows
                                      << " rows, " << c.pixels << " pixels");
    const auto before = bus.active();
    bus.write(spec::kRegErrors, kErrorConfig);
    bus.write(spec::kRegWidth, c.width);
    bus.write(spec::kRegHeight, c.height);
    bus.write(spec::kRegReadStart,
              spec::kReadStartPixels.put(c.pixels) | spec::kReadStartRows.put(c.rows));
    bus.apply();
    bus.clock(2);
    EXPECT_EQ(bus.pending(), c.good);
    EXPECT_EQ(bus.read(spec::kRegErrors), c.good ? 0 : kErrorConfig);
    bus.take();
    EXPECT_EQ(bus.active() == before, !c.good);
    if (!c.good) continue;
    EXPECT_EQ(bus.active(), bus.shadow());
  }
}

TEST(Registers, Ranges) {
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
  // A correlation window of 21 needs 22 columns.
  check_ranges<RegistersLarge>({{21, 480, 2, 1, false},
                                {22, 480, 2, 1, true},
                                {1280, 480, 2, 255, true},
                                {1281, 480, 2, 1, false}});
}

TEST(Registers, RefusedApplyDropsOnlyItself) {
  Bus<Registers> bus;
  const auto before = bus.active();
  bus.write(spec::kRegMeshData, 1);
  bus.write(spec::kRegHeight, 0);
  bus.apply();
  bus.clock(3);
  EXPECT_FALSE(bus.pending());
  bus.take();
  EXPECT_EQ(bus.active(), before);
  EXPECT_EQ(bus.model.bank_o, 0);
  bus.write(spec::kRegHeight, 5);
  bus.apply();
  bus.clock();
  bus.take();
  EXPECT_EQ(bus.model.height_o, 5);
  EXPECT_EQ(bus.model.bank_o, 1);
  EXPECT_EQ(bus.read(spec::kRegErrors), kErrorConfig);
}

TEST(Registers, WritingToTheShadowWithdrawsAnApply) {
  Bus<Registers> bus;
  for (const auto& [address, withdraws] : {std::pair{spec::kRegWidth, true},
                                           {spec::kRegSpeckleRange, true},
                                           {spec::kRegMeshData, true},
                                           {spec::kRegMeshAddress, false},
                                           {spec::kRegErrors, false}}) {
    for (int wait = 0; wait < 4; ++wait) {  // the check of ranges takes a clock
      SCOPED_TRACE(::testing::Message() << address << " " << wait);
      bus.write(spec::kRegHeight, 50);
      bus.apply();
      bus.clock(wait);
      bus.write(address, 100);
      bus.clock(2);
      EXPECT_EQ(bus.pending(), !withdraws);
      const auto before = bus.active();
      bus.write(spec::kRegHeight, 60);
      bus.take();
      EXPECT_EQ(bus.active(), before);
      EXPECT_EQ(bus.read(spec::kRegErrors), 0U);
    }
  }
  // In the same clock as it is taken: what was there before the write.
  bus.write(spec::kRegHeight, 70);
  bus.apply();
  bus.clock(2);
  bus.model.apply_i = 1;
  bus.write(spec::kRegHeight, 0);
  bus.model.apply_i = 0;
  EXPECT_EQ(bus.model.height_o, 70);
  EXPECT_FALSE(bus.pending());
}

TEST(Registers, MeshUpload) {
  Bus<Registers> bus;
  EXPECT_FALSE(bus.model.mesh_we_o);
  for (const std::uint32_t right : {0U, 1U}) {
    bus.write(spec::kRegMeshAddress,
              spec::kMeshAddressCamera.put(right) | spec::kMeshAddressNode.put(5117));
    EXPECT_FALSE(bus.model.mesh_we_o);
    Signature signature;
    EXPECT_EQ(bus.read(spec::kRegMeshSignature), signature.value());
    for (std::uint32_t node = 5117; node < 5123; ++node) {
      bus.write(spec::kRegMeshData, 0x12340000 + node);
      signature.add(0x12340000 + node);
      EXPECT_EQ(bus.model.mesh_we_o, node < 5120) << node;
      if (node < 5120) {
        EXPECT_EQ(bus.model.mesh_right_o, right);
        EXPECT_EQ(bus.model.mesh_node_o, node);
        EXPECT_EQ(bus.model.mesh_data_o, 0x12340000 + node);
      }
      bus.clock();
      EXPECT_FALSE(bus.model.mesh_we_o);
    }
    EXPECT_EQ(spec::kMeshAddressNode.get(bus.read(spec::kRegMeshAddress)), 5123U);
    EXPECT_EQ(spec::kMeshAddressCamera.get(bus.read(spec::kRegMeshAddress)), right);
    EXPECT_EQ(bus.read(spec::kRegMeshSignature), signature.value());
  }
}

TEST(Registers, BanksChangeWhereAMeshWasWritten) {
  Bus<Registers> bus;
  const auto apply = [&] {
    bus.apply();
    bus.clock();
    bus.take();
  };
  std::uint32_t swaps = 0;
  for (int i = 0; i < 10; ++i) {
    const int bank = bus.model.bank_o;
    EXPECT_EQ(spec::kStatusBank.get(bus.status()), bank);
    apply();
    EXPECT_EQ(bus.model.bank_o, bank);  // nothing written
    bus.write(spec::kRegMeshAddress, 0);
    bus.write(spec::kRegMeshData, 1);
    EXPECT_EQ(bus.model.bank_o, bank);
    apply();
    EXPECT_EQ(bus.model.bank_o, 1 - bank);
    EXPECT_EQ(bus.read(spec::kRegMeshSwaps), ++swaps);
    // Nodes out of range are not written.
    bus.write(spec::kRegMeshAddress, 5120);
    bus.write(spec::kRegMeshData, 1);
    apply();
    EXPECT_EQ(bus.model.bank_o, 1 - bank);
  }
  // A node that comes in the clock of the swap belongs to the next upload.
  bus.write(spec::kRegMeshAddress, 0);
  bus.write(spec::kRegMeshData, 1);
  bus.apply();
  bus.clock();
  const int bank = bus.model.bank_o;
  bus.model.apply_i = 1;
  bus.write(spec::kRegMeshData, 2);
  bus.model.apply_i = 0;
  EXPECT_TRUE(bus.model.mesh_we_o);
  EXPECT_EQ(bus.model.bank_o, 1 - bank);
  bus.clock();
  apply();
  EXPECT_EQ(bus.model.bank_o, bank);
}

TEST(Registers, ErrorsStayUntilCleared) {
  Bus<Registers> bus;
  auto& m = bus.model;
  const std::vector<std::pair<CData*, spec::Field>> inputs = {
      {&m.cut_frame_i, spec::kErrorsCutFrame},
      {&m.long_frame_i, spec::kErrorsLongFrame},
      {&m.buffer_left_i, spec::kErrorsBufferLeft},
      {&m.buffer_right_i, spec::kErrorsBufferRight}};
  std::uint32_t expected = 0;
  for (const auto& [input, field] : inputs) {
    *input = 1;
    bus.clock();
    *input = 0;
    expected |= field.put(1);
    bus.clock(3);
    EXPECT_EQ(bus.read(spec::kRegErrors), expected);
  }
  for (const auto& [input, field] : inputs) {
    bus.write(spec::kRegErrors, field.put(1));
    expected &= ~field.mask();
    EXPECT_EQ(bus.read(spec::kRegErrors), expected);
    // In the clock in which it is cleared it comes again.
    *input = 1;
    bus.write(spec::kRegErrors, field.put(1));
    *input = 0;
    EXPECT_EQ(bus.read(spec::kRegErrors), expected | field.put(1));
    bus.write(spec::kRegControl, spec::kControlClear.put(1));
    EXPECT_EQ(bus.read(spec::kRegErrors), 0U);
    expected = 0;
  }
}

TEST(Registers, Counters) {
  Bus<Registers> bus;
  auto& m = bus.model;
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
      bus.clock();
    }
    for (const auto& [input, address] : inputs) *input = 0;
    for (std::size_t k = 0; k < inputs.size(); ++k) {
      EXPECT_EQ(bus.read(inputs[k].second), expected[k]);
    }
    bus.write(spec::kRegControl, spec::kControlClear.put(1));
    for (const auto& [input, address] : inputs) EXPECT_EQ(bus.read(address), 0U);
  }
  EXPECT_EQ(bus.read(spec::kRegLabelExhaustion), 0U);
  // What happens in the clock that clears counts.
  m.frame_in_i = 1;
  bus.write(spec::kRegControl, spec::kControlClear.put(1));
  m.frame_in_i = 0;
  EXPECT_EQ(bus.read(spec::kRegFramesIn), 1U);
}

TEST(Registers, StatusAndSignatures) {
  Bus<Registers> bus;
  bus.model.busy_i = 1;
  EXPECT_EQ(bus.status(), spec::kStatusBusy.put(1));
  bus.model.busy_i = 0;
  EXPECT_EQ(bus.status(), 0U);
  for (int i = 0; i < kNumStages; ++i) bus.model.signatures_i[i] = 0x1000000 * (i + 1) + 7;
  for (std::uint32_t i = 0; i < kNumStages; ++i) {
    EXPECT_EQ(bus.read(spec::kRegSignatureRectify + i), 0x1000000 * (i + 1) + 7);
  }
}

}  // namespace
}  // namespace fpga_stereo::test
