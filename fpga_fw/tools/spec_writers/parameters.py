"""Writes parameter_values.hpp and parameter_table.cpp: the pipeline's parameters for C++.

Each parameter is a member of struct Parameters, a row of the table and a line in the functions that
map parameters to register fields and back.
"""
from .specification import camel
from .text import NOTICE, allowed, commented, default, number, quoted, sentence, wrapped

BASIC_TYPES = ("int", "double", "bool")


def enumerations(spec):
    return [parameter for parameter in spec["parameters"] if parameter["choices"]]


def enumerator(parameter, name):
    return f"{parameter['type']}::k{camel(name)}"


def enumeration_lines(parameter):
    yield wrapped(f"{sentence(parameter['about'])}.", "/// ")
    yield f"enum class {parameter['type']} {{"
    yield commented([(f"k{camel(choice['name'])},", choice["about"])
                     for choice in parameter["choices"]], "  ")
    yield "};"
    yield f"/// Returns the value's name: {allowed(parameter)}."
    yield f"std::string to_text({parameter['type']} value);"
    yield ""


def member_lines(parameter):
    limits = ""
    if parameter["type"] in ("int", "double"):
        limits = f" ({parameter['unit'] or 'no unit'}, {allowed(parameter)})"
    yield wrapped(f"{sentence(parameter['about'])}{limits}.", "  /// ")
    value = default(parameter)
    if parameter["choices"]:
        value = enumerator(parameter, value)
    elif parameter["type"] == "double":
        value = repr(float(value))
    yield f"  {parameter['type']} {parameter['name']} = {value};"


def header(spec):
    types = [*BASIC_TYPES, *(parameter["type"] for parameter in enumerations(spec))]
    members = ",\n    ".join(f"{name} Parameters::*" for name in types)
    return f"""\
// {NOTICE}
//
// The parameters of the pipeline with their defaults. parameters.hpp checks and converts them.
#pragma once

#include <string>
#include <variant>

namespace fpga_stereo {{

{chr(10).join(line for one in enumerations(spec) for line in enumeration_lines(one))}
/// Parameters of the pipeline, in the order of the stages.
struct Parameters {{
{chr(10).join(line for one in spec["parameters"] for line in member_lines(one))}
}};

// clang-format off
/// A member of Parameters.
using ParameterMember = std::variant<
    {members}>;
// clang-format on

}}  // namespace fpga_stereo
"""


def row_lines(parameter):
    choices = ", ".join(quoted(choice["name"]) for choice in parameter["choices"])
    built = parameter.get("built") or any(register["reset"] is None
                                          for register, _ in parameter.get("fields", []))
    yield (f"      {{{quoted(parameter['name'])}, &Parameters::{parameter['name']}, "
           f"{number(parameter['min'])}, {number(parameter['max'])}, {parameter['step']}, "
           f"{quoted(parameter['unit'])}, {{{choices}}}, {str(built).lower()},")
    yield f"       {quoted(parameter['about'])}}},"


def field_number(field):
    """Returns the C++ expression for what the field holds."""
    member = f"p.{field['parameter']['name']}"
    encoding = field.get("encoding")
    if encoding == "uniqueness_factor":
        return f"{encoding}(p)"
    if field["parameter"]["choices"]:
        return f"static_cast<std::uint32_t>({member})"
    return member if encoding in (None, "modulo") else f"{member} * k{encoding}"


def parameter_value(field):
    """Returns the C++ expression for the parameter that the field of `word` holds."""
    kind, encoding = field["parameter"]["type"], field.get("encoding")
    got = f"spec::k{field['camel']}.get(word)"
    if kind == "bool":
        return f"{got} != 0"
    if kind not in BASIC_TYPES:
        return f"static_cast<{kind}>({got})"
    value = f"static_cast<int>({got})"
    if encoding == "uniqueness_factor":
        return f"{field['parameter']['name']}_of({value})"
    if encoding == "modulo":
        return f"modulo(spec::k{field['camel']}, word)"
    return value if encoding is None else f"{value} / k{encoding}"


def held(register):
    return [field for field in register["fields"] if "parameter" in field]


def bits(register):
    """Returns the C++ expression for the parameters in a register, a line per field."""
    return " |\n           ".join(f"spec::k{field['camel']}.put({field_number(field)})"
                                  for field in held(register))


def write_lines(registers):
    for register in registers:
        yield f"      {{spec::kReg{register['camel']},"
        yield f"           {bits(register)}}},"


def case_lines(registers):
    for register in registers:
        yield f"    case spec::kReg{register['camel']}:"
        for field in held(register):
            yield f"      p.{field['parameter']['name']} = {parameter_value(field)};"
        yield "      break;"


def name_lines(parameter):
    names = ", ".join(quoted(choice["name"]) for choice in parameter["choices"])
    yield f"std::string to_text({parameter['type']} value) {{"
    yield f"  constexpr const char* kNames[]{{{names}}};"
    yield "  return kNames[static_cast<int>(value)];"
    yield "}"
    yield ""


def source(spec):
    holders = [register for register in spec["registers"] if held(register)]
    written = [register for register in holders if register in spec["configuration"]]
    build = next(register for register in holders if register not in written)
    return f"""\
// {NOTICE}
#include "fpga_stereo/core/gateware_configuration.hpp"
#include "fpga_stereo/core/parameters.hpp"
#include "fpga_stereo/core/spec.hpp"

namespace fpga_stereo {{
namespace {{

/// Returns the number in a field in which 0 stands for 2^width.
int modulo(spec::Field field, std::uint32_t word) {{
  const auto value = static_cast<int>(field.get(word));
  return value == 0 ? 1 << field.bits : value;
}}

}}  // namespace

// clang-format off
const std::vector<ParameterInfo>& parameter_table() {{
  static const std::vector<ParameterInfo> table{{
{chr(10).join(line for one in spec["parameters"] for line in row_lines(one))}
  }};
  return table;
}}

{chr(10).join(line for one in enumerations(spec) for line in name_lines(one))}
std::vector<RegisterWrite> parameter_registers(const Parameters& p) {{
  return {{
{chr(10).join(write_lines(written))}
  }};
}}

std::uint32_t build_fields(const Parameters& p) {{
  return {bits(build)};
}}

void set_parameters(Parameters& p, std::uint32_t address, std::uint32_t word) {{
  switch (address) {{
{chr(10).join(case_lines(holders))}
    default:
      break;
  }}
}}
// clang-format on

}}  // namespace fpga_stereo
"""
