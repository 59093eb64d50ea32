"""Tests are limited in CPU time, not in elapsed time: what only waits, as on a busy machine, passes."""

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
TESTS = """
import os, signal, subprocess, sys, time
import pytest

BUSY = "while True: pass"

def test_waiting():
    time.sleep(2.5)

def test_busy():
    exec(BUSY)

def test_busy_child_of_a_child():
    started = f"import subprocess, sys; subprocess.run([sys.executable, '-c', {BUSY!r}])"
    with subprocess.Popen([sys.executable, "-c", started], start_new_session=True) as child:
        try:
            child.wait()
        finally:
            os.killpg(child.pid, signal.SIGKILL)

@pytest.fixture
def busy():
    exec(BUSY)

def test_busy_set_up(busy):
    pass

@pytest.mark.cpu_limit(60)
def test_limit_of_its_own():
    end = time.process_time() + 2.5
    while time.process_time() < end:
        pass
"""


def test_cpu_time_is_limited_and_elapsed_time_is_not(tmp_path: Path) -> None:
    """By the suite's own settings, but for the limit: one second."""
    (tmp_path / "test_them.py").write_text(TESTS)
    settings = ["-c", str(ROOT / "pyproject.toml"), "-p", "conftest", "-n", "0", "-o", "cpu_limit=1"]
    done = subprocess.run(
        [sys.executable, "-m", "pytest", *settings, "--timeout", "60", "-v", str(tmp_path)],
        env={**os.environ, "PYTHONPATH": str(ROOT / "tests"), "COLUMNS": "200"},
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    for name in ("waiting", "limit_of_its_own"):
        assert f"::test_{name} PASSED" in done.stdout
    for name in ("busy", "busy_child_of_a_child", "busy_set_up"):
        assert f"::test_{name} - Failed: it takes more than 1 s of CPU time" in done.stdout
