"""One case, or a group, from its parameters to the bytes of its file; whatever happens is an outcome."""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from time import monotonic, process_time
from typing import Any

from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.block import CaseRecord
from rps_exudyn.results.case_file import FileForms, Keep, kept
from rps_exudyn.results.outcome import Interrupted, Status
from rps_exudyn.results.result import Result, failed
from rps_exudyn.simulate.case_group import CaseGroup
from rps_exudyn.simulate.run import simulate
from rps_exudyn.simulate.time_limit import alarm, place_of, sentence


class CaseRunner:
    """Simulates cases one after the other."""

    def __init__(self) -> None:
        self._forms = FileForms()

    def warm_up(self, task: dict[str, Any], turns: float) -> None:
        """Run the task's scene over a few degrees of the default gear and discard it: loads what cases
        need."""
        gear = SteeringGear().replace({"test.turns": turns}).model_dump()
        result = _outcome(task | {"gear": gear})
        self._forms.content(kept(result, _keep(task)))
        if "members" in task:
            some = task["members"][:2] if "ranges" in task else task["members"]  # enough to begin
            with suppress(InputError):
                _outcomes(task | {"gear": gear, "members": some})

    def run(self, task: dict[str, Any]) -> tuple[dict[str, Any], bytes]:
        """Return the case's row for the index, and the bytes of its file or, if asked for, of its record."""
        return self._answer(_outcome(task), task, task)

    def run_group(self, task: dict[str, Any]) -> list[tuple[dict[str, Any], bytes]] | None:
        """Return the same for each member of a group; None if they are to be done singly."""
        try:
            results = _outcomes(task)
        except (InputError, KeyboardInterrupt):  # of the table as a whole; of its time
            return None
        return [
            self._answer(result, task, member)
            for result, member in zip(results, task["members"], strict=True)
        ]

    def _answer(
        self, whole: Result, task: dict[str, Any], case: dict[str, Any]
    ) -> tuple[dict[str, Any], bytes]:
        """`case` is the task or a member of it; records alone need its hash."""
        result = kept(whole, _keep(task))
        row = {
            "status": result.status.value,
            "message": result.message,
            "codes": list(result.codes),
            "cpu_s": result.cpu_s,
            "wall_s": result.wall_s,
            "summary": dict(result.summary),
            "in_loop": "together" in result.findings,
        }
        if task.get("form") == "record":
            return row, CaseRecord.of(case["hash"], result).to_bytes()
        return row, self._forms.content(result)


def _keep(task: dict[str, Any]) -> Keep:
    names = task["keep"]["signals"]
    return Keep(None if names is None else tuple(names), task["keep"]["samples"])


def _outcomes(task: dict[str, Any]) -> Sequence[Result]:
    """The results of a group's members, within the time of the task.

    Raises:
        InputError: what they have in common is wrong.
        KeyboardInterrupt: the time is over.
    """
    gear, fidelity = SteeringGear.from_tables(task["gear"]), Fidelity.from_tables(task["fidelity"])
    settings = [member["settings"] for member in task["members"]]
    group = CaseGroup(task["scene"], gear, fidelity, settings, task.get("ranges"))
    with alarm(task.get("time_limit", float("inf"))):
        return group.results(task["keep"]["signals"])


def _outcome(task: dict[str, Any]) -> Result:
    gear, fidelity = SteeringGear.from_tables(task["gear"]), Fidelity.from_tables(task["fidelity"])
    limit = task.get("time_limit", float("inf"))
    begun, cpu = task.get("begun", monotonic()), process_time()
    recorded = None
    try:
        with alarm(begun + limit - monotonic()):
            return simulate(task["scene"], gear, fidelity, robust=task.get("robust", False))
    except InputError as error:  # a gear that cannot be built, a test that leaves the rack
        status, message = Status.INVALID, " ".join(error.problems)
    except Interrupted as interrupt:
        status, recorded, message = Status.TIMEOUT, interrupt.recorded, interrupt.recorded.message
    except KeyboardInterrupt as interrupt:
        status, message = Status.TIMEOUT, f"interrupted {place_of(interrupt.__traceback__)}"
    except Exception as error:
        status, message = Status.CRASHED, f"{type(error).__name__}: {error}"
    wall, cpu = monotonic() - begun, process_time() - cpu
    if status is Status.TIMEOUT and wall >= limit:
        message = sentence(limit, message, cpu, wall)
    if recorded is not None:
        return replace(recorded, message=message, cpu_s=cpu, wall_s=wall)
    return failed(task["scene"], gear, fidelity, status, message, cpu, wall)
