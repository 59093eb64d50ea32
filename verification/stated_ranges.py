"""Ranges that do not follow from a parameter's declaration, for random gears and models of any kind.

They are wider than what is built: the whole width in which a user may look for a limit. Lengths and forces
are those of a gear of the default's module; parts that must fit others are drawn as shares of these.
"""

from collections.abc import Mapping

import numpy as np

from rps_exudyn.parameters.gear import SteeringGear
from verification.ranges import Choice, Drawn, Even, Logarithmic, Range, Seldom, Share, Where, Whole

DEG = np.pi / 180
RPM = np.pi / 30
MODULE = SteeringGear().pinion.normal_module  # of the gear whose size the ranges have
SCALE = Logarithmic(0.3e-3 / MODULE, 20e-3 / MODULE)  # modules of 0.3 to 20 mm
USUAL_SCALE = Even(0.85, 1.25)  # modules of 1.6 to 2.3 mm
USUAL_SHARE = 0.6  # of the gears are of usual size

TEETH: dict[str, Range] = {
    "basic_rack.addendum": Even(0.7, 1.0),
    "basic_rack.dedendum": Share(Even(1.2, 1.5), lambda drawn: drawn["basic_rack.addendum"]),
    "basic_rack.fillet_radius": Share(Even(0.3, 0.95), lambda drawn: _largest_fillet(drawn)),
    "pinion.teeth": Whole(4, 16),
    "pinion.normal_module": Even(MODULE, MODULE),  # the scale makes others of it
    "pinion.pressure_angle": Even(16 * DEG, 28 * DEG),
    "pinion.helix_angle": Even(-40 * DEG, 40 * DEG),
    "pinion.profile_shift": Even(0.01, 0.6),  # above the least without undercut
    "pinion.tip_diameter": Even(0.35, 0.95),  # of the way from the form circle to the point
    "rack.tooth_angle": Even(-25 * DEG, 25 * DEG),
}

ERRORS: dict[str, Range] = {
    "pinion.runout": Seldom(0.35, Even(0, 60e-6)),
    "pinion.runout_angle": Even(0, 2 * np.pi),
    "pinion.tip_relief": Seldom(0.25, Even(0, 30e-6)),
    "pinion.tip_relief_length": Even(0.2e-3, 1.2e-3),
    "pinion.crowning": Seldom(0.25, Even(0, 15e-6)),
    # a grid and a surface are those of one gear: none fits the next one drawn
    **dict.fromkeys(
        (f"{part}.{file}" for part in ("pinion", "rack") for file in ("deviation", "surface")),
        Choice({"none": 1}),
    ),
    # a course fits the one pinion that it is made for
    **dict.fromkeys(("rack.ratio.centre", "rack.ratio.lock"), Even(0, 0)),
    **dict.fromkeys(("rack.ratio.angle", "rack.ratio.travel_per_turn"), Choice({"none": 1})),
    "pinion.pitch_errors": Choice({"none": 6, "ISO 1328 class 7, seed 3": 1}),
    "rack.back_parallelism": Seldom(0.1, Even(-3e-4, 3e-4)),
    "rack.pitch_errors": Choice({"none": 6, "ISO 1328 class 7, seed 3": 1}),
    "pinion.pitch_error": Seldom(0.25, Even(-15e-6, 15e-6)),
    "pinion.lead_error": Seldom(0.25, Even(-20e-6, 20e-6)),
    "pinion.profile_slope": Seldom(0.25, Even(-15e-6, 15e-6)),
    "installation.angle_error": Seldom(0.3, Even(-0.8 * DEG, 0.8 * DEG)),
    "installation.axis_offset": Seldom(0.3, Even(-1e-3, 0.1e-3)),
    "installation.gravity": Seldom(0.3, Even(-9.81, 9.81)),
    "installation.gravity_angle": Seldom(0.5, Even(-np.pi, np.pi)),
    "installation.gravity_slope": Seldom(0.5, Even(-20 * DEG, 20 * DEG)),
}

LAWS: dict[str, Range] = {
    "friction_law": Choice({"coulomb": 2, "stribeck": 1, "bristle": 1}),
    "static_ratio": Even(1.0, 1.5),
    "stribeck_speed": Logarithmic(1e-3, 1e-2),
    "bristle_damping": Seldom(0.5, Logarithmic(1e-5, 1e-3)),
}

