"""Work against precision of every model, scene by scene; a run goes on where it was stopped.

The points are those of `plans/*.toml`, which `rps-exudyn study` runs too, and for the free pinion torque
those of models that no fidelity describes: pinions as they are cut. Each is run several times in this one
process, and its least CPU time counts. Costs belong to the machine, errors do not: delete SCENE.h5 to measure
again.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cache, partial
from pathlib import Path
from types import MappingProxyType

from benchmarks.accuracy_speed.chart import work_precision_figure
from benchmarks.accuracy_speed.level_points import whole_runs
from benchmarks.accuracy_speed.loop_points import loop_points
from benchmarks.accuracy_speed.measurement import Measurement, PlannedPoint, load_measurement, measure_point
from benchmarks.accuracy_speed.tables import TABLES
from benchmarks.topic import Topic
from rps_exudyn.pages.charts import style
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.provenance import provenance
from rps_exudyn.scenes import scene_named
from rps_exudyn.study.cases import describe, setup_of
from rps_exudyn.study.definition import Axis, Study, Value, axis_quantity
from rps_exudyn.study.study_file import read_study
from verification.faceted import FACETED, Surface, faceted_run, largest_deviation, meshed, shaped
from verification.law_area import by_law
from verification.references import Method, as_run, by_strips, over_generators, reference_of, still
from verification.runs import SceneReference, run_scene
from verification.variants import VARIANTS, of_family, reference_of_variant
from verification.work_precision import Reference

PLANS = Path(__file__).parent / "plans"
OF_TORQUE = (
    "closed_form quasi_static quasi_static_turn spheres_at_rest flank newton bush "
    "general_contact general_contact_step triangles faceted quasi_static_line flank_line quasi_static_teeth "
    "flank_teeth quasi_static_bending flank_bending quasi_static_stribeck flank_stribeck "
    "quasi_static_bristles flank_bristles quasi_static_supported flank_supported loop"
)
OF_TURNING = (
    "closed_form quasi_static flank quasi_static_line flank_line quasi_static_teeth flank_teeth "
    "quasi_static_bending flank_bending quasi_static_stribeck flank_stribeck quasi_static_bristles "
    "flank_bristles"
)
BY_DEFAULT_LAW = "quasi_static_line flank_line"
ON_BRISTLES = "quasi_static_bristles flank_bristles quasi_static_four_bristles flank_four_bristles"
LOADED = "at_rest at_rest_line at_rest_teeth"
FILES = {
    "free-pinion-torque": OF_TORQUE.split(),
    "load-test": OF_TURNING.split(),
    "rack-push": OF_TURNING.split(),
    "reversal": f"quasi_static flank {BY_DEFAULT_LAW} {ON_BRISTLES} reduced".split(),
    "steering-feel": f"{BY_DEFAULT_LAW} {ON_BRISTLES} reduced".split(),
    "yoke-impact": ["newton"],
    "yoke-setting": BY_DEFAULT_LAW.split(),
    "rack-lift": LOADED.split(),
    "radial-play": LOADED.split(),
}
REPEATS = {"free-pinion-torque": 15, "yoke-impact": 1}
CUTS = (50, 100, 200, 400)  # per turn of a shaped pinion
CHORDS = (3e-6, 1e-6, 0.3e-6, 0.1e-6)  # errors of the pinion's triangles [m]
GEAR = by_law(SteeringGear(), "area")  # as of the plans that set no law
PITCH = GEAR.replace({"test.turns": 1 / 6})


def run(
    folder: Path,
    scenes: Mapping[str, Sequence[str]] = MappingProxyType(FILES),
    thinned: Callable[[Study], Study] = lambda study: study,
    methods: Mapping[str, Method] | None = None,
    repeats: Mapping[str, int] = MappingProxyType(REPEATS),
) -> None:
    """Measure the points of these plans, scene by scene, and write their files and charts.

    Where all points of a scene are of variants, its reference is that of the default contact law. `thinned`
    takes points out of a plan; `methods` of the reference are by default those of the scene; `repeats` of a
    point are 3 for other scenes.
    """
    for scene, plans in scenes.items():
        planned = list(points_of(scene, plans, thinned))
        own = any(not of_family(plan.family) for plan in planned)
        reference = reference_of(scene, GEAR, methods) if own else reference_of_variant(scene, "line")
        measure_scene(planned, reference, folder, repeats.get(scene, 3))


def measure_scene(
    planned: Sequence[PlannedPoint], reference: SceneReference, folder: Path, repeats: int
) -> None:
    """Measure what is missing, and write the scene's file and chart."""
    scene = reference.scene
    file = folder / f"{scene}.h5"
    names = [(plan.study, plan.label) for plan in planned]
    known = reference.headline
    measurement = Measurement(scene, known.uncertainty, known.differences, planned=names, origin=provenance())
    before = load_measurement(file).points if file.exists() else []
    measurement.points = [point for point in before if (point.study, point.label) in names]
    missing = measurement.missing
    for plan in planned:
        if (plan.study, plan.label) not in missing:
            continue
        warm_up(scene, plan)
        point = measure_point(plan, reference_for(plan, reference), repeats)
        about = f"{1e3 * point.cost:10.3f} ms {point.rms:9.4f} %  {plan.study}: {plan.label}"
        print(f"{point.status:15s}", about, flush=True)
        measurement.points.append(point)
        measurement.save(file)
    if measurement.points != before:  # else the file keeps its origin
        measurement.save(file)
    whole = whole_runs(folder, scene)
    style.save(work_precision_figure(measurement, whole), file.with_suffix(".png"))


