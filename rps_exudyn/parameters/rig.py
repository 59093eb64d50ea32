"""Motion and load of the rig: the parameters of the table `test`."""

from collections.abc import Iterator
from typing import Literal

from rps_exudyn.parameters.declaration import (
    DEG,
    Angle,
    Count,
    Force,
    Frequency,
    Mass,
    Number,
    Speed,
    SpringRate,
    Table,
    Time,
    Torque,
    parameter,
)
from rps_exudyn.parameters.wrong_values import WrongValue, conflict


class Test(Table):
    """Motion and load of the rig."""

    __test__ = False  # not a test class of pytest

    speed: Speed = parameter("15 rpm", "speed of the pinion; in reversal its largest value", gt=0)
    turns: Number = parameter(1.0, "recorded revolutions", ge=0.001)
    direction: Literal[-1, 1] = parameter(1, "sense of rotation; +1 moves the rack along +X")
    start_angle: Angle = parameter(0.0, "pinion angle from the centre position at which recording starts")
    path: Literal["one-way", "there-and-back", "lock-to-lock"] = parameter(
        "one-way",
        "one-way: over test.turns; there-and-back: the same and back; lock-to-lock: over the rack's travel "
        "and back",
    )
    load_mass: Mass = parameter("10 kg", "weight at the rack's end in the load test", "paper", ge=0)
    amplitude: Angle = parameter("30 deg", "reversal: amplitude of the steering about start_angle", gt=0)
    cycles: Count = parameter(1, "reversal: number of full cycles", ge=1, le=100)
    pulse_force: Force = parameter("1.5 kN", "yoke-impact: peak of the half sine of force at the rack's end")
    pulse_axis: Literal["x", "y", "z"] = parameter(
        "y", "yoke-impact: direction of the pulse; y lifts the rack off the pinion"
    )
    pulse_duration: Time = parameter("5 ms", "yoke-impact: duration of a pulse", gt=0, le=1)
    pulse_period: Time = parameter("20 ms", "yoke-impact: time from pulse to pulse", gt=0, le=10)
    pulses: Count = parameter(1, "yoke-impact: number of pulses", ge=1, le=100)
    play_force: Force = parameter(
        "98 N", "radial-play: force across the rack at its end, in both directions", gt=0
    )
    road_force: Force = parameter(
        "1 kN", "rattle: peak of the road's force along the tie rod at the rack's end", gt=0
    )
    road_frequency: Frequency = parameter("20 Hz", "rattle: frequency of the road's force", ge=1, le=200)
    road_angle: Angle = parameter(
        "10 deg", "rattle: angle of the tie rod to the bar, away from the pinion", ge=-90 * DEG, le=90 * DEG
    )
    road_shape: Literal["sine", "half-sine", "growing-sine"] = parameter(
        "sine",
        "rattle: sine: force in both directions; half-sine: its positive halves; growing-sine: from zero to "
        "the peak, to find the threshold",
    )
    road_cycles: Count = parameter(
        4, "rattle: recorded cycles; the first cycle is discarded before them", ge=1, le=1000
    )
    road_phases: Count = parameter(
        2, "rattle: number of runs, which begin at different phases of the force", ge=1, le=100
    )
    band_low: Frequency = parameter(
        "100 Hz", "rattle: lower limit of the frequency band of the rack's acceleration", gt=0
    )
    band_high: Frequency = parameter(
        "1 kHz", "rattle: upper limit of the frequency band of the rack's acceleration", gt=0
    )
    centre_window: Angle = parameter(
        "100 deg", "range on either side of the centre that counts as on centre", gt=0
    )
    steer_torque: Torque = parameter("4 N*m", "steering-torque: peak of the hand's torque on the wheel", gt=0)
    steer_frequency: Frequency = parameter(
        "0.2 Hz", "steering-torque: frequency of the hand's torque", ge=0.001, le=5
    )
    steer_shape: Literal["sine", "ramp"] = parameter(
        "sine",
        "steering-torque: sine: to and fro; ramp: growing at a constant rate to the peak within a quarter of "
        "a cycle",
    )
    tyre_stiffness: SpringRate = parameter(
        0.0, "steering-torque: spring rate of the tyres along the rack; 0: no tyres", ge=0
    )
    cap_torque: Torque = parameter("4.9 N*m", "yoke-setting: torque to which the yokenut is tightened", gt=0)
    back_off: Angle = parameter(
        "25 deg", "yoke-setting: angle by which the tightened yokenut is turned back", ge=0
    )
    lift_torque: Torque = parameter(
        "19.6 N*m", "rack-lift: torque on the pinion in both directions, rack held", gt=0
    )
    shaft_force: Force = parameter(
        "98 N", "input-shaft-play: force across the input shaft's end, in both directions", gt=0
    )
    shaft_axial_force: Force = parameter(
        "49 N", "input-shaft-play: force along the input shaft, in both directions", gt=0
    )

    def conflicts(self) -> Iterator[WrongValue]:
        """Yield parameters that are each fine alone, but not together."""
        if self.band_low >= self.band_high:
            low, high = f"{self.band_low:g} Hz", f"{self.band_high:g} Hz"
            yield conflict(f"test.band_low is {low}; it must be below test.band_high = {high}.")
