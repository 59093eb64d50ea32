"""The flank contact of modified flanks, and its greatest depth, against points on the flanks.

Tolerances are shares of the sum of normal forces (times the base radius for moments).
"""

import numpy as np
import pytest

from flank_points import wrench_by_points
from flank_poses import POSES, ZONE, changed, difference, state
from rps_exudyn.base.kernel_compiler import from_python
from rps_exudyn.tooth_contact.flank_data import pack
from rps_exudyn.tooth_contact.flank_strip import DEPTH, LOW_END, PRESSING, STRIP_SHAPE, touching
from rps_exudyn.tooth_contact.wrench import PENETRATION
from verification.contact_at import flank_contact

FORMS: dict[str, dict[str, object]] = {
    "relief": {"pinion__tip_relief": "40 um", "pinion__tip_relief_length": "2 mm"},
    "slope": {"pinion__profile_slope": "21 um"},
    "crowning": {"pinion__crowning": "15 um"},
    "all": {"pinion__tip_relief": "15 um", "pinion__profile_slope": "8 um", "pinion__crowning": "6 um"},
}


@pytest.mark.parametrize("form", FORMS.values(), ids=FORMS.keys())
def test_contact_ends_where_the_modified_flank_does(form: dict[str, object]) -> None:
    """Points on the modified flank that lie inside the rack, between form and tip circle. 300 000 cells
    leave 1e-4, 320 generators 3e-4 on crowned flanks; limits on the perfect flank would be wrong by 3e-3."""
    gear = changed(**form)
    for angle in (0.25, 0.75):
        args = state(gear, angle, press=30e-6, turn=(5e-4, 0, 0))
        expected = wrench_by_points(gear, *args, zone=ZONE, shape=(1500, 200))
        strip, generators = pack(gear, zone=ZONE, along=6, across=3), pack(gear, zone=ZONE, generators=320)
        assert difference(flank_contact(*args, strip), expected, gear) < 4e-4
        assert difference(flank_contact(*args, generators), expected, gear) < 4e-4


@pytest.mark.parametrize("askew", [5e-3, -5e-3])
def test_a_short_relief_ends_the_contact_where_it_should(askew: float) -> None:
    """A relief of 33 um over 0.4 mm bends the flank more than the involute does. Its parabola, taken far
    below where it begins, would put the rack's tips millimetres away (6 % by generators); its crest lies so
    far from the line that the band's end would be overlooked (0.5 % by strips, on one random gear a third).
    """
    gear = changed(pinion__tip_relief="33 um", pinion__tip_relief_length="0.4 mm")
    args = state(gear, 0.5, press=30e-6, turn=(0, askew, 0))
    expected = wrench_by_points(gear, *args, zone=ZONE, shape=(1500, 200))
    strip, generators = pack(gear, zone=ZONE, along=6, across=3), pack(gear, zone=ZONE, generators=320)
    assert difference(flank_contact(*args, strip), expected, gear) < 6e-4
    assert difference(flank_contact(*args, generators), expected, gear) < 6e-4


@pytest.mark.parametrize("form", [{}, FORMS["all"]], ids=["perfect", "modified"])
@pytest.mark.parametrize("pose", POSES)
def test_penetration_is_the_greatest_depth_of_all_points(pose: str, form: dict[str, object]) -> None:
    """The deepest of 450 000 cells, which misses 5e-4 of it; the strip takes it where limits cross its crest:
    0.3 %. The deepest of the stations along the line would be 1 to 3 % less."""
    gear = changed(**form)
    for angle in (0.25, 0.75):
        args = state(gear, angle, **POSES[pose])
        expected = wrench_by_points(gear, *args, zone=ZONE, shape=(1500, 300))[PENETRATION]
        assert flank_contact(*args, pack(gear, zone=ZONE))[PENETRATION] == pytest.approx(expected, rel=3e-3)


@from_python
def touched_part(strip, low, high):  # type: ignore[no-untyped-def]
    """What `touching` returns first, for Python."""
    low, high, _, _ = touching(strip, low, high)
    return low, high


@pytest.mark.parametrize("beyond", [-1e-6, 3e-8, 1e-7, 3e-7, 1e-5])
def test_a_line_that_reaches_the_base_circle_is_pressed_as_far_as_it_goes(beyond: float) -> None:
    """A flank that slopes by 1.25e-3 on a line 10 um deep everywhere, which ends short of the base circle or
    beyond it, 0.7 mm of tangent length below the form circle: pressed on the whole face. Its crest's depth,
    the slope's square over the tangent length, would have no bound there, and half of the line was lost."""
    half_face, form, base, n_p, slope, per_z = 4.37e-3, 0.667e-3, 9.5e-3, 0.9, 1.25e-3, -0.352
    q = -per_z * half_face + beyond  # where Z = 0
    strip = np.zeros(STRIP_SHAPE)
    strip[LOW_END, [0, 1, 3]] = q - form, per_z, -base
    strip[DEPTH, [0, 3, 6, 7, 9]] = 10e-6, n_p * base * slope, -n_p * q / 2, -n_p * per_z / 2, n_p * base / 3
    strip[PRESSING] = strip[DEPTH]
    low, high = touched_part(strip, -half_face, half_face)
    assert (low, high) == pytest.approx((-half_face, half_face))
