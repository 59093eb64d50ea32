"""Methods that have little in common must agree; facets of the pinion must not."""

import numpy as np
import pytest

from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.multibody.general_contact import flank_triangle
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Status
from rps_exudyn.tooth_contact.spheres import SIDES
from verification.faceted import FACETED, faceted_run, largest_deviation, meshed, shaped
from verification.flywheel import explicit_run
from verification.law_area import by_law
from verification.references import as_run, by_strips, moving, over_generators, reference_of, slowly

GEAR = by_law(SteeringGear(), "area")  # the law that generators know
PITCH = GEAR.replace({"test.turns": 1 / 6})


def test_reversal_by_generators_by_strips_and_in_motion() -> None:
    """Equilibria carry the swing's inertia; without it they differ from dynamics thrice as much. In a zone
    of 0.1 the torque turns over many steps: where it jumps, curves of any two step lengths differ more. What
    would confirm the motion has a narrower zone, and is not made."""
    gear, step = GEAR.replace({"test.amplitude": "15 deg"}), "0.05 deg"
    wide = {"zone_ratio": 0.1}
    reference = reference_of(
        "reversal",
        gear,
        {
            "generators": over_generators(80, slowly(by_strips(step).replace(wide))),
            "strips": slowly(by_strips(step).replace(wide)),
            "moving": as_run(moving(step, 1e-5).replace(wide)),
        },
    )
    differences = reference.headline.differences
    assert differences["generators - strips"] < 0.01
    assert differences["strips - moving"] < 0.03


@pytest.mark.parametrize("solver", ["VelocityVerlet", "RK44"])
def test_exudyns_explicit_solvers_turn_the_gear_alike(solver: str) -> None:
    gear = GEAR.replace({"test.turns": 1 / 36})
    known = as_run(by_strips("0.5 deg"))("free-pinion-torque", gear)[0]
    run = explicit_run(gear, Fidelity.preset("flank"), solver, 30e-6)
    assert run.ok, run.outcome.message
    torque = np.interp(known["pinion_angle"], run.signals["pinion_angle"], run.signals["pinion_torque"])
    assert torque == pytest.approx(known["pinion_torque"], rel=5e-4)
    turned = run.signals["pinion_angle"][-1] - run.signals["pinion_angle"][0]
    assert turned / run.signals["time"][-1] == pytest.approx(gear.test.speed, rel=1e-6)


def test_explicit_steps_beyond_the_stable_ones_are_a_failure() -> None:
    run = explicit_run(GEAR.replace({"test.turns": 1 / 36}), Fidelity.preset("flank"), "RK44", 100e-6)
    assert run.outcome.status is Status.DIVERGED
    assert "100 us" in run.outcome.message


def test_shaping_costs_torque_with_the_square_of_the_cut() -> None:
    model, gear = FACETED.replace({"step_angle": "2 deg"}), GEAR.replace({"test.turns": 1 / 12})
    smooth = faceted_run(gear, model, meshed(1e-8)).signals["pinion_torque"]

    def error(cuts: int) -> float:
        torque = faceted_run(gear, model, shaped(cuts)).signals["pinion_torque"]
        return float(np.sqrt(np.mean((torque - smooth) ** 2)) / smooth.mean())

    coarse, fine = error(100), error(200)
    assert coarse == pytest.approx(0.0090, rel=0.1)
    assert np.log2(coarse / fine) == pytest.approx(2.0, abs=0.25)


def test_facets_deviate_as_far_as_they_say() -> None:
    assert largest_deviation(GEAR, meshed(1e-6)) == pytest.approx(1e-6, rel=0.2)
    assert largest_deviation(GEAR, shaped(100)) == pytest.approx(3.1e-6, rel=0.1)


def test_rack_triangles_have_no_chord_error() -> None:
    """A rack's flank is a plane: one triangle is exact."""
    bar, rng = RackBar.of(GEAR), np.random.default_rng(1)
    for side in SIDES:
        flank = bar.flank(0, side)
        places = rng.dirichlet(np.ones(3), 100) @ flank_triangle(bar, flank)
        assert np.abs((places - flank.point) @ flank.normal).max() < 1e-15
