"""Work against precision of every model, scene by scene; goes on where it was stopped.

    python studies/accuracy_speed.py [--out results/accuracy_speed] [--scene NAME] [--again | --more STUDY]

The points are those of studies/accuracy_speed_*.toml, which `rps-exudyn study` runs too, and for the free
pinion torque those of models that no fidelity describes: Exudyn's explicit solvers, and pinions as they are
cut. Each is run several times in this one process, and its least CPU time counts. Writes SCENE.h5,
SCENE.png and report.html. With --again what is there is measured anew: on another machine the costs are
others, the errors are not. With --more a study is measured once more, and the least cost of all counts.
"""

import argparse
from collections.abc import Iterator
from dataclasses import replace
from functools import cache, partial
from pathlib import Path

from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.provenance import provenance
from rps_exudyn.study.cases import describe, setup_of
from rps_exudyn.study.description import Axis, Value
from rps_exudyn.study.study_file import read_study
from rps_exudyn.study.table import axis_quantity
from rps_exudyn.verification.accuracy_page import write_accuracy_report
from rps_exudyn.verification.convergence import fitted_orders
from rps_exudyn.verification.faceted import Surface, faceted_run, largest_deviation, meshed, shaped, spheres
from rps_exudyn.verification.flywheel import explicit_run
from rps_exudyn.verification.measurement import Measurement, Plan, Point, load_measurement, measure_point
from rps_exudyn.verification.references import truth_of
from rps_exudyn.verification.runs import JUDGED, Truth, curve_of, run_scene
from rps_exudyn.verification.work_precision import Reference
from rps_exudyn.verification.work_precision_chart import draw_work_precision

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
EXPLICIT = {
    "VelocityVerlet": (10e-6, 20e-6, 30e-6, 40e-6, 60e-6),
    "RK44": (20e-6, 30e-6, 50e-6, 60e-6),
    "ExplicitMidpoint": (10e-6, 20e-6),
}
"""Steps [s]; the last of each is beyond what is stable."""

CUTS = (50, 100, 200, 400)
"""Of a pinion's turn."""

CHORDS = (3e-6, 1e-6, 0.3e-6, 0.1e-6)
"""Errors of the pinion's triangles [m]; the package's spheres sit on the last."""

FACETED = spheres(108, 36, "1 deg")
PITCH = SteeringGear().replace({"test.turns": 1 / 6})


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=STUDIES.parent / "results" / "accuracy_speed")
    parser.add_argument("--scene", action="append", choices=list(JUDGED))
    parser.add_argument("--again", action="store_true")
    parser.add_argument("--more", action="append", default=[], help="study to repeat: the least cost counts")
    asked = parser.parse_args()
    asked.out.mkdir(parents=True, exist_ok=True)
    for scene in asked.scene or FILES:
        measure_scene(scene, asked.out, asked.again, asked.more)
        write_accuracy_report(asked.out, asked.out / "report.html")


def measure_scene(scene: str, folder: Path, again: bool, more: list[str]) -> None:
    """Everything planned of a scene, its file and its chart."""
    file = folder / f"{scene}.h5"
    planned = list(points_of(scene))
    truth = truth_of(scene, SteeringGear())
    done = _there(file) if not again else None
    measurement = Measurement(scene, truth.judged, origin=provenance())
    measurement.planned = [(plan.study, plan.label) for plan in planned]
    measurement.points = [p for p in done.points if (p.study, p.label) in measurement.planned] if done else []
    known = {(point.study, point.label): at for at, point in enumerate(measurement.points)}
    for plan in planned:
        at = known.get((plan.study, plan.label))
        if at is not None and plan.study not in more:
            continue
        warm_up(scene, plan)
        point = measure_point(plan, truth_for(plan, truth), REPEATS.get(scene, 3))
        cost, error = f"{1e3 * point.cost:10.3f} ms", f"{point.rms:9.4f} %"
        print(f"{point.status:15s} {cost} {error}  {plan.study}: {plan.label}", flush=True)
        if at is None:
            measurement.points.append(point)
        else:
            measurement.points[at] = cheaper(measurement.points[at], point)
        measurement.save(file)
    measurement.orders = fitted_orders(measurement)
    measurement.save(file)
    draw_work_precision(measurement, file.with_suffix(".png"))


