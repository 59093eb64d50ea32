"""The report says what was run and what came out, of whatever it is given, and shows it harmlessly."""

import base64
import dataclasses
import hashlib
import json
import re
from collections.abc import Callable
from html.parser import HTMLParser
from importlib.resources import files
from pathlib import Path

import pytest
from matplotlib.figure import Figure

import rps_exudyn as rps
from made_up_study import GRID, HOSTILE, description, grid_points, make_study, sampled
from rps_exudyn.base.screen import silent
from rps_exudyn.gears.geometry_report import geometry_report
from rps_exudyn.pages.report import study_page
from rps_exudyn.pages.report.effects_charts import main_effect_figure
from rps_exudyn.pages.report.pictures import picture
from rps_exudyn.parameters.gear import gear_file
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.page_blocks import Fold, Pictures
from rps_exudyn.results.quantities import GEOMETRY, SUMMARY
from rps_exudyn.results.result import Result
from rps_exudyn.scenes import SCENE_NAMES
from rps_exudyn.study.definition import Axis
from rps_exudyn.study.effects import grid_effect
from rps_exudyn.study.store import Store
from rps_exudyn.study.table import CaseTable
from shell import Command, refusal_of

POINTS = [{"preload": 110.0 + 7 * at, "friction": 0.1 + 0.01 * (at % 3)} for at in range(12)]


