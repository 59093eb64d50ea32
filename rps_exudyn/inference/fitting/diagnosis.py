"""What contradicts a fit, and what explains a misfit: refusals, and notes that name parts of the rig.

Goodness of fit alone does not refuse what matters: friction that falls with load, or another drag without
yoke, is taken up by five unknowns. So one test is directed: below the weight that lifts a flank, half the
difference of both directions does not depend on the weight.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from rps_exudyn.base.errors import are
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.inference.fitting.bench_tests import mixed_speeds
from rps_exudyn.inference.fitting.level import ZERO, LevelEstimate
from rps_exudyn.inference.fitting.level_fit import BETWEEN_MODELS, LevelModel, stepped
from rps_exudyn.inference.fitting.problem import MODEL, FitState, Problem
from rps_exudyn.inference.fitting.unknowns import BY_LOAD
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.solvers.closed_form import GRAVITY, runout_harmonics

OPENED = 100.0  # times the deviations of the unknowns, where the data alone are judged
UNLIKELY = 0.01  # probability of a chi squared, below which no model of this kind explains the data
FLAT_LOAD = 0.01  # by which the formula's half difference may change below lifting
BY_CHANCE = 0.05  # probability of a slope over the weight
OWN_WAVE, OWN_BEND = 3.0, 3.5  # standard deviations of friction's own waves and bend that are named
NAMED = 0.005  # of the level: smaller ones are not worth naming
ENCODER = 5.0  # standard deviations of a wave of the teeth at a wrong order


@dataclass(frozen=True)
class Refusal:
    """Why nothing counts as found, although it is narrow."""

    name: str
    sentence: str


def refusals(problem: Problem, model: LevelModel, state: FitState) -> list[Refusal]:
    """Return what contradicts the model: the data as a whole, and the load tests."""
    by_load = (
        "half the torque difference changes with the weight although no flank lifts: friction depends on the "
        "load, or the runs differ by more than the declared repeatability"
    )
    by_levels = "levels of the tests contradict each other"
    checks = (
        (_data_probability(model, state), UNLIKELY, "chi-squared", by_levels),
        (_load_probability(problem, model, state), BY_CHANCE, "weights", by_load),
    )
    said = "no parameter counts as found: {} (probability {:.2g}, limit {:g})"
    failed = [check for check in checks if check[0] < check[1]]
    return [Refusal(name, said.format(what, chance, limit)) for chance, limit, name, what in failed]


def _data_probability(model: LevelModel, state: FitState) -> float:
    """Probability of a larger chi squared, with hardly any prior of the unknowns but the nuisances."""
    from scipy.special import chdtrc

    freedom = model.rows.values.size - sum(not each.is_nuisance for each in model.unknowns)
    if freedom < 1:
        return 1.0
    open_model = model.with_priors(OPENED, nuisances=1.0)
    end = stepped(open_model, state.u)
    return float(chdtrc(freedom, open_model.cost(end.u))) if end.converged else 1.0


def _load_probability(problem: Problem, model: LevelModel, state: FitState) -> float:
    """Probability of a larger slope of the half difference over the weight, below lifting."""
    from scipy.special import ndtr

    u = state.u.copy()
    for j, each in enumerate(model.unknowns):
        u[j] = 0.0 if each.path == BY_LOAD else u[j]
    rows, predicted, formula = model.rows, model.at(u), model.by_formula(u)
    both = {each.test for each in problem.levels if each.both_ways}
    chosen = [i for i, direction in enumerate(rows.directions) if rows.tests[i] in both and direction[1] < 0]
    free = [i for i in chosen if rows.tests[i].kind == "free"]
    if not free:
        return 1.0
    level = formula[free[0]]
    chosen = [i for i in chosen if i in free or rows.tests[i].of_kind.weighted]
    chosen = [i for i in chosen if abs(formula[i] / level - 1) < FLAT_LOAD]
    if len(chosen) < 2:
        return 1.0
    masses = np.array([abs(rows.tests[i].load) / GRAVITY for i in chosen])
    deviations = {each.test: each.data_sd / each.value for each in problem.levels}
    model_sd = np.array([MODEL if rows.tests[i].of_kind.weighted else 0.0 for i in chosen])
    sd = np.hypot([deviations[rows.tests[i]] for i in chosen], model_sd)
    apart = np.where(np.isin(chosen, free), 0.0, BETWEEN_MODELS * (model.factors[chosen] - 1))
    ratio = rows.values[chosen] / predicted[chosen]
    if not (ratio > 0).all():
        return 0.0
    effects = np.column_stack([np.ones(len(chosen)), masses])
    weighted = np.linalg.solve(np.diag(sd**2) + np.outer(apart, apart), effects)
    normal = effects.T @ weighted
    slope = np.linalg.solve(normal, weighted.T @ np.log(ratio))[1]
    return float(2 * ndtr(-abs(slope) / np.sqrt(np.linalg.inv(normal)[1, 1])))


# --- Notes


def notes(problem: Problem, gear: SteeringGear) -> Iterator[str]:
    """What explains how the curves differ from the model, and what the intervals lack."""
    levels, measurement = problem.levels, problem.measurement
    if all(each.runs == 1 for each in levels):
        yield "no test was repeated: the repeatability is the declared one"
    for each in levels:
        yield from notes_of(each, gear)
    yield from measurement.late
    yield from mixed_speeds(measurement, float(GearPair.of(gear).gain))


def notes_of(level: LevelEstimate, gear: SteeringGear) -> Iterator[str]:
    """What is to be said of one test's curves."""
    yield from level.asks
    title, of_kind = level.test.title, level.test.of_kind
    if not level.both_ways:
        yield f"{title} was measured in one direction only: an error of the sensor's zero counts as friction"
    if level.spikes:
        yield f"{are(level.spikes, 'point', f' of {title}')} left out as outliers"
    if of_kind.by_angle:
        yield from _rig(level, gear)
    zero = 0.0 if level.half_sum is None or of_kind.weighted else level.half_sum
    if abs(zero) > 3 * ZERO * abs(level.value):
        yield f"the zero of the sensor is {zero:.2g} (SI) in {title}, a large part of its mean"


