"""The variables of the FMU: references as in `reduced_gear.h`, units, and the file that describes them."""

from typing import NamedTuple
from xml.etree import ElementTree as xml

from rps_exudyn.parameters.gear import SteeringGear

MOST_ELEMENTS = 4


class Variable(NamedTuple):
    """A variable of the FMU.

    Attributes:
        name: in the FMU.
        reference: number by which the C code has it.
        causality: as FMI names it.
        unit: a name in `UNITS`; "" without.
        meaning: one sentence.
        variability: as FMI names it.
        start: value before the start; None where it is calculated.
        derivative: reference of the variable whose derivative it is.
        whole: whether it is a whole number.
    """

    name: str
    reference: int
    causality: str
    unit: str
    meaning: str
    variability: str = "continuous"
    start: float | None = None
    derivative: int | None = None
    whole: bool = False


UNITS: dict[str, dict[str, str]] = {
    "s": {"s": "1"},
    "rad": {"rad": "1"},
    "rad/s": {"rad": "1", "s": "-1"},
    "rad/s2": {"rad": "1", "s": "-2"},
    "m": {"m": "1"},
    "m/s": {"m": "1", "s": "-1"},
    "N": {"kg": "1", "m": "1", "s": "-2"},
    "N/m": {"kg": "1", "s": "-2"},
    "N.m": {"kg": "1", "m": "2", "s": "-2"},
    "N.m/rad": {"kg": "1", "m": "2", "s": "-2", "rad": "-1"},
    "N.m.s/rad": {"kg": "1", "m": "2", "s": "-1", "rad": "-1"},
    "J": {"kg": "1", "m": "2", "s": "-2"},
    "W": {"kg": "1", "m": "2", "s": "-3"},
    "K": {"K": "1"},
}
"""Unit -> its exponents of base units."""

STATES = range(20, 23 + MOST_ELEMENTS)


def parameters_of(gear: SteeringGear, longest_step: float) -> dict[str, float]:
    """Return the parameters of the FMU in the order of their references."""
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
    start = parameters_of(gear, longest_step)
    given = [
        ("preload", "N", "preload of the yoke at 20 degC", "tunable"),
        ("mesh_friction", "", "friction coefficient of the teeth", "tunable"),
        ("yoke_friction", "", "friction coefficient of the plunger at 20 degC", "tunable"),
        ("temperature", "K", "temperature of the gear", "tunable"),
        ("column_stiffness", "N.m/rad", "torsional stiffness of the column, of pinion_input 2", "fixed"),
        ("column_damping", "N.m.s/rad", "damping of the column, of pinion_input 2", "fixed"),
        ("mount_stiffness", "N/m", "stiffness of the housing's mounts along the rack; 0: rigid", "fixed"),
        ("longest_step", "s", "longest step within a communication step", "fixed"),
        ("start_angle", "rad", "pinion angle at the start, of pinion_input 0", "fixed"),
    ]
    inputs = [
        ("pinion_torque_in", "N.m", "torque on the pinion, of pinion_input 0"),
        ("pinion_angle_in", "rad", "angle of the pinion, or of the column's upper end"),
        ("pinion_speed_in", "rad/s", "its rate"),
        ("pinion_acceleration_in", "rad/s2", "the rate of that"),
        ("rack_force_in", "N", "load that pulls the rack towards -X, of rack_input 0"),
        ("rack_travel_in", "m", "travel of the rack, of rack_input 1"),
        ("rack_speed_in", "m/s", "its rate"),
    ]
    outputs = [
        ("pinion_torque", "N.m", "torque on the pinion: the one given, the one needed, or the column's"),
        ("pinion_angle", "rad", "angle of the pinion"),
        ("pinion_speed", "rad/s", "speed of the pinion"),
        ("rack_force", "N", "load that pulls the rack towards -X: the one given or the one needed"),
        ("rack_travel", "m", "travel of the rack"),
        ("rack_speed", "m/s", "speed of the rack"),
        ("friction_torque", "N.m", "torque of the friction elements"),
        ("stored_energy", "J", "kinetic and elastic energy"),
    ]
    states = [
        ("angle_state", "rad", "angle of the pinion that a torque turns"),
        ("speed_state", "rad/s", "its rate"),
        ("lost_work", "J", "work lost to friction and damping since the start"),
        *((f"stretch_{k}", "rad", f"stretch of friction element {k}") for k in range(1, MOST_ELEMENTS + 1)),
    ]
    rates = {"rad": "rad/s", "rad/s": "rad/s2", "J": "W"}
    return [
        Variable("time", 0, "independent", "s", "time"),
        *(Variable(each[0], 1 + i, "input", *each[1:], start=0.0) for i, each in enumerate(inputs)),
        *(Variable(name, 10 + i, "output", unit, text) for i, (name, unit, text) in enumerate(outputs)),
        *(
            Variable(name, 20 + i, "local", unit, text, start=0.0)
            for i, (name, unit, text) in enumerate(states)
        ),
        *(
            Variable(f"der_{name}", 30 + i, "local", rates[unit], f"rate of {name}", derivative=20 + i)
            for i, (name, unit, _) in enumerate(states)
        ),
        *(
            Variable(name, 40 + i, "parameter", unit, text, variability, start[name])
            for i, (name, unit, text, variability) in enumerate(given)
        ),
        Variable(
            "pinion_input", 50, "parameter", "",
            "0: torque at the pinion; 1: angle of the pinion; 2: angle of the column's upper end",
            "fixed", 0, whole=True,
        ),
        Variable(
            "rack_input", 51, "parameter", "", "0: load on the rack; 1: travel of the rack",
            "fixed", 0, whole=True,
        ),
    ]  # fmt: skip


