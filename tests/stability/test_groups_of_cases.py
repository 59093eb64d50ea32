"""Cases that go through `batch` in groups end as they do singly, whatever happens to a group."""

import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rps_exudyn as rps
from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.results.block import CaseRecord
from rps_exudyn.results.outcome import Status
from rps_exudyn.scenes.error_bars import error_bars
from rps_exudyn.simulate.cases.case_group import CaseGroup
from rps_exudyn.simulate.cases.processes import Processes
from rps_exudyn.simulate.cases.task import Answer, Executor, Task, answer_to
from rps_exudyn.study import task_queue
from rps_exudyn.study.runner import StudyWork, run_study
from rps_exudyn.study.store import Store
from rps_exudyn.study.study_file import read_study
from rps_exudyn.study.task_queue import FEWEST, TaskQueue, group_plan_of
from shell import Command
from study_files import Here, write_grid, write_stand_in

SINGLY = '[set]\nyoke.friction_law = "bristle"\n'  # as no gears are computed together
TORQUE = '[keep]\nsignals = ["pinion_torque"]\n[set]\ntest.turns = 0.2\n'


def tasks_of(folder: Path, cases: int, extra: str = "", executor: Here = Here()) -> TaskQueue:  # noqa: B008
    """The tasks of a study over so many preloads from 100 N."""
    file = write_grid(folder / "s.toml", *range(100, 100 + cases))
    file.write_text(file.read_text().replace("[[axis]]", f"{extra}[[axis]]"))
    work = StudyWork.of(read_study(file), folder / "s")
    return TaskQueue(work.study, work.description, work.missing, executor)


def group_of(task: Task) -> CaseGroup:
    """The cases of a task."""
    group = task.call.__self__  # type: ignore[attr-defined]
    assert isinstance(group, CaseGroup)
    return group


def answered(task: Task, seconds: float = 1.0) -> Answer:
    """A task whose cases all end."""
    record = CaseRecord("", {"findings": "{}"}, {}, {})
    return Answer([record] * len(group_of(task).settings), wall_s=seconds)


def test_groups_grow_to_their_time_and_shrink_towards_the_end(tmp_path: Path) -> None:
    tasks, sizes = tasks_of(tmp_path, 1000, SINGLY), []
    for task in tasks:
        sizes.append(len(group_of(task).settings))
        assert len(tasks.records(task, answered(task, 0.01 * sizes[-1]))) == sizes[-1]
    assert sum(sizes) == tasks.through_batch == 1000
    assert sizes[0] == task_queue.SMALLEST
    assert max(sizes) <= Here().group_seconds / 0.01
    assert sizes[1:] == sorted(sizes[1:], reverse=True)
    assert sizes[-2] == task_queue.SMALLEST


def test_a_group_takes_less_than_the_time_limit_of_a_case(tmp_path: Path) -> None:
    tasks = tasks_of(tmp_path, 4000, SINGLY, Here(group_seconds=1e3))
    for _ in range(3):
        task = next(tasks)
        tasks.records(task, answered(task, 0.5 * len(group_of(task).settings)))
    assert 0.5 * len(group_of(next(tasks)).settings) <= 20.0 / task_queue.OF_LIMIT


@pytest.mark.parametrize("answer", [Answer(ended="killed"), Answer(error=InputError("wrong"))])
def test_a_group_without_answers_is_done_singly(tmp_path: Path, answer: Answer) -> None:
    tasks = tasks_of(tmp_path, FEWEST)
    lost = next(tasks)
    for task in list(tasks):
        tasks.records(task, answered(task))
    assert tasks.records(lost, answer) == []
    again = [group_of(task).settings for task in tasks]  # the iterator had ended before
    assert [list(settings) for settings in again] == [[name] for name in group_of(lost).settings]
    assert tasks.through_batch == FEWEST - len(again)


