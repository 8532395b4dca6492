"""What must come of each command that the documents print, by section, in the order of printing."""
import re

import data
from checks import BOARD, SIZE_OF_DISPARITY, calls, elsewhere, prints, publishes, writes
from printed import ROOT, block_after
from readme_commands import MATCH, README, calibrate, reload_udev, udev
from world import Skipped, copy_of_sources


def configure(world, text):
    copy = world.top / "clone"
    if not copy.exists():
        copy_of_sources(copy)
    world.run(f"cd {copy} && {text}")


def setup_file_of_clone(world, text):
    clone = world.top / "clone"
    found = world.run(f"cd {clone} && {text} && rospack find fpga_stereo").strip()
    assert found == str(clone), f"rospack finds the package in {found}"


def probe_serial(world, text):
    line = world.top / "ttyUSB0"
    world.start("board", f"exec rosrun fpga_stereo virtual_board --pty {line}")
    world.wait("the virtual board", lambda: "ready" in world.output("board"))
    prints(r"disparities +64\n")(world, text.replace("/dev/ttyUSB0", str(line)))


def record(world, text):
    world.run(BOARD + text)
    assert (world.folder / "link.rec").stat().st_size > data.WIDTH * data.HEIGHT


def transforms(world, text):
    world.need_master()
    world.hear("/tf_static", messages=3, arrays=True)
    world.start("command", text)
    frames = ("base_link", "front_link", "front_left_optical_frame")
    children = (*frames[1:], "front_right_optical_frame")
    world.heard("/tf_static", *(f' frame_id: "{parent}"\n *child_frame_id: "{child}"'
                                for parent, child in zip(frames, children)))
    world.stop("command")


def simulate(world, text):
    if not world.succeeds("command -v verilator"):
        raise Skipped("verilator is not installed")
    writes("OUT.png" if "OUT.png" in text else "disparity.png")(
        world, text.replace("LEFT RIGHT", "left.png right.png"))


def on_folder(folder, *files):
    return lambda world, text: writes(*files)(world, re.sub("[A-Z_0-9]+_FOLDER", folder, text))


def in_sources(pattern, option=""):
    """The command runs in the sources, with an option that keeps it short."""
    return lambda world, text: prints(pattern)(world, f"cd {ROOT} && {text} {option}")


def eeprom(world, text):
    world.add_program("ftdi_eeprom", f'grep -q cha_type=FIFO "$2" && echo "ftdi_eeprom $*" >>{world.top}/calls')
    conf = block_after("fpga_fw/boards/ulx3s_85f/README.md", "# ft232h.conf,")
    (world.folder / "ft232h.conf").write_text(conf, encoding="utf-8")
    world.run(text)
    calls(world, "ftdi_eeprom --flash-eeprom ft232h.conf")


def flash(world, text):
    world.run("mkdir -p build/ulx3s_85f/name/speed && echo x >build/ulx3s_85f/name/speed/top.bit")
    world.run(text)
    calls(world, "openFPGALoader --board ulx3s --write-flash build/ulx3s_85f/name/speed/top.bit")


