"""The report in a real browser (conftest.py): no request, no error, readable on a phone, whole in print."""

import re
from pathlib import Path

import numpy as np
import pytest
from playwright import sync_api

from made_up_study import HOSTILE, make_study, sampled
from page_faults import page_faults
from rps_exudyn.pages.report.write_report import write_report
from rps_exudyn.results.result import Result
from watched_page import watched

PHONE, DESKTOP = {"width": 390, "height": 844}, {"width": 1400, "height": 900}
TABLET = {"width": 768, "height": 1000}
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
    for viewport in (PHONE, TABLET, DESKTOP):
        page = browser.new_page(viewport=viewport)
        asked, said = watched(page)
        page.goto(report.as_uri(), wait_until="load")
        assert asked == [report.as_uri()]
        assert said == []
        assert page.evaluate("document.documentElement.scrollWidth") <= viewport["width"]
        assert page_faults(page) == []
        assert page.locator("script").count() == 1  # no part of a message
        cell = page.get_by_role("cell", name="<script>alert('torque')</script>")
        assert cell.first.is_visible()
        widths = page.locator("figure svg").evaluate_all("all => all.map(one => one.clientWidth)")
        shown = [width for width in widths if width]
        assert len(shown) > 5
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


def told(figure: sync_api.Locator) -> dict[str, float]:
    """What the line below a chart says: name -> value."""
    parts = figure.locator("output").inner_text().replace("−", "-").split(" · ")
    found = [re.fullmatch(r"(.+?) (-?[\d.]+)(?: / .+)? ?(\D*)", part) for part in parts]
    return {each[1]: float(each[2]) for each in found if each}


@pytest.mark.parametrize("viewport", [PHONE, DESKTOP])
def test_chart_tells_values_of_its_curves(
    browser: sync_api.Browser, report: Path, made_up_result: Result, viewport: sync_api.ViewportSize
) -> None:
    """By pointer and by keys, to a thousandth of the axes; the dot lies on the curve."""
    page = browser.new_page(viewport=viewport)
    page.goto(report.as_uri())
    figure = page.locator("article").last.locator("figure[data-axes]:visible").first
    svg = figure.locator("svg")
    svg.scroll_into_view_if_needed()
    box = svg.bounding_box()
    page.mouse.move(box["x"] + 0.6 * box["width"], box["y"] + 0.3 * box["height"])
    pointed = told(figure)
    svg.focus()
    page.keyboard.press("ArrowRight")
    stepped = told(figure)
    assert stepped["pinion angle"] == pytest.approx(pointed["pinion angle"] + 360 / 200, abs=0.2)
    for seen in (pointed, stepped):
        angle = np.radians(seen["pinion angle"])
        expected = np.interp(angle, made_up_result["pinion_angle"], made_up_result["pinion_torque"])
        assert seen["pinion torque"] == pytest.approx(expected, abs=2e-4)  # 0.05 N m high: two thousandths
    page.keyboard.press("End")
    assert told(figure)["pinion angle"] == pytest.approx(360, abs=0.1)
    assert svg.get_attribute("aria-valuetext").startswith("pinion angle 360")
    assert figure.locator(".dot").count() == 1
    page.close()


def test_case_leads_to_its_curve_and_back(browser: sync_api.Browser, report: Path) -> None:
    page = browser.new_page(viewport=DESKTOP)
    page.goto(report.as_uri())
    page.evaluate("for (const one of document.querySelectorAll('details')) one.open = true")
    row = page.locator("tr[id]").first
    row.locator("a").last.click()
    name = page.url.split("#")[1]
    curve = page.locator(f"[id='{name}'] path")
    assert curve.evaluate("one => getComputedStyle(one).strokeWidth") == "3px"
    figure = page.locator("figure", has=page.locator(f"[id='{name}']"))
    figure.locator("svg").focus()
    page.keyboard.press("Home")
    figure.locator("output a").first.click()
    assert page.locator("tr:target").count() == 1
    page.close()


def test_gear_turns_in_three_dimensions_on_a_click(browser: sync_api.Browser, report: Path) -> None:
    """Without a request, with the script that the page's own policy names, and below 500 kB."""
    page = browser.new_page(viewport=DESKTOP)
    asked, said = watched(page)
    page.goto(report.as_uri())
    gear = page.locator(".gear").last
    assert gear.locator("img").evaluate("one => one.naturalWidth") > 600
    texts = gear.locator(".label").all_inner_texts()
    assert [text.split()[0] for text in texts] == ["yoke", "teeth", "bearings", "bush", "torque"]
    gear.get_by_role("button").click()
    inner = page.frame_locator("iframe")
    inner.locator("#reading").filter(has_text="pinion at").wait_for()
    assert not inner.locator("body.still").count()
    assert len(asked) == 1
    assert [text for text in said if "GL Driver Message" not in text] == []
    page.close()


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_texts_stand_out_from_the_page(browser: sync_api.Browser, report: Path, scheme: str) -> None:
    """WCAG's contrast of at least 4.5 for texts of the sheet, in both colour schemes."""
    page = browser.new_page(viewport=DESKTOP, color_scheme=scheme)
    page.goto(report.as_uri())
    contrasts = page.evaluate(
        r"""() => {
          const light = (text) => {
            const [r, g, b] = text.match(/[\d.]+/g).map((one) => one / 255).map(
              (one) => one <= 0.04045 ? one / 12.92 : ((one + 0.055) / 1.055) ** 2.4);
            return 0.2126 * r + 0.7152 * g + 0.0722 * b;
          };
          const ground = light(getComputedStyle(document.body).backgroundColor);
          const texts = document.querySelectorAll("h1, h2, p.lead, dt, dd, .label, .label b, small, summary");
          return [...texts].map((one) => {
            const ink = light(getComputedStyle(one).color);
            return (Math.max(ink, ground) + 0.05) / (Math.min(ink, ground) + 0.05);
          });
        }"""
    )
    assert min(contrasts) > 4.5
    page.close()
