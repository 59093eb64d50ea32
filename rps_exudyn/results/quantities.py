"""Every quantity a result may hold: name, unit, definition. Declared once, here.

A result with another name is refused when it is made, so that files, charts and the format's page
(docs/hdf5-format.md, which a test compares with this list) cannot drift apart. Directions are those of the
housing frame in `gears.gear_pair`: X the rack's travel, Y from the pinion to the rack, Z = X x Y.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from rps_exudyn.base import units

LEAST_SHOWN = {
    "N*m": 1e-7,
    "N": 1e-6,
    "N*s": 1e-9,
    "J": 1e-9,
    "mm": 1e-7,
    "um": 1e-4,
    "deg": 1e-6,
    "mrad": 1e-6,
    "mm/s": 1e-6,
    "%": 1e-4,
}
"""Display unit -> size below which a number means nothing: a millionth of what is measured in a small gear.
Equilibria are found to 1e-3 N, a hundred thousandth of their torque, and positions to rounding, 1e-17 m."""


LEAST_CHANGED = {"um": 1e-7, "mrad": 1e-6, "deg": 1e-5, "%": 1e-3}
"""Display unit -> size in SI below which the error of a metric counts as if it had that size."""
NOTHING = 1e-200  # size in SI of any other that is 0
LEAST_SHARE = 0.01  # the same where a run has a size of its own, of that size
FACE = 0.01  # face width of a small gear [m], beside which the error of a place counts
PART = 0.02  # of all work lost, or of a record's time, beside which the error of a share counts
IMPACTS = 30  # beside which the error of their number counts
SEEN = 5e-7  # smallest motion of the rack that is of interest [m], at the bar's surface and half a seat ...
LEVERS = {"rack_roll_range": 0.01, "rack_yaw_range": 0.1, "lost_motion_angle": 0.01}
"""... of turns about X and Y, and of the pinion's [m]."""


@dataclass(frozen=True)
class Quantity:
    """One number or signal: kept in the SI `unit`, shown in the unit `display`; "" is dimensionless.

    A metric is `simulated` unless a formula, a setting or a check gives it. `least` is the size below which
    its error counts as if it had that size: of a place the length that it is a place on, of a share a part of
    the whole.
    """

    unit: str
    display: str
    long_name: str
    simulated: bool = False
    least: float = 0.0

    @property
    def attributes(self) -> dict[str, str]:
        """Return what files and labelled arrays state of it: `units` and `long_name`."""
        return {"units": self.unit, "long_name": self.long_name}

    def size(self, value: Any, of_run: Any = 0.0) -> Any:
        """Return the size of a metric beside that of its run: its own value, or the least that matters."""
        least = max(self.least, LEAST_CHANGED.get(self.display, NOTHING))
        return np.maximum(np.abs(value), np.maximum(LEAST_SHARE * of_run, least))

    def show(self, value: float) -> str:
        """Return the value for a reader, for instance "0.593 N m"; counts are whole numbers.

        What is below `LEAST_SHOWN` is rounding, and shown as 0.
        """
        if isinstance(value, int):
            return str(value)
        number = self.displayed(value)
        if abs(number) < LEAST_SHOWN.get(self.display, 0.0):
            number = 0.0
        return f"{number:.4g} {units.pretty(self.display)}".strip()

    def displayed(self, values: Any) -> Any:
        """Return SI values, a number or an array of any shape, in the display unit."""
        return units.displayed(values, self.unit, self.display)

    def axis_label(self, name: str) -> str:
        """Return the label of an axis, for instance "pinion torque [N m]"."""
        unit = units.pretty(self.display)
        return f"{name} [{unit}]" if unit else name


def _torque(long_name: str) -> Quantity:
    return Quantity("N*m", "N*m", long_name)


def _deflection(long_name: str) -> Quantity:
    return Quantity("m", "um", long_name)


def _tilt(long_name: str) -> Quantity:
    return Quantity("rad", "mrad", long_name)


def _force(long_name: str) -> Quantity:
    return Quantity("N", "N", long_name)


def _energy(long_name: str) -> Quantity:
    return Quantity("J", "J", long_name)


