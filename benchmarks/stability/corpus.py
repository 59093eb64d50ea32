"""What the bad cases of tests/bad_cases.json give without any check, and with all of them."""

import sys
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import rps_exudyn as rps
from benchmarks.topic import ROOT, Topic, load_rows, markdown, save_rows, shown
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.result import Result
from verification.stability import ScenePlan, cpu_time_limit, error_of, reference, unchecked

COLUMNS = ("case", "without_checks", "error_without", "outcome", "error", "message")
DATA = "corpus.csv"
TIME_LIMIT = 60.0  # CPU time of a reference [s]


def run(folder: Path, names: Sequence[str] = ()) -> None:
    """Run these cases, or all."""
    sys.path.insert(0, str(ROOT / "tests"))
    from bad_cases import bad_cases

    chosen = {name: case for name, case in bad_cases().items() if name in names or not names}
    rows = shown((name, *row_of(case.plan)) for name, case in chosen.items())
    save_rows(folder / DATA, COLUMNS, rows)


def row_of(plan: ScenePlan) -> tuple[str, str, str, str, str]:
    """Outcome and error without and with checks, and the message."""
    bare, result = _without_checks(plan), rps.run(plan.scene, plan.gear, fidelity=plan.fidelity)
    bare_status = bare.status.value if bare else "crashed"
    true = _reference(plan) if Status.OK in (bare_status, result.status) else float("nan")
    error = error_of(plan.main_metric(result), true) if result.status is Status.OK else float("nan")
    without = error_of(plan.main_metric(bare), true) if bare else float("nan")
    return bare_status, f"{without:.3g}", result.status.value, f"{error:.3g}", result.message


def _without_checks(plan: ScenePlan) -> Result | None:
    """The run; None where what a check would refuse ends in an error of the program."""
    try:
        return unchecked(plan)
    except Exception as error:
        print(f"{type(error).__name__}: {error}", flush=True)
        return None


def _reference(plan: ScenePlan) -> float:
    """The reference; nan where it takes too long."""
    try:
        with cpu_time_limit(TIME_LIMIT):
            return reference(plan)
    except TimeoutError:
        return float("nan")


def corpus_table(folder: Path) -> str:
    """Outcomes of all cases."""
    rows = load_rows(folder / DATA)
    errors = [float(row["error"]) for row in rows if row["outcome"] == "ok"]
    wrong, unjudged = sum(abs(each) > 0.02 for each in errors), sum(each != each for each in errors)
    counts = {"cases": len(rows), "ok without checks": sum(row["without_checks"] == "ok" for row in rows)}
    counts |= {f"{name} with checks": n for name, n in Counter(row["outcome"] for row in rows).most_common()}
    counts |= {"ok with checks, no reference": unjudged, "**ok with checks and more than 2 % wrong**": wrong}
    return markdown(("bad cases", "number"), list(counts.items()))


TOPIC = Topic("8 min", "stability", run, {"names": ("plan 202",)}, {"corpus": corpus_table})
