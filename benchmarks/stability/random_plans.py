"""Random admissible plans compared with a reference: how many are right, refused, failed, or silently wrong.

A plan is a random gear, speed, step, solver and stiffness over at most one tooth pitch. It is run as drawn,
without the checks before a run, and those are asked besides: one run shows both what they let pass and what
they refuse although it is right. Each plan has its own seed and a hard time limit.
"""

import csv
import json
import multiprocessing
import multiprocessing.connection
from collections import Counter
from functools import cache
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

from benchmarks.topic import Topic, markdown
from rps_exudyn.base.errors import InputError
from rps_exudyn.checks.before_run import refused
from rps_exudyn.gears.report import geometry_report
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.result import Result
from rps_exudyn.scenes import scene_named
from rps_exudyn.simulate.checked_run import run_unchecked
from rps_exudyn.verification.stability import REFERENCES, ScenePlan, error_of, reference, unchecked

SEED = 20261121
TIME_LIMIT = 20.0  # [s] of one plan
WRONG = 0.02  # error of the mean that must not be called ok
SCENES = ("free-pinion-torque", "rack-push", "load-test")
LEAST_CONTACT_RATIO = 1.2  # total; a designer's gear has more
DATA = "random_plans.csv"
COLUMNS = ("number", "verdict", "status", "error", "refused", "message", "seconds", "plan")


def plan_of(number: int) -> tuple[ScenePlan, str]:
    """The random plan of that number, and its drawn values; a gear that cannot exist is drawn again."""
    rng = np.random.default_rng([SEED, number])
    while True:
        settings, choices, scene = _drawn(rng)
        try:
            gear, fidelity = SteeringGear().replace(settings), Fidelity().replace(choices)
            if geometry_report(gear).total_contact_ratio < LEAST_CONTACT_RATIO:
                continue
        except InputError:
            continue
        return ScenePlan(scene, gear, fidelity), json.dumps(
            {"scene": scene} | settings | choices, default=float
        )


def _log(rng: np.random.Generator, low: float, high: float) -> float:
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def _seldom(rng: np.random.Generator, probability: float, value: float) -> float:
    return float(value) if rng.random() < probability else 0.0


def _drawn(rng: np.random.Generator) -> tuple[dict[str, Any], dict[str, Any], str]:
    """Settings of the gear, choices of the fidelity, scene. The order of the draws is part of the seed."""
    teeth, module = int(rng.integers(5, 11)), 1e-3 * rng.uniform(1.5, 2.3)
    helix, shift = np.deg2rad(rng.uniform(0, 35)), rng.uniform(0.5, 1.1)
    tip = module * teeth / np.cos(helix) + 2 * module * (shift + rng.uniform(0.6, 1.0))
    solver = str(rng.choice(["equilibrium", "generalized-alpha"], p=[0.4, 0.6]))
    general = solver != "equilibrium" and rng.random() < 0.06
    scene = str(rng.choice(SCENES, p=[0.8, 0.12, 0.08]))
    pinion = {
        "pinion.teeth": teeth,
        "pinion.normal_module": module,
        "pinion.helix_angle": helix,
        "pinion.profile_shift": shift,
        "pinion.tip_diameter": tip,
    }
    settings = pinion | _drawn_settings(rng, teeth)
    choices = _drawn_choices(rng, solver)
    if general:
        choices |= {"mesh": "general-contact"}
        settings["test.turns"] = 0.1 / teeth
        choices["step_angle"] = min(choices["step_angle"], np.deg2rad(2))
    elif rng.random() < 0.1:
        choices |= {"mesh": "flank-generators"}
    if solver != "equilibrium" and choices["rack"] == "free" and choices.get("mesh", "flank") == "flank":
        choices["bush"] = str(rng.choice(["condensed", "chain", "rigid"], p=[0.7, 0.2, 0.1]))
    if solver != "equilibrium" and rng.random() < 0.3:
        choices["tolerance"] = _log(rng, 1e-7, 1e-2)
    return settings, choices, scene


def _drawn_settings(rng: np.random.Generator, teeth: int) -> dict[str, Any]:
    return {
        "basic_rack.addendum": rng.uniform(0.8, 1.0),
        "pinion.pressure_angle": np.deg2rad(rng.uniform(17, 25)),
        "pinion.face_width": rng.uniform(8e-3, 20e-3),
        "pinion.runout": _seldom(rng, 0.3, rng.uniform(0, 60e-6)),
        "pinion.tip_relief": _seldom(rng, 0.2, rng.uniform(0, 20e-6)),
        "pinion.crowning": _seldom(rng, 0.2, rng.uniform(0, 10e-6)),
        "rack.tooth_angle": np.deg2rad(rng.uniform(-5, 15)),
        "installation.angle_error": _seldom(rng, 0.25, np.deg2rad(rng.uniform(-1, 1))),
        "installation.axis_offset": _seldom(rng, 0.2, rng.uniform(-1e-4, 1e-4)),
        "yoke.preload": _log(rng, 30, 900),
        "yoke.friction": rng.uniform(0.02, 0.25),
        "yoke.clearance": rng.uniform(0, 1e-4),
        "yoke.seat_stiffness": _log(rng, 1e7, 1e9),
        "mesh.friction": rng.uniform(0.02, 0.25),
        "mesh.stiffness": _log(rng, 1e12, 5e14),
        "mesh.damping": _seldom(rng, 0.3, _log(rng, 1e-6, 3e-3)),
        "bush.drag": rng.uniform(5, 60),
        "bush.segments": int(np.round(_log(rng, 1, 40))),
        "bush.youngs_modulus": _log(rng, 3e7, 1e10),
        "test.speed": _log(rng, 0.5, 300) * np.pi / 30,
        "test.turns": float(rng.choice([1.0, 0.5, 0.2])) / teeth,
        "test.direction": int(rng.choice([-1, 1])),
        "test.load_mass": _log(rng, 1, 60),
    }


