"""The explorer as a widget of a notebook (anywidget): the page in a frame, its requests through the kernel.

from rps_exudyn.assessment.requirements.window_page import window_sheet
from rps_exudyn.pages.explore.widget import explorer

explorer(rps.SteeringGear(), window_sheet)  # the last line of a cell shows it, with the button for windows
"""

import json
from pathlib import Path
from threading import Thread
from typing import Any

from rps_exudyn.base.errors import InputError
from rps_exudyn.pages.charts.style import theme
from rps_exudyn.pages.explore.answering import Answering, Request
from rps_exudyn.pages.explore.on_request import FindWindow
from rps_exudyn.parameters.gear import SteeringGear

_FOLDER = Path(__file__).parent / "web"
_LINKS = {
    '<link rel="stylesheet" href="/explore.css">': ("explore.css", "style"),
    '<script src="/explore.js" defer></script>': ("explore.js", "script type=module"),
}
_FRONT = """
function render({ model, el }) {
  const waiting = new Map();
  let count = 0;
  const frame = document.createElement("iframe");
  frame.title = "Explore a steering gear";
  frame.style = "width: 100%; height: 48rem; border: 0";
  frame.rpsPost = (path, content) => new Promise((done) => {
    const id = String(++count);
    waiting.set(id, done);
    model.send({ id, path, content });
  });
  const take = ({ id, content }) => {
    waiting.get(id)?.(content);
    waiting.delete(id);
  };
  model.on("msg:custom", take);
  frame.srcdoc = model.get("page");
  el.append(frame);
  return () => model.off("msg:custom", take);
}
export default { render };
"""


def page_file(name: str) -> str:
    """A file of the page; its style sheet begins with the colours of all pages."""
    return theme() * (name == "explore.css") + (_FOLDER / name).read_text(encoding="utf-8")


def page() -> str:
    """The explorer's page in one piece."""
    text = page_file("page.html")
    for link, (name, tag) in _LINKS.items():
        text = text.replace(link, f"<{tag}>\n{page_file(name)}\n</{tag.split()[0]}>")
    return text


def explorer(gear: SteeringGear | None = None, find_window: FindWindow | None = None) -> Any:
    """Return the widget of a gear, the default one without; with a button for windows by the function.

    Raises:
        InputError: anywidget is not installed.
    """
    try:
        from anywidget import AnyWidget
        from traitlets import Unicode
    except ImportError:
        raise InputError("The widget needs anywidget: pip install 'rps-exudyn[notebook]'.") from None

    class Explorer(AnyWidget):
        _esm = _FRONT
        page = Unicode(page()).tag(sync=True)

        def __init__(self, gear: SteeringGear) -> None:
            super().__init__()
            self.answering = Answering(gear, find_window)
            self.on_msg(lambda _, content, buffers: self.take(content))

        def take(self, asked: Any) -> None:
            """Answer a request of the page, in a thread of its own."""
            Thread(target=self._answer, args=(asked,), daemon=True).start()

        def _answer(self, asked: Any) -> None:
            try:
                if asked["path"] not in self.answering.paths:
                    raise InputError("there is no such request.")
                found = self.answering.reply(asked["path"], Request.from_page(asked["content"]))
            except InputError as error:
                found = {"problems": list(error.problems)}
            self.send({"id": asked["id"], "content": json.loads(json.dumps(found, allow_nan=False))})

        def close(self) -> None:
            """End the processes, too."""
            self.answering.__exit__()
            super().close()

    return Explorer(gear or SteeringGear())
