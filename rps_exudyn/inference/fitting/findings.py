"""What a fit found, in sentences: for the screen, the page and the head of the gear file."""

from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

import numpy as np

from rps_exudyn.base import units
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.inference.fitting.adjustment import Adjustment
from rps_exudyn.inference.fitting.bench_tests import BenchTest
from rps_exudyn.inference.fitting.fitted import Fit
from rps_exudyn.inference.fitting.identifiability import MOST_RUNS, NARROWED, SEPARATING, WANTED
from rps_exudyn.inference.fitting.level import LevelEstimate
from rps_exudyn.inference.fitting.noise import NORMAL, waves
from rps_exudyn.inference.fitting.unknowns import LEVEL
from rps_exudyn.inference.uncertainty.joint import posterior_table
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.judged_row import Verdict
from rps_exudyn.results.limit import Limit
from rps_exudyn.results.requirements import REQUIRED
from rps_exudyn.scenes.rack_on_rollers import SCENE as RACK_ON_ROLLERS
from rps_exudyn.solvers.closed_form import mesh_torque_per_force, torque_per_preload

TESTS = {
    "yoke-out": "turn the pinion without the yoke",
    "bearing": "turn the pinion alone in its bearings",
    RACK_ON_ROLLERS.name: "push the rack between the yoke and rollers in the pinion's place",
}


def shown(path: str, value: float) -> str:
    """A value of a parameter with four digits, in its unit."""
    unit = SteeringGear.declared_at(path.partition(" ")[0])[0].unit
    if unit is None or not unit.display:
        return f"{value:.4g}"
    return f"{units.displayed(value, unit.si, unit.display):.4g} {units.pretty(unit.display)}"


def level_sentence(fit: Fit) -> str:
    """The mean free torque with both its intervals; empty where no pinion was turned freely."""
    return f"{_level(fit.level)}, 95 % of the gear; {_of_run(fit.level)})" if fit.level else ""


def _level(level: LevelEstimate) -> str:
    """The mean free torque with half its interval, absolute and in per cent, within an open bracket."""
    half = level.interval[1] - level.value
    return f"mean free torque {level.value:.4g} N m +- {half:.2g} N m ({100 * half / abs(level.value):.2g} %"


def _of_run(level: LevelEstimate) -> str:
    half = level.run_interval[1] - level.value
    runs = "this run" if level.runs == 1 else f"these {level.runs} runs"
    return f"of {runs} +- {100 * half / abs(level.value):.2g} %"


BUDGET = ("test", "contribution", "half 95 % interval", "in the interval of", "from")


def budget_rows(fit: Fit) -> list[tuple[str, str, str, str, str]]:
    """The uncertainty budget of each test's level, row by row, with both sums."""
    table = []
    for level in fit.levels:
        size, unit = abs(level.value), level.test.unit.replace("*", " ")
        for row in level.budget:
            of = "run and gear" if row.of_run else "gear"
            table.append((level.test.title, row.name, f"{100 * row.half / size:.2g} %", of, row.basis))
        for name, (low, high) in (("run", level.run_interval), ("gear", level.interval)):
            half = (high - low) / 2
            text = f"{level.value:.4g} {unit} +- {half:.2g} {unit}"
            table.append((level.test.title, f"level of the {name}", f"{100 * half / size:.2g} %", name, text))
    return table


def runout_sentence(fit: Fit) -> str:
    """P e as it was measured, and e that follows; empty where no turn was covered."""
    if fit.runout is None:
        return ""
    low, high = (1e3 * end for end in fit.runout.stored_interval)
    if not fit.runout.is_found:
        return f"preload x runout is at most {high:.2g} N mm (95 %): not different from zero"
    return (
        f"preload x runout = {1e3 * fit.runout.stored:.3g} N mm ({low:.2g} to {high:.2g} N mm, 95 %) is "
        "measured; the runout below follows from it and the preload"
    )


