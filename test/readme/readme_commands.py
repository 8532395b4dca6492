"""What must come of each command of the README, by section, in the order of printing."""
import re

import data
from checks import BOARD, SIZE_OF_DISPARITY, calls, elsewhere, prints, publishes, writes
from printed import ROOT
from world import Skipped

RULES = (ROOT / "config/70-fpga-stereo.rules").read_text(encoding="utf-8")


def setup_file(world, text):
    found = world.run(f"{text} && rospack find fpga_stereo").strip()
    assert found == str(ROOT), f"rospack finds the package in {found}"
    programs = ("board", "virtual_board", "match", "simulate", "make_bag")
    for program in programs:
        assert "Usage: " + program in world.run(f"rosrun fpga_stereo {program} --help")


def view(world, text):
    world.need_display()
    world.need_master()
    world.start("command", text)
    world.rviz_listens("/stereo/points2")
    world.hear("/tf_static", messages=2, arrays=True)
    world.heard("/tf_static", "child_frame_id: \"stereo_left_optical_frame")
    world.stop("command")


def replay(world, text):
    world.need_master()
    text = world.without_display(text)
    world.hear("/stereo/disparity")
    world.start("command", text)
    world.rviz_listens("/stereo/points2")
    world.heard("/stereo/disparity", SIZE_OF_DISPARITY)
    world.stop("command")


def replay_other_bag(world, text):
    """A bag with other names and frames, and without camera_info."""
    world.need_master()
    remaps = " ".join(f"/stereo/{side}/image_raw:=/front/{name}/image_raw"
                      for side, name in (("left", "cam0"), ("right", "cam1")))
    world.start("camera", f"exec rosbag play -q {world.folder}/pair.bag {remaps}")
    world.run("rosbag record -q --duration 20 -O other.bag /front/cam0/image_raw /front/cam1/image_raw")
    world.stop("camera")
    world.run("rm pair.bag && rosbag filter other.bag pair.bag "
              "\"setattr(m.header, 'frame_id', 'cam0') or True\"")
    text = world.without_display(text)
    world.hear("/front/disparity")
    world.hear("/front/cam0/camera_info")
    world.start("command", text)
    world.rviz_listens("/front/points2")
    world.heard("/front/disparity", SIZE_OF_DISPARITY)
    world.heard("/front/cam0/camera_info", "frame_id: \"?cam0")
    world.hear("/tf_static", messages=2, arrays=True)
    world.heard("/tf_static", "child_frame_id: \"cam0")
    world.stop("command")


def calibrator(world, text):
    """The topics and services that the calibrator is told to use exist with a board's cameras."""
    world.need_master()
    world.start("driver", BOARD + "roslaunch fpga_stereo stereo.launch")
    named = dict(word.split(":=") for word in text.split() if ":=" in word)
    for side in ("left", "right"):
        world.hear(named[side])
        world.heard(named[side], f"width: {data.WIDTH}")
        world.run(f"rosservice info {named[f'{side}_camera']}/set_camera_info")
    world.stop("driver")
    if not world.succeeds("rospack find camera_calibration"):
        raise Skipped("camera_calibration is not installed; its topics and services exist")
    raise Skipped("it needs a person; its topics and services exist")


def calibrate(world, text):
    for side in ("left", "right"):
        (world.folder / f"{side}.yaml").unlink()
    world.run(text)
    shift = re.search(r"projection_matrix:.*?data: \[(.*?)\]",
                      (world.folder / "right.yaml").read_text(encoding="utf-8"), re.DOTALL)
    values = [float(v) for v in shift.group(1).split(",")]
    assert abs(-values[3] / values[0] - 0.04) < 0.002, f"the baseline is {-values[3] / values[0]}"


def udev(world, text):
    world.run(text)
    rule = (world.etc / "udev/rules.d/70-fpga-stereo.rules").read_text(encoding="utf-8")
    assert rule == RULES, rule
    # rosrun writes its errors to standard output; they must not become a rule.
    assert world.run("rosrun fpga_stereo board udev") == RULES
    target = world.etc / "udev/rules.d/70-fpga-stereo.rules"
    target.unlink()
    broken = text.replace("fpga_stereo board", "fpga_stereo no_such_program")
    assert not world.succeeds(broken) and not target.exists(), "an error became a rule"


