"""Runs the node with a virtual board on virtual USB, for measurements. The board repeats one pair and
caches its results, so it needs little processor time; it shares the machine with the node.
Needs a built tree (scripts/test)."""
import contextlib
import os
import pathlib
import random
import signal
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]


def enter_environment(devel):
    """Restarts this program in the environment of a development space."""
    if "FPGA_STEREO_BENCH" in os.environ:
        return
    os.environ.update(FPGA_STEREO_BENCH="1", ROS_HOSTNAME="localhost",
                      PATH="/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin")
    command = f". {devel}/setup.sh && exec python3 \"$@\""
    os.execvp("bash", ["bash", "-c", command, *sys.argv[:1], *sys.argv])


def write_pair(folder, width, height):
    """Writes a noise pair with a disparity of 20 px."""
    generator = random.Random(1)
    rows = [generator.randbytes(width + 20) for _ in range(height)]
    for name, offset in (("left", 0), ("right", 20)):
        with open(f"{folder}/{name}.pgm", "wb") as file:
            file.write(f"P5 {width} {height} 255\n".encode())
            file.write(b"".join(r[offset:offset + width] for r in rows))


def calibrate(width, height):
    import rospy
    from sensor_msgs.msg import CameraInfo
    from sensor_msgs.srv import SetCameraInfo
    f, cx, cy = width * 0.625, width / 2, height / 2
    for side, shift in (("left", 0.0), ("right", -f / 10)):
        info = CameraInfo(width=width, height=height, distortion_model="plumb_bob", D=[0.0] * 5)
        info.K = [f, 0, cx, 0, f, cy, 0, 0, 1]
        info.R = [1.0, 0, 0, 0, 1, 0, 0, 0, 1]
        info.P = [f, 0, cx, shift, 0, f, cy, 0, 0, 0, 1, 0]
        service = f"/stereo/{side}/set_camera_info"
        rospy.wait_for_service(service, 30)
        if not rospy.ServiceProxy(service, SetCameraInfo)(info).success:
            sys.exit(f"{service} refused the calibration")


def node_pid(devel, other_than=0):
    found = subprocess.run(["pgrep", "-f", f"^{devel}/lib/fpga_stereo/stereo"], text=True,
                           stdout=subprocess.PIPE, check=True)
    return next(pid for pid in map(int, found.stdout.split()) if pid != other_than)


@contextlib.contextmanager
def running(devel, width, height, board_options, node_options=()):
    """Runs the virtual board and the node /stereo/fpga_stereo. Yields the process of the board, whose
    standard input takes script lines."""
    programs = devel / "lib/fpga_stereo"
    with tempfile.TemporaryDirectory() as folder:
        os.environ.update(ROS_HOME=folder, ROS_LOG_DIR=folder)
        write_pair(folder, width, height)
        port = os.environ.get("ROS_MASTER_URI", "http://localhost:11311").rsplit(":", 1)[1].strip("/")
        master = subprocess.Popen(["roscore", "-p", port], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        time.sleep(3)
        board = subprocess.Popen(
            [programs / "virtual_board", "--usb", "--images", f"{folder}/left.pgm",
             f"{folder}/right.pgm", "--keep", "1", *board_options, "--", programs / "stereo",
             "__name:=fpga_stereo", *node_options],
            stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, env=dict(os.environ, ROS_NAMESPACE="stereo"))
        try:
            yield board
        finally:
            board.send_signal(signal.SIGINT)
            board.wait(20)
            master.terminate()
            master.wait(20)
