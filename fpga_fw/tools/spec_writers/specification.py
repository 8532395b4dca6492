"""Loads fpga_fw/spec/spec.yaml, checks it and adds what follows from it."""
import hashlib
import json
import math
import pathlib
import sys

import yaml

ROOT = pathlib.Path(__file__).resolve().parents[3]
SOURCE = "fpga_fw/spec/spec.yaml"

HASHED = ("stages", "constants", "packets", "registers")  # what host and board must agree on
NOT_HASHED = ("about", "group", "configuration")  # keys in these sections that they need not


def hashed(node):
    """Returns `node` without the keys that the hash leaves out."""
    if isinstance(node, dict):
        return {key: hashed(value) for key, value in node.items() if key not in NOT_HASHED}
    return [hashed(item) for item in node] if isinstance(node, list) else node


def gateware_stages(spec):
    return [stage for stage in spec["stages"] if stage.get("gateware", True)]


def spec_hash(spec):
    """Returns the first 32 bits of the SHA-256 of the hashed sections as JSON.

    The JSON has sorted keys, no spaces and ASCII characters only.
    """
    sections = {section: hashed(spec[section]) for section in HASHED}
    sections["stages"] = hashed(gateware_stages(spec))
    text = json.dumps(sections, sort_keys=True, separators=(",", ":"))
    return int(hashlib.sha256(text.encode()).hexdigest()[:8], 16)


def camel(name):
    """READ_START, max_width -> ReadStart, MaxWidth."""
    return "".join(part[0].upper() + part[1:].lower() for part in name.split("_"))


def load():
    """Returns the specification with hash, names, and lsb, width and mask of fields.

    The reset value of a register is a number, or None where a build parameter gives it. Fields that
    hold a parameter refer to its entry. `configuration` lists the configuration registers.
    """
    spec = yaml.safe_load((ROOT / SOURCE).read_text())
    spec["hash"] = spec_hash(spec)
    spec["constant"] = {constant["name"]: constant["value"]
                        for constant in spec["constants"] + spec["software_constants"]}
    spec["gateware_stages"] = gateware_stages(spec)
    for stage in spec["stages"]:
        stage["camel"] = camel(stage["name"])
    for parameter in spec["parameters"]:
        complete(parameter, spec["constant"])
    parameters = {parameter["name"]: parameter for parameter in spec["parameters"]}
    spec["groups"] = spec["registers"]
    spec["registers"] = [register for group in spec["groups"] for register in group["registers"]]
    for register in spec["registers"]:
        register["camel"] = camel(register["name"])
        for field in register.setdefault("fields", []):
            complete_field(register, field, parameters)
        reset = register["reset"]
        register["reset"] = {"build": None, "hash": spec["hash"]}.get(reset, reset)
        if reset == "parameters":
            register["reset"] = sum(encoded(field, field["parameter"]["default"], spec)
                                    for field in register["fields"])
    check_ranges(spec)
    spec["configuration"] = next(group["registers"] for group in spec["groups"]
                                 if group.get("configuration"))
    check_configuration(spec["configuration"])
    return spec


def complete(parameter, constants):
    """Sets the optional keys of a parameter and replaces names of constants by their values."""
    for limit in ("min", "max"):
        value = parameter.get(limit, 0)
        parameter[limit] = constants.get(value, value)
    parameter.setdefault("step", 1)
    parameter.setdefault("unit", "")
    parameter.setdefault("note", [])
    parameter["choices"] = parameter.get("choices", [])
    if parameter["choices"] or parameter["type"] == "bool":
        parameter["max"] = max(len(parameter["choices"]) - 1, 1)


def complete_field(register, field, parameters):
    """Sets name, position, mask and parameter of a field."""
    field["camel"] = register["camel"] + camel(field["name"])
    field["lsb"] = field["bits"][1]
    field["width"] = field["bits"][0] - field["bits"][1] + 1
    field["mask"] = ((1 << field["width"]) - 1) << field["lsb"]
    if "parameter" in field:
        if field["parameter"] not in parameters:
            sys.exit(f"{register['name']}.{field['name']}: no parameter {field['parameter']}")
        field["parameter"] = parameters[field["parameter"]]
        field["parameter"].setdefault("fields", []).append((register, field))


def uniqueness_factor(ratio, spec):
    """Python twin of uniqueness_factor() in core: rounds half away from zero."""
    return math.floor(spec["constant"]["UniquenessScale"] * (1 + ratio / 100) + 0.5)


def field_value(field, value, spec):
    """Returns the number that a field needs to hold the value of its parameter."""
    encoding, choices = field.get("encoding"), field["parameter"]["choices"]
    if choices and isinstance(value, str):
        return [choice["name"] for choice in choices].index(value)
    if encoding == "uniqueness_factor":
        return uniqueness_factor(value, spec)
    return int(value) * spec["constant"].get(encoding, 1)


def encoded(field, value, spec):
    """Returns the value of a parameter in the bits of its field."""
    return field_value(field, value, spec) << field["lsb"] & field["mask"]


def check_ranges(spec):
    """Exits unless each field can hold every allowed value of its parameter."""
    for parameter in spec["parameters"]:
        for register, field in parameter.get("fields", []):
            largest = field_value(field, parameter["max"], spec)
            limit = 1 << field["width"]
            if parameter["min"] < 0 or largest >= limit + (field.get("encoding") == "modulo"):
                sys.exit(f"{register['name']}.{field['name']} cannot hold {parameter['name']} from "
                         f"{parameter['min']} to {parameter['max']}")


def check_configuration(registers):
    """Exits unless these registers can stand side by side in one vector."""
    first = registers[0]["address"]
    for word, register in enumerate(registers):
        if register["address"] != first + word or not register["fields"]:
            sys.exit(f"{register['name']}: configuration registers need fields, and addresses "
                     "without a gap")
    if first % (1 << (len(registers) - 1).bit_length()) != 0:
        sys.exit("the first configuration register needs an address that is a multiple of their "
                 "number, rounded up to a power of 2")
