"""Runs the commands of the documents: a folder with test data, a ROS master, processes, a display."""
import contextlib
import os
import pathlib
import re
import shutil
import signal
import socket
import subprocess
import tempfile
import time

import data
from printed import ROOT

PATIENCE_S = 120  # for anything that other programs on this machine may delay


class Skipped(Exception):
    """Why a command cannot be run here."""


def free_port():
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


class World:
    def __init__(self, devel, models):
        self.devel, self.models = pathlib.Path(devel).resolve(), pathlib.Path(models).resolve()
        self.top = pathlib.Path(tempfile.mkdtemp(prefix="fpga_stereo_readme_"))
        self.base, self.folder, self.bin = self.top / "base", self.top / "work", self.top / "bin"
        self.etc = self.top / "etc"
        self.processes, self.display = {}, None
        self.environment = {
            **os.environ, "ROS_MASTER_URI": f"http://127.0.0.1:{free_port()}", "ROS_IP": "127.0.0.1",
            "ROS_HOME": str(self.top / "ros"), "PYTHONUNBUFFERED": "1", "ROS_LOG_DIR": str(self.top / "ros/log"),
            "XDG_CACHE_HOME": str(self.top / "cache"),
            "PATH": f"{self.bin}:/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin"}
        self.environment.pop("ROS_HOSTNAME", None)
        self.environment.pop("DISPLAY", None)

    def __enter__(self):
        for folder in (self.base, self.bin, self.etc / "udev/rules.d", self.top / "ros/log",
                       self.top / "cache"):
            folder.mkdir(parents=True)
        (self.top / "cache/fpga_stereo").symlink_to(self.models)
        data.write_all(self.base)
        (self.base / "devel").symlink_to(self.devel)
        # sudo, for commands that would change this machine: files of /etc go to a folder of the test.
        self.add_program("sudo", f'args=()\nfor a; do args+=("${{a//\\/etc\\//{self.etc}/}}"); done\n'
                                 'exec "${args[@]}"')
        for name in ("udevadm", "openFPGALoader", "fujprog"):
            self.add_program(name, f'echo "{name} $*" >>{self.top}/calls')
        self.renew_folder()
        self.run("rosrun fpga_stereo make_bag create pair.bag --left left.png --right right.png "
                 "--left-info left.yaml --right-info right.yaml --rate 3 --repeat 90")
        shutil.move(self.folder / "pair.bag", self.base / "pair.bag")
        self.renew_folder()
        return self

    def __exit__(self, *_):
        self.end_of_section()
        for name in list(self.processes):
            self.stop(name)
        shutil.rmtree(self.top, ignore_errors=True)

    def add_program(self, name, body):
        path = self.bin / name
        path.write_text(f"#!/bin/bash\n{body}\n", encoding="utf-8")
        path.chmod(0o755)

    def renew_folder(self):
        shutil.rmtree(self.folder, ignore_errors=True)
        shutil.copytree(self.base, self.folder, symlinks=True, copy_function=os.link)

    def end_of_section(self):
        """Ends all programs but the display, and restores the folder. A new section has a new master,
        so that the parameters of another one do not hold in it."""
        for name in list(self.processes):
            if name != "Xvfb":
                self.stop(name)
        self.renew_folder()

    # --- commands ---

    def shell(self, text):
        """Returns the command for a shell in which the setup file has been sourced."""
        replacements = {"/path/to.bag": str(self.folder / "pair.bag"), "file:///path": f"file://{self.folder}",
                        "/tmp/board": str(self.top / "board")}
        for what, by in replacements.items():
            text = text.replace(what, by)
        return ["bash", "-c", f"set -o pipefail; . devel/setup.bash; {text}"]

    def run(self, text, timeout=10 * PATIENCE_S, code=0):
        """Runs a command to its end. Returns its standard output."""
        done = subprocess.run(self.shell(text), cwd=self.folder, env=self.environment, text=True,
                              timeout=timeout, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, check=False)
        assert done.returncode == code, f"exit code {done.returncode}: {done.stdout}{done.stderr}"
        return done.stdout

    def start(self, name, text):
        """Starts a command in the background. Its output goes to a file."""
        if name in self.processes:
            self.stop(name)
        with open(self.top / f"{name}.log", "w", encoding="utf-8") as log:
            self.processes[name] = subprocess.Popen(
                self.shell(text.removesuffix("&")), cwd=self.folder, env=self.environment,
                stdin=subprocess.DEVNULL, stdout=log, stderr=subprocess.STDOUT,
                start_new_session=True)

    def output(self, name):
        return (self.top / f"{name}.log").read_text(encoding="utf-8", errors="replace")

    def stop(self, name):
        """Ends a background command as Ctrl-C does."""
        process = self.processes.pop(name)
        for sign, patience in ((signal.SIGINT, 30), (signal.SIGTERM, 10), (signal.SIGKILL, 10)):
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, sign)
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(patience)
                return

    def wait(self, what, condition, patience=PATIENCE_S):
        end = time.monotonic() + patience
        while not condition():
            assert time.monotonic() < end, f"timeout: {what}\n" + "\n".join(
                f"--- {name}:\n{self.output(name)[-3000:]}" for name in self.processes)
            time.sleep(0.3)

    # --- ROS ---

    def need_master(self):
        if "roscore" not in self.processes:
            port = self.environment["ROS_MASTER_URI"].rsplit(":", 1)[1]
            self.start("roscore", f"exec roscore -p {port}")
            self.wait("roscore", lambda: self.succeeds("rosparam get /run_id"))
        self.run("rosparam set /use_sim_time false")

    def succeeds(self, text):
        with contextlib.suppress(AssertionError):
            self.run(text)
            return True
        return False

    def hear(self, topic, messages=1, arrays=False):
        """Starts to listen to the first messages of a topic, with or without the values of arrays."""
        self.start("echo" + topic.replace("/", "_"),
                   f"exec rostopic echo -n {messages} {'' if arrays else '--noarr'} {topic}")

    def heard(self, topic, *patterns):
        """Waits for the messages. Their text must contain each pattern."""
        name = "echo" + topic.replace("/", "_")
        self.wait(f"no message on {topic}", lambda: self.processes[name].poll() is not None)
        text = self.output(name)
        for pattern in patterns:
            assert re.search(pattern, text), f"{topic} does not contain {pattern}:\n{text}"
        self.stop(name)

    def play_camera(self):
        """Plays the pair as a camera driver on /stereo."""
        self.start("camera", "exec rosbag play -q pair.bag")

    def need_display(self):
        """Starts a virtual display; raises Skipped if there is no Xvfb."""
        if shutil.which("Xvfb") is None:
            raise Skipped("rviz needs a display, and Xvfb is not installed")
        if "Xvfb" in self.processes:
            return
        number = self.top / "display"
        self.start("Xvfb", f"exec Xvfb -displayfd 9 -screen 0 800x600x24 9>{number}")
        self.wait("Xvfb", lambda: number.exists() and number.read_text(encoding="utf-8").strip())
        self.environment.update(DISPLAY=":" + number.read_text(encoding="utf-8").strip(),
                                LIBGL_ALWAYS_SOFTWARE="1", QT_X11_NO_MITSHM="1")

    def without_display(self, text):
        """Returns the command without rviz if there is no display."""
        try:
            self.need_display()
        except Skipped:
            return text.replace("view:=true", "view:=false transforms:=true")
        return text

    def rviz_listens(self, topic):
        """Waits until rviz subscribes to the topic, if there is a display."""
        if "DISPLAY" in self.environment:
            self.wait(f"rviz does not listen to {topic}", lambda: self.succeeds(
                f"rostopic info {topic} | grep -q '/rviz '"))


def copy_of_sources(folder):
    """Copies the sources to `folder`, as a clone would have them."""
    def not_of_a_clone(at, names):
        is_top = pathlib.Path(at) == ROOT
        return [n for n in names if is_top and n.startswith((".git", "build", "devel", "demo_out"))]
    shutil.copytree(ROOT, folder, symlinks=True, ignore=not_of_a_clone)