def headline(fit: Fit) -> str:
    """What a picture of the fit shows: the tests and the mean free torque."""
    parts = [f"Fit to {', '.join(dict.fromkeys(each.test for each in fit.passes))}"]
    if fit.level:
        parts += [f"{_level(fit.level)}, 95 % of the gear)", _of_run(fit.level)]
    return " · ".join(parts)


def offset_sentence(fit: Fit) -> str:
    """Where the files' angle 0 stands in the model; empty where no pinion was turned freely."""
    if fit.level is None:
        return ""
    offset, half = np.degrees(fit.offset), 1.96 * np.degrees(fit.offset_sd)
    return f"angle offset {offset:.2f} deg +- {half:.2g} deg: model angle = file angle - offset"


def sum_sentence(fit: Fit) -> str:
    """How the parameters make the level, with the lengths of this gear."""
    gear, gain = fit.gear, float(GearPair.of(fit.gear).gain)
    teeth = mesh_torque_per_force(gear) / gear.mesh.friction if gear.mesh.friction else 0.0
    at_seat = torque_per_preload(gear) - mesh_torque_per_force(gear)
    yoke = at_seat / gear.yoke.friction if gear.yoke.friction else 0.0
    return (
        f"mean free torque = yoke.preload x ({1e3 * teeth:.3g} mm x mesh.friction + {1e3 * yoke:.3g} mm x "
        f"yoke.friction) + {1e3 * gain:.3g} mm x bush.drag + bearing.friction_torque"
    )


def open_sentences(fit: Fit) -> Iterator[str]:
    """What these tests leave open, and which tests or how many repeats would determine it."""
    if said := runout_sentence(fit):
        yield said
    left = [each.path for each in fit.estimates if each.verdict is Verdict.OPEN and each.path in LEVEL]
    if left:
        yield from _apart_sentences(fit, left)
    if said := repeats_sentence(fit):
        yield said


def level_sentences(fit: Fit) -> list[str]:
    """What the tests determine of the level, and what they leave open."""
    said = [level_sentence(fit)] if fit.level else []
    return [*said, *open_sentences(fit)]


def _apart_sentences(fit: Fit, left: list[str]) -> Iterator[str]:
    """That what is left is not separable, what is known of it together, and which tests would separate it."""
    yield f"not separable by these tests: {', '.join(left)}; the values below are one of many combinations"
    if fit.level is not None:
        yield f"only their sum is determined: {sum_sentence(fit)}"
    for each in fit.combinations:
        yield f"the product {each.words} is known to {100 * each.sd:.2g} % (standard deviation)"
    if fit.advice and fit.advice.tests:
        determined = {path: sd for path, sd in fit.advice.reached.items() if sd < NARROWED * LEVEL[path].sd}
        reached = ", ".join(f"{path} to {100 * sd:.2g} %" for path, sd in determined.items())
        still = [path for path in SEPARATING if path not in determined]
        rest = f"; {', '.join(still)} needs repeat tests or other data" if still else ""
        tests = ", ".join(map(test_words, fit.advice.tests))
        yield f"to separate them: {tests}; that determines {reached}{rest}"


def repeats_sentence(fit: Fit) -> str:
    """How often all tests must be run for what is wanted; empty if that is reached or not identifiable."""
    if fit.repeats is None:
        return ""
    parts = []
    for path, runs in fit.repeats.runs.items():
        often = f"{runs} runs of each test" if runs else f"more than {MOST_RUNS} runs of each test"
        parts.append(f"{often} would reach {100 * WANTED[path]:.2g} % of {path}")
    now = ", ".join(f"{path} to {100 * half:.2g} %" for path, half in fit.repeats.now.items())
    return f"known are {now} (95 %); {' and '.join(parts)}, with the scatter of these"


def test_words(test: BenchTest) -> str:
    """A further test in words."""
    if test.of_kind.weighted:
        return f"raise and lower {test.title.partition('@')[2].replace('kg', ' kg')} at the rack's end"
    return TESTS.get(test.kind, test.title)


# --- In the words of a workshop: what to turn, and what no screw changes