def _length(long_name: str) -> Quantity:
    return Quantity("m", "mm", long_name)


def _line_stiffness(long_name: str) -> Quantity:
    return Quantity("N/m^2", "N/mm/um", long_name)


def _number(long_name: str) -> Quantity:
    return Quantity("", "", long_name)


def _ratio(long_name: str) -> Quantity:
    return Quantity("", "%", long_name)


SIGNALS = {
    "time": Quantity("s", "s", "time from the start of recording"),
    "pinion_angle": Quantity(
        "rad", "deg", "pinion angle from the centre position, positive for rack travel along +X"
    ),
    "pinion_torque": _torque(
        "torque that drives the pinion, about its axis of rotation, in the sense of pinion_angle"
    ),
    "rack_force": _force("force that drives the rack along X, where the rig moves the rack"),
    "wheel_angle": Quantity("rad", "deg", "angle of the steering wheel, in the sense of pinion_angle"),
    "wheel_torque": _torque("torque of the hand on the steering wheel, in the sense of wheel_angle"),
    "column_torque": _torque(
        "torque of the column on the steering wheel: wheel_torque without the wheel's inertia"
    ),
    "column_twist": Quantity("rad", "deg", "twist of column and torsion bar"),
    "housing_displacement": _deflection("displacement of the housing on its mounts along X, behind a column"),
    "tyre_force": _force("force of the tyres' spring on the rack along +X"),
    "load_force": _force("force that pulls the rack's end towards -X"),
    "road_force": _force("force of the road along the tie rod on the rack's end beside the pinion"),
    "end_force_y": _force("force of the rig across the rack's end beside the pinion, along Y"),
    "end_force_z": _force("force of the rig across the rack's end beside the pinion, along Z"),
    "shaft_force_across": _force(
        "force of the rig across the input shaft's end along e, perpendicular to Y and the shaft"
    ),
    "shaft_force_y": _force("force of the rig across the input shaft's end along Y"),
    "shaft_force_axial": _force("force of the rig along the input shaft, away from the lower bearing"),
    "shaft_end_across": _deflection("displacement of the input shaft's end along e"),
    "shaft_end_y": _deflection("displacement of the input shaft's end along Y"),
    "shaft_end_axial": _deflection("displacement of the input shaft's end along the shaft"),
    "pinion_across": _deflection("displacement of a supported pinion's axis in the mesh along e"),
    "pinion_y": _deflection("displacement of a supported pinion's axis in the mesh along Y"),
    "pinion_axial": _deflection("displacement of a supported pinion along its axis, towards the input shaft"),
    "rack_displacement": _length("displacement of the rack's reference point along X"),
    "rack_y": _deflection(
        "lift of the bar's axis above the pitch point along Y, away from the pinion, from the design position"
    ),
    "rack_z": _deflection("displacement of the bar's axis above the pitch point along Z"),
    "rack_roll": _tilt("rotation of the rack about X"),
    "rack_yaw": _tilt("rotation of the rack about Y"),
    "rack_pitch": _tilt("rotation of the rack about Z"),
    "rack_end_y": _length("displacement of the bar's axis at its end beside the pinion along Y"),
    "rack_end_z": _length("displacement of the bar's axis at its end beside the pinion along Z"),
    "rack_bush_y": _deflection(
        "displacement of the bar's axis in the bush along Y, where the bar bends or is bent"
    ),
    "rack_bush_z": _deflection(
        "displacement of the bar's axis in the bush along Z, where the bar bends or is bent"
    ),
    "plunger_displacement": _deflection(
        "displacement of the plunger along Y, towards the yokenut, from its rest position"
    ),
    "mesh_normal_force": _force("sum of the normal forces between the teeth, both flanks"),
    "mesh_normal_force_drive": _force("sum of the normal forces on the flanks that drive the rack along +X"),
    "mesh_normal_force_coast": _force("sum of the normal forces on the flanks that drive the rack along -X"),
    "mesh_penetration": _deflection("deepest penetration of the teeth"),
    "mesh_pressure": Quantity(
        "Pa", "MPa", "largest Hertzian pressure on the lines of contact; for law teeth away from their ends"
    ),
    "seat_force": _force("force of the plunger on the rack along -Y, without the seat's friction"),
    "yokenut_force": _force(
        "contact force of the yokenut on the plunger along -Y, 0 while there is clearance"
    ),
    "bore_force": _force("force against the plunger's motion in its bore, along -Y"),
    "bush_force": _force("magnitude of the bush's force on the rack across X"),
    "upper_bearing_force": _force("radial force of the upper bearing on a supported pinion"),
    "lower_bearing_force": _force("radial force of the lower bearing on a supported pinion"),
    "axial_bearing_force": _force("force of a supported pinion on its axial stops, towards the input shaft"),
    "work_drive": _energy("work of the drive on pinion or rack from the start of recording"),
    "work_load": _energy("work of the forces on rack's end and input shaft from the start of recording"),
    "work_mesh_friction": _energy("work lost to friction between the teeth from the start of recording"),
    "work_mesh_edges": _energy(
        "work lost at the rack's tooth edges, where loaded material leaves the contact, from the start of "
        "recording"
    ),
    "work_mesh_damping": _energy("work lost to damping of the tooth contact from the start of recording"),
    "work_seat_friction": _energy(
        "work lost to friction between plunger and rack from the start of recording"
    ),
    "work_seat_damping": _energy("work lost to damping of the seat from the start of recording"),
    "work_yokenut_damping": _energy("work lost to damping of the yokenut from the start of recording"),
    "work_bore_friction": _energy(
        "work lost to friction of the plunger in its bore from the start of recording"
    ),
    "work_bore_damping": _energy(
        "work lost to damping of the plunger in its bore from the start of recording"
    ),
    "work_bush_friction": _energy("work lost to the bush's drag from the start of recording"),
    "work_bearing_friction": _energy("work lost to the pinion's bearings from the start of recording"),
    "work_support_friction": _energy(
        "work lost to friction against a supported pinion's axial motion from the start of recording"
    ),
    "work_rack_damping": _energy("work lost to the damping of a flexible rack from the start of recording"),
    "work_column_damping": _energy("work lost to the column's damping from the start of recording"),
    "column_energy": _energy("elastic energy of column and mounts; part of stored_energy"),
    "bending_energy": _energy("elastic energy of a flexible rack's bending; part of stored_energy"),
    "stored_energy": _energy(
        "kinetic energy, and elastic energy of springs and contacts, from the start of recording"
    ),
}

