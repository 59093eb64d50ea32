"""The window of the default gear's preload, and how many other gears keep the limits at its ends."""

from pathlib import Path

import numpy as np

import rps_exudyn as rps
from benchmarks.measure import least_time
from benchmarks.topic import Columns, Topic, digits, load_data, save_data, table_of
from rps_exudyn.assessment.requirements.judging import RATED_TORQUE, as_tested
from rps_exudyn.inference.uncertainty.input_sets import uncertain_inputs
from rps_exudyn.inference.uncertainty.samples import Samples
from rps_exudyn.parameters.fidelity import FOR_MEANS
from rps_exudyn.results.requirements import limits_in
from rps_exudyn.scenes.contact_law import LAW_OF_SERIES, resolve_contact_law
from rps_exudyn.simulate.batch import batch

DATA, SCENE, PRELOAD, SERIES = "window.json", "free-pinion-torque", "yoke.preload", "series"
LIMITS = {"free_torque": {"least": "0.8 N*m", "most": "1.8 N*m"}, "torque_peak_to_peak": {"most": "0.3 N*m"}}
METRICS = {"free_torque": "torque_mean"}  # limit -> metric, where names differ
SEED_OF_OTHERS = 7


def run(folder: Path, gears: int = 2000, samples: int | None = None) -> None:
    """Seek the window, then judge other gears at its ends."""
    seconds, found = least_time(
        lambda: rps.window(rps.SteeringGear(), PRELOAD, LIMITS, inputs=SERIES, samples=samples), 1
    )
    ends = [
        {
            "value": end.value,
            "error": end.error,
            "limited_by": list(end.limited_by),
            "gears": gears,
            "kept": kept_by_others(end.value, gears),
        }
        for end in found.ends
    ]
    save_data(folder / DATA, {"seconds": seconds, "share": found.share, "ends": ends})


def kept_by_others(preload: float, gears: int) -> float:
    """Return the share of gears with other random numbers that keep all limits at a preload [N]."""
    given = rps.SteeringGear().replace({PRELOAD: preload})
    table = Samples.drawn(uncertain_inputs(given, SERIES, {}), gears, SEED_OF_OTHERS).values
    tested = resolve_contact_law(as_tested(given, SCENE, RATED_TORQUE), FOR_MEANS, LAW_OF_SERIES, table)
    ran = batch(SCENE, tested, table, fidelity=FOR_MEANS, keep="torque")
    kept = [
        limit.keeps(ran.summary[METRICS.get(name, name)])
        for name, limit in limits_in(LIMITS, "limits").items()
    ]
    return float((np.logical_and.reduce(kept) & ran.ok).mean())


def _share(row: dict[str, float]) -> str:
    error = np.sqrt(row["kept"] * (1 - row["kept"]) / row["gears"])
    return f"{100 * row['kept']:.1f} ± {100 * error:.1f}"


COLUMNS: Columns = {
    "end [N]": lambda row: f"{row['value']:.0f} ± {row['error']:.0f}",
    "limited by": lambda row: ", ".join(f"`{name}`" for name in row["limited_by"]),
    "other gears": "{gears}",
    "keep all limits [%]": _share,
}


def window_table(folder: Path) -> str:
    """Return the ends, and the CPU time."""
    data = load_data(folder / DATA)
    return f"{table_of(data['ends'], COLUMNS)}\n\nThe window takes {digits(data['seconds'])} s."


TOPIC = Topic("2 min", "drawing", run, {"gears": 16, "samples": 8}, {"window": window_table})
