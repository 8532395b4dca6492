"""Finds the shell commands that the documents print."""
import pathlib
import re

ROOT = pathlib.Path(__file__).resolve().parents[2]
DOCUMENTS = ["README.md", *sorted(f"docs/{p.name}" for p in (ROOT / "docs").glob("*.md")),
             "fpga_fw/README.md", "fpga_fw/boards/ulx3s_85f/README.md"]
# First lines of indented blocks that are no commands.
NO_COMMANDS = ("# ft232h.conf,",)


def blocks(text):
    """Yields heading and lines of each indented or fenced block."""
    heading, block, fenced, after_blank = "", [], False, True
    for line in text.splitlines() + [""]:
        if line.startswith("```"):
            fenced = not fenced
            line = ""
        elif line.startswith("#") and not fenced:
            heading = line.strip("# ")
        in_block = fenced or (line.startswith("    ") and (after_blank or block))
        if in_block and line.strip():
            block.append(line if fenced else line[4:])
        elif block:
            yield heading, block
            block = []
        after_blank = not line.strip()


def commands_of(block):
    """Joins continued lines, and removes comments."""
    text = re.sub(r"\\\n\s*", "", "\n".join(block))
    for line in text.splitlines():
        line = re.sub(r"(^|\s+)# .*$", "", line).strip()
        if line:
            yield line


def printed_commands(document):
    """Returns the commands of a document by section: (document, heading)."""
    found = {}
    for heading, block in blocks((ROOT / document).read_text(encoding="utf-8")):
        if not block[0].startswith(NO_COMMANDS):
            found.setdefault((document, heading), []).extend(commands_of(block))
    return found


def block_after(document, first_line):
    """Returns the text of the block that begins with this text."""
    for _, block in blocks((ROOT / document).read_text(encoding="utf-8")):
        if block[0].startswith(first_line):
            return "\n".join(block) + "\n"
    raise LookupError(f"{document} has no block that begins with {first_line}")
