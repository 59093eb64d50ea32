"""Every command that the pages and `--help` print runs as a reader runs it, and makes the files it names.

Each page is read in an empty folder of its own, from top to bottom: each command line is a fresh process in a
reader's environment, and the Python blocks of a page are one more. The tables say all that is done otherwise.
"""

import http.client
import re
import shlex
import shutil
import socket
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import NamedTuple

import pytest

import rps_exudyn as rps
from reader import EXAMPLES, PAGES, ROOT, Printed, Server, Session, Terminal, printed_in
from rps_exudyn.study.store import Store
from shell import in_fresh_process

ELSEWHERE = {
    r"pip install|-m venv": "installs: .ci/run does, as the README prints it",
    r"pytest|/(ruff|mypy|lint-imports)|mkdocs build|\.ci/": "checks: .ci/run does them, and this is one",
    r"pre-commit install": "changes the checkout",
    r"python benchmarks/make\.py": "takes minutes to hours: tests/benchmarks run every topic at toy size",
    r"dask_jobqueue": "needs a job queue",
    r"--install-completion": "changes the reader's shell: tests/wrong_input/test_environment.py does it",
}
"""What is not run here, and why."""

INSTEAD = {
    "python3 -m venv .venv && .venv/bin/pip install -q -e . && .venv/bin/": "",
    ". .venv/bin/activate": ":",
    "dask scheduler": "dask scheduler --host 127.0.0.1 --port {port} --no-dashboard",
    "tcp://10.0.0.1:8786": "tcp://127.0.0.1:{port}",
    "--nworkers 8": "--nworkers 2",
}
"""What stands for a part of a line: the installation that runs these tests, and a cluster on this machine."""

PLACEHOLDERS = {
    "SCENE": "load-test",
    "FILE": "result.h5",
    "A": "result.h5",
    "B": "other.h5",
    "FILE...": "measured.csv",
    "FILE.toml": "study.toml",
    "DIR": "study",
    "PATH...": "study",
    "DIR/cases/HASH.h5": "study/cases/{hash}.h5",
    "[SCENE]": "load-test",
    "[DIR]": "begun",
    "[ROWS]": "rows",
    "[PATH]": "yoke",
}
"""What stands for a word that a reader replaces: a word, or a file or folder that `lender` has."""

OWN_FILES = {
    "free.csv",
    "b.csv",
    "c.csv",
    "d.csv",
    "e.csv",
    "expected.toml",
    "optimise_ripple.toml",
    "tolerance_cost.toml",
    "wish.toml",
    "first.csv",
    "second.csv",
    "line",
}
"""Files of a reader's own that pages name."""

STATUS = {"rps-exudyn check --limits own.toml": 0, "rps-exudyn check": 1, "rps-exudyn view": 2}
"""Exit status other than 0: the default gear does not keep all requirements; there is no display."""

SERVERS = {
    "dask scheduler": r"Scheduler at:\s+(tcp://\S+)",
    "dask worker": r"(?s)Registered to:.+Registered to:",
    "rps-exudyn explore": r"server: http://([^/\s]+)",
}
"""Commands that go on until they are ended, and what they print when they are ready."""

TO_HELP = {
    "run --column": "--measured titled.csv",
    "export --set": "gear.stl",
    "export --part": "gear.stl",
    "study --cluster": "study.toml",
    "fit --set": "free.csv",
    "judge-batch --set": "line",
    "fit --prior": "free.csv",
    "fit --column": "titled.csv",
    "fit --time-limit": "free.csv",
}
"""What an example in `--help` needs besides."""

OUTPUTS = ("--out", "--plot", "--report", "--series")
MAKERS = re.compile(
    r"rps-exudyn (run|study|fit|report|collect|animate|validate|schema) "
)  # of files that they name


class Lender(NamedTuple):
    """Files and folders that stand for a reader's own, made once for all pages."""

    folder: Path
    port: int
    hash: str  # of a case of the study

    def lend(self, name: str, folder: Path) -> None:
        """Put a copy where a reader would have it; what the reader has made stays."""
        if (source := self.folder / name).is_dir():
            shutil.copytree(source, folder / name, dirs_exist_ok=True)
        elif source.exists() and not (folder / name).exists():
            shutil.copy(source, folder / name)


