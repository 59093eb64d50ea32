"""From the paper's model down: each row leaves out one thing of the row above; what that saves and loses.

The first row is general contact in Exudyn with a bush of 25 segments. All rows have a rigid bar and the
contact law of general contact, load per length. Changes are against `flank` in a quarter of its step and
twice its stations.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import rps_exudyn as rps
from benchmarks.measure import quickest
from benchmarks.topic import Topic, begun, digits, load_data, markdown, save_data
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear

DATA = "ladder.json"
LAW: dict[str, object] = {"mesh.law": "line"}
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
    "impact: force": ("yoke-impact", "impact_peak_force"),
    "impact: impulse": ("yoke-impact", "impact_impulse"),
}
"""Column of the table -> scene and metric."""
SLOW = 1.0  # CPU time of a run [s] that is not repeated


FULL, FLANK, STILL = (
    Fidelity.preset(name).replace({"rack": "free"}) for name in ("full", "flank", "quasi-static")
)
RUNGS = {
    "`full`": ("nothing: spheres on triangles, bush of 25 segments", FULL),
    "`flank --mesh triangles`": (
        "spheres and segments: triangles are cut by the rack's faces",
        FLANK.replace({"mesh": "triangles"}),
    ),
    "`flank --bush chain`": (
        "meshes: the contact is integrated along lines",
        FLANK.replace({"bush": "chain"}),
    ),
    "`flank`": ("segments: the bush is condensed into its stiffness", FLANK),
    "`quasi-static`": ("inertia: equilibria at each angle", STILL),
    "`quasi-static --rack guided`": (
        "roll, yaw and pitch of the rack; four of five angles",
        STILL.replace({"rack": "guided", "step_angle": "5 deg"}),
    ),
    "`closed-form`": ("the angle: means over the field of contact", Fidelity.preset("closed-form")),
}
"""Model -> what it leaves out of the one above, and its choices."""
REFERENCE = FLANK.replace({"step_angle": FLANK.step_angle / 4, "strip_stations": 2 * FLANK.strip_stations})


def run(folder: Path, rungs: Sequence[str] = tuple(RUNGS), scenes: Sequence[str] = tuple(SCENES)) -> None:
    """Measure these rungs in these scenes; what was measured of other rungs stays."""
    file = folder / DATA
    rows = begun(file).get("rows", {})
    reference = {scene: metrics(measured(scene, REFERENCE)) for scene in scenes}
    for name in rungs:
        print(name, flush=True)
        rows[name] = {scene: single_run(scene, RUNGS[name][1]) for scene in scenes}
        save_data(
            file, {"reference": reference, "rows": {name: rows[name] for name in RUNGS if name in rows}}
        )


def measured(scene: str, fidelity: Fidelity) -> rps.Result:
    """The run of a scene."""
    return rps.run(scene, SteeringGear().replace(LAW | SCENES[scene]), fidelity=fidelity)


def metrics(result: rps.Result) -> dict[str, float]:
    """The summary's numbers of a run that ended ok; {} of others."""
    return dict(result.summary) if result.status == "ok" else {}


def single_run(scene: str, model: Fidelity) -> dict[str, Any]:
    """A single run: outcome, metrics, CPU time of the solver [s], least of two runs unless they are slow."""
    try:
        result = quickest(lambda: measured(scene, model), 2, SLOW)
    except rps.InputError as error:
        return {"why": str(error), "summary": {}, "cpu_s": None}
    return {"why": result.message, "summary": metrics(result), "cpu_s": result.counters["solver_cpu"]}


def ladder_table(folder: Path) -> str:
    """Model -> what it leaves out, and by how many per cent it changes each metric."""
    data = load_data(folder / DATA)
    rows = []
    for name, scenes in data["rows"].items():
        changes = [_change(data["reference"], scenes, *metric) for metric in METRICS.values()]
        rows.append((name, RUNGS[name][0], *changes))
    return markdown(("model", "leaves out", *(f"{each} %" for each in METRICS)), rows)


def _change(reference: Mapping[str, Any], row: Mapping[str, Any], scene: str, metric: str) -> str:
    if scene not in row or metric not in row[scene]["summary"]:
        return "-"
    right = reference[scene][metric]
    change = 100 * (row[scene]["summary"][metric] / right - 1)
    return "0" if abs(change) < 0.005 else f"{change:+.0f}" if abs(change) >= 99.5 else f"{change:+.2g}"


def times_table(folder: Path) -> str:
    """Model -> CPU time of each scene [s]."""
    rows = []
    for name, scenes in load_data(folder / DATA)["rows"].items():
        times = [each["cpu_s"] if each["summary"] else None for each in scenes.values()]
        rows.append((name, *(digits(time) if time else "-" for time in times)))
    return markdown(("CPU s", *SCENES), rows)


TOPIC = Topic(
    "3 min",
    "free_pinion_torque",
    run,
    {"rungs": ("`quasi-static`", "`closed-form`"), "scenes": ("free-pinion-torque",)},
    {"ladder": ladder_table, "ladder_times": times_table},
)
