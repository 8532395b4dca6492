"""The virtual board of the test: its images, its program, and what the kernel's USB host shows of it."""
import contextlib
import pathlib
import random
import signal
import subprocess

from machine import PATIENCE, PROGRAMS, expect, program, wait_for

SERIAL, WIDTH, HEIGHT, RATE = "FS000009", 160, 120, 10
BUILD = ["--max-width", f"{WIDTH}", "--disparities", "16", "--census", "5", "--correlation", "5"]
MATCH = ["--stereo_algorithm", "window", "--disparity_range", "16", "--census_window_size", "5",
         "--correlation_window_size", "5"]
SETTINGS = ["--left-info", "left.yaml", "--right-info", "right.yaml", "--speckle_size", "20"]
DEVICES = pathlib.Path("/sys/bus/usb/devices")


def write_images():
    """Writes two pairs with a disparity of 7 px, and the calibration of ideal cameras."""
    generator = random.Random(1)
    for i in range(2):
        rows = [generator.randbytes(WIDTH + 7) for _ in range(HEIGHT)]
        for side, offset in (("left", 0), ("right", 7)):
            folder = pathlib.Path("images", side)
            folder.mkdir(parents=True, exist_ok=True)
            (folder / f"{i}.pgm").write_bytes(f"P5 {WIDTH} {HEIGHT} 255\n".encode() + b"".join(
                row[offset:offset + WIDTH] for row in rows))
    f = 100.0
    for side, shift in (("left", 0.0), ("right", -f / 10)):
        matrix = [f, 0, WIDTH / 2, 0, f, HEIGHT / 2, 0, 0, 1]
        projection = [f, 0, WIDTH / 2, shift, 0, f, HEIGHT / 2, 0, 0, 0, 1, 0]
        text = f"image_width: {WIDTH}\nimage_height: {HEIGHT}\ncamera_name: {side}\n"
        for name, rows, cols, data in (
                ("camera_matrix", 3, 3, matrix), ("distortion_coefficients", 1, 5, [0] * 5),
                ("rectification_matrix", 3, 3, [1, 0, 0, 0, 1, 0, 0, 0, 1]),
                ("projection_matrix", 3, 4, projection)):
            text += f"{name}:\n  rows: {rows}\n  cols: {cols}\n  data: {[float(v) for v in data]}\n"
        pathlib.Path(f"{side}.yaml").write_text(text + "distortion_model: plumb_bob\n")


def matched(extension="png"):
    """Returns the files that match writes for the two pairs."""
    files, out = set(), f"matched.{extension}"
    for i in range(2):
        program("match", f"images/left/{i}.pgm", f"images/right/{i}.pgm", out, *MATCH, *SETTINGS)
        files.add(pathlib.Path(out).read_bytes())
    expect(len(files) == 2, "both pairs have the same disparity")
    return files


def count_matched(folder, pairs):
    """Returns the number of disparities in a folder. All must be among those of match."""
    files = sorted(folder.iterdir())
    wrong = [file.name for file in files if file.read_bytes() not in pairs]
    expect(not wrong, f"{len(wrong)} of {len(files)} disparities differ from those of match: {wrong[:5]}")
    return len(files)


class Board:
    """A virtual board that is a USB gadget."""

    def __init__(self):
        self.process = subprocess.Popen(
            [PROGRAMS / "virtual_board", f"--gadget={SERIAL}", "--folder", "images", "--rate", f"{RATE}",
             "--keep", "2", "--threads", "1", "--waiting", "500000", *BUILD, "--script", "-"],
            text=True, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        line = self.process.stdout.readline()
        expect(line.startswith("ready "), f"the virtual board did not start: {line}")
        wait_for(device, "device")

    def script(self, line):
        self.process.stdin.write(line + "\n")
        self.process.stdin.flush()

    def replug(self):
        """Unplugs the board for 300 ms, and waits until the kernel has found it again."""
        number = attribute("devnum")
        self.script("unplug 300")
        wait_for(lambda: attribute("devnum") not in ("", number), "new device")

    def stop(self):
        self.process.send_signal(signal.SIGINT)
        expect(self.process.wait(PATIENCE) == 0, "the virtual board failed")

    def kill(self):
        self.process.kill()
        self.process.wait(PATIENCE)


def device():
    """Returns the folder of the board in sysfs, or None."""
    for folder in DEVICES.iterdir():
        with contextlib.suppress(OSError):
            if (folder / "serial").read_text().strip() == SERIAL and (folder / f"{folder.name}:1.0").exists():
                return folder
    return None


def attribute(name):
    """Reads an attribute of the board in sysfs; empty while there is no board."""
    with contextlib.suppress(OSError, TypeError):
        return (device() / name).read_text().strip()
    return ""


def driver():
    """Returns the name of the driver of the board's interface."""
    link = device() / f"{device().name}:1.0" / "driver"
    return link.resolve().name if link.exists() else ""


def node():
    """Returns the file of the board in usbfs."""
    return pathlib.Path(f"/dev/bus/usb/{int(attribute('busnum')):03}/{int(attribute('devnum')):03}")