@pytest.fixture(scope="module")
def lender(tmp_path_factory: pytest.TempPathFactory) -> Lender:
    folder = tmp_path_factory.mktemp("lent")
    terminal = Terminal(folder)
    for line in (
        "rps-exudyn init . && grep -v '^gear' preload.toml > study.toml",
        "rps-exudyn run --fidelity quasi-static --out result.h5",
        "rps-exudyn run --fidelity closed-form --out other.h5",
        "rps-exudyn study study.toml",
    ):
        assert terminal.run(line).returncode == 0
    row = sorted((ROOT / "validation").glob("*/row.toml"))[0].parent
    shutil.copytree(row, folder / "rows" / row.name)
    for name in ("measured.csv", "free.csv", "first.csv", "second.csv"):
        shutil.copy(EXAMPLES / "measured" / "made_up_free.csv", folder / name)
    wishes = (
        'free_torque.least = "0.8 N*m"',
        'free_torque.most = "1.8 N*m"',
        'torque_peak_to_peak.most = "0.3 N*m"',
    )
    (folder / "wish.toml").write_text("\n".join(wishes) + "\n")
    (folder / "line").mkdir()
    for number in range(5):
        shutil.copy(folder / "free.csv", folder / "line" / f"gear{number}.csv")
    shutil.copy(EXAMPLES / "measured" / "made_up_yoke_out.csv", folder / "b.csv")
    shutil.copy(folder / "gears" / "paper.toml", folder / "expected.toml")
    for name, title, torque in (("c.csv", "torque [N mm]", 30), ("titled.csv", "M2", 61)):
        rows = [f"{angle}; {torque + 0.1 * (angle % 7)}" for angle in range(0, 361, 5)]
        (folder / name).write_text("\n".join([f"angle [deg]; {title}", *rows]) + "\n")
    for name, mass in {"d.csv": "40 kg", "e.csv": "150 kg"}.items():
        raised = rps.run("load-test", fidelity="quasi-static", load_mass=mass).to_xarray().to_dataframe()
        table = raised[["pinion_angle", "pinion_torque"]]
        table.to_csv(folder / name, header=["angle [rad]", "torque [N m]"], index=False)
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        return Lender(
            folder, free.getsockname()[1], next(iter(Store.open(folder / "study").description.hashes))
        )


@pytest.fixture(scope="module")
def cluster() -> Iterator[dict[str, Server]]:
    """The servers of a cluster, once they are started."""
    servers: dict[str, Server] = {}
    yield servers
    for server in reversed(servers.values()):
        server.end()


class Reader:
    """Someone at a terminal in an empty folder."""

    def __init__(self, folder: Path, lender: Lender, cluster: dict[str, Server]) -> None:
        self.terminal = Terminal(folder)
        self.printed = ""  # by the command before
        self._lender, self._cluster = lender, cluster

    def type(self, line: str) -> None:
        """Run a command line; check its exit status, and that the files that it names are there."""
        here = self.terminal.folder
        line = self._filled_in(line)
        for start, ready in SERVERS.items():
            if line.startswith(start):
                self._serve(start, line, ready)
                return
        done = self.terminal.run(line)
        expected = next((status for start, status in STATUS.items() if line.startswith(start)), 0)
        assert done.returncode == expected, f"{line}: {done.stderr or done.stdout}"
        assert "Traceback" not in done.stderr, f"{line}: {done.stderr}"
        outputs = outputs_of(line, done.stdout)
        assert outputs or not MAKERS.match(line) or "--dry-run" in line.split(), f"{line} names no file"
        assert [name for name in outputs if not (here / name).exists()] == [], line
        self.printed = done.stdout

    def _filled_in(self, line: str) -> str:
        """The line with what stands for its parts and placeholders; files that it needs are put there."""
        for part, other in INSTEAD.items():
            line = line.replace(part, other.format(port=self._lender.port))
        words = line.split(" ")
        for at, word in enumerate(words):
            words[at] = PLACEHOLDERS.get(word, word).format(hash=self._lender.hash)
            own = words[at] if word in PLACEHOLDERS else word.rpartition("=")[2]
            if word in PLACEHOLDERS or own in OWN_FILES:
                self._lender.lend(own.partition("/")[0], self.terminal.folder)
        return " ".join(words)

    def _serve(self, start: str, line: str, ready: str) -> None:
        """Start a server and see that it answers; those of a cluster stay."""
        if start in self._cluster:
            return
        server = Server(line, self.terminal.folder, ready)
        if start.startswith("dask"):
            self._cluster[start] = server
            return
        try:
            link = http.client.HTTPConnection(server.answer[1], timeout=300)
            link.request("GET", "/")
            assert link.getresponse().status == 200
            link.close()
            assert server.interrupt() == 0, server.said
        finally:
            server.end()


def outputs_of(line: str, printed: str) -> list[str]:
    """Names of the files and folders that a command makes, by its options and by what it prints."""
    words = shlex.split(line)
    named = [words[at + 1] for at, word in enumerate(words) if word in OUTPUTS]
    return [
        *named,
        *(
            name
            for line in re.findall(r"^written: (.+?)(?:  \(.*)?$", printed, re.M)
            for name in line.split(", ")
        ),
        *re.findall(r": \d+ cases in (.+?) \(", printed),
    ]


