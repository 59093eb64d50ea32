"""A gear fitted to made-up curves of the model with noise: what is found, how surely, and what is not.

The curves come from whole scenes in steps of one degree, the fit's from its own maneuvers in two. They judge
the estimator, not the model. Standard deviations that bound errors are those of the noise put in.
"""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from rps_exudyn.base.errors import InputError
from rps_exudyn.cli.options import GearOptions
from rps_exudyn.inference.fitting.bench_tests import BenchTest, measurement_of
from rps_exudyn.inference.fitting.findings import fit_as_dict, gear_text, open_sentences, rows
from rps_exudyn.inference.fitting.fit import fit
from rps_exudyn.inference.fitting.fitted import Estimate, Fit, shape_claims, with_others
from rps_exudyn.inference.fitting.identifiability import LevelData, advice_of, more_runs
from rps_exudyn.inference.fitting.level_fit import LevelModel, fitted_levels
from rps_exudyn.inference.fitting.nonlinear import OtherShape
from rps_exudyn.inference.fitting.posterior import SAMPLES
from rps_exudyn.inference.fitting.series import read_series, write_series
from rps_exudyn.inference.fitting.unknowns import LEVEL, NUISANCES, USUAL, settings_of, unknowns_of
from rps_exudyn.inference.uncertainty.input_sets import uncertain_inputs
from rps_exudyn.inference.uncertainty.quick_band import formula_torques
from rps_exudyn.inference.uncertainty.samples import Samples
from rps_exudyn.pages.report.fit_page import fit_sheet
from rps_exudyn.parameters.gear import SteeringGear, gear_file
from rps_exudyn.results.judged_row import Verdict
from rps_exudyn.scenes.error_bars import FACTOR, FLOOR
from rps_exudyn.solvers.closed_form import GRAVITY
from verification.made_up_curves import (
    DISTURBANCES,
    FREE,
    REAL,
    REPEATED,
    SET,
    WEIGHTS,
    WHITE,
    BenchNoise,
    curve_of,
    least_deviations,
    measured,
    measured_curve,
    true_curve,
    true_gear,
    true_level,
    with_noise,
)

LEVEL_SD = 0.02 / np.sqrt(722)  # of the mean of both passes, white noise of 2 %
NEVER = {"yoke.preload", "mesh.friction", "yoke.friction"}
KNOWN = (*LEVEL, *NUISANCES)
NOTHING = LevelData(KNOWN, np.zeros((len(KNOWN), len(KNOWN))))


@cache
def free_fit() -> Fit:
    return fit(measurement_of([measured(FREE, WHITE, np.random.default_rng(5))]), other_law=False)


def level_error(found: Fit) -> float:
    assert found.level is not None
    return found.level.value / true_level() - 1


def test_free_torque_tells_its_level_and_the_runout() -> None:
    """Within four standard deviations of the noise put in; that of the run is at most 2.5 times so wide."""
    found = free_fit()
    assert found.converged
    assert found.simulations <= 15
    assert abs(level_error(found)) < 4 * LEVEL_SD
    assert found.level is not None
    half = found.level.run_interval[1] - found.level.value
    assert 1.96 * LEVEL_SD < half / found.level.value < 2.5 * 1.96 * LEVEL_SD
    assert found.level.sd / found.level.value == pytest.approx(0.0288, rel=0.02)  # t of 4, 2 %; 0.5 %
    for path in ("pinion.runout", "pinion.runout_angle"):
        each = found.estimate(path)
        assert abs(each.value - true_gear().value_at(path)) < 4 * each.sd
        assert each.verdict is Verdict.NOT_ZERO


