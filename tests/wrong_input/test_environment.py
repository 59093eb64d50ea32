"""A closed pipe, a full disk, a poor terminal, a lost folder, numbers beyond all sizes: no traceback."""

import os
import shutil
from pathlib import Path

import pytest

from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.gear import Setup
from shell import Command, in_fresh_process, refusal_of

NUMBERS = [item.path for item in Setup.declared() if item.field.annotation is float]


def test_reader_that_has_seen_enough(tmp_path: Path) -> None:
    done = in_fresh_process("rps-exudyn describe --json | head -1", tmp_path)
    assert (done.stdout, done.stderr) == ("{\n", "")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full here")
@pytest.mark.parametrize("arguments", ["describe", "describe --json"])
def test_output_on_a_full_disk(tmp_path: Path, arguments: str) -> None:
    done = in_fresh_process(f"rps-exudyn {arguments} > /dev/full", tmp_path)
    assert done.returncode == 2
    assert done.stderr == "rps-exudyn: the output cannot be written: No space left on device.\n"


def test_terminal_without_greek_letters(tmp_path: Path) -> None:
    done = in_fresh_process("rps-exudyn run --fidelity closed-form", tmp_path, PYTHONIOENCODING="ascii")
    assert done.returncode == 0
    assert "mean torque" in done.stdout


def test_drawing_backend_that_does_not_exist(tmp_path: Path) -> None:
    assert (
        in_fresh_process("rps-exudyn run --fidelity closed-form", tmp_path, MPLBACKEND="nonsense").returncode
        == 0
    )
    assert (tmp_path / "free-pinion-torque.png").exists()


def test_folder_that_is_gone(tmp_path: Path) -> None:
    gone = tmp_path / "gone"
    gone.mkdir()
    done = in_fresh_process(f"rmdir {gone}; rps-exudyn describe", gone)
    assert done.returncode == 2
    assert done.stderr.startswith("rps-exudyn: the current folder does not exist any more")


@pytest.mark.parametrize("path", NUMBERS)
@pytest.mark.parametrize("value", [1e308, -1e308, 1e-308])
def test_number_beyond_all_sizes(path: str, value: float) -> None:
    """Its powers are no numbers a computer knows; it is refused before anything is computed with it."""
    with pytest.raises(InputError, match=path):
        Setup().replace({path: value})


def test_rerun_does_not_replace_the_result_that_it_repeats(command: Command) -> None:
    assert command(["run", "--fidelity", "closed-form", "--out", "a.h5"]).status == 0
    assert "name another file" in refusal_of(command(["rerun", "a.h5", "--out", "a.h5"]))


ONLY_POSIX = """
import os, signal, sys
for name in ("fcntl", "resource", "pwd", "grp", "termios", "tty"):
    sys.modules[name] = None
for name in ("geteuid", "getuid", "sched_getaffinity", "sysconf", "fork", "O_NONBLOCK", "getloadavg"):
    if hasattr(os, name):
        delattr(os, name)
for name in ("setitimer", "alarm", "SIGALRM", "SIGHUP", "ITIMER_REAL"):
    delattr(signal, name)
"""
"""Hides what Windows does not have, in each process that starts."""


def test_runs_and_studies_need_nothing_that_windows_lacks(tmp_path: Path) -> None:
    """Only its names: a real Windows has not been tried."""
    (tmp_path / "sitecustomize.py").write_text(ONLY_POSIX, encoding="utf-8")
    study = '[[axis]]\npath = "yoke.preload"\nvalues = [200, 300]\n'
    (tmp_path / "two.toml").write_text(f'fidelity = "closed-form"\n{study}', encoding="utf-8")
    root = Path(__file__).parents[2]
    for line in (
        "run --fidelity closed-form --time-limit '60 s'",
        "study two.toml --jobs 2",
        "collect two --out two.mat",
        "report two --out two.html",
    ):
        paths = os.pathsep.join((str(tmp_path), str(root)))
        done = in_fresh_process(f"rps-exudyn {line}", tmp_path, PYTHONPATH=paths)
        assert done.returncode == 0, done.stderr
    assert (tmp_path / "two.mat").exists()


@pytest.mark.skipif(shutil.which("bash") is None, reason="no bash here")
def test_shell_completes_commands_and_options(tmp_path: Path) -> None:
    """As docs/commands.md prints it: the script that bash loads from the reader's home."""
    home = {"HOME": str(tmp_path), "SHELL": "/bin/bash"}
    assert in_fresh_process("rps-exudyn --install-completion", tmp_path, **home).returncode == 0
    (script,) = tmp_path.rglob("rps-exudyn")

    def completions(*words: str) -> list[str]:
        typed = f"COMP_WORDS=(rps-exudyn {' '.join(words)}); COMP_CWORD={len(words)}; _rps_exudyn"
        line = f'bash -c \'. {script}; {typed}; printf "%s\\n" "${{COMPREPLY[@]}}"\''
        return in_fresh_process(line, tmp_path).stdout.split()

    assert {"schema", "show", "study"} <= set(completions("s"))
    assert completions("run", "--fid") == ["--fidelity"]
    assert completions("schema", "st") == ["study"]
