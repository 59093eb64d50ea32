"""Answers to all that the page asks for, computed in processes beside this one.

The page's server and the widget hand over what they get, and send back what they are given. A state that
takes longer than `LONGEST`, without what is compiled for its scene, is given up; until then, it holds one
process, and the others answer all other tabs. Each kind of click has processes of its own, whose work can be
cancelled. The page can ask how far a curve or a click is.
"""

from collections import Counter, defaultdict
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from functools import partial
from queue import LifoQueue
from typing import Any

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.progress import Making, Progress, following, listening
from rps_exudyn.base.units import pretty
from rps_exudyn.pages.explore.on_request import KINDS, SIMULATION, WINDOW, FindWindow, on_request, window_of
from rps_exudyn.pages.explore.sliders import SLIDERS, SLOW, Answer, Wish, answer, scenes
from rps_exudyn.pages.explore.typed_limits import limits_of
from rps_exudyn.parameters.gear import SteeringGear, gear_file
from rps_exudyn.scenes import SCENE_NAMES
from rps_exudyn.scenes.free_pinion_torque import SCENE
from rps_exudyn.simulate.cases.processes import Processes
from rps_exudyn.simulate.cases.run_cases import available_processors
from rps_exudyn.simulate.cases.task import Task

LONGEST = 10.0  # that a state may take [s]
LONGEST_REQUESTED = 600.0  # that a click may take: it can be cancelled [s]
MOST_TABS = 4096  # of which the number of the last request is kept
_LATER = "longer than {}; download {} gear file and compute it by rps-exudyn"
TOO_LONG = f"These settings take {_LATER.format(f'{LONGEST:.0f} s', 'its')} run --gear."
TOO_LONG_REQUESTED = f"This takes {_LATER.format(f'{LONGEST_REQUESTED / 60:.0f} min', 'the')}."
CANCELLED = {"cancelled": True}
CURVE = "curve"
PATHS = ("sliders", CURVE, "gear", "limits", "progress", "cancel")  # beside those of clicks


@dataclass(frozen=True)
class Request:
    """What a page asks for, in which tab, as its which curve, and of which click."""

    wish: Wish
    tab: str
    number: int
    of: str

    @classmethod
    def from_page(cls, asked: Any) -> "Request":
        """Read what a page sends.

        Raises:
            InputError: it is no table with a state.
        """
        try:
            scene, both_ways = str(asked.get("scene", SCENE.name)), bool(asked.get("both_ways"))
            measured, is_draft = str(asked.get("measured", "")), bool(asked.get("draft"))
            wish = Wish(asked["state"], scene, both_ways, measured, is_draft, asked.get("limits"))
            tab, number = str(asked.get("tab", ""))[:40], int(asked.get("number", 0))
            return cls(wish, tab, number, str(asked.get("of", "")))
        except (ValueError, KeyError, TypeError, AttributeError, OverflowError):
            raise InputError("a request must be JSON with a state.") from None


@dataclass(eq=False)
class _Work:
    """Work that a curve or a click has begun, and how far it is."""

    processes: Processes | None = None  # None: it waits for one
    is_cancelled: bool = False
    text: str = "waiting for other answers"
    fraction: float | None = None

    def take(self, progress: Progress) -> None:
        self.text, self.fraction = progress.sentence, progress.fraction

    def take_code(self, step: Making) -> None:
        if step.sentence:
            self.text, self.fraction = step.sentence, None

    def begin(self, processes: Processes) -> None:
        self.processes, self.text = processes, "computing"

    def cancel(self) -> None:
        self.is_cancelled = True
        if self.processes is not None:
            self.processes.cancel()


