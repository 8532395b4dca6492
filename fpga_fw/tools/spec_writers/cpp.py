"""Writes spec.hpp and spec.cpp: stages, constants and registers for C++."""
from .text import NOTICE, commented, digits, quoted, wrapped

ACCESS = {"ro": "kReadOnly", "rw": "kReadWrite", "wo": "kWriteOnly", "w1c": "kWriteOneToClear"}

TYPES = """\
/// Bits of a register.
struct Field {
  int lsb, bits;

  constexpr std::uint32_t mask() const { return (0xFFFFFFFFU >> (32 - bits)) << lsb; }
  constexpr std::uint32_t get(std::uint32_t word) const { return (word & mask()) >> lsb; }
  constexpr std::uint32_t put(std::uint32_t value) const { return (value << lsb) & mask(); }
};

struct FieldInfo {
  const char* name;
  Field field;
  const char* parameter;  // pipeline parameter that the field holds, or ""
  const char* about;
};

enum class Access { kReadOnly, kReadWrite, kWriteOnly, kWriteOneToClear };

struct Register {
  const char* name;
  std::uint32_t address;  // of the word; byte address = 4 x this
  Access access;
  std::optional<std::uint32_t> reset;  // nullopt: a build parameter of the gateware gives it
  const char* about;
  std::vector<FieldInfo> fields;  // empty: one number of 32 bits
};"""


def constant_line(constant):
    name, value, bits = constant["name"], constant["value"], constant.get("bits")
    if bits is None:
        return f"constexpr int k{name} = {value};"
    return f"constexpr std::uint{bits}_t k{name} = 0x{digits(value, bits)};"


def packet_lines(packet):
    yield f"// Byte offsets in {packet['about']}."
    yield f"constexpr int k{packet['name']}Bytes = {packet['bytes']};"
    for field in packet["fields"]:
        yield f"constexpr int k{packet['name']}{field['name']}At = {field['at']};"
    yield ""


def register_lines(register):
    name = register["camel"]
    yield f"constexpr std::uint32_t kReg{name} = 0x{digits(register['address'], 8)};"
    if register["reset"] is not None:
        yield f"constexpr std::uint32_t kReg{name}Reset = 0x{digits(register['reset'])};"
    for field in register["fields"]:
        yield f"constexpr Field k{field['camel']}{{{field['lsb']}, {field['width']}}};"
    yield ""


def header(spec):
    stages = [(f"k{stage['camel']},", stage["about"]) for stage in spec["stages"]]
    stage_names = wrapped(", ".join(quoted(stage["name"]) for stage in spec["stages"]), "    ")
    gateware_stages = wrapped(", ".join(f"Stage::k{stage['camel']}"
                                        for stage in spec["gateware_stages"]), "    ")
    constants = [(constant_line(constant), constant["about"])
                 for constant in spec["constants"] + spec["software_constants"]]
    build = [(f"constexpr int kDefault{parameter['name']} = {parameter['value']};",
              parameter["about"]) for parameter in spec["build"]]
    packets = [line for packet in spec["packets"] for line in packet_lines(packet)]
    registers = [line for register in spec["registers"] for line in register_lines(register)]
    return f"""\
// {NOTICE}
//
// The numbers that software and gateware share. RTL twin: fpga_fw/rtl/fs_pkg.sv. Document:
// fpga_fw/spec/registers.md.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace fpga_stereo {{

/// Stages of the pipeline, in data order. stereo_algorithm decides between match, and cost with
/// aggregate.
enum class Stage {{
{commented(stages, "  ")}
}};
constexpr int kNumStages = {len(stages)};
// clang-format off
constexpr std::array<const char*, kNumStages> kStageNames{{
{stage_names}}};
/// The stages of the gateware, in the order of its signatures.
constexpr int kNumGatewareStages = {len(spec["gateware_stages"])};
constexpr std::array<Stage, kNumGatewareStages> kGatewareStages{{
{gateware_stages}}};
// clang-format on
/// Returns the name of a stage of the gateware.
constexpr const char* gateware_stage_name(int signature) {{
  const Stage stage = kGatewareStages[static_cast<std::size_t>(signature)];
  return kStageNames[static_cast<std::size_t>(stage)];
}}

{commented(constants)}

// Build parameters of a gateware unless a board sets others.
{commented(build)}

{chr(10).join(packets)}
/// The specification hash. The host refuses a gateware with another hash.
constexpr std::uint32_t kSpecHash = 0x{digits(spec['hash'])};

/// The register map of the gateware.
namespace spec {{

{TYPES}

/// Returns all registers in ascending address order.
const std::vector<Register>& register_table();

/// Configuration registers: addresses from the first one up to, but without, the end.
constexpr std::uint32_t kConfigurationBegin = 0x{digits(spec['configuration'][0]['address'], 8)};
constexpr std::uint32_t kConfigurationEnd = 0x{digits(spec['configuration'][-1]['address'] + 1, 8)};

// Word addresses, reset values, fields.

{chr(10).join(registers)}
}}  // namespace spec
}}  // namespace fpga_stereo
"""


def table_lines(register):
    """Yields one row of the table: the constants of the header, with the texts."""
    reset = "{}" if register["reset"] is None else f"kReg{register['camel']}Reset"
    yield (f"      {{{quoted(register['name'])}, kReg{register['camel']}, "
           f"Access::{ACCESS[register['access']]}, {reset},")
    yield f"       {quoted(register['about'])}, {{"
    for field in register["fields"]:
        parameter = field["parameter"]["name"] if "parameter" in field else ""
        yield (f"           {{{quoted(field['name'])}, k{field['camel']}, "
               f"{quoted(parameter)}, {quoted(field['about'])}}},")
    yield "       }},"


def source(spec):
    rows = [line for register in spec["registers"] for line in table_lines(register)]
    return f"""\
// {NOTICE}
#include "fpga_stereo/core/spec.hpp"

namespace fpga_stereo::spec {{

const std::vector<Register>& register_table() {{
  // clang-format off
  static const std::vector<Register> table{{
{chr(10).join(rows)}
  }};
  // clang-format on
  return table;
}}

}}  // namespace fpga_stereo::spec
"""
