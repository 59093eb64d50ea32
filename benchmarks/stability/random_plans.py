"""Random admissible plans against a reference: how many are right, refused, failed, or silently wrong.

    python studies/stability_plans.py 1000 --out results/stability/random_plans.csv

A plan is a random gear, speed, step, solver and stiffness over at most one tooth pitch. It is run as the user
gave it, without the guards that stand before a run, and those are asked besides: so one run tells both what
they let pass and what they refuse for nothing. Each plan has its own seed, is on a hard time limit, and is
repeated alone by `python studies/stability_plans.py 1 --first NUMBER`.
"""

import csv
import json
import multiprocessing
import multiprocessing.connection
import sys
from argparse import ArgumentParser
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.report import geometry_report
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.result import Result
from rps_exudyn.verification.stability import REFERENCES, Plan, error_of, reference, unchecked

SEED = 20261121
TIME_LIMIT = 20.0  # [s] of one plan
WRONG = 0.02  # error of the mean that must not be called ok
SCENES = ("free-pinion-torque", "rack-push", "load-test")
LEAST_CONTACT_RATIO = 1.2  # total; a designer's gear has more
COLUMNS = ("number", "verdict", "status", "error", "refused", "message", "seconds", "plan")


def plan_of(number: int) -> tuple[Plan, str]:
    """The random plan of that number, and what was drawn for it; a gear that cannot exist is drawn again."""
    rng = np.random.default_rng([SEED, number])
    while True:
        settings, choices, scene = _drawn(rng)
        try:
            gear, fidelity = SteeringGear().replace(settings), Fidelity().replace(choices)
            if geometry_report(gear).total_contact_ratio < LEAST_CONTACT_RATIO:
                continue
        except InputError:
            continue
        return Plan(scene, gear, fidelity), json.dumps({"scene": scene} | settings | choices, default=float)


def _drawn(rng: np.random.Generator) -> tuple[dict[str, Any], dict[str, Any], str]:
    def log(low: float, high: float) -> float:
        return float(np.exp(rng.uniform(np.log(low), np.log(high))))

    def seldom(share: float, value: float) -> float:
        return float(value) if rng.random() < share else 0.0

    teeth, module = int(rng.integers(5, 11)), 1e-3 * rng.uniform(1.5, 2.3)
    helix, shift = np.deg2rad(rng.uniform(0, 35)), rng.uniform(0.5, 1.1)
    tip = module * teeth / np.cos(helix) + 2 * module * (shift + rng.uniform(0.6, 1.0))
    solver = str(rng.choice(["equilibrium", "generalized-alpha"], p=[0.4, 0.6]))
    general = solver != "equilibrium" and rng.random() < 0.06
    scene = str(rng.choice(SCENES, p=[0.8, 0.12, 0.08]))
    settings = {
        "basic_rack.addendum": rng.uniform(0.8, 1.0),
        "pinion.teeth": teeth,
        "pinion.normal_module": module,
        "pinion.pressure_angle": np.deg2rad(rng.uniform(17, 25)),
        "pinion.helix_angle": helix,
        "pinion.profile_shift": shift,
        "pinion.tip_diameter": tip,
        "pinion.face_width": rng.uniform(8e-3, 20e-3),
        "pinion.runout": seldom(0.3, rng.uniform(0, 60e-6)),
        "pinion.tip_relief": seldom(0.2, rng.uniform(0, 20e-6)),
        "pinion.crowning": seldom(0.2, rng.uniform(0, 10e-6)),
        "rack.tooth_angle": np.deg2rad(rng.uniform(-5, 15)),
        "installation.angle_error": seldom(0.25, np.deg2rad(rng.uniform(-1, 1))),
        "installation.axis_offset": seldom(0.2, rng.uniform(-1e-4, 1e-4)),
        "yoke.preload": log(30, 900),
        "yoke.friction": rng.uniform(0.02, 0.25),
        "yoke.clearance": rng.uniform(0, 1e-4),
        "yoke.seat_stiffness": log(1e7, 1e9),
        "mesh.friction": rng.uniform(0.02, 0.25),
        "mesh.stiffness": log(1e12, 5e14),
        "mesh.damping": seldom(0.3, log(1e-6, 3e-3)),
        "bush.drag": rng.uniform(5, 60),
        "bush.segments": int(np.round(log(1, 40))),
        "bush.youngs_modulus": log(3e7, 1e10),
        "test.speed": log(0.5, 300) * np.pi / 30,
        "test.turns": float(rng.choice([1.0, 0.5, 0.2])) / teeth,
        "test.direction": int(rng.choice([-1, 1])),
        "test.load_mass": log(1, 60),
    }
    choices: dict[str, Any] = {
        "solver": solver,
        "step_angle": np.deg2rad(log(0.1, 20)),
        "zone_ratio": log(0.01, 1) if rng.random() < 0.3 else 0.1,
        "yoke": "body",
        "rack": str(rng.choice(["free", "guided"], p=[0.9, 0.1])),
    }
    if general:
        choices |= {"mesh": "general-contact"}
        settings["test.turns"] = 0.1 / teeth
        choices["step_angle"] = min(choices["step_angle"], np.deg2rad(2))
    elif rng.random() < 0.1:
        choices |= {"mesh": "flank-generators"}
    if solver != "equilibrium" and choices["rack"] == "free" and choices.get("mesh", "flank") == "flank":
        choices["bush"] = str(rng.choice(["condensed", "chain", "rigid"], p=[0.7, 0.2, 0.1]))
    if solver != "equilibrium" and rng.random() < 0.3:
        choices["tolerance"] = log(1e-7, 1e-2)
    return settings, choices, scene


