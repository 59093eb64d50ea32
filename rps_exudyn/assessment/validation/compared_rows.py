"""Running rows: S, D, E, u_num, u_input, u_D and the verdict of each; equal procedures are run once."""

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from rps_exudyn.assessment.validation.calculations import CALCULATIONS
from rps_exudyn.assessment.validation.row import Procedure, ValidationRow
from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.geometry_report import geometry_report
from rps_exudyn.inference.uncertainty.band import Band, band_of_runs
from rps_exudyn.inference.uncertainty.input_sets import carried, uncertain_inputs
from rps_exudyn.inference.uncertainty.quick_band import SCENE, quick_band
from rps_exudyn.inference.uncertainty.statistics import MEDIAN
from rps_exudyn.parameters.fidelity import FOR_MEANS, Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.judged_row import JudgedRow, Verdict
from rps_exudyn.results.outcome import Status
from rps_exudyn.scenes import scene_named
from rps_exudyn.simulate.cases.run_cases import run_cases
from rps_exudyn.simulate.cases.task import Task
from rps_exudyn.simulate.run import simulate

COVERAGE = 2.0  # standard uncertainties that are 95 %
SURE = 0.95  # share of the gears that keep a limit
FAR_FROM_LIMIT = 0.5  # of a limit: where every gear is below, it excludes nothing
SAME = 0.01  # of a number: two of one procedure that are nearer are one prediction
COUNTED = (Verdict.AGREES, Verdict.NOISE, Verdict.WEAK, Verdict.DISAGREES)
"""Verdicts on rows that judge a prediction, from the best to the worst."""


@dataclass(frozen=True)
class Simulated:
    """What the package computes; nan where it could not be found."""

    value: float
    u_num: float  # standard, of the solution and of quantiles from so many samples
    u_input: float  # standard
    low: float  # 5 % of the band; the value without one
    high: float  # 95 %
    message: str = ""
    drawn: tuple[float, ...] = ()  # numbers of the gears of a band; nan of those that failed

    def keeping(self, side: int, limit: float) -> tuple[float, float]:
        """Least and greatest share of the gears at most (`side` +1) or at least (-1) at the limit; failed
        ones may be or not. Of one gear 0 or 1."""
        numbers = np.array(self.drawn or (self.value,))
        kept, failed = np.mean(side * (limit - numbers) >= 0), np.mean(~np.isfinite(numbers))
        return float(kept), float(kept + failed)


@dataclass(frozen=True, kw_only=True)
class ComparedRow(JudgedRow):
    """A row after its run, SI: S is its value, with the band of S."""

    row: ValidationRow
    u_num: float
    u_input: float
    error: float  # E = S - D
    uncertainty: float  # u_val
    kept: tuple[float, float] | None  # least and greatest share of the gears that keep a limit

    @property
    def kept_shown(self) -> str:
        """The share for a reader; "" of rows without a limit or a number."""
        if self.kept is None or not self.is_known:
            return ""
        least, most = self.kept
        return f"kept by {least:.0%}" if least == most else f"kept by {least:.0%} to {most:.0%}"

    @property
    def counts(self) -> bool:
        """Whether the row judges a prediction."""
        return self.verdict in COUNTED

    def as_dict(self) -> dict[str, Any]:
        """Return the row for JSON."""
        row, data = self.row, self.row.data
        return {
            **{name: getattr(row, name) for name in ("name", "title", "kind", "source", "note")},
            "quantity": data.quantity,
            "unit": data.shown_as.unit,
            "S": self.value,
            "band": [self.low, self.high] if np.isfinite(self.low) else None,
            "D": data.value,
            "range": data.ends,
            "limit": {1: "at most", -1: "at least"}.get(data.side, ""),
            "E": self.error,
            "u_num": self.u_num,
            "u_input": self.u_input,
            "u_D": data.uncertainty,
            "u_val": self.uncertainty,
            "kept": self.kept and list(self.kept),
            "agreement": row.agreement,
            "verdict": self.verdict.value,
            "message": self.remark,
        }


def compared_row(row: ValidationRow, found: Simulated) -> ComparedRow:
    """Judge a row by E = S - D and u_val^2 = u_num^2 + u_input^2 + u_D^2 (ASME V&V 20)."""
    data = row.data
    error = found.value - data.value
    uncertainty = float(np.hypot(np.hypot(found.u_num, found.u_input), data.uncertainty))
    kept = found.keeping(data.side, data.value) if data.side else None
    if row.not_comparable:
        judged = Verdict.NOT_COMPARABLE
    elif row.calibrates:
        judged = Verdict.CALIBRATED
    elif kept is not None:
        judged = verdict_on_limit(kept, found.value / data.value, data.side)
    else:
        judged = verdict(error, uncertainty, row.agreement * abs(data.value))
    return ComparedRow(
        name=row.name,
        value=found.value,
        low=found.low,
        high=found.high,
        verdict=judged,
        remark=row.not_comparable or row.calibrates or found.message,
        row=row,
        u_num=found.u_num,
        u_input=found.u_input,
        error=error,
        uncertainty=uncertainty,
        kept=kept,
    )


def verdict(error: float, uncertainty: float, allowed: float) -> Verdict:
    """Judge a row that compares with a value or a range.

    Args:
        error: E = S - D.
        uncertainty: u_val, standard.
        allowed: |E| up to which the criterion calls it agreement.
    """
    if not np.isfinite(error + uncertainty):
        return Verdict.NOT_COMPARABLE
    size = abs(error)
    if size <= allowed and COVERAGE * uncertainty <= allowed:
        return Verdict.AGREES
    if size > max(allowed, COVERAGE * uncertainty):
        return Verdict.DISAGREES
    return Verdict.NOISE if size <= uncertainty else Verdict.WEAK


