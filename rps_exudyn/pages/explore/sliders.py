"""The sliders of the page (parameter, range, step), and the answer to one state of them."""

from dataclasses import dataclass
from time import perf_counter
from typing import Any

import numpy as np

from rps_exudyn.analysis.passes import passes
from rps_exudyn.base import units
from rps_exudyn.base.errors import InputError, raise_wrapped
from rps_exudyn.base.units import pretty, words
from rps_exudyn.gears.geometry_report import geometry_report
from rps_exudyn.pages.explore.typed_limits import metrics_of
from rps_exudyn.pages.report.result_sheet import REMARK, WORK_LOST, loss_shares, sheet_of
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.law_error import error_of_law
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.quantities import GEOMETRY, PARTS, SIGNALS
from rps_exudyn.results.result import Result
from rps_exudyn.scenes import SCENE_NAMES, scene_named
from rps_exudyn.scenes.free_pinion_torque import SCENE
from rps_exudyn.scenes.scene import WITHOUT_BARS
from rps_exudyn.simulate.run import simulate
from rps_exudyn.simulate.run_plan import run_unchecked


@dataclass(frozen=True)
class Slider:
    """A parameter's range and step in its shown unit; the same parameter may stand for others, too."""

    path: str
    low: float
    high: float
    step: float
    unit: str = ""

    @property
    def name(self) -> str:
        """The parameter's name in words, for instance "yoke preload"."""
        return units.words(self.path.replace(".", " "))

    def value(self, number: float) -> str | int:
        """The number of the shown unit as a setting of the gear."""
        if self.path == "pinion.teeth":
            return int(number)
        return f"{number:g} {self.unit}".strip()

    def of(self, gear: SteeringGear) -> float:
        """A gear's value in the shown unit, on the slider's grid where it is close to that."""
        value = gear.value_at(self.path)
        item = gear.declared_at(self.path)[0]
        number = units.displayed(value, item.unit.si, self.unit) if item.unit and self.unit else float(value)
        return float(f"{number:.9g}")


SLIDERS = (
    Slider("yoke.preload", 0, 1000, 10, "N"),
    Slider("mesh.friction", 0, 0.3, 0.005),
    Slider("yoke.friction", 0, 0.3, 0.005),
    Slider("pinion.runout", 0, 100, 1, "um"),
    Slider("yoke.clearance", 0, 200, 5, "um"),
    Slider("yoke.spring_rate", 0, 200, 5, "N/mm"),
    Slider("bush.drag", 0, 60, 1, "N"),
    Slider("bearing.friction_torque", 0, 150, 5, "N*mm"),
    Slider("pinion.teeth", 5, 12, 1),
    Slider("pinion.normal_module", 1.2, 2.6, 0.01, "mm"),
    Slider("pinion.helix_angle", 0, 35, 0.5, "deg"),
    Slider("rack.tooth_angle", -5, 20, 0.5, "deg"),
    Slider("pinion.profile_shift", 0.2, 1.3, 0.01),
    Slider("pinion.face_width", 8, 25, 0.5, "mm"),
    Slider("installation.axis_offset", -100, 100, 5, "um"),
    Slider("installation.angle_error", -1, 1, 0.05, "deg"),
    Slider("rack.ratio.centre", 0, 60, 0.1, "mm"),
    Slider("rack.ratio.lock", 0, 60, 0.1, "mm"),
    Slider("rack.ratio.from", 0, 360, 5, "deg"),
    Slider("rack.ratio.to", 0, 720, 5, "deg"),
)
LEAST_TURN = 1e-6  # of the pinion, over which a curve can be drawn [rad]
BY_PATH = {slider.path: slider for slider in SLIDERS}


def settings_of(state: Any) -> dict[str, Any]:
    """Settings of the gear from what a page sends: path -> number in the shown unit.

    Raises:
        InputError: it is no table of numbers of known sliders within their ranges.
    """
    if not isinstance(state, dict):
        raise InputError("the state is no table of sliders.")
    settings, problems = {}, []
    for path, number in state.items():
        slider = BY_PATH.get(path)
        if slider is None:
            problems.append(f"{units.short(str(path))} is no slider of this page.")
        elif isinstance(number, bool) or not isinstance(number, int | float):
            problems.append(f"{path} is {units.shown(number)}; it must be a number.")
        elif not slider.low <= number <= slider.high:
            allowed = f"from {slider.low:g} to {slider.high:g}"
            problems.append(f"{path} is {units.shown(number)}; it must be {allowed}.")
        else:
            settings[path] = slider.value(number)
    if problems:
        raise InputError(problems)
    return settings


# --- The answer: the scene's curve, numbers, losses, geometry; or why there is none

MODELS = {
    "quasi-static": " Quasi-static: equilibria at each instant, without inertia. Friction as given.",
    "flank": " Dynamics by fidelity flank. Friction as given.",
}
SLOW = 0.25  # scenes that take longer show a preview while a slider moves [s]
DRAFT = "draft while a slider moves, without error bars"
MOST_POINTS = 3000  # of a curve
SIZES = (
    *("transverse_contact_ratio", "overlap_ratio", "tip_diameter", "root_diameter"),
    *("undercut_margin", "crest_width"),
)
Answer = dict[str, Any]


