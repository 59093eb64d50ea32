"""Kernels: functions of numbers and arrays that run as machine code.

    @inline              a function that kernels absorb
    @kernel              a function that kernels call
    @entry(VECTOR, ...)  a kernel that Python calls, with these types of arguments

Their code comes as LLVM code with the package (`kernel_code`); `kernel_compiler` makes it, and serves where
it does not fit. What kernels work on is given to them: no kernel takes memory but on its stack. A gear's
constants are NumPy records, which compiled code reads through a pointer; many gears are an array of records.
"""

import ctypes
from collections.abc import Callable
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np


class Array(NamedTuple):
    """The type of an argument: an array without gaps, which an entry gets by its address and its shape."""

    dtype: np.dtype
    ndim: int


class Law(NamedTuple):
    """The type of an argument that is another entry, of these arguments; it is given by its address."""

    arguments: tuple[Any, ...]


REAL = np.dtype(float)
VECTOR, MATRIX, CUBE, HYPERCUBE = (Array(REAL, n) for n in (1, 2, 3, 4))
NUMBERS = Array(np.dtype(np.int64), 1)
NUMBER, WHOLE = float, int  # a double, a 64-bit integer


class Function:
    """A function of kernels. Python calls `py_func`, which is what was written."""

    def __init__(self, py_func: Callable[..., Any], is_absorbed: bool) -> None:
        self.py_func, self.is_absorbed = py_func, is_absorbed
        self.__doc__ = py_func.__doc__

    @property
    def name(self) -> str:
        """Module and name."""
        return f"{self.py_func.__module__}.{self.py_func.__qualname__}"


class Entry(Function):
    """A kernel that Python calls: arrays are changed in place, and nothing is returned.

    Args of a call: as the decorator lists them.

    Raises of a call:
        TypeError: an argument of another type, or an array with gaps.
    """

    def __init__(self, py_func: Callable[..., None], arguments: tuple[Any, ...]) -> None:
        super().__init__(py_func, is_absorbed=False)
        self.arguments = arguments

    @cached_property
    def address(self) -> int:
        """Where its machine code stands."""
        from rps_exudyn.base import kernel_code

        return kernel_code.address_of(self)

    @cached_property
    def _code(self) -> Callable[..., None]:
        types = (one for each in self.arguments for one in _c_types(each))
        return ctypes.CFUNCTYPE(None, *types)(self.address)

    def __call__(self, *values: Any) -> None:
        """Call it."""
        self._code(*(one for pair in zip(self.arguments, values, strict=True) for one in _passed(*pair)))

    def bound(self, *values: Any) -> Callable[[], None]:
        """Return a call with these arguments, which takes a tenth of the time: arrays have what they hold at
        each call, and so have numbers that are `ctypes.c_double`."""
        types = (one for each in self.arguments for one in _c_types(each))
        given = (one for pair in zip(self.arguments, values, strict=True) for one in _passed(*pair))
        pairs = zip(types, given, strict=True)
        passed = [each if isinstance(each, ctypes.c_double) else make(each) for make, each in pairs]
        code = self._code

        def call(_held: Any = values) -> None:
            try:
                code(*passed)
            except (
                ctypes.ArgumentError
            ) as error:  # arguments that are made are never wrong: a signal came then
                raise KeyboardInterrupt from error

        return call


def _c_types(kind: Any) -> list[Any]:
    """The C types of an argument."""
    if isinstance(kind, Array):
        return [ctypes.c_void_p, *[ctypes.c_int64] * kind.ndim]
    if isinstance(kind, Law):
        return [ctypes.c_int64]
    return [ctypes.c_double if kind is NUMBER else ctypes.c_int64]


def _passed(kind: Any, value: Any) -> tuple[Any, ...]:
    """What stands for an argument."""
    if isinstance(kind, Array):
        if value.dtype != kind.dtype or value.ndim != kind.ndim or not value.flags.c_contiguous:
            raise TypeError(f"{value.dtype} {value.shape} is no {kind} without gaps")
        return value.ctypes.data, *value.shape
    return (value.address if isinstance(kind, Law) else value,)


def kernel(function: Callable[..., Any]) -> Function:
    """Return a function that kernels call; division by zero gives inf or nan, as in NumPy."""
    return Function(function, is_absorbed=False)


def inline(function: Callable[..., Any]) -> Function:
    """Return a function that kernels absorb: one whose call would cost more than its work."""
    return Function(function, is_absorbed=True)


def entry(*arguments: Any) -> Callable[[Callable[..., None]], Entry]:
    """Return a decorator for a kernel that Python calls with such arguments."""
    return lambda function: Entry(function, arguments)


# --- what kernels do with memory and addresses: `kernel_compiler` has the compiled form


class Primitive(Function):
    """A function of kernels that the compiler has itself."""


def primitive(function: Callable[..., Any]) -> Primitive:
    """Return such a function, whose Python does the same."""
    return Primitive(function, is_absorbed=True)


@primitive
def stacked(shape: Any, most: int = 0) -> np.ndarray:
    """Return an array on the stack, not filled, of constant shape or of at most so many numbers: it ends with
    the function that asks for it, which does not return it."""
    return np.empty(shape)


@primitive
def stacked_zeros(shape: Any, most: int = 0) -> np.ndarray:
    """The same filled with zeros."""
    return np.zeros(shape)


@primitive
def placed(room: np.ndarray, first: int, shape: Any) -> np.ndarray:
    """Return an array of this shape in a vector, from the place `first` on; the vector is an argument, which
    lives on."""
    return room[first : first + int(np.prod(shape))].reshape(shape)


@primitive
def placed_numbers(room: np.ndarray, first: int, size: int) -> np.ndarray:
    """Return a vector of whole numbers in one of real numbers, from the place `first` on."""
    return room[first : first + size].view(np.int64)


@primitive
def called(law: Any, *arguments: Any) -> None:
    """Call an entry that is an argument."""
    law(*arguments)


# --- records


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
