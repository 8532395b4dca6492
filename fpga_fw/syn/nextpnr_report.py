"""Reads a report of nextpnr (--report)."""
import re


def net_of(clock):
    """Returns the name of a clock's net without the affixes that nextpnr adds."""
    return clock.replace("$glbnet$", "").replace("$TRELLIS_IO_IN", "")


def plain(cell):
    """Returns the name of the net that a cell drives: cells are called .._TRELLIS_FF_Q_12 after it."""
    return re.sub(r"(_TRELLIS_FF|_CCU2C|_LUT4|_PFUMX|_L6MUX21|_DP16KD|_PDPW16KD|\$CCU2_|\$lut|\$glb).*",
                  "", cell)


def longest_path(report, clock, prefix=""):
    """Returns the logic levels of the longest path between registers of this clock, and its ends as
    text, without this prefix of their names."""
    for found in report["critical_paths"]:
        if found["from"].endswith(" " + clock) and found["to"].endswith(" " + clock):
            path = found["path"]
            levels = sum(step["type"] == "logic" for step in path)
            ends = path[0]["from"]["cell"], path[-1]["to"]["cell"]
            return levels, " -> ".join(plain(end).removeprefix(prefix) for end in ends)
    return 0, ""
