"""Work against precision of every model, scene by scene; goes on where it was stopped.

    python studies/accuracy_speed.py [--out results/accuracy_speed] [--scene NAME ...] [--again]

The points are those of studies/accuracy_speed_*.toml, which `rps-exudyn study` runs too; here each is run
several times in this one process, and its least processor time counts. Writes SCENE.h5 and SCENE.png. With
--again what is there is measured anew: on another machine the costs are others, the errors are not.
"""

import argparse
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from rps_exudyn.accuracy.measurement import Measurement, load_measurement, measure_point
from rps_exudyn.accuracy.runs import JUDGED, run_scene, truth_of
from rps_exudyn.charts.work_precision import draw_work_precision
from rps_exudyn.errors import InputError
from rps_exudyn.fidelity import Fidelity
from rps_exudyn.parameters import SteeringGear
from rps_exudyn.provenance import provenance
from rps_exudyn.study.cases import describe, setup_of
from rps_exudyn.study.description import Axis, Value
from rps_exudyn.study.study_file import read_study
from rps_exudyn.study.table import axis_quantity

STUDIES = Path(__file__).parent
OF_TORQUE = (
    "closed_form ratio quasi_static quasi_static_turn generators spheres_at_rest flank newton bush "
    "general_contact general_contact_step"
)
FILES = {
    "free-pinion-torque": OF_TORQUE.split(),
    "load-test": ["closed_form", "quasi_static", "flank"],
    "rack-push": ["closed_form", "quasi_static", "flank"],
    "reversal": ["quasi_static", "flank"],
    "yoke-impact": ["newton"],
}
REPEATS = {"free-pinion-torque": 15, "yoke-impact": 1}
Planned = tuple[str, str, SteeringGear, Fidelity]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=STUDIES.parent / "results" / "accuracy_speed")
    parser.add_argument("--scene", action="append", choices=list(JUDGED))
    parser.add_argument("--again", action="store_true")
    asked = parser.parse_args()
    asked.out.mkdir(parents=True, exist_ok=True)
    for scene in asked.scene or FILES:
        measure_scene(scene, asked.out, asked.again)


def measure_scene(scene: str, folder: Path, again: bool) -> None:
    """Everything planned of a scene, its file and its chart."""
    file = folder / f"{scene}.h5"
    planned = list(points_of(scene))
    truth = truth_of(scene, planned[0][2])
    done = _there(file) if not again else None
    measurement = Measurement(scene, truth.judged, origin=provenance())
    measurement.planned = [(study, label) for study, label, *_ in planned]
    measurement.points = [p for p in done.points if (p.study, p.label) in measurement.planned] if done else []
    missing = set(measurement.missing)
    for study, label, gear, fidelity in planned:
        if (study, label) not in missing:
            continue
        warm_up(scene, gear, fidelity)
        point = measure_point(study, label, truth, gear, fidelity, REPEATS.get(scene, 3))
        cost, error = f"{1e3 * point.cost:10.3f} ms", f"{point.rms:9.4f} %"
        print(f"{point.status:15s} {cost} {error}  {study}: {label}", flush=True)
        measurement.points.append(point)
        measurement.save(file)
    measurement.save(file)
    draw_work_precision(measurement, file.with_suffix(".png"))


def points_of(scene: str) -> Iterator[Planned]:
    """File, label, gear and fidelity of each point."""
    for name in FILES[scene]:
        study = replace(read_study(STUDIES / f"accuracy_speed_{name}.toml"), scene=scene)
        for case in describe(study, {}).cases:
            setup = setup_of(study, case)
            label = ", ".join(_told(axis, case.values[axis.name]) for axis in study.axes)
            yield name, label, setup.steering_gear, setup.fidelity


def _told(axis: Axis, value: Value) -> str:
    """For instance "step_angle 1 deg"."""
    shown = axis_quantity(axis).show(value) if isinstance(value, float) else value
    return f"{axis.name.removeprefix('fidelity.').removeprefix('bush.')} {shown}"


WARM: set[str] = set()


def warm_up(scene: str, gear: SteeringGear, fidelity: Fidelity) -> None:
    """Once for each kind of model: compiled kernels are loaded, and no point pays for it."""
    kind = f"{fidelity.solver} {fidelity.mesh} {fidelity.bush}"
    if kind not in WARM:
        run_scene(scene, gear.replace({"test.turns": 0.01}), fidelity)
        WARM.add(kind)


def _there(file: Path) -> Measurement | None:
    try:
        return load_measurement(file)
    except InputError:
        return None


if __name__ == "__main__":
    main()
