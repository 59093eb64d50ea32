"""Verdicts on rows of validation: ASME V&V 20's rule, and the rows that must agree."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rps_exudyn.assessment.validation.compared_rows import (
    Simulated,
    compare_rows,
    compared_row,
    predictions,
    verdict,
    verdict_on_limit,
)
from rps_exudyn.assessment.validation.row import SHIPPED, read_rows
from rps_exudyn.inference.uncertainty.input_sets import uncertain_inputs
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.judged_row import Verdict
from shell import Command

ROWS = {row.name: row for row in read_rows(SHIPPED)}


@pytest.mark.parametrize(
    ("error", "uncertainty", "allowed", "expected"),
    [
        (0.01, 0.01, 0.05, Verdict.AGREES),
        (-0.04, 0.02, 0.05, Verdict.AGREES),
        (0.01, 0.03, 0.05, Verdict.NOISE),  # 2 u is beyond the criterion: it could not tell
        (0.04, 0.03, 0.05, Verdict.WEAK),
        (0.2, 0.15, 0.05, Verdict.WEAK),
        (0.2, 0.3, 0.05, Verdict.NOISE),
        (-0.2, 0.05, 0.05, Verdict.DISAGREES),
        (0.04, 0.0, 0.05, Verdict.AGREES),
        (0.06, 0.0, 0.05, Verdict.DISAGREES),
        (float("nan"), 0.1, 0.05, Verdict.NOT_COMPARABLE),
    ],
)
def test_verdict(error: float, uncertainty: float, allowed: float, expected: Verdict) -> None:
    assert verdict(error, uncertainty, allowed) is expected


@pytest.mark.parametrize("side", [1, -1])
def test_limits_are_judged_by_the_share_of_gears_that_keep_them(side: int) -> None:
    """A limit that is kept is no agreement; one that every gear keeps by far judges nothing."""
    near, far = 0.8**side, 0.4**side
    for kept, ratio, expected in (
        ((1.0, 1.0), near, Verdict.WEAK),
        ((1.0, 1.0), far, Verdict.KEPT_BY_ANY),
        ((0.96, 0.96), far, Verdict.WEAK),
        ((0.5, 0.5), near, Verdict.NOISE),
        ((0.04, 0.04), 1.2**side, Verdict.DISAGREES),
        ((0.7, 1.0), far, Verdict.NOISE),  # failed samples decide
        ((0.0, 0.3), 1.2**side, Verdict.NOISE),
        ((0.0, 0.0), float("nan"), Verdict.NOT_COMPARABLE),
    ):
        assert verdict_on_limit(kept, ratio, side) is expected
    found = Simulated(1.0, 0.0, 0.1, 0.8, 1.2, drawn=(0.8, 0.9, 1.0, 1.2))
    assert found.keeping(1, 0.95) == (0.5, 0.5)
    assert found.keeping(-1, 0.85) == (0.75, 0.75)
    assert replace(found, drawn=(0.8, float("nan"), 1.0, 1.2)).keeping(1, 0.95) == (0.25, 0.5)
    assert Simulated(1.0, 0.0, 0.0, 1.0, 1.0).keeping(1, 0.9) == (0.0, 0.0)


def test_a_number_held_against_many_manuals_is_one_prediction() -> None:
    """It counts by its worst row; calibrated rows, limits that any gear keeps and gears with seals do not."""
    one = _simulated(0.0, 0.1)
    rows = [ROWS[name] for name in ("tacoma-rotation", "suzuki-rotation", "accent-rotation")]
    wrong = replace(rows[0], data=replace(rows[0].data, value=2.0, uncertainty=0.01))
    centring = replace(ROWS["note-on-centre"], calibrates="it centres an input")
    others = [centring, ROWS["celica-rotation"], ROWS["legacy-rotation"]]
    compared = [compared_row(row, one) for row in (*rows, wrong, *others)]
    (group,) = predictions(compared)
    assert sorted(each.name for each in group) == sorted([wrong.name, *(row.name for row in rows)])
    assert group[0].verdict is Verdict.DISAGREES
    assert all(each.verdict is not Verdict.DISAGREES for each in group[1:])
    assert [each.verdict for each in compared[4:]] == [
        Verdict.CALIBRATED,
        Verdict.NOT_COMPARABLE,
        Verdict.NOT_COMPARABLE,
    ]
    assert len(predictions([*compared, compared_row(rows[0], replace(one, value=1.5))])) == 2


def test_the_set_unknown_has_its_preload_from_a_spring() -> None:
    """From its force a turn of the plug before the inspection length to half more than when solid; no row
    centres it."""
    force, rate, length, pitch, wire, coils = 196.0, 59.4e3, 16.3e-3, 1.3e-3, 2.9e-3, 4.4
    preload = uncertain_inputs(SteeringGear(), "unknown", {})["yoke.preload"]
    least, most = preload.ends
    assert least == pytest.approx(force - rate * pitch, rel=0.02)
    assert most == pytest.approx(1.5 * (force + rate * (length - coils * wire)), rel=0.05)
    assert not any(row.calibrates for row in ROWS.values())


def test_no_row_of_a_gear_with_seals_is_counted() -> None:
    """Whether it fits or not: torques and forces of gears with hydraulic assistance."""
    forces = {"torque_mean", "torque_on_centre", "torque_off_centre_max", "push_force_mean"}
    for row in ROWS.values():
        seals = "ydraulic assistance" in row.note + row.not_comparable
        assert not (seals and row.data.quantity in forces and not row.not_comparable), row.name


def test_uncertainty_is_the_root_of_the_sum_of_squares() -> None:
    """And a manual's range counts as even over its width: 0.4 / sqrt(12)."""
    row = ROWS["attrage-rotation"]
    assert row.data.uncertainty == pytest.approx(0.7 / 12**0.5)
    made = compared_row(replace(row, data=replace(row.data, uncertainty=6.0)), _simulated(2.0, 3.0))
    assert made.uncertainty == pytest.approx(7.0)
    assert made.error == pytest.approx(1.0 - 0.95)


