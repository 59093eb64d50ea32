"""The page to explore: every state of its sliders has an answer, and nobody else gets one."""

import base64
import http.client
import json
import re
import socket
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import partial
from pathlib import Path
from threading import Thread
from time import monotonic, sleep
from typing import Any

import numpy as np
import pytest
from playwright import sync_api

import rps_exudyn as rps
from measured_binary_files import READABLE as BINARY
from measured_files import READABLE
from page_faults import page_faults
from rps_exudyn.assessment.requirements.window_page import window_page, window_sheet
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.pages.explore import sliders as answers
from rps_exudyn.pages.explore.answering import CANCELLED, LONGEST, TOO_LONG, Answering
from rps_exudyn.pages.explore.on_request import KINDS, NO_LIMIT, on_request
from rps_exudyn.pages.explore.server import Explorer
from rps_exudyn.pages.explore.sliders import (
    MOST_POINTS,
    SLIDERS,
    Answer,
    Slider,
    Wish,
    answer,
    scenes,
    settings_of,
    thinned,
)
from rps_exudyn.pages.explore.typed_limits import limits_of
from rps_exudyn.results.quantities import SIGNALS
from rps_exudyn.scenes import scene_named
from rps_exudyn.simulate.cases.task import Task
from watched_page import watched

GEAR = rps.SteeringGear()
JSON = {"Content-Type": "application/json"}
SLOW = {"yoke.preload": 999}
CROWD = 200
PATIENCE = 300.0  # [s] with a busy machine


class Slow(Answering):
    """Answers of which one takes much longer than allowed."""

    def task(self, wish: Wish) -> Task:
        endless = partial(eval, "__import__('time').sleep(600)")
        return Task(endless) if wish.state == SLOW else super().task(wish)


@pytest.fixture(scope="module")
def server() -> Iterator[Explorer]:
    with Explorer(GEAR) as started:
        started.answering = Slow(GEAR, window_sheet)
        started.answering.warm_up()
        Thread(target=started.serve_forever, kwargs={"poll_interval": 0.05}, daemon=True).start()
        yield started
        started.shutdown()


def asked(server: Explorer, method: str, path: str, body: Any = None, **headers: str) -> tuple[int, bytes]:
    link = http.client.HTTPConnection("127.0.0.1", server.server_address[1], timeout=PATIENCE)
    content = body if isinstance(body, str | None) else json.dumps(body)
    link.request(method, path, content, {**(JSON if body is not None else {}), **headers})
    reply = link.getresponse()
    found = reply.status, reply.read()
    link.close()
    return found


def posted(server: Explorer, path: str, content: Any) -> Any:
    """What the page gets."""
    status, answered = asked(server, "POST", path, content)
    assert status == 200
    return json.loads(answered)


def test_curve_is_that_of_the_command(server: Explorer) -> None:
    found = posted(server, "/curve", {"state": {"yoke.preload": 400}, "number": 1})
    result = rps.run("free-pinion-torque", GEAR.replace({"yoke.preload": 400}), fidelity="quasi-static")
    (curve,) = found["curves"]
    np.testing.assert_allclose(curve["y"], result["pinion_torque"], atol=1e-6)  # as it is rounded
    assert sum(share for _, _, share in found["losses"]) == pytest.approx(100, abs=0.1)


def test_what_follows_from_a_slider_follows(server: Explorer) -> None:
    """Teeth alone: the tip diameter goes with them, and the gear file says so."""
    found = posted(server, "/gear", {"state": {"pinion.teeth": 8, "pinion.runout": 12}})
    Path("gear.toml").write_text(found["file"], encoding="utf-8")
    gear = rps.SteeringGear.from_toml("gear.toml")
    assert gear == GEAR.replace({"pinion.teeth": 8, "pinion.runout": "12 um"})
    assert gear.pinion.tip_diameter > 0.022


@pytest.fixture(autouse=True)
def empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_random_states_have_values_or_sentences() -> None:
    """Some random states, and every end of a slider."""
    rng = np.random.default_rng(4)
    drawn = [{s.path: float(np.round(rng.uniform(s.low, s.high), 6)) for s in SLIDERS} for _ in range(6)]
    ends = [{slider.path: end} for slider in SLIDERS for end in (slider.low, slider.high)]
    for state in [*drawn, *ends]:
        found = answer(GEAR, Wish(state))
        json.dumps(found, allow_nan=False)
        problems = found.get("problems", [])
        assert problems or len(found["curves"][0]["y"]) > 10
        assert all(text.endswith(".") for text in problems)


