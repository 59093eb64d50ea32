"""Ctrl-C is neither lost where Python drops exceptions nor raised within an import."""

import signal
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from time import sleep

import pytest

from rps_exudyn.base import interrupts
from rps_exudyn.base.interrupts import arm, disarm


@pytest.fixture(autouse=True)
def as_before() -> Iterator[None]:
    before, report = signal.getsignal(signal.SIGINT), sys.unraisablehook
    yield
    sys.unraisablehook = report
    signal.signal(signal.SIGINT, before)


def in_a_finalizer() -> None:
    class Dying:
        def __del__(self) -> None:
            signal.raise_signal(signal.SIGINT)

    Dying()


def in_an_import() -> None:
    import interrupted_module  # type: ignore[import-not-found]

    assert interrupted_module.done


@pytest.mark.parametrize("work", [in_a_finalizer, in_an_import])
def test_ctrl_c_comes_later(
    work: Callable[[], None], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "interrupted_module.py").write_text("import signal\nsignal.raise_signal(2)\ndone = True\n")
    monkeypatch.syspath_prepend(tmp_path)

    def then_wait() -> None:
        arm()  # not in a fixture: pytest before 8.4 has a hook of its own within each test
        work()
        sleep(600)

    with pytest.raises(KeyboardInterrupt):
        then_wait()
    assert ("interrupted_module" in sys.modules) == (work is in_an_import)


def test_ctrl_c_that_waits_when_all_is_done_is_no_success(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(interrupts, "_postponed", False)
    monkeypatch.setattr("_thread.start_new_thread", lambda *_: None)
    arm()
    in_a_finalizer()
    with pytest.raises(KeyboardInterrupt, match="when all was done"):
        disarm()
