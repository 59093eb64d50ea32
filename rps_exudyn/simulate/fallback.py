"""When a run fails: the next safer settings, one after the other, and every try told.

    result = robust_run("free-pinion-torque", gear, fidelity)
    result.solver["tries"]      what was tried, and how each ended

The first try is the plan as given, repaired where `guards` refuse it. What is changed stays in the result's
fidelity, its message and its tries: a number that took fallback never looks like one that did not.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from rps_exudyn.checks.before_run import breaches
from rps_exudyn.parameters.fidelity import CHAINS, Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.result import Result
from rps_exudyn.simulate.run import unguarded


def robust_run(scene: str, gear: SteeringGear, fidelity: Fidelity) -> Result:
    """The scene by the first settings that end well; if none do, the first try's result.

    Raises:
        InputError: a gear that cannot exist, or a test that it does not allow.
    """
    tries: list[dict[str, Any]] = []
    results: list[Result] = []
    for changes in _ladder(scene, gear, fidelity):
        chosen = fidelity.replace(changes) if changes else fidelity
        result = unguarded(scene, gear, chosen)
        results.append(result)
        tries.append({"changed": changes, "status": result.status.value, "message": result.message})
        if result.status is Status.OK:
            return _told(result, tries)
    return _told(results[0], tries)


def _ladder(scene: str, gear: SteeringGear, fidelity: Fidelity) -> Iterator[dict[str, Any]]:
    """Changes of the fidelity, safer from one to the next."""
    changes: dict[str, Any] = {}
    for breach in breaches(scene, gear, fidelity):
        changes |= breach.repair
    yield dict(changes)
    step = changes.get("step_angle", fidelity.step_angle)
    yield changes | {"step_angle": step / 2}
    changes |= {"step_angle": step / 5}
    yield dict(changes)
    if fidelity.mesh == "flank":
        changes |= {"mesh": "flank-generators"}
        yield dict(changes)
    statics_can = fidelity.bush not in CHAINS and scene != "yoke-impact"
    if fidelity.solver == "generalized-alpha" and statics_can:
        yield changes | {"solver": "equilibrium"}
    elif fidelity.solver == "equilibrium":
        yield changes | {"solver": "generalized-alpha"}


def _told(result: Result, tries: list[dict[str, Any]]) -> Result:
    """The result with its tries; a message if the plan was not the one given."""
    solver = {**result.solver, "tries": tries}
    last = tries[-1]
    if len(tries) == 1 and not last["changed"]:
        return replace(result, solver=solver)
    failures = [f"{_changed(each)}: {each['status']} ({each['message']})" for each in tries[:-1]]
    if result.status is Status.OK:
        end = f"ok with {_changed(last)}"
        remarks = [result.message] if result.message else []
        return replace(result, solver=solver, message="; ".join([*failures, end, *remarks]))
    return replace(
        result, solver=solver, message=f"{result.message}; nor did {len(tries) - 1} safer settings"
    )


def _changed(tried: dict[str, Any]) -> str:
    told = ", ".join(
        f"{n} {v:.4g}" if isinstance(v, float) else f"{n} {v}" for n, v in tried["changed"].items()
    )
    return told or "as given"