def reload_udev(world, text):
    world.run(text)
    calls(world, "udevadm control --reload")


def two_boards(world, text):
    for name in ("front", "rear"):
        world.start(f"board_{name}", "exec rosrun fpga_stereo virtual_board --pty "
                    f"{world.top}/{name} --images left.png right.png --rate 10")
    text = text.replace("usb:serial=FS000001", f"serial:{world.top}/front")
    text = text.replace("usb:serial=FS000002", f"serial:{world.top}/rear")
    publishes({"/front/left/image_raw": "frame_id: \"?front_left_optical_frame",
               "/rear/left/image_raw": "frame_id: \"?rear_left_optical_frame"})(world, text)


def virtual_board(world, text):
    world.start("board", text)
    world.wait("the virtual board", lambda: "ready" in world.output("board"))


def start_node(world, text):
    world.need_master()
    world.start("node", text)


def hz(world, text):
    world.run("until rostopic info /stereo/disparity; do sleep 0.5; done", timeout=120)
    world.start("hz", "exec " + text)
    world.wait("no rate", lambda: "average rate" in world.output("hz"))


MATCH = writes("disparity.png", "picture.png")
README = {
    "Try it": [("scripts/demo", elsewhere("it installs packages and takes minutes")),
               ("scripts/test", elsewhere("it runs this test")),
               ("source devel/setup.bash", setup_file)],
    "On your robot": [
        ("roslaunch fpga_stereo stereo.launch camera:=stereo",
         publishes({"/stereo/disparity": SIZE_OF_DISPARITY, "/stereo/points2": "point_step: 32",
                    "/stereo/depth": "encoding: \"?32FC1"}, lambda world: world.play_camera())),
        ("roslaunch fpga_stereo view.launch camera:=stereo", view)],
    "Your bag": [
        ("roslaunch fpga_stereo replay.launch bag:=/path/to.bag camera:=stereo view:=true", replay),
        ("roslaunch fpga_stereo replay.launch bag:=/path/to.bag camera:=front left:=cam0 right:=cam1 "
         "frame_id:=cam0 view:=true "
         "left_info_url:=file:///path/left.yaml right_info_url:=file:///path/right.yaml",
         replay_other_bag)],
    "Calibrate": [
        ("rosrun camera_calibration cameracalibrator.py --size 8x6 --square 0.108 "
         "left:=/stereo/left/image_raw right:=/stereo/right/image_raw left_camera:=/stereo/left "
         "right_camera:=/stereo/right", calibrator),
        ("rosrun fpga_stereo make_bag calibrate --left 'left*.jpg' --right 'right*.jpg' --board 9x6 "
         "--square 0.025 --left-info left.yaml --right-info right.yaml", calibrate)],
    "With a board": [
        ("rosrun fpga_stereo board udev > 70-fpga-stereo.rules && "
         "sudo cp 70-fpga-stereo.rules /etc/udev/rules.d/", udev),
        ("sudo udevadm control --reload", reload_udev),
        ("rosrun fpga_stereo board probe", prints(r"disparities +64\n", BOARD)),
        ("roslaunch fpga_stereo stereo.launch camera:=stereo",
         publishes({"/stereo/left/image_raw": "frame_id: \"?stereo_left_optical_frame",
                    "/stereo/right/camera_info": f"width: {data.WIDTH}"}, before=BOARD)),
        ("roslaunch fpga_stereo two_boards.launch front:=usb:serial=FS000001 "
         "rear:=usb:serial=FS000002", two_boards)],
    "Without hardware": [
        ("rosrun fpga_stereo virtual_board --pty /tmp/board --images left.png right.png --rate 10 &",
         virtual_board),
        ("roslaunch fpga_stereo stereo.launch device:=serial:/tmp/board "
         "left_info_url:=file://$PWD/left.yaml right_info_url:=file://$PWD/right.yaml", start_node),
        ("rostopic hz /stereo/disparity", hz)],
    "Without ROS": [
        ("rosrun fpga_stereo match left.png right.png disparity.png --disparity-range 96 "
         "--color picture.png", MATCH)],
}