# --- what is run -----------------------------------------------------------------------------------


def reason_not_to_run(text: str) -> str | None:
    """Why something is left to others; None if it is run here."""
    for part, other in INSTEAD.items():
        text = text.replace(part, other)
    return next((why for part, why in ELSEWHERE.items() if re.search(part, text)), None)


def usages() -> dict[str, str]:
    """Name of each command -> how the table of commands prints it."""
    lines = [each.text for each in printed_in(ROOT / "docs" / "commands.md")]
    return {line.split()[1]: line for line in lines if line.startswith("rps-exudyn ")}


def is_name(text: str) -> bool:
    """Return whether it is no command line but the name of a command that takes more, "rps-exudyn study"."""
    name = text.removeprefix("rps-exudyn ")
    return name in usages() and bool(re.search(r" [A-Z]", usages()[name]))


def run_here(page: Path) -> list[Printed]:
    """The commands and blocks of a page that its test runs."""
    languages = ("sh", "python", "toml", *(["text"] if page.name == "README.md" else []))
    return [
        each
        for each in printed_in(page)
        if each.language in languages and not is_name(each.text) and not reason_not_to_run(each.text)
    ]


READ = {page: run_here(page) for page in PAGES}


@pytest.mark.parametrize("page", [*filter(READ.get, PAGES)], ids=lambda page: str(page.relative_to(ROOT)))
def test_page_runs_as_printed(page: Path, tmp_path: Path, lender: Lender, cluster: dict[str, Server]) -> None:
    reader, session = Reader(tmp_path, lender, cluster), None
    if page.is_relative_to(EXAMPLES):  # it is read where `init` writes it
        shutil.copytree(page.parent, tmp_path, dirs_exist_ok=True)
    with ExitStack() as at_the_end:
        for number, each in enumerate(READ[page]):
            if each.language == "sh":
                reader.type(each.text)
            elif each.language == "toml":
                (tmp_path / "studies" / f"own{number}.toml").write_text(each.text, encoding="utf-8")
                reader.type(f"rps-exudyn study studies/own{number}.toml")
            elif each.language == "text":
                check_shown(each.text, reader.printed)
            else:
                if session is None:
                    session = Session(reader.terminal.folder)
                    at_the_end.callback(session.end)
                session.run(each.text, f"{page.name}, line {each.line}")
                for name in re.findall(r"(?:save|plot|to_csv)\(\"([^\"]+)\"\)", each.text):
                    assert (reader.terminal.folder / name).exists(), f"{name} is not there"


def check_shown(shown: str, printed: str) -> None:
    """Check that the command before has printed the lines that the page shows of it."""
    words = " ".join(printed.split())
    for line in shown.splitlines():
        assert " ".join(line.removesuffix("...").split()) in words


@pytest.mark.parametrize("name", usages())
def test_help_and_its_examples_run(
    name: str, tmp_path: Path, lender: Lender, cluster: dict[str, Server]
) -> None:
    helped = in_fresh_process(f"rps-exudyn {name} --help", tmp_path, COLUMNS="1000")
    assert helped.returncode == 0
    reader = Reader(tmp_path, lender, cluster)
    examples = re.findall(r"│ (--[\w-]+) .*?for instance (.+?)[;:.](?= )", helped.stdout)
    assert {key for key in TO_HELP if key.startswith(f"{name} ")} <= {
        f"{name} {each}" for each, _ in examples
    }
    for option, example in examples:
        if option == "--cluster":
            for line in ("dask scheduler", "dask worker tcp://10.0.0.1:8786 --nworkers 8"):
                reader.type(line)
        besides = TO_HELP.get(f"{name} {option}", "")
        for word in besides.split():
            lender.lend(word, tmp_path)
        given = example if example.startswith("--") else f"{option} {example}"
        reader.type(f"rps-exudyn {name} {besides} {given}")


def test_tables_have_no_entry_that_no_page_needs() -> None:
    texts = [each.text for page in PAGES for each in printed_in(page)]
    words = {word for text in texts for word in re.split(r"[ =]", text)}
    assert [part for part in ELSEWHERE if not any(re.search(part, text) for text in texts)] == []
    assert [part for part in INSTEAD if not any(part in text for text in texts)] == []
    assert PLACEHOLDERS.keys() | OWN_FILES <= words


def test_pages_have_commands() -> None:
    """What is looked for is found: the numbers can only grow."""
    ran = [each.language for page in PAGES for each in READ[page]]
    counts = {language: ran.count(language) for language in ("sh", "python", "toml")}
    left = [each.text for page in PAGES for each in printed_in(page) if reason_not_to_run(each.text)]
    print(f"{counts} run here, {len(left)} elsewhere")
    assert counts["sh"] >= 85
    assert counts["python"] >= 22
