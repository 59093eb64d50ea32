"""One run of one plan, unchecked before it, and safer settings where it fails.

result = run_with_fallback("free-pinion-torque", gear, fidelity)
result.findings["tries"]      what was tried, and how each ended
"""

from collections.abc import Iterator
from dataclasses import replace
from time import perf_counter, process_time
from typing import Any

from rps_exudyn.gears.geometry_report import geometry_report
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Code, Interrupted, Status, each_once
from rps_exudyn.results.result import Result, failed
from rps_exudyn.scenes import scene_named
from rps_exudyn.scenes.checks.rules import breaches_of_plan, refused
from rps_exudyn.scenes.contact_law import resolve_contact_law, with_meshes
from rps_exudyn.scenes.scene import DEFAULT_OPTIONS, RunOptions, Scene
from rps_exudyn.scenes.scene_run import SceneRun
from rps_exudyn.scenes.two_levels import Levels
from rps_exudyn.solvers.temperature_and_wear import operating_gear, tested_gear


class Plan:
    """A gear in a scene by a model: what it is run with, and the results of its runs.

    Attributes:
        gear: as it is given, with the contact law that the scene needs.
        tested: the same in operation: warm or cold, worn.
    """

    def __init__(self, scene: str, gear: SteeringGear, fidelity: Fidelity) -> None:
        """Prepare a plan."""
        self._wall, self._cpu = perf_counter(), process_time()
        self.scene, self.fidelity = scene_named(scene), with_meshes(fidelity, gear)
        self.gear = resolve_contact_law(gear, fidelity, self.scene.law)
        self._geometry, in_operation = geometry_report(self.gear).numbers, operating_gear(self.gear)
        self.tested, self._numbers = (
            (in_operation.gear, in_operation.numbers) if in_operation else (self.gear, {})
        )

    def run(self, options: RunOptions = DEFAULT_OPTIONS) -> Result:
        """Run the plan without a check before it.

        Raises:
            InputError: a test that the gear does not allow.
            Interrupted: Ctrl-C; it carries what was recorded.
        """
        given = self.scene, self.tested, self.fidelity, options
        try:
            if not options.bars:
                return self.result(self.scene.run(*given[1:]))
            return self.result(Levels(*given).with_bars(options.level))
        except Interrupted as interrupt:
            raise Interrupted(self.result(interrupt.recorded)) from None

    def result(self, done: SceneRun) -> Result:
        """Return the result of a run; its times are those since the plan was prepared."""
        formulas = self.scene.test.formulas if self.scene.test and done.summary else None
        return Result(
            scene=self.scene.name,
            gear=self.gear,
            fidelity=self.fidelity.model_dump(),
            solver=done.outcome.settings,
            findings=done.outcome.findings,
            status=done.outcome.status,
            message=done.outcome.message,
            codes=each_once(done.outcome.codes),
            signals=done.signals,
            summary=done.summary | (formulas(self.tested) if formulas else {}) | self._numbers,
            errors=done.errors,
            counters={**done.outcome.counters, "solver_cpu": done.outcome.cpu_s},
            geometry=self._geometry,
            cpu_s=process_time() - self._cpu,
            wall_s=perf_counter() - self._wall,
        )

    @property
    def refusal(self) -> Result | None:
        """Return the result of a plan that a check before the run refuses; None of any other."""
        if not (sentences := refused(self.tested, self.fidelity, motion=self.scene.motion)):
            return None
        message = "; ".join(sentences)
        result = failed(self.scene.name, self.gear, self.fidelity, Status.INVALID, f"not run: {message}")
        found = {"refused": message}
        return replace(result, codes=(Code.REFUSED.value,), findings=found, geometry=self._geometry)


def run_unchecked(
    scene: str, gear: SteeringGear, fidelity: Fidelity, options: RunOptions = DEFAULT_OPTIONS
) -> Result:
    """Run a plan without a check before it, for studies of what goes wrong then.

    Raises:
        InputError: a gear that cannot exist, or a test that it does not allow.
        Interrupted: Ctrl-C; it carries what was recorded.
    """
    return Plan(scene, gear, fidelity).run(options)


# --- Fallback: the first try is the plan as given, repaired where `checks.rules` refuse it. Changed
# settings stand in the result's fidelity, message and tries.

Changes = dict[str, Any]


def run_with_fallback(
    scene: str, gear: SteeringGear, fidelity: Fidelity, options: RunOptions = DEFAULT_OPTIONS
) -> Result:
    """Simulate by the first settings that end well; if none do, return the first try's result."""
    gear = resolve_contact_law(gear, fidelity, scene_named(scene).law)
    results: list[Result] = []
    tries: list[dict[str, Any]] = []
    for changes in _safer(scene_named(scene), tested_gear(gear), fidelity):
        try:
            model = fidelity.replace(changes) if changes else fidelity
            results.append(run_unchecked(scene, gear, model, options))
        except Interrupted as interrupt:
            raise (Interrupted(results[-1]) if results else interrupt) from None
        last = results[-1]
        tries.append({"changed": changes, "status": last.status.value, "message": last.message})
        if last.status is Status.OK:
            break
    return _reported(results[-1] if results[-1].status is Status.OK else results[0], tries)


def _safer(scene: Scene, gear: SteeringGear, fidelity: Fidelity) -> Iterator[Changes]:
    """Changes of the fidelity, safer from one to the next."""
    changes: Changes = {}
    for breach in breaches_of_plan(gear, fidelity, motion=scene.motion):
        changes |= breach.repair
    yield dict(changes)
    step = changes.get("step_angle", fidelity.step_angle)
    yield changes | {"step_angle": step / 2}
    changes |= {"step_angle": step / 5}
    yield dict(changes)
    equilibria_can = fidelity.bush != "chain" and not scene.needs_inertia
    if fidelity.solver == "generalized-alpha" and equilibria_can:
        yield changes | {"solver": "equilibrium"}
    elif fidelity.solver == "equilibrium":
        yield changes | {"solver": "generalized-alpha"}


def _reported(result: Result, tries: list[dict[str, Any]]) -> Result:
    """The result with its tries, and with a message if the plan was not the one given."""
    findings, codes = {**result.findings, "tries": tries}, result.codes
    last = tries[-1]
    failures = [f"{_shown(each)}: {each['status']} ({each['message']})" for each in tries[:-1]]
    if not failures and not last["changed"]:
        message = result.message
    elif result.status is Status.OK:
        remarks = [result.message] if result.message else []
        codes = each_once([Code.OTHER_SETTINGS, *codes])
        message = "; ".join([*failures, f"ok with {_shown(last)}", *remarks])
    else:
        message = f"{result.message}; {len(failures)} safer settings did not help"
    return replace(result, findings=findings, codes=codes, message=message)


def _shown(tried: dict[str, Any]) -> str:
    changes = [f"{n} {Fidelity.declared_at(n)[0].show(value)}" for n, value in tried["changed"].items()]
    return ", ".join(changes) or "as given"