@pytest.mark.parametrize(
    "extra",
    ['[set]\nfidelity.solver = "generalized-alpha"\n', '[set]\nfidelity.mesh = "general-contact"\n'],
)
def test_dear_models_are_done_singly(tmp_path: Path, extra: str) -> None:
    """Each of their cases takes seconds, and has a time limit of its own."""
    assert all(len(group_of(task).settings) == 1 for task in tasks_of(tmp_path, FEWEST, extra))


def test_few_cases_are_done_singly(tmp_path: Path) -> None:
    assert all(len(group_of(task).settings) == 1 for task in tasks_of(tmp_path, FEWEST - 1))


def some(group: CaseGroup, chosen: Sequence[int], **changes: Any) -> CaseGroup:
    """Some cases of a group."""
    settings = [list(group.settings.items())[at] for at in chosen]
    return replace(group, settings=dict(settings), **changes)


def with_impossible(group: CaseGroup, at: int) -> CaseGroup:
    """A group whose case `at` has a preload that no gear can have."""
    name = list(group.settings)[at]
    wrong = {**group.settings[name], "yoke.preload": -1.0}
    return replace(group, settings={**group.settings, name: wrong})


def statuses(records: list[CaseRecord]) -> list[str]:
    return [record.attributes["status"] for record in records]


def test_members_of_a_group_end_bit_for_bit_as_single_cases(tmp_path: Path) -> None:
    """A gear that cannot exist among them; only times differ."""
    whole = group_of(next(tasks_of(tmp_path, FEWEST, SINGLY + "test.turns = 0.2\n")))
    group = with_impossible(some(whole, range(4)), 2)
    found = group.records()
    for index in (0, 1, 3):
        (alone,), record = some(group, [index]).records(), found[index]
        assert record.hash == alone.hash
        assert {**record.tables, "counters": {}} == {**alone.tables, "counters": {}}
        assert record.attributes["parameters"] == alone.attributes["parameters"]
        assert all(np.array_equal(values, alone.signals[name]) for name, values in record.signals.items())
    assert statuses(found) == ["ok", "ok", "invalid", "ok"]


@pytest.mark.parametrize("keep", ["", '[keep]\nsignals = ["pinion_torque"]\n'])
def test_members_of_a_group_are_followed_together(tmp_path: Path, keep: str) -> None:
    """They end as single runs: the same instants and names, means within 1e-5, all else within 1e-3."""
    tasks = tasks_of(tmp_path, FEWEST, f"{keep}[set]\ntest.turns = 0.2\n")
    task = next(tasks)
    group, answer = group_of(task), answer_to(task, 100.0)
    assert tasks.records(task, answer)
    assert tasks.in_loop > FEWEST / 2
    for at in (0, -1):
        (theirs,), ours = some(group, [at], ranges=None).records(), answer.value[at]
        for name in ("status", "message", "parameters"):
            assert ours.attributes[name] == theirs.attributes[name]
        mean = theirs.tables["summary"]["torque_mean"]
        assert ours.tables["summary"]["torque_mean"] == pytest.approx(mean, rel=1e-5)
        assert ours.tables["geometry"] == theirs.tables["geometry"]
        assert set(ours.tables["summary"]) == set(theirs.tables["summary"])
        counted = ours.tables["counters"]
        assert set(theirs.tables["counters"]) - set(counted) == {"solver_cpu"}  # which no gear has alone
        assert counted["steps"] <= counted["force_evaluations"] < 3 * counted["steps"]
        assert set(ours.signals) == set(theirs.signals)
        for name in ("time", "pinion_angle"):
            assert ours.signals[name] == pytest.approx(theirs.signals[name], abs=1e-9)
        assert ours.signals["pinion_torque"] == pytest.approx(theirs.signals["pinion_torque"], rel=1e-3)


def test_unknown_error_bar_of_a_member_is_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def bars(*given: Any) -> dict[str, Any]:
        known = error_bars(*given)
        return known | {"torque_mean": known["torque_mean"] * np.nan}

    monkeypatch.setattr("rps_exudyn.simulate.gear_table.error_bars", bars)
    group = group_of(next(tasks_of(tmp_path, FEWEST, "[set]\ntest.turns = 0.2\n")))
    record = next(each for each in group.records() if each.in_loop)
    assert np.isnan(record.result().errors["torque_mean"])


