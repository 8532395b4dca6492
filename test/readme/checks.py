"""Ways to check a command, for the tables of commands."""
import re

import data
from printed import ROOT
from world import Skipped

BOARD = "rosrun fpga_stereo virtual_board --usb --images left.png right.png --rate 10 -- "
SIZE_OF_DISPARITY = f"height: {data.HEIGHT}\n *width: {data.WIDTH}"


def elsewhere(reason):
    """The test `reason` runs the command."""
    def check(_, text):
        assert not text.startswith("scripts/") or (ROOT / text).stat().st_mode & 0o100
        raise Skipped(reason)
    return check


def prints(pattern, before=""):
    """The command ends and prints the pattern."""
    def check(world, text):
        out = world.run(before + text)
        assert re.search(pattern, out), f"{pattern} is not in:\n{out}"
    return check


def writes(*files, prepare=""):
    """The command ends and writes these files, none of them empty."""
    def check(world, text):
        world.run(prepare + text)
        for file in files:
            assert (world.folder / file).stat().st_size > 0, file
    return check


def publishes(topics, fixture=None, before="", change=lambda world, text: text):
    """The command runs until it is stopped, and each topic has a message with the pattern."""
    def check(world, text):
        world.need_master()
        command = before + change(world, text)
        for topic in topics:
            world.hear(topic)
        world.start("command", command)
        if fixture:
            fixture(world)
        for topic, pattern in topics.items():
            world.heard(topic, pattern)
        world.stop("command")
    return check


def calls(world, expected):
    """Checks that a program of the test was called."""
    log = (world.top / "calls").read_text(encoding="utf-8")
    assert expected in log, log
