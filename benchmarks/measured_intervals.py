"""Intervals of level, P e and runout against curves of a formula of their own: 18 kinds of noise and rig.

No measurement stands behind these numbers. The curves are not the package's (`verification.bench_curves`);
the gear is the same in all of them. A cell in which fewer than 35 of 40 intervals hold is repeated with other
seeds. Six tests are drawn from the priors of a fit: levels by simulations, with friction that falls under
load and with another drag without yoke.
"""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.topic import Topic, load_data, markdown, save_data
from rps_exudyn.inference.fitting.bench_tests import BenchTest, measurement_of
from rps_exudyn.inference.fitting.fit import fit
from rps_exudyn.inference.fitting.level import levels_of, runout_of
from rps_exudyn.inference.fitting.level_fit import LevelModel, stepped
from rps_exudyn.inference.fitting.prediction import NoPredictionError, Prediction
from rps_exudyn.inference.fitting.problem import level_rows
from rps_exudyn.inference.fitting.unknowns import BY_LOAD, LEVEL, WITHOUT_YOKE, unknowns_of
from rps_exudyn.parameters.gear import SteeringGear
from verification.bench_curves import GAIN, KINDS, TEETH, BenchGear, bench_record
from verification.made_up_curves import SET, BenchNoise, measured_curve, with_noise

DATA = "intervals.json"
NUMBERS = ("run", "gear", "P e", "e")
LEAST, AGAIN, SHARE = 35, 200, 0.9
FREE = BenchTest("free")
FALLING, MORE_DRAG = {BY_LOAD: float(np.log(0.9))}, {WITHOUT_YOKE: float(np.log(1.4))}
TRUTHS: dict[str, dict[str, float]] = {
    "as modelled": {},
    "friction falls by 10 % to 150 kg": FALLING,
    "drag 40 % higher without yoke": MORE_DRAG,
}
"""Name -> nuisances' logarithms."""
BENCH = BenchNoise(0.01, repeatability=0.02, zero=0.03)


def run(
    folder: Path, seeds: int = 40, sets: int = 100, kinds: Iterable[str] = tuple(KINDS), again: int = AGAIN
) -> None:
    """Fit all kinds and six tests; keep how often each interval holds."""
    cells: dict[str, Any] = {}
    tests: dict[str, Any] = {}
    for kind in kinds:
        own = [free_case(kind, seed) for seed in range(seeds)]
        cells[kind] = of_kind(own)
        missed = [name for name in NUMBERS if cells[kind]["holds"][name] < LEAST / 40]
        if missed and again:
            other = of_kind([free_case(kind, 1000 + seed) for seed in range(again)])
            cells[kind]["again"] = {name: other["holds"][name] for name in missed}
        print(kind, cells[kind], flush=True)
    for truth in TRUTHS if sets else ():
        tests[truth] = of_sets([set_case(truth, seed) for seed in range(sets)])
        print(truth, tests[truth], flush=True)
    save_data(folder / DATA, {"seeds": seeds, "sets": sets, "cells": cells, "tests": tests})


def free_case(kind: str, seed: int) -> dict[str, Any]:
    """Find level and runout of one free torque of a kind; return what their intervals hold.

    The preload is that of the closed form's fit: no simulation moves it by a tenth of its deviation.
    """
    of, gear = KINDS[kind], BenchGear(area=KINDS[kind].area)
    record, curves, factor = bench_record(gear, of.spacing), [], 0.0
    for number in range(of.runs):
        random = np.random.default_rng([seed, number])
        curves.append(measured_curve(with_noise(record, of.noise, random), FREE))
        scale = np.random.default_rng([seed, number]).standard_normal()
        factor += (1 + of.noise.repeatability * scale) / of.runs
    (level,) = levels_of(measurement_of(curves).passes, TEETH, GAIN)
    unknowns = unknowns_of(SteeringGear(), LEVEL, {})
    model = LevelModel.of(level_rows([level]), unknowns, SteeringGear())
    end = stepped(model, np.array([each.before for each in unknowns]))
    runout = runout_of(level, float(np.exp(end.u[0])), float(np.sqrt(end.covariance[0, 0])))
    assert runout is not None
    low, high = level.run_interval
    stored = gear.preload * gear.runout
    intervals = {
        "run": (level.run_interval, gear.level * factor),
        "gear": (level.interval, gear.level),
        "P e": (runout.stored_interval, stored),
        "e": (runout.interval, gear.runout),
    }
    return {
        "error": level.value / (gear.level * factor) - 1,
        "half": (high - low) / 2 / gear.level,
        "halves": {name: (ends[1] - ends[0]) / 2 / true for name, (ends, true) in intervals.items()},
        "holds": {name: bool(ends[0] <= true <= ends[1]) for name, (ends, true) in intervals.items()},
    }