def adjustment_rows(fit: Fit) -> Iterator[tuple[str, str]]:
    """What to do to plug or spring, and the causes of the ripple: place and words."""
    if fit.level is None:
        return
    if fit.adjustment is None:
        one_way = "the free torque has one direction" if fit.converged else "the fit did not converge"
        yield "plug", f"not identifiable: {one_way}"
    else:
        yield _plug_or_spring(fit.adjustment, fit.limits["free_torque"])
    if once := _once_per_turn(fit):
        yield "once per turn", once
    teeth = [_amplitude(fit, values, fit.gear.pinion.teeth) for values in ("value", "model")]
    words = "\u00b1{:.2g} N m, of the given gear's teeth \u00b1{:.2g} N m: no screw changes it"
    by_angle = [each for each in fit.estimates if each.path == "installation.angle_error"]
    if not by_angle:
        words += "; --free installation.angle_error fits the shaft angle"
    elif by_angle[0].verdict is Verdict.NOT_ZERO:
        words += f"; shaft angle error {shown(by_angle[0].path, by_angle[0].value)}"
    yield "per tooth", words.format(*teeth)


def _plug_or_spring(adjustment: Adjustment, limit: Limit) -> tuple[str, str]:
    low, high = np.degrees(adjustment.interval)
    turn, room = np.degrees(adjustment.turn), np.degrees(adjustment.room)
    within, after = limit.show(REQUIRED["free_torque"]), f"mean {adjustment.mean:.3g} N m"
    change, half = 100 * adjustment.spring_change, 100 * NORMAL * adjustment.spring_sd
    spring = f"change its force by {change:+.0f} % \u00b1 {half:.0f} % for {after} ({within})"
    if adjustment.contact:
        words = f"turn back by {turn:.0f}\u00b0 ({low:.2g} to {high:.2g}\u00b0 end its contact, 95 %)"
        return "plug", f"{words}, then the spring: {spring}" if change else f"{words}: {after}"
    if change:
        reach = f"{-room[0]:.0f}\u00b0 in and {room[1]:.0f}\u00b0 back"
        return "spring", f"{spring}; the plug has {reach}, which is too little"
    if turn:
        way, half_turn = "back" if turn > 0 else "in", (high - low) / 2
        return "plug", f"turn {way} by {abs(turn):.0f}\u00b0 \u00b1 {half_turn:.0f}\u00b0: {after} ({within})"
    return "plug", f"no turn: free torque {within}, no contact once per turn"


def _once_per_turn(fit: Fit) -> str:
    """What makes the torque's wave once per turn; empty where no turn was covered."""
    if fit.adjustment and (contact := fit.adjustment.contact):
        runout, clearance = contact.depth + contact.clearance, contact.clearance
        where = np.degrees(contact.angle) % 360
        return (
            f"plunger touches the plug, friction +{contact.rise:.2g} N m at {where:.0f}\u00b0: runout "
            f"{1e6 * runout:.0f} \u00b5m, clearance {1e6 * clearance:.0f} \u00b5m"
        )
    if fit.runout is None:
        return ""
    low, high = (1e6 * end for end in fit.runout.interval)
    if not fit.runout.is_found:
        return f"runout at most {high:.0f} \u00b5m (95 %): not different from zero"
    wave, size = f"\u00b1{1e3 * fit.runout.stored:.2g} N mm", 1e6 * fit.runout.size
    return f"{wave} by a runout of {size:.0f} \u00b5m ({low:.0f} to {high:.0f} \u00b5m, 95 %)"


def _amplitude(fit: Fit, values: str, order: int) -> float:
    """Mean amplitude of an order of the turn in the passes of the free torque [N m]."""
    sizes = []
    for each in (each for each in fit.passes if fit.level and each.test == fit.level.test.title):
        of_order = waves(each.angle, 2 * np.pi, (order,))
        columns = np.column_stack([np.ones_like(each.angle), waves(each.angle, 2 * np.pi, (1, 2)), of_order])
        found = np.linalg.lstsq(columns, getattr(each, values), rcond=None)[0]
        sizes.append(np.hypot(*found[-2:]) if of_order.size else np.nan)
    return float(np.mean(sizes))


