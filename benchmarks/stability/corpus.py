"""What the bad cases of tests/stability give without any check, and with all: results/stability/corpus.csv.

python studies/stability_corpus.py
"""

import csv
import sys
from collections import Counter
from pathlib import Path

from rps_exudyn.results.outcome import Status
from rps_exudyn.simulate.run import run
from rps_exudyn.verification.stability import Plan, error_of, reference, unchecked

HERE = Path(__file__).parents[1]
sys.path.insert(0, str(HERE / "tests"))
COLUMNS = ("case", "without_checks", "error_without", "outcome", "error", "message")


def main() -> None:
    from bad_cases import bad_cases

    rows = []
    for name, plan in bad_cases().items():
        rows.append((name, *row_of(plan)))
        print(*rows[-1], sep=" | ", flush=True)
    with (HERE / "results" / "stability" / "corpus.csv").open("w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([COLUMNS, *rows])
    print(len(rows), Counter(row[3] for row in rows), file=sys.stderr)


def row_of(plan: Plan) -> tuple[str, str, str, str, str]:
    bare, result = unchecked(plan), run(plan.scene, plan.gear, fidelity=plan.fidelity)
    true = reference(plan, plan.figure(bare))
    error = error_of(plan.figure(result), true) if result.status is Status.OK else float("nan")
    without = error_of(plan.figure(bare), true)
    return bare.status.value, f"{without:.3g}", result.status.value, f"{error:.3g}", result.message


if __name__ == "__main__":
    main()