def test_free_torque_never_finds_preload_and_friction() -> None:
    """Whatever the priors are: the combination is named, and the tests that would separate it."""
    found = free_fit()
    assert not NEVER & set(found.found)
    (product,) = found.combinations
    assert set(product.exponents) >= NEVER
    assert product.sd < 0.03  # the repeatability and the calibration that are declared
    sentences = " ".join(open_sentences(found))
    assert "not separable by these tests: yoke.preload, mesh.friction, yoke.friction" in sentences
    assert "at the rack's end" in sentences
    assert "without the yoke" in sentences
    narrow = {"mesh.friction": (0.085, 0.001), "yoke.friction": (0.12, 0.001), "bush.drag": (25.0, 0.1)}
    known = fit(
        measurement_of([measured(FREE, WHITE, np.random.default_rng(5))]), priors=narrow, other_law=False
    )
    assert not NEVER & set(known.found)
    assert known.estimate("yoke.preload").verdict is Verdict.BY_PRIOR
    assert known.estimate("yoke.preload").value == pytest.approx(350.0, rel=0.03)


def test_shape_would_claim_what_the_fit_does_not_print() -> None:
    """With the law taken for true the preload would look known; the levels leave two thirds of the doubt."""
    claims, found = shape_claims(free_fit()), free_fit().estimate("yoke.preload")
    assert claims["yoke.preload"] < 0.5 * found.sd
    assert found.sd > 0.5 * LEVEL["yoke.preload"].sd


def test_interval_without_noise_is_that_of_the_numerical_error() -> None:
    problem = free_fit().problem
    rows = replace(problem.rows, covariance=1e-12 * problem.rows.covariance)
    drag = [each for each in problem.unknowns if each.path == "bush.drag"]
    model = LevelModel.of(rows, drag, SteeringGear())
    begin = np.array([drag[0].before])
    model, state = fitted_levels(model, problem.prediction, problem.rows_of, lambda gear, _: gear, begin)
    assert state.converged
    of_level = float(np.abs(model.slopes(state.u)[0, 0]) * np.sqrt(state.covariance[0, 0]))
    coarse = replace(problem.prediction, level=0).simulated(model.gear.replace(settings_of(drag, state.u)))
    change = problem.rows_of(state.values - coarse)[0]
    assert of_level > 0.99 * max(
        abs(change), FLOOR / FACTOR * rows.values[0]
    )  # 0.99: the prior knows a little


def test_next_gear_of_a_series_takes_three_simulations() -> None:
    curve = measured(FREE, WHITE, np.random.default_rng(6))
    second = fit(measurement_of([curve]), like=free_fit())
    assert second.converged
    assert second.simulations <= 3
    assert abs(level_error(second)) < 4 * LEVEL_SD


def test_a_series_is_the_same_from_its_file(tmp_path: Path) -> None:
    """The next fit ends where it would without the file; sums of rounded terms differ in the last digits."""
    path, first = tmp_path / "series.json", free_fit()
    write_series(first.series, path)
    measurement = measurement_of([measured(FREE, WHITE, np.random.default_rng(6))])
    kept, read = (fit(measurement, like=like) for like in (first, read_series(path)))
    assert read.level is not None
    assert kept.level is not None
    assert read.level.interval == pytest.approx(kept.level.interval, rel=1e-9)
    assert read.simulations == kept.simulations <= 3
    other = fit(measurement, like=read_series(path), free=("yoke.preload",))
    assert other.converged
    assert any("series is not used: it fitted yoke.preload, mesh.friction" in each for each in other.warnings)


@pytest.mark.parametrize(("case", "most"), [("spikes", 0.0025), ("disturbed", 0.007), ("missing", 0.003)])
def test_what_disturbs_a_curve_hardly_moves_its_level(case: str, most: float) -> None:
    random = np.random.default_rng(7)
    test, curve = measured(FREE, WHITE, random)
    found = fit(measurement_of([(test, DISTURBANCES[case](curve, random))]), other_law=False)
    assert abs(level_error(found)) < most
    low, high = found.level.run_interval  # type: ignore[union-attr]
    assert low <= true_level() <= high


def test_one_way_alone_leaves_the_zero_open() -> None:
    random = np.random.default_rng(8)
    test, curve = measured(FREE, WHITE, random)
    found = fit(measurement_of([(test, DISTURBANCES["one way"](curve, random))]), other_law=False)
    assert any("one direction only" in sentence for sentence in found.warnings)
    assert found.level is not None
    assert free_fit().level is not None
    rows = {row.name: row.half / found.level.value for row in found.level.budget}
    assert rows["zero, one way only"] == pytest.approx(0.03 * 2.776, rel=1e-3)