def points_of(scene: str, plans: Sequence[str], thinned: Callable[[Study], Study]) -> Iterator[PlannedPoint]:
    """Points of study files; those of `BUILT` no file can hold."""
    for name in plans:
        if name in BUILT:
            yield from BUILT[name](scene)
            continue
        study = thinned(replace(read_study(PLANS / f"{name}.toml"), scene=scene))
        for case in describe(study, {}).cases:
            setup = setup_of(study, case)
            label = ", ".join(_shown(axis, case.values[axis.name]) for axis in study.axes)
            gear = setup.steering_gear
            gear = gear if "mesh.law" in study.settings else by_law(gear, "area")  # known in three ways
            yield PlannedPoint.of_scene(name, label, scene, gear, setup.fidelity)


def faceted_points(scene: str) -> Iterator[PlannedPoint]:
    """Pinions as they are cut and as they are meshed, over a tooth pitch."""
    for cuts in CUTS:
        left = 1e6 * largest_deviation(PITCH, shaped(cuts))
        yield _faceted("shaping", f"cuts {cuts}, {left:.3g} um", "shaped pinion", shaped(cuts))
    for chord in CHORDS:
        yield _faceted("chord", f"chord error {1e6 * chord:g} um", "meshed pinion", meshed(chord))


def _faceted(study: str, label: str, family: str, surface: Surface) -> PlannedPoint:
    run = partial(faceted_run, PITCH, FACETED, surface)
    return PlannedPoint(study, label, family, FACETED, PITCH.test.turns, run)


def reference_for(plan: PlannedPoint, reference: SceneReference) -> SceneReference:
    """The scene's reference; for faceted pinions a solid of much finer triangles, for models of other
    physics the same in finer steps and stations."""
    if name := of_family(plan.family):
        return reference_of_variant(reference.scene, name)
    return reference if plan.fidelity is not FACETED else on_fine_solid(reference.scene)


@cache
def on_fine_solid(scene: str) -> SceneReference:
    """Reference of faceted pinions: the torque of a solid within ten nanometres."""
    signals = faceted_run(PITCH, FACETED, meshed(1e-8)).signals
    curve, lift = (scene_named(scene).curve(signals, PITCH, FACETED, name) for name in ("", "rack_y"))
    return SceneReference(scene, PITCH, Reference(curve, 0.0, {}), lift)


def _shown(axis: Axis, value: Value) -> str:
    """Label of a value, for instance "step_angle 1 deg"."""
    shown = axis_quantity(axis).show(value) if isinstance(value, float) else value
    return f"{axis.name.removeprefix('fidelity.').removeprefix('bush.')} {shown}"


WARM: set[str] = set()


def warm_up(scene: str, plan: PlannedPoint) -> None:
    """Load compiled kernels once for each kind of model, so that no point pays for it."""
    fidelity = plan.fidelity
    kind = f"{plan.family} {fidelity.solver} {fidelity.mesh} {fidelity.bush}"
    if kind not in WARM:
        name = "triangles" if plan.fidelity is FACETED else of_family(plan.family)
        gear = SteeringGear().replace(dict(VARIANTS[name].gear)) if name else GEAR
        run_scene(scene, gear.replace({"test.turns": 0.01}), fidelity)
        WARM.add(kind)


BUILT = {"faceted": faceted_points, "loop": loop_points}

COARSE = {"generators": over_generators(40, as_run(still("3 deg"))), "strips": as_run(by_strips("3 deg"))}

TOPIC = Topic(
    "45 min",
    "accuracy_speed",
    run,
    {
        "scenes": {"free-pinion-torque": ["closed_form", "quasi_static"]},
        "thinned": Study.toy,
        "methods": COARSE,
        "repeats": {"free-pinion-torque": 1},
    },
    TABLES,
)
