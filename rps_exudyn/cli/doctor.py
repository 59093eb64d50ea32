"""The command `doctor`: whether this installation computes what it should, and where it keeps what."""

import json
import os
from collections.abc import Iterator, Sequence
from importlib import import_module
from pathlib import Path
from time import perf_counter, process_time

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import check_writable
from rps_exudyn.base.screen import shown_progress
from rps_exudyn.cli.options import Flag
from rps_exudyn.cli.output import DONE, FAILED

PUBLISHED = 0.6199
"""Mean free pinion torque of the default gear by `quasi-static` [N m], as the README states it."""
AGREES = 1e-4  # half a unit of the last digit stated


def doctor(*, clear_cache: Flag = False) -> int:
    """Check the installation with a reference run, and list versions, cache and folders.

    Args:
        clear_cache: Remove the compiled force laws first; the next run compiles them again.
    """
    from rps_exudyn.base.kernel_cache import cache_folders

    import_module("rps_exudyn.solvers.gear_forces")  # all modules with kernels of a run
    folders = cache_folders()
    if clear_cache:
        _clear(folders)
    well = True
    for name, text, fine in (*_machine(), *_places(folders), _reference()):
        print(f"{'ok ' if fine else 'NO '} {name:<18} {text}")
        well &= fine
    return DONE if well else FAILED


def _machine() -> Iterator[tuple[str, str, bool]]:
    import numba

    from rps_exudyn.results import provenance

    yield "rps-exudyn", f"{provenance.package_version()} {provenance.git_hash()}".strip(), True
    libraries = json.loads(provenance.library_versions())
    yield "libraries", ", ".join(f"{name} {number}" for name, number in libraries.items()), True
    usable = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    yield "machine", provenance.machine(), True
    of_numba = f"(numba {numba.config.NUMBA_NUM_THREADS})"
    yield "threads", f"{usable} usable; a run uses one, a study one per process {of_numba}", True
    display = os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY") or os.name == "nt"
    views = "there is one: rps-exudyn view works" if display else "none: animate instead of view"
    yield "display", views, True


def _places(folders: Sequence[Path]) -> Iterator[tuple[str, str, bool]]:
    from rps_exudyn.base.kernel_cache import files_of

    size = sum(file.stat().st_size for folder in folders for file in files_of(folder)) / 1e6
    if folders:
        held = f"{os.path.commonpath(folders)}, {size:.0f} MB"
        yield "compiled kernels", f"{held}; rps-exudyn doctor --clear-cache removes them", True
    else:
        where = "NUMBA_CACHE_DIR names a folder for them"
        yield "compiled kernels", f"not stored: their folder cannot be written; {where}", False
    places = [*(("cache is writable", each) for each in folders[:1]), ("folder is writable", Path.cwd())]
    for name, folder in places:
        try:
            check_writable(folder / "rps-exudyn-doctor.tmp")
        except InputError as error:
            yield name, " ".join(error.problems), False
        else:
            yield name, str(folder), True


def _reference() -> tuple[str, str, bool]:
    """The default gear's torque, against the published one."""
    from rps_exudyn.results.outcome import Status
    from rps_exudyn.scenes.free_pinion_torque import SCENE
    from rps_exudyn.simulate.run import run

    began, cpu = perf_counter(), process_time()
    with shown_progress():
        result = run(SCENE.name, fidelity="quasi-static")
    took = (
        f"{perf_counter() - began:.2g} s, {process_time() - cpu:.2g} s of CPU time with loading or compiling"
    )
    if result.status is not Status.OK:
        return "reference run", f"{result.status}: {result.message}", False
    torque = result.summary["torque_mean"]
    fine = abs(torque / PUBLISHED - 1) < AGREES
    return "reference run", f"{torque:.5f} N m, published {PUBLISHED} N m; {took}", fine


def _clear(folders: Sequence[Path]) -> None:
    from rps_exudyn.base.kernel_cache import clear

    try:
        count = sum(clear(folder) for folder in folders)
    except OSError as error:
        raise InputError(f"{error.filename} cannot be removed: {error.strerror or error}.") from None
    print(f"removed: {count} files of compiled kernels")