def test_repeats_count_beside_what_is_declared() -> None:
    """Three runs: the declared 2 % as four degrees of freedom, their scatter as two, Student's t of six."""
    random = np.random.default_rng(9)
    noise = BenchNoise(repeatability=0.02)
    found = fit(measurement_of([measured(FREE, noise, random) for _ in range(3)]), other_law=False)
    assert found.level is not None
    levels = found.level.run_levels / found.level.value
    row = next(row for row in found.level.budget if row.name == "repeatability")
    scatter = float(np.var(levels, ddof=1))
    sd = np.sqrt(max((4 * 0.02**2 + 2 * scatter) / 6, scatter) / 3)
    assert row.half / found.level.value == pytest.approx(2.447 * sd, rel=5e-3)
    assert abs(level_error(found)) < 4 * 0.02 / np.sqrt(3)


def test_without_yoke_and_rack_drag_and_bearings_are_found() -> None:
    random = np.random.default_rng(10)
    found = fit(measurement_of([measured(test, WHITE, random) for test in SET[:3]]), other_law=False)
    assert found.found[:2] == ["bush.drag without yoke", "bearing.friction_torque"]
    assert found.estimate("bush.drag without yoke").value == pytest.approx(25.0, rel=0.05)
    drag = found.estimate("bush.drag")
    assert drag.verdict is Verdict.BY_RATIO
    assert drag.sd > 0.2
    assert found.estimate("bearing.friction_torque").value == pytest.approx(0.03, rel=0.05)


def test_rollers_separate_the_two_frictions() -> None:
    """One run each: the rollers narrow both coefficients to less than 0.6 of what they are without."""
    tests, rollers = (*SET[:3], WEIGHTS[-1]), BenchTest("rack-on-rollers")
    curves = [
        measured(test, WHITE, np.random.default_rng([11, i])) for i, test in enumerate((*tests, rollers))
    ]
    with_rollers = fit(measurement_of(curves), other_law=False)
    without = fit(measurement_of(curves[:-1]), other_law=False)
    assert with_rollers.converged
    for path, true in (
        ("mesh.friction", true_gear().mesh.friction),
        ("yoke.friction", true_gear().yoke.friction),
    ):
        after, before = (each.estimate(path) for each in (with_rollers, without))
        assert after.sd < 0.6 * before.sd
        assert after.low < true < after.high


def test_a_weight_that_lifts_a_flank_finds_the_preload() -> None:
    """Within 8 %: the declared repeatability of 2 % lets the prior, 15 % off, pull at it. One weight does not
    show whether friction changes under load: three times wider beliefs of that leave more than 20 %."""
    random = np.random.default_rng(11)
    tests = (*SET[:3], WEIGHTS[-1])
    found = fit(measurement_of([measured(test, WHITE, random) for test in tests]), other_law=False)
    assert found.converged
    assert found.estimate("yoke.preload").verdict is Verdict.BY_PRIOR
    assert found.estimate("yoke.preload").value == pytest.approx(350.0, rel=0.08)


def test_what_means_determine_follows_from_the_closed_form() -> None:
    """Weights below a flank's lifting measure the same sum as the free torque; one beyond does not."""
    gear = SteeringGear()
    light, heavy = (BenchTest("load-test", mass * GRAVITY) for mass in (10.0, 150.0))
    free = NOTHING.with_test(gear, FREE)
    for same in (BenchTest("rack-push"), BenchTest("reversal"), light):
        assert free.with_test(gear, same).from_data()["yoke.preload"] > 0.5
    apart = free.with_test(gear, BenchTest("yoke-out")).with_test(gear, BenchTest("bearing"))
    assert apart.from_data()["bearing.friction_torque"] < 0.05
    assert 0.2 < apart.from_data()["bush.drag"] < 0.25  # with and without yoke: a ratio of 25 %
    assert apart.from_data()["yoke.preload"] > 0.5
    assert apart.with_test(gear, heavy).from_data()["yoke.preload"] < 0.12
    advice = advice_of(gear, free, [FREE])
    assert advice is not None
    assert {"yoke-out", "bearing", "load-test"} <= {test.kind for test in advice.tests}


