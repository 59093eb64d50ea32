"""The inverse that compiled followers take."""

import numpy as np
import pytest

from rps_exudyn.base.linear import inverse


def test_inverse_is_that_of_lapack() -> None:
    """To the rounding of matrices whose condition is below 1e6."""
    random = np.random.default_rng(3)
    for n in (1, 2, 7):
        matrix = random.normal(size=(n, n)) * 10.0 ** random.uniform(-2, 2, (n, 1))
        np.testing.assert_allclose(inverse(matrix), np.linalg.inv(matrix), rtol=1e-9, atol=1e-12)


def test_rows_are_exchanged_where_a_pivot_is_zero() -> None:
    swap = np.array([[0.0, 2.0], [4.0, 0.0]])
    assert (inverse(swap) == np.array([[0.0, 0.25], [0.5, 0.0]])).all()


def test_singular_matrix_is_refused() -> None:
    with pytest.raises(np.linalg.LinAlgError, match="singular"):
        inverse(np.ones((3, 3)))
