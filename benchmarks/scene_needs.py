"""What a scene needs: leave one thing out or simplify it, and see what that does to the metrics and the time.

Each row is one change; it says how far each metric moves from the everyday model (preset flank), and the
solver's CPU time. Bold is what moves a metric by more than the accuracy stated for it: the scene needs it.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import rps_exudyn as rps
from benchmarks.topic import Topic, load_data, markdown, save_data
from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.tooth_stiffness import line_stiffness
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.friction_law import RUBBING_PARTS
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.quantities import SUMMARY
from rps_exudyn.results.result import Result

DATA = "needs.json"
BRISTLES: dict[str, object] = {f"{part}.friction_law": "bristle" for part in RUBBING_PARTS}
FALLING: dict[str, object] = {f"{part}.friction_law": "stribeck" for part in RUBBING_PARTS} | {
    f"{part}.static_ratio": 1.2 for part in RUBBING_PARTS
}
LEAD_ERROR = 0.2e-3 * SteeringGear().pinion.face_width  # over the face [m]


@dataclass(frozen=True)
class Change:
    """One thing left out, simplified or added."""

    fidelity: dict[str, object] = field(default_factory=dict)
    gear: dict[str, object] = field(default_factory=dict)


CHANGES = {
    "bush: chain of 25 segments": Change({"bush": "chain"}),
    "bush: rigid": Change({"bush": "rigid"}),
    "bush: clearance of 50 um": Change(gear={"bush.clearance": "50 um"}),
    "yokenut: none": Change(gear={"yoke.clearance": "9 mm"}),
    "rack: no roll, yaw, pitch, sway": Change({"rack": "guided"}),
    "rack: rigid": Change({"rack": "free"}),
    "rack: bending": Change({"rack": "flexible"}),
    "rack: bow of 0.15 mm along Y": Change(gear={"rack.bow": "0.15 mm"}),
    "rack: bow of 0.15 mm along Z": Change(gear={"rack.bow": "0.15 mm", "rack.bow_angle": "90 deg"}),
    "rack: 98 N across its end along Z": Change(
        gear={"rack.side_force": "98 N", "rack.side_angle": "90 deg"}
    ),
    "plunger: tilts in its bore by 0.1 mm": Change(gear={"yoke.bore_clearance": "0.1 mm"}),
    "plunger: 30 N of friction in its bore": Change(gear={"yoke.bore_friction": "30 N"}),
    "yokenut: damping time 20 us": Change(gear={"yoke.nut_damping": "20 us"}),
    "seat: clearance of 50 um": Change(gear={"yoke.seat_clearance": "50 um"}),
    "seat: gothic arch, 50 um": Change(gear={"yoke.seat_form": "gothic", "yoke.seat_clearance": "50 um"}),
    "seat: damping time 5 us": Change(gear={"yoke.seat_damping": "5 us"}),
    "inertia: none (equilibria)": Change({"solver": "equilibrium"}),
    "inertia: pinion twice as heavy": Change(gear={"pinion.density": 2 * SteeringGear().pinion.density}),
    "teeth: bending together": Change(gear={"mesh.law": "teeth"}),
    "teeth: load per length of line": Change(gear={"mesh.law": "line"}),
    "teeth: half as stiff": Change(
        gear={"mesh.law": "line", "mesh.line_stiffness": line_stiffness(SteeringGear()) / 2}
    ),
    "teeth: contact damping 0.1 ms": Change(gear={"mesh.damping": "0.1 ms"}),
    "lead error 0.2 mrad": Change(gear={"pinion.lead_error": LEAD_ERROR}),
    "lead error -0.2 mrad": Change(gear={"pinion.lead_error": -LEAD_ERROR}),
    "pitch errors of the pinion: ISO 1328 class 8": Change(
        gear={"pinion.pitch_errors": "ISO 1328 class 8, seed 3"}
    ),
    "pitch errors of the rack: ISO 1328 class 8": Change(
        gear={"rack.pitch_errors": "ISO 1328 class 8, seed 3"}
    ),
    "rack: back slopes by 0.3 mrad": Change(gear={"rack.back_parallelism": 0.3e-3}),
    "friction zone half as wide": Change({"zone_ratio": Fidelity().zone_ratio / 2}),
    "step half as long": Change({"step_angle": Fidelity().step_angle / 2}),
    "friction: bristles of 5 um": Change(gear=BRISTLES),
    "friction: bristles of 5 um, four elements": Change({"friction_elements": 4}, gear=BRISTLES),
    "column: half as stiff": Change(gear={"column.stiffness": SteeringGear().column.stiffness / 2}),
    "housing: mounts of 5 N/um": Change(gear={"housing.mount_stiffness": "5e6 N/m"}),
    "column: half as damped": Change(gear={"column.damping": SteeringGear().column.damping / 2}),
    "column: universal joint bent by 20 deg": Change(gear={"column.joint_angle": "20 deg"}),
    "temperature -30 degC": Change(gear={"conditions.temperature": "-30 degC"}),
    "temperature -30 degC, base oil PAO 32": Change(
        gear={"conditions.temperature": "-30 degC", "grease.base_oil": "PAO 32"}
    ),
    "spring: set by 5 %": Change(gear={"conditions.spring_set": 0.05}),
    "wear of 1e6 cycles": Change(gear={"conditions.steering_cycles": 1e6}),
    "pinion: on bearings": Change({"pinion": "supported"}),
    "pinion: bearing clearances of 20 um": Change(
        {"pinion": "supported"}, {"bearing.upper_clearance": "20 um", "bearing.lower_clearance": "20 um"}
    ),
    "pinion: bearings rub by 0.05 of their load": Change({"pinion": "supported"}, {"bearing.friction": 0.05}),
    "pinion: axial float of 0.1 mm": Change({"pinion": "supported"}, {"pinion.axial_float": "0.1 mm"}),
    "pinion: axial float of 0.1 mm under 40 N of friction": Change(
        {"pinion": "supported"}, {"pinion.axial_float": "0.1 mm", "pinion.axial_friction": "40 N"}
    ),
    "pinion: seat of the housing 200 N/um": Change(
        {"pinion": "supported"}, {"housing.seat_stiffness": "2e8, 2e8, 2e8, 1e5, 1e5, 1e5"}
    ),
    "gravity, pinion below the rack": Change(gear={"installation.gravity": "9.81 m/s^2"}),
    "gravity, pinion above the rack": Change(gear={"installation.gravity": "-9.81 m/s^2"}),
}


@dataclass(frozen=True)
class Metric:
    """A summary's number, and the change that matters: a fraction of itself, or absolute (SI)."""

    name: str
    fraction: float = 0.0
    absolute: float = 0.0

    def moved(self, base: Result, other: Result) -> tuple[str, bool]:
        """The change in the metric's unit or in per cent, and whether it matters."""
        if self.name not in other.summary or self.name not in base.summary:
            return "-", self.name in base.summary
        value, change = base.summary[self.name], other.summary[self.name] - base.summary[self.name]
        limit = self.absolute + self.fraction * abs(value)
        if abs(change) < 1e-3 * limit:
            return "0", False
        text = SUMMARY[self.name].show(change) if self.absolute else f"{100 * change / abs(value):+.2g} %"
        return text, abs(change) > limit