@pytest.mark.parametrize("slider", SLIDERS, ids=lambda slider: slider.path)
def test_slider_at_its_start_is_the_gear(slider: Slider) -> None:
    assert slider.low <= slider.of(GEAR) <= slider.high
    same = GEAR.replace({slider.path: slider.value(slider.of(GEAR))})
    assert same.value_at(slider.path) == pytest.approx(GEAR.value_at(slider.path), rel=1e-9)


def test_a_solver_that_breaks_is_a_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: object) -> None:
        raise ZeroDivisionError("by zero")

    monkeypatch.setattr(answers, "simulate", broken)
    assert answer(GEAR, Wish({})) == {
        "problems": ["This state cannot be computed: ZeroDivisionError: by zero."]
    }


@pytest.mark.parametrize(
    ("state", "sentence"),
    [
        ({"yoke.preload": 2000}, "yoke.preload is 2000; it must be from 0 to 1000."),
        ({"yoke.preload": "300"}, "yoke.preload is '300'; it must be a number."),
        ({"yoke.preload": 10**400}, "yoke.preload is 1000"),  # beyond the range of floats
        ({"pinion.teeth": -(10**5000)}, "pinion.teeth is a number too long to be shown; it must be from 5"),
        ({"yoke.preload": float("nan")}, "yoke.preload is nan; it must be from 0 to 1000."),
        ({"test.turns": 5}, "test.turns is no slider of this page."),
        ([], "the state is no table of sliders."),
    ],
)
def test_other_states_are_refused(state: Any, sentence: str) -> None:
    with pytest.raises(rps.InputError, match=sentence.replace(".", r"\.")):
        settings_of(state)


@pytest.mark.parametrize(
    ("method", "path", "body", "headers", "status"),
    [
        ("GET", "/", None, {"Host": "rebound.example"}, 421),  # an address that was made to point here
        ("POST", "/curve", {"state": {}}, {"Host": "rebound.example:80"}, 421),
        ("GET", "/", None, {"Host": "user@127.0.0.1"}, 421),
        ("GET", "/", None, {"Host": "127.0.0.1:80@rebound.example"}, 421),
        ("GET", "/", None, {"Host": "127.0.0.1:rebound.example"}, 421),
        ("GET", "/", None, {"Host": "localhost:80"}, 200),
        ("GET", "/", None, {"Host": "[::1]:80"}, 200),
        ("POST", "/curve", {"state": {}}, {"Content-Type": "text/plain"}, 415),  # as forms of other sites
        ("GET", "/../../etc/passwd", None, {}, 404),
        ("GET", "/answer.py", None, {}, 404),
        ("POST", "/shutdown", {"state": {}}, {}, 404),
        ("POST", "/curve", "no json", {}, 400),
        ("POST", "/curve", [1], {}, 400),
        ("POST", "/curve", {"state": {"x": "y" * 30_000}}, {}, 413),
        ("POST", "/gear", {"state": {"yoke.preload": 10**400}}, {}, 200),  # with problems
        ("POST", "/cancel", {"of": "simulation"}, {}, 400),
        ("POST", "/curve", {"state": {"yoke.preload": 10**400}, "number": 10**400}, {}, 200),
        ("POST", "/curve", '{"state": {"yoke.preload": 1' + "0" * 5000 + "}}", {}, 400),
        ("DELETE", "/", None, {}, 501),
    ],
)
def test_nothing_else_is_served(
    server: Explorer, method: str, path: str, body: Any, headers: dict[str, str], status: int
) -> None:
    assert asked(server, method, path, body, **headers)[0] == status


def test_user_part_is_no_host_on_a_network_either() -> None:
    with Explorer(GEAR, "0.0.0.0") as server:
        assert server.allows("bench.example:80")
        assert not server.allows("user@bench.example:80")


