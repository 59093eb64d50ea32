"""Cases that go through `batch` in groups end as they do singly, whatever happens to a group."""

from pathlib import Path
from typing import Any

import pytest

import rps_exudyn as rps
from rps_exudyn.results.block import CaseRecord
from rps_exudyn.results.outcome import Status
from rps_exudyn.simulate.case_run import CaseRunner
from rps_exudyn.simulate.processes import Done, Task
from rps_exudyn.study import handover
from rps_exudyn.study.handover import Handover
from rps_exudyn.study.runner import StudyWork
from rps_exudyn.study.store import Store
from rps_exudyn.study.study_file import read_study
from rps_exudyn.study.ways import FEWEST, ways_of
from shell import Command
from study_files import write_grid, write_stand_in

SINGLY = '[set]\nyoke.friction_law = "bristle"\n'  # as no gears are followed together
TORQUE = '[keep]\nsignals = ["pinion_torque"]\n[set]\ntest.turns = 0.2\n'


def tasks_of(folder: Path, cases: int, extra: str = "") -> Handover:
    """The tasks of a study over so many preloads from 100 N."""
    file = write_grid(folder / "s.toml", *range(100, 100 + cases))
    file.write_text(file.read_text().replace("[[axis]]", f"{extra}[[axis]]"))
    work = StudyWork.of(read_study(file), folder / "s")
    return Handover(work.study, work.store, work.missing, "record")


def answered(task: Task, seconds: float = 1.0) -> Done:
    """A group whose members all end ok."""
    answer = {"cases": [{"status": "ok", "message": ""} for _ in task["members"]]}
    return Done(task, answer, wall_s=seconds)


def test_groups_grow_to_their_time_and_shrink_towards_the_end(tmp_path: Path) -> None:
    tasks, sizes = tasks_of(tmp_path, 1000, SINGLY), []
    for task in tasks:
        sizes.append(len(task["members"]))
        assert len(tasks.answers(answered(task, 0.01 * sizes[-1]))) == sizes[-1]
    assert sum(sizes) == tasks.through_batch == 1000
    assert sizes[0] == handover.SMALLEST
    assert max(sizes) <= handover.SECONDS / 0.01
    assert sizes[1:] == sorted(sizes[1:], reverse=True)
    assert sizes[-2] == handover.SMALLEST


def test_a_group_takes_less_than_the_time_limit_of_a_case(tmp_path: Path) -> None:
    tasks = tasks_of(tmp_path, 4000, SINGLY)
    tasks._seconds = 100.0 / handover.OF_LIMIT
    for _ in range(3):
        task = next(tasks)
        tasks.answers(answered(task, 0.5 * len(task["members"])))
    assert 0.5 * len(next(tasks)["members"]) <= 100.0 / handover.OF_LIMIT


@pytest.mark.parametrize("answer", [None, {"cases": None}])
def test_a_group_without_answers_is_done_singly(tmp_path: Path, answer: dict[str, Any] | None) -> None:
    tasks = tasks_of(tmp_path, FEWEST)
    lost = next(tasks)
    for task in list(tasks):
        tasks.answers(answered(task))
    assert tasks.answers(Done(lost, answer, "killed")) == []
    again = list(tasks)  # the iterator had ended before
    assert [task["hash"] for task in again] == [member["hash"] for member in lost["members"]]
    assert all("members" not in task for task in again)
    assert tasks.through_batch == FEWEST - len(again)


@pytest.mark.parametrize(
    "extra",
    ['[set]\nfidelity.solver = "generalized-alpha"\n', '[set]\nfidelity.mesh = "general-contact"\n'],
)
def test_dear_models_are_done_singly(tmp_path: Path, extra: str) -> None:
    """Each of their cases takes seconds, and has a time limit of its own."""
    assert all("members" not in task for task in tasks_of(tmp_path, FEWEST, extra))


def test_few_cases_are_done_singly(tmp_path: Path) -> None:
    assert all("members" not in task for task in tasks_of(tmp_path, FEWEST - 1))