# --- one plan, in the child -------------------------------------------------------------------------
def outcome_of(number: int) -> dict[str, Any]:
    """What becomes of a plan, and of its reference."""
    from rps_exudyn.simulate.run import unguarded

    (plan, text), start = plan_of(number), perf_counter()
    refused = _refusal(plan)
    try:
        result = unguarded(plan.scene, plan.gear, plan.fidelity)
    except InputError as error:
        return {"status": "input-error", "message": str(error), "plan": text, "refused": refused}
    seconds = perf_counter() - start
    told = {"status": result.status.value, "message": result.message, "refused": refused, "plan": text}
    return told | {"seconds": seconds} | _error(plan, result)


def _error(plan: Plan, result: Result) -> dict[str, Any]:
    """Of its figure; a run that is not ok is held against equilibria alone.

    Where no reference is sound itself, teeth deeper than their law for instance, one that nobody judged is
    better than none, and the verdict says so.
    """
    value, sound = plan.figure(result), result.status is Status.OK
    if not result.summary:
        return {"error": float("nan")}
    error = error_of(value, reference(plan, value, REFERENCES if sound else REFERENCES[:2]))
    if sound and error != error:
        finer = Plan(plan.scene, plan.gear, plan.fidelity.replace(REFERENCES[2]))
        return {"error": error_of(value, plan.figure(unchecked(finer))), "reference": "not sound"}
    return {"error": error}


def _refusal(plan: Plan) -> str:
    from rps_exudyn.checks.before_run import refused

    return "; ".join(refused(plan.scene, plan.gear, plan.fidelity))


def warm_up() -> None:
    """Load or compile every kernel, which is on no plan's clock."""
    from rps_exudyn.simulate.run import unguarded

    for scene in SCENES:
        gear = SteeringGear().replace({"test.turns": 0.01})
        for solver in ("equilibrium", "generalized-alpha"):
            for mesh in ("flank", "flank-generators"):
                unguarded(scene, gear, Fidelity().replace({"solver": solver, "mesh": mesh}))
        unguarded(scene, gear, Fidelity().replace({"bush": "chain"}))
        unguarded(scene, gear, Fidelity().replace({"mesh": "general-contact", "profile_samples": 8}))


