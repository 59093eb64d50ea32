"""The default gear optimised for the ripple of its series: cost of a design, the best on other gears.

The designs of `studies/optimise_ripple.toml` are searched, and confirmed. Beside the best one stands the
best one of those whose helix presses the pinion little.
"""

import tempfile
from collections.abc import Sequence
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

from benchmarks.published import BOTH, cpu_time_of
from benchmarks.topic import ROOT, Topic, digits, load_data, markdown, save_data
from rps_exudyn.optimisation.confirmation import MODELS, confirmed_numbers
from rps_exudyn.optimisation.definition import read_problem
from rps_exudyn.optimisation.optimise import optimised
from rps_exudyn.results.result import read_result

DATA, STUDY = "optimised.json", ROOT / "studies" / "optimise_ripple.toml"
HELIX, LITTLE = "pinion.helix_angle", np.deg2rad(30)
GIVEN, BEST, LITTLE_HELIX = "given", "best", "helix at most 30 deg"
PROTOTYPE = {BEST: -62, LITTLE_HELIX: -42}
"""Changes of the ripple that a search with other code had found by law `line` [%]."""


def run(folder: Path, toy: bool = False) -> None:
    """Search and confirm; keep what designs cost, and the ripple of three of them by each model."""
    problem = read_problem(STUDY)
    with tempfile.TemporaryDirectory() as place:
        start, used = perf_counter(), cpu_time_of(*BOTH)
        found = optimised(problem, Path(place) / "search", None, toy)
        used, elapsed = cpu_time_of(*BOTH) - used, perf_counter() - start
        store = found.search.store
        costs = [read_result(store.path_of(each.case.hash)).cpu_s for each in found.search.designs]
    problem, designs = found.search.problem, {GIVEN: found.search.given, BEST: found.front[0]}
    flat = [each for each in found.front if abs(float(each.case.values[HELIX])) <= LITTLE]
    designs |= dict(zip([LITTLE_HELIX], flat, strict=False))
    rows = []
    for model, samples in zip(MODELS, (problem.confirm[0], *[problem.confirm[1]] * 2), strict=True):
        for name, design in designs.items() if samples else ():
            known = found.confirmed.get((design.case.hash, model))
            fresh = known or confirmed_numbers(problem, design.case.values, model, samples)
            row = {"model": model, "samples": samples, "design": name, "ripple": fresh.values[0]}
            rows.append(row | {"error": fresh.errors[0] + fresh.bars[0], "not_kept": found.not_kept(fresh)})
            print(rows[-1], flush=True)
    whole = [bool(each.numbers) and bool(np.isfinite(each.numbers[0])) for each in found.search.designs]
    content = {"designs": len(costs), "series": sum(whole), "mean": float(np.mean(costs)), "used": used}
    content |= {"whole": float(np.mean(np.array(costs)[whole])), "elapsed": elapsed}
    content["luck"] = found.luck(found.front[0])
    save_data(folder / DATA, content | {"rows": rows})


def ripple_table(folder: Path) -> str:
    """Return the 90 % quantiles of the ripple by each model, with their changes."""
    rows, lines = load_data(folder / DATA)["rows"], list[Sequence[object]]()
    for model in dict.fromkeys(row["model"] for row in rows):
        cells = {row["design"]: row for row in rows if row["model"] == model}
        given = cells[GIVEN]
        line = [f"by {model}, {given['samples']} gears", f"{given['ripple']:.3f} ± {given['error']:.3f} N m"]
        others = (cells.get(name) for name in (BEST, LITTLE_HELIX))
        line += [_changed(each, given) if each else "-" for each in others]
        lines.append(line)
    before = [
        "a prototype found, by law `line`",
        "",
        *(f"{PROTOTYPE[name]} %" for name in (BEST, LITTLE_HELIX)),
    ]
    return markdown(("", GIVEN, BEST, LITTLE_HELIX), [*lines, before])


def _changed(row: dict[str, Any], given: dict[str, Any]) -> str:
    missed = f"; misses {', '.join(row['not_kept'])}" if row["not_kept"] else ""
    return f"{row['ripple']:.3f} N m ({100 * (row['ripple'] / given['ripple'] - 1):+.0f} %){missed}"


def design_cost_table(folder: Path) -> str:
    """Return the CPU time of designs, and of the whole command."""
    data = load_data(folder / DATA)
    rows = [
        ("designs, and those whose series is computed", f"{data['designs']}, {data['series']}"),
        ("CPU time of a design, mean, and with its series [s]", f"{data['mean']:.3f}, {data['whole']:.3f}"),
        (
            "CPU and elapsed time of the command, confirmation included [s]",
            f"{data['used']:.0f}, {data['elapsed']:.0f}",
        ),
        ("luck of the best [%]", digits(100 * data["luck"])),
    ]
    return markdown(("search", ""), rows)


TOPIC = Topic(
    "15 min", "drawing", run, {"toy": True}, {"ripple": ripple_table, "design_cost": design_cost_table}
)