# --- modelDescription.xml


def description(version: int, about: dict[str, str], token: str, variables: list[Variable]) -> bytes:
    """Return the file that describes the FMU by a version of FMI, 2 or 3."""
    root = (_of_fmi3 if version == 3 else _of_fmi2)(about, token, variables)
    xml.indent(root)
    return bytes(xml.tostring(root, encoding="utf-8", xml_declaration=True))


def _units(root: xml.Element) -> None:
    units = xml.SubElement(root, "UnitDefinitions")
    for name, base in UNITS.items():
        xml.SubElement(xml.SubElement(units, "Unit", name=name), "BaseUnit", base)


def _of_fmi3(about: dict[str, str], token: str, variables: list[Variable]) -> xml.Element:
    root = xml.Element("fmiModelDescription", {"fmiVersion": "3.0", "instantiationToken": token} | about)
    state = {
        "modelIdentifier": "reduced_gear",
        "canGetAndSetFMUState": "true",
        "canSerializeFMUState": "true",
        "providesDirectionalDerivatives": "true",
    }
    xml.SubElement(root, "ModelExchange", state)
    xml.SubElement(root, "CoSimulation", state | {"canHandleVariableCommunicationStepSize": "true"})
    _units(root)
    _category(root)
    xml.SubElement(root, "DefaultExperiment", stopTime="10", stepSize="0.001")
    listed = xml.SubElement(root, "ModelVariables")
    for each in variables:
        kind = "Int32" if each.whole else "Float64"
        xml.SubElement(listed, kind, _attributes(each) | _unit(each) | _start(each) | _derivative(each))
    structure = xml.SubElement(root, "ModelStructure")
    for each in _outputs(variables):
        xml.SubElement(structure, "Output", valueReference=str(each.reference))
    rates = [each for each in variables if each.derivative is not None]
    for each in rates:
        xml.SubElement(structure, "ContinuousStateDerivative", valueReference=str(each.reference))
    states = [each for each in variables if each.reference in STATES]
    for each in [*_outputs(variables), *states, *rates]:
        xml.SubElement(structure, "InitialUnknown", valueReference=str(each.reference))
    return root


def _of_fmi2(about: dict[str, str], token: str, variables: list[Variable]) -> xml.Element:
    root = xml.Element("fmiModelDescription", {"fmiVersion": "2.0", "guid": token} | about)
    state = {
        "modelIdentifier": "reduced_gear",
        "canHandleVariableCommunicationStepSize": "true",
        "canGetAndSetFMUstate": "true",
        "canSerializeFMUstate": "true",
        "providesDirectionalDerivative": "true",
    }
    sources = xml.SubElement(xml.SubElement(root, "CoSimulation", state), "SourceFiles")
    for name in SOURCES[2]:
        xml.SubElement(sources, "File", name=name)
    _units(root)
    _category(root)
    xml.SubElement(root, "DefaultExperiment", stopTime="10", stepSize="0.001")
    listed = xml.SubElement(root, "ModelVariables")
    for each in variables:
        scalar = xml.SubElement(listed, "ScalarVariable", _attributes(each))
        xml.SubElement(scalar, "Integer" if each.whole else "Real", _unit(each) | _start(each))
    structure = xml.SubElement(root, "ModelStructure")
    for part in ("Outputs", "InitialUnknowns"):
        unknowns = xml.SubElement(structure, part)
        for each in _outputs(variables):
            xml.SubElement(unknowns, "Unknown", index=str(variables.index(each) + 1))
    return root


def _category(root: xml.Element) -> None:
    xml.SubElement(xml.SubElement(root, "LogCategories"), "Category", name="error")


def _outputs(variables: list[Variable]) -> list[Variable]:
    return [each for each in variables if each.causality == "output"]


def _attributes(each: Variable) -> dict[str, str]:
    named = {"name": each.name, "valueReference": str(each.reference), "causality": each.causality}
    named |= {"description": each.meaning, "variability": each.variability}
    if each.start is not None and each.causality == "local":
        named["initial"] = "calculated"
    return named


def _unit(each: Variable) -> dict[str, str]:
    return {"unit": each.unit} if each.unit else {}


def _start(each: Variable) -> dict[str, str]:
    if each.start is None or each.causality == "local":
        return {}
    return {"start": str(int(each.start)) if each.whole else repr(float(each.start))}


def _derivative(each: Variable) -> dict[str, str]:
    return {} if each.derivative is None else {"derivative": str(each.derivative)}


SOURCES = {
    3: ("reduced_gear.c", "fmi3.c"),
    2: ("reduced_gear.c", "fmi2.c"),
}
"""C files of each version of FMI."""


def build_description() -> bytes:
    """Return the file that tells an importer of FMI 3.0 how to compile the sources."""
    root = xml.Element("fmiBuildDescription", fmiVersion="3.0")
    build = xml.SubElement(root, "BuildConfiguration", modelIdentifier="reduced_gear")
    files = xml.SubElement(build, "SourceFileSet", language="C99")
    for name in SOURCES[3]:
        xml.SubElement(files, "SourceFile", name=name)
    xml.indent(root)
    return bytes(xml.tostring(root, encoding="utf-8", xml_declaration=True))