def test_time_of_a_group_that_is_over_gives_no_records(tmp_path: Path) -> None:
    answer = answer_to(next(tasks_of(tmp_path, FEWEST)), 1e-3)
    assert (answer.value, answer.timeout) == (None, 1e-3)


@pytest.mark.parametrize("wrapped", [False, True])
def test_interrupt_within_a_case_is_no_crash(
    wrapped: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Compiled code that calls Python turns an interrupt into a SystemError."""

    def interrupted(*_: object, **__: object) -> None:
        time.sleep(0.01)
        try:
            raise KeyboardInterrupt
        except KeyboardInterrupt as interrupt:
            if not wrapped:
                raise
            raise SystemError("returned a result with an exception set") from interrupt

    group = group_of(next(tasks_of(tmp_path, FEWEST)))
    monkeypatch.setattr("rps_exudyn.simulate.cases.case_group.simulate", interrupted)
    for count in (2, 1):
        call = some(group, range(count), ranges=None).records
        assert answer_to(Task(call), 0.01).timeout
        with pytest.raises(KeyboardInterrupt):
            answer_to(Task(call), 100.0)
    failure = answer_to(Task(call), 0.01).failure(group.scene, rps.SteeringGear(), Fidelity())
    assert failure.status is Status.TIMEOUT


def test_bad_cases_of_a_group_harm_no_other(
    command: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A process that dies, an error and a failure, in processes that simulate nothing."""
    monkeypatch.setenv("PYTHONPATH", str(write_stand_in(tmp_path)))
    file = write_grid(tmp_path / "s.toml", *range(100, 170), 901, 903, 904)
    file.write_text(f"{file.read_text()}{SINGLY}[keep]\nblocks = true\nsamples = 11\n")
    answer = command(["study", str(file), "--jobs", "1", "--json"])
    assert answer.status == 1
    assert 0 < answer.json["in_groups"] < 73
    found = {case.values["yoke.preload"]: row for case, row in Store.open(tmp_path / "s").rows()}
    assert {preload: row.status for preload, row in found.items() if row.status is not Status.OK} == {
        901: Status.CRASHED,
        903: Status.CRASHED,
        904: Status.DIVERGED,
    }
    assert len(found) == 73
    assert found[169].summary["torque_mean"] == 169 / 500


RANDOM = """
fidelity = "quasi-static"
design = "latin-hypercube"
samples = 64
[set]
test.turns = 0.2
yoke.nut_damping = 1e-5
[[axis]]
path = "yoke.clearance"
uniform = ["0 um", "60 um"]
[[axis]]
path = "yoke.preload"
uniform = ["200 N", "500 N"]
[[axis]]
path = "mesh.friction"
uniform = [0.03, 0.1]
[[axis]]
path = "pinion.runout"
uniform = ["0 um", "20 um"]
[[axis]]
path = "pinion.runout_angle"
uniform = ["0 deg", "360 deg"]
[[axis]]
path = "yoke.seat_stiffness"
uniform = ["50 N/um", "300 N/um"]
"""


def random_group(folder: Path, scene: str) -> CaseGroup:
    """All cases of a study of random gears."""
    file = folder / "random.toml"
    file.write_text(f'scene = "{scene}"\n{RANDOM}')
    work = StudyWork.of(read_study(file), folder / "random")
    return group_of(next(TaskQueue(work.study, work.description, work.missing, Here())))


def numbers_of(record: CaseRecord) -> dict[str, Any]:
    """All that a case's file holds but times, to be compared bit for bit."""
    counters = {name: count for name, count in record.tables["counters"].items() if name != "solver_cpu"}
    tables = {**record.tables, "counters": counters}
    said = {name: record.attributes[name] for name in ("status", "message", "parameters", "findings")}
    return {**tables, **said, **{name: values.tobytes() for name, values in record.signals.items()}}


@pytest.mark.parametrize("scene", ["free-pinion-torque", "rack-push"])
def test_a_case_ends_bit_for_bit_alike_in_whatever_company(tmp_path: Path, scene: str) -> None:
    """In groups of one, of three and of all, in any order, with a gear among them that cannot exist, and some
    whose yoke touches its nut."""
    whole = with_impossible(random_group(tmp_path, scene), 2)
    found = {record.hash: record for record in whole.records()}
    assert sum(record.in_loop for record in found.values()) > 0.9 * len(found)
    order = np.random.default_rng(1).permutation(len(found)).tolist()
    groups = [order, *([at] for at in order[:4]), order[4:7], order[7:10], [2]]
    for group in groups:
        for record in some(whole, group).records():
            assert numbers_of(record) == numbers_of(found[record.hash])


class Stopped(Here):
    """Is interrupted while it does its second task."""

    def run(self, tasks: Iterator[Task]) -> Iterator[tuple[Task, Answer]]:
        """Do one task."""
        yield from islice(super().run(tasks), 1)
        raise KeyboardInterrupt


class Deadly(Here):
    """Its process dies at groups, and answers of single cases come last first."""

    def run(self, tasks: Iterator[Task]) -> Iterator[tuple[Task, Answer]]:
        """Do all tasks."""
        left = []
        for task in tasks:
            if len(group_of(task).settings) > 1:
                yield task, Answer(ended="killed")
            else:
                left.append(task)
        yield from reversed([(task, answer_to(task, 100.0)) for task in left])


def test_a_study_ends_bit_for_bit_alike_after_whatever_happens(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Undisturbed, interrupted and resumed by two processes, and with processes that die."""
    monkeypatch.setattr(task_queue, "SMALLEST_TOGETHER", 21)
    file = write_grid(tmp_path / "s.toml", *range(250, 250 + FEWEST))
    file.write_text(file.read_text().replace("[[axis]]", "[set]\ntest.turns = 0.2\n[[axis]]"))

    def study(name: str, executor: Executor) -> StudyWork:
        work = StudyWork.of(read_study(file), tmp_path / name)
        run_study(work, executor)
        return work

    def numbers(name: str) -> dict[str, Any]:
        """Of each case all numbers but times, and what is said of it."""
        found = {}
        for case, result in Store.open(tmp_path / name).results():
            signals = {signal: values.tobytes() for signal, values in result.signals.items()}
            found[case.hash] = result.status, result.message, result.summary, result.findings, signals
        return found

    study("whole", Here())
    with pytest.raises(KeyboardInterrupt):
        study("resumed", Stopped())
    assert len(numbers("resumed")) == 21
    with Processes(2, 100.0) as processes:
        study("resumed", processes)
    study("deadly", Deadly())
    whole = numbers("whole")
    assert len(whole) == FEWEST
    assert numbers("resumed") == whole
    assert numbers("deadly") == whole


def test_a_case_that_cannot_learn_from_others_is_simulated_without(tmp_path: Path) -> None:
    """One whose time is over, or which fails; not one whose process died, as it may by chance."""
    tasks = tasks_of(tmp_path, FEWEST)
    tasks.records(next(tasks), Answer(ended="killed"))
    late, wrong, dead, *_ = alone = list(tasks)
    assert all(group_of(task).ranges is not None for task in alone)
    assert tasks.records(late, Answer(timeout=1.0)) == []
    assert tasks.records(wrong, Answer(error=ValueError())) == []
    ((_, record),) = tasks.records(dead, Answer(ended="killed"))
    assert record.attributes["status"] == "crashed"
    given = list(tasks)
    again = [group_of(task) for task in given]
    assert [list(group.settings) for group in again] == [
        list(group_of(task).settings) for task in (late, wrong)
    ]
    assert [group.ranges for group in again] == [None, None]
    ((_, record),) = tasks.records(given[0], Answer(timeout=1.0))
    assert record.attributes["status"] == "timeout"


@pytest.mark.parametrize(
    ("extra", "reason"),
    [
        (SINGLY, "need single runs"),
        ('[set]\nrack.bow = "0.1 mm"\n', "a bow, a side force"),
    ],
)
def test_what_is_not_followed_together_goes_in_groups_without_ranges(
    tmp_path: Path, extra: str, reason: str
) -> None:
    tasks = tasks_of(tmp_path, FEWEST, extra)
    assert all(group_of(task).ranges is None for task in tasks)
    assert reason in tasks.plan.single_run_reason


def test_ranges_leave_out_what_no_gear_can_have(tmp_path: Path) -> None:
    """A load among the cases that no teeth carry harms no other."""
    file = write_grid(tmp_path / "s.toml", *range(100, 170), 5e6)
    file.write_text(file.read_text().replace("[[axis]]", '[keep]\nsignals = "none"\n[[axis]]'))
    work = StudyWork.of(read_study(file), tmp_path / "s")
    ranges = group_plan_of(work.study, work.description).ranges
    assert ranges is not None
    assert (min(ranges["yoke.preload"]), round(max(ranges["yoke.preload"]))) == (100, 169)


@pytest.mark.parametrize(
    ("scene", "axis", "cause"),
    [
        ("load-test", 'path = "test.load_mass"\nunit = "kg"\nlinspace = [0, 64, 65]', "greater than 0"),
        (
            "rack-push",
            f'path = "yoke.preload"\nvalues = {[5e6, *range(270, 334)]}',
            "more than the teeth carry",
        ),
    ],
)
def test_of_other_scenes_some_cases_go_singly(tmp_path: Path, scene: str, axis: str, cause: str) -> None:
    """The first has no run, and its cause; the others are found together, within 1e-5 of single runs."""
    file = tmp_path / "s.toml"
    file.write_text(
        f'scene = "{scene}"\nfidelity = "quasi-static"\n[keep]\nsignals = "none"\n'
        f"[set]\ntest.turns = 0.2\n[[axis]]\n{axis}\n"
    )
    work = StudyWork.of(read_study(file), tmp_path / "s")
    whole = group_of(next(TaskQueue(work.study, work.description, work.missing, Here())))
    found = some(whole, [0, *range(40, 45)]).records()
    assert [record.in_loop for record in found] == [False] + 5 * [True]
    assert found[0].attributes["status"] == "invalid"
    assert cause in found[0].attributes["message"]
    (alone,) = some(whole, [44], ranges=None).records()
    name = "torque_forward" if scene == "load-test" else "push_force_mean"
    assert found[5].tables["summary"][name] == pytest.approx(alone.tables["summary"][name], rel=1e-5)


@pytest.mark.parametrize(
    ("extra", "said"),
    [
        (TORQUE, "most of them computed together"),
        ("", "most of them computed together"),
        (SINGLY, "no cases computed together: bristles"),
    ],
)
def test_a_dry_run_says_which_way_cases_go(command: Command, tmp_path: Path, extra: str, said: str) -> None:
    file = write_grid(tmp_path / "s.toml", *range(250, 250 + FEWEST))
    file.write_text(file.read_text().replace("[[axis]]", f"{extra}[[axis]]"))
    assert said in command(["study", str(file), "--dry-run"]).out


def test_a_case_found_together_is_rerun_compared_and_reported(command: Command, tmp_path: Path) -> None:
    file = write_grid(tmp_path / "s.toml", *range(250, 250 + FEWEST))
    file.write_text(file.read_text().replace("[[axis]]", "[set]\ntest.turns = 0.2\n[[axis]]"))
    assert command(["study", str(file), "--jobs", "1", "--json"]).json["in_loop"] == FEWEST
    store = Store.open(tmp_path / "s")
    first = store.path_of(store.description.cases[0].hash)
    assert "computed together" in rps.load(first).findings["together"]
    answer = command(["rerun", str(first), "--out", "again.h5", "--json"])
    assert answer.status == 0
    before, now = answer.json["differing"]["torque_mean"]
    assert before == pytest.approx(now, rel=1e-5)
    assert command(["diff", str(first), "again.h5"]).status == 0
    assert command(["report", str(first), "--out", "page.html"]).status == 0
    page = Path("page.html").read_text()
    assert "Geometry" in page
    assert "computed together" in page
