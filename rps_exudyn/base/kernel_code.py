"""The machine code of kernels.

The package ships the LLVM code of its entries, as text, with a fingerprint of what they were made of.
llvmlite makes machine code of an entry where it is first called on a machine, and keeps it as an object file.
Where the shipped code does not fit the sources, the platform or llvmlite, numba makes it (`kernel_compiler`).

Object files of other sources are never read: they lie in a folder named by the hash of all kernel sources,
and each ends with its sha256. A folder that others can write to holds none.
"""

import ctypes
import hashlib
import lzma
import os
import stat
import tokenize
from collections.abc import Iterable
from contextlib import suppress
from functools import cache, partial
from inspect import getsource
from io import StringIO
from itertools import takewhile
from pathlib import Path
from shutil import rmtree
from threading import RLock
from types import ModuleType
from typing import Any

import numpy as np
from llvmlite import __version__, binding

from rps_exudyn.base.compiled import Array, Entry, Function, Law
from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import replacing
from rps_exudyn.base.progress import making

PACKAGE = Path(__file__).parents[1]
SHIPPED = PACKAGE / "kernels.ll.xz"
"""LLVM code of all entries, behind lines with its platform and with each entry's fingerprint."""
LLVM = (20, 1)
"""Version of the code, which later ones read: that of llvmlite 0.46."""
KERNEL_SOURCES = (
    "base/compiled.py",
    "base/kernel_c*.py",
    "forces/*.py",
    "gears/tooth_stiffness.py",
    "tooth_contact/*.py",
    "solvers/*.py",
    "pages/animation/depth_buffer.py",
)
"""Files that hold kernels, and the records and constants that they read."""
EXTERNALS = (
    *("acos", "asin", "atan", "atan2", "sin", "cos", "exp", "expm1", "log", "pow"),
    *("sqrt", "sincos", "floor", "ceil", "rint", "memset", "memcpy", "memmove"),
)
"""Functions of C's library that kernels may call."""
CACHE = "RPS_EXUDYN_CACHE"
"""Environment variable that names a folder for object files."""
MARK = 32  # bytes behind an object file's code
MARKED = "; of "

_one_at_a_time = RLock()


def address_of(entry: Entry) -> int:
    """Return the address of an entry's machine code: loaded, or made first."""
    with _one_at_a_time:
        if entry.name.startswith(f"{PACKAGE.name}."):
            return _loaded(_object_file(entry), entry.name)
        from rps_exudyn.base import kernel_compiler

        with making(f"Compiling the force law {entry.py_func.__name__}, which no release contains"):
            return kernel_compiler.address_of(entry)


def _object_file(entry: Entry) -> bytes:
    """Return the machine code of an entry as an object file: kept, or made and kept."""
    folder = object_folder()
    file = folder / f"{entry.name}-{_processor()}.o" if folder else None
    with suppress(OSError):  # it is not there, or cannot be read
        content = file.read_bytes() if file else b""
        if hashlib.sha256(content[:-MARK]).digest() == content[-MARK:]:
            return content[:-MARK]
    reason = reason_not_usable(entry)
    if reason:
        from rps_exudyn.base import kernel_compiler

        with making(f"Compiling force laws, once, which takes about a minute: {reason}"):
            code = _machine_code(kernel_compiler.llvm_code([entry]), entry.name)
    else:
        with making("Preparing force laws for this machine, once"):
            code = _machine_code(_shipped(), entry.name)
    if file:
        with suppress(OSError, InputError):  # a full disk: another process makes it again
            file.parent.mkdir(parents=True, exist_ok=True)
            with replacing(file) as unfinished:
                unfinished.write_bytes(code + hashlib.sha256(code).digest())
    return code


# --- LLVM's part


