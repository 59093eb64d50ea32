"""Bands: distributions, quantiles with their errors, contributions, and the quick band against runs."""

import re
from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations
from typing import Any

import numpy as np
import pytest
from scipy.stats import qmc

from rps_exudyn.base.errors import InputError
from rps_exudyn.inference.uncertainty import band as band_module
from rps_exudyn.inference.uncertainty.band import Band, band_of_runs
from rps_exudyn.inference.uncertainty.input_sets import SETS, carried, uncertain_inputs
from rps_exudyn.inference.uncertainty.joint import correlated
from rps_exudyn.inference.uncertainty.quick_band import formula_torques, quick_band
from rps_exudyn.inference.uncertainty.samples import Samples
from rps_exudyn.inference.uncertainty.statistics import LEVELS, Polynomials, numerical_error, quantiles
from rps_exudyn.parameters.distribution import KINDS, Distribution
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import CORRELATION, POSTERIOR, SteeringGear
from rps_exudyn.results.outcome import Code, Interrupted
from rps_exudyn.simulate.cases.run_cases import run_cases
from rps_exudyn.simulate.cases.task import Answer, Task
from rps_exudyn.solvers.closed_form import mean_state

FORMULA = Fidelity.preset("closed-form")
EQUILIBRIA = Fidelity.preset("quasi-static").replace({"step_angle": "2 deg"})
TURN = "free-pinion-torque"


@pytest.mark.parametrize(
    ("text", "kind", "half"),
    [
        ("300 N +- 10 %", "normal", 30.0),
        ("300 N ± 30 N", "normal", 30.0),
        ("normal(300 N, 30 N)", "normal", 30.0),
        ("uniform(240 N, 360 N)", "uniform", 120 / 12**0.5),
    ],
)
def test_standard_deviation_of_what_is_drawn(text: str, kind: str, half: float) -> None:
    """Cut at three deviations a normal distribution has 0.9866 of its width; 1e5 points give 0.5 %."""
    read = Distribution.read(text, "N")
    drawn = read.quantile(np.random.default_rng(1).random(100_000))
    assert (read.kind, read.nominal) == (kind, 300.0)
    assert drawn.mean() == pytest.approx(300.0, abs=0.5)
    assert drawn.std() == pytest.approx(half, rel=0.02)


@pytest.mark.parametrize("kind", KINDS)
def test_quantile_function_rises_from_end_to_end_through_the_nominal_value(kind: str) -> None:
    each = Distribution(kind, 2.0, 3.0)
    values = each.quantile(np.linspace(0, 1, 101))
    assert (np.diff(values) > 0).all()
    assert (values[0], values[-1]) == pytest.approx(each.ends)
    assert values[50] == pytest.approx(each.nominal, rel=1e-9)


def test_two_thirds_of_a_log_normal_lie_within_its_factor() -> None:
    drawn = Distribution("lognormal", 0.1, 1.3).quantile(np.linspace(0, 1, 100_001))
    within = np.mean((drawn > 0.1 / 1.3) & (drawn < 0.1 * 1.3))
    assert within == pytest.approx(0.6827 / 0.9973, abs=1e-3)  # cut at three deviations


def test_error_of_a_median_is_that_of_theory() -> None:
    """1.2533 / sqrt(n) for a normal distribution; a bootstrap of 1000 numbers scatters by a fifth."""
    numbers = np.random.default_rng(2).normal(size=1000)
    assert quantiles(numbers).errors[2] == pytest.approx(1.2533 / 1000**0.5, rel=0.25)


@pytest.mark.parametrize("lost", list(combinations(range(6), 2)))
def test_quantiles_of_all_lie_between_the_worst_cases_of_failed_samples(lost: tuple[int, int]) -> None:
    """Whichever samples fail, what they would have been moves no quantile beyond the stated ends."""
    every = np.array([1.0, 2.0, 4.0, 7.0, 11.0, 16.0])
    found = quantiles(np.delete(every, lost), failed=2)
    whole = np.quantile(every, LEVELS)
    assert (found.lowest <= whole + 1e-12).all()
    assert (found.highest >= whole - 1e-12).all()


