"""What `--accuracy` is measured on, scene by scene: settings, references and quantities.

Steady turning: equilibria with fine strips, and dynamics at two steps, the shorter of which shows vibration.
Swings: dynamics in two steps and strips of two kinds, and equilibria where they exist; behind a column they
mostly do not, and `wheel_plans` compares that motion with an integration of its own. Impacts: Exudyn in parts
of the scene's steps. The package's own Runge-Kutta method needs steps below 2 us there: of two random gears
the peak was 0.3 to 0.6 % off in steps of 4 us and 0.1 % in steps of 2 us; so it is left to the chart's
reference, on one gear. A rattling gear is run in two steps as well, where it is hit: a coarse run shows that
beforehand. At rest: strips of two kinds.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes import scene_named
from verification.limited import cpu_limit
from verification.references import SHAKEN, STRIPS, by_strips
from verification.runs import STEPS_AS_GIVEN, run_scene
from verification.scene_truth import Made, Make, by_model, impact_in_parts

Setting = tuple[str, int | None, dict[str, float]]
"""Preset, angles per pitch, other settings."""

FINE: dict[str, float] = {"strip_stations": 8, "strip_points": 4}


@dataclass(frozen=True)
class Measured:
    """How a scene is measured.

    Attributes:
        settings: what is tried.
        methods: name -> how the truth is found; the first that succeeds is the reference.
        figures: numbers of the summary that are promised besides the signal, or instead of it, each with the
            largest uncertainty of its reference [%].
        signal: whether the scene's signal is promised.
        gears: how many are drawn.
        uncertain: the same of the signal [%].
        all_methods: whether a gear on which a method fails is left out: there it may have several equilibria.
        most_failures: share of gears on which an offered setting may find nothing.
        costed: gears whose costs are measured.
        longest: CPU time for a gear, with compiling; one that takes more is left out [s]. A check gives as
            much to a reference, and to a run with what confirms it.
    """

    settings: Sequence[Setting]
    methods: Mapping[str, Make]
    figures: Mapping[str, float] = field(default_factory=dict)
    signal: bool = True
    gears: int = 90
    uncertain: float = 0.03
    all_methods: bool = False
    most_failures: float = 0.1
    costed: int = 16
    longest: float = 60.0

    def allowed(self, scene: str) -> dict[str, float]:
        """Return the quantities, the signal first, each with the largest uncertainty of its reference [%]."""
        signal = {scene_named(scene).signal: self.uncertain} if self.signal else {}
        return signal | dict(self.figures)


def moving(step: str, **changes: Any) -> Make:
    """Method: dynamics with fine strips in steps of an angle."""
    settings = {"step_angle": step, "tolerance": 1e-5, **FINE, **changes}
    return by_model(Fidelity.preset("flank").replace(settings))


def shortly(make: Make, seconds: float) -> Make:
    """Method: another one that fails where it takes more CPU time than this [s]."""
    return cpu_limit(seconds)(make)


def struck(parts: int) -> Make:
    """Method: an impact in so many parts of the scene's step; the test must be short."""

    def limited(scene: str, gear: SteeringGear) -> Made:
        _check_short((gear.test.pulses + 1) * gear.test.pulse_period, LONGEST_TEST)
        return impact_in_parts(parts)(scene, gear)

    return limited


def _check_short(duration: float, limit: float) -> None:
    if duration > limit:
        raise ArithmeticError(f"the test is longer than {limit:g} s")


def rattling(swing_steps: int, halvings: int) -> Make:
    """Method: a road's force in steps per swing halved so often, with the zone; it must hit, and be short."""
    fine = SHAKEN.replace({"swing_steps": swing_steps})

    def limited(scene: str, gear: SteeringGear) -> Made:
        test = gear.test
        _check_short((test.road_cycles + 1) * test.road_phases / test.road_frequency, LONGEST_RATTLE)
        if not run_scene(scene, gear, COARSE, STEPS_AS_GIVEN).summary.get("rattle_impacts_per_cycle"):
            raise ArithmeticError("nothing hits: the plunger does not reach the yokenut, or never leaves it")
        return run_scene(scene, gear, fine, replace(STEPS_AS_GIVEN, halvings=halvings)), fine

    return limited


