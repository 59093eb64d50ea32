"""Linear algebra of a few unknowns in compiled code."""

import numpy as np

from rps_exudyn.base.compiled import inline


@inline
def put(numbers, row):  # type: ignore[no-untyped-def]
    """Copy numbers into a row: for `row[:] = numbers` numba compiles the message of an error, which takes
    half a second."""
    for i in range(numbers.size):
        row[i] = numbers[i]


@inline
def solve(system, n):  # type: ignore[no-untyped-def]
    """Solve n equations in place: rows (n, n + 1) of matrix and right side; false if they are singular.

    Gauss elimination with partial pivoting; the solution is the last column.
    """
    for k in range(n):
        pivot = k
        for i in range(k + 1, n):
            if abs(system[i, k]) > abs(system[pivot, k]):
                pivot = i
        if not abs(system[pivot, k]) > 0:
            return False
        if pivot != k:
            for j in range(k, n + 1):
                system[k, j], system[pivot, j] = system[pivot, j], system[k, j]
        per_pivot = 1 / system[k, k]
        for i in range(k + 1, n):
            factor = system[i, k] * per_pivot
            if factor != 0:
                for j in range(k + 1, n + 1):
                    system[i, j] -= factor * system[k, j]
    for i in range(n - 1, -1, -1):
        for j in range(i + 1, n):
            system[i, n] -= system[i, j] * system[j, n]
        system[i, n] /= system[i, i]
        if not np.isfinite(system[i, n]):
            return False
    return True