def test_contributions_of_a_sum_and_of_a_product() -> None:
    """a^2 / sum a^2 for a sum; a product of two centred inputs has none alone."""
    u = Samples.drawn({str(i): Distribution("uniform", 0, 1) for i in range(4)}, 1024, 3).quantile
    x, names = 2 * u - 1, {name: [i] for i, name in enumerate("abcd")}
    added = Polynomials.at(u, names).contributions(3 * x[:, 0] + 2 * x[:, 1] ** 3 + x[:, 2])
    variances = np.array([9 / 3, 4 / 7, 1 / 3])
    assert added is not None
    assert [added.fractions[name] for name in "abc"] == pytest.approx(variances / variances.sum(), abs=0.02)
    assert added.fractions["d"] < 0.001
    assert added.together < 1e-6
    together = Polynomials.at(u, names).contributions(x[:, 0] * x[:, 1])
    assert together is not None
    assert max(together.fractions.values()) < 0.02  # four errors of chance
    assert together.together > 0.95
    assert Polynomials.at(u, names).contributions(np.ones(1024)) is None
    whole = Polynomials.at(u[:9], {"all": [0, 1, 2, 3]}).contributions(x[:9, 0] * x[:9, 1])
    assert whole is not None
    assert whole.fractions == {"all": 1.0}  # nothing else varies


def test_effects_are_slopes_and_elasticities() -> None:
    """Of a b^2 and |c|: elasticities 1 and 2 to the order of the variances; c has a share and no sign."""
    inputs = {name: Distribution("uniform", 0.9, 1.1) for name in "ab"} | {
        "c": Distribution("uniform", -1, 1)
    }
    points = Samples.drawn(inputs, 64, 3)
    a, b, c = points.values.values()
    number = 5 * a * b**2 + np.abs(c)
    found = Polynomials.at(points.quantile, points.inputs.groups, points.values).contributions(number)
    assert found is not None
    effects, mean = found.effects, number.mean()
    assert effects["a"].slope == pytest.approx(5, abs=4 * effects["a"].error)
    assert effects["b"].slope == pytest.approx(10, abs=4 * effects["b"].error)
    assert effects["a"].error < 0.5
    assert effects["b"].elasticity == pytest.approx(effects["b"].slope / mean, rel=0.01)
    assert found.fractions["c"] > 0.1
    assert not effects["c"].is_clear
    assert np.isnan(effects["c"].elasticity)
    assert found.effect_of("c") == ""
    assert found.effect_of("b").startswith("+1.")


def test_band_of_one_input_is_the_input() -> None:
    """The bearings' friction adds to the torque: the quantiles are those of its distribution."""
    own = carried({}, {"bearing.friction_torque": "uniform(20 N*mm, 60 N*mm)"})
    gear = SteeringGear()
    band = band_of_runs(TURN, gear, FORMULA, own, samples=40)
    free = gear.replace({"bearing.friction_torque": 0.0})
    without = band_of_runs(TURN, free, FORMULA, carried({}, {"yoke.clearance": "50 um +- 1 um"}), 8)
    rest = without.nominal.summary["torque_mean"]
    # a Latin hypercube has one point in each fortieth: quantiles are exact to one of these
    expected = rest + own["bearing.friction_torque"].quantile(np.array(LEVELS))
    assert band.metrics["torque_mean"].values == pytest.approx(expected, abs=0.04 / 40)
    assert band.contributions["torque_mean"].fractions["bearing.friction_torque"] == pytest.approx(
        1, abs=0.01
    )
    effect = band.contributions["torque_mean"].effects["bearing.friction_torque"]
    assert effect.slope == pytest.approx(1, abs=0.01)
    assert set(band.as_dict()["effects"]) == set(band.contributions)
    assert "torque_mean" not in without.contributions  # the formula knows no clearance
    assert band.curves is not None
    assert np.ptp(band.curves.quantiles, axis=1).max() < 1e-12  # the formula has no ripple
    assert band.curves.quantiles[:, 0] == pytest.approx(band.metrics["torque_mean"].values)


def test_failed_samples_are_counted_with_their_cause() -> None:
    own = carried({}, {"yoke.clearance": "uniform(1 um, 100 um)"})
    gear = SteeringGear().replace({"pinion.runout": "26 um"})
    band = band_of_runs(TURN, gear, FORMULA, own, samples=100)
    assert band.drawn.failed in (25, 26)  # those below the runout, one point in each hundredth
    (cause,) = band.drawn.failures
    assert "exceeds yoke.clearance" in cause
    assert np.isnan(band.drawn.numbers["torque_mean"]).sum() == band.drawn.failed
    found = band.metrics["torque_mean"]
    assert found.lowest[0] == -np.inf
    assert found.highest[-1] == np.inf


