"""Compiled kernels: numba's `njit`, cached on disk, and never stale.

numba notices a change in a kernel's own file but not in the kernels of other files that it calls; a
stale cache then runs yesterday's physics. So the cache's folder carries a fingerprint of all sources that
kernels are made of: any change there gives a new, empty cache.
"""

import hashlib
import os
import pickle
import sys
import tempfile
from collections.abc import Callable
from functools import cache
from io import BytesIO
from operator import attrgetter
from pathlib import Path
from typing import Any

import numba
import numpy as np
from numba.core.caching import FunctionCache, IndexDataCacheFile
from numba.core.environment import Environment, _rebuild_env, lookup_environment
from numba.core.runtime.nrt import rtsys
from numba.experimental import structref

# What compiled code is made of: the kernels, and the constants and NamedTuples that they read
KERNEL_SOURCES = (
    "base/compiled.py",
    "base/linear.py",
    "solvers/gear_kernel.py",
    "solvers/flexible_kernel.py",
    "solvers/path_follower.py",
    "mesh_contact/*.py",
    "forces/*.py",
    "verification/seat_cells.py",
    "animation/raster.py",
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


class _CheckedFile(IndexDataCacheFile):
    """numba's files with a checksum: what is damaged is reported once, compiled anew and replaced."""

    def _load_index(self) -> Any:
        try:
            return super()._load_index()
        except Exception:  # whatever pickle makes of damaged bytes
            _report_damage()
            return {}

    def _save_data(self, name: str, data: Any) -> None:
        content = self._dump(data)
        with self._open_for_write(self._data_path(name)) as file:
            file.write(hashlib.sha256(content).digest() + content)

    def _load_data(self, name: str) -> Any:
        checksum, content = (data := Path(self._data_path(name)).read_bytes())[:32], data[32:]
        if hashlib.sha256(content).digest() != checksum:
            _report_damage()
            raise OSError("damaged")  # taken for a missing file
        return _Unpickler(BytesIO(content)).load()


class _Unpickler(pickle.Unpickler):
    """Reads compiled code without the modules of numba that it was made by: it runs without them."""

    def find_class(self, module: str, name: str) -> Any:
        if (module, name) == (_rebuild_env.__module__, _rebuild_env.__name__):
            return _environment
        return super().find_class(module, name)


def _environment(module: str, constants: list[Any], name: str) -> Environment:
    """The constants of a compiled function; of its module no more than what is loaded."""
    known = lookup_environment(name)
    if known is None:
        loaded = sys.modules.get(module)
        known = Environment({"__name__": module} if loaded is None else vars(loaded))
        known.consts[:] = constants
        known.env_name = name
        Environment._memo[name] = known
    return known


@cache
def _report_damage() -> None:
    print(
        f"rps-exudyn: the cache of compiled kernels in {numba.config.CACHE_DIR} is damaged; "
        "what is missing is compiled again.",
        file=sys.stderr,
    )


class _Cache(FunctionCache):
    """numba's cache without a kernel's closure in its key, and with `_CheckedFile`.

    That key is new in every process when the closure holds other kernels. What it guards against, changed
    sources, the folder's fingerprint covers.
    """

    def __init__(self, function: Callable[..., Any]) -> None:
        super().__init__(function)
        stamp = self._impl.locator.get_source_stamp()
        self._cache_file = _CheckedFile(self._cache_path, self._impl.filename_base, stamp)

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return what the cache holds for a signature, or None.

        numba makes ready all that it knows of array functions before; what is compiled already needs none of
        it.
        """
        rtsys.initialize(target_context)
        with self._guard_against_spurious_io_errors():
            return self._load_overload(sig, target_context)

    def _index_key(self, sig: Any, codegen: Any) -> Any:
        return sig, codegen.magic_tuple()


def _compiled(function: Callable[..., Any], **options: Any) -> Callable[..., Any]:
    dispatcher = numba.njit(function, error_model="numpy", **options)
    dispatcher._cache = _Cache(function)
    return dispatcher


def kernel(function: Callable[..., Any]) -> Callable[..., Any]:
    """Compile a function of floats and arrays; division by zero gives inf or nan, as in numpy."""
    return _compiled(function)


def inlined(function: Callable[..., Any]) -> Callable[..., Any]:
    """A kernel that its callers absorb: for functions whose call would cost more than their work.

    Multiply-adds are not fused: where a compiler fuses them depends on what it inlines, and the process that
    compiles would round otherwise than those that load its kernels.
    """
    return _compiled(function, forceinline=True)


def kernel_over(function: Callable[..., Any], *kernels: Callable[..., Any]) -> Callable[..., Any]:
    """Compile a function that closes over other kernels, for instance a loop over any force law.

    Its name becomes the function's and the kernels', by which the cache tells the copies apart.
    """
    name = "_".join([function.__name__, *(kernel.__name__ for kernel in kernels)])
    function.__name__ = function.__qualname__ = name
    return _compiled(function)


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
