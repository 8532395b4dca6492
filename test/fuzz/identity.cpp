// libFuzzer target for what a board says about itself: the answer that identifies it, and what the
// plan for it makes of that. The input is the values of the registers, and a payload.
#include "fpga_stereo/link/identity.hpp"

#include "fpga_stereo/link/board_plan.hpp"
#include "fuzz/budget.hpp"
#include "link/request.hpp"
#include "support/images.hpp"

namespace {

using fpga_stereo::test::require;

fpga_stereo::StereoRectification rectification(cv::Size size) {
  fpga_stereo::StereoGeometry geometry;
  geometry.image_size = size;
  return fpga_stereo::identity_rectification(geometry, 0);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  namespace link = fpga_stereo::link;
  static const auto small = rectification({64, 24});
  const fpga_stereo::test::Budget budget(size);
  std::vector<fpga_stereo::RegisterWrite> values;
  // Mostly a good identity: a fuzzer does not guess it.
  const auto addresses = link::Identity::registers();
  const fpga_stereo::GatewareBuild good;
  const std::uint32_t expected[]{fpga_stereo::spec::kRegIdentityReset,
                                 fpga_stereo::kSpecHash,
                                 fpga_stereo::spec::kRegVersionReset,
                                 good.build_register(),
                                 static_cast<std::uint32_t>(good.line_rows),
                                 static_cast<std::uint32_t>(good.mesh_nodes),
                                 0xFF,
                                 50000000};
  for (std::size_t i = 0; i < addresses.size(); ++i) {
    const bool is_given = size >= 5 && data[0] % 2 == 1;
    if (size >= 1) ++data, --size;
    values.push_back({addresses[i], is_given ? link::get_u32(data) : expected[i]});
    if (is_given) data += 4, size -= 4;
  }
  const link::Identity identity = link::Identity::from_values(values);
  require(!identity.text().empty(), "an identity has a text");
  if (identity.check()) {
    const auto& build = identity.build;
    require(static_cast<bool>(build.check()), "a build that is accepted is possible");
    const auto made =
        fpga_stereo::make_gateware_configuration(build, fpga_stereo::parameters_of(build), small);
    if (made) require(made->registers.size() < 64, "a configuration has few registers");
  }
  std::vector<std::uint8_t> payload(data, data + size / 4 * 4);
  link::Packet packet;
  packet.header.type = link::PacketType::kRegisters;
  packet.header.length = static_cast<std::uint16_t>(payload.size());
  packet.payload = payload.data();
  if (const auto registers = link::unpack_registers(packet)) {
    require(registers->size() == payload.size() / 8, "every register is unpacked");
  }
  require(!link::refusal_text(packet).empty(), "a refusal has a text");
  return 0;
}