def test_interrupted_band_is_that_of_the_samples_done(monkeypatch: pytest.MonkeyPatch) -> None:
    def stopping(*arguments: object) -> object:
        for number, part in enumerate(real(*arguments)):  # type: ignore[arg-type]
            if number == after:
                raise KeyboardInterrupt
            yield part

    real, after = band_module.runs_at, 20  # samples
    monkeypatch.setattr(band_module, "runs_at", stopping)
    own = carried({}, {"yoke.preload": "300 N +- 30 N"})
    band = band_of_runs(TURN, SteeringGear(), FORMULA, own, samples=64)
    assert band.interrupted
    assert len(band.drawn.samples) == after
    after = 0
    with pytest.raises(Interrupted):
        band_of_runs(TURN, SteeringGear(), FORMULA, own, samples=64)


@pytest.mark.parametrize("name", ["unknown", "series"])
def test_every_input_of_a_set_has_a_source_and_can_be_drawn(name: str) -> None:
    """Every value that a set draws makes a gear that can exist; what a gear does not have does not vary."""
    gear = SteeringGear().replace(
        {"pinion.axial_float": "0.05 mm", "bush.clearance": "30 um", "yoke.bore_friction": "20 N"}
    )
    found = uncertain_inputs(gear, name, {})
    assert set(found) == {each.path for each in SETS[name]}
    absent = set(found) - set(uncertain_inputs(SteeringGear(), name, {}))
    assert all(SteeringGear().value_at(path) == 0 for path in absent)
    assert all(each.source for each in SETS[name])
    for end in (0, 1):
        gear.replace({path: each.ends[end] for path, each in found.items()})


def test_own_values_and_distributions_come_before_a_series() -> None:
    gear = SteeringGear().replace({"pinion.runout": "30 um", "yoke.preload": "200 N"})
    own = carried({}, {"mesh.friction": "uniform(0.08, 0.12)"})
    found = uncertain_inputs(gear, "series", own)
    assert "pinion.runout" not in found  # the gear has one
    assert found["yoke.preload"].nominal == pytest.approx(200)
    assert found["mesh.friction"] == own["mesh.friction"]


TEETH, PLUNGER = "mesh.friction", "yoke.friction"
FRICTIONS = {"mesh": {"friction": "uniform(0.05, 0.15)"}, "yoke": {"friction": "uniform(0.05, 0.15)"}}


def drawn_torques(correlation: object, count: int = 400) -> np.ndarray:
    tables = FRICTIONS | ({} if correlation is None else {CORRELATION: {f"{TEETH}, {PLUNGER}": correlation}})
    points = Samples.drawn(uncertain_inputs(SteeringGear(), "own", carried(tables, {})), count, seed=4)
    return formula_torques(SteeringGear(), points)


def test_inputs_as_one_have_the_width_of_the_closed_form() -> None:
    """The free torque is a sum of both frictions: as one its ends are those of both at their ends, one way
    (1) or the other (-1); independent, its variance is the sum of both."""
    gear = SteeringGear()

    def torque(teeth: float, plunger: float) -> float:
        return mean_state(gear.replace({TEETH: teeth, PLUNGER: plunger}), 1, 0.0).torque

    for value, ends in (("as one", ((0.05, 0.05), (0.15, 0.15))), (-1, ((0.05, 0.15), (0.15, 0.05)))):
        low, high = sorted(torque(*each) for each in ends)
        found = np.quantile(drawn_torques(value), (0.05, 0.95))
        # points of a hypercube: one in each four hundredth; the formula bends by less than a percent
        expected = low + (high - low) * np.array([0.05, 0.95])
        assert found == pytest.approx(expected, abs=0.02 * (high - low))
    parts = [torque(0.15, 0.1) - torque(0.05, 0.1), torque(0.1, 0.15) - torque(0.1, 0.05)]
    for r in (None, 0.5):
        # the correlation of uniform inputs whose normal scores have 0.5 is 6 / pi asin(0.25) = 0.483
        cross = 0.0 if r is None else 2 * 6 / np.pi * np.arcsin(r / 2) * parts[0] * parts[1]
        variance = (parts[0] ** 2 + parts[1] ** 2 + cross) / 12
        assert np.var(drawn_torques(r, 4000)) == pytest.approx(variance, rel=0.06)  # 3 / sqrt(4000)


def test_independent_inputs_are_drawn_as_ever() -> None:
    """A correlation of 0, and inputs beside correlated ones, leave the hypercube as it is."""
    inputs = carried(FRICTIONS | {"bush": {"drag": "20 N +- 2 N"}}, {})
    plain = qmc.LatinHypercube(3, rng=np.random.default_rng(7)).random(32)
    assert np.array_equal(Samples.drawn(inputs, 32, 7).quantile, plain)
    pair = frozenset((TEETH, PLUNGER))
    assert np.array_equal(Samples.drawn(replace(inputs, pairs={pair: 0.0}), 32, 7).quantile, plain)
    moved = Samples.drawn(replace(inputs, pairs={pair: 0.5}), 32, 7).quantile
    changed = [i for i in range(3) if not np.array_equal(moved[:, i], plain[:, i])]
    assert [list(inputs)[i] for i in changed] == [TEETH if list(inputs).index(TEETH) > 0 else PLUNGER]