@pytest.mark.parametrize(
    "sent",
    [
        b"",
        b"GET / HTTP/1.1\r\nX: ",
        b"POST /gear HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
        b"Content-Length: 20000\r\n\r\n",
    ],
    ids=["nothing", "head", "body"],
)
def test_request_that_does_not_end_is_dropped(sent: bytes) -> None:
    """A client that goes on with a byte at a time sees the connection closed."""
    with Explorer(GEAR, request_limit=0.5) as server:
        Thread(target=server.serve_forever, kwargs={"poll_interval": 0.05}, daemon=True).start()
        with socket.create_connection(("127.0.0.1", server.server_address[1])) as link:
            link.settimeout(0.05)
            piece, end, is_open = sent, monotonic() + PATIENCE, True
            while is_open and monotonic() < end:
                try:
                    link.sendall(piece)
                    piece = sent[:1] and b"x"
                    is_open = link.recv(1) != b""
                except TimeoutError:
                    pass
                except ConnectionError:
                    is_open = False
        server.shutdown()
    assert not is_open


def test_typed_limits_are_read_as_those_of_a_file_in_the_units_of_the_page(server: Explorer) -> None:
    typed = {
        "torque_mean": {"least": "0,8", "most": "1800 N mm"},
        "rack_gain": {"most": 36},
        "efficiency_forward": {"least": " 46"},
        "torque_peak_to_peak": {"most": "300 N"},
        "torque_on_centre": {"least": "2", "most": "1 N m"},
    }
    found = posted(server, "/limits", {"state": {}, "limits": typed})["limits"]
    assert found["torque_mean"] == {"least": 0.8, "most": 1.8, "shown": "at least 0.8 N m, at most 1.8 N m"}
    assert found["rack_gain"] == {"least": None, "most": pytest.approx(0.036), "shown": "at most 36 mm"}
    assert found["efficiency_forward"]["least"] == pytest.approx(0.46)
    (sentence,) = found["torque_peak_to_peak"]["problems"]
    assert sentence.startswith("ripple, peak to peak, most is '300 N', which is no quantity in N*m")
    (sentence,) = found["torque_on_centre"]["problems"]
    assert sentence.startswith("mean torque on centre, least must be below most")


@pytest.mark.parametrize(
    ("typed", "sentence"),
    [
        ({"ripple": {"most": "1"}}, "ripple is no metric of this page."),
        ([], "limits must be a table of metrics"),
        ({"torque_mean": 3}, "limits must be a table of metrics"),
    ],
)
def test_other_limits_are_refused(typed: Any, sentence: str) -> None:
    with pytest.raises(rps.InputError, match=sentence):
        limits_of(typed)


@pytest.mark.cpu_limit(300)
def test_window_is_that_of_the_state_and_the_typed_limits(server: Explorer) -> None:
    """Its ends, their errors and what limits them are those of the function, with limits in SI."""

    def found(typed: Answer) -> Answer:
        state = {"yoke.preload": 400, "mesh.friction": 0.12}
        return dict(posted(server, "/window", {"state": state, "limits": typed}))

    answered = found({"torque_mean": {"most": "1200 N mm"}, "torque_peak_to_peak": {"most": "0.3"}})
    gear = GEAR.replace({"yoke.preload": 400, "mesh.friction": 0.12})
    limits = {"torque_mean": {"most": 1.2}, "torque_peak_to_peak": {"most": 0.3}}
    sheet = window_page(rps.window(gear, "yoke.preload", limits, inputs="series"), gear, "series", "")
    assert answered["rows"] == [[row.value, row.words, row.is_vague] for row in sheet.rows]
    assert "preload 400 N" in answered["lead"]
    assert all(image["src"].startswith("data:image/svg+xml;base64,") for image in answered["images"].values())
    assert found({})["problems"] == [NO_LIMIT]
    (why,) = found({"torque_mean": {"most": "1 kg"}})["problems"]
    assert why.startswith("mean torque, most is '1 kg'")


def test_without_a_function_there_are_no_windows() -> None:
    with Explorer(GEAR) as plain:
        Thread(target=plain.serve_forever, kwargs={"poll_interval": 0.05}, daemon=True).start()
        assert posted(plain, "/sliders", {"state": {}})["window"] == ""
        assert asked(plain, "POST", "/window", {"state": {}})[0] == 404
        plain.shutdown()


def test_only_this_machine_is_listened_to(server: Explorer) -> None:
    assert server.server_address[0] == "127.0.0.1"
    assert server.address.startswith("http://127.0.0.1:")


