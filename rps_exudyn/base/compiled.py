"""Compiled functions: numba's `njit` with its own cache.

A gear's constants are NumPy records (`numba.from_dtype`), which compiled code reads through a pointer: they
cost no counting of references, and many gears are an array of records.
"""

from collections.abc import Callable
from functools import cache
from threading import RLock
from typing import Any

import numpy as np
from numba import types

from rps_exudyn.base import kernel_cache
from rps_exudyn.base.compiling import compiling

# Types of arguments: arrays without gaps, and numbers
VECTOR, MATRIX, CUBE = types.float64[::1], types.float64[:, ::1], types.float64[:, :, ::1]
HYPERCUBE, NUMBERS = types.float64[:, :, :, ::1], types.int64[::1]
NUMBER, WHOLE = types.float64, types.int64

_NOT_FROM_PYTHON = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
_signatures: dict[Any, Any] = {}
_one_at_a_time = RLock()  # numba's own lock does not hold until `disable_compile`


def kernel(function: Callable[..., Any]) -> Any:
    """Compile a function of numbers, arrays and records; division by zero gives inf or nan, as in NumPy."""
    return kernel_cache.compiled(function, error_model="numpy")


def inline(function: Callable[..., Any]) -> Any:
    """Compile a function that its callers absorb: for those whose call would cost more than their work.

    Python calls `function.py_func`.
    """
    return kernel_cache.compiled(function, error_model="numpy", forceinline=True, **_NOT_FROM_PYTHON)


def kernel_of(*arguments: Any, result: Any = types.none) -> Callable[[Callable[..., Any]], Any]:
    """Return a decorator for a kernel of these types of arguments alone.

    `ready` compiles it, or loads it; such a kernel can be handed to another one as an argument of the type
    `pointer(...)`.
    """

    def decorate(function: Callable[..., Any]) -> Any:
        made = kernel(function)
        _signatures[made] = result(*arguments)
        return made

    return decorate


def pointer(*arguments: Any, result: Any = types.none) -> Any:
    """Return the type of an argument that is a kernel of these types."""
    return types.FunctionType(result(*arguments))


@cache
def ready(made: Any) -> Any:
    """Return a kernel of `kernel_of`, compiled or loaded for its types."""
    with _one_at_a_time:
        if not made.signatures:
            with compiling(made):
                made.compile(_signatures[made])
            made.disable_compile()  # other types of arguments are an error, not another compilation
            if made.stats.cache_misses:
                kernel_cache.stamp()
    return made


def called(made: Any, *arguments: Any) -> Any:
    """Return what a kernel returns; a kernel of any types of arguments is compiled, or loaded, when they
    first come."""
    if made.signatures:
        return made(*arguments)
    with _one_at_a_time, compiling(made):
        returned = made(*arguments)
    if made.stats.cache_misses:  # at once: a process that is killed stamps nothing at its end
        kernel_cache.stamp()
    return returned


def record_type(fields: list[tuple[Any, ...]]) -> np.dtype:
    """Return the type of a record from its fields, laid out for compiled code."""
    return np.dtype(fields, align=True)


def record(dtype: np.dtype, **values: Any) -> np.record:
    """Return a record with a value for each of its fields, which are its attributes.

    Raises:
        TypeError: a field without a value, or a value without a field.
    """
    assert dtype.names is not None
    if set(values) != set(dtype.names):
        raise TypeError(f"fields {sorted(set(values) ^ set(dtype.names))} do not match the record's")
    return changed(np.zeros(1, dtype)[0], **values)


def changed(of: np.void, **values: Any) -> np.record:
    """Return a copy of a record with other values of some fields."""
    made = np.array([of], dtype=of.dtype)
    for name, value in values.items():
        made[name] = value
    first: np.record = made.view(np.recarray)[0]
    return first