def test_teeth_and_plunger_share_a_grease_unless_the_file_says_otherwise() -> None:
    gear, pair = SteeringGear(), frozenset((TEETH, PLUNGER))
    for name in ("series", "unknown"):
        assert uncertain_inputs(gear, name, {}).pairs == {pair: 0.5}
        without = carried({CORRELATION: {f"{TEETH}, {PLUNGER}": 0}}, {})
        assert uncertain_inputs(gear, name, without).pairs == {pair: 0.0}
    assert uncertain_inputs(gear, None, carried(FRICTIONS, {})).pairs == {}


def test_inputs_that_vary_together_have_one_contribution() -> None:
    """As one, the share of both is that of their sum; beside it the drag's."""
    tables = FRICTIONS | {
        "bush": {"drag": "uniform(0 N, 40 N)"},
        CORRELATION: {f"{TEETH},{PLUNGER}": "as one"},
    }
    points = Samples.drawn(uncertain_inputs(SteeringGear(), None, carried(tables, {})), 512, seed=2)
    torques = formula_torques(SteeringGear(), points)
    found = Polynomials.at(points.quantile, points.inputs.groups).contributions(torques)
    assert found is not None
    drag = np.var(0.0055747 * points.values["bush.drag"])
    assert found.fractions["bush.drag"] == pytest.approx(drag / np.var(torques), abs=0.01)
    assert sum(found.fractions.values()) == pytest.approx(1, abs=0.01)
    assert len(found.fractions) == 2


@pytest.mark.parametrize(
    ("tables", "said"),
    [
        ({CORRELATION: 5}, "correlation is 5; it must be a table"),
        ({CORRELATION: {TEETH: 0.5}}, "a correlation names two inputs"),
        ({CORRELATION: {f"{TEETH}, {PLUNGER}": 1.5}}, 'is 1.5; it must be from -1 to 1, or "as one"'),
        ({CORRELATION: {f"{TEETH}, bush.drag": 0.5}}, "names bush.drag, which does not vary"),
        ({POSTERIOR: {"yoke.preload": [300.0, "a"]}}, "must be a list of at least 16 numbers"),
        ({POSTERIOR: {"yoke.preloads": [300.0] * 20}}, "yoke.preloads, which is no parameter"),
        (
            {POSTERIOR: {"yoke.preload": [310.0, *range(290, 320)]}},
            "yoke.preload is 300 N, but 310 N in the table",
        ),
    ],
)
def test_wrong_tables_of_what_varies_together(tables: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=re.escape(said)):
        uncertain_inputs(SteeringGear(), None, carried(FRICTIONS | tables, {}))


def test_correlations_that_cannot_be_together_are_refused() -> None:
    names = [TEETH, PLUNGER, "bush.drag"]
    pairs = {
        frozenset(each): value for each, value in zip(combinations(names, 2), (0.9, 0.9, -0.9), strict=True)
    }
    with pytest.raises(InputError, match="cannot be together"):
        correlated(np.full((4, 3), 0.3), names, pairs)


@pytest.fixture(scope="module")
def both() -> tuple[Band, Band]:
    """Quick band and plain runs of the same two inputs."""
    settings = {"yoke.preload": "uniform(200 N, 400 N)", "mesh.friction": "uniform(0.05, 0.15)"}
    own, gear = carried({}, settings), SteeringGear()
    return quick_band(gear, EQUILIBRIA, own, runs=20), band_of_runs(TURN, gear, EQUILIBRIA, own, 128, seed=5)


def test_quick_band_is_that_of_many_runs(both: tuple[Band, Band]) -> None:
    """3 %: three times the 1 % that quantiles of 128 points of a hypercube scatter by."""
    quick, runs = (each.metrics["torque_mean"] for each in both)
    assert quick.values == pytest.approx(runs.values, rel=0.03)
    assert (quick.errors < 0.02 * quick.values).all()
    shares = [each.contributions["torque_mean"].fractions for each in both]
    assert shares[0] == pytest.approx(shares[1], abs=0.08)  # the sum of the chances of both