def of_kind(cases: list[dict[str, Any]]) -> dict[str, Any]:
    """Half interval over scatter, widths and shares that hold."""
    scatter = max(float(np.std([each["error"] for each in cases])), 1e-12)
    return {
        "over": float(np.mean([each["half"] for each in cases]) / 1.96 / scatter),
        "halves": {name: float(np.mean([each["halves"][name] for each in cases])) for name in NUMBERS},
        "holds": {name: float(np.mean([each["holds"][name] for each in cases])) for name in NUMBERS},
    }


def drawn(random: np.random.Generator) -> SteeringGear:
    """A gear out of a fit's priors of the default one."""
    gear, values = SteeringGear(), {}
    for path, prior in LEVEL.items():
        value = gear.value_at(path) * np.exp(prior.sd * random.standard_normal())
        values[path] = min(value, 0.6) if path.endswith(".friction") else value
    return gear.replace(values)


def drawn_means(
    random: np.random.Generator, tests: tuple[BenchTest, ...], changed: Mapping[str, float]
) -> tuple[SteeringGear, dict[BenchTest, np.ndarray]]:
    """A drawn gear that has equilibria in all tests, and its mean values both ways."""
    prediction = Prediction.of(tests)
    while True:
        gear = drawn(random)
        try:
            values = prediction.simulated(gear, changed)
        except NoPredictionError:
            continue
        parts = [block.means(prediction.part(i, values)) for i, block in enumerate(prediction.blocks)]
        return gear, dict(zip(tests, parts, strict=True))


def set_case(truth: str, seed: int, tests: tuple[BenchTest, ...] = SET) -> dict[str, Any]:
    """Fit six tests of a drawn gear; return which intervals hold and what is called found."""
    random = np.random.default_rng([77, seed])
    gear, means_of = drawn_means(random, tests, TRUTHS[truth])
    forth, curves = np.radians(np.arange(-180.0, 181.0)), []
    for test, means in means_of.items():
        value = np.repeat(means, forth.size)
        record = {"pinion_angle": np.concatenate([forth, forth[::-1]]), "value": value}
        curves.append(measured_curve(with_noise(record, BENCH, random), test))
    found = fit(measurement_of(curves), other_law=False)
    return {
        each.path: {
            "holds": bool(each.interval[0] <= gear.value_at(each.path) <= each.interval[1]),
            "half": (each.interval[1] - each.interval[0]) / 2 / each.value,
            "found": each.path in found.found,
        }
        for each in found.estimates
        if each.path in LEVEL
    }


def of_sets(cases: list[dict[str, Any]]) -> dict[str, Any]:
    """Shares that hold, found and of these hold, by parameter."""
    result: dict[str, Any] = {}
    for path in LEVEL:
        own = [each[path] for each in cases]
        called = [each["holds"] for each in own if each["found"]]
        result[path] = {
            "half": float(np.median([each["half"] for each in own])),
            "holds": float(np.mean([each["holds"] for each in own])),
            "found": len(called),
            "found_holds": float(np.mean(called)) if called else None,
        }
    return result


def kind_table(folder: Path) -> str:
    """A row for each kind, or for kinds that give the same."""
    alike: dict[tuple[str, ...], list[str]] = {}
    for kind, cell in load_data(folder / DATA)["cells"].items():
        shares = ((cell["halves"][name], cell["holds"][name]) for name in ("run", "gear"))
        texts = tuple(f"{100 * half:.2g}, {100 * holds:.0f}" for half, holds in shares)
        alike.setdefault(texts, []).append(kind)
    rows = [("; ".join(kinds), *texts) for texts, kinds in alike.items()]
    return markdown(("kind", "run: half %, holds %", "gear: half %, holds %"), rows)


def set_table(folder: Path) -> str:
    """A row for each parameter, a column for each truth of six tests."""
    tests = load_data(folder / DATA)["tests"]

    def shown(each: dict[str, float]) -> str:
        text = f"{100 * each['half']:.1f}, {100 * each['holds']:.0f}"
        return f"{text}; {each['found']}, {100 * each['found_holds']:.0f}" if each["found"] else text

    rows = [(f"`{path}`", *(shown(cell[path]) for cell in tests.values())) for path in LEVEL]
    return markdown(("half %, holds %; found, of which hold %", *tests), rows)


TOPIC = Topic(
    "12 min",
    "fit",
    run,
    {"seeds": 2, "sets": 1, "kinds": ("white 2 %", "steps of 0.05 N m"), "again": 0},
    {"fit_kinds": kind_table, "fit_six_tests": set_table},
)