class Page(HTMLParser):
    """Text of each section, and every element with its attributes."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.sections: dict[str, str] = {"": ""}
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self._in_heading, self._in_style = False, False
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, dict(attrs)))
        self._in_heading, self._in_style = tag == "h2", tag in ("style", "script")

    def handle_endtag(self, tag: str) -> None:
        self._in_heading = self._in_style = False

    def handle_data(self, data: str) -> None:
        if self._in_heading:
            self.sections[data] = ""
        elif not self._in_style:
            self.sections[list(self.sections)[-1]] += f"{data.strip()} "

    @property
    def tags(self) -> set[str]:
        return {tag for tag, _ in self.elements}


def reported(command: Command, *arguments: str) -> Page:
    """The page that `report` writes."""
    with silent():  # a kernel may be compiled here first
        answer = command(["report", *arguments])
    assert (answer.status, answer.err) == (0, "")
    return Page(Path(answer.out.removeprefix("written: ").strip()))


def test_half_finished_study(made_up_result: Result, tmp_path: Path, command: Command) -> None:
    folder = make_study(tmp_path / "s", made_up_result, failed={1: "the rack left"}, pending=[5])
    damaged = next(path for path in sorted((folder / "cases").glob("*.h5")))
    damaged.write_bytes(b"damaged")
    page = reported(command, "s")
    assert list(page.sections) == [
        "",
        "Main effects and response surfaces",
        "Failed cases",
        "Best and worst cases",
        "Outcome",
        "What was run",
        "All cases",
        "Provenance",
    ]
    assert "mean torque over 3 cases" in page.sections[""]
    assert "2 of 6 cases are still to run" in page.sections[""]
    assert "100 N, 200 N, 400 N" in page.sections["What was run"]
    assert "mesh.friction, yoke.friction" in page.sections["What was run"]
    assert "60 N/mm" in page.sections["What was run"]
    assert "the rack left" in page.sections["Failed cases"]
    assert Status.DIVERGED.remedy in page.sections["Failed cases"]
    assert damaged.name in page.sections["Failed cases"]
    assert "rps-exudyn study made-up.toml" in page.sections["Provenance"]


STOPPED = "yoke.clearance = {} um is closed, first at 0 deg; the yokenut carries up to {} N"


def test_remarks_and_causes_are_counted_and_linked(
    made_up_result: Result, tmp_path: Path, command: Command
) -> None:
    """Messages that differ in numbers only are one; every link leads to a row of the page."""
    make_study(
        tmp_path / "s",
        made_up_result,
        failed={0: "left at 3 s", 1: "left at 0.5 s"},
        remarks={4: STOPPED.format(15, 3.1), 5: STOPPED.format(25, "1e-05")},
    )
    collected = command(["collect", "s"])
    assert "2 cases diverged; for instance: left at 3 s" in collected.out
    assert f"2 cases; for instance: {STOPPED.format(15, 3.1)}" in collected.out
    page = reported(command, "s")
    assert "2 cases of 4 met a limit of the gear" in page.sections["Remarks"]
    assert STOPPED.format(15, 3.1) in page.sections["Remarks"]
    assert STOPPED.format(25, "1e-05") not in page.sections["Remarks"]
    assert "left at 3 s" in page.sections["Failed cases"]
    assert page.sections["All cases"].count("ok, remark") == 2
    ids = {found["id"] for tag, found in page.elements if tag == "tr" and "id" in found}
    links = [found["href"] for tag, found in page.elements if tag == "a"]
    to_rows = {link[1:] for link in links if link and not link.startswith(("#part", "#curve-of"))}
    assert len(to_rows) == 6  # 2 remarks, 2 failures, and best and worst of those that ended ok
    assert to_rows <= ids
    to_curves = {link[1:] for link in links if link and link.startswith("#curve-of")}
    groups = [found for tag, found in page.elements if tag == "g" and "data-curve" in found]
    curves = {found["id"] for found in groups if "id" in found}
    assert to_curves == curves
    assert len(curves) == 4  # cases that ended ok


def test_charts_do_not_join_both_sides_of_a_limit(made_up_result: Result, tmp_path: Path) -> None:
    """Contours and lines where all cases are on one side; none where a level has cases on both."""
    everywhere = {at: STOPPED.format(15, 3) for at in range(6)}
    lines, diamonds = {}, {}
    for name, remarks in (("none", {}), ("all", everywhere), ("some", {0: everywhere[0], 3: everywhere[3]})):
        described = description(grid_points(), name=name)
        table = CaseTable.of(
            Store.open(make_study(tmp_path / name, made_up_result, described, remarks=remarks))
        )
        effect = grid_effect(table.axes, "preload", table.numbers["torque_mean"], table.limited)
        (axes,) = main_effect_figure(GRID[0], effect, "torque_mean", SUMMARY["torque_mean"]).axes
        lines[name] = [line for line in axes.lines if line.get_linestyle() == "-"]
        diamonds[name] = sum(line.get_xdata().size for line in axes.lines if line.get_marker() == "D")
    assert {name: len(found) for name, found in lines.items()} == {"none": 2, "all": 2, "some": 0}
    assert diamonds == {"none": 0, "all": 6, "some": 2}


@pytest.mark.parametrize("count", [1, 3])
def test_charts_of_a_study_have_names_in_words_one_scale_and_the_width_of_the_page(
    count: int, made_up_result: Result, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    figures: list[Figure] = []
    monkeypatch.setattr(study_page, "picture", lambda *given: figures.append(given[0]) or picture(*given))
    values = {
        "yoke.preload": (100.0, 200.0, 400.0),
        "mesh.friction": (0.1, 0.2),
        "pinion.runout": (0.0, 1e-5),
    }
    axes = tuple(
        Axis(path, (path,), "", each if at < count else each[:1], "grid")
        for at, (path, each) in enumerate(values.items())
    )
    folder = make_study(tmp_path / "s", made_up_result, description(grid_points(axes), axes=axes))
    (section,) = (
        each
        for each in study_page.study_page(Store.open(folder)).sections
        if each.title.startswith("Main effects")
    )
    fold = next(each for each in section.blocks if isinstance(each, Fold))
    (drawn,) = (each.pictures for each in fold.blocks if isinstance(each, Pictures))
    assert drawn[0].caption == "mean torque over yoke preload"
    assert [each.place for each in drawn] == (["wide-only", "narrow"] if count == 1 else 6 * [""])
    assert not any("yoke.preload" in each.svg for each in drawn)
    scales = {tuple(figure.axes[1].get_ylim()) for figure in figures[3 : 2 * count]}
    assert len(scales) == (count > 1)


def test_effects_below_the_error_bars_are_named(
    made_up_result: Result, tmp_path: Path, command: Command
) -> None:
    """The means differ by 0.23 N m over friction, by 0.45 N m over preload."""
    errors = {"torque_mean": 0.3}
    make_study(tmp_path / "s", dataclasses.replace(made_up_result, errors=errors))
    effects = reported(command, "s", "--out", "r.html").sections["Main effects and response surfaces"]
    assert "error bars (median ± 0.30 N m) are larger than the main effect of friction." in effects


@pytest.mark.usefixtures("study")
def test_best_and_worst_cases_are_listed(command: Command) -> None:
    section = reported(command, "s", "--out", "r.html").sections["Best and worst cases"]
    assert re.search(r"lowest \(best\)\s+0\.100 ± 0\.001 N m\s+100 N\s+0\.1 ", section)
    assert re.search(r"highest \(worst\)\s+0\.800 ± 0\.001 N m\s+400 N\s+0\.2 ", section)


@pytest.mark.parametrize("kept", ["nothing", "one case"])
def test_study_of_few_finished_cases(
    kept: str, made_up_result: Result, tmp_path: Path, command: Command
) -> None:
    make_study(tmp_path / "s", made_up_result, pending=range(kept == "one case", 6))
    outcome = reported(command, "s").sections["Outcome"]
    assert ("No case has ended ok yet." in outcome) == (kept == "nothing")


def test_sampled_study_shows_its_distribution(
    made_up_result: Result, tmp_path: Path, command: Command
) -> None:
    make_study(tmp_path / "s", made_up_result, sampled(POINTS))
    command(["report", "s"])
    assert "mean torque: distribution" in (tmp_path / "s" / "report.html").read_text(encoding="utf-8")


def test_words_as_an_axis(made_up_result: Result, tmp_path: Path, command: Command) -> None:
    law = dataclasses.replace(GRID[1], name="law", paths=("mesh.law",), values=("teeth", "line"))
    points = [{"law": word, "preload": 100.0, "friction": 0.1} for word in ("teeth", "line")]
    axes = (law, *(dataclasses.replace(axis, values=(0.1 if axis is GRID[1] else 100.0,)) for axis in GRID))
    study = description(points, axes=axes)
    make_study(tmp_path / "s", made_up_result, study)
    page = reported(command, "s")
    assert re.search(r"law\s+mesh\.law\s+teeth, line", page.sections["What was run"])
    assert re.search(r"teeth\s+100 N\s+0\.1\s+ok", page.sections["All cases"])


def test_nothing_of_a_file_becomes_markup(made_up_result: Result, tmp_path: Path, command: Command) -> None:
    axes = tuple(dataclasses.replace(axis, name=f"{axis.name}{HOSTILE}$x_") for axis in GRID)
    study = description(grid_points(axes), axes=axes, name=HOSTILE, title=HOSTILE)
    study = dataclasses.replace(study, provenance={HOSTILE: HOSTILE, "command": HOSTILE})
    folder = make_study(tmp_path / "s", made_up_result, study, failed={0: HOSTILE})
    (folder / "study.toml").write_text(f"# {HOSTILE}", encoding="utf-8")
    dataclasses.replace(
        made_up_result, status=Status.CRASHED, message=HOSTILE, solver={HOSTILE: HOSTILE}
    ).save(tmp_path / "r.h5")
    page = reported(command, "s", "r.h5")
    assert page.tags.isdisjoint({"iframe", "object", "form"})
    assert [tag for tag, _ in page.elements].count("script") == 1  # the page's own, told by its hash
    text = (tmp_path / "report.html").read_text(encoding="utf-8")
    script = (files("rps_exudyn") / "pages" / "report" / "page.js").read_text(encoding="utf-8")
    assert f"<script>{script}</script>" in text
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    policy = re.search(r'content="([^"]*script-src[^"]*)"', text)[1]
    allowed = policy.split("script-src ")[1].split(";")[0].split()
    assert f"'sha256-{digest}'" in allowed
    assert all(each.startswith("'sha256-") for each in allowed)
    assert not any(name.startswith("on") for _, attributes in page.elements for name in attributes)
    assert "<script>alert('torque')</script>" in page.sections["Failed cases"]


def test_page_asks_for_nothing(made_up_result: Result, tmp_path: Path, command: Command) -> None:
    made_up_result.save(tmp_path / "r.h5")
    louder = {**made_up_result.signals, "pinion_torque": 2 * made_up_result["pinion_torque"]}
    dataclasses.replace(made_up_result, signals=louder).save(tmp_path / "other.h5")
    make_study(tmp_path / "s", made_up_result)
    command(["report", "r.h5", "other.h5", "s", "--out", "r.html"])
    text = (tmp_path / "r.html").read_text(encoding="utf-8")
    page = Page(tmp_path / "r.html")
    for _, attributes in page.elements:
        links = [attributes.get(name) or "" for name in ("src", "href", "xlink:href", "srcset", "data")]
        assert all(
            link.startswith(("#", "data:image/webp;base64,")) or link in ("", "data:,") for link in links
        )
    assert set(re.findall(r"url\((.)", text)) <= {"#"}
    assert "@import" not in text
    ids = [attributes["id"] for _, attributes in page.elements if "id" in attributes]
    assert len(ids) == len(set(ids))


EVERY_DAY = ("free-pinion-torque", "reversal", "rattle")
"""Scenes of which pages are made every day; pictures of all are in test_scene_pictures.py."""


@pytest.mark.parametrize(
    "scene",
    [
        *EVERY_DAY,
        *(pytest.param(name, marks=pytest.mark.long) for name in SCENE_NAMES if name not in EVERY_DAY),
        "a scene of tomorrow",
    ],
)
def test_result_of_any_scene(scene: str, made_up_result: Result, tmp_path: Path, command: Command) -> None:
    """Also of one that did not keep all signals of the scene's own picture."""
    result = dataclasses.replace(
        made_up_result, scene=scene, gear=made_up_result.gear.replace({"yoke.preload": 310})
    )
    result.save(tmp_path / "r.h5")
    page = reported(command, "r.h5")
    assert re.search(r"torque_mean\s+0\.600 ± 0\.001 N m", page.sections["Details"])
    assert re.search(r"yoke\.preload\s+310 N", page.sections["Details"])


