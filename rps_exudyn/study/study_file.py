"""Study files: what the TOML file may contain, and every mistake in it reported before anything runs.

    title = "Free pinion torque over preload and friction"
    scene = "free-pinion-torque"
    fidelity = "quasi-static"
    gear = "gears/paper.toml"        # beside or below the study file; without it the paper's gear
    design = "grid"                  # or latin-hypercube, sobol, random, morris, saltelli, uncertain
    time_limit = "60 s"              # of one case

    [set]                            # parameters of all cases
    test.turns = 1
    fidelity.step_angle = "1 deg"

    [[axis]]
    path = "yoke.preload"
    linspace = ["100 N", "600 N", 6]

    [keep]
    signals = ["pinion_torque", "rack_y"]   # or "all", "none"
    samples = 121

docs/studies.md explains every key.
"""

from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.progress import reached
from rps_exudyn.base.units import short, shown, to_si
from rps_exudyn.inference.uncertainty.joint import correlated, read_pairs
from rps_exudyn.parameters.declaration import read_toml
from rps_exudyn.parameters.fidelity import PRESETS, preset_table
from rps_exudyn.parameters.gear import CORRELATION, SteeringGear
from rps_exudyn.results.block import Keep
from rps_exudyn.results.quantities import SIGNALS
from rps_exudyn.scenes import SCENE_NAMES
from rps_exudyn.simulate.by_accuracy import AccuracyGoal
from rps_exudyn.study.axis_tables import check_twice, read_axes
from rps_exudyn.study.definition import DESIGNS, FIDELITY, GRID_DESIGN, UNCERTAIN_DESIGN, Axis, Study
from rps_exudyn.study.designs import ends, uncertain_axes
from rps_exudyn.study.toml_keys import Keys

MODEL_KEYS = ("scene", "gear", "fidelity", "accuracy", "metrics", "set")
DESIGN_KEYS = ("axis", "design", "samples", "seed", "inputs", CORRELATION)
KEYS = ("title", *MODEL_KEYS, *DESIGN_KEYS, "time_limit", "keep")
CORRELATED_DESIGNS = ("latin-hypercube", "sobol", "random", UNCERTAIN_DESIGN)
MOST_SAMPLES = 1_000_000
MOST_PROBLEMS = 10  # of axes, reported at once


def read_study(path: str | Path) -> Study:
    """The study in a TOML file.

    Raises:
        InputError: everything that is wrong with it: file, key, and what is allowed.
    """
    return study_of(Path(path), read_toml(path))


def study_of(file: Path, content: Mapping[str, Any]) -> Study:
    """The study in the tables of a TOML file.

    Raises:
        InputError: as `read_study`.
    """
    reader = _StudyKeys(file)
    study = reader.study(content)
    if not reader.problems:
        with reader.gathering():
            study.base  # noqa: B018 - read to raise its errors
    if not reader.problems:
        reader.problems += _problems_of_axes(study)
    if reader.problems:
        raise InputError(reader.problems)
    return study


