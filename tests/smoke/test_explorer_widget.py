"""The explorer in a notebook: the widget's frame in a real browser, its requests answered by its kernel."""

import json
from queue import Queue
from typing import Any

import pytest
from playwright import sync_api

from rps_exudyn.base.errors import InputError
from rps_exudyn.pages.explore.widget import explorer, page
from watched_page import watched

anywidget = pytest.importorskip("anywidget")

STAND_IN = """
<body><div id="cell"></div><script type="module">
const source = new Blob([SOURCE], { type: "text/javascript" });
const heard = [];
const model = {
  get: () => PAGE,
  send: (asked) => window.kernel(JSON.stringify(asked)).then((answer) => {
    for (const each of heard) each(JSON.parse(answer));
  }),
  on: (_, take) => heard.push(take),
  off: () => {},
};
const { default: widget } = await import(URL.createObjectURL(source));
widget.render({ model, el: document.getElementById("cell") });
</script></body>
"""


def test_sliders_in_a_cell_move_the_curve(browser: sync_api.Browser, monkeypatch: pytest.MonkeyPatch) -> None:
    """The notebook's front end is a stand-in; messages pass as JSON, as a kernel's do."""
    widget = explorer()
    answers: Queue[Any] = Queue()
    monkeypatch.setattr(widget, "send", answers.put)

    def kernel(asked: str) -> str:
        widget.take(json.loads(asked))
        return json.dumps(answers.get(timeout=300))

    seen = browser.new_page(viewport={"width": 1100, "height": 900})
    _, said = watched(seen)
    try:
        seen.expose_function("kernel", kernel)
        text = STAND_IN.replace("SOURCE", _quoted(str(widget._esm))).replace("PAGE", _quoted(page()))
        seen.set_content(text)
        inside = seen.frame_locator("iframe")
        number = inside.locator("#rows dt").first
        number.wait_for(timeout=300_000)
        before = number.inner_text()
        inside.locator("input[type=range]").first.evaluate(
            "one => { one.value = one.max; one.dispatchEvent(new Event('input', { bubbles: true })); }"
        )
        sync_api.expect(number).not_to_have_text(before, timeout=300_000)
        assert float(before.split()[0]) == pytest.approx(0.62, abs=0.01)
        assert said == []
    finally:
        seen.close()
        widget.close()


def _quoted(text: str) -> str:
    return json.dumps(text).replace("<", "\\u003c")


def test_request_that_cannot_be_is_answered(monkeypatch: pytest.MonkeyPatch) -> None:
    widget = explorer()
    answers: Queue[Any] = Queue()
    monkeypatch.setattr(widget, "send", answers.put)
    try:
        for asked in (
            {"id": "a", "path": "files", "content": {}},
            {"id": "b", "path": "curve", "content": 3},
        ):
            widget.take(asked)
            answer = answers.get(timeout=60)
            assert answer["id"] == asked["id"]
            assert answer["content"]["problems"]
    finally:
        widget.close()


def test_without_anywidget_a_sentence_names_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "anywidget", None)
    with pytest.raises(InputError, match=r"pip install 'rps-exudyn\[notebook\]'"):
        explorer()
