"""What tests of the FMU share: its C code as a library, the compiler."""

import ctypes
import shutil
from functools import cache
from pathlib import Path
from tempfile import mkdtemp

import pytest

from rps_exudyn.fmu.export_fmu import COMPILERS, LONGEST_STEP, compiled, reduced_of, sources_of
from rps_exudyn.fmu.gear_data import header
from rps_exudyn.fmu.variables import parameters_of
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.solvers.reduced_gear import ReducedGear

GEAR = SteeringGear().replace({"mesh.law": "line"})
COURSED = GEAR.replace({"rack.ratio.centre": "34 mm", "rack.ratio.lock": "38 mm", "rack.travel": "60 mm"})
LOAD = 3000.0
HERE = Path(__file__).parent

needs_compiler = pytest.mark.skipif(
    not any(map(shutil.which, COMPILERS)), reason="a C compiler makes the binary of an FMU"
)


@cache
def table(gear: SteeringGear = GEAR) -> ReducedGear:
    """The reduced gear that the library has."""
    return reduced_of(gear, LOAD)


@cache
def library(gear: SteeringGear = GEAR) -> ctypes.CDLL:
    """The C code of the FMU without FMI, and the random histories of `fmu_histories.c`."""
    sources = sources_of(3)
    sources["gear_data.h"] = header(gear, table(gear), parameters_of(gear, LONGEST_STEP).values(), "")
    sources["fmu_histories.c"] = (HERE / "fmu_histories.c").read_text("utf-8")
    binary = compiled(sources, ["reduced_gear.c", "fmu_histories.c"])
    assert binary is not None
    path = Path(mkdtemp()) / "gear.so"
    path.write_bytes(binary)
    return ctypes.CDLL(str(path))


class CGear:
    """A gear of the C code."""

    ROOM = 8192  # bytes, more than it takes

    def __init__(self, gear: SteeringGear = GEAR, **values: float) -> None:
        self.library = library(gear)
        self.bytes = ctypes.create_string_buffer(self.ROOM)
        self.library.gear_reset(self.bytes)
        for name, value in values.items():
            self.set(name, value)

    def set(self, name: str, value: float) -> int:
        """Set a variable by its name; return the status."""
        return int(self.library.gear_set(self.bytes, REFERENCES[name], ctypes.c_double(value)))

    def get(self, name: str) -> float:
        """Return a variable by its name."""
        value = ctypes.c_double()
        assert self.library.gear_value(self.bytes, REFERENCES[name], ctypes.byref(value)) == 0
        return value.value

    def start(self) -> int:
        """Initialise; return the status."""
        return int(self.library.gear_start(self.bytes))

    def step(self, duration: float) -> int:
        """Step; return the status."""
        return int(self.library.gear_step(self.bytes, ctypes.c_double(duration)))


def _references() -> dict[str, int]:
    from rps_exudyn.fmu.variables import variables_of

    return {each.name: each.reference for each in variables_of(GEAR, LONGEST_STEP)}


REFERENCES = _references()
