"""Main effects and sensitivity indices against numbers known by formula."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from made_up_study import GRID, sampled
from rps_exudyn.base.errors import InputError
from rps_exudyn.results.block import CaseRow
from rps_exudyn.results.outcome import Status
from rps_exudyn.study.definition import Axis, Case
from rps_exudyn.study.effects import grid_effect, sampled_effect, surface
from rps_exudyn.study.sensitivity import indices
from rps_exudyn.study.table import CaseTable

A, B, C = (values.ravel() for values in np.meshgrid([0.0, 1, 2], [0.0, 1, 2, 3], [0.0, 1], indexing="ij"))
AXES = {"a": A, "b": B, "c": C}
FREE = np.zeros(A.size, dtype=bool)  # no case met a limit


def test_additive_effects_are_found_exactly() -> None:
    numbers = 2 * A - B
    effect = grid_effect(AXES, "a", numbers, FREE)
    np.testing.assert_allclose(effect.mean, np.array([0, 2, 4]) - 1.5)
    assert effect.span == pytest.approx(4)
    shares = [grid_effect(AXES, name, numbers, FREE).fraction for name in AXES]
    variances = np.array([4 * 2 / 3, 5 / 4, 0])  # of 2 a and of b over their levels
    np.testing.assert_allclose(shares, variances / variances.sum(), atol=1e-15)


def test_missing_cases_do_not_bend_an_effect() -> None:
    """The cases with large b are missing at large a: plain means would fall there."""
    numbers = np.where((A == 2) & (B > 1), np.nan, A + 10 * B)
    np.testing.assert_allclose(np.diff(grid_effect(AXES, "a", numbers, FREE).mean), 1)
    levels, others, means = surface(AXES, "a", "b", numbers)
    assert means.shape == (len(levels), len(others))
    np.testing.assert_array_equal(np.isnan(means), [[False] * 4, [False] * 4, [False, False, True, True]])


def test_level_with_hardly_any_case_has_no_mean() -> None:
    numbers = np.where((A == 2) & (B > 0), np.nan, A)
    assert np.isnan(grid_effect(AXES, "a", numbers, FREE).mean).tolist() == [False, False, True]


def test_sampled_effect_follows_the_number() -> None:
    x = np.random.default_rng(1).random(400)
    effect = sampled_effect(x, x**2, np.zeros(x.size, dtype=bool))
    np.testing.assert_allclose(effect.mean, effect.levels**2, atol=0.004)  # a class spans 1/8
    assert effect.fraction > 0.97
    assert sampled_effect(x, np.random.default_rng(2).random(400), np.zeros(400, dtype=bool)).fraction < 0.05


def test_levels_know_on_which_side_of_a_limit_their_cases_are() -> None:
    """0 or 1 where all known cases agree, nan where some met the limit; both kinds of design alike."""
    limited = (A == 2) | ((A == 1) & (B > 1))
    np.testing.assert_array_equal(grid_effect(AXES, "a", A, limited).side, [0, np.nan, 1])
    unknown = np.where((A == 1) & (B > 1), np.nan, A)
    np.testing.assert_array_equal(grid_effect(AXES, "a", unknown, limited).side, [0, 0, 1])
    x = np.linspace(0, 1, 80)
    np.testing.assert_array_equal(sampled_effect(x, x, x > 0.55).side, [0, 0, 0, 0, np.nan, 1, 1, 1])


def test_words_are_levels_too() -> None:
    words, free = np.array(["line", "area", "line", "area"]), np.zeros(4, dtype=bool)
    effect = sampled_effect(words, np.array([1.0, 3, 1, 3]), free)
    assert effect.levels.tolist() == ["area", "line"]
    assert effect.mean.tolist() == [3, 1]


def table_of(design: str, inputs: np.ndarray, numbers: np.ndarray) -> CaseTable:
    """A study whose torque_mean are these numbers; a nan is a failed case."""
    axes = tuple(Axis(name, ("mesh.friction",), "", None, "sampled") for name in "abc"[: inputs.shape[1]])
    cases = tuple(
        Case(f"{at:016x}", dict(zip("abc", map(float, values), strict=False)))
        for at, values in enumerate(inputs)
    )
    rows = [
        CaseRow(case.hash, Status.OK if np.isfinite(y) else Status.CRASHED, "", 1.0, 1.0, {"torque_mean": y})
        for case, y in zip(cases, numbers.tolist(), strict=True)
    ]
    study = dataclasses.replace(sampled([]), axes=axes, cases=cases, design=design)
    return CaseTable(Path("study"), study, rows, ())


def test_sobol_indices_of_ishigamis_function() -> None:
    """Ishigami & Homma (1990): a = 7, b = 0.1 give S1 = 0.314, 0.442, 0 and ST = 0.558, 0.442, 0.244."""
    sobol = pytest.importorskip("SALib.sample.sobol")
    problem = {"num_vars": 3, "names": list("abc"), "bounds": [[-np.pi, np.pi]] * 3}
    x = sobol.sample(problem, 2048, calc_second_order=False, seed=1)
    y = np.sin(x[:, 0]) + 7 * np.sin(x[:, 1]) ** 2 + 0.1 * x[:, 2] ** 4 * np.sin(x[:, 0])
    found = indices(table_of("saltelli", x, y), "torque_mean")
    first = [row["first order"].value for row in found.rows.values()]
    total = [row["total"].value for row in found.rows.values()]
    np.testing.assert_allclose(first, [0.3139, 0.4424, 0], atol=0.03)
    np.testing.assert_allclose(total, [0.5576, 0.4424, 0.2437], atol=0.03)


def test_elementary_effects_of_a_linear_function_are_its_slopes() -> None:
    morris = pytest.importorskip("SALib.sample.morris")
    problem = {"num_vars": 3, "names": list("abc"), "bounds": [[0, 1], [0, 2], [0, 1]]}
    x = morris.sample(problem, 10, seed=1)
    y = 2 * x[:, 0] - 3 * x[:, 1]
    y[5] = np.nan  # a failed case takes its trajectory with it
    found = indices(table_of("morris", x, y), "torque_mean")
    assert (found.groups, found.left_out) == (9, 1)
    assert found.rows["a"]["mean effect"].value == pytest.approx(2)
    assert found.rows["b"]["mean effect"].value == pytest.approx(-6)  # over the whole axis
    assert found.rows["b"]["mean absolute effect"].value == pytest.approx(6)
    assert found.rows["c"]["mean absolute effect"].value == pytest.approx(0, abs=1e-12)
    assert found.rows["a"]["spread of the effect"].value == pytest.approx(0, abs=1e-12)


def test_indices_need_their_design_and_enough_cases() -> None:
    pytest.importorskip("SALib")
    x = np.linspace(0.1, 0.2, 8).reshape(4, 2)
    with pytest.raises(InputError, match="design random; indices need the design morris or saltelli"):
        indices(table_of("random", x, x[:, 0]), "torque_mean")
    with pytest.raises(InputError, match="rack_gain is no number of this study; there are torque_mean"):
        indices(table_of("morris", x, x[:, 0]), "rack_gain")
    with pytest.raises(InputError, match="4 cases, which are not whole groups of 3"):
        indices(table_of("morris", x, x[:, 0]), "torque_mean")
    with pytest.raises(InputError, match="1 complete groups of 4 cases; indices need at least 2"):
        indices(table_of("saltelli", x, x[:, 0]), "torque_mean")
    assert len(GRID) == 2