def _simulated(u_num: float, u_input: float) -> Simulated:
    return Simulated(1.0, u_num, u_input, 0.9, 1.1)


def test_there_are_rows_of_every_kind_with_their_sources() -> None:
    assert len(ROWS) >= 20
    counts = {kind: sum(row.kind == kind for row in ROWS.values()) for kind in ("validation", "verification")}
    assert counts["validation"] >= 20
    assert counts["verification"] >= 8
    assert any("contradict" in row.note for row in ROWS.values())
    assert any(row.not_comparable for row in ROWS.values())


def test_rows_of_verification_agree() -> None:
    """Closed forms and standards' examples, each within the criterion that its folder states."""
    rows = [row for row in ROWS.values() if row.kind == "verification"]
    assert {each.row.name: each.verdict for each in compare_rows(rows)} == {
        row.name: Verdict.AGREES for row in rows
    }


def test_wrong_data_disagree() -> None:
    """The same rows with data 10 % off."""
    rows = [
        replace(row, data=replace(row.data, value=1.1 * row.data.value))
        for name, row in ROWS.items()
        if name in ("undercut-limit", "iso-single-stiffness", "bush-stiffness")
    ]
    assert {each.verdict for each in compare_rows(rows)} == {Verdict.DISAGREES}


def test_equal_procedures_run_once_and_rows_share_their_band(tmp_path: Path) -> None:
    """Two rows of one scene: the second has the first one's median; a failed run is not comparable."""
    told: list[tuple[int, int]] = []
    head = 'kind = "validation"\nsource = "made up"\ntitle = '
    end = (
        '[procedure]\nscene = "free-pinion-torque"\nfidelity = "closed-form"\n[criterion]\nagreement = 0.05\n'
    )
    band = end.replace(
        "[criterion]", 'inputs = "own"\nset = { "yoke.preload" = "300 N +- 10 %" }\n[criterion]'
    )
    failing = end.replace("[criterion]", 'set = { "pinion.runout" = "90 um" }\n[criterion]')
    data = '[data]\nquantity = "torque_mean"\n'
    texts = {
        "a": f'{head}"a"\n{data}low = "0.5 N*m"\nhigh = "0.7 N*m"\n{band}',
        "b": f'{head}"b"\n{data}most = "1.5 N*m"\n{band}',
        "c": f'{head}"c"\n{data}most = "1.5 N*m"\n{failing}',
    }
    for name, text in texts.items():
        (tmp_path / name).mkdir()
        (tmp_path / name / "row.toml").write_text(text)
    first, second, third = compare_rows(read_rows(tmp_path), lambda *done: told.append(done))
    assert told == [(1, 2), (2, 2)]
    assert (first.value, first.low, first.high) == (second.value, second.low, second.high)
    assert first.u_input == pytest.approx(0.1 * 0.45, rel=0.2)  # of the share of the preload
    assert second.verdict is Verdict.KEPT_BY_ANY  # at 41 % of the limit
    assert third.verdict is Verdict.NOT_COMPARABLE
    assert "yokenut" in third.remark
    assert np.isnan(third.error)


def test_command_writes_page_data_and_picture(command: Command) -> None:
    only = ("undercut-limit", "paper-point-contact", "paper-rack-gain")
    answer = command(["validate", *(word for name in only for word in ("--only", name)), "--json"])
    assert answer.status == 0
    rows = {row["name"]: row for row in answer.json["rows"]}
    assert rows["undercut-limit"]["verdict"] == "agrees"
    assert rows["paper-point-contact"]["S"] is None
    kept = json.loads(Path("validation.json").read_text())
    assert len(kept["rows"]) == 3
    page = Path("validation.html").read_text()
    assert "Least profile shift without undercut" in page
    assert "not comparable" in page
    assert Path("validation.png").stat().st_size > 5_000
