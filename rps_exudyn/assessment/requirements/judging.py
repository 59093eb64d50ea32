"""Evaluating the requirements of a gear: each number with its band, and whether it is kept.

A requirement is kept if at least `ASSURED` of the gears drawn keep it; samples that failed do not, and where
they decide it is open. Numbers that hang on the teeth alone have no band. What a gear does not let compute is
not evaluated, with the cause; the others still are.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from itertools import pairwise

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.flank_grid import measured_flanks
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.geometry_limits import transverse_contact_ratio
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.gears.tooth_strength import (
    RootTeeth,
    bearing_face,
    flank_sharing,
    flank_stress,
    pinion_teeth,
    rack_teeth,
    root_load_factor,
    weakest,
)
from rps_exudyn.inference.uncertainty.band import LEFT_OUT, Band, band_of_runs, nominal_result
from rps_exudyn.inference.uncertainty.quick_band import SCENE as TURN_FREELY
from rps_exudyn.inference.uncertainty.quick_band import quick_band
from rps_exudyn.parameters.distribution import Distribution
from rps_exudyn.parameters.fidelity import FOR_MEANS
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.parameters.wrong_values import nearest_names
from rps_exudyn.results.judged_row import JudgedRow, Verdict
from rps_exudyn.results.limit import Limit
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.quantities import SUMMARY
from rps_exudyn.results.requirements import REQUIRED, quantity_of
from rps_exudyn.scenes.contact_law import LAW_OF_SERIES, resolve_contact_law
from rps_exudyn.scenes.load_test import SCENE as LOAD_TEST
from rps_exudyn.scenes.rack_lift import SCENE as RACK_LIFT
from rps_exudyn.simulate.run import simulate
from rps_exudyn.solvers.closed_form import GRAVITY, load_test, mean_gain

ASSURED = 0.95  # of the gears
FEWEST = 8  # samples of a band
RATED_TORQUE = 30.0  # [N m]
LIGHTEST, HEAVIEST = 0.5, 400.0  # weights between which a kept efficiency is looked for [kg]
NO_FACE_LOADING = "face load factor is 1, because contact forces are missing: "
LABELS_OF_FACE = {"load_centre": "load centre", "contact_pressure_max": "pressure"}
BY_RUNS = {
    "free_torque": (TURN_FREELY, "torque_mean"),
    "variation_on_centre": (TURN_FREELY, "torque_on_centre_variation"),
    "variation_off_centre": (TURN_FREELY, "torque_off_centre_variation"),
    "efficiency_ratio": (LOAD_TEST.name, "efficiency_ratio"),
    "rated_lift": (RACK_LIFT.name, "rack_lift"),
}
"""Requirement -> scene and metric; all others follow from the teeth alone."""
STEPS = {TURN_FREELY: "free torque and its variation", LOAD_TEST.name: "efficiencies", RACK_LIFT.name: "lift"}
"""Scene that the sheet runs -> what is computed by it."""
BY_GEOMETRY: Mapping[str, Callable[[SteeringGear], float]] = {
    "travel": lambda gear: 2 * RackBar.of(gear).largest_displacement,
    "gain": lambda gear: 2 * np.pi * mean_gain(gear.with_unchecked({"test.path": "lock-to-lock"})),
}
"""Requirement -> its number, from the gear's geometry."""


def _root_stress(teeth: RootTeeth, torque: float, face_load_factor: float) -> float:
    stress, local, form = weakest(teeth, torque)
    return root_load_factor(GearPair.of(local), form, face_load_factor) * stress


STRESSES: Mapping[str, Callable[[SteeringGear, float, float], float]] = {
    "rated_root_pinion": lambda gear, *loads: _root_stress(pinion_teeth(gear), *loads),
    "rated_root_rack": lambda gear, *loads: _root_stress(rack_teeth(gear), *loads),
    "rated_flank": lambda gear, torque, factor: float(np.sqrt(factor)) * flank_stress(gear, torque),
}
"""Requirement -> its number, from gear, torque [N m] and face load factor: the standard's stress times
K_F-beta at a root, times the square root of K_H-beta at the flank; all other K are 1."""
BandOf = Callable[[str], Band]
"""Scene -> its band."""


@dataclass(frozen=True, kw_only=True)
class RequirementRow(JudgedRow):
    """One requirement, by the number of the gear as given; the remark has the cause where there is none."""

    limit: Limit
    share: float  # of the gears that keep the limit
    error: float = 0.0  # half width of the number's error bar, nan: unknown

    @property
    def is_close(self) -> bool:
        """Whether the number lies within its error bar of a limit."""
        return any(abs(self.value - end) < self.error for end in (self.limit.least, self.limit.most))

    @property
    def margin(self) -> float:
        """How far the band of 90 % lies within the limit; negative: how far it reaches beyond."""
        return min(self.low - self.limit.least, self.limit.most - self.high)