def verdict_on_limit(kept: tuple[float, float], ratio: float, side: int) -> Verdict:
    """Judge a row that compares with a limit, by the share of the gears that keep it.

    Args:
        kept: least and greatest share; failed samples decide where the verdicts on both differ.
        ratio: S over the limit.
        side: +1: at most; -1: at least.
    """
    least, most = kept
    if not np.isfinite(ratio):
        return Verdict.NOT_COMPARABLE
    if least == 1 and ratio**side <= FAR_FROM_LIMIT:
        return Verdict.KEPT_BY_ANY
    if least >= SURE:
        return Verdict.WEAK
    return Verdict.DISAGREES if most <= 1 - SURE else Verdict.NOISE


def predictions(comparisons: Sequence[ComparedRow]) -> list[list[ComparedRow]]:
    """Return the rows that count, those of one predicted number together, the worst verdict first: one number
    of one procedure is one prediction, whatever many manuals it is held against."""
    found: dict[str, list[list[ComparedRow]]] = {}
    for each in comparisons:
        if not each.counts:
            continue
        of_procedure = found.setdefault(_key(each.row.procedure), [])
        same = [group for group in of_procedure if abs(each.value - group[0].value) <= SAME * abs(each.value)]
        if same:
            same[0].append(each)
        else:
            of_procedure.append([each])
    worst_first = list(reversed(COUNTED))
    return [
        sorted(group, key=lambda each: worst_first.index(each.verdict))
        for groups in found.values()
        for group in groups
    ]


def compare_rows(
    rows: Sequence[ValidationRow], on_progress: Callable[[int, int], None] | None = None, jobs: int = 1
) -> list[ComparedRow]:
    """Run the rows in up to `jobs` processes; a run that fails makes a row that is not comparable.

    `on_progress` gets the number of procedures that are done, and of all.
    """
    keys = [_key(row.procedure) for row in rows]
    procedures = {key: row.procedure for key, row in zip(keys, rows, strict=True)}
    dearest_first = sorted(procedures, key=lambda key: -_expected(procedures[key]))
    tasks = {Task(partial(_outcome, procedures[key])): key for key in dearest_first}
    found: dict[str, dict[str, Simulated]] = {}
    for task, answer in run_cases(list(tasks), jobs, expected=sum(map(_expected, procedures.values()))):
        found[tasks[task]] = {"": _missing(answer.ended)} if answer.ended else answer.returned()
        if on_progress is not None:
            on_progress(len(found), len(tasks))
    missing = _missing("the run has no such number")
    return [
        compared_row(row, found[key].get(row.data.quantity) or found[key].get("") or missing)
        for key, row in zip(keys, rows, strict=True)
    ]


def _key(procedure: Procedure) -> str:
    return json.dumps(vars(procedure), sort_keys=True, default=dict)


def _expected(procedure: Procedure) -> float:
    """Return about what a procedure takes [s]: gears that are computed together take less."""
    if not procedure.scene:
        return 0.0
    each = 0.1 if scene_named(procedure.scene).test is None else 0.01
    return each * (procedure.samples if procedure.inputs else 2)


def _outcome(procedure: Procedure) -> dict[str, Simulated]:
    """Every number that the procedure gives, by quantity; "" stands for all others."""
    try:
        return _simulated(procedure)
    except InputError as error:
        return {"": _missing(" ".join(error.problems))}


def _simulated(procedure: Procedure) -> dict[str, Simulated]:
    if procedure == Procedure():
        return {}
    if procedure.calculation:
        value = CALCULATIONS[procedure.calculation](**procedure.arguments)
        return {"": Simulated(value, 0.0, 0.0, value, value)}
    gear = SteeringGear.from_tables({}, procedure.settings)
    if procedure.geometry:
        numbers = geometry_report(gear).numbers
        return {name: Simulated(value, 0.0, 0.0, value, value) for name, value in numbers.items()}
    fidelity = Fidelity.preset(procedure.fidelity)
    if fidelity.based_on == FOR_MEANS.based_on:
        fidelity = FOR_MEANS
    if procedure.inputs:
        return _of_band(_band(procedure, gear, fidelity))
    result = simulate(procedure.scene, gear, fidelity)
    if result.status is not Status.OK:
        return {"": _missing(f"the run ended {result.status}: {result.message}")}
    return {
        name: Simulated(value, result.errors.get(name, 0.0) / 2, 0.0, value, value, result.message)
        for name, value in result.summary.items()
    }


def _band(procedure: Procedure, gear: SteeringGear, fidelity: Fidelity) -> Band:
    inputs = uncertain_inputs(gear, procedure.inputs, carried({}, procedure.settings))
    if procedure.scene == SCENE:
        return quick_band(gear, fidelity, inputs, procedure.samples)
    return band_of_runs(procedure.scene, gear, fidelity, inputs, procedure.samples)


def _of_band(band: Band) -> dict[str, Simulated]:
    failed = f"{band.drawn.failed} of {len(band.drawn.samples)} samples failed" if band.drawn.failed else ""
    found = {}
    for name, each in band.metrics.items():
        of_runs = band.drawn.numerical.get(name)
        half = float(of_runs.of_quantiles[MEDIAN]) if of_runs else 0.0
        error = float(np.hypot(each.errors[MEDIAN], half / 2))  # a bar is two standard uncertainties
        drawn = tuple(band.drawn.numbers[name].tolist())
        found[name] = Simulated(each.median, error, each.standard, each.low, each.high, failed, drawn)
    return found


def _missing(message: str) -> Simulated:
    return Simulated(np.nan, np.nan, np.nan, np.nan, np.nan, message)