TORQUE = [
    Metric("torque_mean", fraction=0.01),
    Metric("torque_peak_to_peak", fraction=0.1),
    Metric("torque_tooth_order", fraction=0.1),
]
RACK = [Metric("rack_lift_range", absolute=0.5e-6), Metric("rack_roll_range", absolute=0.1e-3)]
RUNOUT: dict[str, object] = {"pinion.runout": "40 um"}


@dataclass(frozen=True)
class Need:
    """A scene and what is asked of it."""

    scene: str
    metrics: list[Metric]
    gear: dict[str, object] = field(default_factory=dict)
    fidelity: dict[str, object] = field(default_factory=dict)  # of the everyday model, beside the preset


NEEDS = {
    "free-pinion-torque": Need("free-pinion-torque", [*TORQUE, *RACK]),
    "free-pinion-torque, runout 40 um": Need(
        "free-pinion-torque", [*TORQUE, Metric("torque_first_order", fraction=0.05), *RACK], RUNOUT
    ),
    "free-pinion-torque, runout beyond the clearance": Need(
        "free-pinion-torque",
        [*TORQUE, Metric("torque_first_order", fraction=0.05), *RACK],
        RUNOUT | {"yoke.clearance": "30 um"},
    ),
    "load-test": Need(
        "load-test",
        [
            Metric("torque_forward", fraction=0.01),
            Metric("torque_reverse", fraction=0.01),
            Metric("efficiency_forward", fraction=0.01),
            Metric("efficiency_reverse", fraction=0.01),
            *RACK,
        ],
        {"test.load_mass": "40 kg"},
    ),
    "rack-push": Need(
        "rack-push",
        [Metric("push_force_mean", fraction=0.01), Metric("push_force_peak_to_peak", fraction=0.1), *RACK],
    ),
    "rack-on-rollers": Need("rack-on-rollers", [Metric("roller_force_mean", fraction=0.01), *RACK]),
    "reversal": Need(
        "reversal",
        [
            Metric("torque_jump", fraction=0.01),
            Metric("hysteresis_area", fraction=0.01),
            Metric("lost_motion", absolute=0.5e-6),
            Metric("lost_motion_angle", absolute=0.1e-3),
            Metric("reversal_angle", fraction=0.1),
        ],
    ),
    "steering-feel": Need(
        "steering-feel",
        [
            Metric("feel_area", fraction=0.01),
            Metric("on_centre_stiffness", fraction=0.05),
            Metric("feel_angle_hysteresis", fraction=0.05),
            Metric("breakaway_ratio", absolute=0.02),
        ],
    ),
    "steering-torque": Need(
        "steering-torque",
        [
            Metric("feel_area", fraction=0.01),
            Metric("angle_dead_band", fraction=0.01),
            Metric("torque_dead_band", fraction=0.01),
            Metric("steering_gradient", fraction=0.02),
        ],
        {"test.tyre_stiffness": "200 N/mm"},
    ),
    "stick-slip": Need(
        "stick-slip",
        [
            Metric("stick_slip_torque", fraction=0.1),
            Metric("stick_slip_frequency", fraction=0.1),
            Metric("stick_share", absolute=0.05),
            Metric("breakaway_ratio", absolute=0.02),
        ],
        FALLING,
    ),
    "radial-play": Need(
        "radial-play",
        [Metric("radial_play_y", fraction=0.02), Metric("radial_play_z", fraction=0.02)],
    ),
    "rack-lift": Need(
        "rack-lift", [Metric("rack_lift", fraction=0.02), Metric("rack_lift_end", fraction=0.02)]
    ),
    "input-shaft-play": Need(
        "input-shaft-play",
        [Metric("input_shaft_play_radial", fraction=0.02), Metric("input_shaft_play_axial", fraction=0.02)],
    ),
    "yoke-setting": Need(
        "yoke-setting",
        [
            Metric("torque_on_centre", fraction=0.01),
            Metric("torque_on_centre_variation", fraction=0.1),
            Metric("torque_off_centre_variation", fraction=0.1),
        ],
        {"test.path": "there-and-back", "test.turns": 1.0},
        {"solver": "equilibrium"},
    ),
    "rattle": Need(
        "rattle",
        [
            Metric("rattle_force_rms", fraction=0.05),
            Metric("rattle_speed_rms", fraction=0.05),
            Metric("rattle_impulse_per_cycle", fraction=0.05),
        ],
        {"test.road_frequency": "50 Hz", "test.road_phases": 1, "test.road_cycles": 2},
    ),
    "yoke-impact": Need(
        "yoke-impact",
        [
            Metric("impact_peak_force", fraction=0.05),
            Metric("impact_impulse", fraction=0.05),
            Metric("impact_force_rms", fraction=0.05),
        ],
        fidelity={"rack": "flexible"},
    ),
}