def resting(stations: int, points: int) -> Make:
    """Method: equilibria under loads one after the other."""
    strips = {"strip_stations": stations, "strip_points": points}
    return by_model(Fidelity.preset("quasi-static").replace(strips))


# --- steady turning ----------------------------------------------------------------------------------
STEADY: list[Setting] = [("quasi-static", n, {}) for n in (6, 8, 12, 16, 24, 36, 48)]
STEADY += [("quasi-static", n, FINE) for n in (36, 48, 72, 96, 144)]
STEADY += [("flank", n, {}) for n in (12, 24, 48)]
STEADY += [("flank", n, FINE) for n in (48, 96)]
TURNED: dict[str, Make] = {
    "equilibria": by_model(by_strips("0.1 deg")),
    "dynamics": moving("0.25 deg"),
    "dynamics, short steps": moving("0.0625 deg"),
}
TURNING = Measured(STEADY, TURNED, all_methods=True)

# --- swings ------------------------------------------------------------------------------------------
BY_DYNAMICS: list[Setting] = [("flank", n, {}) for n in (24, 60, 180, 360, 720)]
TO_AND_FRO: list[Setting] = [("quasi-static", n, {}) for n in (24, 60, 180, 360)] + BY_DYNAMICS
TO_AND_FRO += [(preset, n, FINE) for preset in ("quasi-static", "flank") for n in (60, 180)]
IN_MOTION: dict[str, Make] = {
    "dynamics, short steps": moving("0.01 deg"),
    "dynamics, finer strips": moving("0.02 deg", **STRIPS),
}
FELT: list[Setting] = [("flank", n, {}) for n in (24, 180)]
FELT += [("flank", n, FINE) for n in (24, 60, 180, 720, 1440)]
SETTLING = 10.0  # CPU time of equilibria, which some gears follow over dozens of cycles in vain [s]
SWUNG: dict[str, Make] = {**IN_MOTION, "equilibria": shortly(by_model(by_strips("0.02 deg")), SETTLING)}

# --- impacts -----------------------------------------------------------------------------------------
STRUCK: list[Setting] = [("flank", None, {"swing_steps": n, **FINE}) for n in (8, 17, 34)]
LONGEST_TEST = 60e-3  # of an impact that is measured [s]
HIT: dict[str, Make] = {"a third of the step": struck(3), "half the step": struck(2)}

LONGEST_RATTLE = 90e-3  # of all cycles and phases of a road's force that is measured [s]
COARSE = Fidelity.preset("flank").replace({"swing_steps": 8})
RATTLED: dict[str, Make] = {"64 steps per swing": rattling(16, 2), "44 steps per swing": rattling(22, 1)}

# --- at rest -----------------------------------------------------------------------------------------
STILL: list[Setting] = [
    ("quasi-static", None, {"strip_stations": stations, "strip_points": points})
    for stations, points in ((2, 2), (3, 2), (4, 2), (6, 3), (8, 4))
]
RESTED: dict[str, Make] = {"strips 12 x 6": resting(12, 6), "strips 9 x 5": resting(9, 5)}

SCENES: dict[str, Measured] = {
    "free-pinion-torque": TURNING,
    "load-test": replace(TURNING, gears=104),
    "rack-push": TURNING,
    "reversal": Measured(
        TO_AND_FRO, SWUNG, {"hysteresis_area": 0.03}, gears=50, uncertain=0.5, most_failures=0.5
    ),
    "steering-feel": Measured(FELT, IN_MOTION, {"feel_area": 0.05}, gears=56, uncertain=0.5, longest=150.0),
    "rack-lift": Measured(STILL, RESTED, {"rack_lift": 0.03}, signal=False, gears=52),
    "radial-play": Measured(STILL, RESTED, {"radial_play_y": 0.03}, signal=False, gears=44),
    "yoke-impact": Measured(
        STRUCK, HIT, {"impact_peak_force": 0.05, "impact_force_rms": 0.05}, signal=False, gears=125
    ),
    "rattle": Measured(
        STRUCK,
        RATTLED,
        {
            "rattle_force_rms": 0.3,
            "rattle_impulse_per_cycle": 0.3,
            "rattle_acceleration_rms": 0.3,
            "rattle_energy_per_cycle": 0.5,
        },
        signal=False,
        gears=408,
        costed=4,
    ),
}
