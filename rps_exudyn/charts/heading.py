"""Headline of a result's picture: scene and its figures, the gear, and its failure in words."""

from collections.abc import Mapping

from matplotlib.figure import Figure

from rps_exudyn.base.units import mm
from rps_exudyn.charts import style
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.quantities import SUMMARY
from rps_exudyn.results.result import Result
from rps_exudyn.scenes import is_scene, scene_named


def head(figure: Figure, result: Result, subject: str, figures: Mapping[str, str]) -> None:
    """Write the headline; `figures` are the summary's names -> labels, skipped if they are not in it."""
    parts = [subject] + [
        f"{label} {SUMMARY[name].show(result.summary[name])}"
        for name, label in figures.items()
        if name in result.summary
    ]
    failure = "" if result.status is Status.OK else f"{result.status}: {result.message}"
    style.title(figure, f"{' · '.join(parts)}\n{about(result)}", failure)


def scene_of(result: Result) -> str:
    """The scene's name in words, for instance "Load test"."""
    return result.scene.replace("-", " ").capitalize()


def about(result: Result) -> str:
    """What was simulated in one line: gear, preload, speed where there is one, fidelity."""
    gear = result.gear
    size = f"{gear.pinion.teeth} teeth, module {mm(gear.pinion.normal_module)}"
    parts = [size, f"preload {gear.yoke.preload:g} N"]
    if not is_scene(result.scene) or scene_named(result.scene).at_test_speed:
        parts.append(next(item for item in SteeringGear.declared_at("test.speed")).show(gear.test.speed))
    return " · ".join([*parts, f"fidelity {result.fidelity['name']}"])