def test_failed_result_says_so(failed_result: Result, tmp_path: Path, command: Command) -> None:
    failed_result.save(tmp_path / "r.h5")
    outcome = reported(command, "r.h5").sections["Outcome"]
    assert "NaN at t = 0.1 s." in outcome
    assert Status.DIVERGED.remedy in outcome


def _sheet(text: str) -> dict[str, object]:
    judgement = {
        "mark": "kept", "name": text, "note": text, "value": text, "interval": text, "verdict": text,
        "remark": text, "at": 3.0, "band": [1.0, 2.0], "limits": [1.0], "beyond": [[0.0, 1.0]],
    }  # fmt: skip
    blocks = [
        {"kind": "text", "text": text},
        {"kind": "pictures", "pictures": [{"svg": text, "caption": text, "width": 5.0, "axes": text}]},
        {"kind": "judged", "heads": [text] * 4, "rows": [judgement]},
        {"kind": "fold", "title": text, "blocks": [{"kind": "grid", "columns": [text], "rows": [[text]]}]},
    ]
    rows = [{"value": text, "words": text}]
    return {"title": text, "lead": text, "rows": rows, "gear": None,
            "sections": [{"title": text, "blocks": blocks}]}  # fmt: skip


def test_nothing_of_a_sheet_file_becomes_markup(tmp_path: Path, command: Command) -> None:
    (tmp_path / "s.json").write_text(json.dumps({"sheet": _sheet(HOSTILE)}))
    page = reported(command, "s.json")
    images = [dict(attributes)["src"] for tag, attributes in page.elements if tag == "img"]
    assert [each.partition(",")[0] for each in images] == ["data:image/svg+xml;base64"]  # runs no scripts
    assert len([tag for tag, _ in page.elements if tag == "script"]) == 1
    assert page.sections[HOSTILE].count(HOSTILE) >= 8