def test_only_the_last_state_of_a_tab_is_computed(server: Explorer) -> None:
    answering = server.answering
    assert "curves" in answering.computed(Wish({}), "a tab", 5)
    assert answering.computed(Wish({}), "a tab", 4) == {"stale": True}
    assert "curves" in answering.computed(Wish({}), "another", 1)


@pytest.mark.cpu_limit(300)
def test_crowd_is_answered_beside_a_slow_state(server: Explorer) -> None:
    """200 requests at once, the first of a state that does not end: all have answers, that one a sentence."""

    def one(number: int) -> tuple[float, Any]:
        began = monotonic()
        state = {"yoke.preload": 999 if number == 0 else 100 + number}
        found = posted(server, "/curve", {"state": state, "tab": str(number), "number": 1})
        return monotonic() - began, found

    with ThreadPoolExecutor(CROWD) as crowd:
        (slow, sentence), *others = crowd.map(one, range(CROWD))
    assert sentence["problems"] == [TOO_LONG]
    assert slow >= LONGEST
    assert all("curves" in found for _, found in others)


def test_every_scene_of_equilibria_has_curves() -> None:
    """In both directions where the scene turns steadily: two curves against the motion, of one sign."""
    for scene in (name for name, each in scenes().items() if not each["dynamic"]):
        found = answer(GEAR, Wish({}, scene))
        json.dumps(found, allow_nan=False)
        assert found.get("problems") or (len(found["curves"][0]["y"]) > 2 and found["rows"]), scene
    both = answer(GEAR, Wish({}, is_both_ways=True))["curves"]
    assert [curve["direction"] for curve in both] == [1, -1]
    assert min(min(curve["y"]) for curve in both) > 0.5
    assert answer(GEAR, Wish({}, "rattling"))["problems"] == ["'rattling' is no scene of this page."]


def test_scene_of_dynamics_is_simulated_on_request() -> None:
    shown = answer(GEAR, Wish({"pinion.teeth": 8}, "stick-slip"))
    assert shown["on_request"]
    assert "curves" not in shown
    assert "8 teeth" in shown["gear"]
    found = on_request(GEAR, Wish({"yoke.preload": 400}, "stick-slip"), KINDS["simulation"])
    assert found["fidelity"] == "flank"
    result = rps.run("stick-slip", GEAR.replace({"yoke.preload": 400}))
    largest = (
        SIGNALS[scene_named("stick-slip").signal].displayed(result[scene_named("stick-slip").signal]).max()
    )
    assert max(found["curves"][0]["y"]) == pytest.approx(largest, abs=1e-6)


def test_long_curves_keep_their_peaks() -> None:
    values = np.random.default_rng(3).normal(size=50_000)
    kept = thinned(values)
    assert kept.size <= MOST_POINTS
    assert (np.diff(kept) > 0).all()
    assert {values.argmin(), values.argmax()} <= set(kept)


@pytest.mark.cpu_limit(300)
def test_simulation_is_cancelled_and_stops_no_other_tab(server: Explorer) -> None:
    """It reports how far it is; its tab and others are answered beside it, also with simulations."""
    watched_tab = {"state": {}, "tab": "dynamic", "of": "simulation"}
    post = partial(posted, server)
    post("/simulation", {"state": {}, "scene": "stick-slip", "tab": "other"})
    with ThreadPoolExecutor(1) as crowd:
        long = crowd.submit(post, "/simulation", {"state": {}, "scene": "rattle", "tab": "dynamic"})
        end, texts = monotonic() + PATIENCE, set[str]()
        while not any(" left" in text for text in texts) and monotonic() < end:
            texts.add(post("/progress", watched_tab).get("text", ""))
            sleep(0.1)
        assert any("%, " in text or "once" in text for text in texts), texts
        other = post("/simulation", {"state": {}, "scene": "stick-slip", "tab": "other"})
        assert "curves" in other
        assert "curves" in post("/curve", {"state": {}, "tab": "third", "number": 1})
        post("/cancel", watched_tab)
        assert long.result(timeout=PATIENCE) == CANCELLED  # before it has ended by itself
    assert post("/progress", watched_tab) == {}
    again = post("/simulation", {"state": {}, "scene": "stick-slip", "tab": "dynamic"})
    assert "curves" in again  # by a new process