def _rig(level: LevelEstimate, gear: SteeringGear) -> Iterator[str]:
    """Friction's own waves and bend, drift, correlated noise, and the order at which the teeth show."""
    value = abs(level.value)
    if level.correlated > 0.5:
        yield "the residual keeps its sign over some degrees: the noise is correlated"
    if level.drift_sd > NAMED * value:
        yield (
            f"half the sum of both directions drifts: {100 * level.drift_sd / value:.2g} % of the level, "
            "by a bow, by warming or by the sensor"
        )
    for order, name in (
        (1, "a coupling, a wheel out of true or the yoke's plug"),
        (2, "a cardan joint or a bent coupling"),
    ):
        wave = level.friction_waves.get(order)
        if wave is None:
            continue
        vector, sd = wave.vector, wave.sd
        if order == 1:
            if level.first is None or not level.both_ways:
                continue
            of_friction, stored = runout_harmonics(gear.replace({"pinion.runout": 1e-6}))
            share = of_friction / abs(stored)  # of an eccentric pinion alone
            c, s = level.first.vector
            vector = vector - share * np.array([-s, c])
            sd = float(np.hypot(sd, share * level.first.sd))
        size = float(np.hypot(*vector))
        if size > OWN_WAVE * sd and size > NAMED * value:
            times = "once" if order == 1 else "twice"
            teeth, ratio = level.tooth_waves.get(1.0), gear.pinion.teeth / order
            if teeth is not None and not teeth.is_seen:
                name += f", or the teeth, where an encoder counts {ratio:g} times the angle"
            yield f"friction changes by {100 * size / value:.2g} % {times} per turn: {name}"
    bend, sd = level.bend
    if abs(bend) > OWN_BEND * sd and abs(bend) > NAMED * value:
        yield (
            f"friction is {200 * bend / value:+.2g} % at the ends of the travel compared with the middle: "
            f"a bent rack, or a bore out of line"
        )
    yield from encoder_doubts(level, gear.pinion.teeth)


def encoder_doubts(level: LevelEstimate, teeth: int) -> Iterator[str]:
    """What is to be said if the teeth show at another order of the angle than their number."""
    waves = level.tooth_waves
    at_teeth = waves.get(1.0)
    others = {ratio: wave for ratio, wave in waves.items() if ratio != 1.0 and wave.size > ENCODER * wave.sd}
    if at_teeth is None or not others:
        return
    ratio = max(others, key=lambda each: others[each].size)
    wrong = not at_teeth.is_seen if ratio > 1 else others[ratio].size > 1.5 * at_teeth.size
    if wrong:
        yield (
            f"the teeth show {ratio * teeth:.3g} times per turn of the angle, the given pinion has {teeth}: "
            "the encoder may have a ratio, or the pinion another number of teeth"
        )