def test_members_of_a_group_end_bit_for_bit_as_single_cases(tmp_path: Path) -> None:
    """A gear that cannot exist among them; only times differ."""
    tasks = tasks_of(tmp_path, FEWEST, SINGLY + "test.turns = 0.2\n")
    group = dict(next(tasks))
    group["members"] = [dict(member) for member in group["members"][:4]]
    group["members"][2]["settings"] = {"yoke.preload": -1.0}
    tasks._grouped = False
    tasks._alone.extend(tasks._cases[member["hash"]] for member in group["members"])
    singles = [next(tasks) for _ in group["members"]]
    runner = CaseRunner()
    found = runner.run_group(group)
    assert found is not None
    for index in (0, 1, 3):
        row, (alone, _) = found[index][0], runner.run(dict(singles[index]))
        assert {**row, "cpu_s": 0, "wall_s": 0} == {**alone, "cpu_s": 0, "wall_s": 0}
    assert [row["status"] for row, _ in found] == ["ok", "ok", "invalid", "ok"]


@pytest.mark.parametrize("keep", ["", '[keep]\nsignals = ["pinion_torque"]\n'])
def test_members_of_a_group_are_followed_together(tmp_path: Path, keep: str) -> None:
    """They end as single runs: the same instants and names, means within 1e-5, all else within 1e-3."""
    tasks, runner = tasks_of(tmp_path, FEWEST, f"{keep}[set]\ntest.turns = 0.2\n"), CaseRunner()
    group = next(tasks)
    found = runner.run_group(dict(group))
    assert found is not None
    assert sum(row["in_loop"] for row, _ in found) > FEWEST / 2
    assert tasks.answers(Done(group, {"cases": [row for row, _ in found]}, wall_s=1.0))
    assert tasks.in_loop > FEWEST / 2
    ends = [found[0], found[-1]]
    tasks._alone.extend(tasks._cases[group["members"][i]["hash"]] for i in (0, -1))
    for (row, content), single in zip(ends, list(tasks), strict=True):
        alone, expected = runner.run(dict(single))
        assert (row["status"], row["message"]) == (alone["status"], alone["message"])
        assert row["summary"]["torque_mean"] == pytest.approx(alone["summary"]["torque_mean"], rel=1e-5)
        ours, theirs = CaseRecord.from_bytes(content), CaseRecord.from_bytes(expected)
        assert ours.attributes["parameters"] == theirs.attributes["parameters"]
        assert ours.tables["geometry"] == theirs.tables["geometry"]
        assert set(ours.tables["summary"]) == set(theirs.tables["summary"])
        counted = ours.tables["counters"]
        assert set(theirs.tables["counters"]) - set(counted) == {"solver_cpu"}  # which no gear has alone
        assert counted["steps"] <= counted["force_evaluations"] < 3 * counted["steps"]
        assert set(ours.signals) == set(theirs.signals)
        for name in ("time", "pinion_angle"):
            assert ours.signals[name] == pytest.approx(theirs.signals[name], abs=1e-9)
        assert ours.signals["pinion_torque"] == pytest.approx(theirs.signals["pinion_torque"], rel=1e-3)


def test_time_of_a_group_that_is_over_gives_no_answers(tmp_path: Path) -> None:
    group = dict(next(tasks_of(tmp_path, FEWEST)))
    assert CaseRunner().run_group(group | {"time_limit": 1e-3}) is None


