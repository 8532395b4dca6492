"""Writes what people read and ROS loads: registers.md and the marked parts of other files."""
from .text import (NOTICE, allowed, default, digits, number, quoted, replace_part, sentence,
                   wrapped)


def table(heads, rows):
    lines = [heads, ["---"] * len(heads), *rows]
    return "\n".join(f"| {' | '.join(str(cell) for cell in line)} |" for line in lines)


def register_rows(register):
    reset = register["reset"]
    yield (f"0x{digits(register['address'], 8)}", f"`{register['name']}`", register["access"],
           "build" if reset is None else f"0x{digits(reset)}", register["about"])
    for field in register["fields"]:
        high, low = field["bits"]
        bits = f"{high}:{low}" if high > low else low
        value = "" if reset is None else (reset & field["mask"]) >> low
        parameter = f" (`{field['parameter']['name']}`)" if "parameter" in field else ""
        yield "", f"&nbsp; `{field['name']}` [{bits}]", "", value, field["about"] + parameter


def group_page(group):
    rows = [row for register in group["registers"] for row in register_rows(register)]
    heads = ["address", "name", "access", "reset", ""]
    return f"## {group['group']}\n\n{wrapped(group['about'])}\n\n{table(heads, rows)}\n"


def constant_rows(spec):
    for constant in spec["constants"]:
        value, bits = constant["value"], constant.get("bits")
        text = f"0x{digits(value, bits)}" if bits else value
        yield f"`{constant['name']}`", text, constant["about"]
    for parameter in spec["build"]:
        yield (f"`Default{parameter['name']}`", parameter["value"],
               f"build parameter: {parameter['about']}")


def parameter_rows(spec):
    for parameter in spec["parameters"]:
        held = ", ".join(f"`{register['name']}.{field['name']}`"
                         for register, field in parameter.get("fields", []))
        unit = f" {parameter['unit']}" if parameter["unit"] else ""
        yield (f"`{parameter['name']}`", default(parameter), allowed(parameter) + unit, held,
               parameter["about"])


def parameter_table(spec):
    return table(["name", "default", "allowed", "register field", "meaning"], parameter_rows(spec))


def registers_page(spec):
    stages = [(order, f"`{stage['name']}`", stage["about"])
              for order, stage in enumerate(spec["gateware_stages"])]
    return f"""\
# Registers, constants, stages

{NOTICE}

Specification hash: `0x{digits(spec["hash"])}`. It is the first 32 bits of the SHA-256 of what host
and board must agree on; [`spec.yaml`](spec.yaml) says what that is. The host refuses a gateware
with another hash.

A register has 32 bits and a word address; byte address = 4 x word address. Access: ro, rw, wo
(reads 0), w1c (writing 1 clears the bit). Bits outside all fields read 0; writes to them are
ignored. In brackets: the pipeline parameter that a field holds.

{chr(10).join(group_page(group) for group in spec["groups"])}
## Constants

{table(["name", "value", ""], constant_rows(spec))}

## Stages

{table(["number", "name", ""], stages)}
"""


def pipeline_page(spec, text):
    return replace_part(text, parameter_table(spec), "<!--", " -->")


# ROS.

def reconfigure_lines(parameter):
    kind = {"int": "int_t", "double": "double_t", "bool": "bool_t"}.get(parameter["type"], "str_t")
    about = sentence(parameter["about"])
    if parameter["unit"]:
        step = f", in steps of {parameter['step']}" if parameter["step"] > 1 else ""
        about += f" ({parameter['unit']}{step})"
    yield f"gen.add({quoted(parameter['name'])}, {kind}, 0,"
    yield f"        {quoted(about)},"
    value = parameter["default"]
    if kind == "str_t":
        yield f"        {quoted(value)}, edit_method=choice("
        yield f"            {quoted(parameter['name'])},"
        pairs = [f"({quoted(choice['name'])}, {quoted(choice['about'])})"
                 for choice in parameter["choices"]]
        yield ",\n".join(f"            {pair}" for pair in pairs) + "))"
    elif kind == "bool_t":
        yield f"        {value})"
    else:
        convert = float if kind == "double_t" else int
        yield "        " + ", ".join(
            repr(convert(n)) for n in (value, parameter["min"], parameter["max"])) + ")"


def reconfigure(spec, text):
    lines = [line for parameter in spec["parameters"] for line in reconfigure_lines(parameter)]
    return replace_part(text, "\n".join(lines), "#")


COLUMN = 29  # of the comments in stereo.yaml


def yaml_lines(parameter):
    value = default(parameter)
    if parameter["type"] == "double":
        value = repr(float(value))
    limits = ""
    if parameter["type"] in ("int", "double"):
        limits = f"{parameter['unit']}, " if parameter["unit"] else ""
        limits += f"{number(parameter['min'])}..{number(parameter['max'])}"
        limits += f" in steps of {parameter['step']}: " if parameter["step"] > 1 else ": "
    elif parameter["choices"]:
        limits = " | ".join(choice["name"] for choice in parameter["choices"]) + ": "
    mark = "# " if parameter.get("unset") else ""
    start = f"{mark}{parameter['name']}: {value}".ljust(COLUMN)
    further = " " * COLUMN + "#   "
    yield wrapped(limits + parameter["about"], start + "# ", further)
    for line in parameter["note"]:
        yield further + line


def settings(spec, text):
    lines, group = [], None
    for parameter in spec["parameters"]:
        if parameter["group"] != group:
            lines += [""] * (group is not None)
            group = parameter["group"]
            lines.append(f"# --- {group} ".ljust(96, "-"))
        lines += yaml_lines(parameter)
    return replace_part(text, "\n".join(lines), "#")