MAKE_BOARD = "make -C fpga_fw/boards/ulx3s_85f"
OTHERS = {
    ("docs/build.md", "Build by hand"): [
        ("cmake -S . -B build/tree -DCATKIN_DEVEL_PREFIX=$PWD/devel", configure),
        ("cmake --build build/tree -- -j2", elsewhere("the test catkin_make builds everything")),
        ("source devel/setup.bash", setup_file_of_clone)],
    ("docs/build.md", "As a library, without ROS"): [
        ("cmake -S . -B build/library -DFPGA_STEREO_ROS=OFF -DBUILD_TESTING=OFF", configure),
        ("cmake --build build/library -- -j2", elsewhere("the test install builds it")),
        ("sudo cmake --install build/library", elsewhere("the test install installs it"))],
    ("docs/board.md", "Recordings of a link"): [
        ("rosrun fpga_stereo board record link.rec 10 --left-info left.yaml --right-info right.yaml "
         "--streams disparity,left,raw_left,raw_right", record),
        ("roslaunch fpga_stereo stereo.launch device:=replay:$PWD/link.rec "
         "left_info_url:=file://$PWD/left.yaml right_info_url:=file://$PWD/right.yaml",
         publishes({"/stereo/disparity": SIZE_OF_DISPARITY}))],
    ("docs/frames.md", "For a robot: a URDF"): [
        ("rosrun fpga_stereo make_bag frames --left-info left.yaml --right-info right.yaml --camera front "
         "--parent base_link --xyz \"0.3 0 0.25\" --rpy \"0 0.1 0\" > front.urdf", writes("front.urdf"))],
    ("docs/frames.md", "Without a URDF: static transforms"): [
        ("roslaunch fpga_stereo transforms.launch camera:=front parent:=base_link "
         "pose:=\"0.3 0 0.25 0 0.1 0\" left_info_url:=file://$PWD/left.yaml "
         "right_info_url:=file://$PWD/right.yaml", transforms)],
    ("docs/tools.md", "Disparity of files"): [
        ("rosrun fpga_stereo match left.png right.png disparity.png --disparity-range 96 "
         "--color picture.png", MATCH),
        ("rosrun fpga_stereo match left.png right.png disparity.pfm --left-info left.yaml "
         "--right-info right.yaml", writes("disparity.pfm")),
        ("rosrun fpga_stereo simulate left.png right.png disparity.png --disparity-range 16 --cycles",
         simulate)],
    ("docs/tools.md", "Errors"): [
        ("rosrun fpga_stereo evaluate MIDDLEBURY_V2_FOLDER --csv scores.csv --pictures scores/",
         on_folder("middlebury", "scores.csv")),
        ("rosrun fpga_stereo evaluate_raw EUROC_OR_CHESSBOARD_FOLDER", on_folder("chessboards"))],
    ("docs/tools.md", "Boards"): [
        ("rosrun fpga_stereo board probe /dev/ttyUSB0", probe_serial),
        ("rosrun fpga_stereo board compare usb left.png right.png --left-info left.yaml "
         "--right-info right.yaml", prints(r"all 7 stages are equal", BOARD))],
    ("docs/tools.md", "Bags and calibration files"): [
        ("rosrun fpga_stereo make_bag create pair.bag --left left/ --right right/ --left-info left.yaml "
         "--right-info right.yaml", writes("pair.bag", prepare="rm pair.bag; ")),
        ("rosrun fpga_stereo make_bag calibrate --left 'left*.jpg' --right 'right*.jpg' --board 9x6 "
         "--square 0.025 --left-info left.yaml --right-info right.yaml", calibrate),
        ("rosrun fpga_stereo make_bag extract pair.bag folder/",
         writes("folder/left/000000.png", "folder/right.yaml"))],
    ("fpga_fw/README.md", "Try it"): [
        ("rosrun fpga_stereo simulate LEFT RIGHT OUT.png --disparity-range 16 --cycles", simulate),
        (f"{MAKE_BOARD} help", in_sources("make program")),
        ("fpga_fw/syn/place_and_route --seeds 1-8 DISPARITIES=16", in_sources("seeds", "--help")),
        ("fpga_fw/syn/module_timing fs_input", in_sources("seeds", "--help")),
        ("test/rtl/mutate", in_sources("", "--check"))],
    ("fpga_fw/boards/ulx3s_85f/README.md", "Write the FT232H's EEPROM, once"): [
        ("rosrun fpga_stereo board udev > 70-fpga-stereo.rules && "
         "sudo cp 70-fpga-stereo.rules /etc/udev/rules.d/", udev),
        ("sudo udevadm control --reload && sudo udevadm trigger --subsystem-match=usb", reload_udev),
        ("sudo ftdi_eeprom --flash-eeprom ft232h.conf", eeprom)],
    ("fpga_fw/boards/ulx3s_85f/README.md", "Flash"): [
        (MAKE_BOARD, in_sources("nextpnr-ecp5", "-n")),
        (f"{MAKE_BOARD} program", in_sources("openFPGALoader", "-n")),
        ("rosrun fpga_stereo board flash --permanent build/ulx3s_85f/*/*/top.bit", flash)],
}

SECTIONS = {**{("README.md", heading): steps for heading, steps in README.items()}, **OTHERS}
