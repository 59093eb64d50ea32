"""Ctrl-C is neither lost where Python drops exceptions nor raised within an import."""

import ctypes
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from time import sleep

import pytest

from rps_exudyn.__main__ import main
from rps_exudyn.base import interrupts
from rps_exudyn.base.compiled import NUMBER, Entry
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


def cleared(work: Callable[[], None]) -> None:
    with suppress(KeyboardInterrupt):  # as extension modules do that look for an attribute
        work()


@pytest.mark.parametrize(
    "work", [in_a_finalizer, lambda: cleared(lambda: signal.raise_signal(signal.SIGINT))]
)
def test_ctrl_c_that_is_lost_is_no_success(work: Callable[[], None], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(interrupts, "_pressed", False)
    monkeypatch.setattr("_thread.start_new_thread", lambda *_: None)
    arm()
    work()
    assert disarm()


def test_a_command_states_that_it_was_interrupted(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(interrupts, "_pressed", False)
    monkeypatch.setattr(
        "rps_exudyn.cli.main.main", lambda: cleared(lambda: signal.raise_signal(signal.SIGINT)) or 0
    )
    signal.signal(signal.SIGINT, signal.default_int_handler)
    assert main() == 130
    assert "interrupted at the end" in capsys.readouterr().err


def test_a_signal_while_arguments_are_passed_is_an_interrupt() -> None:
    def refuse(*_: object) -> None:
        raise ctypes.ArgumentError("a function returned a result with an exception set")

    law = Entry(lambda number: None, (NUMBER,))
    vars(law)["_code"] = refuse
    with pytest.raises(KeyboardInterrupt):
        law.bound(1.0)()