def test_real_noise_widens_the_interval_to_what_runs_differ_by() -> None:
    found = fit(measurement_of([measured(FREE, REAL, np.random.default_rng(12))]), other_law=False)
    assert found.level is not None
    assert (found.level.run_interval[1] - found.level.value) / found.level.value > 0.004  # white: 0.0015
    assert any("noise is correlated" in sentence for sentence in found.warnings)


def test_another_law_widens_the_intervals_and_keeps_the_level() -> None:
    both = fit(measurement_of([measured(FREE, WHITE, np.random.default_rng(5))]))
    alone = free_fit()
    for path in NEVER:
        assert both.estimate(path).by_law != 0
        wide, narrow = (each.estimate(path).interval for each in (both, alone))
        assert wide[1] - wide[0] > narrow[1] - narrow[0]
    assert abs(level_error(both)) < 4 * LEVEL_SD


def test_signs_of_a_bench_are_turned_and_said() -> None:
    """Torques against the motion, and torques that count negative along the motion, are the same curve."""
    curve = curve_of(FREE)
    half = np.arange(curve["value"].size) < curve["value"].size // 2
    given = measurement_of([measured_curve(curve, FREE)])
    for changed in (np.where(half, 1, -1) * curve["value"], -curve["value"]):
        turned = measurement_of([measured_curve({**curve, "value": changed}, FREE)])
        for a, b in zip(given.passes, turned.passes, strict=True):
            np.testing.assert_allclose(a.value[3:-3], b.value[3:-3])
        assert len(turned.assumed) == len(given.assumed) + 1


def test_a_fit_that_did_not_converge_calls_nothing_known() -> None:
    lost = replace(free_fit(), ended=replace(free_fit().ended, converged=False))
    names = [row.value for row in fit_sheet(lost).rows]
    assert "known" in [row.value for row in fit_sheet(free_fit()).rows]
    assert "no estimate" in names
    assert not {"known", "with priors", "not separable"} & {*names}
    assert {(row[2], row[4]) for row in rows(lost)} == {("", "last iteration, no estimate")}


def test_a_fit_is_written_without_its_curves() -> None:
    content = fit_as_dict(free_fit())
    assert content["level"]["value"] == free_fit().level.value  # type: ignore[union-attr]
    assert content["estimates"]["yoke.preload"]["verdict"] == "not separable"
    assert content["further_tests"]["tests"]


def test_an_angle_error_is_found_with_its_sign() -> None:
    """Although preload and friction begin 17 to 25 % off, which changes the size of the ripple as well; the
    level is that of the gear with the error."""
    gear = true_gear().replace({"installation.angle_error": "-0.06 deg"})
    curve = true_curve(gear, FREE)
    noisy = with_noise(curve, WHITE, np.random.default_rng(13))
    free = (*USUAL, "installation.angle_error")
    found = fit(measurement_of([measured_curve(noisy, FREE)]), free=free, other_law=False)
    assert found.converged
    each = found.estimate("installation.angle_error")
    assert each.verdict is Verdict.NOT_ZERO
    assert abs(each.value - np.radians(-0.06)) < 3 * each.sd
    assert each.sd < np.radians(0.012)
    assert not NEVER & set(found.found)
    half = curve["value"].size // 2
    true = (curve["value"][:half].mean() - curve["value"][half:].mean()) / 2
    assert found.level is not None
    assert found.level.value == pytest.approx(true, rel=4 * LEVEL_SD + 1e-3)  # and the formula's slopes


def test_a_prior_of_the_runout_leaves_its_direction_to_the_curve() -> None:
    curve = measurement_of([measured(FREE, WHITE, np.random.default_rng(5))])
    free, held = (
        fit(curve, free=("pinion.runout",), priors=priors, other_law=False)
        for priors in ({}, {"pinion.runout": (40e-6, 1e-6)})
    )
    one, other = (each.estimate("pinion.runout_angle") for each in (free, held))
    assert other.value == pytest.approx(one.value, abs=0.01)
    assert held.estimate("pinion.runout").value > free.estimate("pinion.runout").value


