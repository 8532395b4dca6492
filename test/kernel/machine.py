"""Helpers for programs that run in the emulated machine."""
import contextlib
import pathlib
import subprocess
import sys
import time

PROGRAMS = pathlib.Path(sys.argv[1])
PATIENCE = 120  # s; the machine is emulated, and shares its processors


def say(text):
    print(f"[{time.monotonic():7.2f}] {text}", flush=True)


def last_lines(text, count):
    return "\n".join(text.splitlines()[-count:])


def fail(what):
    """Ends with what the programs have noted and are doing, and with the end of the kernel's log."""
    for log in sorted(pathlib.Path().glob("*.log")):
        print(f"{log}:\n{last_lines(log.read_text(), 20)}")
    for task in pathlib.Path("/proc").glob("[0-9]*/task/[0-9]*"):
        with contextlib.suppress(OSError):
            if (task / "../../exe").resolve().parent == PROGRAMS.resolve():
                print(f"thread {(task / 'comm').read_text()}{(task / 'stack').read_text()}")
    print(last_lines(subprocess.run(["dmesg", "--color=never"], text=True, stdout=subprocess.PIPE).stdout, 40))
    raise SystemExit(what)


def wait_for(condition, what, seconds=PATIENCE):
    """Returns the first true value of the condition, and the seconds that it took."""
    begin = time.monotonic()
    while not (value := condition()):
        if time.monotonic() - begin > seconds:
            fail(f"no {what} within {seconds} s")
        time.sleep(0.01)
    return value, time.monotonic() - begin


def expect(condition, what):
    if not condition:
        fail(what)


def program(name, *arguments, prefix=()):
    """Runs a program, which must succeed. Returns what it printed."""
    done = subprocess.run([*prefix, PROGRAMS / name, *arguments], text=True, timeout=3 * PATIENCE,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    expect(done.returncode == 0, f"{name} {' '.join(arguments)}: exit code {done.returncode}\n{done.stdout}")
    return done.stdout