class _StudyKeys(Keys):
    """Reads the keys of a study file."""

    def study(self, content: Mapping[str, Any]) -> Study:
        for key in content.keys() - set(KEYS):
            self.wrong(short(key), f"is no key of a study; there are {', '.join(KEYS)}.")
        design = self.choice(content, "design", DESIGNS, GRID_DESIGN)
        preset = self.choice(content, "fidelity", tuple(PRESETS), "flank")
        settings = self.flat(self.table(content, "set"), "set")
        gear = self.gear(content)
        axes, shared = self.axes(content, design, gear, settings)
        accuracy_goal, keep = self.accuracy_goal(content, settings, axes), self.table(content, "keep")
        return Study(
            file=self.file,
            title=self.text(content, "title", self.file.stem),
            scene=self.choice(content, "scene", SCENE_NAMES, SCENE_NAMES[0]),
            tables={**gear, "fidelity": preset_table(preset)},
            settings=settings,
            axes=axes,
            design=design,
            samples=self.samples(content, design),
            seed=self.whole(content, "seed", 0, 0, 2**32 - 1),
            time_limit=self.time_limit(content),
            keep=self.keep(keep),
            accuracy_goal=accuracy_goal,
            blocks=self.blocks(keep),
            correlation=self.correlation(content, design, axes, shared),
        )

    def axes(
        self, content: Mapping[str, Any], design: str, gear: Mapping[str, Any], settings: Mapping[str, Any]
    ) -> tuple[tuple[Axis, ...], Mapping[str, float]]:
        """The axes of the file's tables, and of an uncertain design's parameters, with what these share."""
        if "inputs" in content and design != UNCERTAIN_DESIGN:
            self.wrong("inputs", f"has no meaning for the design {design}; it is for {UNCERTAIN_DESIGN}.")
        uncertain = design == UNCERTAIN_DESIGN
        axes: tuple[Axis, ...] = ()
        if "axis" in content or not uncertain:
            axes = read_axes(self, content.get("axis", []), design == GRID_DESIGN)
            check_twice(self, axes, settings)
        if not uncertain or self.problems:
            return axes, {}
        of_gear = {path: value for path, value in settings.items() if not path.startswith(FIDELITY)}
        with self.gathering():
            others, shared = uncertain_axes(gear, of_gear, self.text(content, "inputs", ""), axes)
            return axes + others, shared
        return axes, {}

    def correlation(
        self, content: Mapping[str, Any], design: str, axes: tuple[Axis, ...], shared: Mapping[str, float]
    ) -> dict[str, float]:
        """ "axis, axis" -> correlation, of the file before that of what the axes share."""
        if CORRELATION in content and design not in CORRELATED_DESIGNS:
            allowed = ", ".join(CORRELATED_DESIGNS)
            self.wrong(CORRELATION, f"has no meaning for the design {design}; it is for {allowed}.")
        problems: list[str] = []
        own = read_pairs(content.get(CORRELATION, {}), CORRELATION, problems)
        pairs = read_pairs(shared, CORRELATION, problems) | own
        names = [axis.name for axis in axes]
        for name in {name for pair in own for name in pair} - set(names):
            self.wrong(CORRELATION, f"names {name}, which is no axis; there are {', '.join(names)}.")
        self.problems += [f"{self.file}: {problem}" for problem in problems]
        if not self.problems:
            with self.gathering():
                correlated(np.full((1, len(names)), 0.5), names, pairs)
        return {", ".join(sorted(pair)): value for pair, value in pairs.items()}

    def accuracy_goal(
        self, content: Mapping[str, Any], settings: Mapping[str, Any], axes: tuple[Axis, ...]
    ) -> AccuracyGoal | None:
        """The accuracy to which each case climbs the ladder; None: each is run once, with its bars."""
        if "accuracy" not in content:
            if "metrics" in content:
                self.wrong("metrics", "are those that accuracy keeps; give accuracy, too.")
            return None
        own = [*settings, *(path for axis in axes for path in (*axis.paths, *axis.along))]
        if own := [path for path in own if path.startswith(FIDELITY)]:
            self.wrong("accuracy", f"chooses the model itself; leave out {', '.join(own)}.")
        metrics, preset = content.get("metrics", []), content.get("fidelity")
        if not isinstance(metrics, list):
            self.wrong("metrics", f"is {shown(metrics)}; it must be a list of names.")
        elif preset is None or preset in PRESETS:  # else said already
            with self.gathering():
                return AccuracyGoal.of(self.text(content, "accuracy", ""), metrics, preset)
        return None

    def gear(self, content: Mapping[str, Any]) -> dict[str, Any]:
        """The gear file's tables; it must lie in the study file's folder or below."""
        if "gear" not in content:
            return {}
        given = Path(self.text(content, "gear", "."))
        folder = self.file.resolve().parent
        if given.is_absolute() or not (folder / given).resolve().is_relative_to(folder):
            self.wrong(
                "gear", f"is {shown(content['gear'])}; it must lie in the study file's folder or below it."
            )
            return {}
        with self.gathering():
            tables = SteeringGear.tables_in(self.file.parent / given)
            if "fidelity" in tables:
                self.wrong("gear", "has a table fidelity, which is no part of a gear; put it under [set].")
            return tables
        return {}

    def samples(self, content: Mapping[str, Any], design: str) -> int:
        if design == GRID_DESIGN:
            if "samples" in content:
                self.wrong("samples", "has no meaning for a grid; its axes give the number of cases.")
            return 0
        if "samples" not in content:
            self.wrong("samples", f"is missing: how many points the {design} design draws.")
            return 0
        return self.whole(content, "samples", 1, 1, MOST_SAMPLES)

    def time_limit(self, content: Mapping[str, Any]) -> float:
        given = content.get("time_limit", "600 s")
        try:
            limit = to_si(given, "s")
        except ValueError as error:
            self.wrong("time_limit", f"{error}.")
            return 600.0
        if not 0 < limit < np.inf:
            self.wrong("time_limit", f"is {shown(given)}; it must be more than 0 s and finite.")
        return limit

    def blocks(self, content: Mapping[str, Any]) -> bool | None:
        blocks = content.get("blocks")
        if blocks is None or isinstance(blocks, bool):
            return blocks
        self.wrong("keep.blocks", f"is {shown(blocks)}; it must be true or false.")
        return None

    def keep(self, content: Mapping[str, Any]) -> Keep:
        for key in content.keys() - {"signals", "samples", "blocks"}:
            self.wrong(f"keep.{key}", "is no key of keep; there are signals, samples, blocks.")
        samples = self.whole(content, "samples", 2, 2, 10**9) if "samples" in content else None
        signals = content.get("signals", "all")
        if signals in ("all", "none"):
            return Keep(None if signals == "all" else (), samples)
        if not isinstance(signals, list) or any(name not in SIGNALS for name in signals):
            if isinstance(signals, list):
                signals = [name for name in signals if name not in SIGNALS]
            allowed = f'"all", "none", or names of {", ".join(SIGNALS)}'
            self.wrong("keep.signals", f"has {shown(signals)}; it must be {allowed}.")
            return Keep()
        return Keep(tuple(name for name in SIGNALS if name in ("time", "pinion_angle", *signals)), samples)


def _problems_of_axes(study: Study) -> list[str]:
    """Return what is wrong with each value of an axis, or each end of its distribution, alone in the base."""
    problems: dict[str, None] = {}
    for axis in study.axes:
        values = ends(axis) if axis.values is None else axis.values
        for number, value in enumerate(values):
            reached(number / len(values), partial("{} values checked".format, number))
            try:
                study.setup(axis.settings(value))
            except InputError as error:
                problems |= {f"{study.file}: axis {axis.name}: {problem}": None for problem in error.problems}
    more = len(problems) - MOST_PROBLEMS
    return [*problems][:MOST_PROBLEMS] + [f"{study.file}: {more} more like these."] * (more > 0)
