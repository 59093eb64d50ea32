"""Pictures as commands draw them: which functions made each, and what is wrong with it.

with album.looking("run rattle"):
    cli.main(["run", "rattle"])
album.pages["run rattle"]  # [Drawn({"rps_exudyn.pages.charts.scene_figures.rattle_figure", ...}, []), ...]
"""

import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from importlib import import_module
from inspect import isfunction
from pkgutil import walk_packages
from types import ModuleType
from typing import Any, get_args, get_origin
from weakref import WeakKeyDictionary

import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from picture_faults import faults


@dataclass(frozen=True)
class Drawn:
    """A picture that left the program."""

    functions: frozenset[str]  # within which its figure began, by module and name
    faults: list[str]
    figure: Figure


@dataclass
class Album:
    """All pictures that were drawn while it looked, by a title."""

    zooms: Mapping[str, Mapping[int, str]] = field(default_factory=dict)
    """Function of a chart -> number of axes -> why they show a part of their data."""
    pages: dict[str, list[Drawn]] = field(default_factory=dict)

    @contextmanager
    def looking(self, title: str) -> Iterator[None]:
        """Look at every picture that is drawn in this block, as it is when it is written."""
        page = self.pages.setdefault(title, [])
        begun: WeakKeyDictionary[Figure, frozenset[str]] = WeakKeyDictionary()

        def begin(original: Any, figure: Figure, *arguments: Any, **named: Any) -> None:
            begun[figure] = _callers()
            original(figure, *arguments, **named)

        def draw(original: Any, canvas: FigureCanvasAgg) -> None:
            original(canvas)
            if canvas.figure.axes and not any(canvas.figure is each.figure for each in page):
                functions = begun.get(canvas.figure, frozenset())
                zooms = {at: why for name in functions for at, why in self.zooms.get(name, {}).items()}
                page.append(Drawn(functions, faults(canvas, zooms), canvas.figure))

        def save(original: Any, figure: Figure, target: Any, **named: Any) -> None:
            FigureCanvasAgg(figure).draw()
            original(Figure(), target, **named)  # an empty picture: what is in it has been looked at

        with pytest.MonkeyPatch.context() as patch:
            _instead(patch, Figure, "__init__", begin)
            _instead(patch, FigureCanvasAgg, "draw", draw)
            _instead(patch, Figure, "savefig", save)
            yield

    def faults(self) -> list[str]:
        """Every fault with the title of its picture."""
        return [
            f"{title}: {fault}"
            for title, page in self.pages.items()
            for drawn in page
            for fault in drawn.faults
        ]


def _instead(patch: pytest.MonkeyPatch, cls: Any, name: str, do: Callable[..., None]) -> None:
    """Let `do` work instead of a method, which it gets as its first argument."""
    original = getattr(cls, name)
    patch.setattr(cls, name, lambda *arguments, **named: do(original, *arguments, **named))


def _callers() -> frozenset[str]:
    """The functions that are running, by module and name."""
    found, frame = set(), sys._getframe()
    while frame := frame.f_back:  # type: ignore[assignment]
        found.add(f"{frame.f_globals.get('__name__')}.{frame.f_code.co_qualname}")
    return frozenset(found)


def figure_functions(package: ModuleType, without: tuple[str, ...] = ()) -> set[str]:
    """Every function of a package that is declared to return a Figure, by module and name."""
    names = [package.__name__]
    names += [each.name for each in walk_packages(package.__path__, f"{package.__name__}.")]
    found = set()
    for name in names:
        if name.startswith(without) and without:
            continue
        for value in vars(import_module(name)).values():
            if isfunction(value) and value.__module__ == name and _returns_figure(value):
                found.add(f"{name}.{value.__qualname__}")
    return found


def _returns_figure(function: Callable[..., object]) -> bool:
    returned = function.__annotations__.get("return")
    parts = () if get_origin(returned) is Callable else get_args(returned)
    return Figure in (returned, *parts)
