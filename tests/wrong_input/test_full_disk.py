"""A disk that is full after the run: the result is saved elsewhere, and a sentence says where."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from rps_exudyn import load
from shell import Command

FIT = """
import resource, signal, sys
from rps_exudyn.base.screen import silent
from rps_exudyn.cli.main import main
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, ({bytes}, {bytes}))  # no file may be larger
with silent():
    raise SystemExit(main())
"""
RUN = ["run", "--fidelity", "closed-form", "--out", "a.h5"]


def limited(
    arguments: list[str], folder: Path, size: int, **environment: str
) -> subprocess.CompletedProcess[str]:
    """The command where no file may be larger than `size` bytes, as if the disk were full there."""
    return subprocess.run(
        [sys.executable, "-c", FIT.format(bytes=size), *arguments],
        cwd=folder,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.fixture
def full(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """The current folder takes one byte, which a check before the run writes, and no more."""
    write = Path.write_bytes

    def write_bytes(path: Path, content: bytes) -> int:
        if path.resolve().parent == tmp_path and len(content) > 1:
            raise OSError(28, "No space left on device")
        return write(path, content)

    monkeypatch.setattr(Path, "write_bytes", write_bytes)


@pytest.mark.usefixtures("full")
def test_result_goes_to_the_temporary_folder(command: Command) -> None:
    answer = command(RUN)
    assert answer.status == 1
    assert "mean torque" in answer.out  # the summary is printed all the same
    problem = r"rps-exudyn: a\.h5 cannot be written: No space left on device\. "
    found = re.fullmatch(problem + r"The result is kept in (\S+) instead\.\n", answer.err)
    assert found
    assert load(found[1]).summary["torque_mean"] > 0
    assert not Path("a.h5").exists()


def test_nowhere_is_space(tmp_path: Path) -> None:
    answer = limited(RUN, tmp_path, 3000)
    assert answer.returncode == 1
    assert "Traceback" not in answer.stderr
    assert (
        "a.h5 cannot be written: File too large. The result could not be stored elsewhere either"
        in answer.stderr
    )
    assert "mean torque" in answer.stdout
    assert os.listdir(tmp_path) == []


def test_picture_that_does_not_fit_costs_no_result(command: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    from PIL import Image

    def save(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Image.Image, "save", save)
    answer = command(["run", "--fidelity", "closed-form", "--out", "a.h5"])
    if not load("a.h5").signals:
        pytest.skip("this model has nothing to draw")
    assert answer.status == 1
    assert answer.err.startswith("rps-exudyn: the picture is missing: a.png cannot be written")
    assert "mean torque" in answer.out


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full here")
def test_summary_that_cannot_be_printed_says_where_the_result_is(tmp_path: Path) -> None:
    with open("/dev/full", "w") as output:
        done = subprocess.run(
            [sys.executable, "-m", "rps_exudyn", *RUN],
            cwd=tmp_path,
            stdout=output,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
        )
    assert done.returncode == 2
    assert done.stderr == (
        "rps-exudyn: the output cannot be written: No space left on device. The result is kept in a.h5.\n"
    )
    assert load(tmp_path / "a.h5").summary


@pytest.mark.parametrize("subcommand", ["collect", "report"])
def test_studies_are_left_as_they_are(subcommand: str, study: Path, tmp_path: Path) -> None:
    before = sorted(path.name for path in study.rglob("*"))
    answer = limited([subcommand, "s"], tmp_path, 3000)
    assert answer.returncode == 2
    assert re.fullmatch(r"rps-exudyn: .+ cannot be written: File too large\..*\n", answer.stderr)
    assert sorted(path.name for path in study.rglob("*")) == before
