"""What a scene needs: leave one thing out or simplify it, and see what that does to the metrics and the time.

    python studies/need_analysis.py [SCENE ...]

Writes results/scenes/need/SCENE.md, a table for each scene: a row for each change, in it how far each metric
moves from the everyday model (preset flank) and the solver's CPU time. Bold is what moves a metric by
more than the accuracy stated for it, so that the scene needs it. Some minutes.
"""

import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.quantities import SUMMARY
from rps_exudyn.results.result import Result
from rps_exudyn.simulate.run import SCENES, run

FOLDER = Path(__file__).parents[1] / "results" / "scenes" / "need"


@dataclass(frozen=True)
class Change:
    """One thing left out, simplified or added."""

    fidelity: dict[str, object] = field(default_factory=dict)
    gear: dict[str, object] = field(default_factory=dict)


CHANGES = {
    "bush: chain of 25 segments": Change({"bush": "chain"}),
    "bush: rigid": Change({"bush": "rigid"}),
    "yoke: force without plunger": Change({"yoke": "force"}),
    "yokenut: none": Change(gear={"yoke.clearance": "9 mm"}),
    "rack: no roll, yaw, pitch, sway": Change({"rack": "guided"}),
    "inertia: none (equilibria)": Change({"solver": "equilibrium"}),
    "inertia: pinion twice as heavy": Change(gear={"pinion.density": 2 * SteeringGear().pinion.density}),
    "teeth: constant line stiffness": Change(gear={"mesh.law": "line"}),
    "teeth: kinematic ratio with loss": Change({"mesh": "ratio-with-loss"}),
    "teeth: half as stiff": Change(gear={"mesh.stiffness": SteeringGear().mesh.stiffness / 2}),
    "teeth: contact damping 0.1 ms": Change(gear={"mesh.damping": "0.1 ms"}),
    "friction zone half as wide": Change({"zone_ratio": Fidelity().zone_ratio / 2}),
    "step half as long": Change({"step_angle": Fidelity().step_angle / 2}),
    "gravity, pinion below the rack": Change(gear={"installation.gravity": "9.81 m/s^2"}),
    "gravity, pinion above the rack": Change(gear={"installation.gravity": "-9.81 m/s^2"}),
}


@dataclass(frozen=True)
class Metric:
    """A summary's number, and the change that matters: a share of itself, or absolute (SI)."""

    name: str
    share: float = 0.0
    absolute: float = 0.0

    def moved(self, base: Result, other: Result) -> tuple[str, bool]:
        """The change as a reader wants it, and whether it matters."""
        if self.name not in other.summary or self.name not in base.summary:
            return "-", self.name in base.summary
        value, change = base.summary[self.name], other.summary[self.name] - base.summary[self.name]
        limit = self.absolute + self.share * abs(value)
        if abs(change) < 1e-3 * limit:
            return "0", False
        text = SUMMARY[self.name].show(change) if self.absolute else f"{100 * change / abs(value):+.2g} %"
        return text, abs(change) > limit


TORQUE = [
    Metric("torque_mean", share=0.01),
    Metric("torque_peak_to_peak", share=0.1),
    Metric("torque_tooth_order", share=0.1),
]
RACK = [Metric("rack_lift_range", absolute=0.5e-6), Metric("rack_roll_range", absolute=0.1e-3)]
RUNOUT = {"pinion.runout": "40 um"}


@dataclass(frozen=True)
class Need:
    """A scene and what is asked of it."""

    scene: str
    metrics: list[Metric]
    gear: dict[str, object] = field(default_factory=dict)


NEEDS = {
    "free-pinion-torque": Need("free-pinion-torque", [*TORQUE, *RACK]),
    "free-pinion-torque, runout 40 um": Need(
        "free-pinion-torque", [*TORQUE, Metric("torque_first_order", share=0.05), *RACK], RUNOUT
    ),
    "free-pinion-torque, runout beyond the clearance": Need(
        "free-pinion-torque",
        [*TORQUE, Metric("torque_first_order", share=0.05), *RACK],
        RUNOUT | {"yoke.clearance": "30 um"},
    ),
    "load-test": Need(
        "load-test",
        [
            Metric("torque_forward", share=0.01),
            Metric("torque_reverse", share=0.01),
            Metric("efficiency_forward", share=0.01),
            Metric("efficiency_reverse", share=0.01),
            *RACK,
        ],
        {"test.load_mass": "40 kg"},
    ),
    "rack-push": Need(
        "rack-push",
        [Metric("push_force_mean", share=0.01), Metric("push_force_peak_to_peak", share=0.1), *RACK],
    ),
    "reversal": Need(
        "reversal",
        [
            Metric("torque_jump", share=0.01),
            Metric("hysteresis_area", share=0.01),
            Metric("lost_motion", absolute=0.5e-6),
            Metric("reversal_angle", share=0.1),
        ],
    ),
    "yoke-impact": Need(
        "yoke-impact",
        [
            Metric("impacts", absolute=0.5),
            Metric("impact_peak_force", share=0.05),
            Metric("impact_impulse", share=0.05),
            Metric("impact_duration", share=0.1),
        ],
    ),
}


def main(wanted: list[str]) -> None:
    FOLDER.mkdir(parents=True, exist_ok=True)
    for scene in wanted or SCENES:
        tables = [table(name, need) for name, need in NEEDS.items() if need.scene == scene]
        (FOLDER / f"{scene}.md").write_text("\n".join(tables), encoding="utf-8")


def table(name: str, need: Need) -> str:
    """One scene's table as Markdown."""
    base = timed(lambda: outcome(need, Change()))
    assert isinstance(base, Result)
    head = ["change", *(f"`{metric.name}`" for metric in need.metrics), "CPU s"]
    values = [SUMMARY[metric.name].show(base.summary[metric.name]) for metric in need.metrics]
    rows = [["everyday model", *values, cpu(base)]]
    for title, change in CHANGES.items():
        other = timed(lambda change=change: outcome(need, change))  # type: ignore[misc]
        rows.append([title, *cells(need, base, other)])
        print(" | ".join(rows[-1]), flush=True)
    limits = ", ".join(f"`{m.name}` {_limit(m)}" for m in need.metrics)
    lines = [head, ["---"] * len(head), *rows]
    text = "\n".join(f"| {' | '.join(line)} |" for line in lines)
    return f"### {name}\n\nStated accuracy: {limits}.\n\n{text}\n"


def outcome(need: Need, change: Change) -> Result | str:
    """The run, or why the scene cannot do without what was changed."""
    try:
        gear = SteeringGear().replace(need.gear | change.gear)
        result = run(need.scene, gear, fidelity=Fidelity.preset("flank").replace(change.fidelity))
    except InputError as error:
        return str(error).split(";")[-1].strip()
    return result if result.status is Status.OK else f"{result.status}: {result.message}"


def timed(measure: Callable[[], Result | str]) -> Result | str:
    """A second run, after one that compiled and loaded what it needs."""
    measure()
    return measure()


def cells(need: Need, base: Result, other: Result | str) -> list[str]:
    if isinstance(other, str):
        return [f"*{other}*", *[""] * len(need.metrics)]
    moved = [metric.moved(base, other) for metric in need.metrics]
    return [*(f"**{text}**" if matters else text for text, matters in moved), cpu(other)]


def cpu(result: Result) -> str:
    return f"{result.counters['solver_cpu']:.2g}"


def _limit(metric: Metric) -> str:
    return SUMMARY[metric.name].show(metric.absolute) if metric.absolute else f"{metric.share:.0%}"


if __name__ == "__main__":
    main(sys.argv[1:])
