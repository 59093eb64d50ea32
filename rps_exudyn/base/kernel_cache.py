"""The cache of compiled kernels: never stale, checked when read, and quick to load.

numba notices a change in a kernel's own file but not in the kernels of other files that it calls; a
stale cache then runs yesterday's physics. So the cache's folder carries a fingerprint of all sources that
kernels are made of: any change there gives a new, empty cache.

numba compiles what a kernel calls anew into it. Kernels that stand apart are compiled once: their callers
find them by their symbols, and are loaded after them.
"""

import hashlib
import os
import pickle
import sys
import tempfile
from collections.abc import Callable
from functools import cache
from io import BytesIO
from pathlib import Path
from typing import Any, NamedTuple

import llvmlite.binding as llvm
import numba
import numpy as np
from numba.core.caching import FunctionCache, IndexDataCacheFile
from numba.core.environment import Environment, _rebuild_env, lookup_environment
from numba.core.runtime.nrt import rtsys

from rps_exudyn.base.absorbed import TRIED, tell_constants
from rps_exudyn.base.interrupts import raise_wrapped

# What compiled code is made of: the kernels, and the constants and NamedTuples that they read
KERNEL_SOURCES = (
    "base/absorbed.py",
    "base/compiled.py",
    "base/kernel_cache.py",
    "base/linear.py",
    "base/quick_compiling.py",
    "solvers/gear_kernel.py",
    "solvers/flexible_kernel.py",
    "solvers/path_follower.py",
    "solvers/newton_tangent.py",
    "solvers/newton_follower.py",
    "solvers/newton_approach.py",
    "solvers/gear_numbers.py",
    "solvers/gear_loop.py",
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


def cache_folder() -> Path:
    """Return the folder of the compiled kernels of this version."""
    return Path(numba.config.CACHE_DIR)


class _Symbol(NamedTuple):
    """A compiled kernel that stands apart, as its callers know it."""

    name: str  # of its function in compiled code
    kernel: tuple[str, str]  # its module and its qualified name
    signature: Any


class _Entry(NamedTuple):
    """What a file of the cache holds."""

    needs: tuple[_Symbol, ...]  # to be loaded before
    defines: tuple[str, ...]  # names in its compiled code
    reduced: Any  # the code, as numba keeps it


_apart: dict[tuple[str, str], Any] = {}  # the dispatchers of kernels that stand apart, by their names
_symbols: dict[str, _Symbol] = {}  # what of them is compiled or loaded, by its name in compiled code


class _CheckedFile(IndexDataCacheFile):
    """numba's files with a checksum: what is damaged is reported once, compiled anew and replaced."""

    about: tuple[tuple[_Symbol, ...], tuple[str, ...]] = (), ()  # the next entry's needs, and what it defines

    def _load_index(self) -> Any:
        try:
            return super()._load_index()
        except Exception as error:  # whatever pickle makes of damaged bytes
            raise_wrapped(error)
            _report_damage()
            return {}

    def _save_data(self, name: str, data: Any) -> None:
        content = self._dump(_Entry(*self.about, data))
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


class KernelCache(FunctionCache):
    """numba's cache without a kernel's closure in its key, and with `_CheckedFile`.

    That key is new in every process when the closure holds other kernels. What it guards against, changed
    sources, the folder's fingerprint covers.
    """

    def __init__(self, function: Callable[..., Any]) -> None:
        self._function = function
        self._key = function.__module__, function.__qualname__

    def __getattr__(self, name: str) -> Any:
        """Look for the kernel's files when they are first asked for: most kernels of a run never are."""
        if name.startswith("__") or "_impl" in vars(self):
            raise AttributeError(name)
        super().__init__(self._function)
        stamp = self._impl.locator.get_source_stamp()
        self._cache_file = _CheckedFile(self._cache_path, self._impl.filename_base, stamp)
        return getattr(self, name)

    def stand_apart(self, dispatcher: Any) -> None:
        """Compile the kernel once, not again into each of its callers."""
        _apart[self._key] = dispatcher

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return what the cache holds for a signature, or None.

        numba makes ready all that it knows of array functions before; what is compiled already needs none of
        it.
        """
        rtsys.initialize(target_context)
        with self._guard_against_spurious_io_errors():
            if (compiled := self._load_overload(sig, target_context)) is not None:
                return compiled
        from rps_exudyn.base.quick_compiling import quicken

        quicken()
        return None

    def _load_overload(self, sig: Any, target_context: Any) -> Any:
        codegen = target_context.codegen()
        entry = self._cache_file.load(self._index_key(sig, codegen))
        if entry is None or not all(_is_there(need) for need in entry.needs):
            return None
        codegen._engine._defined_symbols |= set(entry.defines)
        compiled = self._impl.rebuild(target_context, entry.reduced)
        self._publish(sig, compiled)
        return compiled

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep what was compiled for a signature, and hide it from its callers if it stands apart."""
        if TRIED:
            tell_constants(data)
        module = data.library._final_module
        everything = [*module.functions, *module.global_variables]
        needs = tuple(
            _symbols[each.name] for each in everything if each.is_declaration and each.name in _symbols
        )
        if self._key in _apart:
            data.library._shared_module = _nothing_like(module)
        defines = tuple(each.name for each in everything if not each.is_declaration)
        self._cache_file.about = needs, defines
        self._publish(sig, data)
        super().save_overload(sig, data)

    def _publish(self, sig: Any, compiled: Any) -> None:
        """Let callers know a kernel that stands apart."""
        if self._key in _apart:
            name = compiled.fndesc.mangled_name
            _symbols[name] = _Symbol(name, self._key, sig)

    def _index_key(self, sig: Any, codegen: Any) -> Any:
        return sig, codegen.magic_tuple()


def _is_there(need: _Symbol) -> bool:
    """Load what a caller needs; false if that is not the code by which the caller was compiled."""
    dispatcher = _apart.get(need.kernel)
    if dispatcher is None:
        return False
    dispatcher.compile(need.signature)
    return need.name in _symbols


def _nothing_like(module: Any) -> Any:
    """An empty module for the same machine: what callers link in."""
    empty = llvm.parse_assembly("")
    empty.triple, empty.data_layout = module.triple, module.data_layout
    return empty