def test_a_prior_of_what_is_not_fitted_is_named() -> None:
    curve = measurement_of([measured(FREE, WHITE, np.random.default_rng(5))])
    found = fit(curve, free=("yoke.preload",), priors={"mesh.friction": (0.05, 0.001)}, other_law=False)
    assert any("the prior of mesh.friction is not used" in each for each in found.warnings)


def test_steps_of_contradicting_tests_end_within_what_a_gear_may_have() -> None:
    path = "bush.drag"
    unknowns = unknowns_of(SteeringGear(), [path], {})
    for value in (-500.0, 500.0):
        SteeringGear().replace(settings_of(unknowns, np.array([value])))


def test_a_runout_alone_is_fitted_with_samples_for_bands() -> None:
    found = fit(measurement_of([measured(FREE, WHITE, np.random.default_rng(5))]), free=("pinion.runout",))
    assert [each.path for each in found.estimates][:1] == ["pinion.runout"]
    assert found.posterior["pinion.runout"].shape == (SAMPLES,)


def test_a_runout_is_found_beside_a_bow() -> None:
    """Although the bow moves half the sum of both directions over the travel by more than the runout does."""
    true = {"pinion.runout": 40e-6, "pinion.runout_angle": -1.0, "rack.bow": 174e-6, "rack.bow_angle": 1.0}
    gear = true_gear().replace({**true, "test.turns": 3.8})
    noisy = with_noise(true_curve(gear, FREE), WHITE, np.random.default_rng(8))
    found = fit(measurement_of([measured_curve(noisy, FREE)]), free=("rack.bow",), other_law=False)
    assert found.converged
    assert {*USUAL, *true} <= {each.path for each in found.estimates}  # the usual ones are never held beside
    for path, value in true.items():
        each = found.estimate(path)
        assert each.verdict is Verdict.NOT_ZERO
        assert each.interval[0] < value < each.interval[1], path
    assert found.runout is not None
    low, high = found.runout.stored_interval
    stored = gear.yoke.preload * 40e-6
    assert low < stored < high < 1.1 * stored


def test_other_ends_widen_an_interval_and_leave_the_direction_open() -> None:
    size = Estimate.of("rack.bow", 1e-4, (0.9e-4, 1.1e-4), (0.0, 1e-4), 5e-6, 0.0, Verdict.NOT_ZERO)
    angle = Estimate.of("rack.bow_angle", 1.0, (0.9, 1.1), (0.0, np.pi), 0.05, 0.0, Verdict.NOT_ZERO)
    near, far = (OtherShape({"rack.bow": 1.3e-4, "rack.bow_angle": 2.0}, worse) for worse in (1.0, 8.0))
    assert with_others(size, [near]).interval == (0.9e-4, 1.3e-4)
    assert with_others(angle, [near]).verdict is Verdict.OPEN
    assert with_others(angle, [far]) == angle


def test_least_deviations_fall_with_the_root_of_the_runs() -> None:
    """Without prior belief three runs tell sqrt(3) times as much; no set of one run keeps preload to 2 %."""
    one, three = (least_deviations(REPEATED, runs) for runs in (1, 3))
    for path, sd in one.items():
        assert sd / three[path] == pytest.approx(np.sqrt(3), rel=1e-9)
    assert one["yoke.preload"] > 0.02


def test_runs_that_would_reach_what_is_wanted() -> None:
    """1.96 s / sqrt(n) <= 5 %: of a run that scatters by 10 %, n = 16 (4.9 %), not 15 (5.06 %); what is
    reached is not named."""
    halves = {"yoke.preload": 0.2, "mesh.friction": 0.1}
    found = more_runs(halves, 1, lambda runs: dict.fromkeys(halves, 0.1 / np.sqrt(runs)))
    assert found is not None
    assert found.runs == {"yoke.preload": 16}
    never = more_runs(halves, 1, lambda _: dict.fromkeys(halves, 0.1))
    assert never is not None
    assert never.runs == {"yoke.preload": None}
    assert more_runs({"yoke.preload": 0.04}, 1, lambda _: {}) is None