def run(folder: Path, cases: Sequence[str] = tuple(NEEDS), changes: Sequence[str] = tuple(CHANGES)) -> None:
    """Measure what is missing of these changes of these cases; delete needs.json to measure all again."""
    file = folder / DATA
    needs = load_data(file)["needs"] if file.exists() else {}
    for name in cases:
        need = NEEDS[name]
        head = ["change", *(f"`{metric.name}`" for metric in need.metrics), "CPU s"]
        before = needs.get(name, {})
        kept = (
            {row[0]: row for row in before["rows"] if row[0] in CHANGES} if before.get("head") == head else {}
        )
        missing = [title for title in changes if title not in kept]
        if not missing and before:
            continue
        print(name, flush=True)
        base, measured = measured_rows(need, missing)
        kept |= {row[0]: row for row in measured}
        needs[name] = {
            "accuracy": ", ".join(f"`{metric.name}` {_limit(metric)}" for metric in need.metrics),
            "head": head,
            "rows": [base, *(kept[title] for title in CHANGES if title in kept)],
        }
        save_data(file, {"needs": {each: needs[each] for each in NEEDS if each in needs}})


def measured_rows(need: Need, changes: Sequence[str]) -> tuple[list[str], list[list[str]]]:
    """Return the rows of a case's table: of the everyday model, and of these changes."""
    base = second(lambda: outcome(need, Change()))
    assert isinstance(base, Result)
    values = [SUMMARY[metric.name].show(base.summary[metric.name]) for metric in need.metrics]
    rows = []
    for title in changes:
        other = second(lambda title=title: outcome(need, CHANGES[title]))  # type: ignore[misc]
        rows.append([title, *cells(need, base, other)])
    return ["everyday model", *values, cpu(base)], rows