def test_measured_file_is_read_with_the_signs_of_a_fit_or_refused() -> None:
    table = [f"{angle};{0.7 if angle < 360 else -0.7}" for angle in [*range(0, 360, 2), *range(360, 0, -2)]]
    text = "\n".join(["angle [deg];torque [N m]", *table])
    found = dropped(text.encode())["measured"]
    assert [curve["direction"] for curve in found] == [1, -1]
    assert max(found[0]["y"]) == pytest.approx(0.7)
    late = [f"{row.split(';')[0]};{0.7 if k < 183 else -0.7}" for k, row in enumerate(table)]
    late_file = "\n".join(["angle [deg];torque [N m]", *late]).encode()
    assert [curve["at_reversal"] for curve in dropped(late_file)["measured"]] == [0, 2]
    refused = dropped(b"x;y\n1;2\n")["problems"]
    assert refused
    assert not any("/tmp" in text for text in refused)


def dropped(content: bytes, kind: str = "measured") -> Answer:
    """The answer to a dropped file."""
    return on_request(GEAR, Wish({}, measured=base64.b64encode(content).decode()), KINDS[kind])


@pytest.mark.parametrize("kind", ["Windows-1252", "UTF-16", "MAT, units in the names"])
def test_dropped_file_may_have_any_encoding_or_be_binary(kind: str, tmp_path: Path) -> None:
    if kind in BINARY:
        BINARY[kind](tmp_path / "bench")
    content = (tmp_path / "bench").read_bytes() if kind in BINARY else READABLE[kind]
    assert [curve["direction"] for curve in dropped(content)["measured"]] == [1, -1]


def test_dropped_file_with_the_racks_travel_takes_the_gear_of_the_page_and_doubts_are_said() -> None:
    travel = 1e3 * float(GearPair.of(GEAR).gain) * np.radians(np.arange(-180, 181))
    rows = [*(f"{x:.4f};6.2" for x in travel), *(f"{x:.4f};-6.2" for x in travel[::-1])]
    found = dropped("\n".join(["rack travel [mm];torque [N m]", *rows]).encode())
    assert np.ptp(found["measured"][0]["x"]) == pytest.approx(360, abs=1)
    assert any("check the unit of its torque" in text for text in found["assumed"])


def test_sheet_picture_and_pattern_are_those_of_the_state(server: Explorer) -> None:
    page = posted(server, "/sheet", {"state": {"yoke.preload": 400}})["page"]
    assert "preload 400 N" in page
    assert 'class="gear"' in page
    picture = posted(server, "/picture", {"state": {"yoke.preload": 400}})
    assert picture["image"].startswith("data:image/webp;base64,")
    assert [label["value"] for label in picture["labels"] if label["name"] == "yoke"] == [
        "presses with 400 N"
    ]
    pattern = posted(server, "/pattern", {"state": {}})
    assert pattern["image"].startswith("data:image/svg+xml;base64,")
    undercut = posted(server, "/picture", {"state": {"yoke.preload": -1}})
    assert undercut["problems"] == ["yoke.preload is -1; it must be from 0 to 1000."]


def test_what_a_scene_needs_first_is_on_no_clock(monkeypatch: pytest.MonkeyPatch) -> None:
    class Cold(Answering):
        def task(self, wish: Wish) -> Task:
            task = super().task(wish)
            return replace(task, call=partial(sleep, 2.0)) if wish.state == {} else task

    monkeypatch.setattr("rps_exudyn.pages.explore.answering.LONGEST", 1.0)
    with Cold(GEAR) as answering:
        assert "curves" in answering.computed(Wish({"yoke.preload": 400}), "a tab", 1)


def test_late_curve_shows_that_it_is_computed(browser: sync_api.Browser, server: Explorer) -> None:
    page = browser.new_page()
    page.set_default_timeout(1e3 * PATIENCE)
    page.goto(f"{server.address}#{json.dumps({'state': SLOW})}")
    job = page.locator(".job")
    job.wait_for()
    assert "Curve" in job.inner_text()
    job.wait_for(state="detached")
    assert page.locator("#problems").inner_text() == TOO_LONG
    page.close()


