"""Tolerances: the cheapest set is that of brute force over all sets, from gears that were run once."""

from itertools import product
from pathlib import Path

import numpy as np
import pytest

import rps_exudyn as rps
from rps_exudyn.optimisation.tolerance_search import Tolerancing
from rps_exudyn.parameters.distribution import Distribution
from rps_exudyn.solvers.closed_form import mean_state

RIGHT = """
fidelity = "closed-form"
errors = "none"
samples = 1024
confirm = [2048, 0]
seed = 2
[tolerances.yoke.preload]
coarse = ["300 N +- 60 N", 0]
medium = ["300 N +- 30 N", 1]
fine = ["300 N +- 15 N", 3]
[tolerances.bush.drag]
coarse = ["uniform(0 N, 40 N)", 0]
fine = ["uniform(15 N, 25 N)", 1.5]
[constraints.torque_mean]
most = "0.72 N*m"
"""
PRELOADS, DRAGS = (60.0, 30.0, 15.0), ((0.0, 40.0), (15.0, 25.0))
COSTS = {(i, j): (0, 1, 3)[i] + (0, 1.5)[j] for i, j in product(range(3), range(2))}


def found_in(folder: Path, text: str = RIGHT) -> Tolerancing:
    (folder / "costs.toml").write_text(text)
    return rps.tolerances(folder / "costs.toml", folder / "out", jobs=1)


@pytest.fixture(scope="module")
def solved(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Tolerancing]:
    """Folder and answer of the file above."""
    folder = tmp_path_factory.mktemp("solved")
    return folder, found_in(folder)


def torque(preload: float, drag: float) -> float:
    """Return the mean free torque by the closed form [N m]."""
    gear = rps.SteeringGear().replace({"yoke.preload": preload, "bush.drag": drag})
    return float(mean_state(gear, gear.test.direction, 0.0).torque)


def scraps(most: float) -> dict[tuple[int, int], float]:
    """Return the share above a torque of each set: the closed form is linear, so that it is an integral."""
    base, u = torque(300.0, 20.0), (np.arange(1000) + 0.5) / 1000
    per_preload, per_drag = (torque(400.0, 20.0) - base) / 100, (torque(300.0, 40.0) - base) / 20
    found = {}
    for i, j in COSTS:
        preload = Distribution("normal", 300.0, PRELOADS[i]).quantile(u) - 300.0
        drag = Distribution("uniform", *DRAGS[j]).quantile(u) - 20.0
        sums = base + per_preload * preload[:, None] + per_drag * drag
        found[i, j] = float((sums > most).mean())
    return found


def test_cheapest_set_by_brute_force(solved: tuple[Path, Tolerancing]) -> None:
    """Shares of all sets are within four standard errors of the integral, and the set is the same."""
    found, exact = solved[1], scraps(0.72)
    problem = found.problem
    assert list(problem.classes) == ["yoke.preload", "bush.drag"]
    for own, scrap, error in zip(problem.sets.tolist(), found.scrap, found.errors, strict=True):
        assert abs(scrap - exact[tuple(own)]) < 4 * error + 2 / found.gears
    keeping = [own for own, scrap in exact.items() if scrap <= 0.05]
    best = min(keeping, key=lambda own: COSTS[own])
    assert 1 < len(keeping) < len(exact)
    assert tuple(problem.sets[found.chosen]) == best
    fresh = found.fresh["the search's model"]
    assert abs(fresh.value - exact[best]) < 4 * fresh.error
    for step in found.steps:
        own = {path: [each.name for each in classes] for path, classes in problem.classes.items()}
        there = dict(found.classes) | {step.path: step.after}
        other = tuple(own[path].index(name) for path, name in there.items())
        assert step.cost == COSTS[other] - COSTS[best]
        assert abs(step.scrap.value - exact[other] + exact[best]) < 4 * step.scrap.error + 2 / found.gears


def test_gears_of_the_folder_are_not_run_again(solved: tuple[Path, Tolerancing]) -> None:
    """One lost case is computed again, and the end is the same to the bit."""
    folder, whole = solved
    files = sorted((folder / "out" / "cases").glob("*.h5"))
    files[0].unlink()
    kept = {path: path.stat().st_mtime_ns for path in files[1:]}
    again = found_in(folder)
    np.testing.assert_array_equal(again.scrap, whole.scrap)
    assert {path: path.stat().st_mtime_ns for path in files[1:]} == kept
    assert again.fresh == whole.fresh


