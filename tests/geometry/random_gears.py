"""Gears from the whole admissible range, for property tests."""

import dataclasses

import numpy as np
from hypothesis import strategies as st

from rps_exudyn.gears.basic_rack import pointed_radius, undercut_limit
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.trochoid import form_point
from rps_exudyn.parameters import SteeringGear


@st.composite
def gear_pairs(draw: st.DrawFn) -> GearPair:
    """Pinions without undercut, from a spur gear to 45 degrees of helix, 4 to 30 teeth, either hand."""
    module = draw(st.floats(0.5e-3, 5e-3))
    helix = st.one_of(st.just(0.0), st.floats(0.05, 0.78), st.floats(-0.78, -0.05))
    dedendum = draw(st.floats(1.1, 1.4))
    pair = dataclasses.replace(
        GearPair.of(SteeringGear()),
        teeth=draw(st.integers(4, 30)),
        module=module,
        alpha_n=draw(st.floats(0.24, 0.42)),
        beta_p=draw(helix),
        beta_r=draw(st.floats(-0.4, 0.4)),
        rack_addendum=module,
        rack_dedendum=dedendum * module,
        fillet_radius=draw(st.floats(0.0, 0.2)) * module,
        face_width=draw(st.floats(2, 12)) * module,
    )
    shift = max(undercut_limit(pair), -0.8) + draw(st.floats(0.001, 0.8))
    pair = dataclasses.replace(pair, profile_shift=shift)
    share = draw(st.floats(0.3, 0.97))
    form, pointed = form_point(pair).radius, pointed_radius(pair)
    return dataclasses.replace(pair, tip_radius=form + share * (pointed - form))


sides = st.sampled_from([-1, 1])


def angle_between(a: float, b: float) -> float:
    """a - b brought into (-pi, pi]."""
    return float(np.remainder(a - b + np.pi, 2 * np.pi) - np.pi)
