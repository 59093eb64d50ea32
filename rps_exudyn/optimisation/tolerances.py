"""Tolerances with costs, in a file of the optimisation's form; mistakes in it are reported before any run.

share = "95 %"                              # of the gears must keep all limits
samples = 2048                              # gears that serve all sets of classes

[tolerances.pinion.runout]                  # class = [scatter, cost]
"quality 8" = ["uniform(0 um, 30 um)", 0]
"quality 6" = ["uniform(0 um, 15 um)", 2.5]

[constraints.torque_peak_to_peak]           # or `requirements`, as of an optimisation
most = "0.25 N*m"
share = "99 %"                              # of the gears must keep this one

All keys that both files have mean the same; `errors` are those of all other parameters.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from math import isfinite, prod
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from rps_exudyn.assessment.requirements.judging import ASSURED
from rps_exudyn.base.units import shown, to_si
from rps_exudyn.inference.uncertainty.input_sets import SETS, outside, uncertain_inputs
from rps_exudyn.inference.uncertainty.joint import JointInputs
from rps_exudyn.optimisation.definition import NONE, OF_STUDIES, Problem, ProblemKeys
from rps_exudyn.parameters.distribution import Distribution

KEYS = (
    *OF_STUDIES,
    *("errors", "samples", "confirm", "share", "limits", "requirements", "tolerances", "constraints"),
)
SIZES = {"samples": (2048, 64, 10**5)}  # default, least and most
MOST_SETS = 20_000  # of classes: each has a weight for every gear


class ToleranceClass(NamedTuple):
    """A class of a tolerance: how the parameter scatters by it, and what it costs."""

    name: str
    scatter: Distribution
    cost: float

    @property
    def width(self) -> float:
        """From the least to the greatest value [SI]."""
        low, high = self.scatter.ends
        return high - low


@dataclass(frozen=True)
class ToleranceProblem:
    """Which classes to choose from, for which limits.

    Attributes:
        problem: the gear, its limits and its errors; without variables and objectives.
        classes: path -> classes, from wide to narrow.
        share: of the gears that must keep all limits.
        shares: of the gears that must keep each limit, (limits,); 0 of those without a share of their own.
    """

    problem: Problem
    classes: Mapping[str, tuple[ToleranceClass, ...]]
    share: float
    shares: np.ndarray

    @property
    def sets(self) -> np.ndarray:
        """All sets of classes, as numbers of the classes (sets, tolerances)."""
        counts = [range(len(each)) for each in self.classes.values()]
        return np.stack(np.meshgrid(*counts, indexing="ij"), axis=-1).reshape(-1, len(counts))

    @property
    def costs(self) -> np.ndarray:
        """Cost of each set, (sets,)."""
        columns = zip(self.classes.values(), self.sets.T, strict=True)
        return np.sum([np.array([each.cost for each in own])[at] for own, at in columns], axis=0)

    @property
    def inputs(self) -> JointInputs:
        """What scatters; the tolerances by their widest classes."""
        own, problem = JointInputs.of(self.problem.own), self.problem
        widest = {path: each[0].scatter for path, each in self.classes.items()}
        errors = "own" if problem.errors == NONE else problem.errors
        both = JointInputs({**own, **widest}, own.pairs, own.parted)
        return uncertain_inputs(problem.study.base.steering_gear, errors, both)

    def toy(self) -> "ToleranceProblem":
        """The same at the smallest size."""
        return replace(self, problem=replace(self.problem, samples=64, confirm=(64, 0)))


def tolerances_of(file: Path, content: Mapping[str, Any]) -> ToleranceProblem:
    """Return the tolerances in the tables of a TOML file.

    Raises:
        InputError: everything that is wrong with it: file, key, and what is allowed.
    """
    reader = _ToleranceKeys(file)
    return reader.read(lambda: reader.tolerances(content))


class _ToleranceKeys(ProblemKeys):
    """Reads the keys of a file of tolerances."""

    def tolerances(self, content: Mapping[str, Any]) -> ToleranceProblem:
        self.check_keys(content.keys(), KEYS, "a file of tolerances")
        share = self.wanted_share("share", content.get("share", ASSURED))
        errors = self.choice(content, "errors", (*SETS, NONE), "series")
        samples = self.whole(content, "samples", *SIZES["samples"])
        confirm = self.confirmed(content)
        classes = dict(self.classes(self.table(content, "tolerances")))
        self.stop()
        if not classes or (sets := prod(map(len, classes.values()))) > MOST_SETS:
            found = f"have {sets} sets of classes" if classes else "have no class"
            self.wrong("tolerances", f"{found}; there must be 1 to {MOST_SETS}.")
        self.stop()
        ends = [np.array([each.scatter.ends for each in own]) for own in classes.values()]
        axes = [
            {"path": path, "uniform": [float(each.min()), float(each.max())]}
            for path, each in zip(classes, ends, strict=True)
        ]
        study, own = self.study(content, axes, samples)
        problem = Problem(study, {}, (), (), errors, own, samples, 0, confirm)
        tables, own_shares = dict(self.table(content, "constraints")), dict[str, float]()
        for name, table in tables.items():
            if isinstance(table, Mapping) and "share" in table:
                where, tables[name] = f"constraints: {name}: share", {**table}
                own_shares[name] = self.wanted_share(where, tables[name].pop("share"))
                if own_shares[name] <= share:
                    self.wrong(where, f"must be more than that of all limits, {100 * share:g} %.")
        asked = [*self.asked(tables, problem)]
        required = [*self.requirements(content, problem)]
        self.stop()
        each_gear = [replace(each, number=replace(each.number, quantile=None)) for each in required]
        limits = (*self.constraints(problem, asked), *each_gear)
        self.stop()
        for each in limits:
            if not each.number.scene:
                self.wrong(
                    "constraints:", f"{each.number.name} follows from the drawing, no tolerance changes it."
                )
        if not limits:
            self.wrong("constraints", "must have at least one table, or requirements a name.")
        shares = np.array([own_shares.get(each.number.name, 0.0) for each in limits])
        made = ToleranceProblem(replace(problem, constraints=limits), classes, share, shares)
        self.stop()
        for path in {path for pair in made.inputs.pairs for path in pair} & {*classes}:
            self.wrong(
                "tolerances:", f"{path} is correlated with another input; a tolerance must vary by itself."
            )
        return made

    def wanted_share(self, where: str, given: Any) -> float:
        """Return a share of the gears that must keep limits."""
        try:
            share = to_si(given, "")
        except ValueError:
            share = np.nan
        if not 0 < share < 1:
            self.wrong(where, f"is {shown(given)}; it must be more than 0 % and less than 100 %.")
        return share

    def classes(
        self, table: Mapping[str, Any], above: str = ""
    ) -> Iterator[tuple[str, tuple[ToleranceClass, ...]]]:
        """Yield path -> classes, from wide to narrow."""
        for key, value in table.items():
            path, before = f"{above}{key}", len(self.problems)
            if isinstance(value, Mapping) and any(isinstance(each, Mapping) for each in value.values()):
                yield from self.classes(value, f"{path}.")
            elif not isinstance(value, Mapping) or not value:
                self.wrong(f"tolerances: {path}", f"is {shown(value)}; it must be a table of classes.")
            elif self.is_parameter(path, "tolerances"):
                made = [self.one_class(path, name, each) for name, each in value.items()]
                found = sorted((each for each in made if each), key=lambda each: -each.width)
                for wide, narrow in pairwise(found):
                    if not (wide.width > narrow.width and wide.cost < narrow.cost):
                        self.wrong(
                            f"tolerances: {path}",
                            f"{wide.name} costs {wide.cost:g} and {narrow.name} {narrow.cost:g}; of two "
                            "classes the wider one must cost less.",
                        )
                if len(self.problems) == before:
                    yield path, tuple(found)

    def one_class(self, path: str, name: str, given: Any) -> ToleranceClass | None:
        """Return a class of a parameter's tolerance; None of a wrong one."""
        where, item = f"tolerances: {path}: {name}", self.declared[path]
        listed = isinstance(given, list) and len(given) == 2 and isinstance(given[0], str)
        if not listed or type(given[1]) not in (int, float) or not given[1] >= 0 or not isfinite(given[1]):
            self.wrong(where, f"is {shown(given)}; it must be [scatter, cost] with a cost of 0 or more.")
        elif item.unit is None or path.startswith("fidelity."):
            self.wrong(where, f"is {shown(given)}; only numbers of the gear have tolerances.")
        else:
            try:
                scatter = Distribution.read(given[0], item.unit.si)
            except ValueError as error:
                self.wrong(where, f"{error}.")
                return None
            for sentence in outside(item, scatter):
                self.wrong(where, f"cannot be: {sentence}")
            return ToleranceClass(name, scatter, float(given[1]))
        return None