def child(pipe: multiprocessing.connection.Connection) -> None:
    warm_up()
    while True:
        number = pipe.recv()
        pipe.send("begun")
        try:
            pipe.send(outcome_of(number))
        except Exception as error:
            pipe.send({"status": "crashed", "message": f"{type(error).__name__}: {error}"})


# --- all plans --------------------------------------------------------------------------------------
class Child:
    """A process that does plans, killed and started again when one is out of time."""

    def __init__(self, work: Callable[[Any], None] = child) -> None:
        self._work = work
        self._start()

    def _start(self) -> None:
        context = multiprocessing.get_context("spawn")
        self.pipe, other = context.Pipe()
        self.process = context.Process(target=self._work, args=(other,), daemon=True)
        self.process.start()
        other.close()

    def do(self, number: int, limit: float) -> dict[str, Any]:
        self.pipe.send(number)
        try:
            self.pipe.recv()
            if self.pipe.poll(limit):
                return dict(self.pipe.recv())
            status, message = "timeout", f"more than {limit:g} s"
        except EOFError:
            status, message = "crashed", "its process ended"
        self.process.kill()
        self.process.join()
        self._start()
        return {"status": status, "message": message}


def stands(row: dict[str, Any]) -> bool:
    """Whether no change of checks or least steps concerns a row: right in eight steps or more, or failed."""
    drawn = json.loads(row["plan"])
    steps = np.ceil(2 * np.pi * drawn["test.turns"] / drawn["step_angle"])
    told = ("no-convergence", "diverged", "timeout", "contact-lost")
    return (row["verdict"] == "right" and steps >= 8) or row["verdict"] in told


def verdict(row: dict[str, Any]) -> str:
    """right, refused rightly or for nothing, failed, wrong and told, or silently wrong."""
    if row["status"] == "input-error":
        return "wrong input"
    error = row.get("error", float("nan"))
    sound = row["status"] == "ok"
    right = abs(error) <= WRONG
    if row.get("refused"):
        return "refused, was right" if sound and right else "refused"
    if sound and row.get("reference"):
        return "right, reference not sound" if right else "ok, no reference"
    if sound:
        return "right" if right else "SILENTLY WRONG"
    return f"{row['status']}, was right" if row["status"] == "invalid" and right else row["status"]


def main() -> None:
    parser = ArgumentParser(description=__doc__)
    parser.add_argument("plans", type=int)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--out", type=Path)
    parser.add_argument("--again", type=Path, help="a table whose plans that are not simply right are redone")
    asked = parser.parse_args()
    known = {int(row["number"]): row for row in csv.DictReader(asked.again.open())} if asked.again else {}
    worker, rows = Child(), []
    for number in range(asked.first, asked.first + asked.plans):
        if known and number not in known:
            continue
        if known and stands(known[number]):
            rows.append(known[number])
            continue
        row = worker.do(number, TIME_LIMIT + 10)  # with the reference
        row = {"number": number, "plan": plan_of(number)[1], "error": float("nan"), "refused": ""} | row
        rows.append(row | {"verdict": verdict(row)})
        if rows[-1]["verdict"].isupper() or asked.plans == 1:
            print({name: rows[-1].get(name) for name in COLUMNS}, flush=True)
        if asked.out:
            write(rows, asked.out)
    print(json.dumps(Counter(row["verdict"] for row in rows), indent=1), file=sys.stderr)


def write(rows: list[dict[str, Any]], path: Path) -> None:
    with path.open("w", newline="") as file:
        table = csv.DictWriter(file, COLUMNS, extrasaction="ignore", lineterminator="\n")
        table.writeheader()
        table.writerows(
            row | {n: f"{row[n]:.4g}" for n in ("error", "seconds") if isinstance(row.get(n), float)}
            for row in rows
        )


if __name__ == "__main__":
    main()