@cache
def _machine() -> Any:
    """The processor of this machine, for LLVM."""
    binding.initialize_native_target()
    binding.initialize_native_asmprinter()
    library = ctypes.CDLL("ucrtbase" if os.name == "nt" else None)
    for name in filter(partial(hasattr, library), EXTERNALS):
        binding.add_symbol(name, ctypes.cast(getattr(library, name), ctypes.c_void_p).value)
    cpu, features = binding.get_host_cpu_name(), binding.get_host_cpu_features().flatten()
    target = binding.Target.from_default_triple()
    # as numba asks for it: code for addresses anywhere, which a later process loads
    return target.create_target_machine(
        cpu=cpu, features=features, opt=3, reloc="default", codemodel="jitdefault"
    )


@cache
def _processor() -> str:
    """What names processor and compiler in the name of an object file."""
    about = binding.get_host_cpu_name(), binding.get_host_cpu_features().flatten(), __version__
    return hashlib.sha256(" ".join(about).encode()).hexdigest()[:16]


def _machine_code(text: str, name: str) -> bytes:
    """Make an object file of an entry, and of what it calls, from LLVM code with others."""
    machine, module = _machine(), binding.parse_assembly(text)
    module.verify()
    for each in module.functions:
        if not each.is_declaration and each.name != name:
            each.linkage = "internal"
    passes = binding.create_new_module_pass_manager()
    passes.add_global_dead_code_eliminate_pass()
    passes.run(module, binding.create_pass_builder(machine, binding.create_pipeline_tuning_options()))
    return bytes(machine.emit_object(module))


@cache
def _engine() -> Any:
    """What holds all machine code: one, for it takes over the machine that it is made with."""
    return binding.create_mcjit_compiler(binding.parse_assembly(""), _machine())


def _loaded(code: bytes, name: str) -> int:
    """Load an object file; return the address of its entry."""
    engine = _engine()
    engine.add_object_file(binding.ObjectFileRef.from_data(code))
    engine.finalize_object()
    return int(engine.get_function_address(name))


# --- The shipped code


@cache
def _shipped() -> str:
    with lzma.open(SHIPPED, "rt", encoding="ascii") as file:
        return file.read()


def marks() -> dict[str, str]:
    """Return the fingerprints of the shipped entries, and their platform by the name "platform"."""
    lines = takewhile(lambda line: line.startswith(MARKED), _shipped().splitlines())
    return dict(line.removeprefix(MARKED).split() for line in lines)


def reason_not_usable(entry: Entry) -> str:
    """Return why the shipped code of an entry does not serve here; "" if it does."""
    try:
        shipped = marks()
    except (OSError, EOFError, ValueError, lzma.LZMAError):
        return f"{SHIPPED} is damaged or missing"
    here = platform_of(binding.get_default_triple())
    if shipped.get("platform") != here:
        return f"the package contains them for {shipped.get('platform', 'no platform')}, and this is {here}"
    if binding.llvm_version_info[:2] < LLVM:
        return "llvmlite is older than 0.46"
    if shipped.get(entry.name) != fingerprint(entry):
        return "the package contains them of other sources"
    return ""


def platform_of(triple: str) -> str:
    """Return processor and system of an LLVM triple."""
    system = next((each for each in ("linux", "darwin", "windows") if each in triple), triple)
    return f"{triple.partition('-')[0]}-{system}"


def write(code: str, entries: Iterable[Entry]) -> None:
    """Write the LLVM code of entries as the package ships it."""
    head = {"platform": platform_of(binding.get_default_triple())}
    head |= {entry.name: fingerprint(entry) for entry in entries}
    text = "".join(f"{MARKED}{name} {mark}\n" for name, mark in head.items()) + code
    SHIPPED.write_bytes(lzma.compress(text.encode("ascii"), preset=9 | lzma.PRESET_EXTREME))


# --- What kernels are made of