PARTS: dict[str, Range] = {
    "rack.reference_height": Share(Even(0.35, 0.92), lambda drawn: _radius_below_teeth(drawn)),
    "rack.travel": Even(0.06, 0.2),
    "rack.modes": Whole(1, 10),
    "rack.modal_damping": Logarithmic(1e-3, 0.1),
    "rack.bow": Seldom(0.3, Even(0, 0.3e-3)),
    "rack.bow_angle": Even(0, 2 * np.pi),
    "rack.side_force": Seldom(0.2, Even(-200, 200)),
    "rack.side_angle": Even(0, 2 * np.pi),
    "yoke.preload": Logarithmic(50, 900),
    "yoke.spring_rate": Logarithmic(5e3, 3e5),
    "yoke.clearance": Even(0, 0.15e-3),
    "yoke.friction": Even(0.02, 0.3),
    "yoke.seat_angle": Even(10 * DEG, 65 * DEG),
    "yoke.seat_length": Share(Even(0.2, 0.95), lambda drawn: _longest_seat(drawn)),
    "yoke.seat_stiffness": Logarithmic(7e6, 2e9),
    "yoke.plunger_diameter": Share(Even(1.0, 1.6), lambda drawn: drawn["rack.bar_diameter"]),
    "yoke.bore_clearance": Seldom(0.2, Even(0, 0.1e-3)),
    "yoke.bore_friction": Seldom(0.2, Even(0, 50)),
    "yoke.bore_damping": Seldom(0.1, Logarithmic(1, 100)),
    "yoke.seat_clearance": Seldom(0.2, Even(5e-6, 0.1e-3)),
    "yoke.seat_form": Where(
        lambda drawn: drawn["yoke.seat_clearance"] > 0 and drawn["yoke.seat_angle"] > 46 * DEG,
        Choice({"round": 1, "gothic": 1}),
        "round",
    ),
    "yoke.seat_damping": Seldom(0.1, Logarithmic(1e-7, 1e-5)),
    "yoke.nut_damping": Seldom(0.2, Logarithmic(1e-7, 1e-4)),
    "yoke.nut_diameter": Share(Even(1.0, 1.4), lambda drawn: drawn["yoke.plunger_diameter"]),
    "yoke.nut_stiffness": Logarithmic(1e6, 1e9),
    "yoke.plunger_mass": Logarithmic(0.02, 0.6),
    "bush.inner_diameter": Share(Even(1.01, 1.2), lambda drawn: drawn["rack.bar_diameter"]),
    "bush.outer_diameter": Share(Even(1.1, 1.6), lambda drawn: drawn["bush.inner_diameter"]),
    "bush.youngs_modulus": Logarithmic(3e7, 7e10),
    "bush.poisson_ratio": Even(0, 0.45),
    "bush.segments": Whole(1, 40),
    "bush.drag": Even(0, 80),
    "bush.viscous_drag": Seldom(0.2, Logarithmic(10, 3000)),
    "bush.clearance": Seldom(0.15, Even(5e-6, 0.1e-3)),
    "bush.interference": Where(
        lambda drawn: not drawn["bush.clearance"], Seldom(0.15, Even(20e-6, 0.2e-3)), 0.0
    ),
    "bush.end_overhang": Share(Even(0.2, 2.0), lambda drawn: drawn["rack.bar_diameter"]),
    "bush.distance": Share(Even(0.5, 1.0), lambda drawn: _farthest_bush(drawn)),
    "bearing.friction_torque": Even(0, 0.1),
    "bearing.friction": Seldom(0.2, Even(0, 0.1)),
    "bearing.upper_position": Share(Even(0.8, 2.5), lambda drawn: drawn["pinion.face_width"]),
    "bearing.lower_position": Share(Even(-2.5, -0.8), lambda drawn: drawn["pinion.face_width"]),
    "bearing.upper_clearance": Seldom(0.1, Even(0, 30e-6)),
    "bearing.lower_clearance": Seldom(0.1, Even(0, 30e-6)),
    "pinion.axial_float": Seldom(0.1, Even(0, 0.1e-3)),
    "pinion.axial_friction": Seldom(0.3, Even(0, 50)),
    "housing.seat_stiffness": Choice(
        {"none": 4, "5e8, 5e8, 5e8, 5e5, 5e5, 5e5": 1}  # of the default gear's size in all sizes
    ),
    **{
        f"{part}.{name}": range_
        for part in ("yoke", "bush", "bearing", "mesh")
        for name, range_ in LAWS.items()
    },
    "mesh.law": Choice({"by-scene": 1, "line": 1, "teeth": 1}),
    "mesh.friction": Even(0.02, 0.3),
    "mesh.stiffness": Logarithmic(3e12, 2e14),
    "mesh.damping": Seldom(0.25, Logarithmic(1e-6, 1e-3)),
    "mesh.line_stiffness": Seldom(0.5, Even(5e9, 25e9)),  # else from the gear
}

