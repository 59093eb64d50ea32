"""The step of Newton's method that the compiled follower takes."""

import numpy as np

from rps_exudyn.base.kernel_compiler import from_python
from rps_exudyn.solvers.follower import factorized, newton_move


@from_python
def step(tangent, damping, forces, free, lengths, move):  # type: ignore[no-untyped-def]
    """Fill the step of the free coordinates; whether there is one, and its size."""
    n = free.size
    system, pivots = np.empty((n, n)), np.empty(n, np.int64)
    if not factorized(tangent, damping, free, lengths, system, pivots):
        return False, 0.0
    return True, newton_move(system, pivots, forces, free, lengths, move)


def test_step_is_that_of_lapack() -> None:
    """To the rounding of matrices whose condition is below 1e6; coordinates that are not free stay."""
    random = np.random.default_rng(3)
    for n in (1, 2, 7, 20):
        free, lengths = np.sort(random.permutation(n + 2)[:n]), 10.0 ** random.uniform(-2, 0, n + 2)
        tangent = random.normal(size=(n + 2, n + 2)) * 10.0 ** random.uniform(-2, 2, (n + 2, 1))
        forces, move = random.normal(size=n + 2), np.zeros(n)
        for damping in (0.0, 3.0):
            found, size = step(tangent, damping, forces, free, lengths, move)
            damped = tangent[np.ix_(free, free)] - damping * np.diag(lengths[free] ** 2)
            assert found
            np.testing.assert_allclose(move, -np.linalg.solve(damped, forces[free]), rtol=1e-8, atol=1e-10)
            assert size == np.abs(move * lengths[free]).max()


def test_rows_are_exchanged_where_a_pivot_is_zero() -> None:
    move = np.zeros(2)
    found, size = step(
        np.array([[0.0, 2.0], [4.0, 0.0]]), 0.0, np.array([2.0, 8.0]), np.arange(2), np.ones(2), move
    )
    assert (found, size) == (True, 2.0)
    assert move.tolist() == [-2.0, -1.0]


def test_a_singular_tangent_has_no_step() -> None:
    assert not step(np.ones((3, 3)), 0.0, np.ones(3), np.arange(3), np.ones(3), np.zeros(3))[0]


def test_what_is_not_finite_is_no_size_of_a_step() -> None:
    _, size = step(np.eye(2), 0.0, np.array([1.0, np.nan]), np.arange(2), np.ones(2), np.zeros(2))
    assert not np.isfinite(size)
