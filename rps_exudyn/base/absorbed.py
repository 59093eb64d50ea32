"""Kernels that only other kernels call: made ready to be absorbed by these, and no machine code of their own.

Numba optimises every function, compiles it to machine code and keeps that, also if each of its callers has a
copy of its own: a fourth of the time of a first run. It is told otherwise from within, which only versions
allow that this has been tried with; others compile everything.
"""

from typing import Any

import numba
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler

TRIED = numba.version_info.short <= (0, 68)  # from the lowest version that the package allows


class AbsorbedLibrary(JITCodeLibrary):
    """Code that callers link in; they optimise it with their own."""

    @property
    def codegen(self) -> Any:
        """What asks here for the place of a function's constants finds none: they lie in the callers."""
        return _NoMachineCode

    def get_pointer_to_function(self, name: str) -> int:
        """Return the address of no function."""
        self._ensure_finalized()
        return 0

    def serialize_using_object_code(self) -> Any:
        """Return what the cache keeps."""
        return self.serialize_using_bitcode()

    def _optimize_final_module(self) -> None:
        """Leave that to the callers."""

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()
        self._finalized = True


class _NoMachineCode:
    """Where compiled functions would be told of their constants."""

    @staticmethod
    def set_env(name: str, environment: Any) -> None:
        """Do nothing."""


class Absorbing(Compiler):
    """Numba's compiler with such a library."""

    def define_pipelines(self) -> Any:
        """Give the function its library, and return numba's steps."""
        name = self.state.func_id.func_qualname
        self.state.library = AbsorbedLibrary(self.state.targetctx.codegen(), name)
        return super().define_pipelines()


def tell_constants(compiled: Any) -> None:
    """Tell a compiled function of the constants of what it has absorbed, as numba does when it loads one."""
    for each in compiled._find_referenced_environments():
        compiled.library.codegen.set_env(each.env_name, each)
