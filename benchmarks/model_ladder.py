"""From the paper's model down: each row leaves out one thing of the row above; what that saves and loses.

The first row is general contact in Exudyn with a bush of 25 segments. All rows have a rigid bar and the
contact law of general contact, load per length. Changes are against `flank` in a quarter of its step and
twice its stations.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import rps_exudyn as rps
from benchmarks.topic import Topic, digits, load_data, markdown, save_data
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear

DATA = "ladder.json"
LAW: dict[str, object] = {"mesh.law": "line"}
RIGID: dict[str, object] = {"rack": "free"}
SCENES: dict[str, dict[str, object]] = {
    "free-pinion-torque": {},
    "load-test": {"test.load_mass": "40 kg"},
    "reversal": {},
    "yoke-impact": {},
}
METRICS = {
    "mean": ("free-pinion-torque", "torque_mean"),
    "ripple": ("free-pinion-torque", "torque_peak_to_peak"),
    "efficiency": ("load-test", "efficiency_forward"),
    "reversal: work": ("reversal", "hysteresis_area"),
    "reversal: angle": ("reversal", "reversal_angle"),
    "impact: force": ("yoke-impact", "impact_peak_force"),
    "impact: impulse": ("yoke-impact", "impact_impulse"),
}
"""Column of the table -> scene and metric."""
SLOW = 1.0  # CPU time of a run [s] that is not repeated


@dataclass(frozen=True)
class Rung:
    """A model, and what it leaves out of the one above."""

    leaves_out: str
    preset: str
    choices: Mapping[str, object] = field(default_factory=dict)

    @property
    def fidelity(self) -> Fidelity:
        rack = RIGID if self.preset != "closed-form" else {}
        return Fidelity.preset(self.preset).replace(rack | dict(self.choices))


RUNGS = {
    "`full`": Rung("nothing: spheres on triangles, bush of 25 segments", "full"),
    "`flank --bush chain`": Rung(
        "spheres: the contact is integrated along lines", "flank", {"bush": "chain"}
    ),
    "`flank`": Rung("segments: the bush is condensed into its stiffness", "flank"),
    "`quasi-static`": Rung("inertia: equilibria at each angle", "quasi-static"),
    "`quasi-static --rack guided`": Rung(
        "roll, yaw and pitch of the rack; four of five angles",
        "quasi-static",
        {"rack": "guided", "step_angle": "5 deg"},
    ),
    "`closed-form`": Rung("the angle: means over the field of contact", "closed-form"),
}
REFERENCE = Fidelity.preset("flank").replace(
    RIGID | {"step_angle": Fidelity().step_angle / 4, "strip_stations": 2 * Fidelity().strip_stations}
)


def run(folder: Path, rungs: Sequence[str] = tuple(RUNGS), scenes: Sequence[str] = tuple(SCENES)) -> None:
    """Measure these rungs in these scenes; what was measured of other rungs stays."""
    file = folder / DATA
    rows = load_data(file)["rows"] if file.exists() else {}
    reference = {scene: metrics(measured(scene, REFERENCE)) for scene in scenes}
    for name in rungs:
        print(name, flush=True)
        rows[name] = {scene: single_run(scene, RUNGS[name]) for scene in scenes}
        save_data(
            file, {"reference": reference, "rows": {each: rows[each] for each in RUNGS if each in rows}}
        )


def measured(scene: str, fidelity: Fidelity) -> rps.Result:
    """The run of a scene."""
    return rps.run(scene, SteeringGear().replace(LAW | SCENES[scene]), fidelity=fidelity)


def metrics(result: rps.Result) -> dict[str, float]:
    """The summary's numbers of a run that ended ok; {} of others."""
    return dict(result.summary) if result.status == "ok" else {}


def single_run(scene: str, rung: Rung) -> dict[str, Any]:
    """A single run: outcome, metrics, CPU time of the solver [s], least of two runs unless they are slow."""
    runs: list[rps.Result] = []
    try:
        while not runs or (len(runs) < 2 and runs[0].counters["solver_cpu"] < SLOW):
            runs.append(measured(scene, rung.fidelity))
    except rps.InputError as error:
        return {"why": str(error), "summary": {}, "cpu_s": None}
    cpu = min(each.counters["solver_cpu"] for each in runs)
    return {"why": runs[-1].message, "summary": metrics(runs[-1]), "cpu_s": cpu}


def ladder_table(folder: Path) -> str:
    """Model -> what it leaves out, CPU time of a turn, and by how many per cent it changes each metric."""
    data = load_data(folder / DATA)
    rows = []
    for name, scenes in data["rows"].items():
        turn = scenes["free-pinion-torque"]["cpu_s"]
        changes = [_change(data["reference"], scenes, *metric) for metric in METRICS.values()]
        rows.append((name, RUNGS[name].leaves_out, digits(turn), *changes))
    return markdown(("model", "leaves out", "CPU s", *(f"{each} %" for each in METRICS)), rows)


def _change(reference: Mapping[str, Any], row: Mapping[str, Any], scene: str, metric: str) -> str:
    if scene not in row or metric not in row[scene]["summary"]:
        return "-"
    right = reference[scene][metric]
    change = 100 * (row[scene]["summary"][metric] / right - 1)
    return "0" if abs(change) < 0.005 else f"{change:+.0f}" if abs(change) >= 99.5 else f"{change:+.2g}"


def times_table(folder: Path) -> str:
    """Model -> CPU time of each scene [s]."""
    rows = [
        (
            name,
            *(
                digits(each["cpu_s"]) if each["cpu_s"] and each["summary"] else "-"
                for each in scenes.values()
            ),
        )
        for name, scenes in load_data(folder / DATA)["rows"].items()
    ]
    return markdown(("CPU s", *SCENES), rows)


TOPIC = Topic(
    "from the paper's model down: what each simplification saves and loses",
    "3 min",
    "free_pinion_torque",
    run,
    {"rungs": ("`quasi-static`", "`closed-form`"), "scenes": ("free-pinion-torque",)},
    {"ladder": ladder_table, "ladder_times": times_table},
)