@dataclass(frozen=True)
class Wish:
    """What a page asks for.

    Attributes:
        state: path -> number in the slider's unit.
        scene: name of a scene.
        is_both_ways: whether the rig turns there and back.
        measured: bytes of a measured file, as base64.
        is_draft: whether a slider moves, and an answer that nothing confirms will do until it rests.
        limits: metric -> table of what is typed for it.
    """

    state: Any
    scene: str = SCENE.name
    is_both_ways: bool = False
    measured: str = ""
    is_draft: bool = False
    limits: Any = None

    def gear(self, gear: SteeringGear) -> SteeringGear:
        """The gear with the state of the sliders.

        Raises:
            InputError: the state cannot be, or the scene is none of this page.
        """
        if self.scene not in SCENE_NAMES:
            raise InputError(f"{units.shown(self.scene)} is no scene of this page.")
        path = {"test.path": "there-and-back"} if self.is_both_ways else {}
        return gear.replace(settings_of(self.state) | path)

    def result(self, gear: SteeringGear) -> Result:
        """Simulate a gear; a draft is one run through the scene, made once."""
        model = Fidelity.preset(fidelity_of(self.scene))
        if self.is_draft:
            return run_unchecked(self.scene, gear, model, WITHOUT_BARS)
        return simulate(self.scene, gear, model)


def scenes() -> dict[str, Answer]:
    """Scenes -> their titles, and whether they are of dynamics, which is simulated on request."""
    found = {name: scene_named(name) for name in SCENE_NAMES}
    return {name: {"title": each.title, "dynamic": each.needs_inertia} for name, each in found.items()}


def fidelity_of(scene: str) -> str:
    """The preset that the page takes: equilibria wherever the scene can be run by them."""
    return "flank" if scene_named(scene).needs_inertia else "quasi-static"


def answer(gear: SteeringGear, wish: Wish) -> Answer:
    """Answer one state of the sliders; whatever it is, the answer is a table for the page: "problems", which
    are sentences, if this gear cannot exist or be computed; else curves, numbers and remarks, or "on_request"
    and no curve where the scene is one of dynamics."""
    if wish.scene in SCENE_NAMES and scene_named(wish.scene).needs_inertia:
        try:
            return {**_described(wish.gear(gear)), "on_request": True}
        except InputError as error:
            return {"problems": list(error.problems)}
    return simulated(gear, wish)


def simulated(gear: SteeringGear, wish: Wish) -> Answer:
    """Simulate one state of the sliders, of dynamics too; answers as `answer`."""
    began = perf_counter()
    try:
        chosen = wish.gear(gear)
        shown = _described(chosen)
        result = wish.result(chosen)
    except InputError as error:
        return {"problems": list(error.problems)}
    except Exception as error:  # whatever a state nobody has tried does to a solver: the page goes on
        raise_wrapped(error)
        return {"problems": [f"This state cannot be computed: {type(error).__name__}: {error}."]}
    if result.status is not Status.OK:
        return shown | {"problems": [f"{result.status}: {result.message} {result.status.remedy}".strip()]}
    draft = {"draft": DRAFT} if wish.is_draft else {}
    return shown | _drawn(result) | draft | {"ms": 1e3 * (perf_counter() - began)}


def _described(gear: SteeringGear) -> Answer:
    """Sizes and warnings of a gear.

    Raises:
        InputError: the gear cannot exist.
    """
    report = geometry_report(gear)  # without masses, which need solids
    sizes = {words(name): GEOMETRY[name].show(getattr(report, name)) for name in SIZES}
    return {"gear": repr(gear).strip("<>"), "geometry": sizes, "warnings": list(report.warnings)}


def _drawn(result: Result) -> Answer:
    error, signal, along = error_of_law(result), scene_named(result.scene).signal, abscissa(result)
    rows = [row for row in sheet_of(result).rows if row.value not in (WORK_LOST, REMARK)]
    return {
        "curves": curves_of(result, signal, along),
        "along": _label(along),
        "across": _label(signal),
        "rows": [[row.value, row.words, row.is_vague] for row in rows],
        "metrics": metrics_of(result),
        "losses": [[part, PARTS[part], 100 * share] for part, share in loss_shares(result).items()],
        "error": error.largest if error and signal == "pinion_torque" else None,
        "accuracy": (error.sentence if error else "") + MODELS[fidelity_of(result.scene)],
        "fidelity": result.fidelity["name"],
        "remarks": result.message,
    }


def _label(name: str) -> dict[str, str]:
    return {"name": words(name), "unit": pretty(SIGNALS[name].display)}


def abscissa(result: Result) -> str:
    """The signal over which the scene's own is drawn: the pinion's angle where that moves."""
    angle = result.signals.get("pinion_angle")
    return "pinion_angle" if angle is not None and np.ptp(angle) > LEAST_TURN else "time"


def curves_of(result: Result, signal: str, along: str) -> list[Answer]:
    """Curves for the page in display units; of a torque in both directions each against its motion."""
    parts = [(1, result.signals)]
    if along == "pinion_angle" and scene_named(result.scene).steady:
        parts = [(each.direction, each.signals) for each in passes(result.signals)]
    sign = len({direction for direction, _ in parts}) > 1
    found = []
    for direction, signals in parts:
        x = SIGNALS[along].displayed(signals[along])
        y = SIGNALS[signal].displayed((direction if sign else 1) * signals[signal])
        x, y = (np.round(values[thinned(y)], digits).tolist() for values, digits in ((x, 4), (y, 6)))
        found.append({"direction": direction, "x": x, "y": y})
    return found


def thinned(values: np.ndarray) -> np.ndarray:
    """Indices of at most `MOST_POINTS` values, shape (n,): of longer curves the least and the largest of each
    stretch, so that no peak is missing."""
    if values.size <= MOST_POINTS:
        return np.arange(values.size)
    stretches = np.array_split(np.arange(values.size), MOST_POINTS // 2)
    ends = [stretch[[values[stretch].argmin(), values[stretch].argmax()]] for stretch in stretches]
    return np.unique(np.concatenate(ends))