def test_repeats_of_several_tests_share_their_scatter() -> None:
    """Three runs of three tests with a repeatability of 2 % each: ten degrees of freedom with the declared
    four, and the same part of each level."""
    random = np.random.default_rng(12)
    noise = BenchNoise(repeatability=0.02)
    files = [measured(test, noise, random) for test in SET[:3] for _ in range(3)]
    found = fit(measurement_of(files), other_law=False)
    rows = [next(row for row in level.budget if row.name == "repeatability") for level in found.levels]
    assert all("6 degrees of freedom" in row.basis for row in rows)
    parts = [row.half / level.value for row, level in zip(rows, found.levels, strict=True)]
    assert parts == pytest.approx([parts[0]] * 3, rel=0.02)  # but for each test's own white noise
    drag = found.estimate("bush.drag without yoke")
    assert drag.value == pytest.approx(25.0, rel=0.06)  # 2.2 standard errors


def test_teeth_and_runout_under_a_weight_are_no_outliers() -> None:
    """Three runs of six tests with white noise alone: what is left of 20 um of runout and of the teeth under
    80 and 150 kg must not move their levels. The preload comes within 2 %, half the deviation that friction
    under load leaves; with the ripple weighed as outliers it was 3 % off."""
    random = np.random.default_rng([5, 0])
    files = [measured(test, WHITE, random) for test in SET for _ in range(3)]
    found = fit(measurement_of(files), other_law=False)
    assert found.converged
    assert found.estimate("yoke.preload").value == pytest.approx(350.0, rel=0.02)


def test_samples_of_a_fit_are_its_intervals(tmp_path: Path) -> None:
    """Written and read again, the samples have the interval of each parameter (2 %: 512 samples), and the
    band of the torque is that of the measured level, of normal tails instead of Student's t, though each
    parameter alone is known ten times worse."""
    found = free_fit()
    file = tmp_path / "fitted.toml"
    file.write_text(gear_text(found, gear_file(found.gear)), "utf-8")
    options = GearOptions(gear=file)
    gear, inputs = options.load(), uncertain_inputs(options.load(), None, options.carried())
    assert set(inputs) == {*LEVEL, "pinion.runout", "pinion.runout_angle"}
    for path in LEVEL:
        each = found.estimate(path)
        ends = np.log(np.quantile(inputs[path].values, (0.025, 0.975)))  # type: ignore[attr-defined]
        assert ends[1] - ends[0] == pytest.approx(np.log(each.interval[1] / each.interval[0]), rel=0.08)
    torques = formula_torques(gear, Samples.drawn(inputs, 512, seed=1))
    assert found.level is not None
    half = 1.96 * float(found.model.rows.covariance[0, 0]) ** 0.5
    low, middle, high = np.quantile(torques, (0.025, 0.5, 0.975))
    assert (high - low) / 2 / middle == pytest.approx(half / found.level.value, rel=0.1)
    assert middle == pytest.approx(found.level.value, rel=0.01)
    # P e is measured: preload and runout vary against each other
    stored = inputs["pinion.runout"].values * np.array(inputs["yoke.preload"].values)  # type: ignore[attr-defined]
    assert found.runout is not None
    assert np.quantile(stored, 0.975) == pytest.approx(found.runout.stored_interval[1], rel=0.03)


def test_samples_of_a_gear_that_was_changed_are_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A value given by --set replaces its samples."""
    found = free_fit()
    file = tmp_path / "fitted.toml"
    changed = found.gear.replace({"yoke.preload": "400 N"})
    file.write_text(gear_text(found, gear_file(changed)), "utf-8")
    options = GearOptions(gear=file)
    with pytest.raises(InputError, match=r"yoke\.preload is 400 N, but .* in the table posterior"):
        uncertain_inputs(options.load(), None, options.carried())
    options = GearOptions(gear=file, settings=("yoke.preload=410 N",))
    assert "yoke.preload" not in uncertain_inputs(options.load(), None, options.drawn())
    told = capsys.readouterr().err
    assert "yoke.preload: the setting replaces samples" in told
    assert "mesh.friction" in told