_SUMMARY = {
    "torque_mean": _torque("mean of pinion_torque over the recorded pinion angle"),
    "torque_peak_to_peak": _torque("largest minus smallest pinion_torque"),
    "torque_tooth_order": _torque("amplitude of pinion_torque's harmonic once per tooth"),
    "torque_first_order": _torque("amplitude of pinion_torque's harmonic once per revolution"),
    "torque_closed_form": _torque("free pinion torque by the closed form, for comparison with torque_mean"),
    "torque_mean_forward": _torque(
        "mean torque against the motion towards +X, over the pinion angles that both directions cover"
    ),
    "torque_mean_backward": _torque(
        "mean torque against the motion towards -X, over the pinion angles that both directions cover"
    ),
    "torque_direction_difference": _torque("torque_mean_forward - torque_mean_backward"),
    "torque_on_centre": _torque(
        "mean torque against the motion in the on-centre range (within test.centre_window of the centre)"
    ),
    "torque_on_centre_max": _torque("largest torque in the on-centre range"),
    "torque_on_centre_variation": _torque(
        "largest minus smallest torque in the on-centre range, in one direction"
    ),
    "torque_off_centre": _torque("mean torque against the motion outside the on-centre range"),
    "torque_off_centre_max": _torque("largest torque outside the on-centre range"),
    "torque_off_centre_variation": _torque(
        "largest minus smallest torque on one side of the on-centre range, in one direction"
    ),
    "torque_forward": _torque(
        "load test: mean pinion_torque over whole tooth pitches while the load is raised"
    ),
    "torque_reverse": _torque(
        "load test: mean pinion_torque that holds the load while it is lowered; negative if the gear is "
        "self-locking"
    ),
    "free_torque": _torque(
        "load test: mean torque against the motion over whole tooth pitches without the load"
    ),
    "efficiency_forward": _ratio("load x rack gain per radian / torque_forward"),
    "efficiency_reverse": _ratio(
        "torque_reverse / (load x rack gain per radian); negative if the gear is self-locking"
    ),
    "efficiency_forward_net": _ratio("load x rack gain per radian / (torque_forward - free_torque)"),
    "efficiency_reverse_net": _ratio(
        "(torque_reverse + free_torque) / (load x rack gain per radian); above 100 % if friction is smaller "
        "under load"
    ),
    "efficiency_ratio": _ratio("efficiency_reverse / efficiency_forward"),
    "face_load_factor": _number(
        "face load factor K_H-beta: largest over mean load along the face, from the contact forces"
    ),
    "load_centre": _length("centre of the load along the pinion's axis, from the middle of the face"),
    "contact_pressure_max": Quantity(
        "Pa", "MPa", "largest Hertzian pressure on the flanks, away from the ends of the lines of contact"
    ),
    "push_force_mean": _force(
        "mean force along the motion that moves the rack, over the rack's displacement"
    ),
    "push_force_peak_to_peak": _force("largest minus smallest force that moves the rack, in one direction"),
    "roller_force_mean": _force(
        "mean force along the motion that moves the rack on rollers in the pinion's place"
    ),
    "rack_gain": _length("displacement of the rack per revolution of the pinion"),
    "transmission_error_peak_to_peak": _deflection(
        "largest minus smallest rack displacement ahead of gain x pinion angle, in one direction"
    ),
    "transmission_error_first_order": _deflection(
        "amplitude of the transmission error's harmonic once per revolution"
    ),
    "rack_end_deflection": _length(
        "largest displacement across X of the bar's end beside the pinion, where the bar bends"
    ),
    "rack_lift_range": _deflection("largest minus smallest rack_y"),
    "rack_roll_range": _tilt("largest minus smallest rack_roll"),
    "rack_yaw_range": _tilt("largest minus smallest rack_yaw"),
    "yoke_force_min": _force("smallest seat_force"),
    "yoke_force_max": _force("largest seat_force"),
    "hysteresis_area": _energy("work of the drive on the pinion over the last whole cycle of reversals"),
    "lost_motion": _deflection(
        "difference of the rack displacement between motion towards -X and +X at equal pinion angle, mean "
        "over the middle"
    ),
    "lost_motion_angle": Quantity(
        "rad",
        "mrad",
        "lost_motion over the rack's travel per radian; negative if the rack leads after a reversal",
    ),
    "torque_jump": _torque(
        "largest change of pinion_torque across a reversal, between the medians of both passes"
    ),
    "reversal_angle": Quantity(
        "rad",
        "deg",
        "largest pinion angle from a reversal until the torque reaches 90 % of its new running value",
    ),
    "feel_area": _energy("work of column_torque over the last whole cycle of the wheel"),
    "feel_running_torque": _torque(
        "column_torque against the motion, mean over the later half of each pass of the wheel"
    ),
    "feel_angle_hysteresis": Quantity(
        "rad",
        "deg",
        "mean wheel angle from a reversal until column_torque reaches 90 % of feel_running_torque",
    ),
    "on_centre_stiffness": Quantity(
        "N*m/rad",
        "N*m/deg",
        "mean slope of column_torque over wheel_angle after a reversal, between -50 and +50 % of the running "
        "torque",
    ),
    "angle_dead_band": Quantity(
        "rad", "deg", "steering-torque: width of the loop of column_torque over wheel_angle at zero torque"
    ),
    "torque_dead_band": _torque(
        "steering-torque: height of the loop of column_torque over wheel_angle at its middle angle"
    ),
    "steering_gradient": Quantity(
        "N*m/rad",
        "N*m/rad",
        "steering-torque: slope of column_torque over wheel_angle at the loop's middle, mean of both "
        "directions",
    ),
    "breakaway_torque": _torque(
        "largest column_torque against the motion after a reversal, mean over the reversals; with a ramp: "
        "column_torque less the torque of the tyres when the pinion starts to move"
    ),
    "breakaway_ratio": _number("breakaway_torque over feel_running_torque"),
    "stick_slip_amplitude": Quantity(
        "rad", "deg", "stick-slip: half the range of column_twist over the later half of the record"
    ),
    "stick_slip_torque": _torque(
        "stick-slip: half the range of column_torque over the later half of the record"
    ),
    "stick_slip_frequency": Quantity(
        "Hz",
        "Hz",
        "stick-slip: frequency of the pinion's speed over the later half of the record, if it sticks there",
    ),
    "stick_share": _ratio(
        "stick-slip: share of the record's later half in which the pinion turns at less than 2 % of "
        "test.speed"
    ),
    "sticking_speed": Quantity(
        "rad/s",
        "rad/s",
        "largest wheel speed at which the gear, reduced to one inertia, sticks",
    ),
    "sliding_damping": Quantity(
        "N*m*s/rad",
        "N*m*s/rad",
        "damping of the column below which steady sliding of the whole gear at test.speed is unstable",
    ),
    "bristle_margin": _number("positive if steady sliding at test.speed is stable with bristles"),
    "impacts": _number("number of impacts of the plunger on the yokenut"),
    "impact_peak_force": _force("largest yokenut_force of an impact"),
    "impact_impulse": Quantity("N*s", "N*s", "largest integral of yokenut_force over an impact"),
    "impact_duration": Quantity("s", "ms", "duration of the longest impact"),
    "impact_speed": Quantity("m/s", "mm/s", "largest speed of the plunger at the beginning of an impact"),
    "impact_contact_share": _ratio("share of the time with contact between plunger and yokenut"),
    "impact_force_rms": _force("root mean square of yokenut_force over the record"),
    "input_shaft_play_radial": _deflection(
        "input shaft play: displacement of the shaft's end between test.shaft_force in both directions, "
        "along "
        "e or Y, the larger"
    ),
    "input_shaft_play_axial": _deflection(
        "input shaft play: displacement along the shaft between test.shaft_axial_force in both directions"
    ),
    "radial_play_y": _deflection(
        "radial play: displacement of the rack's end under the largest force along Y, the larger of both "
        "directions"
    ),
    "radial_play_z": _deflection(
        "radial play: displacement of the rack's end under the largest force along Z, the larger of both "
        "directions"
    ),
    "radial_play_up": _deflection(
        "radial play: displacement of the rack's end along Y, away from the pinion"
    ),
    "radial_play_down": _deflection(
        "radial play: displacement of the rack's end along Y, towards the pinion"
    ),
    "radial_play_side": _deflection("radial play: displacement of the rack's end along Z"),
    "radial_play_other_side": _deflection("radial play: displacement of the rack's end along -Z"),
    "rack_lift": _deflection(
        "rack lift: rise of rack_y under the largest torque, the larger of both directions"
    ),
    "rack_lift_forward": _deflection(
        "rack lift: rise of rack_y under the torque in the sense of the pinion angle"
    ),
    "rack_lift_backward": _deflection("rack lift: rise of rack_y under the torque against the pinion angle"),
    "rack_lift_closed_form": _deflection("rack lift by the closed form, for comparison with rack_lift"),
    "rack_lift_end": _deflection("rack lift: rise of the rack's end, the larger of both directions"),
    "cap_force": _force("yoke setting: force of the tightened yokenut along its axis"),
    "clearance_set": _deflection(
        "yoke setting: clearance after the yokenut is turned back; negative if it still presses"
    ),
    "preload_set": _force("yoke setting: spring force at the rest position after the yokenut is turned back"),
    "operating_preload": _force("yoke's preload at the gear's temperature and wear"),
    "operating_clearance": _deflection("yoke's clearance at the gear's temperature and wear"),
    "operating_yoke_friction": _number(
        "friction coefficient between plunger and rack at the gear's temperature"
    ),
    "operating_viscous_drag": Quantity(
        "N*s/m", "N*s/m", "viscous drag coefficient of the rack at the gear's temperature"
    ),
    "operating_bush_clearance": _deflection(
        "diametral clearance of the bar in the bush at the gear's temperature"
    ),
    "operating_bush_drag": _force("Coulomb drag of the bush at the gear's temperature"),
    "wear_liner": _deflection("depth worn off the liner of the plunger's seat, along the yoke's axis"),
    "wear_teeth": _deflection("approach of the rack to the pinion by the wear of the flanks"),
    "rattle_impulse_per_cycle": Quantity(
        "N*s",
        "N*s",
        "rattle: integral of yokenut_force over a cycle of the road's force, mean over the cycles",
    ),
    "rattle_impulse_uncertainty": Quantity(
        "N*s", "N*s", "standard uncertainty of rattle_impulse_per_cycle, from its scatter over the cycles"
    ),
    "rattle_force_rms": _force("rattle: root mean square of yokenut_force over the recorded cycles"),
    "rattle_force_rms_uncertainty": _force(
        "standard uncertainty of rattle_force_rms, from its scatter over the cycles"
    ),
    "rattle_speed_rms": Quantity(
        "m/s", "mm/s", "rattle: root mean square of the plunger's speed at the beginning of its impacts"
    ),
    "rattle_energy_per_cycle": _energy(
        "rattle: kinetic energy of the plunger at the beginning of its impacts, sum over a cycle, mean over "
        "cycles"
    ),
    "rattle_energy_uncertainty": _energy(
        "standard uncertainty of rattle_energy_per_cycle, from its scatter over the cycles"
    ),
    "rattle_acceleration_rms": Quantity(
        "m/s^2",
        "m/s^2",
        "rattle: root mean square of the acceleration of rack_y between test.band_low and test.band_high",
    ),
    "rattle_impacts_per_cycle": _number(
        "rattle: number of impacts in a cycle, mean over the phases; chaotic"
    ),
    "rattle_impacts_scatter": _number("standard deviation of rattle_impacts_per_cycle over the phases"),
    "rattle_fastest_impact": Quantity(
        "m/s", "mm/s", "rattle: largest speed of the plunger at an impact, mean over the phases; chaotic"
    ),
    "rattle_threshold_force": _force(
        "amplitude of a growing road force at the first hit of the yokenut, mean over the phases"
    ),
    "rattle_threshold_scatter": _force("standard deviation of rattle_threshold_force over the phases"),
    "rattle_fastest_scatter": Quantity(
        "m/s", "mm/s", "standard deviation of rattle_fastest_impact over the phases"
    ),
    "loss_share_mesh": _ratio("work lost between the teeth over all work lost"),
    "loss_share_seat": _ratio("work lost between plunger and rack over all work lost"),
    "loss_share_yokenut": _ratio("work lost to damping of the yokenut over all work lost"),
    "loss_share_bore": _ratio("work lost by the plunger in its bore over all work lost"),
    "loss_share_bush": _ratio("work lost in the bush over all work lost"),
    "loss_share_bearing": _ratio("work lost in the pinion's bearings over all work lost"),
    "loss_share_support": _ratio("work lost to axial friction of a supported pinion over all work lost"),
    "loss_share_column": _ratio("work lost to damping of the steering column over all work lost"),
    "loss_share_rack": _ratio("work lost to damping of a flexible rack over all work lost"),
    "energy_residual": _ratio(
        "(work_drive + work_load - work lost - change of stored_energy) / larger range of work_drive and "
        "work_load"
    ),
}

