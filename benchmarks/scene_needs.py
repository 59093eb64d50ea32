"""What a scene needs: leave one thing out or simplify it, and see what that does to the metrics and the time.

Each row is one change; it says how far each metric moves from the everyday model (preset flank), and the
solver's CPU time. Bold is what moves a metric by more than the accuracy stated for it: the scene needs it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

import rps_exudyn as rps
from benchmarks.topic import Topic, begun, load_data, markdown, save_data
from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.tooth_stiffness import line_stiffness
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.friction_law import RUBBING_PARTS
from rps_exudyn.parameters.gear import Setup, SteeringGear
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.quantities import SUMMARY
from rps_exudyn.results.result import Result

Settings = dict[str, object]

DATA = "needs.json"
GEAR = SteeringGear()
EVERYDAY = Setup(fidelity=Fidelity.preset("flank"))
BRISTLES: Settings = {f"{part}.friction_law": "bristle" for part in RUBBING_PARTS}
FALLING: Settings = {f"{part}.friction_law": "stribeck" for part in RUBBING_PARTS} | {
    f"{part}.static_ratio": 1.2 for part in RUBBING_PARTS
}
SUPPORTED: Settings = {"fidelity.pinion": "supported"}
GAIN = float(GearPair.of(GEAR).gain)  # [m/rad]
LEAD_ERROR = 0.2e-3 * GEAR.pinion.face_width  # over the face [m]

CHANGES: dict[str, Settings] = {
    "bush: chain of 25 segments": {"fidelity.bush": "chain"},
    "bush: rigid": {"fidelity.bush": "rigid"},
    "bush: clearance of 50 um": {"bush.clearance": "50 um"},
    "yokenut: none": {"yoke.clearance": "9 mm"},
    "rack: no roll, yaw, pitch, sway": {"fidelity.rack": "guided"},
    "rack: rigid": {"fidelity.rack": "free"},
    "rack: bending": {"fidelity.rack": "flexible"},
    "rack: 10 % more travel per turn outwards": {
        "rack.ratio.centre": 2 * np.pi * GAIN, "rack.ratio.lock": 2.2 * np.pi * GAIN
    },
    "rack: bow of 0.15 mm along Y": {"rack.bow": "0.15 mm"},
    "rack: bow of 0.15 mm along Z": {"rack.bow": "0.15 mm", "rack.bow_angle": "90 deg"},
    "rack: 98 N across its end along Z": {"rack.side_force": "98 N", "rack.side_angle": "90 deg"},
    "plunger: tilts in its bore by 0.1 mm": {"yoke.bore_clearance": "0.1 mm"},
    "plunger: 30 N of friction in its bore": {"yoke.bore_friction": "30 N"},
    "yokenut: damping time 20 us": {"yoke.nut_damping": "20 us"},
    "seat: clearance of 50 um": {"yoke.seat_clearance": "50 um"},
    "seat: gothic arch, 50 um": {"yoke.seat_form": "gothic", "yoke.seat_clearance": "50 um"},
    "seat: damping time 5 us": {"yoke.seat_damping": "5 us"},
    "equilibria instead of dynamics": {"fidelity.solver": "equilibrium"},
    "inertia: pinion twice as heavy": {"pinion.density": 2 * GEAR.pinion.density},
    "teeth: bending together": {"mesh.law": "teeth"},
    "teeth: load per length of line": {"mesh.law": "line"},
    "teeth: half as stiff": {"mesh.law": "line", "mesh.line_stiffness": line_stiffness(GEAR) / 2},
    "teeth: contact damping 0.1 ms": {"mesh.damping": "0.1 ms"},
    "lead error 0.2 mrad": {"pinion.lead_error": LEAD_ERROR},
    "lead error -0.2 mrad": {"pinion.lead_error": -LEAD_ERROR},
    "pitch errors of the pinion: ISO 1328 class 8": {"pinion.pitch_errors": "ISO 1328 class 8, seed 3"},
    "pitch errors of the rack: ISO 1328 class 8": {"rack.pitch_errors": "ISO 1328 class 8, seed 3"},
    "rack: back slopes by 0.3 mrad": {"rack.back_parallelism": 0.3e-3},
    "friction zone half as wide": {"fidelity.zone_ratio": Fidelity().zone_ratio / 2},
    "step half as long": {"fidelity.step_angle": Fidelity().step_angle / 2},
    "friction: bristles of 5 um": BRISTLES,
    "friction: bristles of 5 um, four elements": BRISTLES | {"fidelity.friction_elements": 4},
    "column: half as stiff": {"column.stiffness": GEAR.column.stiffness / 2},
    "housing: mounts of 5 N/um": {"housing.mount_stiffness": "5e6 N/m"},
    "column: half as damped": {"column.damping": GEAR.column.damping / 2},
    "column: universal joint bent by 20 deg": {"column.joint_angle": "20 deg"},
    "temperature -30 degC": {"conditions.temperature": "-30 degC"},
    "temperature -30 degC, base oil PAO 32": {
        "conditions.temperature": "-30 degC", "grease.base_oil": "PAO 32"
    },
    "spring: set by 5 %": {"conditions.spring_set": 0.05},
    "wear of 1e6 cycles": {"conditions.steering_cycles": 1e6},
    "pinion: on bearings": SUPPORTED,
    "pinion: bearing clearances of 20 um": SUPPORTED
    | {"bearing.upper_clearance": "20 um", "bearing.lower_clearance": "20 um"},
    "pinion: bearings rub by 0.05 of their load": SUPPORTED | {"bearing.friction": 0.05},
    "pinion: axial float of 0.1 mm": SUPPORTED | {"pinion.axial_float": "0.1 mm"},
    "pinion: axial float of 0.1 mm under 40 N of friction": SUPPORTED
    | {"pinion.axial_float": "0.1 mm", "pinion.axial_friction": "40 N"},
    "pinion: seat of the housing 200 N/um": SUPPORTED
    | {"housing.seat_stiffness": "2e8, 2e8, 2e8, 1e5, 1e5, 1e5"},
    "gravity, pinion below the rack": {"installation.gravity": "9.81 m/s^2"},
    "gravity, pinion above the rack": {"installation.gravity": "-9.81 m/s^2"},
}  # fmt: skip
"""One thing left out, simplified or added -> what is set."""

FRACTIONS = {
    0.01: """torque_mean torque_forward torque_reverse efficiency_forward efficiency_reverse push_force_mean
        roller_force_mean torque_jump hysteresis_area feel_area angle_dead_band torque_dead_band
        torque_on_centre""",
    0.02: """steering_gradient radial_play_y radial_play_z rack_lift rack_lift_end input_shaft_play_radial
        input_shaft_play_axial""",
    0.05: """torque_first_order on_centre_stiffness feel_angle_hysteresis rattle_force_rms rattle_speed_rms
        rattle_impulse_per_cycle impact_peak_force impact_impulse impact_force_rms""",
    0.1: """torque_peak_to_peak torque_tooth_order push_force_peak_to_peak stick_slip_torque
        stick_slip_frequency torque_on_centre_variation torque_off_centre_variation""",
}
FRACTION = {name: limit for limit, names in FRACTIONS.items() for name in names.split()}
"""Metric -> the change that matters, as a fraction of itself ..."""

ABSOLUTE = {
    "rack_lift_range": 0.5e-6,
    "rack_roll_range": 0.1e-3,
    "lost_motion": 0.5e-6,
    "lost_motion_angle": 0.1e-3,
    "breakaway_ratio": 0.02,
    "stick_share": 0.05,
}
"""... or as a number [SI]."""


@dataclass(frozen=True)
class Need:
    """What is asked of a scene, and the settings of its everyday model beside the preset."""

    metrics: str
    settings: Settings = field(default_factory=dict)

    @property
    def names(self) -> list[str]:
        """Names of the metrics."""
        return self.metrics.split()


TORQUE = "torque_mean torque_peak_to_peak torque_tooth_order"
RACK = "rack_lift_range rack_roll_range"
RUNOUT: Settings = {"pinion.runout": "40 um"}
ECCENTRIC = f"{TORQUE} torque_first_order {RACK}"
NEEDS = {
    "free-pinion-torque": Need(f"{TORQUE} {RACK}"),
    "free-pinion-torque, runout 40 um": Need(ECCENTRIC, RUNOUT),
    "free-pinion-torque, runout beyond the clearance": Need(ECCENTRIC, RUNOUT | {"yoke.clearance": "30 um"}),
    "load-test": Need(
        f"torque_forward torque_reverse efficiency_forward efficiency_reverse {RACK}",
        {"test.load_mass": "40 kg"},
    ),
    "rack-push": Need(f"push_force_mean push_force_peak_to_peak {RACK}"),
    "rack-on-rollers": Need(f"roller_force_mean {RACK}"),
    "reversal": Need("torque_jump hysteresis_area lost_motion lost_motion_angle"),
    "steering-feel": Need("feel_area on_centre_stiffness feel_angle_hysteresis breakaway_ratio"),
    "steering-torque": Need(
        "feel_area angle_dead_band torque_dead_band steering_gradient", {"test.tyre_stiffness": "200 N/mm"}
    ),
    "stick-slip": Need("stick_slip_torque stick_slip_frequency stick_share breakaway_ratio", FALLING),
    "radial-play": Need("radial_play_y radial_play_z"),
    "rack-lift": Need("rack_lift rack_lift_end"),
    "input-shaft-play": Need("input_shaft_play_radial input_shaft_play_axial"),
    "yoke-setting": Need(
        "torque_on_centre torque_on_centre_variation torque_off_centre_variation",
        {"test.path": "there-and-back", "test.turns": 1.0, "fidelity.solver": "equilibrium"},
    ),
    "rattle": Need(
        "rattle_force_rms rattle_speed_rms rattle_impulse_per_cycle",
        {"test.road_frequency": "50 Hz", "test.road_phases": 1, "test.road_cycles": 2},
    ),
    "yoke-impact": Need("impact_peak_force impact_impulse impact_force_rms", {"fidelity.rack": "flexible"}),
}
"""Scene, and a case of it behind a comma -> what is asked."""


def run(folder: Path, cases: Sequence[str] = tuple(NEEDS), changes: Sequence[str] = tuple(CHANGES)) -> None:
    """Measure what is missing of these changes of these cases; delete needs.json to measure all again."""
    file = folder / DATA
    needs = begun(file).get("needs", {})
    for name in cases:
        head = ["change", *(f"`{metric}`" for metric in NEEDS[name].names), "CPU s"]
        before = needs.get(name, {})
        rows = before["rows"] if before.get("head") == head else []
        kept = {row[0]: row for row in rows if row[0] in CHANGES}
        missing = [title for title in changes if title not in kept]
        if not missing and before:
            continue
        print(name, flush=True)
        base = outcome(name, {})
        assert isinstance(base, Result)
        kept |= {title: [title, *cells(name, base, outcome(name, CHANGES[title]))] for title in missing}
        values = [SUMMARY[metric].show(base.summary[metric]) for metric in NEEDS[name].names]
        rows = [["everyday model", *values, cpu(base)], *(kept[title] for title in CHANGES if title in kept)]
        needs[name] = {"head": head, "rows": rows}
        save_data(file, {"needs": {each: needs[each] for each in NEEDS if each in needs}})


def outcome(name: str, change: Settings) -> Result | str:
    """The second run of a case, after one that compiled and loaded what it needs; or why the scene cannot do
    without what was changed."""
    try:
        setup = EVERYDAY.replace(NEEDS[name].settings | change)
        for _ in range(2):
            result = rps.run(name.partition(",")[0], setup.steering_gear, fidelity=setup.fidelity)
    except InputError as error:
        return str(error).split(";")[-1].strip()
    return result if result.status is Status.OK else f"{result.status}: {result.message}"


def cells(name: str, base: Result, other: Result | str) -> list[str]:
    """Return how far each metric moved, bold where it matters, and the cost; or why there is no result."""
    metrics = NEEDS[name].names
    if isinstance(other, str):
        return [f"*{other}*", *[""] * len(metrics)]
    return [*(moved(metric, base, other) for metric in metrics), cpu(other)]


def moved(metric: str, base: Result, other: Result) -> str:
    """The change of a metric in its unit or in per cent, bold if it matters."""
    if metric not in base.summary:
        return "-"
    if metric not in other.summary:
        return "**-**"
    value, change = base.summary[metric], other.summary[metric] - base.summary[metric]
    limit = ABSOLUTE.get(metric) or FRACTION[metric] * abs(value)
    if abs(change) < 1e-3 * limit:
        return "0"
    text = SUMMARY[metric].show(change) if metric in ABSOLUTE else f"{100 * change / abs(value):+.2g} %"
    return f"**{text}**" if abs(change) > limit else text


def cpu(result: Result) -> str:
    """CPU time of the solver [s]."""
    return f"{result.counters['solver_cpu']:.2g}"


MOST = 0.6  # of the scenes: changes that matter to so many share a line


def needs_table(folder: Path) -> str:
    """Changes -> the cases in which they move a metric by more than its accuracy; others are left out."""
    needs = load_data(folder / DATA)["needs"]
    moved: dict[str, list[str]] = {}
    measured: dict[str, list[str]] = {}
    for name, need in needs.items():
        short = name.removeprefix("free-pinion-torque, ")
        for title, *texts in need["rows"][1:]:
            measured.setdefault(title, []).append(short)
            refused = texts[0].startswith("*") and not any(texts[1:])
            if refused or any(text.startswith("**") for text in texts):
                moved.setdefault(title, []).append(f"{short} (cannot)" if refused else short)
    titles: dict[str, list[str]] = {}
    for title, found in sorted(moved.items(), key=lambda item: -len(item[1]) / len(measured[item[0]])):
        if len(found) >= MOST * len(measured[title]):
            titles.setdefault(f"at least {MOST:.0%} of the scenes", []).append(title)
            continue
        every = "all" if len(measured[title]) == len(needs) else "all measured"
        titles.setdefault(_listed(found, measured[title], every), []).append(title)
    return markdown(("change", "matters to"), [("; ".join(same), listed) for listed, same in titles.items()])


def _listed(found: list[str], measured: list[str], every: str) -> str:
    """Return these cases, or `every` except the others where those are fewer."""
    missing = [name for name in measured if name not in found and f"{name} (cannot)" not in found]
    cannot = [each for each in found if each.endswith(" (cannot)")]
    if len(missing) + len(cannot) >= len(found):
        return ", ".join(found)
    but = f" except {', '.join(missing)}" if missing else ""
    return f"{every}{but}" + (f"; {', '.join(cannot)}" if cannot else "")


def first_scene_table(folder: Path) -> str:
    """The first case's changes that move one of its first two metrics beyond its accuracy, with the cost."""
    need = next(iter(load_data(folder / DATA)["needs"].values()))
    first, *others = need["rows"]
    rows = [(*row[:3], row[-1]) for row in [first, *others] if row is first or "**" in "".join(row[1:3])]
    return markdown(
        (*need["head"][:3], need["head"][-1]), [[cell.replace("*", "") for cell in row] for row in rows]
    )


TOPIC = Topic(
    "10 min",
    "scenes",
    run,
    {"cases": ("rack-push",), "changes": ("bush: rigid", "rack: no roll, yaw, pitch, sway")},
    {"needs": needs_table, "needs_first": first_scene_table},
)
