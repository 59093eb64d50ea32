"""Compiled kernels: numba's `njit`, cached on disk, and never stale.

numba notices a change in a kernel's own file but not in the kernels of other files that it calls; a
stale cache then runs yesterday's physics. So the cache's folder carries a fingerprint of all sources that
kernels are made of: any change there gives a new, empty cache.
"""

import hashlib
import os
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba
import numpy as np
from numba.core.caching import FunctionCache
from numba.experimental import structref

# What compiled code is made of: the kernels, and the constants and NamedTuples that they read
KERNEL_SOURCES = (
    "base/compiled.py",
    "solvers/gear_kernel.py",
    "solvers/path_follower.py",
    "mesh_contact/*.py",
    "forces/*.py",
)


def fingerprint(package: Path) -> str:
    """Hash of everything in a package's folder that compiled kernels depend on, and of their compiler."""
    digest = hashlib.sha256(f"numba {numba.__version__}, numpy {np.__version__}".encode())
    for pattern in KERNEL_SOURCES:
        for source in sorted(package.glob(pattern)):
            digest.update(source.relative_to(package).as_posix().encode() + b"\0" + source.read_bytes())
    return digest.hexdigest()[:16]


def _cache_root() -> Path:
    chosen = (
        os.environ.get("NUMBA_CACHE_DIR") or os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
    )
    root = Path(chosen) / "rps_exudyn"
    try:
        root.mkdir(parents=True, exist_ok=True)
    except OSError:  # no home that can be written to, as in some containers
        root = Path(tempfile.gettempdir()) / "rps_exudyn"
    return root


numba.config.CACHE_DIR = str(_cache_root() / fingerprint(Path(__file__).parents[1]))


def kernel(function: Callable[..., Any]) -> Callable[..., Any]:
    """Compile a function of floats and arrays; division by zero gives inf or nan, as in numpy."""
    return numba.njit(function, cache=True, error_model="numpy")


def inlined(function: Callable[..., Any]) -> Callable[..., Any]:
    """A kernel that its callers absorb: for functions whose call would cost more than their work.

    Multiply-adds are not fused: where a compiler fuses them depends on what it inlines, and the process that
    compiles would round otherwise than those that load its kernels.
    """
    return numba.njit(function, cache=True, error_model="numpy", forceinline=True)


class _FingerprintedCache(FunctionCache):
    """numba's cache without the closure in its key: that key is new in every process when the closure holds
    other kernels. What it guards against, changed sources, the folder's fingerprint covers."""

    def _index_key(self, sig: Any, codegen: Any) -> Any:
        return sig, codegen.magic_tuple()


def kernel_over(function: Callable[..., Any], *kernels: Callable[..., Any]) -> Callable[..., Any]:
    """Compile a function that closes over other kernels, for instance a loop over any force law.

    Its name becomes the function's and the kernels', by which the cache tells the copies apart.
    """
    name = "_".join([function.__name__, *(kernel.__name__ for kernel in kernels)])
    function.__name__ = function.__qualname__ = name
    compiled = numba.njit(function, error_model="numpy")
    compiled._cache = _FingerprintedCache(function)
    return compiled


@structref.register
class _HandleType(numba.types.StructRef):
    """The compiled type of a `Handle`."""


class Handle(structref.StructRefProxy):
    """A tuple of constants that compiled functions read as `handle.data`.

    A nested NamedTuple is unpacked number by number in each call from Python, which takes as long as a third
    of the gear's forces; a handle is one pointer.
    """

    def __new__(cls, data: tuple[Any, ...]) -> "Handle":
        return _new_handle(data)


structref.define_boxing(_HandleType, Handle)
structref.define_constructor(Handle, _HandleType, ["data"])


@kernel
def _new_handle(data):  # type: ignore[no-untyped-def]
    return Handle(data)
