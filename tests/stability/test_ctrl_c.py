"""Ctrl-C at any moment of a command ends it, and the processes that it started, in one sentence."""

import random
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from study_files import write_grid

MOMENTS = 4  # of each command
COMMAND = """
import sys
from rps_exudyn.base.interrupts import arm
arm()
print("begun", flush=True)
from rps_exudyn.__main__ import main
sys.exit(main())
"""
LINES = {
    "run": "run --fidelity quasi-static --out {out}/a.h5",
    "band": "run --band --fidelity quasi-static --jobs 2 --out {out}/a.h5",
    "study": "study s.toml --out {out} --jobs 2",
    "fit": "fit measured.csv --out {out}/a.toml",
    "check": "check --json",
}


def begun(line: str, folder: Path) -> "subprocess.Popen[str]":
    """Start a command and return it as soon as Ctrl-C is its own; what is before it is Python's."""
    process = subprocess.Popen(
        [sys.executable, "-c", COMMAND, *line.split()],
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stdout
    assert process.stdout.readline() == "begun\n"
    return process


def interrupted(process: "subprocess.Popen[str]") -> bool:
    """Send Ctrl-C; return whether the command was not done yet: then it ignores Ctrl-C."""
    about = Path(f"/proc/{process.pid}/status")
    process.send_signal(signal.SIGSTOP)  # nothing changes in between
    while re.search(r"State:\t[^TZ]", about.read_text()):
        time.sleep(0.001)
    ignored = re.findall(r"SigIgn:\t(\w+)", about.read_text())
    process.send_signal(signal.SIGINT)
    process.send_signal(signal.SIGCONT)
    return not int(ignored[0], 16) >> (signal.SIGINT - 1) & 1


def runs_of(folder: Path) -> list[int]:
    """Processes in a folder."""
    found = []
    for each in Path("/proc").glob("[0-9]*"):
        try:
            if (each / "cwd").readlink() == folder:
                found.append(int(each.name))
        except OSError:  # over already
            continue
    return found


@pytest.mark.cpu_limit(1200)
@pytest.mark.parametrize("name", LINES)
def test_any_moment(name: str, tmp_path: Path) -> None:
    write_grid(tmp_path / "s.toml", *range(300, 340))
    table = "".join(f"{angle},{0.6 + 0.01 * (angle % 50) / 50}\n" for angle in range(361))
    (tmp_path / "measured.csv").write_text(f"pinion_angle [deg], pinion_torque [N m]\n{table}")
    random.seed(name)
    whole = None
    for number in range(MOMENTS + 1):  # the first one is left alone
        shutil.rmtree(tmp_path / "out", ignore_errors=True)
        (tmp_path / "out").mkdir()
        start = time.monotonic()
        with begun(LINES[name].format(out="out"), tmp_path) as process:
            caught = False
            if whole is not None:
                time.sleep(whole * (number - random.random()) / MOMENTS)
                caught = process.poll() is None and interrupted(process)
            out, err = process.communicate()
        whole = whole or time.monotonic() - start
        assert "Traceback" not in err
        assert "Exception ignored" not in err
        assert process.returncode in ((130,) if caught else (0, 1)), (out, err)
        assert len(re.findall("[Ii]nterrupted", out + err)) == caught
        while runs_of(tmp_path):
            time.sleep(0.01)  # until the limit of all tests
