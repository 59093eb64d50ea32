"""A limit to the CPU time of a test and its children: a busy machine, where all takes longer, fails none.

pytest-timeout limits elapsed time besides, generously: for tests that wait for ever and compute nothing.
"""

import os
import signal
import threading
import time
from collections.abc import Generator
from types import FrameType

import psutil
import pytest

EVERY = 1.0  # [s] between two looks at the time used


class CpuLimit:
    """Fails a test whose set-up, call or tear-down takes more CPU time than `seconds`.

    A thread looks at the time used and signals the main thread: what is tested uses the process' own timers.
    Code that does not return to Python is not interrupted until it does. Children count as far as the system
    accounts for them: while they live, and when they have been waited for.
    """

    def __init__(self, seconds: float) -> None:
        self._default = self._seconds = seconds
        self._end = float("inf")
        self._process = psutil.Process()
        self._watching = False

    def pytest_runtest_protocol(self, item: pytest.Item) -> None:
        """Take the test's own limit, if it has one."""
        marker = item.get_closest_marker("cpu_limit")
        self._seconds = marker.args[0] if marker else self._default

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_setup(self) -> Generator[None]:
        """Limit the set-up."""
        return (yield from self._limited())

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_call(self) -> Generator[None]:
        """Limit the test."""
        return (yield from self._limited())

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_teardown(self) -> Generator[None]:
        """Limit the tear-down."""
        return (yield from self._limited())

    def _limited(self) -> Generator[None]:
        if not self._watching:
            self._watching = True
            signal.signal(signal.SIGXCPU, self._fail)
            threading.Thread(target=self._watch, name="CPU limit", daemon=True).start()
        self._end = self._used() + self._seconds
        try:
            return (yield)
        finally:
            self._end = float("inf")

    def _watch(self) -> None:
        while True:
            time.sleep(EVERY)
            if self._used() > self._end:
                signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGXCPU)

    def _fail(self, number: int, frame: FrameType | None) -> None:
        if self._end < float("inf"):  # it had not ended meanwhile
            pytest.fail(f"it takes more than {self._seconds:g} s of CPU time")

    def _used(self) -> float:
        """CPU time of this process and its children until now [s]."""
        ended = os.times()
        used = time.process_time() + ended.children_user + ended.children_system
        for child in self._process.children(recursive=True):
            try:
                used += sum(child.cpu_times()[:4])  # user, system, and both of its own children
            except psutil.Error:  # it has just ended
                continue
        return used
