"""What holds for every law of the flanks' contact, from poses that no equilibrium needs to be found for."""

from collections.abc import Callable

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import rps_exudyn as rps
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.tooth_contact.flank_data import pack
from rps_exudyn.tooth_contact.wrench import NORMAL_COAST, NORMAL_DRIVE, PENETRATION, TORQUE
from verification.contact_at import elastic_contact, flank_contact, mesh_of_teeth
from verification.law_area import by_law

LAWS = ("line", "teeth", pytest.param("area", marks=pytest.mark.long))
NORMALS = [NORMAL_DRIVE, NORMAL_COAST]
GUIDED = (0.0, 0.0, 0.0)
ROLLED = (1e-3, 2e-4, -2e-4)
ANGLES = np.linspace(0, 1.0, 5)  # a tooth pitch is 2 pi / 6

Contact = Callable[..., np.ndarray]
"""(steering angle, X and Y of the rack off its place, its turn, its speed of parting) -> wrench."""


def contact_of(gear: SteeringGear) -> Contact:
    """The contact of a gear's flanks by its law, the rack near its place."""
    pair, flank = GearPair.of(gear), pack(gear, zone=1e-5)
    elastic = mesh_of_teeth(gear, flank) if gear.mesh.contact_law == "teeth" else None

    def contact(
        angle: float, x: float, y: float, turn: tuple[float, ...] = GUIDED, parting: float = 0.0
    ) -> np.ndarray:
        rotation = Rotation.from_rotvec(turn).as_matrix()
        to_mesh = np.array([0, pair.reference_radius - pair.bar_axis_height, 0])
        place = np.array([pair.gain * angle + x, pair.bar_axis_height + y, 0]) + to_mesh - rotation @ to_mesh
        state = -angle, -1.0, place, rotation, np.array([pair.gain, parting, 0]), np.zeros(3)
        return flank_contact(*state, flank) if elastic is None else elastic_contact(*state, elastic)

    return contact


def gear_by(law: str, **settings: object) -> SteeringGear:
    return by_law(SteeringGear().replace({p.replace("__", "."): v for p, v in settings.items()}), law)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("form", [{}, {"pinion__crowning": "5 um"}, {"mesh__damping": "1e-4 s"}], ids=str)
def test_no_law_ever_pulls(law: str, form: dict[str, object]) -> None:
    """Law: normal forces are pressures.

    The rack stands aside by up to 6 um and apart by up to 3 um, so that one side or both have a gap, guided
    or rolled, at rest across the mesh or parting at 1 mm/s.
    """
    contact = contact_of(gear_by(law, **form))
    for angle in ANGLES:
        for turn in (GUIDED, ROLLED):
            for x, y in ((0, 3e-6), (6e-6, 0), (-6e-6, 0), (6e-6, -3e-6), (-6e-6, 3e-6)):
                for parting in (0.0, 1e-3):
                    assert (contact(angle, x, y, turn, parting)[NORMALS] >= 0).all()


@pytest.mark.parametrize("law", LAWS)
def test_a_gap_carries_nothing(law: str) -> None:
    """Law: a guided rack lifted by 3 um touches nowhere; one aside by 6 um presses on one side only."""
    contact = contact_of(gear_by(law))
    for angle in ANGLES:
        assert not contact(angle, 0, 3e-6).any()
        for x, pressed, apart in ((6e-6, NORMAL_COAST, NORMAL_DRIVE), (-6e-6, NORMAL_DRIVE, NORMAL_COAST)):
            out = contact(angle, x, 0)
            assert out[pressed] > 100
            assert out[apart] == 0


@pytest.mark.parametrize("law", LAWS)
def test_friction_turns_about_with_the_motion(law: str) -> None:
    """Law: frictionless forces of a guided rack do no work over a pitch: the mean torque is friction's."""
    still = contact_of(gear_by(law, mesh__friction=0.0))
    rubbing = contact_of(gear_by(law))
    without, with_ = (
        np.array([one(angle, 0, -5e-6)[TORQUE] for angle in np.linspace(0, np.pi / 3, 24, endpoint=False)])
        for one in (still, rubbing)
    )
    assert abs(without.mean()) < 0.02 * abs(with_.mean())


@pytest.mark.parametrize("law", LAWS[1:])
def test_depth_is_geometry(law: str) -> None:
    """The deepest place of undeformed flanks is the same by every law, to 1 % for their stations."""
    depth, of_lines = (contact_of(gear_by(each))(0.31, 0, -10e-6)[PENETRATION] for each in (law, "line"))
    assert depth == pytest.approx(of_lines, rel=1e-2)


GUIDED_RACK = Fidelity.preset("quasi-static").replace({"rack": "guided"})
PARALLEL = {
    "pinion.teeth": 7,
    "pinion.normal_module": "1.8 mm",
    "pinion.helix_angle": "15 deg",
    "pinion.profile_shift": 0.6,
    "pinion.tip_diameter": "18.2 mm",
    "pinion.face_width": "18 mm",
    "test.turns": 1 / 7,
}


@pytest.mark.parametrize("tooth_angle", ["15 deg", "16 deg", "17 deg"])
@pytest.mark.parametrize("form", [{}, {"pinion.crowning": "8 um"}], ids=["plain", "crowned"])
def test_ripple_where_sliding_turns_about_needs_no_more_stations(
    tooth_angle: str, form: dict[str, str]
) -> None:
    """With (nearly) parallel axes friction turns about on the pitch line, inside the lines of contact.

    In one piece four stations have 2.4 times the ripple of many.
    """
    gear = SteeringGear().replace({**PARALLEL, **form, "rack.tooth_angle": tooth_angle, "mesh.law": "line"})
    runs = [
        rps.run("free-pinion-torque", gear, fidelity=GUIDED_RACK.replace({"strip_stations": n})).summary
        for n in (4, 12)
    ]
    usual, many = runs
    assert usual["torque_peak_to_peak"] == pytest.approx(many["torque_peak_to_peak"], rel=0.04)
    assert usual["torque_mean"] == pytest.approx(many["torque_mean"], rel=1e-4)
    if not form and tooth_angle == "15 deg":  # an integration of its own, converged
        assert 8.5e-3 < usual["torque_peak_to_peak"] < 9.1e-3
