"""Compiled kernels: numba's `njit` with the cache of `kernel_cache`."""

from collections.abc import Callable
from operator import attrgetter
from typing import Any

import numba
from numba.core import cgutils
from numba.core.datamodel import default_manager
from numba.core.registry import CPUDispatcher
from numba.experimental import structref
from numba.extending import intrinsic

from rps_exudyn.base.absorbed import TRIED, Absorbing
from rps_exudyn.base.compiling import watch_numba
from rps_exudyn.base.kernel_cache import KernelCache

watch_numba()

_NOT_FROM_PYTHON = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
_ABSORBED = _NOT_FROM_PYTHON | ({"pipeline_class": Absorbing} if TRIED else {})


def _compiled(function: Callable[..., Any], **options: Any) -> Any:
    dispatcher = numba.njit(function, error_model="numpy", **options)
    dispatcher._cache = KernelCache(function)
    dispatcher.__class__ = _Kernel
    return dispatcher


class _Kernel(CPUDispatcher):
    """Compiles a function once for all numbers of a type: numba does so anew for each number in a call."""

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """Return what a call with arguments of such types returns, and see that it is compiled."""
        types = {name: numba.types.unliteral(each) for name, each in kws.items()}
        return super().get_call_template([numba.types.unliteral(each) for each in args], types)


def kernel(function: Callable[..., Any]) -> Callable[..., Any]:
    """Compile a function of floats and arrays; division by zero gives inf or nan, as in numpy."""
    return _compiled(function)


def apart(function: Callable[..., Any]) -> Callable[..., Any]:
    """A kernel that is not compiled again into each of its callers: for much code, which few calls run."""
    dispatcher = _compiled(function)
    dispatcher._cache.stand_apart(dispatcher)
    return dispatcher


def nested(function: Callable[..., Any]) -> Callable[..., Any]:
    """A kernel that only kernels call: what unpacks arguments from Python is not compiled.

    Called from Python it runs uncompiled.
    """
    dispatcher = _compiled(function, **_ABSORBED)
    dispatcher.__class__ = _WithinKernels
    return dispatcher


def inlined(function: Callable[..., Any]) -> Callable[..., Any]:
    """A kernel that its callers absorb: for functions whose call would cost more than their work.

    Multiply-adds are not fused: where a compiler fuses them depends on what it inlines, and the process that
    compiles would round otherwise than those that load its kernels. Called from Python it runs uncompiled:
    what unpacks its arguments would take longer to compile than the function.
    """
    dispatcher = _compiled(function, forceinline=True, **_ABSORBED)
    dispatcher.__class__ = _WithinKernels
    return dispatcher


def borrowing(function: Callable[..., Any]) -> Callable[..., Any]:
    """An inlined kernel that counts no references to the arrays in its arguments.

    A tuple of constants holds several arrays; to count them in and out of each small function took more than
    half of the time of the flanks' contact. It must neither make arrays, which does not compile, nor return
    any, which is refused, nor call what returns some, which would never be freed.
    """
    dispatcher = _compiled(function, forceinline=True, _nrt=False, **_ABSORBED)
    dispatcher.__class__ = _Borrowing
    return dispatcher


class _WithinKernels(_Kernel):
    """Knows compiled code that only compiled code can call."""

    def add_overload(self, cres: Any) -> None:
        """Keep what was compiled from calls by Python, which would go to nowhere."""
        self.overloads[tuple(cres.signature.args)] = cres

    def _compile_for_args(self, *arguments: Any) -> Any:
        return self.py_func  # what is called then


class _Borrowing(_WithinKernels):
    """Such code that counts no references."""

    def add_overload(self, cres: Any) -> None:
        """Keep it unless it returns an array: its caller would free what belongs to someone else.

        Raises:
            TypeError: it does.
        """
        if default_manager[cres.signature.return_type].contains_nrt_meminfo():
            raise TypeError(f"{self.__name__} is borrowing and returns an array: make it inlined.")
        super().add_overload(cres)


def kernel_over(function: Callable[..., Any], *kernels: Callable[..., Any]) -> Callable[..., Any]:
    """Compile a function that closes over other kernels, for instance a loop over any force law.

    Its name becomes the function's and the kernels', by which the cache tells the copies apart.
    """
    name = "_".join([function.__name__, *(kernel.__name__ for kernel in kernels)])
    function.__name__ = function.__qualname__ = name
    return apart(function)


@intrinsic
def unowned(typing: Any, value: Any) -> Any:
    """The same array, or tuple with arrays, to which no references are counted.

    Each function that a tuple goes through counts its arrays in and out, by instructions that lock the bus,
    a fifth of the time of a loop over many gears. Their owner must outlive what is returned: arrays are
    arguments of the function that calls this, or are used again after the last use of what is returned.
    """

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return _without_owner(context, builder, signature.args[0], arguments[0])

    return value(value), code


def _without_owner(context: Any, builder: Any, kind: Any, value: Any) -> Any:
    """Code for a value whose arrays know no owner."""
    if isinstance(kind, numba.types.Array):
        array = context.make_array(kind)(context, builder, value)
        array.meminfo = cgutils.get_null_value(array.meminfo.type)
        return array._getvalue()
    if isinstance(kind, numba.types.BaseTuple):
        items = [
            _without_owner(context, builder, each, builder.extract_value(value, i))
            for i, each in enumerate(kind)
        ]
        return context.make_tuple(builder, kind, items)
    return value


@structref.register
class _HandleType(numba.types.StructRef):
    """The compiled type of a `Handle`."""


class Handle(structref.StructRefProxy):
    """A tuple of constants that compiled functions read as `handle.data`.

    A nested NamedTuple is unpacked number by number in each call from Python, which takes as long as a third
    of the gear's forces; a handle is one pointer.
    """

    # The base class has a property in Python. Numba reads it in each call and takes whatever it raises for a
    # missing attribute: one Ctrl-C or alarm in a hundred got lost there. A getter in C cannot be interrupted.
    _numba_type_ = property(attrgetter("_type"))

    def __new__(cls, data: tuple[Any, ...]) -> "Handle":
        return _new_handle(data)


structref.define_boxing(_HandleType, Handle)
structref.define_constructor(Handle, _HandleType, ["data"])


@kernel
def _new_handle(data):  # type: ignore[no-untyped-def]
    return Handle(data)
