"""The page that plays a result, in a real browser: quiet, on a phone, by keyboard; its poses are Python's."""

from pathlib import Path

import numpy as np
import pytest
from playwright import sync_api

import rps_exudyn as rps
from page_faults import page_faults
from rps_exudyn.pages.animation.animation_page import write_page
from rps_exudyn.pages.animation.motion import Factors, Motion
from rps_exudyn.results.result import Result
from watched_page import watched

PHONE, DESKTOP = {"width": 390, "height": 800}, {"width": 1280, "height": 900}
DRIVER = "GL Driver Message"  # what software rendering says of its own speed


def until(page: sync_api.Page, condition: str) -> None:
    """Wait for a condition in JavaScript; playwright's own way is refused by the page's policy."""
    for _ in range(200):
        if page.evaluate(condition):
            return
        page.wait_for_timeout(50)
    pytest.fail(f"never: {condition}")


@pytest.fixture(scope="module")
def pitch() -> Result:
    return rps.run("free-pinion-torque", fidelity="quasi-static", turns=1 / 6)


@pytest.fixture(scope="module")
def address(pitch: Result, tmp_path_factory: pytest.TempPathFactory) -> str:
    path: Path = tmp_path_factory.mktemp("page") / "r.html"
    write_page(pitch, path)
    return path.as_uri()


def test_page_is_quiet_and_fits(browser: sync_api.Browser, address: str) -> None:
    for viewport in (PHONE, DESKTOP):
        page = browser.new_page(viewport=viewport)
        asked, said = watched(page)
        page.goto(address)
        until(page, "document.getElementById('reading').textContent.length > 5")
        page.get_by_text("What this shows").click()
        assert asked == [address]
        assert [text for text in said if DRIVER not in text] == []
        assert page.evaluate("document.documentElement.scrollWidth") <= viewport["width"]
        assert page_faults(page) == []
        page.close()


def test_poses_are_those_of_python(browser: sync_api.Browser, address: str, pitch: Result) -> None:
    """To single precision, in which the page has the signals: 1e-7 of a rack displacement of some 10 mm."""
    motion, page = Motion.of(pitch), browser.new_page()
    page.goto(address)
    for factors in (Factors(), Factors(300, 30)):
        shown = page.evaluate(f"poses(7, [{factors.displacement}, {factors.tilt}])")
        poses = motion.poses(7, factors)
        assert set(poses) - set(shown) == {"bearings"}  # rings of the sheet's picture
        for name, (turn, origin) in poses.items():
            if name == "bearings":
                continue
            np.testing.assert_allclose(np.reshape(shown[name][0], (3, 3)), turn, atol=3e-7)
            np.testing.assert_allclose(shown[name][1], origin, atol=1e-8)
    page.close()


def test_page_is_played_by_keyboard_and_pointer(
    browser: sync_api.Browser, address: str, pitch: Result
) -> None:
    page = browser.new_page(viewport=DESKTOP)
    page.goto(address)
    slider = page.get_by_label("instant of the record")
    slider.focus()
    page.keyboard.press("End")
    until(page, "document.getElementById('instant').value == document.getElementById('instant').max")
    until(page, "document.getElementById('instant').getAttribute('aria-valuetext').includes('60°')")
    torque = f"{pitch['pinion_torque'][-1]:.4g}"
    assert torque in (slider.get_attribute("aria-valuetext") or "")
    page.locator("#view").focus()
    before = page.evaluate("state.camera.azimuth")
    page.keyboard.press("ArrowRight")
    assert page.evaluate("state.camera.azimuth") == pytest.approx(before + 0.08)
    page.keyboard.press(" ")
    assert page.get_by_role("button", name="pause").is_visible()
    page.keyboard.press(" ")
    page.locator("#curve svg").scroll_into_view_if_needed()
    box = page.locator("#curve svg").bounding_box()
    assert box is not None
    page.mouse.click(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    until(page, "Math.abs(state.frame / (DATA.frames - 1) - 0.5) < 0.08")
    page.close()


def test_bodies_are_drawn_and_taken_apart(browser: sync_api.Browser, address: str) -> None:
    """Pixels differ between the whole gear, one without forces, and one taken apart."""
    page = browser.new_page(viewport=DESKTOP)
    page.goto(address)
    until(page, "document.getElementById('reading').textContent.length > 5")
    canvas, pictures = page.locator("#view"), []
    for change in ("null", "document.getElementById('forces').click()", "state.explode = 1, refresh()"):
        page.evaluate(change)
        page.wait_for_timeout(200)
        pictures.append(canvas.screenshot())
    assert len(set(pictures)) == 3
    assert min(map(len, pictures)) > 20_000  # no plain background
    page.close()


def test_without_webgl_a_still_is_shown(browser: sync_api.Browser, address: str) -> None:
    page = browser.new_page()
    page.add_init_script("HTMLCanvasElement.prototype.getContext = () => null")
    page.goto(address)
    picture = page.get_by_alt_text("The gear; this browser has no WebGL")
    assert picture.evaluate("image => image.naturalWidth") == 640
    page.get_by_label("instant of the record").fill("3")
    until(page, "document.getElementById('reading').textContent.includes('pinion at')")
    assert page.evaluate("state.frame") == 3
    chosen = page.locator("#factors option:checked").text_content()
    assert page.locator("#magnified").text_content() == f"deflections: {chosen}"
    page.locator("#factors").select_option("0")
    until(page, "document.getElementById('magnified').textContent === ''")
    page.close()