_NOT_FROM_STEPS = {
    "torque_closed_form", "rack_lift_closed_form", "cap_force", "clearance_set", "preload_set",
    "sticking_speed", "sliding_damping", "bristle_margin", "energy_residual",
}  # fmt: skip


RACK_RANGES = "rack_lift_range", "rack_roll_range", "rack_yaw_range"
SPREADS = frozenset(
    name
    for name in _SUMMARY
    if name.endswith(("_peak_to_peak", "_range", "_variation")) or name == "torque_tooth_order"
)
"""Metrics of how far a signal varies, which vibration and the start of a motion change before its mean."""
EXTREMES = frozenset(name for name in _SUMMARY if name.endswith(("_min", "_max")))
"""Metrics that one instant of a signal gives, which vibration changes as it does what varies."""
FIRST_ORDERS = frozenset(name for name in _SUMMARY if name.endswith("_first_order"))
"""Metrics of what repeats with the turn, which may be small beside what is left of the start."""
MOTIONS = frozenset(
    name for name in _SUMMARY if name.startswith("transmission_error_") or name in RACK_RANGES
)
"""Metrics of motions beside the travel, of micrometres."""
LOST_MOTIONS = frozenset({"lost_motion", "lost_motion_angle"})
"""Metrics of how far the rack stays behind between both directions."""
WANDERING = MOTIONS | LOST_MOTIONS | {"reversal_angle"}
"""Metrics of a swing that small motions make, which may go on to change when its torque has settled."""
INSTANTS = {
    "torque_peak_to_peak": "pinion_torque", "torque_on_centre_max": "pinion_torque",
    "torque_on_centre_variation": "pinion_torque", "torque_off_centre_max": "pinion_torque",
    "torque_off_centre_variation": "pinion_torque", "push_force_peak_to_peak": "rack_force",
    "transmission_error_peak_to_peak": "transmission_error", "rack_lift_range": "rack_y",
    "rack_roll_range": "rack_roll", "rack_yaw_range": "rack_yaw", "yoke_force_min": "seat_force",
    "yoke_force_max": "seat_force",
}  # fmt: skip
"""Metric that one or two instants give -> its signal: an error of any instant may be its error."""
LOSS_SHARES = frozenset(name for name in _SUMMARY if name.startswith("loss_share_"))
"""Metrics of who takes the work, which depend on how lines of contact share the load at each instant."""
SCATTERS = {
    "rattle_impulse_per_cycle": "rattle_impulse_uncertainty",
    "rattle_force_rms": "rattle_force_rms_uncertainty",
    "rattle_energy_per_cycle": "rattle_energy_uncertainty",
    "rattle_impacts_per_cycle": "rattle_impacts_scatter",
    "rattle_fastest_impact": "rattle_fastest_scatter",
    "rattle_threshold_force": "rattle_threshold_scatter",
}
"""Metric -> that which states how it scatters, printed with it."""