def test_state_is_in_the_address_and_a_file_can_be_dropped(
    browser: sync_api.Browser, server: Explorer
) -> None:
    page, other = browser.new_page(), browser.new_page()
    for each in (page, other):
        each.set_default_timeout(1e3 * PATIENCE)
    page.goto(server.address)
    page.locator("#chart polyline.now").first.wait_for()
    page.get_by_label("yoke preload").fill("420")
    page.get_by_label("both directions").check()
    page.locator("#chart polyline.now.back").wait_for()
    page.wait_for_url(lambda url: "420" in url and "true" in url)  # it may have both, one after the other
    other.goto(page.url)
    other.locator("#chart polyline.now.back").wait_for()
    assert other.get_by_label("yoke preload").input_value() == "420"
    rows = [f"{angle};{0.8 + 0.01 * np.sin(angle):.4f}" for angle in range(-180, 181, 2)]
    text = "\n".join(["angle [deg];torque [N m]", *rows])
    other.evaluate(
        """(text) => {
          const data = new DataTransfer();
          data.items.add(new File([text], "bench.csv"));
          document.dispatchEvent(new DragEvent("drop", { dataTransfer: data, cancelable: true }));
        }""",
        text,
    )
    other.locator("#chart circle").first.wait_for()
    assert other.locator("#chart circle").count() > 150  # brought onto 0 to 360 degrees by whole turns
    places = other.locator("#chart circle").evaluate_all("all => all.map(one => one.cy.baseVal.value)")
    assert min(places) > 0  # the ordinate holds them
    assert "bench.csv" in other.locator("#caption").inner_text()
    with other.expect_download() as download:
        other.get_by_role("button", name="Python").click()
    assert 'rps.run("free-pinion-torque"' in Path(download.value.path()).read_text()
    page.close()
    other.close()


def test_dynamics_and_the_gear_in_three_dimensions(browser: sync_api.Browser, server: Explorer) -> None:
    page = browser.new_page()
    _, said = watched(page)
    page.goto(server.address)
    page.get_by_role("button", name="Turn it in 3-D").click()
    inner = page.frame_locator("#picture iframe")
    inner.locator("#reading").filter(has_text="pinion at").wait_for()
    picture = page.query_selector("#picture iframe")
    frame = picture.content_frame() if picture else None
    assert frame is not None
    frame.evaluate(
        "window.rpsView.set({ camera: { ...window.rpsView.get().camera, azimuth: 0.123 }, explode: 0 })"
    )
    page.get_by_label("pinion teeth").fill("8")
    inner.locator(".lead").filter(has_text="8 teeth").wait_for()
    page.wait_for_function(
        "document.querySelector('#picture iframe').contentWindow.rpsView?.get().camera.azimuth === 0.123"
    )
    page.locator("#scene").select_option("yoke-impact")
    page.locator("#hint").wait_for()
    assert page.locator("#chart polyline").count() == 0
    page.get_by_role("button", name="Simulate").click()
    page.locator(".job progress").wait_for()
    page.get_by_role("button", name="Cancel: Simulate").click()
    page.locator(".job").wait_for(state="detached")
    page.locator("#scene").select_option("stick-slip")
    page.get_by_role("button", name="Simulate").click()
    page.locator("#chart polyline.now").wait_for(timeout=60_000)
    assert not page.locator("#hint").is_visible()
    page.get_by_label("yoke preload").fill("420")
    page.locator("#hint").wait_for()  # the curve is that of other values: it pales
    assert page.locator("body.stale").count() == 1
    assert [text for text in said if "GL Driver Message" not in text] == []
    page.close()


def test_slow_scene_is_drafted_while_a_slider_moves(browser: sync_api.Browser, server: Explorer) -> None:
    """The load test by its own law, a draft of it, and its own law again, once the slider rests."""
    page = browser.new_page()
    _, said = watched(page)
    address = '{"state": {}, "scene": "load-test", "both_ways": false}'
    page.goto(f"{server.address}#{address}")
    sync_api.expect(page.locator("#timing")).to_contain_text("ms to compute", timeout=1e3 * PATIENCE)
    page.evaluate("drafts = true")  # however fast the machine is
    caption = page.locator("#caption")
    page.locator("#yoke-preload").press("ArrowRight")
    sync_api.expect(caption).to_contain_text(answers.DRAFT, timeout=1e3 * PATIENCE)
    sync_api.expect(caption).not_to_contain_text("draft", timeout=1e3 * PATIENCE)
    assert said == []
    page.close()


