"""From a study to its cases: each case's hash, gear and fidelity, and the folder's description."""

import hashlib
import json
import math
from collections.abc import Iterator, Mapping
from dataclasses import asdict
from functools import partial
from typing import Any

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.progress import reached
from rps_exudyn.parameters.declaration import Table
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import Setup, SteeringGear
from rps_exudyn.results.provenance import MODEL_VERSION
from rps_exudyn.simulate.by_accuracy import AccuracyGoal
from rps_exudyn.study.definition import GRID_DESIGN, Case, Description, Study, settings_of
from rps_exudyn.study.designs import points, points_per_sample

MOST_CASES = 1_000_000
MOST_PROBLEMS = 10  # reported at once
MOST_KNOWN = 4096
NAMES = {"name", "based_on"}  # of a fidelity: no number depends on them


def case_hash(scene: str, gear: SteeringGear, fidelity: Fidelity, goal: AccuracyGoal | None = None) -> str:
    """Sixteen hex digits that name a case: of all that its numbers depend on, and nothing else."""
    tables = ",".join(f'"{name}":{_json(getattr(gear, name))}' for name in sorted(SteeringGear.model_fields))
    model = _canonical(asdict(goal)) if goal else _json(fidelity)
    content = (
        f'{{"fidelity":{model},"gear":{{{tables}}},"model":{MODEL_VERSION},"scene":{_canonical(scene)}}}'
    )
    return hashlib.sha256(content.encode()).hexdigest()[:16]


_known: dict[int, tuple[Table, str]] = {}  # of tables by their identity: cases share those that do not vary


def _json(table: Table) -> str:
    """The canonical JSON of a table but for its name, kept until a few thousand others are asked for."""
    known = _known.get(id(table))
    if known is None or known[0] is not table:
        if len(_known) >= MOST_KNOWN:
            _known.clear()
        known = _known[id(table)] = table, _canonical(table.model_dump(exclude=NAMES))
    return known[1]


def _canonical(content: Any) -> str:
    return json.dumps(content, sort_keys=True, separators=(",", ":"), allow_nan=False)


def count_of(study: Study) -> int:
    """Number of cases of the design, without laying them out.

    Raises:
        InputError: more than anyone could run.
    """
    if study.design == GRID_DESIGN:
        count = math.prod(len(axis.values or ()) for axis in study.axes)
    else:
        count = study.samples * points_per_sample(study.design, len(study.axes))
    if count > MOST_CASES:
        raise InputError(f"{study.file}: the design has {count} cases; at most {MOST_CASES} are allowed.")
    return count


def describe(study: Study, provenance: Mapping[str, Any]) -> Description:
    """The study with all its cases laid out and named."""
    base = study.base
    return Description(
        name=study.name,
        title=study.title,
        scene=study.scene,
        fidelity=base.fidelity.model_dump()
        | ({"name": study.accuracy_goal.words} if study.accuracy_goal else {}),
        base=base.steering_gear.changes(),
        axes=study.axes,
        design=study.design,
        seed=None if study.design == GRID_DESIGN else study.seed,
        cases=tuple(_cases(study)),
        signals=study.keep,
        correlation=study.correlation,
        time_limit=study.time_limit,
        provenance=dict(provenance),
    )


def setup_of(study: Study, case: Case) -> Setup:
    """Gear and fidelity of a case."""
    return study.setup(settings_of(study.axes, case.values))


def _cases(study: Study) -> Iterator[Case]:
    problems: dict[str, None] = {}
    count = count_of(study)
    drawn = points(study.axes, study.design, study.samples, study.seed, study.correlation)
    for number, values in enumerate(drawn):
        reached(number / count, partial("{} cases laid out".format, number))
        settings = settings_of(study.axes, values)
        try:
            setup = study.setup(settings)
        except InputError as error:
            case = ", ".join(f"{path} = {value}" for path, value in settings.items())
            problems |= dict.fromkeys(f"{study.file}: the case {case}: {item}" for item in error.problems)
            if len(problems) >= MOST_PROBLEMS:
                break
        else:
            yield Case(case_hash(study.scene, setup, setup.fidelity, study.accuracy_goal), values)
    if problems:
        raise InputError(problems)