KNOWN = (Verdict.FOUND, Verdict.NOT_ZERO, Verdict.BY_PRIOR, Verdict.BY_RATIO)


def rows(fit: Fit) -> list[tuple[str, str, str, str, str]]:
    """Parameter, value, 95 % interval, what was expected, verdict; no interval of what was not found, and
    none at all, nor a verdict, of a fit that did not converge."""
    table = []
    for each in fit.estimates:
        low, high = (shown(each.path, end) for end in each.interval)
        interval = f"{low.split()[0]} to {high}" if fit.converged and each.verdict in KNOWN else ""
        if each.path.partition(" ")[0] in LEVEL:
            expected = f"{shown(each.path, each.prior)} +- {100 * each.prior_sd:.2g} %"
        elif each.path.endswith("_angle"):
            expected = "any"
        else:
            expected = f"{shown(each.path, each.prior)} +- {shown(each.path, each.prior_sd)}"
        verdict = str(each.verdict) if fit.converged else "last iteration, no estimate"
        if fit.converged and each.verdict is Verdict.MAYBE_ZERO:
            most = shown(each.path, max(abs(end) for end in each.interval))
            verdict = f"not different from zero (at most {most})"
        table.append((each.path, shown(each.path, each.value), interval, expected, verdict))
    return table


def _level_as_dict(level: LevelEstimate) -> dict[str, Any]:
    intervals = {"interval": list(level.interval), "run_interval": list(level.run_interval)}
    return {"value": level.value, **intervals}


def fit_as_dict(fit: Fit) -> dict[str, Any]:
    """The fit without its curves, in SI units."""
    level = fit.level
    return {
        "converged": fit.converged,
        "level": level and _level_as_dict(level) | {"sd": level.sd, "noise": level.noise},
        "budgets": {
            each.test.title: _level_as_dict(each) | {"rows": [asdict(row) for row in each.budget]}
            for each in fit.levels
        },
        "preload_times_runout": fit.runout
        and {
            "value": fit.runout.stored,
            "interval": list(fit.runout.stored_interval),
            "found": fit.runout.is_found,
        },
        "refusals": {each.name: each.sentence for each in fit.refusals},
        "estimates": {
            each.path: {
                "value": each.value,
                "interval": list(each.interval),
                "sd": each.sd,
                "prior": each.prior,
                "prior_sd": each.prior_sd,
                "by_other_law": each.by_law,
                "verdict": str(each.verdict),
            }
            for each in fit.estimates
        },
        "combinations": [
            {"exponents": each.exponents, "sd": each.sd, "prior_sd": each.prior_sd}
            for each in fit.combinations
        ],
        "correlations": {"of": fit.correlated, "matrix": np.round(fit.correlations, 4).tolist()},
        "further_tests": fit.advice
        and {"tests": [test.title for test in fit.advice.tests], "reached": fit.advice.reached},
        "more_runs": fit.repeats and {"half_interval": fit.repeats.now, "runs": fit.repeats.runs},
        "adjustment": fit.adjustment and asdict(fit.adjustment),
        "angle_offset": {"value": fit.offset, "sd": fit.offset_sd},
        "warnings": list(fit.warnings),
        "assumed": list(fit.assumed),
        "left_out": list(fit.left_out),
        "simulations": fit.simulations,
        "cpu_s": fit.cpu_s,
        "gear": fit.gear.model_dump(),
    }


def gear_text(fit: Fit, gear_file: str) -> str:
    """The gear file with what its values rest on at its head, and the samples that bands take at its end."""
    said = level_sentences(fit)
    said += [f"{path} {value}: {verdict}" for path, value, _, _, verdict in rows(fit)]
    if not fit.converged:
        said.insert(0, "THE FIT DID NOT CONVERGE: these values are its last iteration.")
    head = "".join(f"# {sentence}\n" for sentence in said)
    names = ", ".join(dict.fromkeys(each.name for each in fit.passes))
    samples = posterior_table(fit.gear, fit.posterior) if fit.posterior else ""
    return f"# Fitted to {names}.\n{head}{gear_file}{samples}"