CONDITIONS: dict[str, Range] = {
    "yoke.plunger_expansion": Choice({23e-6: 3, 115e-6: 1}),
    "grease.base_oil": Choice({"none": 4, "PAO 32": 1, "VG 68": 0.3, "VG 100": 0.3, "VG 150": 0.3}),
    "conditions.temperature": Choice({293.15: 6, 253.15: 1, 313.15: 1}),
    "conditions.steering_cycles": Seldom(0.2, Logarithmic(1e3, 1e6)),
    "conditions.spring_set": Seldom(0.2, Even(0, 0.1)),
}

COLUMN: dict[str, Range] = {
    "column.joint_angle": Seldom(0.3, Even(0, 45 * DEG)),
    "column.joint_phase": Even(0, 2 * np.pi),
    "housing.mount_stiffness": Seldom(0.2, Logarithmic(1e6, 3e7)),
}

TEST: dict[str, Range] = {
    "test.speed": Logarithmic(0.5 * RPM, 250 * RPM),
    "test.turns": Choice({0.3: 1, 0.5: 2, 1: 3, 1.7: 2, 2: 1, 3: 1, 6.4: 1}),  # pitches
    "test.start_angle": Seldom(0.7, Even(-0.9, 0.9)),  # of the way to the end of the teeth
    "test.path": Choice({"one-way": 8, "there-and-back": 2, "lock-to-lock": 1}),
    "test.load_mass": Logarithmic(1, 60),
    "test.amplitude": Logarithmic(2 * DEG, 90 * DEG),
    "test.cycles": Whole(1, 2),
    "test.pulses": Whole(1, 2),
    "test.tyre_stiffness": Logarithmic(2e4, 4e5),
    "test.steer_torque": Even(1.2, 5.0),  # of the gear's friction
    "test.steer_frequency": Logarithmic(0.02, 2.0),
    "test.road_angle": Even(-20 * DEG, 20 * DEG),
    "test.road_cycles": Whole(1, 2),
    "test.road_phases": Whole(1, 2),
    "test.pulse_force": Even(-2500, 2500),
}

GEAR: Mapping[str, Range] = {**TEETH, **ERRORS, **PARTS, **CONDITIONS, **COLUMN, **TEST}

FIDELITY: Mapping[str, Range] = {
    "mesh": Choice({"flank": 19, "triangles": 1, "general-contact": 0}),  # spheres are drawn apart
    "bush": Choice({"condensed": 7, "rigid": 1, "chain": 1}),
    "rack": Choice({"by-scene": 8, "free": 1, "guided": 1, "flexible": 2}),
    "pinion": Choice({"by-scene": 8, "rigid": 1, "supported": 1}),
    # formulas have no error of method: what they leave out is said where they stand
    "solver": Choice({"equilibrium": 1, "generalized-alpha": 1, "reduced": 0, "closed-form": 0}),
    "step_angle": Logarithmic(0.1 * DEG, 15 * DEG),
    "swing_steps": Choice({0: 1}),  # the scene's own
    "tolerance": Logarithmic(1e-6, 1e-2),
    "strip_stations": Whole(2, 8),
    "strip_points": Whole(2, 6),
    "profile_samples": Whole(12, 60),
    "axial_samples": Whole(8, 40),
    "chord_error": Logarithmic(1e-8, 3e-6),
    "zone_ratio": Logarithmic(0.001, 1),
    "friction_elements": Whole(1, 4),
}


def _largest_fillet(drawn: Drawn) -> float:
    """Largest fillet radius that leaves the cutter a flat tip, and the rack's tips room [modules]."""
    alpha, dedendum = drawn["pinion.pressure_angle"], drawn["basic_rack.dedendum"]
    flat = (np.pi / 4 - dedendum * np.tan(alpha)) / (1 / np.cos(alpha) - np.tan(alpha))
    reached = (dedendum - drawn["basic_rack.addendum"]) / (1 - np.sin(alpha))
    return float(max(0.0, min(0.5, flat, reached)))


def _radius_below_teeth(drawn: Drawn) -> float:
    """Height of the reference line at which the teeth reach the bar's surface [m]."""
    return float(drawn["rack.bar_diameter"] / 2 - drawn["basic_rack.addendum"] * MODULE)


def _longest_seat(drawn: Drawn) -> float:
    """Length of the seat whose corners reach the plunger's edge [m]; short where its arc nearly does."""
    plunger = drawn["yoke.plunger_diameter"] / 2
    half_width = drawn["rack.bar_diameter"] / 2 * np.sin(drawn["yoke.seat_angle"])
    return float(2 * np.sqrt(max(plunger**2 - half_width**2, (0.1 * plunger) ** 2)))


def _farthest_bush(drawn: Drawn) -> float:
    """Distance of the bush at which the rack still reaches through it [m]."""
    return float(drawn["rack.length"] - drawn["bush.length"] - drawn["rack.travel"] / 2)
