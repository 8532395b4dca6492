"""Writes fs_pkg.sv, the RTL package."""
from .text import NOTICE, commented, digits, wrapped


def constant_line(constant):
    name, value, bits = constant["name"], constant["value"], constant.get("bits")
    if bits is None:
        return f"localparam int {name} = {value};"
    return f"localparam logic [{bits - 1}:0] {name} = {bits}'h{digits(value, bits)};"


def packet_lines(packet):
    yield f"  // Byte offsets in {packet['about']}."
    yield f"  localparam int {packet['name']}Bytes = {packet['bytes']};"
    for field in packet["fields"]:
        yield f"  localparam int {packet['name']}{field['name']}At = {field['at']};"
    yield ""


def register_lines(register):
    name = register["camel"]
    yield ""
    yield wrapped(f"{register['name']} ({register['access']}): {register['about']}", "  // ")
    yield f"  localparam logic [7:0] Reg{name} = 8'h{digits(register['address'], 8)};"
    if register["reset"] is not None:
        yield f"  localparam logic [31:0] Reg{name}Reset = 32'h{digits(register['reset'])};"
    for field in register["fields"]:
        yield f"  localparam int {field['camel']}Lsb = {field['lsb']};"
        yield f"  localparam int {field['camel']}Bits = {field['width']};"


def configuration_lines(registers):
    """Yields the configuration vector: its size, its fields, its value after a reset."""
    bits = 32 * len(registers)
    masks = [sum(field["mask"] for field in register["fields"]) for register in registers]
    resets = [f"Reg{register['camel']}Reset" for register in registers]
    yield f"  localparam int ConfigWords = {len(registers)};"
    yield f"  localparam int ConfigBits = {bits};"
    yield f"  localparam logic [{bits - 1}:0] ConfigMask = {{  // bits that lie in a field"
    yield list_lines(f"32'h{digits(mask)}" for mask in reversed(masks))
    yield f"  localparam logic [{bits - 1}:0] ConfigReset = {{"
    yield list_lines(reversed(resets))
    for word, register in enumerate(registers):
        for field in register["fields"]:
            yield f"  localparam int Config{field['camel']}Lsb = {32 * word + field['lsb']};"


def list_lines(items):
    return wrapped(", ".join(items) + "};", "      ")


def package(spec):
    stages = [(f"localparam int Stage{stage['camel']} = {number};", stage["about"])
              for number, stage in enumerate(spec["gateware_stages"])]
    constants = [(constant_line(constant), constant["about"]) for constant in spec["constants"]]
    build = [(f"localparam int Default{parameter['name']} = {parameter['value']};",
              parameter["about"]) for parameter in spec["build"]]
    packets = [line for packet in spec["packets"] for line in packet_lines(packet)]
    registers = [line for register in spec["registers"] for line in register_lines(register)]
    return f"""\
// {NOTICE}
//
// The numbers that gateware and software share. C++ twin: include/fpga_stereo/core/spec.hpp.
// Document: fpga_fw/spec/registers.md.

/* verilator lint_off UNUSEDPARAM */  // no design uses every name
package fs_pkg;
  // The specification hash.
  localparam logic [31:0] SpecHash = 32'h{digits(spec['hash'])};

  // Stages, in data order.
{commented(stages, "  ")}
  localparam int NumStages = {len(stages)};

  // Constants.
{commented(constants, "  ")}

  // Build parameters unless a board sets others.
{commented(build, "  ")}

{chr(10).join(packets)}
  // Registers: word address, reset value, fields.
  localparam int NumRegisters = {len(spec["registers"])};
{chr(10).join(registers)}

  // The configuration vector: configuration registers side by side, the first one lowest. A field
  // begins at Config...Lsb and has the width of the register's field.
{chr(10).join(configuration_lines(spec["configuration"]))}
endpackage
/* verilator lint_on UNUSEDPARAM */
"""