@pytest.mark.parametrize(
    "damage",
    [
        lambda sheet: sheet.pop("title"),
        lambda sheet: sheet.update(rows=[{"value": 3}]),
        lambda sheet: sheet.update(
            sections=[{"title": "x", "blocks": [{"kind": "pictures", "pictures": [{"svg": 3}]}]}]
        ),
        lambda sheet: sheet["sections"][0]["blocks"][1]["pictures"][0].update(place='" onload="'),
        lambda sheet: sheet["sections"][0]["blocks"][1]["pictures"][0].update(width=float("nan")),
        lambda sheet: sheet["sections"][0]["blocks"][2]["rows"][0].update(at="<b>"),
        lambda sheet: sheet["sections"][0]["blocks"][2]["rows"][0].update(mark="x onload"),
    ],
)
def test_json_that_is_no_sheet_is_refused(
    damage: Callable[[dict[str, object]], object], tmp_path: Path, command: Command
) -> None:
    sheet = _sheet("x")
    damage(sheet)
    (tmp_path / "s.json").write_text(json.dumps({"sheet": sheet}))
    assert "s.json holds no sheet" in refusal_of(command(["report", "s.json"]))


def test_gear_file_has_a_sheet(tmp_path: Path, command: Command) -> None:
    gear = rps.SteeringGear().replace({"pinion.teeth": 8})
    (tmp_path / "fitted.toml").write_text(gear_file(gear), encoding="utf-8")
    page = reported(command, "fitted.toml")
    assert Path("fitted.html").exists()
    every = " ".join(page.sections.values())
    assert "8 teeth" in every
    assert GEOMETRY["tip_diameter"].show(geometry_report(gear).tip_diameter) in every
    assert "img" in page.tags