def requirement_row(
    name: str,
    limit: Limit,
    numbers: tuple[float, float, float],
    share: float,
    failed: float = 0.0,
    remark: str = "",
) -> RequirementRow:
    """Judge one requirement by the share of the gears that keep it.

    Args:
        name: of the requirement.
        limit: to be kept.
        numbers: nominal number, 5 % and 95 % of its band; nan where it is not evaluated.
        share: of the gears that keep the limit.
        failed: share of the samples that gave no number.
        remark: cause or hint.
    """
    value, low, high = numbers
    if np.isnan(value):
        verdict = Verdict.NOT_EVALUATED
    elif share >= ASSURED:
        verdict = Verdict.PASS
    else:
        verdict = Verdict.UNDECIDED if share + failed >= ASSURED else Verdict.FAIL
    return RequirementRow(
        name=name, value=value, low=low, high=high, verdict=verdict, remark=remark, limit=limit, share=share
    )


def judge(
    gear: SteeringGear,
    inputs: Mapping[str, Distribution],
    limits: Mapping[str, Limit],
    rated_torque: float = RATED_TORQUE,
    samples: int = 48,
    on_progress: Callable[[str, float], None] | None = None,
    jobs: int = 1,
) -> Iterator[RequirementRow]:
    """Yield every requirement that has a limit, in the order of `limits.REQUIRED`, then the metrics.

    Args:
        gear: its own load mass is the weight of the efficiencies.
        inputs: distributions of its parameters, for the bands.
        limits: name -> limit.
        rated_torque: on the pinion [N m].
        samples: of each band.
        on_progress: called with what is computed, and the share of all samples that is done.
        jobs: number of processes, for bands that are worth them.

    Raises:
        InputError: a rated torque that is none, or a metric that no scene of the sheet has.
    """
    if not rated_torque > 0:
        raise InputError(f"the rated torque is {rated_torque:g} N m; it must be more than 0 N m.")
    sources = sources_of(limits, gear, inputs, rated_torque)
    few = max(samples // 2, FEWEST)
    counts = {scene: samples if scene == TURN_FREELY else few for scene in STEPS}
    counts = {scene: counts[scene] for scene in STEPS if scene in {of for of, _ in sources.values()}}

    def band_of(scene: str) -> Band:
        names = list(counts)
        before = sum(counts[each] for each in names[: names.index(scene)])
        text = f"{STEPS[scene]} under {rated_torque:g} N m" if scene == RACK_LIFT.name else STEPS[scene]

        def report(done: int, of: int) -> None:
            if on_progress is not None:
                on_progress(text, (before + done) / sum(counts.values()))

        report(0, 1)
        runs = quick_band if scene == TURN_FREELY else partial(band_of_runs, scene)
        tested = as_tested(gear, scene, rated_torque)
        return runs(tested, FOR_MEANS, inputs, counts[scene], on_progress=report, jobs=jobs)

    one = _Judged(gear, limits, rated_torque, band_of)
    computed = {"efficiency_ratio": one.efficiency, **one.without_runs}
    for name in sorted(limits, key=[*REQUIRED, *sources].index):
        yield one.row(name, computed.get(name) or partial(one.of_band, name, *sources[name]))


def numbers_without_runs(
    names: Iterable[str], gear: SteeringGear, limits: Mapping[str, Limit], rated_torque: float
) -> dict[str, float]:
    """Return those requirements that follow from a gear's teeth alone; nan of one that cannot be computed."""
    one = _Judged(gear, limits, rated_torque)
    return {name: one.row(name, one.without_runs[name]).value for name in names}


def sources_of(
    names: Iterable[str], gear: SteeringGear, inputs: Mapping[str, Distribution], rated_torque: float
) -> dict[str, tuple[str, str]]:
    """Return name -> scene and metric of those requirements and metrics that runs give. The scene of a metric
    is the first of the sheet's in which the gear at the medians has it.

    Raises:
        InputError: a metric that none of them has.
    """
    names = list(names)
    found = {name: BY_RUNS[name] for name in names if name in BY_RUNS}
    missing, had, problems = [name for name in names if name not in REQUIRED], dict[str, str](), list[str]()
    for scene in STEPS if missing else ():
        with suppress(InputError):  # of a gear that fails there, which the rows of that scene state
            tested = as_tested(gear, scene, rated_torque)
            for metric in nominal_result(scene, tested, FOR_MEANS, inputs).summary:
                if metric not in LEFT_OUT:
                    had.setdefault(metric, scene)
        found |= {name: (had[name], name) for name in missing if name in had}
        missing = [name for name in missing if name not in had]
    for name in missing:
        near = nearest_names(name, list(had), REQUIRED)
        problems.append(f"the tests of this gear ({', '.join(STEPS)}) have no {name}; {near}.")
    if problems:
        raise InputError(problems)
    return found


def as_tested(gear: SteeringGear, scene: str, rated_torque: float) -> SteeringGear:
    """Return the gear with the test of one of the sheet's scenes."""
    return gear.replace(settings_of_test(gear, scene, rated_torque))


def settings_of_test(gear: SteeringGear, scene: str, rated_torque: float) -> dict[str, object]:
    """Return path -> value of the test of one of the sheet's scenes.

    It turns freely over a turn about the centre, or lock to lock where the torque changes along the travel.
    """
    if scene == LOAD_TEST.name:
        return {"test.path": "there-and-back", "test.turns": 2 / gear.pinion.teeth}
    if scene == RACK_LIFT.name:
        return {"test.lift_torque": rated_torque}
    changing = (
        not gear.rack.ratio.is_constant
        or gear.rack.bow
        or gear.rack.pitch_errors
        or measured_flanks(gear).change_along_travel
    )
    if changing or gear.installation.gravity:
        return {"test.path": "lock-to-lock"}
    start = -np.pi * gear.test.direction
    return {"test.path": "there-and-back", "test.start_angle": start, "test.turns": 1.0}


def law_of_sheet(gear: SteeringGear) -> str:
    """Return the contact law of the sheet's runs."""
    return resolve_contact_law(gear, FOR_MEANS, LAW_OF_SERIES).mesh.contact_law


@dataclass(frozen=True)
class FaceLoading:
    """How the teeth bear the rated torque along the face that bears."""

    factor: float  # K_H-beta; 1 where it is not known
    words: str
    error: float = 0.0  # numerical, of the factor


def borne_under(gear: SteeringGear, torque: float) -> FaceLoading:
    """Return how the flanks bear while the rated torque [N m] raises a weight, by the contact forces."""
    try:
        mass = torque / (float(GearPair.of(gear).gain) * GRAVITY)
        mass *= torque / abs(load_test(gear, mass).torque_forward)
        pitch = {"test.path": "one-way", "test.turns": 1 / gear.pinion.teeth, "test.load_mass": mass}
        result = simulate(LOAD_TEST.name, gear.replace(pitch), FOR_MEANS)
    except InputError as error:
        return FaceLoading(1.0, NO_FACE_LOADING + " ".join(error.problems))
    if result.status is not Status.OK or "face_load_factor" not in result.summary:
        return FaceLoading(1.0, f"{NO_FACE_LOADING}{result.status} {result.message}")
    pair, summary = GearPair.of(gear), result.summary
    factor = max(1.0, summary["face_load_factor"] * bearing_face(pair) / pair.face_width)
    found = [f"{text} {SUMMARY[name].show(summary[name])}" for name, text in LABELS_OF_FACE.items()]
    how = f"by the contact forces under {mass:.3g} kg, law {result.gear.mesh.law}"
    moved = result.errors.get("face_load_factor", 0.0) * bearing_face(pair) / pair.face_width
    return FaceLoading(factor, f"face load factor {factor:.2f} {how}: {', '.join(found)}", moved)


@dataclass(frozen=True)
class _Judged:
    """A gear whose requirements are judged."""

    gear: SteeringGear
    limits: Mapping[str, Limit]
    rated_torque: float
    band_of: BandOf | None = None
    bands: dict[str, Band | InputError] = field(default_factory=dict)  # of scenes that were run

    @cached_property
    def pair(self) -> GearPair:
        return GearPair.of(self.gear)

    @property
    def without_runs(self) -> dict[str, Callable[[], RequirementRow]]:
        """Requirements that have no band."""
        return {
            "rated_root_pinion": lambda: self.root("rated_root_pinion", pinion_teeth(self.gear)),
            "rated_root_rack": lambda: self.root("rated_root_rack", rack_teeth(self.gear)),
            "rated_flank": self.flank,
            **{name: partial(self.of_geometry, name) for name in BY_GEOMETRY},
        }

    @cached_property
    def bears(self) -> FaceLoading:
        return borne_under(self.gear, self.rated_torque)

    def band(self, scene: str) -> Band:
        """The band of a scene, computed once.

        Raises:
            InputError: there is none.
        """
        if scene not in self.bands and self.band_of is not None:
            try:
                self.bands[scene] = self.band_of(scene)
            except InputError as error:
                self.bands[scene] = error
        if isinstance(found := self.bands[scene], InputError):
            raise found
        return found

    def row(self, name: str, computed: Callable[[], RequirementRow]) -> RequirementRow:
        """One requirement, not evaluated with the cause where computing it fails."""
        try:
            row = computed()
        except InputError as error:
            return self.not_evaluated(name, error)
        if not row.is_close:
            return row
        half = quantity_of(name).show(row.error)
        close = f"Too close to the limit to tell within the numerical error, ± {half}"
        return replace(row, remark="; ".join(each for each in (close, row.remark) if each))

    def not_evaluated(self, name: str, error: InputError) -> RequirementRow:
        """A requirement without a number."""
        cause = f"Not evaluated: {' '.join(error.problems)}"
        return requirement_row(name, self.limits[name], (np.nan,) * 3, 0.0, remark=cause)

    def of_geometry(self, name: str) -> RequirementRow:
        """A requirement that follows from the geometry."""
        return self.exact(name, BY_GEOMETRY[name](self.gear))

    def exact(self, name: str, value: float, error: float = 0.0) -> RequirementRow:
        """A requirement of one number; half of its error bar is `error`."""
        value, limit = float(value), self.limits[name]
        return replace(requirement_row(name, limit, (value,) * 3, float(limit.keeps(value))), error=error)

    def of_band(self, name: str, scene: str, metric: str) -> RequirementRow:
        """Judge a metric by the band of a scene: the share of its runs; failed ones keep nothing."""
        band = self.band(scene)
        if metric not in band.metrics:
            raise InputError(f"the runs give no {metric}.")
        limit, numbers = self.limits[name], band.drawn.numbers[metric]
        known = numbers[np.isfinite(numbers)]
        share = float(np.count_nonzero(limit.keeps(known)) / numbers.size)
        found, missing = band.metrics[metric], numbers.size - known.size
        cause = next(iter(band.drawn.failures), "")
        remark = f"{missing} of {numbers.size} samples failed, most often {cause}" if missing else ""
        values = band.nominal.summary[metric], found.low, found.high
        row = requirement_row(name, limit, values, share, missing / numbers.size, remark)
        return replace(row, error=band.nominal.errors.get(metric, 0.0))

    def efficiency(self) -> RequirementRow:
        """The ratio of the efficiencies, and the weight that it would take."""
        gear = self.gear
        judged = self.of_band("efficiency_ratio", *BY_RUNS["efficiency_ratio"])
        weight = f"With {gear.test.load_mass:.4g} kg; the ratio is about 1 − (T₀ / W s′)²"
        if judged.verdict is Verdict.PASS:
            return replace(judged, remark=weight)
        enough = weight_for_ratio(gear, judged.limit.least)
        found = f"it would take {enough:.3g} kg" if enough else f"no weight up to {HEAVIEST:g} kg is enough"
        return replace(judged, remark=f"{weight}: {found} at the medians, by the closed form")

    def stressed(self, name: str, remark: str) -> RequirementRow:
        """A stress with its error by that of the face load factor."""
        bears, stress = self.bears, partial(STRESSES[name], self.gear, self.rated_torque)
        value = stress(bears.factor)
        row = self.exact(name, value, stress(bears.factor + bears.error) - value)
        return replace(row, remark=f"{_face(self.pair)}, {remark}")

    def root(self, name: str, teeth: RootTeeth) -> RequirementRow:
        """The stress at a root, and what was chosen for it."""
        _, local, form = weakest(teeth, self.rated_torque)
        factor = root_load_factor(GearPair.of(local), form, self.bears.factor)
        inclined = f"Y_beta of this part's {np.degrees(form.helix):.3g} deg, load at the tip of a tooth"
        known = (
            f"factor {factor:.2f} at the root of face load factor {self.bears.factor:.2f}, all other K = 1"
        )
        return self.stressed(name, f"{inclined}, {known}")

    def flank(self) -> RequirementRow:
        """The contact stress, and what was chosen for it."""
        ratio, shared = transverse_contact_ratio(self.pair), flank_sharing(self.pair)
        sharing = f"Z_epsilon {shared:.3g} for a contact ratio of {ratio:.2g}"
        return self.stressed("rated_flank", f"{sharing}, all other K = 1; {self.bears.words}")


def _face(pair: GearPair) -> str:
    face = bearing_face(pair)
    whose = "as the bar leaves it at the rack's tips" if face < pair.face_width else "that of the pinion"
    return f"Face {1e3 * face:.3g} mm, {whose}"


def weight_for_ratio(gear: SteeringGear, ratio: float) -> float | None:
    """Return the least weight with which reverse over forward efficiency reaches a ratio, by the closed form
    [kg]; None if none does."""

    from scipy.optimize import brentq

    def beyond(mass: float) -> float:
        return load_test(gear, mass).efficiency_ratio - ratio

    masses = np.geomspace(LIGHTEST, HEAVIEST, 40)
    for lighter, heavier in pairwise(masses.tolist()):
        if beyond(heavier) >= 0:
            return float(brentq(beyond, lighter, heavier, xtol=1e-6)) if beyond(lighter) < 0 else lighter
    return None
