"""board capture, whose disparities are compared with those of match."""
import csv
import pathlib
import signal
import subprocess

from gadget import count_matched
from machine import PATIENCE, PROGRAMS, fail, say, wait_for


class Capture:
    """board capture, which reopens the board whenever it loses it."""
    number = 0

    def __init__(self):
        Capture.number += 1
        self.folder = pathlib.Path(f"captured{Capture.number}")
        self.process = subprocess.Popen(
            [PROGRAMS / "board", "capture", "usb", "100000", "--out", self.folder, "--timeout", f"{PATIENCE}",
             "--wait", f"{PATIENCE}", "--verbose"], text=True, stdout=subprocess.PIPE,
            stderr=open(f"{self.folder}.log", "w"))
        wait_for(lambda: self.count() >= 2, "frame")

    def rows(self):
        try:
            with open(self.folder / "frames.csv", newline="") as table:
                return list(csv.DictReader(table))
        except OSError:
            return []

    def count(self):
        return sum(1 for row in self.rows() if row["file"])

    def frame_after(self, count, what="frame"):
        """Waits for a frame more than `count`. Returns the seconds."""
        if self.process.poll() is not None:
            fail(f"board capture ended: {self.process.stdout.read()}")
        return wait_for(lambda: self.count() > count, what)[1]

    def next_frames(self):
        """Waits for frames that the board has made after now."""
        self.frame_after(self.count() + 3)

    def finish(self, pairs):
        """Ends the capture. Returns how many disparities came; all must be right."""
        self.process.send_signal(signal.SIGINT)
        text = self.process.communicate(timeout=PATIENCE)[0]
        print(text, end="")
        count = count_matched(self.folder / "disparity", pairs)
        print(pathlib.Path(f"{self.folder}.log").read_text(), end="")
        dropped = sum(1 for row in self.rows() if not row["file"])
        say(f"{count} disparities equal those of match, bit for bit; {dropped} frame sets dropped")
        return count