@pytest.mark.usefixtures("study")
def test_description_of_a_study_stands_for_its_folder(command: Command) -> None:
    assert command(["report", "s/study.json"]).out == "written: s/report.html\n"


def test_several_results_stand_side_by_side(made_up_result: Result, tmp_path: Path, command: Command) -> None:
    made_up_result.save(tmp_path / "a.h5")
    other = dataclasses.replace(
        made_up_result,
        gear=made_up_result.gear.replace({"yoke.preload": 310}),
        summary={"torque_mean": 0.7},
        errors={"torque_mean": float("nan")},
    )
    other.save(tmp_path / "b.h5")
    numbers = reported(command, "a.h5", "b.h5").sections["Numbers"]
    assert re.search(r"torque_mean\s+0\.600 ± 0\.001 N m\s+0\.70 ± \? N m", numbers)
    assert re.search(r"yoke\.preload\s+300 N\s+310 N", numbers)


@pytest.mark.usefixtures("study")
def test_same_study_gives_the_same_page(tmp_path: Path, command: Command) -> None:
    command(["report", "s", "--out", "a.html"])
    command(["report", "s", "--out", "b.html"])
    assert (tmp_path / "a.html").read_bytes() == (tmp_path / "b.html").read_bytes()


def test_two_folders_of_one_study_share_no_place(
    made_up_result: Result, tmp_path: Path, command: Command
) -> None:
    """A link would lead to the first of two elements with one id."""
    make_study(tmp_path / "s", made_up_result)
    make_study(tmp_path / "again" / "s", made_up_result)
    elements = reported(command, "s", "again/s", "--out", "both.html").elements
    rows = [found["id"] for tag, found in elements if tag == "tr" and "id" in found]
    assert len(rows) == len(set(rows)) == 12  # six cases each


def test_result_without_signals(made_up_result: Result, tmp_path: Path, command: Command) -> None:
    dataclasses.replace(made_up_result, signals={}).save(tmp_path / "r.h5")
    assert "No signals were kept." in reported(command, "r.h5").sections["Curves"]
