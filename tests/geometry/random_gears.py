"""Gears from the whole admissible range, for property tests."""

import dataclasses

import numpy as np
from hypothesis import assume
from hypothesis import strategies as st

from rps_exudyn.gears.basic_rack import pointed_radius, undercut_limit
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.trochoid import form_point
from rps_exudyn.parameters.gear import SteeringGear


@st.composite
def gear_pairs(draw: st.DrawFn) -> GearPair:
    """Pinions without undercut over what `parameters` allows.

    3 to 40 teeth, either hand up to 59 degrees of helix and spur gears, pressure angles from 5 to 40 degrees,
    any module; dedendum and rounding as far as the cutter's tip keeps a flat.
    """
    module = draw(st.floats(0.2e-3, 20e-3))
    helix = st.one_of(st.just(0.0), st.floats(0.02, 1.03), st.floats(-1.03, -0.02))
    alpha = draw(st.floats(0.09, 0.69))
    dedendum = draw(st.floats(0.5, 1)) * min(1.5, 0.98 * np.pi / 4 / np.tan(alpha))
    largest_fillet = (np.pi / 4 - dedendum * np.tan(alpha)) / (1 / np.cos(alpha) - np.tan(alpha))
    pair = dataclasses.replace(
        GearPair.of(SteeringGear()),
        teeth=draw(st.integers(3, 40)),
        module=module,
        alpha_n=alpha,
        beta_p=draw(helix),
        beta_r=draw(st.floats(-1.03, 1.03)),
        rack_addendum=0.9 * dedendum * module,
        rack_dedendum=dedendum * module,
        fillet_radius=draw(st.floats(0, 0.99)) * min(0.5, largest_fillet, dedendum) * module,
        face_width=draw(st.floats(2, 12)) * module,
    )
    shift = max(undercut_limit(pair), -0.8) + draw(st.floats(0.001, 0.8))
    pair = dataclasses.replace(pair, profile_shift=shift)
    form, pointed = form_point(pair).radius, pointed_radius(pair)
    assume(pointed > 1.01 * form)  # else the teeth are pointed before their involute begins
    share = draw(st.floats(0.3, 0.97))
    return dataclasses.replace(pair, tip_radius=form + share * (pointed - form))


sides = st.sampled_from([-1, 1])


def angle_between(a: float, b: float) -> float:
    """a - b brought into (-pi, pi]."""
    return float(np.remainder(a - b + np.pi, 2 * np.pi) - np.pi)
