"""The bar's free modes by Exudyn's own beam elements, against the modes that the package uses.

Exudyn's cable elements (absolute nodal coordinates, plane, without shear) get the same stiffness and mass
piece by piece. They have neither shear nor rotary inertia, so that they are compared with Timoshenko elements
without both; the third column shows what shear and rotary inertia change.
"""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.topic import Topic, load_data, markdown, save_data
from rps_exudyn.gears.rack_beam import PLANES, RackBeam, TimoshenkoBeam
from rps_exudyn.parameters.gear import SteeringGear

ELEMENTS = 64
MODES = 3
STIFF = 1e6  # shear stiffness over the real one, in a beam without shear
SOLID = {"y": (232.9, 632.2, 1257.6), "z": (255.3, 702.0, 1366.0)}  # finite elements of the whole rack [Hz]
DATA = "beams.json"


def run(folder: Path, elements: int = ELEMENTS) -> None:
    """Compute the modes of the default rack by all methods."""
    beam = RackBeam.of(SteeringGear())
    rows: list[dict[str, Any]] = []
    for plane, name in enumerate(PLANES):
        pieces = beam.elements(plane, elements)
        slender = replace(pieces, shear=STIFF * pieces.shear, rotary_inertia=0 * pieces.rotary_inertia)
        exudyn = cable_frequencies(pieces).tolist()
        by_us, used = ((each.free_modes(MODES)[0] / (2 * np.pi)).tolist() for each in (slender, pieces))
        rows.append({"plane": name, "exudyn": exudyn, "slender": by_us, "used": used, "solid": SOLID[name]})
    save_data(folder / DATA, {"elements": elements, "beams": rows})


def cable_frequencies(beam: TimoshenkoBeam) -> np.ndarray:
    """Lowest bending frequencies of the free beam by Exudyn's ANCFCable2D [Hz]."""
    import exudyn as exu
    from exudyn.itemInterface import NodePoint2DSlope1, ObjectANCFCable2D

    system = exu.SystemContainer()
    mbs = system.AddSystem()
    nodes = [mbs.AddNode(NodePoint2DSlope1(referenceCoordinates=[float(x), 0, 1, 0])) for x in beam.nodes]
    for i, length in enumerate(beam.lengths):
        cable = ObjectANCFCable2D(
            length=float(length),
            massPerLength=float(beam.mass[i]),
            bendingStiffness=float(beam.bending[i]),
            axialStiffness=float(beam.bending[i]) / 3e-5,  # of a bar of this thickness
            nodeNumbers=[nodes[i], nodes[i + 1]],
        )
        mbs.AddObject(cable)
    mbs.Assemble()
    squares = np.sort(np.real(mbs.ComputeODE2Eigenvalues(numberOfEigenvalues=3 + MODES)[0]))
    return np.sqrt(squares[3 : 3 + MODES]) / (2 * np.pi)


def beams_table(folder: Path) -> str:
    """Frequencies in Hz by method."""
    rows = []
    for row in load_data(folder / DATA)["beams"]:
        for mode in range(MODES):
            values = [f"{row[kind][mode]:.1f}" for kind in ("exudyn", "slender", "used", "solid")]
            rows.append([f"{row['plane']} {mode + 1}", *values])
    heads = ["Exudyn ANCFCable", "elements without shear", "elements used", "solid elements"]
    return markdown(["mode", *(f"{head} Hz" for head in heads)], rows)


TOPIC = Topic("5 s", "flexible_rack", run, {"elements": 16}, {"rack_beams": beams_table})
