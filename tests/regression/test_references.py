"""Have the numbers changed? Small cases against values that earlier runs of the same code left.

References prove nothing: the laws are in tests/physics. They show when a change that should move no number
did. `pytest tests/regression --update-references` writes them anew and prints what changed; the commit that
contains them says why.
"""

import json
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.geometry_report import geometry_report
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.quantities import GEOMETRY
from rps_exudyn.simulate.run import run
from rps_exudyn.solvers.equilibrium import equilibrium_path
from rps_exudyn.solvers.gear_forces import gear_forces
from rps_exudyn.solvers.prescribed_motion import Steady

GEAR = SteeringGear()
TOY = Fidelity.preset("full").replace({"profile_samples": 12, "axial_samples": 8, "step_angle": "0.5 deg"})
FILE = Path(__file__).with_name("references.json")

Numbers = Mapping[str, float]


class Case(NamedTuple):
    """What is measured, and how far the same code may be off on another machine: value -> relative."""

    measure: Callable[[], Numbers]
    tolerance: Callable[[str], float]
    floor: float = 1e-15  # the same for values next to zero, absolute


def geometry() -> Numbers:
    report = geometry_report(GEAR)
    masses = {f"mass_{part}": item.mass for part, item in report.mass_properties.items()}
    return {name: getattr(report, name) for name in GEOMETRY} | masses


def equilibrium(mesh: str) -> Numbers:
    """Torque and place of the rack at a few angles."""
    forces = gear_forces(GEAR, TOY.replace({"mesh": mesh}))
    angles = np.deg2rad([0, 10, 20, 40])
    turning = Steady("pinion", 0.0, GEAR.test.speed)
    path = equilibrium_path(forces.statics, GearPair.of(GEAR), turning, angles / GEAR.test.speed)
    assert path.converged
    names = ("torque", "rack_x", "rack_y", "rack_z", "rack_roll", "rack_yaw", "rack_pitch", "plunger")
    rows = np.column_stack([path.forces[:, 0], path.coordinates[:, 1:]])
    return {
        f"{name} at {np.degrees(angle):.0f} deg": float(value)
        for angle, row in zip(angles, rows, strict=True)
        for name, value in zip(names, row, strict=True)
    }


def full_model() -> Numbers:
    """Figures of a run over six degrees with few and large samples."""
    summary = run("free-pinion-torque", GEAR, fidelity=TOY, turns=1 / 60).summary
    return {name: summary[name] for name in ("torque_mean", "rack_gain")}


def balanced(name: str) -> float:
    return 1e-4 if name.startswith("torque") else 2e-3


CASES = {
    # formulas and quadratures: round-off, which another libm may turn; the interference is searched for
    "geometry": Case(geometry, lambda name: 1e-3 if name == "interference" else 1e-9),
    # forces balance to 1e-3 N (statics.TOLERANCE), 1e-5 of the torque; on the softest way, 2e7 N/m, that is
    # 5e-11 m of places that are mostly 1e-7 m and more
    "equilibrium, flank": Case(lambda: equilibrium("flank"), balanced, floor=5e-11),
    "equilibrium, samples": Case(lambda: equilibrium("general-contact"), balanced, floor=5e-11),
    # a sample may come into contact a step earlier or later, and a step may be reduced there, so that others
    # follow: 10 % of the torque's ripple, 0.1 % of its mean; the elastic ripple is 1e-3 of so short a travel
    "full model": Case(
        full_model,
        {"torque_mean": 1e-3, "torque_peak_to_peak": 0.1, "rack_gain": 5e-4}.__getitem__,
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_numbers_are_those_of_the_references(
    name: str, pytestconfig: pytest.Config, capsys: pytest.CaptureFixture[str]
) -> None:
    case = CASES[name]
    measured = {quantity: float(value) for quantity, value in case.measure().items()}
    if pytestconfig.getoption("--update-references"):
        with capsys.disabled():
            for line in updated(name, measured):
                print(line)
        return
    references = json.loads(FILE.read_text(encoding="utf-8"))[name]
    assert measured.keys() == references.keys()
    for quantity, value in measured.items():
        expected = pytest.approx(references[quantity], rel=case.tolerance(quantity), abs=case.floor)
        assert value == expected, quantity


def updated(name: str, measured: Numbers) -> Iterator[str]:
    """Write the references of a case; one line for each value that is not what it was."""
    references = json.loads(FILE.read_text(encoding="utf-8")) if FILE.exists() else {}
    old = references.get(name, {})
    for quantity in sorted(old.keys() | measured.keys()):
        before, after = old.get(quantity), measured.get(quantity)
        if before != after:
            yield f"\n{name}, {quantity}: {before} -> {after}"
    references[name] = measured
    FILE.write_text(json.dumps(references, indent=1) + "\n", encoding="utf-8")
