"""Formats numbers and lines, and replaces the marked part of a file."""
import json
import textwrap

NOTICE = "Generated from fpga_fw/spec/spec.yaml by fpga_fw/tools/generate_spec: do not edit."


def digits(value, bits=32):
    return f"{value:0{bits // 4}X}"


def quoted(text):
    return json.dumps(text)  # a JSON string is a C++ and a Python string


def sentence(text):
    return text[0].upper() + text[1:]


def wrapped(text, start="", then=None):
    """Returns `text` in lines of at most 100 columns; the first begins with `start`.

    The others begin with `then`, or with `start` if there is no `then`.
    """
    return textwrap.fill(text, 100, initial_indent=start,
                         subsequent_indent=start if then is None else then)


def commented(lines, indent=""):
    """Returns (code, about) pairs as lines whose comments stand in one column."""
    column = max(len(code) for code, _ in lines)
    return "\n".join(f"{indent}{code:{column}}  // {about}" for code, about in lines)


def number(value):
    """33, 0.5: without trailing zeros."""
    return f"{value:g}"


def allowed(parameter):
    """Returns the allowed values in words, as allowed_values() in core does."""
    if parameter["choices"]:
        return " or ".join(choice["name"] for choice in parameter["choices"])
    if parameter["type"] == "bool":
        return "true or false"
    text = f"{number(parameter['min'])} to {number(parameter['max'])}"
    return text + (f" in steps of {parameter['step']}" if parameter["step"] > 1 else "")


def default(parameter):
    """Returns the default as text: true, 33, sparse."""
    value = parameter["default"]
    if isinstance(value, bool):
        return str(value).lower()
    return value if isinstance(value, str) else number(value)


def replace_part(text, part, comment, end=""):
    """Returns `text` with `part` between its two markers, which are comments of its language."""
    begin = f"{comment} Begin of generated part (fpga_fw/tools/generate_spec): do not edit.{end}\n"
    finish = f"{comment} End of generated part.{end}\n"
    head, found, rest = text.partition(begin)
    _, closed, tail = rest.partition(finish)
    if not found or not closed:
        raise ValueError(f"markers of the generated part are missing: {begin.strip()}")
    return f"{head}{begin}{part}\n{finish}{tail}"