def test_limit_with_a_share_of_its_own(tmp_path: Path) -> None:
    """The cheapest set is that whose integral keeps the larger share, not only that of all limits."""
    found = found_in(tmp_path, RIGHT + 'share = "99.5 %"\n')
    keeping = [own for own, scrap in scraps(0.72).items() if scrap <= 0.005]
    loose = [own for own, scrap in scraps(0.72).items() if scrap <= 0.05]
    best = min(keeping, key=lambda own: COSTS[own])
    assert COSTS[best] > min(COSTS[own] for own in loose)
    assert tuple(found.problem.sets[found.chosen]) == best
    assert not found.not_kept


def test_numerical_error_of_a_share_is_that_of_the_moved_limit(solved: tuple[Path, Tolerancing]) -> None:
    """The closed form's bar is a part of its torque: gears wrong by it are those of a limit so much lower."""
    fresh = (found := solved[1]).fresh["the search's model"]
    run = rps.run("free-pinion-torque", fidelity="closed-form")
    part = run.errors["torque_mean"] / run.summary["torque_mean"]
    best = tuple(found.problem.sets[found.chosen].tolist())
    moved = scraps(0.72 / (1 + part))[best] - scraps(0.72)[best]
    assert moved > 3 * fresh.error
    assert fresh.numerical == pytest.approx(moved, abs=4 * fresh.error)


def test_weights_in_blocks_are_those_at_once(
    solved: tuple[Path, Tolerancing], monkeypatch: pytest.MonkeyPatch
) -> None:
    folder, whole = solved
    monkeypatch.setattr("rps_exudyn.optimisation.tolerance_search.WEIGHTS_AT_ONCE", 1)
    again = found_in(folder)
    np.testing.assert_allclose(again.scrap, whole.scrap, rtol=1e-12)
    np.testing.assert_allclose(again.errors, whole.errors, rtol=1e-12)


def test_no_set_keeps_the_share(tmp_path: Path) -> None:
    """The nearest set has the least scrap, and the limit that forbids it is named."""
    found = found_in(tmp_path, RIGHT.replace("0.72 N*m", "0.62 N*m"))
    exact = scraps(0.62)
    assert not found.keeps
    assert exact[tuple(found.problem.sets[found.chosen].tolist())] < min(exact.values()) + 0.05
    assert found.misses[0] > 0.05


@pytest.mark.parametrize("text", ["2 +- 0.3", "uniform(1, 3)", "loguniform(1, 3)", "lognormal(2, 1.3)"])
def test_density_is_the_slope_of_the_quantile(text: str) -> None:
    """f(x(u)) dx/du = 1, by central differences; 0 beyond the ends."""
    each, u = Distribution.read(text, ""), np.linspace(0.01, 0.99, 99)
    slope = (each.quantile(u + 1e-6) - each.quantile(u - 1e-6)) / 2e-6
    np.testing.assert_allclose(each.density(each.quantile(u)) * slope, 1.0, rtol=1e-6)
    low, high = each.ends
    assert not each.density(np.array([low - 0.01, high + 0.01])).any()


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('30 N", 1]', '30 N", 0]', "of two classes the wider one must cost less"),
        ("tolerances.bush.drag", "tolerances.bush.drog", "bush.drog is no parameter"),
        ('["uniform(0 N, 40 N)", 0]', '["uniform(-3 N, 40 N)", 0]', "bush.drag reaches -3 N"),
        ('["uniform(0 N, 40 N)", 0]', '"20 N"', "it must be .scatter, cost."),
        ('["uniform(0 N, 40 N)", 0]', '["wide", 0]', "a distribution is written"),
        ('errors = "none"', 'errors = "none"\nshare = "120 %"', "share is '120 %'; it must be more"),
        ("[constraints", "[constraints.rated_flank]\nmost = 1\n[constraints", "follows from the drawing"),
        ('0.72 N*m"', '0.72 N*m"\nshare = "90 %"', "share must be more than that of all limits, 95 %"),
        ("[constraints.torque_mean]\nmost = \"0.72 N*m\"", "", "constraints must have at least one table"),
        ("seed = 2", "seed = 2\ndesigns = 4", "designs is no key of a file of tolerances"),
    ],
)  # fmt: skip
def test_mistake_is_one_sentence(tmp_path: Path, old: str, new: str, said: str) -> None:
    assert old in RIGHT
    with pytest.raises(rps.InputError, match=said):
        found_in(tmp_path, RIGHT.replace(old, new, 1))


def test_correlated_input_has_no_tolerance(tmp_path: Path) -> None:
    """In a series the frictions of teeth and plunger vary together."""
    text = RIGHT.replace('"none"', '"series"') + '[tolerances.mesh.friction]\none = ["0.1 +- 0.01", 1]\n'
    with pytest.raises(rps.InputError, match=r"mesh.friction is correlated with another input; a tolerance"):
        found_in(tmp_path, text)