def test_curves_of_both_bands_agree(both: tuple[Band, Band]) -> None:
    quick, runs = (each.curves for each in both)
    assert quick is not None
    assert runs is not None
    # 3 % as the means, and 2 % for the course of the ripple, which the quick band pairs with them at random
    assert quick.quantiles[[0, -1]] == pytest.approx(runs.quantiles[[0, -1]], rel=0.05)


def test_solution_error_stands_beside_the_band(both: tuple[Band, Band]) -> None:
    """The bar of the mean is its floor of 0.2 %, 0.5 % at most; all gears have about the same."""
    quick, _ = both
    mean, bar = (each["torque_mean"] for each in (quick.nominal.summary, quick.nominal.errors))
    assert 0 < bar < 5e-3 * mean
    of_runs = quick.drawn.numerical["torque_mean"]
    assert [of_runs.of_sample, *of_runs.of_quantiles] == pytest.approx(6 * [bar], rel=0.6)
    assert quick.law is not None
    assert quick.law.law == "teeth"
    stored = quick.as_dict()["figures"]["torque_mean"]
    assert stored["nominal_error"] == bar
    assert stored["numerical_errors_of_quantiles"] == of_runs.of_quantiles.tolist()


def test_quantiles_move_by_the_bars_of_the_samples_about_them() -> None:
    """Bars of a tenth, and two unknown ones of twenty: those reach beyond the quantile of 95 % alone."""
    numbers = np.arange(1.0, 21.0)
    found = numerical_error(numbers, np.append(numbers[:-2] / 10, [np.nan, np.nan]))
    assert found.of_sample == pytest.approx(1.1)
    assert np.isinf(found.of_quantiles).tolist() == [True, False, False, False, True]


def test_no_error_of_the_law_where_the_nominal_yoke_touches_its_nut() -> None:
    """There the laws differ by more than any error that was measured."""
    gear = SteeringGear().replace({"pinion.runout": "26 um", "yoke.clearance": "10 um"})
    band = band_of_runs(TURN, gear, EQUILIBRIA, carried({}, {"bush.drag": "uniform(10 N, 30 N)"}), 8)
    assert Code.YOKE_STOPPED in band.nominal.codes
    assert band.law is None
    assert band.as_dict()["law_error"] is None


@pytest.mark.parametrize(("scene", "count", "rounding"), [(TURN, 24, 0.0), ("rack-lift", 8, 1e-8)])
def test_numbers_depend_neither_on_processes_nor_on_parts(
    scene: str, count: int, rounding: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Bit for bit for gears computed together; else but for BLAS, which has one thread in processes."""
    monkeypatch.setattr("rps_exudyn.inference.uncertainty.samples.TOGETHER", 8)
    monkeypatch.setattr("rps_exudyn.simulate.cases.run_cases.STARTING", -1.0)  # processes after the first
    own = carried({}, {"yoke.preload": "uniform(200 N, 400 N)"})
    gear = SteeringGear().replace({"test.turns": 0.2})
    alone, shared = (band_of_runs(scene, gear, EQUILIBRIA, own, count, jobs=jobs) for jobs in (1, 2))
    assert alone.drawn.numbers.keys() == shared.drawn.numbers.keys()
    for name, numbers in alone.drawn.numbers.items():
        assert shared.drawn.numbers[name] == pytest.approx(numbers, rel=rounding, abs=0, nan_ok=True)


def test_a_sample_whose_process_ends_is_one_that_failed(monkeypatch: pytest.MonkeyPatch) -> None:
    own, gear = carried({}, {"yoke.preload": "300 N +- 30 N"}), SteeringGear()
    died = Answer(ended="its process was ended by SIGSEGV")

    def dying(tasks: list[Task], *how: Any) -> Iterator[tuple[Task, Answer]]:
        for number, (task, answer) in enumerate(run_cases(tasks, *how)):
            yield task, died if number == 3 else answer

    monkeypatch.setattr("rps_exudyn.inference.uncertainty.samples.run_cases", dying)
    band = band_of_runs(TURN, gear, FORMULA, own, samples=16)
    assert dict(band.drawn.failures) == {"crashed: its process was ended by SIGSEGV": 1}
    assert np.isnan(band.drawn.numbers["torque_mean"][3])


def test_a_sample_beyond_its_time_limit_is_one_that_failed() -> None:
    """A part that is computed together and does not end is done again, sample by sample."""
    own, gear = carried({}, {"yoke.preload": "uniform(200 N, 400 N)"}), SteeringGear()
    with pytest.raises(InputError, match=r"16 of 16 samples failed.*timeout: the run took"):
        band_of_runs(TURN, gear, EQUILIBRIA, own, 16, time_limit=1e-4)
