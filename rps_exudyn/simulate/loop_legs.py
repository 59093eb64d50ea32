"""The maneuvers of a scene that the loop over many gears follows, one leg after the other."""

from dataclasses import dataclass

from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes.maneuver import Maneuver, maneuvers_of_test
from rps_exudyn.solvers.closed_form import GRAVITY
from rps_exudyn.solvers.drive import OVERCOME, DrivenBody, travel_per_radian

FREE_TORQUE, LOAD_TEST, RACK_PUSH = "free-pinion-torque", "load-test", "rack-push"

SIGNALS = {
    FREE_TORQUE: ("time", "pinion_angle", "pinion_torque"),
    LOAD_TEST: ("time", "pinion_angle", "pinion_torque"),
    RACK_PUSH: ("time", "pinion_angle", "rack_displacement", "rack_force"),
}
"""Scene that the loop knows -> the signals that it keeps."""


@dataclass(frozen=True)
class Leg:
    """One maneuver of all gears."""

    body: DrivenBody  # that the rig moves
    back: bool = False  # against `test.direction`
    weighted: bool = False  # the weight of the load test pulls at the rack
    recorded: bool = True  # it is a part of the scene's record

    @property
    def force(self) -> str:
        """Name of the signal that the drive overcomes."""
        return OVERCOME[self.body]

    def maneuver(self, gear: SteeringGear, step_angle: float) -> Maneuver:
        """Return the maneuver of a gear.

        Raises:
            InputError: it leaves the rack's teeth.
        """
        to_and_fro = gear.replace({"test.path": "there-and-back"}) if self.back else gear
        return maneuvers_of_test(to_and_fro, self.body, step_angle)[1 if self.back else 0]

    def load(self, gear: SteeringGear) -> float:
        """Return what pulls the rack's end towards -X [N]."""
        return gear.test.direction * GRAVITY * gear.test.load_mass if self.weighted else 0.0

    def speed(self, gear: SteeringGear) -> float:
        """Return the pinion's speed with its sense [rad/s], of a gear without errors where the rack is
        moved."""
        return float(gear.test.direction) * gear.test.speed * (-1 if self.back else 1)

    def travel(self, gain: float) -> float:
        """Return the driven body's travel for one radian of the pinion [rad or m], of which `gain` is the
        rack's [m]."""
        return travel_per_radian(self.body, gain)


def legs_of(scene: str, gear: SteeringGear) -> tuple[Leg, ...]:
    """Return the legs of a scene in their order."""
    if scene == LOAD_TEST:
        raising = Leg("pinion", weighted=True)
        return raising, Leg("pinion", back=True, weighted=True), Leg("pinion", recorded=False)
    body: DrivenBody = "rack" if scene == RACK_PUSH else "pinion"
    return (Leg(body),) if gear.test.path == "one-way" else (Leg(body), Leg(body, back=True))