def cheaper(one: Point, other: Point) -> Point:
    """The newer of two measurements of a point with the least cost of both."""
    return replace(other, cost=min(one.cost, other.cost), repeats=one.repeats + other.repeats)


def points_of(scene: str) -> Iterator[Plan]:
    """Those of the study files, and for the free pinion torque those that no file can hold."""
    for name in FILES[scene]:
        study = replace(read_study(STUDIES / f"accuracy_speed_{name}.toml"), scene=scene)
        for case in describe(study, {}).cases:
            setup = setup_of(study, case)
            label = ", ".join(_told(axis, case.values[axis.name]) for axis in study.axes)
            yield Plan.of_scene(name, label, scene, setup.steering_gear, setup.fidelity)
    if scene == "free-pinion-torque":
        yield from explicit_points()
        yield from faceted_points()


def explicit_points() -> Iterator[Plan]:
    """Exudyn's explicit solvers over a tooth pitch."""
    fidelity = Fidelity.preset("flank")
    for solver, steps in EXPLICIT.items():
        for step in steps:
            run = partial(explicit_run, PITCH, fidelity, solver, step)
            yield Plan(
                "explicit", f"{solver}, {1e6 * step:g} us", "explicit", fidelity, PITCH.test.turns, run
            )


def faceted_points() -> Iterator[Plan]:
    """Pinions as they are cut and as they are meshed, over a tooth pitch."""
    for cuts in CUTS:
        left = 1e6 * largest_deviation(PITCH, shaped(cuts))
        yield _faceted("shaping", f"cuts {cuts}, {left:.3g} um", "shaped pinion", shaped(cuts))
    for chord in CHORDS:
        yield _faceted("chord", f"chord error {1e6 * chord:g} um", "meshed pinion", meshed(chord))


def _faceted(study: str, label: str, family: str, surface: Surface) -> Plan:
    run = partial(faceted_run, PITCH, FACETED, surface)
    return Plan(study, label, family, FACETED, PITCH.test.turns, run)


def truth_for(plan: Plan, truth: Truth) -> Truth:
    """The scene's; of faceted pinions the same spheres on the analytic flank."""
    return truth if plan.fidelity is not FACETED else on_analytic_flank(truth.scene)


@cache
def on_analytic_flank(scene: str) -> Truth:
    """The torque of the spheres that sit on facets elsewhere."""
    signals = faceted_run(PITCH, FACETED, None).signals
    curve, lift = (curve_of(scene, signals, PITCH, FACETED, name) for name in ("", "rack_y"))
    return Truth(scene, PITCH, Reference(curve, 0.0, {}), lift)


def _told(axis: Axis, value: Value) -> str:
    """For instance "step_angle 1 deg"."""
    shown = axis_quantity(axis).show(value) if isinstance(value, float) else value
    return f"{axis.name.removeprefix('fidelity.').removeprefix('bush.')} {shown}"


WARM: set[str] = set()


def warm_up(scene: str, plan: Plan) -> None:
    """Once for each kind of model: compiled kernels are loaded, and no point pays for it."""
    fidelity = plan.fidelity
    kind = f"{fidelity.solver} {fidelity.mesh} {fidelity.bush}"
    if kind not in WARM:
        run_scene(scene, SteeringGear().replace({"test.turns": 0.01}), fidelity)
        WARM.add(kind)


def _there(file: Path) -> Measurement | None:
    try:
        return load_measurement(file)
    except InputError:
        return None


if __name__ == "__main__":
    main()
