"""Tooth forms against an independent implementation: seven gears, see reference/make_reference_gears.py.

Its numbers are found by numerical intersection and maximisation, for a module of one metre. The largest
disagreement is 3e-15 rad; 1e-12 leaves room for another machine's arithmetic.
"""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

from rps_exudyn.gears.basic_rack import half_angle
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.trochoid import form_point, trochoid
from rps_exudyn.parameters.gear import SteeringGear

GEARS: dict[str, dict[str, Any]] = json.loads(
    Path(__file__).with_name("reference").joinpath("reference_gears.json").read_text()
)["gears"]
TOLERANCE = 1e-12


def pair_of(entry: dict[str, Any]) -> GearPair:
    """The gear with a module of one metre."""
    return replace(
        GearPair.of(SteeringGear()),
        teeth=entry["teeth"],
        module=1.0,
        alpha_n=entry["pressure_angle"],
        beta_p=entry["helix_angle"],
        profile_shift=entry["profile_shift"],
        tip_radius=entry["tip_radius"],
        rack_addendum=1.0,
        rack_dedendum=entry["dedendum"],
        fillet_radius=entry["fillet_radius"],
    )


def space_half_angle(pair: GearPair, radius: float) -> float:
    """Half the tooth space of this package's profile."""
    form = form_point(pair)
    if radius >= form.radius:
        return float(np.pi / pair.teeth - half_angle(pair, radius))
    if radius <= pair.root_radius:
        return 0.0
    eta = brentq(lambda eta: np.hypot(*trochoid(pair, eta)) - radius, form.eta, np.pi / 2, xtol=1e-15)
    return float(np.arctan2(*trochoid(pair, eta)))


@pytest.mark.parametrize("name", GEARS)
def test_flanks_agree(name: str) -> None:
    radius, angle = np.array(GEARS[name]["flank"]).T
    np.testing.assert_allclose(half_angle(pair_of(GEARS[name]), radius), angle, rtol=0, atol=TOLERANCE)


@pytest.mark.parametrize("name", GEARS)
def test_tooth_spaces_agree_down_to_the_root(name: str) -> None:
    pair = pair_of(GEARS[name])
    for radius, angle in GEARS[name]["space"]:
        assert space_half_angle(pair, radius) == pytest.approx(angle, abs=TOLERANCE)


@pytest.mark.parametrize("name", [name for name, entry in GEARS.items() if "sharp_root" in entry])
def test_trochoids_of_sharp_cutters_agree(name: str) -> None:
    pair = pair_of(GEARS[name])
    if form_point(pair).undercut:
        # where their two curves cross is solved for to a residual of 1e-9 only
        assert form_point(pair).radius == pytest.approx(GEARS[name]["sharp_form_radius"], abs=1e-8)
    for radius, tooth in GEARS[name]["sharp_root"]:
        assert np.pi / pair.teeth - space_half_angle(pair, radius) == pytest.approx(tooth, abs=TOLERANCE)
