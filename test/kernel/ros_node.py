"""The ROS node with its board on USB, recorded by rosbag; its disparities are compared with those of match."""
import pathlib
import signal
import socket
import subprocess

from gadget import MATCH, count_matched, matched
from machine import PATIENCE, PROGRAMS, expect, program, say, wait_for

MASTER = ("127.0.0.1", 11311)
PARAMETERS = ["_backend:=board", "_device:=usb", "_left_info_url:=file:///tmp/left.yaml",
              "_right_info_url:=file:///tmp/right.yaml", "_speckle_size:=20",
              *(f"_{name[2:]}:={value}" for name, value in zip(MATCH[::2], MATCH[1::2]))]
TOPICS = ["/stereo/disparity", *(f"/stereo/{side}/{topic}" for side in ("left", "right")
                                 for topic in ("image_raw", "camera_info"))]


def recorder():
    """Returns the program that `rosbag record` starts."""
    for folder in ("/usr/lib/rosbag", "/opt/ros/noetic/lib/rosbag"):
        if (path := pathlib.Path(folder, "record")).exists():
            return path
    raise SystemExit("the program `record` of the package rosbag was not found")


class RosNode:
    """A ROS master, the node with its board, and a recorder of its topics."""

    def __init__(self):
        self.processes = []
        self.start("master", "rosmaster", "--core", "-p", f"{MASTER[1]}")
        wait_for(self.master_answers, "answer of the ROS master")
        self.start("recorder", recorder(), "--min-space", "10M", "-O", "/tmp/recorded.bag", *TOPICS)
        self.start("node", PROGRAMS / "stereo", "__ns:=stereo", *PARAMETERS)

    def start(self, name, *command):
        log = open(f"{name}.log", "w")
        self.processes.append(subprocess.Popen(command, stdout=log, stderr=subprocess.STDOUT))

    @staticmethod
    def master_answers():
        with socket.socket() as connection:
            return connection.connect_ex(MASTER) == 0

    @staticmethod
    def recorded_bytes():
        bag = pathlib.Path("recorded.bag.active")
        return bag.stat().st_size if bag.exists() else 0

    def stop(self):
        for process in reversed(self.processes):
            process.send_signal(signal.SIGINT)
            process.wait(PATIENCE)


def carries_a_ros_node(board):
    """The node publishes what the board computes, also after the board was unplugged."""
    pairs = matched("pfm")
    node = RosNode()
    wait_for(lambda: node.recorded_bytes() > 2e6, "2 MB of messages")
    board.replug()
    size = node.recorded_bytes()
    wait_for(lambda: node.recorded_bytes() > size + 2e6, "2 MB of messages after unplugging")
    node.stop()
    print(program("make_bag", "extract", "recorded.bag", "extracted"), end="")
    count = count_matched(pathlib.Path("extracted/disparity"), pairs)
    expect(count > 0, "the node published no disparity")
    say(f"{count} disparities of the ROS node equal those of match, bit for bit")
