"""The report in a real browser (conftest.py): no request, no error, readable on a phone, whole in print."""

from pathlib import Path

import pytest
from playwright import sync_api

from made_up_study import HOSTILE, make_study, sampled
from rps_exudyn.report.report import write_report
from rps_exudyn.results.result import Result
from watched_page import watched

PHONE, DESKTOP = {"width": 360, "height": 740}, {"width": 1280, "height": 900}
POINTS = [{"preload": 110.0 + 7 * at, "friction": 0.1 + 0.01 * (at % 3)} for at in range(12)]


@pytest.fixture
def report(made_up_result: Result, tmp_path: Path) -> Path:
    """A page of everything: half a grid with a hostile failure, a sampled study, a single result."""
    grid = make_study(tmp_path / "grid", made_up_result, failed={1: HOSTILE}, pending=[5])
    samples = make_study(tmp_path / "samples", made_up_result, sampled(POINTS))
    made_up_result.save(tmp_path / "result.h5")
    write_report([grid, samples, tmp_path / "result.h5"], tmp_path / "report.html")
    return tmp_path / "report.html"


def test_page_is_quiet_and_fits(browser: sync_api.Browser, report: Path) -> None:
    for viewport in (PHONE, DESKTOP):
        page = browser.new_page(viewport=viewport)
        asked, said = watched(page)
        page.goto(report.as_uri(), wait_until="load")
        assert asked == [report.as_uri()]
        assert said == []
        assert page.evaluate("document.documentElement.scrollWidth") <= viewport["width"]
        assert page.locator("script").count() == 0
        cell = page.get_by_role("cell", name="<script>alert('torque')</script>")
        assert cell.first.is_visible()
        widths = page.locator("figure svg").evaluate_all("all => all.map(one => one.clientWidth)")
        shown = [width for width in widths if width]
        assert len(shown) > 10
        assert min(shown) >= 220
        page.close()


def test_letters_in_pictures_can_be_read_on_a_phone(browser: sync_api.Browser, report: Path) -> None:
    page = browser.new_page(viewport=PHONE)
    page.goto(report.as_uri())
    heights = page.locator("figure svg text").evaluate_all(
        "all => all.map(one => one.getBoundingClientRect().height).filter(height => height > 0)"
    )
    assert len(heights) > 100
    assert min(heights) > 8  # [px]
    page.close()


def test_what_is_folded_is_printed(browser: sync_api.Browser, report: Path) -> None:
    page = browser.new_page(viewport=DESKTOP)
    page.goto(report.as_uri())
    folded = page.locator("details:not([open]) td").first
    assert not folded.is_visible()
    page.emulate_media(media="print")
    assert folded.bounding_box()["height"] > 5
    assert not page.locator("nav").first.is_visible()
    assert page.pdf(format="A4").startswith(b"%PDF")
    page.close()
