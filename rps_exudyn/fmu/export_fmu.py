"""Export of a gear as an FMU: C sources with its table, and the binary of this platform."""

import json
import os
import platform
import shutil
import subprocess
import sys
import zipfile
from dataclasses import dataclass
from hashlib import sha256
from importlib.metadata import version
from importlib.resources import files
from pathlib import Path
from tempfile import TemporaryDirectory

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import check_writable, replacing
from rps_exudyn.fmu.gear_data import header
from rps_exudyn.fmu.model_error import REFERENCE, model_error
from rps_exudyn.fmu.variables import description, parameters_of, variables_of
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear, gear_file
from rps_exudyn.scenes.contact_law import resolve_contact_law
from rps_exudyn.scenes.reduced_table import TableLost, table_of
from rps_exudyn.scenes.run_maneuver import by_equilibrium
from rps_exudyn.solvers.reduced_gear import ReducedGear
from rps_exudyn.solvers.temperature_and_wear import tested_gear

PRELOADS = 10.0  # largest load of the table, where none is given, over the preload of the yoke
LONGEST_STEP = 1e-4  # within a communication step [s]
VERSIONS = (3, 2)  # of FMI
COMPILERS = ("cc", "gcc", "clang")
FLAGS = ("-std=c99", "-O3", "-ffp-contract=off", "-shared", "-fPIC", "-w")
LATER = (1980, 1, 1, 0, 0, 0)  # of all files inside, so that equal gears give equal FMUs


@dataclass(frozen=True)
class ExportedFmu:
    """What was written.

    Attributes:
        path: of the FMU.
        errors: relative difference of each metric from `flank`.
        platform: of the binary inside; "" without a C compiler.
    """

    path: Path
    errors: dict[str, float]
    platform: str


def export_fmu(
    gear: SteeringGear, path: str | Path, *, load: float | None = None, fmi: int = 3
) -> ExportedFmu:
    """Write a gear as an FMU of the reduced gear.

    FMI 3.0 is for co-simulation and model exchange, FMI 2.0 for co-simulation.

    Args:
        gear: the gear.
        path: of the file, with the suffix .fmu.
        load: largest load on the rack, either way, that the table has [N]; without it ten times the preload.
        fmi: version, 3 or 2.

    Raises:
        InputError: no such version, a file that cannot be written, or a gear without equilibria in the range.
    """
    if fmi not in VERSIONS:
        raise InputError(f"fmi is {fmi!r}; it must be 3 or 2.")
    load = PRELOADS * max(gear.yoke.preload, 1.0) if load is None else load
    if not 0 < load < float("inf"):
        raise InputError(f"load is {load!r} N; it must be greater than 0.")
    target = check_writable(path, (".fmu",))
    model = Fidelity.preset("reduced")
    gear = resolve_contact_law(gear, model, "line")
    reduced = reduced_of(gear, load)
    errors = model_error(gear)
    parameters = parameters_of(gear, LONGEST_STEP)
    content = header(gear, reduced, parameters.values(), "")
    token = "{" + sha256(f"{content}{fmi}".encode()).hexdigest()[:32] + "}"
    sources = sources_of(fmi) | {"gear_data.h": header(gear, reduced, parameters.values(), token)}
    about = f"{gear!r}; largest load {load:g} N; error against {REFERENCE}: {shown(errors)}"
    tool = f"rps-exudyn {version('rps-exudyn')}"
    listed = variables_of(gear, LONGEST_STEP)
    inside: dict[str, bytes | str] = {
        "modelDescription.xml": description(fmi, token, about, tool, listed),
        "resources/gear.toml": gear_file(gear),
        "resources/model_error.json": json.dumps(
            {"reference": REFERENCE, "relative_error": errors}, indent=1
        ),
        **{f"sources/{name}": text for name, text in sources.items()},
    }
    if fmi == 3:
        inside["sources/buildDescription.xml"] = (
            files("rps_exudyn.fmu").joinpath("buildDescription.xml").read_bytes()
        )
    folder, library = platform_of(fmi)
    binary = compiled(sources, ["reduced_gear.c", f"fmi{fmi}.c"])
    if binary is not None:
        inside[f"binaries/{folder}/reduced_gear{library}"] = binary
    with replacing(path) as partial, zipfile.ZipFile(partial, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in inside.items():
            archive.writestr(zipfile.ZipInfo(name, LATER), text, zipfile.ZIP_DEFLATED)
    return ExportedFmu(target, errors, folder if binary is not None else "")


def reduced_of(gear: SteeringGear, load: float) -> ReducedGear:
    """Return the reduced gear of a table up to a load [N].

    Raises:
        InputError: there are no equilibria.
    """
    try:
        return table_of(by_equilibrium, tested_gear(gear), Fidelity.preset("reduced"), load)
    except TableLost as lost:
        raise InputError(f"{lost.sentence}; choose a smaller load than {load:g} N.") from None


def shown(errors: dict[str, float]) -> str:
    """Return errors in words."""
    return ", ".join(f"{name} {100 * value:+.2g} %" for name, value in errors.items())


def sources_of(fmi: int) -> dict[str, str]:
    """Return the C files of a version of FMI, and the headers they include."""
    here = files("rps_exudyn.fmu")
    names = ["reduced_gear.c", f"fmi{fmi}.c", "instance.h", "reduced_gear.h"]
    found = {name: here.joinpath(name).read_text("utf-8") for name in names}
    standard = sorted(each.name for each in here.joinpath("headers").iterdir())
    return found | {
        name: here.joinpath("headers", name).read_text("utf-8")
        for name in standard
        if name.startswith(f"fmi{fmi}")
    }


def platform_of(fmi: int) -> tuple[str, str]:
    """Return the folder of this platform's binary, and the suffix of its libraries."""
    system = {"linux": "linux", "darwin": "darwin", "win32": "windows"}.get(sys.platform, sys.platform)
    suffix = {"darwin": ".dylib", "windows": ".dll"}.get(system, ".so")
    if fmi == 2:
        return {"linux": "linux64", "darwin": "darwin64", "windows": "win64"}.get(system, system), suffix
    machine = {"amd64": "x86_64", "arm64": "aarch64"}.get(platform.machine().lower(), platform.machine())
    return f"{machine}-{system}", suffix


def compiled(sources: dict[str, str], names: list[str]) -> bytes | None:
    """Return the library of C files; None without a C compiler.

    Raises:
        InputError: the compiler refuses them.
    """
    compiler = next(
        (found for name in (os.environ.get("CC"), *COMPILERS) if name and (found := shutil.which(name))), None
    )
    if compiler is None:
        return None
    with TemporaryDirectory() as folder:
        for name, text in sources.items():
            Path(folder, name).write_text(text, "utf-8")
        library = Path(folder, "gear.lib")
        done = subprocess.run(
            [compiler, *FLAGS, *names, "-o", str(library), "-lm"],
            cwd=folder,
            capture_output=True,
            text=True,
            check=False,
        )
        if done.returncode:
            raise InputError(f"{compiler} cannot compile the FMU: {done.stderr.strip().splitlines()[0]}.")
        return library.read_bytes()
