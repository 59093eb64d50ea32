"""Cost of a study over the number of its cases: random gears over a whole turn, in blocks, two processes.

The gears are those of `studies/tolerance.toml`: runout, single pitch error and six more errors, one turn in
steps of 1 degree. Elapsed times grow with what other processes do on the machine.
"""

import os
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

from benchmarks.study_runner import watched, written
from benchmarks.topic import ROOT, Columns, Topic, digits, rows_table, save_data
from rps_exudyn.study.store import Store

STUDY = ROOT / "studies" / "tolerance.toml"
DATA = "scaling.json"
KEEP = '[keep]\nsignals = "none"\nblocks = true\n'


def run(folder: Path, counts: Sequence[int] = (200, 1000, 10_000)) -> None:
    """Run studies of so many cases."""
    rows: list[dict[str, float]] = []
    with tempfile.TemporaryDirectory() as studies:
        for count in counts:
            rows.append(measured(Path(studies), count))
            print(rows[-1], flush=True)
            save_data(folder / DATA, {"load": os.getloadavg()[0], "rows": rows})


def measured(folder: Path, count: int) -> dict[str, float]:
    """Elapsed and CPU time [s], bytes and files of one study, start and storing included."""
    out = folder / f"of_{count}"
    seen = watched(tolerance_study(folder, count), out, 2)
    store = Store.open(out)
    start = time.perf_counter()
    rows = list(store.rows())
    reading = time.perf_counter() - start
    return {
        "cases": count,
        "wall": seen["wall"],
        "cpu": seen["cpu"],
        "bytes": sum(path.stat().st_size for path in store.blocks.paths),
        "reading": reading,
        "failed": sum(row.status != "ok" for _, row in rows),
    }


def tolerance_study(folder: Path, count: int) -> Path:
    """Write the study with so many samples, without signals, in blocks."""
    text = STUDY.read_text().replace("samples = 200", f"samples = {count}")
    text = text.replace('gear = "gears/paper.toml"\n', "")  # the default gear is the paper's
    return written(folder, f"of_{count}", text.partition("[keep]")[0] + KEEP)


COLUMNS: Columns = {
    "cases": lambda row: f"{row['cases']:,}".replace(",", " "),
    "elapsed [s]": lambda row: digits(row["wall"], 3),
    "CPU per case [ms]": lambda row: digits(1e3 * row["cpu"] / row["cases"], 3),
    "kB per case": lambda row: digits(row["bytes"] / row["cases"] / 1e3),
    "summaries read in [s]": lambda row: digits(row["reading"]),
    "failed": "{failed}",
}
TOPIC = Topic(
    "14 min", "study_runner", run, {"counts": (2, 4)}, {"study_scaling": rows_table(DATA, "rows", COLUMNS)}
)