def outcome(need: Need, change: Change) -> Result | str:
    """The run, or why the scene cannot do without what was changed."""
    try:
        gear = SteeringGear().replace(need.gear | change.gear)
        fidelity = Fidelity.preset("flank").replace(need.fidelity | change.fidelity)
        result = rps.run(need.scene, gear, fidelity=fidelity)
    except InputError as error:
        return str(error).split(";")[-1].strip()
    return result if result.status is Status.OK else f"{result.status}: {result.message}"


def second(measure: Callable[[], Result | str]) -> Result | str:
    """The second run, after one that compiled and loaded what it needs."""
    measure()
    return measure()


def cells(need: Need, base: Result, other: Result | str) -> list[str]:
    """Return how far each metric moved, bold where it matters, and the cost; or why there is no result."""
    if isinstance(other, str):
        return [f"*{other}*", *[""] * len(need.metrics)]
    moved = [metric.moved(base, other) for metric in need.metrics]
    return [*(f"**{text}**" if matters else text for text, matters in moved), cpu(other)]


def cpu(result: Result) -> str:
    """CPU time of the solver [s]."""
    return f"{result.counters['solver_cpu']:.2g}"


def _limit(metric: Metric) -> str:
    return SUMMARY[metric.name].show(metric.absolute) if metric.absolute else f"{metric.fraction:.0%}"


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
    for title, found in moved.items():
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
    """The first case's changes that move one of its first two metrics, with the cost."""
    need = next(iter(load_data(folder / DATA)["needs"].values()))
    rows = [(*row[:3], row[-1]) for row in need["rows"] if row[1:3] != ["0", "0"]]
    return markdown(
        (*need["head"][:3], need["head"][-1]), [[cell.replace("*", "") for cell in row] for row in rows]
    )


TOPIC = Topic(
    "what each scene needs of the model: one thing after another left out",
    "10 min",
    "scenes",
    run,
    {"cases": ("rack-push",), "changes": ("bush: rigid", "rack: no roll, yaw, pitch, sway")},
    {"needs": needs_table, "needs_first": first_scene_table},
)
