"""What guards and judge cost: their share of a run's CPU time, results/stability/guard_cost.json.

python studies/bench_guards.py [REPEATS]
"""

import json
import sys
from collections.abc import Callable
from pathlib import Path
from time import process_time
from typing import Any
from unittest.mock import patch

from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes import run_maneuver
from rps_exudyn.simulate import run as simulate

OUT = Path(__file__).parents[1] / "results" / "stability" / "guard_cost.json"
PITCH = 1 / SteeringGear().pinion.teeth
CASES = {
    "flank dynamics, a turn": ("flank", {}, 1.0),
    "equilibria, a tooth pitch": ("quasi-static", {}, PITCH),
    "equilibria, a turn": ("quasi-static", {}, 1.0),
    "equilibria, a turn with runout": ("quasi-static", {"pinion.runout": 40e-6}, 1.0),
    "bush of 25 segments, a tooth pitch": ("chain", {}, PITCH),
    "general contact, 2 deg": ("full", {}, 2 / 360),
}


class Clock:
    """CPU time spent in one function [s]."""

    def __init__(self) -> None:
        self.seconds = 0.0

    def around(self, work: Callable[..., Any]) -> Callable[..., Any]:
        """The same function, timed."""

        def timed(*given: Any) -> Any:
            start = process_time()
            try:
                return work(*given)
            finally:
                self.seconds += process_time() - start

        return timed


def fidelity_of(name: str) -> Fidelity:
    return Fidelity.preset("flank").replace({"bush": "chain"}) if name == "chain" else Fidelity.preset(name)


def cost(name: str, settings: dict[str, Any], turns: float, repeats: int) -> dict[str, float]:
    """CPU time of a run, and what guards and judge take of it."""
    gear = SteeringGear().replace(settings | {"test.turns": turns})
    guards, judge = Clock(), Clock()
    fidelity = fidelity_of(name)
    simulate.run("free-pinion-torque", gear, fidelity=fidelity)  # compiled and loaded
    with (
        patch.object(simulate, "refused", guards.around(simulate.refused)),
        patch.object(run_maneuver, "validated", judge.around(run_maneuver.validated)),
    ):
        start = process_time()
        for _ in range(repeats):
            simulate.run("free-pinion-torque", gear, fidelity=fidelity)
        whole = process_time() - start
    return {
        "run_ms": round(1e3 * whole / repeats, 3),
        "guards_percent": round(100 * guards.seconds / whole, 3),
        "judge_percent": round(100 * judge.seconds / whole, 3),
    }


def main() -> None:
    repeats = int(sys.argv[1]) if len(sys.argv) > 1 else 20
    table = {}
    for case, (name, settings, turns) in CASES.items():
        table[case] = cost(name, settings, turns, 2 if name == "full" else repeats)
        print(f"{case:36s} {table[case]}", flush=True)
    OUT.write_text(json.dumps(table, indent=1) + "\n")


if __name__ == "__main__":
    main()
