"""The variables of the FMU, which `variables.txt` lists, and the file that describes them to importers."""

from importlib.resources import files
from typing import NamedTuple

from rps_exudyn.parameters.gear import SteeringGear


class Variable(NamedTuple):
    """A variable of the FMU; causality and variability as FMI has them, no unit is ""."""

    reference: int
    causality: str
    variability: str
    unit: str
    name: str
    meaning: str
    start: float | None = None
    state: bool = False
    rate: bool = False
    whole: bool = False


UNITS = {
    "s": 's="1"', "rad": 'rad="1"', "rad/s": 'rad="1" s="-1"', "rad/s2": 'rad="1" s="-2"', "m": 'm="1"',
    "m/s": 'm="1" s="-1"', "N": 'kg="1" m="1" s="-2"', "N/m": 'kg="1" s="-2"', "K": 'K="1"',
    "N.m": 'kg="1" m="2" s="-2"', "N.m/rad": 'kg="1" m="2" s="-2" rad="-1"',
    "N.m.s/rad": 'kg="1" m="2" s="-1" rad="-1"', "J": 'kg="1" m="2" s="-2"', "W": 'kg="1" m="2" s="-3"',
}  # fmt: skip
"""Unit -> its exponents of base units."""


def parameters_of(gear: SteeringGear, longest_step: float) -> dict[str, float]:
    """Return the real parameters of the FMU in the order of their references."""
    return {
        "preload": gear.yoke.preload,
        "mesh_friction": gear.mesh.friction,
        "yoke_friction": gear.yoke.friction,
        "temperature": gear.conditions.temperature,
        "column_stiffness": gear.column.stiffness,
        "column_damping": gear.column.damping,
        "mount_stiffness": gear.housing.mount_stiffness,
        "longest_step": longest_step,
        "start_angle": gear.test.start_angle,
    }


def variables_of(gear: SteeringGear, longest_step: float) -> list[Variable]:
    """Return all variables of a gear's FMU."""
    start, found = parameters_of(gear, longest_step), []
    for line in files("rps_exudyn.fmu").joinpath("variables.txt").read_text("utf-8").splitlines()[1:]:
        reference, causality, variability, unit, name, meaning = line.split(maxsplit=5)
        whole = name.endswith("_input")
        begins = 0.0 if causality == "input" else 0 if whole else start.get(name)
        of_unit = "" if unit == "-" else unit
        kinds = int(reference) in range(20, 30), int(reference) in range(30, 40), whole
        found.append(Variable(int(reference), causality, variability, of_unit, name, meaning, begins, *kinds))
    return found


def description(version: int, token: str, about: str, tool: str, variables: list[Variable]) -> str:
    """Return modelDescription.xml by a version of FMI, 2 or 3."""
    from jinja2 import Environment

    source = files("rps_exudyn.fmu").joinpath(f"modelDescription{version}.xml").read_text("utf-8")
    template = Environment(autoescape=True).from_string(source)
    name = "rack-and-pinion steering gear"
    return template.render(token=token, about=about, tool=tool, name=name, variables=variables, units=UNITS)
