"""Numba's compiler without work whose result nobody reads; loaded when something has to be compiled.

What it makes is the same to the bit. Left out are

- messages of failed attempts to find a function for some types, in colours of the terminal;
- the time for which LLVM's lock is held, told to listeners twice for every call of LLVM;
- passes of optimisation over functions that are only declared;
- numpy's function for some types of numbers, sought anew at each operation.
"""

from functools import lru_cache
from inspect import signature
from typing import Any

from llvmlite.binding import ffi
from numba.core import codegen, errors
from numba.np import numpy_support

from rps_exudyn.base.absorbed import TRIED


@lru_cache(maxsize=1)
def quicken() -> None:
    """Leave all that out from now on, with versions of numba that this has been tried with."""
    if not TRIED:
        return
    from numba.core.typing import npydecl

    if scheme := getattr(errors, "HighlightColorScheme", None):  # where colours are known at all
        scheme._markup = _plain
    ffi.lib._lock._cblist.clear()
    if len(signature(codegen.CPUCodegen._function_pass_manager).parameters) == 2:  # since numba 0.62
        codegen.CodeLibrary._optimize_functions = _optimize_functions
    npydecl.ufunc_find_matching_loop = _matching_loop


def _plain(scheme: Any, message: str, *_: Any, **__: Any) -> str:
    """Return the message without colours."""
    return message


def _optimize_functions(library: Any, module: Any) -> None:
    """Numba's method, for functions that have a body."""
    module.data_layout = library._codegen._data_layout
    for function in module.functions:
        if not function.is_declaration:
            manager, builder = library._codegen._function_pass_manager()
            manager.run(function, builder)


def _matching_loop(ufunc: Any, types: Any) -> Any:
    return _kept_loop(ufunc, tuple(types))


_kept_loop = lru_cache(maxsize=None)(numpy_support.ufunc_find_matching_loop)