def fingerprint(entry: Entry) -> str:
    """Return the hash of what an entry and all functions that it calls are written like, comments and
    docstrings apart, and of the values of the names in them."""
    ahead: list[Function] = [entry]
    told: dict[str, str] = {}
    while ahead:
        function = ahead.pop()
        if function.name in told:
            continue
        code = function.py_func.__code__
        values = {name: function.py_func.__globals__.get(name) for name in sorted(set(code.co_names))}
        values = {name: value for name, value in values.items() if value is not None}
        about = [f"{name} {_described(value)}" for name, value in values.items()]
        arguments = _described(getattr(function, "arguments", ()))
        told[function.name] = "\n".join([_written(function), arguments, *about])
        ahead += [value for value in values.values() if isinstance(value, Function)]
    return hashlib.sha256("\n".join(told[name] for name in sorted(told)).encode()).hexdigest()


@cache
def _written(function: Function) -> str:
    """The words of a function without comments and docstring."""
    tokens = list(tokenize.generate_tokens(StringIO(getsource(function.py_func)).readline))
    left_out = (tokenize.COMMENT, tokenize.NL, tokenize.INDENT, tokenize.DEDENT)
    kept = [token for token in tokens if token.type not in left_out]
    words, begins = [], True
    for token in kept:
        if not (begins and token.type == tokenize.STRING):
            words.append(token.string.strip())
        begins = token.type == tokenize.NEWLINE
    return " ".join(words)


def _described(value: Any) -> str:
    """What a name in a kernel stands for, the same on all machines: numbers to 12 digits."""
    if isinstance(value, Function):
        return value.name
    if isinstance(value, ModuleType):
        return value.__name__
    if isinstance(value, np.ndarray):
        return f"{value.dtype} {value.shape} {[_described(each) for each in value.ravel().tolist()]}"
    if isinstance(value, Array | Law):
        return f"{type(value).__name__} {value[0]} {value[1:]}"
    if isinstance(value, tuple | list):
        return f"({', '.join(map(_described, value))})"
    if isinstance(value, float):
        return f"{value:.12g}"
    if isinstance(value, type):
        return f"{value.__name__} {getattr(value, '_fields', '')}"
    return repr(value) if isinstance(value, int | str) else type(value).__name__


# --- Where object files are kept


def object_folder() -> Path | None:
    """Return the folder of this package's object files; None where nobody but others could write there."""
    return _trusted_folder(os.environ.get(CACHE, ""))


@cache
def _trusted_folder(named: str) -> Path | None:
    place, sources = hashlib.sha256(str(PACKAGE).encode()).hexdigest()[:16], _source_hash()
    users = os.environ.get("LOCALAPPDATA") or os.environ.get("XDG_CACHE_HOME") or "~/.cache"
    roots = [Path(named, place)] if named else [PACKAGE / "__pycache__", Path(users, PACKAGE.name, place)]
    for root in (Path(os.path.expanduser(each)) for each in roots):
        folder = root / f"kernels-{sources}"
        with suppress(OSError):
            folder.mkdir(parents=True, exist_ok=True)
            if _is_own(folder) and os.access(folder, os.W_OK):
                for other in root.glob("kernels-*"):
                    if other != folder:  # of other sources
                        rmtree(other, ignore_errors=True)
                return folder
    return None


def _source_hash() -> str:
    digest = hashlib.sha256()
    for pattern in KERNEL_SOURCES:
        for source in sorted(PACKAGE.glob(pattern)):
            digest.update(source.relative_to(PACKAGE).as_posix().encode() + b"\0" + source.read_bytes())
    return digest.hexdigest()[:16]


def _is_own(folder: Path) -> bool:
    """Return whether nobody else can write to a folder but the superuser; true where owners are unknown."""
    if not hasattr(os, "geteuid"):
        return True
    about = folder.stat()
    return about.st_uid in (os.geteuid(), 0) and not about.st_mode & stat.S_IWOTH


def object_files() -> list[Path]:
    """Return the object files that are kept."""
    folder = object_folder()
    return sorted(folder.glob("*.o")) if folder else []