@pytest.mark.parametrize("width", [390, 1280])
def test_typed_limits_have_verdicts_in_words(browser: sync_api.Browser, server: Explorer, width: int) -> None:
    page = browser.new_page(viewport={"width": width, "height": 900})
    _, said = watched(page)

    def shown(place: str, text: str | re.Pattern[str]) -> None:
        sync_api.expect(page.locator(place)).to_contain_text(text, timeout=1e3 * PATIENCE)

    page.goto(server.address)
    page.locator("#limits summary").click(timeout=1e3 * PATIENCE)
    page.get_by_label("mean torque, at least").fill("0.8")
    page.get_by_label("mean torque, at most").fill("1800 N mm")
    page.get_by_label("ripple, peak to peak, at most").fill("0.3")
    page.keyboard.press("Enter")
    shown("#limits", re.compile(r"not kept: 0\.\d+ ± 0\.\d+ N m \(at least 0.8 N m, at most 1.8 N m\)"))
    shown("#limits", re.compile(r"(?<!not )kept: 0\.0\d+ ± 0\.\d+ N m \(at most 0.3 N m\)"))
    mean = page.evaluate("latest.metrics.find(({ name }) => name === 'torque_mean')")
    page.get_by_label("mean torque, at least").fill(f"{mean['value'] + 0.9 * mean['error']} N m")
    page.keyboard.press("Enter")
    shown("#verdict", "Limits too close to tell: mean torque.")
    page.get_by_label("mean torque, at least").fill("0.8")
    page.get_by_label("yoke preload").fill("450")
    shown("#verdict", "Limits kept: mean torque; ripple, peak to peak.")
    page.get_by_role("button", name="Window of the preload").click()
    shown("#window-found", "95 % of the gears keep the limits")
    page.locator("#window-found img").wait_for()
    page.evaluate("scrollTo(0, 0)")  # on a phone the chart stays in view, over what is scrolled
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    assert page_faults(page) == []
    page.get_by_label("pinion profile shift").fill("0.2")  # undercut: there is no curve to judge
    sync_api.expect(page.locator("#window-found")).to_be_empty()
    shown("#verdict", "Limits not computed: mean torque; ripple, peak to peak.")
    page.wait_for_url(lambda url: "limits" in url and "0.2" in url)
    page.reload()
    shown("#problems", "nearest")
    page.get_by_label("pinion profile shift").fill("1")
    shown("#verdict", "Limits kept: mean torque; ripple, peak to peak.")  # those of the address
    page.get_by_label("ripple, peak to peak, at most").fill("0.3 N")
    page.keyboard.press("Enter")
    shown("#limits", "ripple, peak to peak, most is '0.3 N', which is no quantity in N*m")
    assert said == []
    page.close()


def test_page_in_a_browser(browser: sync_api.Browser, server: Explorer) -> None:
    for width, height in ((390, 800), (768, 1000), (1280, 900)):
        page = browser.new_page(viewport={"width": width, "height": height})
        asked_for, said = watched(page)
        page.goto(server.address)
        page.locator("#chart polyline.now").wait_for()
        before = page.locator("#chart polyline.now").get_attribute("points")
        slider = page.get_by_label("yoke preload")
        slider.focus()
        for _ in range(5):
            page.keyboard.press("ArrowRight")
        page.locator("#chart polyline.start").wait_for()
        page.get_by_text("preload 350 N").first.wait_for()
        assert page.locator("#chart polyline.now").get_attribute("points") != before
        assert slider.get_attribute("aria-valuetext") == "350 N"
        page.get_by_label("pinion profile shift").fill("0.2")
        page.locator("#problems p").first.wait_for()  # undercut: a sentence, and the old curve pales
        assert "nearest" in page.locator("#problems").inner_text()
        page.get_by_role("button", name="Back to the start").click()
        page.locator("#problems p").first.wait_for(state="detached")
        page.locator("#picture img").wait_for()
        page.evaluate("scrollTo(0, 0)")  # on a phone the chart stays in view, over what is scrolled
        assert said == []
        assert all(url.startswith((server.address, "data:")) for url in asked_for)
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        assert page_faults(page) == []
        page.close()
