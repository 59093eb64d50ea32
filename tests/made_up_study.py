"""Studies whose results are made up: mean torque = preload * friction / 100, one turn, no simulation."""

import dataclasses
import hashlib
import itertools
import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from rps_exudyn.results.block import Keep
from rps_exudyn.results.outcome import Code, Status
from rps_exudyn.results.provenance import provenance
from rps_exudyn.results.result import Result
from rps_exudyn.study.definition import Axis, Case, Description
from rps_exudyn.study.store import Store

PRELOAD = Axis("preload", ("yoke.preload",), "N", (100.0, 200.0, 400.0), "grid")
FRICTION = Axis("friction", ("mesh.friction", "yoke.friction"), "", (0.1, 0.2), "grid")
GRID = (PRELOAD, FRICTION)
HOSTILE = "<script>alert('torque')</script><img src=x onerror=alert(1)> & \"quoted\""


def torque(values: Mapping[str, Any]) -> float:
    """Mean torque of a made-up case [N m]."""
    return values["preload"] * values["friction"] / 100


def grid_points(axes: Sequence[Axis] = GRID) -> list[dict[str, Any]]:
    """All points of a grid, the last axis fastest."""
    names = [axis.name for axis in axes]
    return [
        dict(zip(names, point, strict=True)) for point in itertools.product(*(a.values or () for a in axes))
    ]


def description(points: Sequence[Mapping[str, Any]], **changes: Any) -> Description:
    """A study of these points over preload and friction."""
    content: dict[str, Any] = {
        "name": "made-up",
        "title": "Made-up study",
        "scene": "free-pinion-torque",
        "fidelity": {"name": "flank", "mesh": "flank"},
        "base": {"yoke.spring_rate": 6e4},
        "axes": GRID,
        "design": "grid",
        "seed": None,
        "cases": tuple(Case(_hash(point), point) for point in points),
        "signals": Keep(),
        "time_limit": 60.0,
        "provenance": {**provenance(), "command": "rps-exudyn study made-up.toml"},
    }
    return Description(**content | changes)


def sampled(points: Sequence[Mapping[str, Any]], design: str = "random") -> Description:
    """The same axes, sampled."""
    axes = tuple(dataclasses.replace(axis, values=None, kind="sampled") for axis in GRID)
    return description(points, axes=axes, design=design, seed=1)


def make_study(
    folder: Path,
    result: Result,
    described: Description | None = None,
    failed: Mapping[int, str] | None = None,
    pending: Iterable[int] = (),
    remarks: Mapping[int, str] | None = None,
) -> Path:
    """A study's folder; cases by their number failed with a message, are still to be run, or ended ok with a
    remark."""
    described, failed, remarks = described or description(grid_points()), failed or {}, remarks or {}
    store = Store.of(folder, described)
    store.make_folders(blocks=False)
    store.write_description()
    for at, case in enumerate(described.cases):
        if at not in set(pending):
            made = result_of(described, case, result)
            codes = (Code.YOKE_STOPPED.value,) if at in remarks else ()
            made = dataclasses.replace(made, message=remarks.get(at, ""), codes=codes)
            if at in failed:
                made = dataclasses.replace(made, status=Status.DIVERGED, codes=(), message=failed[at])
            made.save(store.path_of(case.hash))
    return folder


def result_of(described: Description, case: Case, result: Result) -> Result:
    """What the made-up gear does in a case."""
    settings = described.settings(case)
    mean = torque({"preload": settings["yoke.preload"], "friction": settings["mesh.friction"]})
    return dataclasses.replace(
        result,
        gear=result.gear.replace({**described.base, **settings}),
        signals={**result.signals, "pinion_torque": result["pinion_torque"] - 0.6 + mean},
        summary={"torque_mean": mean, "torque_peak_to_peak": 0.02, "rack_gain": 0.035},
    )


def _hash(point: Mapping[str, Any]) -> str:
    return hashlib.sha256(json.dumps(point, sort_keys=True).encode()).hexdigest()[:16]
