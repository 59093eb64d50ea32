"""Linear algebra of a few unknowns in compiled code, without the libraries that numba would load for it."""

import numpy as np

from rps_exudyn.base.compiled import inlined, kernel


@inlined
def put(numbers, row):  # type: ignore[no-untyped-def]
    """Copy numbers into a row.

    For `row[:] = numbers` numba compiles a sentence about shapes that differ, which takes it half a second.
    """
    for i in range(numbers.size):
        row[i] = numbers[i]


@kernel
def inverse(matrix):  # type: ignore[no-untyped-def]
    """Inverse of a square matrix by Gauss-Jordan elimination with partial pivoting.

    Raises:
        LinAlgError: the matrix is singular.
    """
    n = matrix.shape[0]
    left, right = matrix.copy(), np.zeros((n, n))
    for i in range(n):
        right[i, i] = 1.0
    for k in range(n):
        pivot = k
        for i in range(k + 1, n):
            if abs(left[i, k]) > abs(left[pivot, k]):
                pivot = i
        if left[pivot, k] == 0:
            raise np.linalg.LinAlgError("the matrix is singular")
        for j in range(n):
            left[k, j], left[pivot, j] = left[pivot, j], left[k, j]
            right[k, j], right[pivot, j] = right[pivot, j], right[k, j]
        scale = 1 / left[k, k]
        for j in range(n):
            left[k, j] *= scale
            right[k, j] *= scale
        for i in range(n):
            factor = left[i, k]
            if i != k and factor != 0:
                for j in range(n):
                    left[i, j] -= factor * left[k, j]
                    right[i, j] -= factor * right[k, j]
    return right
