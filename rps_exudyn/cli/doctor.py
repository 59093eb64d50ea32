"""The command `doctor`: whether this installation computes what it should, and by which code."""

import json
import os
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from time import process_time

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import check_writable
from rps_exudyn.base.screen import shown_progress
from rps_exudyn.cli.options import Flag
from rps_exudyn.cli.output import DONE, FAILED
from rps_exudyn.results.outcome import Status

PUBLISHED = 0.6199
"""Mean free pinion torque of the default gear by `quasi-static` [N m], as the README states it."""
AGREES = 1e-4  # half a unit of the last digit stated


def doctor(*, clear_cache: Flag = False) -> int:
    """Check the installation with a reference run, and list versions, cache and folders.

    Args:
        clear_cache: Remove the machine code of force laws first; the next run makes it again.
    """
    began = process_time()
    import_module("rps_exudyn.solvers.gear_forces")  # what a run needs
    loaded = process_time() - began
    if clear_cache:
        from rps_exudyn.base.kernel_code import object_files

        files = object_files()
        try:
            for file in files:
                file.unlink()
        except OSError as error:
            raise InputError(f"{error.filename} cannot be removed: {error.strerror or error}.") from None
        print(f"removed: {len(files)} files of machine code")
    well = True
    for name, text, fine in (*_machine(), *_code(), _reference(loaded)):
        print(f"{'ok ' if fine else 'NO '} {name:<18} {text}")
        well &= fine
    return DONE if well else FAILED


def _machine() -> Iterator[tuple[str, str, bool]]:
    from rps_exudyn.results import provenance

    yield "rps-exudyn", f"{provenance.package_version()} {provenance.git_hash()}".strip(), True
    libraries = json.loads(provenance.library_versions())
    yield "libraries", ", ".join(f"{name} {number}" for name, number in libraries.items()), True
    usable = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    yield "machine", provenance.machine(), True
    yield "threads", f"{usable} usable; a run uses one, a study one per process", True
    display = os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY") or os.name == "nt"
    views = "there is one: rps-exudyn view works" if display else "none: animate instead of view"
    yield "display", views, True


def _code() -> Iterator[tuple[str, str, bool]]:
    """Where the force laws' machine code comes from, and where it is kept."""
    from rps_exudyn.base import kernel_code
    from rps_exudyn.solvers.gear_model import gear_law

    reason = kernel_code.reason_not_usable(gear_law)
    yield "force laws", f"compiled here by numba: {reason}" if reason else "as shipped with the package", True
    folder, files = kernel_code.object_folder(), kernel_code.object_files()
    if folder:
        held = f"{folder}, {len(files)} of {len(kernel_code.marks()) - 1} parts made"
        size = sum(file.stat().st_size for file in files) / 1e6
        yield "machine code", f"{held}, {size:.1f} MB; rps-exudyn doctor --clear-cache removes them", True
    else:
        where = f"{kernel_code.CACHE} names a folder for it"
        yield (
            "machine code",
            f"not kept: its folder cannot be written, or others can write there; {where}",
            False,
        )
    try:
        check_writable(Path.cwd() / "rps-exudyn-doctor.tmp")
    except InputError as error:
        yield "folder is writable", " ".join(error.problems), False
    else:
        yield "folder is writable", str(Path.cwd()), True


def _reference(loaded: float) -> tuple[str, str, bool]:
    """The default gear's torque, against the published one; how long the start took, by part."""
    from rps_exudyn.scenes.free_pinion_torque import SCENE
    from rps_exudyn.simulate.run import run

    times = []
    for _ in range(2):  # the second one is without making code, and without what is imported where needed
        began = process_time()
        with shown_progress():
            result = run(SCENE.name, fidelity="quasi-static")
        times.append(process_time() - began)
    took = (
        f"CPU time: {loaded:.2g} s loading, {times[0] - times[1]:.2g} s preparing, {times[1]:.2g} s computing"
    )
    if result.status is not Status.OK:
        return "reference run", f"{result.status}: {result.message}", False
    torque = result.summary["torque_mean"]
    fine = abs(torque / PUBLISHED - 1) < AGREES
    return "reference run", f"{torque:.5f} N m, published {PUBLISHED} N m; {took}", fine