def _least(name: str) -> float:
    """Return the size below which the error of a metric counts as if it had that size [SI]."""
    if name in MOTIONS | LOST_MOTIONS:
        return SEEN / LEVERS.get(name, 1.0)
    if name == "load_centre":
        return FACE
    if name == "impacts":
        return IMPACTS
    return PART if name.startswith("loss_share_") or name == "stick_share" else 0.0


SUMMARY = {
    name: replace(
        each,
        simulated=name not in _NOT_FROM_STEPS and not name.startswith(("operating_", "wear_")),
        least=_least(name),
    )
    for name, each in _SUMMARY.items()
}

COUNTERS = {
    "steps": _number("time steps, or positions of equilibrium"),
    "newton_iterations": _number("Newton iterations"),
    "jacobians": _number("Jacobians computed"),
    "restarts": _number("restarts of dynamics in shorter steps, after a jump or a step without convergence"),
    "force_evaluations": _number("evaluations of the mesh contact"),
    "solver_cpu": Quantity("s", "s", "CPU time of the solver, without set-up and evaluation"),
}

GEOMETRY = {
    "reference_diameter": _length("reference (pitch) diameter of the pinion"),
    "base_diameter": _length("base diameter"),
    "form_diameter": _length("form diameter, at which the involute begins"),
    "root_diameter": _length("root diameter"),
    "tip_diameter": _length("tip diameter"),
    "pointed_diameter": _length("diameter at which the teeth would be pointed"),
    "crest_width": _length("normal thickness of the teeth at the tip"),
    "travel_per_turn": _length("rack travel per turn of the pinion"),
    "shaft_angle": Quantity("rad", "deg", "shaft angle as installed"),
    "transverse_contact_ratio": _number("transverse contact ratio"),
    "overlap_ratio": _number("overlap ratio"),
    "total_contact_ratio": _number("total contact ratio"),
    "contact_start": _length("start of the path of contact, from the pitch point (recess positive)"),
    "contact_end": _length("end of the path of contact, from the pitch point (recess positive)"),
    "undercut_limit": _number("least profile shift coefficient without undercut"),
    "undercut_margin": _number("profile shift coefficient minus undercut_limit"),
    "pinion_root_clearance": _length("clearance of the rack's tips over the pinion's root"),
    "rack_root_clearance": _length("clearance of the pinion's tips over the rack's root"),
    "interference": _length("deepest cut of pinion and rack into each other's roots over a turn"),
    "rack_face_width": _length("face width of the rack at the pinion's pitch line (bar's chord)"),
    "rack_tip_face_width": _length("face width of the rack at its tips"),
    "toothed_length": _length("toothed length of the rack"),
    "single_stiffness": _line_stiffness("stiffness c' of a pair of teeth per face width, by ISO 6336-1"),
    "mesh_stiffness": _line_stiffness(
        "mean stiffness c_gamma_alpha of the mesh per face width, by ISO 6336-1"
    ),
}

