"""The laws of contact on random gears: whether loads are found at every angle, and how far means differ.

Each gear turns by one tooth pitch, free and under a load between 5 and 30 N m at the pinion, in equilibria of
law "teeth"; the free torque's mean stands against that of law "line". The gears are those of
`verification.population`, with and without manufacturing errors; `SEED` is used nowhere else.
"""

from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

import rps_exudyn as rps
from benchmarks.topic import Columns, Topic, digits, load_data, markdown, save_data, table_of
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.result import Result
from rps_exudyn.solvers.gear_forces import gear_forces
from verification.population import random_gears

SEED, GEARS, BY_SPHERES = 2718, 200, 20
LOADS = 5.0, 30.0  # at the pinion [N m]
GRAVITY = 9.80665
DATA, SPHERES, POSES = "random_gears.json", "spheres.json", "poses.json"
LIFTS = -1e-6, -1e-5, -6e-5  # of the rack, into the mesh [m]
TILT = 5e-3  # of the rack about each axis, at most [rad]
ANGLES = 24  # over a pitch
NEAR = 0.3  # a difference of means [%]
EVERYDAY = Fidelity.preset("quasi-static")
CASES = {
    "teeth, free": ("free-pinion-torque", "teeth"),
    "teeth, loaded": ("load-test", "teeth"),
    "line, free": ("free-pinion-torque", "line"),
    "line, loaded": ("load-test", "line"),
}
"""Name -> scene, law."""


def run(folder: Path, gears: int = GEARS, by_spheres: int = BY_SPHERES) -> None:
    """Run all cases of every gear, and the first gears by spheres."""
    rng = np.random.default_rng(SEED)
    drawn = random_gears(SEED, gears)
    rows = [measured(gear, float(rng.uniform(*LOADS))) for gear in drawn]
    save_data(folder / DATA, {"gears": rows})
    save_data(folder / POSES, {"tried": gears * ANGLES * len(LIFTS), "unfound": sum(map(unfound, drawn))})
    run_spheres(folder, by_spheres)


def run_spheres(folder: Path, gears: int = BY_SPHERES) -> None:
    """Compare spheres with law "line" on the first of these gears."""
    drawn = random_gears(SEED, gears)
    save_data(folder / SPHERES, {"gears": [spheres_against_line(gear) for gear in drawn]})


def of_a_pitch(gear: SteeringGear, law: str, load: float) -> SteeringGear:
    """The gear with a law, for one tooth pitch under a torque at the pinion [N m]."""
    mass = load / abs(GearPair.of(gear).gain) / GRAVITY
    return gear.replace({"mesh.law": law, "test.turns": 1 / gear.pinion.teeth, "test.load_mass": mass})


def measured(gear: SteeringGear, load: float) -> dict[str, Any]:
    """What becomes of a gear's cases."""
    return {"load": load} | {
        name: outcome(rps.run(scene, of_a_pitch(gear, law, load), fidelity=EVERYDAY))
        for name, (scene, law) in CASES.items()
    }


def unfound(gear: SteeringGear) -> int:
    """At how many poses over a pitch, loaded lightly, heavily and at edges, "teeth" finds no loads."""
    rng, gain = np.random.default_rng(SEED), GearPair.of(gear).gain
    settings = {"strip_stations": 4, "strip_points": 2}
    balance = gear_forces(gear.replace({"mesh.law": "teeth"}), EVERYDAY.replace(settings)).statics
    count = 0
    for angle in np.arange(ANGLES) * 2 * np.pi / gear.pinion.teeth / ANGLES:
        for lift in LIFTS:
            q = np.array([angle, -angle * gain, lift, 0.0, *rng.uniform(-TILT, TILT, 3), 0.0])
            count += not np.isfinite(balance.force(q, np.zeros(8))).all()
    return count


def outcome(result: Result) -> dict[str, Any]:
    """Status, mean torque or efficiency of a run, and why it failed."""
    names = ("torque_mean", "efficiency_forward")
    figures = {name: result.summary[name] for name in names if name in result.summary}
    why = {} if result.status is Status.OK else {"message": result.message}
    return {"status": str(result.status), **why, **figures}


def spheres_against_line(gear: SteeringGear) -> dict[str, Any]:
    """A gear's free torque by spheres and by law "line" with the same stiffness, in equilibria."""
    gear, models = of_a_pitch(gear, "line", 0.0), {"line": "flank", "spheres": "general-contact"}
    return {
        name: outcome(rps.run("free-pinion-torque", gear, fidelity=EVERYDAY.replace({"mesh": mesh})))
        for name, mesh in models.items()
    }


def differences(rows: Sequence[dict[str, Any]], one: str, other: str, figure: str) -> np.ndarray:
    """Relative differences of a figure where both runs have it, in %."""
    pairs = [(row[one], row[other]) for row in rows]
    both = [(a[figure], b[figure]) for a, b in pairs if a["status"] == b["status"] == "ok"]
    return np.array([100 * (a / b - 1) for a, b in both])


def unfound_table(folder: Path) -> str:
    """At how many poses no loads were found."""
    columns = {"poses of all gears": "{tried}", "without loads found": "{unfound}"}
    return table_of([load_data(folder / POSES)], columns)


def statuses_table(folder: Path) -> str:
    """How the runs of each case ended."""
    gears, rows = load_data(folder / DATA)["gears"], []
    for name in CASES:
        counts = Counter(gear[name]["status"] for gear in gears)
        rows.append((name, len(gears), ", ".join(f"{n} {status}" for status, n in counts.most_common())))
    return markdown(("law and load", "runs", "ended"), rows)


def differences_table(folder: Path) -> str:
    """Differences between the laws over the gears."""
    rows, spheres = load_data(folder / DATA)["gears"], load_data(folder / SPHERES)["gears"]
    compared = {
        "teeth against line, mean free torque": (rows, "teeth, free", "line, free", "torque_mean"),
        "teeth against line, efficiency": (rows, "teeth, loaded", "line, loaded", "efficiency_forward"),
        "spheres against line, mean free torque": (spheres, "spheres", "line", "torque_mean"),
    }
    columns: Columns = {
        "difference in %": lambda row: row[0],
        "gears": lambda row: row[1].size,
        "smallest": lambda row: digits(row[1].min()),
        "median": lambda row: digits(np.median(row[1])),
        "largest": lambda row: digits(row[1].max()),
        f"within {NEAR:g} %": lambda row: (np.abs(row[1]) <= NEAR).sum(),
    }
    return table_of([(name, differences(*what)) for name, what in compared.items()], columns)


TOPIC = Topic(
    "10 min",
    "contact_laws",
    run,
    {"gears": 2, "by_spheres": 1},
    {"law_poses": unfound_table, "law_statuses": statuses_table, "law_differences": differences_table},
)

SPHERES_ALONE = Topic(
    "2 min",
    "contact_laws",
    run_spheres,
    {"gears": 1},
    {},
    about="spheres beside law line on random gears, a part of `law_on_gears`",
)