@pytest.mark.parametrize("wrapped", [False, True])
def test_interrupt_within_a_case_is_no_crash(
    wrapped: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Compiled code that calls Python turns an interrupt into a SystemError."""

    def interrupted(*_: object, **__: object) -> None:
        try:
            raise KeyboardInterrupt
        except KeyboardInterrupt as interrupt:
            if not wrapped:
                raise
            raise SystemError("returned a result with an exception set") from interrupt

    group = dict(next(tasks_of(tmp_path, FEWEST)))
    monkeypatch.setattr("rps_exudyn.simulate.batch.simulate", interrupted)
    monkeypatch.setattr("rps_exudyn.simulate.case_run.simulate", interrupted)
    group["ranges"] = None
    group["members"] = group["members"][:2]
    assert CaseRunner().run_group(group) is None
    single = {name: group[name] for name in ("scene", "gear", "fidelity", "keep")}
    assert CaseRunner().run(single)[0]["status"] == "timeout"


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


def test_members_found_together_end_alike_in_whichever_group(tmp_path: Path) -> None:
    """All groups learn from the same gears; what is left is the rounding of sums over other lengths."""
    whole = dict(next(tasks_of(tmp_path, FEWEST, TORQUE)))
    whole["members"] = [dict(member) for member in whole["members"][:6]]
    whole["members"][2]["settings"] = {"yoke.preload": -1.0}
    part = whole | {"members": whole["members"][3:]}
    runner = CaseRunner()
    found, again = runner.run_group(whole), runner.run_group(part)
    assert found is not None
    assert again is not None
    assert [row["status"] for row, _ in found] == ["ok", "ok", "invalid", "ok", "ok", "ok"]
    assert [row["in_loop"] for row, _ in found] == [True, True, False, True, True, True]
    for (row, _), (other, _) in zip(found[3:], again, strict=True):
        assert row["summary"] == pytest.approx(other["summary"], rel=1e-9)


@pytest.mark.parametrize(
    ("extra", "reason"),
    [
        (SINGLY, "bristles ask for single runs"),
        ('[set]\nrack.bow = "0.1 mm"\n', "a bow, a side force"),
    ],
)
def test_what_is_not_followed_together_goes_in_groups_without_ranges(
    tmp_path: Path, extra: str, reason: str
) -> None:
    tasks = tasks_of(tmp_path, FEWEST, extra)
    assert all("ranges" not in task for task in tasks)
    assert reason in tasks.alone


def test_ranges_leave_out_what_no_gear_can_have(tmp_path: Path) -> None:
    """A load among the cases that no teeth carry harms no other."""
    file = write_grid(tmp_path / "s.toml", *range(100, 170), 5e6)
    file.write_text(file.read_text().replace("[[axis]]", '[keep]\nsignals = "none"\n[[axis]]'))
    work = StudyWork.of(read_study(file), tmp_path / "s")
    ranges = ways_of(work.study, work.store.description, len(work.missing)).ranges
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
    tasks, runner = Handover(work.study, work.store, work.missing, "record"), CaseRunner()
    group = dict(next(tasks))
    group["members"] = group["members"][:1] + group["members"][40:45]
    found = runner.run_group(group)
    assert found is not None
    assert [row["in_loop"] for row, _ in found] == [False] + 5 * [True]
    assert found[0][0]["status"] == "invalid"
    assert cause in found[0][0]["message"]
    tasks._alone.append(work.missing[44])
    alone = runner.run(dict(next(tasks)))[0]
    name = "torque_forward" if scene == "load-test" else "push_force_mean"
    assert found[5][0]["summary"][name] == pytest.approx(alone["summary"][name], rel=1e-5)


@pytest.mark.parametrize(
    ("extra", "said"),
    [
        (TORQUE, "most of them followed together"),
        ("", "most of them followed together"),
        (SINGLY, "none followed together: bristles ask for single runs"),
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
    first = min((tmp_path / "s" / "cases").glob("*.h5"))
    assert "followed together" in rps.load(first).findings["together"]
    answer = command(["rerun", str(first), "--out", "again.h5", "--json"])
    assert answer.status == 0
    before, now = answer.json["differing"]["torque_mean"]
    assert before == pytest.approx(now, rel=1e-5)
    assert command(["diff", str(first), "again.h5"]).status == 0
    assert command(["report", str(first), "--out", "page.html"]).status == 0
    page = Path("page.html").read_text()
    assert "Geometry" in page
    assert "followed together" in page