GROUPS = {"signals": SIGNALS, "summary": SUMMARY, "counters": COUNTERS, "geometry": GEOMETRY}
"""Group of the HDF5 file -> what it may hold."""

COLUMNS = GROUPS | {
    "summary": {
        column: quantity
        for name, each in SUMMARY.items()
        for column, quantity in (
            (name, each),
            (f"{name}_error", Quantity(each.unit, each.display, f"numerical error of {name}")),
        )
    }
}
"""Group of a table of many results -> its columns: beside each number of the summary stands its error."""


def is_work(name: str) -> bool:
    """Return whether a signal counts energy from the start of recording."""
    return name.startswith("work_") or name == "stored_energy"


LABELS = {
    "torque_mean": "mean torque",
    "torque_peak_to_peak": "ripple, peak to peak",
    "torque_mean_backward": "mean torque towards -X",
    "torque_mean_forward": "mean torque towards +X",
    "torque_forward": "mean torque that moves the load",
    "push_force_mean": "mean force on the rack",
    "roller_force_mean": "mean force on the rack",
    "hysteresis_area": "work of a whole cycle",
    "torque_jump": "jump of the torque across a reversal",
    "reversal_angle": "angle of the reversal",
    "feel_area": "work of a whole cycle at the wheel",
    "feel_running_torque": "running torque at the wheel",
    "breakaway_torque": "breakaway torque",
    "on_centre_stiffness": "stiffness on centre",
    "stick_slip_torque": "amplitude of the torque",
    "stick_share": "share of time at rest",
    "efficiency_forward": "efficiency, pinion drives",
    "efficiency_reverse": "efficiency, rack drives",
    "impact_peak_force": "largest force of an impact",
    "impacts": "impacts",
    "impact_speed": "largest speed of an impact",
    "rattle_force_rms": "force on the yokenut, root mean square",
    "rattle_impacts_per_cycle": "impacts in a cycle",
    "rattle_threshold_force": "force of the road at the first impact",
    "rack_lift": "lift of the rack",
    "rack_lift_end": "rise of the rack's end",
    "radial_play_y": "radial play along Y",
    "radial_play_z": "radial play along Z",
    "input_shaft_play_radial": "radial play of the input shaft",
    "input_shaft_play_axial": "axial play of the input shaft",
    "push_force_peak_to_peak": "ripple, peak to peak",
    "torque_first_order": "amplitude once per revolution",
    "rack_gain": "rack travel per revolution",
    "torque_on_centre": "mean torque on centre",
}
"""Numbers that a sheet shows, in the order of their weight -> their names there."""

PARTS = {
    "mesh": "teeth",
    "seat": "yoke",
    "yokenut": "yokenut",
    "bore": "plunger in its bore",
    "bush": "bush",
    "bearing": "bearings",
    "support": "pinion along its axis",
    "column": "column",
    "rack": "bending rack",
}
"""Where work is lost, as `loss_share_PART` has it -> the part's name for readers."""
