"""Gears fitted to made-up measured curves: bias, scatter, coverage of the intervals, and disturbances.

No measurement stands behind these numbers. The curves are those of the model for one gear (`TRUE`), in steps
that are not the fit's, with noise of known size; so they test the estimator and its intervals, not the model.
That gear differs from the expected one (the default gear) by 17 to 25 % in each parameter.
"""

from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from benchmarks.topic import Topic, load_data, markdown, save_data
from rps_exudyn.analysis.passes import passes
from rps_exudyn.inference.fitting.bench_tests import BenchTest, Measurement, measurement_of
from rps_exudyn.inference.fitting.fit import fit
from rps_exudyn.inference.fitting.fitted import Fit
from rps_exudyn.inference.fitting.identifiability import logarithmic_slopes
from rps_exudyn.inference.fitting.prediction import formula_means
from rps_exudyn.inference.fitting.unknowns import LEVEL
from rps_exudyn.pages.charts import style
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.result import MeasuredTorque
from rps_exudyn.solvers.closed_form import GRAVITY
from verification.law_area import by_law
from verification.made_up_curves import REAL, BenchNoise, measured_curve, true_curve, with_noise

TRUE: dict[str, object] = {
    "yoke.preload": 350.0,
    "mesh.friction": 0.085,
    "yoke.friction": 0.12,
    "bush.drag": 25.0,
    "pinion.runout": 20e-6,
    "pinion.runout_angle": "70 deg",
}
FREE = BenchTest("free")
WEIGHTS = tuple(BenchTest("load-test", mass * GRAVITY) for mass in (40.0, 80.0, 150.0))
SET = (FREE, BenchTest("yoke-out"), BenchTest("bearing"), *WEIGHTS)
SPIKE, SPIKES = 10.0, 0.03  # standard deviations, part of the points
DISTURBED, SHIFT = np.radians(25.0), 8.0  # of one pass, standard deviations
GAPS, GAP = 3, np.radians(27.6)  # in each pass: 23 % of it
WHITE = BenchNoise()
DATA, PICTURE = "fit.json", "fit.png"
SEEDED = ("white", "correlated", "repeats")  # by all seeds
REPEATED = BenchNoise(repeatability=0.02, zero=0.02)
CASES = (*SEEDED, "spikes", "disturbed", "missing", "one way", "law area", "law line")


def run(
    folder: Path,
    seeds: int = 100,
    few: int = 40,
    sets: int = 20,
    cases: tuple[str, ...] = CASES,
    tests: tuple[BenchTest, ...] = SET,
) -> None:
    """Fit made-up curves of many seeds, few of them where something disturbs; keep and draw the errors."""
    levels = {}
    for case in cases:
        count = seeds if case in SEEDED else few
        levels[case] = [level_case(case, seed) for seed in range(count)]
        print(case, level_row(levels[case]), flush=True)
    weights = [set_case(seed, tests) for seed in range(sets)]
    save_data(folder / DATA, {"levels": levels, "weights": weights, "series": series_case()})
    style.save(picture(levels), folder / PICTURE)


@cache
def true_gear() -> SteeringGear:
    """The gear of the made-up curves."""
    return SteeringGear().replace(TRUE)


@cache
def curve_of(test: BenchTest, law: str = "line") -> dict[str, np.ndarray]:
    """The true curve of a test by a contact law."""
    return true_curve(true_gear(), test, law)


@cache
def true_level(law: str = "line") -> float:
    """Mean free torque of the true gear, half the difference of both directions [N m]."""
    curve = curve_of(FREE, law)
    turned = passes({"pinion_angle": curve["pinion_angle"], "value": curve["value"]})
    means = [np.trapezoid(each.signals["value"], each.angle) / np.ptp(each.angle) for each in turned]
    return float(sum(abs(mean) for mean in means) / 2)


def measured(test: BenchTest, noise: BenchNoise, random: np.random.Generator, law: str = "line") -> Any:
    """One made-up file of a test."""
    return measured_curve(with_noise(curve_of(test, law), noise, random), test)


def level_case(case: str, seed: int) -> dict[str, Any]:
    """Fit one free torque; return error and half interval of its level over the true one, and the cost."""
    random = np.random.default_rng(seed)
    law = "area" if case == "law area" else "line"
    noise = REAL if case in ("correlated", "repeats") else WHITE
    files = [measured(FREE, noise, random, law) for _ in range(3 if case == "repeats" else 1)]
    if case in DISTURBANCES:
        files = [(test, DISTURBANCES[case](curve, random)) for test, curve in files]
    gear = by_law(SteeringGear(), "area") if case == "law line" else SteeringGear()
    found = fit(measurement_of(files), gear, other_law=case == "white" and seed < 10)
    return of_level(found, true_level(law))