class Answering:
    """Answers about one gear, with windows where a function finds them; use it in a `with` block, which ends
    its processes."""

    def __init__(self, gear: SteeringGear, find_window: FindWindow | None = None) -> None:
        self.gear = gear
        self.kinds = dict(KINDS)
        if find_window:
            self.kinds[WINDOW] = partial(window_of, find_window)
        self.paths = (*PATHS, *self.kinds)
        self._newest: dict[str, int] = {}
        self._works: dict[tuple[str, str], _Work] = {}
        self._prepared: defaultdict[Processes, set[str]] = defaultdict(set)  # scenes
        self._begun: list[Processes] = []
        count = max(2, available_processors())
        counts = dict.fromkeys(self.kinds, 1) | {SIMULATION: count, CURVE: count}
        self._free: dict[str, LifoQueue[Processes]]  # those that have begun come first
        self._free = {kind: LifoQueue() for kind in counts}
        for kind in Counter(counts).elements():
            self._add(kind)

    def _add(self, kind: str) -> None:
        """Have one process more for a kind of answers."""
        made = Processes(1, LONGEST if kind == CURVE else LONGEST_REQUESTED)
        self._begun.append(made)
        self._free[kind].put(made)

    def __enter__(self) -> "Answering":
        return self

    def __exit__(self, *_: object) -> None:
        for processes in self._begun:
            processes.__exit__()

    def warm_up(self) -> None:
        """Start a process, which compiles if need be, where a command shows it; others start when they are
        needed."""
        self.computed(Wish({}), "", 0)

    def task(self, wish: Wish) -> Task:
        """The call that answers a state."""
        usual = Wish({}, wish.scene)
        return Task(partial(answer, self.gear, wish), warm_up=partial(answer, self.gear, usual))

    def reply(self, path: str, asked: Request) -> Answer:
        """Answer a request of the page, one of `paths`."""
        if path == "sliders":
            return _controls(self.gear) | {"window": SCENE.name * (WINDOW in self.kinds)}
        if path in ("progress", "cancel"):
            work = self._works.get((asked.tab, asked.of))
            if work is not None and path == "cancel" and asked.of in self.kinds:
                work.cancel()
            return {} if work is None else {"text": work.text, "fraction": work.fraction}
        if path == CURVE:
            return self.computed(asked.wish, asked.tab, asked.number)
        if path in self.kinds:
            return self.requested(asked.wish, path, asked.tab)
        try:
            if path == "limits":
                return limits_of(asked.wish.limits)
            return {"file": gear_file(asked.wish.gear(self.gear))}
        except InputError as error:
            return {"problems": list(error.problems)}

    @contextmanager
    def _followed(self, tab: str, kind: str) -> Iterator[_Work]:
        """Work of which the page can ask how far it is."""
        work = self._works[tab, kind] = _Work()
        try:
            with following(work.take), listening(work.take_code):
                yield work
        finally:
            if self._works.get((tab, kind)) is work:
                del self._works[tab, kind]

    def computed(self, wish: Wish, tab: str, number: int) -> Answer:
        """One state's answer; "stale" where the same tab has asked for another meanwhile."""
        self._newest[tab] = max(number, self._newest.pop(tab, 0))
        while len(self._newest) > MOST_TABS:
            del self._newest[next(iter(self._newest))]
        with self._followed(tab, CURVE) as work:
            processes = self._free[CURVE].get()
            if number < self._newest.get(tab, number):
                self._free[CURVE].put(processes)
                return {"stale": True}
            work.begin(processes)
            return self._ask(processes, CURVE, self.task(wish), wish.scene) | {"number": number}

    def requested(self, wish: Wish, kind: str, tab: str = "") -> Answer:
        """The answer to a click; a tab's second click of a kind cancels its first one."""
        if (earlier := self._works.get((tab, kind))) is not None:
            earlier.cancel()
        answered, warm_up = self.kinds[kind], None
        if kind not in (SIMULATION, WINDOW):  # what is compiled for the others has no time limit
            warm_up = partial(on_request, self.gear, replace(wish, state={}), answered)
        task = Task(partial(on_request, self.gear, wish, answered), warm_up=warm_up)
        with self._followed(tab, kind) as click:
            processes = self._free[kind].get()
            click.begin(processes)
            if click.is_cancelled:
                self._free[kind].put(processes)
                return CANCELLED
            return self._ask(processes, kind, task)

    def _ask(self, processes: Processes, kind: str, task: Task, scene: str = "") -> Answer:
        """The answer of a process, which is free afterwards; one that was cancelled has a successor. What is
        compiled for the `scene` of a curve is on no clock."""
        try:
            if scene in SCENE_NAMES and scene not in self._prepared[processes]:
                self._prepare(processes, scene)
            answers = [found for _, found in processes.run(iter([task]))]
            if not answers:
                return CANCELLED
            if answers[0].timeout:
                self._prepared.pop(processes, None)  # its successor loads what is compiled anew
                return {"problems": [TOO_LONG if kind == CURVE else TOO_LONG_REQUESTED]}
            return dict(answers[0].returned())
        except InputError as error:
            return {"problems": list(error.problems)}
        finally:
            if processes.is_cancelled:
                processes.__exit__()
                with suppress(ValueError):
                    self._begun.remove(processes)
                self._add(kind)
            else:
                self._free[kind].put(processes)

    def _prepare(self, processes: Processes, scene: str) -> None:
        """Let a process compile what the scene needs."""
        usual, limit = self.task(Wish({}, scene)), processes.time_limit
        processes.time_limit = LONGEST_REQUESTED
        try:
            list(processes.run(iter([usual])))
        finally:
            processes.time_limit = limit
        self._prepared[processes].add(scene)


def _controls(gear: SteeringGear) -> Answer:
    meanings = {item.path: item.meaning for item in gear.declared()}
    sliders = [
        {
            "path": slider.path,
            "name": slider.name,
            "low": min(slider.low, slider.of(gear)),
            "high": max(slider.high, slider.of(gear)),
            "step": slider.step,
            "unit": pretty(slider.unit),
            "value": slider.of(gear),
            "meaning": meanings[slider.path],
        }
        for slider in SLIDERS
    ]
    return {"sliders": sliders, "scenes": scenes(), "slow": 1e3 * SLOW}
