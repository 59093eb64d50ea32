"""The scenes against what is known in closed form, and what they cost.

    python studies/bench_scenes.py

Prints the tables of results/README.md, section Scenes. CPU seconds of the whole command, compiled, the
least of three repeats.
"""

from collections.abc import Callable, Iterator

import numpy as np

from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.result import Result
from rps_exudyn.simulate.run import run
from rps_exudyn.solvers.closed_form import GRAVITY, closed_form, pushing_force, runout_harmonics

PRESETS = ("flank", "quasi-static", "closed-form")
GEAR = SteeringGear()
GAIN = float(GearPair.of(GEAR).gain)
LOCKS = {"test.path": "lock-to-lock", "test.speed": "60 rpm"}

Settings = dict[str, object]


def main() -> None:
    print("| law | required % | " + " | ".join(PRESETS) + " |")
    print("|---|---|" + "---|" * len(PRESETS))
    for name, required, check in laws():
        print(
            f"| {name} | {required} | " + " | ".join(f"{100 * check(each):+.2g}" for each in PRESETS) + " |"
        )
    print("\n| run, preset flank | CPU s | of it solver | energy residual % |")
    print("|---|---|---|---|")
    for name, scene, settings in costs():
        print(f"| {name} | {' | '.join(cost(scene, settings))} |")


def laws() -> Iterator[tuple[str, str, Callable[[str], float]]]:
    """Name, bound, and the relative deviation by preset."""
    free = closed_form(GEAR).free_torque
    yield "mean torque against the formula", "1", lambda preset: mean(preset) / free - 1
    for mass in (10.0, 40.0):
        yield f"load test {mass:g} kg: half sum over W s'", "1.5", lambda p, m=mass: load_sum(p, m)
        yield (
            f"load test {mass:g} kg: half difference over T_0",
            "1.5",
            lambda p, m=mass: load_difference(p, m),
        )
    yield "rack push against the formula", "1", lambda preset: push(preset) / pushing_force(GEAR, +1) - 1
    yield "first order, runout 40 um, against the formula", "5", first_order
    yield "linearity in the preload, 150 to 600 N", "1", preload_linearity
    yield "linearity in the friction, 0.05 to 0.2", "1", friction_linearity
    for rpm in (1, 60, 300):
        yield (
            f"mean torque at {rpm} rpm against 15 rpm",
            "0.5",
            lambda p, n=rpm: mean(p, {"test.speed": f"{n} rpm"}) / mean(p) - 1,
        )


def ran(scene: str, preset: str, settings: Settings) -> Result:
    result = run(scene, GEAR.replace(settings), fidelity=preset)
    if result.status is not Status.OK:
        raise SystemExit(f"{scene} {preset} {settings}: {result.message}")
    return result


def mean(preset: str, settings: Settings | None = None) -> float:
    return ran("free-pinion-torque", preset, settings or {}).summary["torque_mean"]


def load_sum(preset: str, mass: float) -> float:
    """The ideal torque is small at 10 kg, so the deviation is a share of the larger, T_0 or W s'."""
    found = ran("load-test", preset, {"test.load_mass": mass}).summary
    half = (found["torque_forward"] + found["torque_reverse"]) / 2
    ideal = GRAVITY * mass * GAIN
    return (half - ideal) / max(ideal, found["free_torque"])


def load_difference(preset: str, mass: float) -> float:
    found = ran("load-test", preset, {"test.load_mass": mass}).summary
    return (found["torque_forward"] - found["torque_reverse"]) / 2 / found["free_torque"] - 1


def push(preset: str) -> float:
    return ran("rack-push", preset, {}).summary["push_force_mean"]


def first_order(preset: str) -> float:
    runout = {"pinion.runout": "40 um"}
    found = ran("free-pinion-torque", preset, runout).summary["torque_first_order"]
    return found / float(np.hypot(*runout_harmonics(GEAR.replace(runout)))) - 1


def preload_linearity(preset: str) -> float:
    """The middle torque off the straight line through the others."""
    low, middle, high = (mean(preset, {"yoke.preload": load}) for load in (150.0, 375.0, 600.0))
    return middle / ((low + high) / 2) - 1


def friction_linearity(preset: str) -> float:
    """The torque of the teeth at the middle of three coefficients, off the straight line."""
    low, middle, high = (mean(preset, {"mesh.friction": mu}) for mu in (0.05, 0.125, 0.2))
    return middle / ((low + high) / 2) - 1


def costs() -> Iterator[tuple[str, str, Settings]]:
    yield "free pinion torque, one turn at 15 rpm", "free-pinion-torque", {}
    yield "free pinion torque, lock to lock and back at 60 rpm", "free-pinion-torque", LOCKS
    yield "load test, lock to lock and back at 60 rpm, and free", "load-test", LOCKS
    yield "rack push, lock to lock and back at 60 rpm", "rack-push", LOCKS
    yield "reversal, one cycle of 30 deg", "reversal", {}
    yield "yoke impact, one pulse, 40 ms", "yoke-impact", {}


def cost(scene: str, settings: Settings) -> list[str]:
    ran(scene, "flank", settings)  # so that everything is compiled
    runs = [ran(scene, "flank", settings) for _ in range(3)]
    whole, solver = (
        min(times) for times in zip(*((r.cpu_s, r.counters["solver_cpu"]) for r in runs), strict=True)
    )
    return [f"{whole:.2g}", f"{solver:.2g}", f"{100 * runs[0].summary['energy_residual']:+.2g}"]


if __name__ == "__main__":
    main()