def _drawn_choices(rng: np.random.Generator, solver: str) -> dict[str, Any]:
    return {
        "solver": solver,
        "step_angle": np.deg2rad(_log(rng, 0.1, 20)),
        "zone_ratio": _log(rng, 0.01, 1) if rng.random() < 0.3 else 0.1,
        "yoke": "body",
        "rack": str(rng.choice(["free", "guided"], p=[0.9, 0.1])),
    }


# --- one plan, in the child -------------------------------------------------------------------------
def outcome_of(number: int) -> dict[str, Any]:
    """Outcome of a plan, and its error."""
    (plan, text), start = plan_of(number), perf_counter()
    refusal = "; ".join(refused(plan.gear, plan.fidelity, steady=scene_named(plan.scene).steady))
    found: dict[str, Any] = {"refused": refusal, "plan": text}
    try:
        result = run_unchecked(plan.scene, plan.gear, plan.fidelity)
    except InputError as error:
        return found | {"status": "input-error", "message": str(error)}
    found |= {"status": result.status.value, "message": result.message, "seconds": perf_counter() - start}
    return found | _error(plan, result)


def _error(plan: ScenePlan, result: Result) -> dict[str, Any]:
    """Error of its figure; a run that is not ok is compared with equilibria alone.

    Where no reference is ok itself, teeth deeper than their law for instance, an unchecked one is better than
    none, and the verdict says so.
    """
    value, sound = plan.figure(result), result.status is Status.OK
    if not result.summary:
        return {"error": float("nan")}
    error = error_of(value, reference(plan, value, REFERENCES if sound else REFERENCES[:2]))
    if sound and error != error:
        finer = ScenePlan(plan.scene, plan.gear, plan.fidelity.replace(REFERENCES[2]))
        return {"error": error_of(value, plan.figure(unchecked(finer))), "reference": "not sound"}
    return {"error": error}


@cache
def warm_up(scene: str) -> None:
    """Load or compile every kernel of a scene once, which is on no plan's clock."""
    gear = SteeringGear().replace({"test.turns": 0.01})
    models: list[dict[str, Any]] = [
        {"solver": solver, "mesh": mesh}
        for solver in ("equilibrium", "generalized-alpha")
        for mesh in ("flank", "flank-generators")
    ]
    models += [{"bush": "chain"}, {"mesh": "general-contact", "profile_samples": 8}]
    for choices in models:
        run_unchecked(scene, gear, Fidelity().replace(choices))


def child(pipe: multiprocessing.connection.Connection) -> None:
    """Do plans by their numbers, as the parent sends them."""
    while True:
        try:
            number = pipe.recv()
        except EOFError:  # the parent has ended
            return
        warm_up(plan_of(number)[0].scene)
        pipe.send("begun")
        try:
            pipe.send(outcome_of(number))
        except Exception as error:
            pipe.send({"status": "crashed", "message": f"{type(error).__name__}: {error}"})


# --- all plans --------------------------------------------------------------------------------------
class Child:
    """A process that does plans, killed and started again when one is out of time."""

    def __init__(self) -> None:
        self._start()

    def _start(self) -> None:
        context = multiprocessing.get_context("spawn")
        self.pipe, other = context.Pipe()
        self.process = context.Process(target=child, args=(other,), daemon=True)
        self.process.start()
        other.close()

    def do(self, number: int, limit: float) -> dict[str, Any]:
        """Outcome of a plan, or that it took longer than the limit [s] or ended its process."""
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


def verdict(row: dict[str, Any]) -> str:
    """Tell whether a plan was right, refused rightly or not, failed, or was silently wrong."""
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


def run(folder: Path, plans: int = 1000, first: int = 0) -> None:
    """Run these plans, one after the other in a process of their own."""
    worker, rows = Child(), []
    for number in range(first, first + plans):
        defaults = {"number": number, "plan": plan_of(number)[1], "error": float("nan"), "refused": ""}
        row: dict[str, Any] = defaults | worker.do(number, TIME_LIMIT + 10)  # with the reference
        rows.append(row | {"verdict": verdict(row)})
        if verdict(row).isupper():
            print({name: rows[-1].get(name) for name in COLUMNS}, flush=True)
        write(rows, folder / DATA)


def write(rows: list[dict[str, Any]], path: Path) -> None:
    """Write all plans as a table."""
    with path.open("w", newline="") as file:
        table = csv.DictWriter(file, COLUMNS, extrasaction="ignore", lineterminator="\n")
        table.writeheader()
        table.writerows(
            row | {n: f"{row[n]:.4g}" for n in ("error", "seconds") if isinstance(row.get(n), float)}
            for row in rows
        )


def verdicts_table(folder: Path) -> str:
    """Verdicts of all plans."""
    with (folder / DATA).open(newline="") as file:
        verdicts = Counter(row["verdict"] for row in csv.DictReader(file))
    rows = [("all", verdicts.total()), *verdicts.most_common()]
    return markdown(
        ("random plans", "number"), [*rows, ("**silently wrong**", f"**{verdicts['SILENTLY WRONG']}**")]
    )


TOPIC = Topic(
    "1000 random plans compared with references: right, refused, failed, silently wrong",
    "1 h",
    "stability",
    run,
    {"plans": 1},
    {"random_plans": verdicts_table},
)