def of_level(found: Fit, true: float) -> dict[str, Any]:
    """What is kept of a fit's level."""
    assert found.level is not None
    low, high = found.level.interval
    return {
        "error": found.level.value / true - 1,
        "half": (high - low) / 2 / true,
        "holds": bool(low <= true <= high),
        "simulations": found.simulations,
        "cpu_s": found.cpu_s,
        "converged": found.converged,
        "runout": found.estimate("pinion.runout").value if "pinion.runout" in map_of(found) else None,
        "found": [path for path in found.found if path in ("yoke.preload", "mesh.friction", "yoke.friction")],
        "correlated": "correlated" in found.level.noise,
    }


def map_of(found: Fit) -> list[str]:
    """Paths of the estimates."""
    return [each.path for each in found.estimates]


def spiked(curve: MeasuredTorque, random: np.random.Generator) -> MeasuredTorque:
    """Some points far off, to either side."""
    torque = curve.signals["pinion_torque"].copy()
    hit = random.random(torque.size) < SPIKES
    size = SPIKE * WHITE.white * np.abs(torque).mean()
    torque[hit] += size * random.choice([-1.0, 1.0], hit.sum())
    return MeasuredTorque(curve.name, {**curve.signals, "pinion_torque": torque})


def disturbed(curve: MeasuredTorque, random: np.random.Generator) -> MeasuredTorque:
    """A stretch of the first pass off to one side."""
    angle, torque = curve.signals["pinion_angle"], curve.signals["pinion_torque"].copy()
    begin = random.uniform(angle.min(), angle.max() - DISTURBED)
    inside = (angle >= begin) & (angle < begin + DISTURBED) & (np.arange(angle.size) < angle.size // 2)
    torque[inside] += SHIFT * WHITE.white * np.abs(torque).mean()
    return MeasuredTorque(curve.name, {**curve.signals, "pinion_torque": torque})


def with_gaps(curve: MeasuredTorque, random: np.random.Generator) -> MeasuredTorque:
    """Stretches missing, others in each pass."""
    angle = curve.signals["pinion_angle"]
    kept = np.ones(angle.size, dtype=bool)
    for way in (np.arange(angle.size) < angle.size // 2, np.arange(angle.size) >= angle.size // 2):
        third = np.ptp(angle) / GAPS
        for i in range(GAPS):
            begin = angle.min() + i * third + random.uniform(0, third - GAP)
            kept &= ~(way & (angle >= begin) & (angle < begin + GAP))
    return MeasuredTorque(curve.name, {name: values[kept] for name, values in curve.signals.items()})


def forward_only(curve: MeasuredTorque, random: np.random.Generator) -> MeasuredTorque:
    """The first pass."""
    half = curve.signals["pinion_angle"].size // 2
    return MeasuredTorque(curve.name, {name: values[:half] for name, values in curve.signals.items()})


Disturbance = Callable[[MeasuredTorque, np.random.Generator], MeasuredTorque]
DISTURBANCES: dict[str, Disturbance] = {
    "spikes": spiked,
    "disturbed": disturbed,
    "missing": with_gaps,
    "one way": forward_only,
}


def least_deviations(noise: BenchNoise, runs: int = 1, points: int = 722) -> dict[str, float]:
    """Cramer and Rao's bound of the logarithms of the level's parameters, from the whole set of tests.

    No unbiased estimator scatters less. Half the difference of both directions has the noise of the run, half
    the sum that of the zero; slopes are the closed form's at the true gear. No prior belief is counted.
    """
    paths, information = tuple(LEVEL), np.zeros((len(LEVEL), len(LEVEL)))
    for test in SET:
        means, slopes = formula_means(true_gear(), test), logarithmic_slopes(true_gear(), test, paths)
        friction = abs(means[0] - means[1]) / 2
        halves = (slopes[0] - slopes[1], noise.repeatability), (slopes[0] + slopes[1], noise.zero)
        for slope, common in halves:
            sd = friction * np.hypot(noise.white / np.sqrt(points), common)
            information += runs * np.outer(slope / 2, slope / 2) / sd**2
    deviations = np.sqrt(np.diag(np.linalg.inv(information)))
    return dict(zip(paths, deviations.tolist(), strict=True))


def set_case(seed: int, tests: tuple[BenchTest, ...] = SET) -> dict[str, Any]:
    """Fit the whole set of tests; return estimates over the true values, their deviations and verdicts."""
    random = np.random.default_rng(seed)
    noise = REPEATED if seed % 2 else WHITE
    files: Measurement = measurement_of([measured(test, noise, random) for test in tests])
    found = fit(files, SteeringGear())
    true = true_gear()
    return {
        "repeatability": noise.repeatability,
        "simulations": found.simulations,
        "cpu_s": found.cpu_s,
        "converged": found.converged,
        "estimates": {
            each.path: {
                "ratio": each.value / true.value_at(each.path),
                "holds": bool(each.interval[0] <= true.value_at(each.path) <= each.interval[1]),
                "sd": each.sd,
                "verdict": str(each.verdict),
            }
            for each in found.estimates
            if each.path in TRUE and each.path != "pinion.runout_angle"
        },
    }


def series_case() -> dict[str, Any]:
    """Fit a second gear of a series, of other preload, like the first."""
    random = np.random.default_rng(1000)
    first = fit(measurement_of([measured(FREE, WHITE, random)]))
    other = true_gear().replace({"yoke.preload": 380.0, "mesh.friction": 0.08})
    curve = measured_curve(with_noise(true_curve(other, FREE), WHITE, random), FREE)
    second = fit(measurement_of([curve]), like=first)
    return {"simulations": second.simulations, "cpu_s": second.cpu_s, "converged": second.converged}


def picture(levels: dict[str, list[dict[str, Any]]]) -> Figure:
    """Errors of the level, case by case, with their 95 % intervals."""
    shown = [case for case in levels if case != "one way"]
    figure, axes = style.panels([1.25] * len(shown), width=8.0)
    for panel, case in zip(axes, shown, strict=True):
        cases = levels[case]
        error, half = (100 * np.array([each[name] for each in cases]) for name in ("error", "half"))
        holds = np.array([each["holds"] for each in cases])
        order = np.argsort(error)
        for chosen, colour in ((holds[order], "torque"), (~holds[order], "failure")):
            where = np.flatnonzero(chosen)
            panel.errorbar(
                where / max(len(cases) - 1, 1),
                error[order][chosen],
                half[order][chosen],
                fmt=".",
                markersize=3,
                linewidth=0.8,
                color=style.COLOURS[colour],
            )
        panel.axhline(0.0, **style.REFERENCE_LINE)
        panel.set_ylabel(f"{case}\n[%]")
        panel.set_xticks([])
    style.title(figure, "Error of the fitted mean free torque on made-up curves, seeds by size; red: missed")
    return figure


def level_row(cases: list[dict[str, Any]]) -> list[str]:
    """Number of fits, bias, RMS and largest error, coverage of a case, and fits without convergence."""
    error = 100 * np.array([each["error"] for each in cases])
    return [
        f"{len(cases)}",
        f"{error.mean():+.2f}",
        f"{np.sqrt(np.mean(error**2)):.2f}",
        f"{np.abs(error).max():.2f}",
        f"{100 * np.mean([each['holds'] for each in cases]):.0f}",
        f"{sum(not each['converged'] for each in cases)}",
    ]


def level_table(folder: Path) -> str:
    """Errors of the level by case."""
    head = ["case", "fits", "bias %", "RMS %", "largest %", "95 % interval holds, %", "not converged"]
    levels = load_data(folder / DATA)["levels"]
    return markdown(head, [[case, *level_row(cases)] for case, cases in levels.items()])


def weight_table(folder: Path) -> str:
    """Errors of the parameters after the whole set of tests, with a repeatability of 2 %."""
    data, rows = load_data(folder / DATA)["weights"], []
    bounds = least_deviations(REPEATED, 1)
    for path in data[0]["estimates"]:
        own = [each["estimates"][path] for each in data if each["repeatability"]]
        error = 100 * (np.array([each["ratio"] for each in own]) - 1)
        verdicts = [each["estimates"][path]["verdict"] for each in data]
        rows.append(
            (
                f"`{path}`",
                f"{np.sqrt(np.mean(error**2)):.1f}",
                f"{np.abs(error).max():.1f}",
                f"{100 * np.mean([each['holds'] for each in own]):.0f}",
                f"{100 * bounds[path]:.1f}" if path in bounds else "",
                max(set(verdicts), key=verdicts.count),
            )
        )
    head = ("parameter", "RMS error %", "largest %", "interval holds, %", "least deviation %", "verdict")
    return markdown(head, rows)


TOPIC = Topic(
    "gears fitted to made-up measured curves: bias, scatter, coverage, and what disturbs them",
    "8 min",
    "fit",
    run,
    {"seeds": 1, "few": 1, "sets": 2, "cases": ("white", "spikes"), "tests": SET[:3]},
    {"fit_level": level_table, "fit_weights": weight_table},
)
