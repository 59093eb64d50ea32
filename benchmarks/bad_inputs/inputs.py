"""The corpus of bad inputs: commands, and what stands in their folder or environment."""

import os
import random
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import cache
from json import dumps
from pathlib import Path

import h5py
import numpy as np

from benchmarks.bad_inputs.damaged_files import DAMAGES
from benchmarks.topic import ROOT
from rps_exudyn.base.files import with_checksum, without_checksum
from rps_exudyn.base.hdf5 import file_image
from rps_exudyn.parameters.gear import Setup

CHEAP = ("run", "--fidelity", "closed-form", "--out", "precious.h5")
LONG = ("run", "--out", "long.h5", "--set", "fidelity.step_angle=0.002 deg", "--set", "test.turns=1.4")

VALUES = (
    "", " ", "nan", "-inf", "1e400", "-1e308", "1e-320", "3 parsecs", "3 N N", "three", "0x10", "1,5",
    "[1, 2]", "{a=1}", "true", "None", "1/0", "__import__('os')", "½", "１２", "µm", "5 mm deg", "--5", "'",
    '"', "\\", "%s", "9" * 400, "a" * 3000, "\udcff", "🛞", "1e5 km", "-1 mm", "-3", "0", "1e9", "$HOME",
    "../..", "*",
)  # fmt: skip
WORDS = (
    "", "-", "--", "---", "--help=3", "--no-json", "--json=maybe", "--out", "--out=", "--set", "--set==",
    "--set=a=b=c", "--jobs=0", "--jobs=-1", "--jobs=many", "--cluster=", "--cluster=nowhere",
    "--time-limit=0", "--time-limit=-1 s", "--time-limit=nan", "--time-limit=1e400 s", "--time-limit=3 m",
    "--accuracy=0%", "--accuracy=1", "--accuracy=-1%", "--accuracy=nan%", "--fidelity=", "--mesh=",
    "--plot=", "--plot=/dev/null/a.png", "--out=/a/b/c.h5", "--out=.h5", "--out=a.h5/", "--out=\0.h5",
    "--measured=.", "--measured=nothing.csv", "--gear=.", "--gear=/dev/null", "🛞", "precious.h5/x", "..",
    "~", "/", "/dev/null", "\udcff", "a" * 5000, "nothing.h5", "--robust=3", "--version=3",
)  # fmt: skip
COMMANDS = ("run", "study", "show", "diff", "rerun", "geometry", "describe", "collect", "report", "nothing")
TOML = (
    "", "\0", "\ufeff[yoke]\npreload = 300\n", "[yoke", "yoke = 3", "[yoke]\npreload = \n",
    "[yoke]\npreload = nan", "[yoke]\npreload = inf", "[yoke]\npreload = 1979-05-27", "[yoke]\npreload = {}",
    "[yoke]\npreload = []", "[yoke]\npreload = true", '[yoke]\npreload = "300"', "[yoke]\n[yoke]",
    "[yoke]\npreload = 1\npreload = 2", "[[yoke]]\npreload = 300", "[yoke.preload]\nvalue = 3",
    "[Yoke]\npreload = 300", "[yoke]\nPreload = 300", '["yoke\\u0000"]\npreload = 300', "a = " + "[" * 3000,
    "[yoke]\npreload = " + "9" * 5000, "x = 1\n" * 3, '[yoke]\npreload = "3 N"\nextra = 1',
    "[test]\nturns = -1", "[test]\nspeed = 0", "[pinion]\nteeth = 6.5", "[pinion]\nteeth = 1000000000",
    "\x80\x81", "<gear/>", '{"yoke": {"preload": 300}}', "# nothing\n" * 1000,
)  # fmt: skip
DISTRIBUTIONS = (
    "1 +- -1", "1 +- 0", "+-", "+- 3", "1 +-", "1 +- 1 +- 1", "nan +- 1", "1 +- nan", "1 +- inf",
    "1e400 +- 1", "uniform(1)", "uniform()", "uniform(2, 1)", "uniform(1, 1)", "uniform(1, nan)",
    "uniform(-5, 3)", "normal(1, -1)", "normal(0, 1)", "lognormal(1, 1)", "lognormal(-1, 2)",
    "lognormal(1, nan)", "loguniform(0, 1)", "beta(1, 2)", "uniform(1 parsec, 2 parsec)", "uniform((1), 2)",
    "1 +- 1 parsec", "uniform(0, 1e300)", "1 ± ½", "normal(" + "9" * 400 + ", 1)",
)  # fmt: skip
BANDS = (
    ("--band", "0"), ("--band", "-5"), ("--band", "7"), ("--band", "1e3"), ("--band", "9" * 30),
    ("--band=",), ("--band", "9", "10"), ("--inputs", "series"), ("--band", "9", "--inputs", "all"),
    ("--band", "9", "--accuracy", "1%"), ("--band", "9", "--robust"), ("--band", "9", "--time-limit", "9 s"),
)  # fmt: skip
TABLES = (
    "", "pinion_angle [deg],pinion_torque [N m]\n", "a,b\n1,2\n",
    "pinion_angle [deg],pinion_torque [N m]\n1\n", "pinion_angle [deg],pinion_torque [N m]\n1,x\n",
    "pinion_angle [deg],pinion_torque [N m]\nnan,nan\n", "pinion_angle [deg],pinion_torque [N m]\n1e400,2\n",
    "pinion_angle [m],pinion_torque [N m]\n1,2\n2,3\n",
    "pinion_angle [deg],pinion_angle [deg],pinion_torque [N m]\n1,2,3\n", "\0\0\0", "\ufeff" * 3, '"',
    "x" * 200000, "pinion_angle [deg];pinion_torque [N m]\n1;2\n",
    "pinion_angle [deg],pinion_torque [N m]\n" + "1,2\n" * 3,
)  # fmt: skip
ENVIRONMENTS = (
    {"HOME": "/nowhere"}, {"HOME": ""}, {"TMPDIR": "/nowhere"}, {"TERM": "nothing"}, {"TERM": ""},
    {"COLUMNS": "0"}, {"COLUMNS": "-5"}, {"COLUMNS": "many"}, {"LANG": "C", "LC_ALL": "C"},
    {"LC_ALL": "nonsense"}, {"PYTHONIOENCODING": "ascii"}, {"PYTHONIOENCODING": "utf-16"},
    {"MPLBACKEND": "nonsense"}, {"MPLCONFIGDIR": "/dev/null"}, {"NO_COLOR": "1", "FORCE_COLOR": "1"},
    {"OMP_NUM_THREADS": "many"}, {"HDF5_USE_FILE_LOCKING": "nonsense"},
    {"PYTHONWARNINGS": "error::DeprecationWarning"}, {"TZ": "nowhere"}, {"SOURCE_DATE_EPOCH": "never"},
    {"PATH": ""}, {"GIT_DIR": "/nowhere"}, {"PYTHONOPTIMIZE": "2"},
)  # fmt: skip
CACHES = (
    {"RPS_EXUDYN_CACHE": "/dev/null"}, {"RPS_EXUDYN_CACHE": "/proc"}, {"RPS_EXUDYN_CACHE": "precious.h5"},
    {"XDG_CACHE_HOME": "/dev/null"}, {"RPS_EXUDYN_CACHE": "", "XDG_CACHE_HOME": "", "HOME": "/dev/null"},
)  # fmt: skip
SECRET = b"password 7f3a91"
"""Content of secret.txt beside hostile files; nothing of it may be printed, written or sent."""
FILE_LINES = (
    "show {h5}", "rerun {h5}", "diff precious.h5 {h5}", "report {h5}", "animate {h5}", "fit {csv}",
    "run --fidelity closed-form --gear {toml} --out precious.h5",
    "run --fidelity closed-form --measured {csv} --out precious.h5", "study {toml} --dry-run",
    "fit free.csv --like {toml}", "collect {h5}", "geometry --gear {toml}", "validate {toml}",
    "check --gear {toml}",
)  # fmt: skip
ENDLESS = ("pipe", "/dev/zero", "/dev/random", "/proc/kmsg", "/dev/full", "/dev/tty", ".", "secret.txt")
REQUESTS = (
    "", "\0" * 100, "GET", "GET /\r\n\r\n", "GET / HTTP/9.9\r\n\r\n", "GET / HTTP/1.1\r\n\r\n",
    "\x16\x03\x01\x02\0\x01\0", "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n", "TRACE / HTTP/1.0\r\n\r\n",
    "GET / HTTP/1.0\r\n" + "X: y\r\n" * 200 + "\r\n", "GET /" + "a" * 70000 + " HTTP/1.0\r\n\r\n",
    "GET / HTTP/1.0\r\nHost: rebound.example\r\n\r\n", "GET / HTTP/1.0\r\nHost: [::1\r\n\r\n",
    "GET / HTTP/1.0\r\nHost:" + "x" * 60000 + "\r\n\r\n", "OPTIONS * HTTP/1.0\r\n\r\n",
    "CONNECT example.com:443 HTTP/1.0\r\n\r\n", "GET http://example.com/ HTTP/1.0\r\n\r\n",
)  # fmt: skip
PATHS = (
    "/../secret.txt", "/..%2f..%2fetc/passwd", "/%2e%2e/etc/passwd", "//etc/passwd", "/etc/passwd",
    "/./sliders/..", "/server.py", "/answer.py", "/page.html", "/explore.css/../server.py", "/explore.js%00",
    "/sliders?x=1", "/\\..\\x", "/file:///etc/passwd", "/~root", "/.git/config", "/%", "/" + "a" * 3000,
)  # fmt: skip
STATES: tuple[object, ...] = (
    None, 0, "x", [], [[]], {"yoke": 3}, {"yoke.preload": None}, {"yoke.preload": []}, {"yoke.preload": {}},
    {"yoke.preload": True}, {"yoke.preload": "300 N"}, {"yoke.preload": float("nan")},
    {"yoke.preload": float("inf")}, {"yoke.preload": 1e308}, {"yoke.preload": -1e-300},
    {"yoke.preload": 10**400}, {"pinion.teeth": 6.5}, {"pinion.teeth": 1e9}, {"pinion.teeth": -6},
    {"__class__": 1}, {"yoke.preload\0": 1}, {"": 1}, {"x" * 5000: 1}, {"test.turns": 1},
    {"pinion.profile_shift": 1.3, "pinion.teeth": 5}, {"pinion.helix_angle": 35, "rack.tooth_angle": 20},
    {"pinion.normal_module": 2.6, "pinion.teeth": 12}, {"installation.axis_offset": 1e9},
)  # fmt: skip
HEADS = (
    "Content-Length: -1", "Content-Length: 99999999999", "Content-Length: x", "Content-Length: 1e3",
    "Transfer-Encoding: chunked", "Content-Length: 0", "Content-Length: 20001", "Content-Length: 2", "X: y",
)  # fmt: skip
SIGNALS = ("SIGINT", "SIGTERM", "SIGHUP", "SIGPIPE", "SIGINT", "SIGUSR1")


@dataclass(frozen=True)
class BadInput:
    """One bad input.

    Attributes:
        topic: what is bad.
        arguments: of the command; `precious.h5` in its folder must survive it.
        files: name -> content of files that stand in its folder.
        special: name -> "pipe", or what a link of that name leads to.
        request: bytes sent to the explorer, instead of a command.
        environment: variables that are set for it; it then runs in a process of its own.
        largest_file: bytes beyond which no file can grow, as on a full disk [bytes].
        signal: what it is sent, `after` seconds.
        limit: seconds of `--time-limit`.
    """

    topic: str
    arguments: tuple[str, ...]
    files: dict[str, bytes] = field(default_factory=dict)
    special: dict[str, str] = field(default_factory=dict)
    request: bytes | None = None
    environment: dict[str, str] = field(default_factory=dict)
    largest_file: int | None = None
    signal: str = ""
    after: float = 0.0
    limit: float | None = None

    @property
    def is_alone(self) -> bool:
        """Return whether it needs a process of its own."""
        return bool(self.environment or self.signal or self.limit) or self.largest_file is not None


def corpus(precious: bytes) -> list[BadInput]:
    """All bad inputs; `precious` is the content of a sound result's file."""
    rng, limited = random.Random(500), (*LONG, "--time-limit", "60 s")
    gear, measured = (*CHEAP, "--gear", "gear.toml"), (*CHEAP, "--measured", "m.csv")
    return [
        *_settings(rng),
        *_words(rng),
        *(BadInput("gear files", gear, {"gear.toml": _latin(text)}) for text in TOML),
        *_study_files(rng),
        *(BadInput("measured curves", measured, {"m.csv": text.encode()}) for text in TABLES),
        *_result_files(precious),
        *_disks(),
        *(BadInput("environment", CHEAP, environment=each) for each in ENVIRONMENTS),
        *(BadInput("cache", CHEAP, environment=each) for each in CACHES),
        *(BadInput("signals", LONG, signal=name, after=6.0 + k) for k, name in enumerate(SIGNALS)),
        *(BadInput("signals", limited, signal=name, after=7.0 + k) for k, name in enumerate(SIGNALS)),
        *_distributions(),
        *_limits(),
        *_endless_files(),
        *_hostile_files(precious),
        *_requests(),
    ]


def _settings(rng: random.Random) -> Iterator[BadInput]:
    """Each parameter with a value that it can hardly have."""
    for item in Setup.declared():
        value = rng.choice(VALUES)
        yield BadInput("settings", (*CHEAP, "--set", f"{item.path}={value}"))
    for value in VALUES:
        yield BadInput("settings", (*CHEAP, "--set", value))


def _distributions() -> Iterator[BadInput]:
    """Distributions that cannot be, in settings of a band and of a plain run."""
    for text in DISTRIBUTIONS:
        yield BadInput("distributions", (*CHEAP, "--band", "9", "--set", f"yoke.preload={text}"))
        yield BadInput("distributions", (*CHEAP, "--set", f"mesh.friction={text}"))
    for words in BANDS:
        yield BadInput("distributions", (*CHEAP, *words))


def _words(rng: random.Random) -> Iterator[BadInput]:
    for word in WORDS:
        for command in rng.sample(COMMANDS, 2):
            arguments = (command, word) if command != "run" else (*CHEAP, word)
            yield BadInput("words", arguments)


def _study_files(rng: random.Random) -> Iterator[BadInput]:
    """Shipped studies with a piece cut out, doubled or exchanged."""
    shipped = [path for path in sorted((ROOT / "studies").glob("*.toml")) if "optimise" not in path.stem]
    for number in range(80):
        text = rng.choice(shipped).read_text()
        first = rng.randrange(len(text))
        last = min(first + rng.randrange(1, 60), len(text))
        middle = ("", text[first:last] * 2, rng.choice(VALUES))[number % 3]
        content = (text[:first] + middle + text[last:]).encode("utf-8", "replace")
        yield BadInput("study files", ("study", "s.toml", "--dry-run"), {"s.toml": content})
    for toml in TOML[:20]:
        yield BadInput("study files", ("study", "s.toml", "--dry-run"), {"s.toml": _latin(toml)})


def _latin(text: str) -> bytes:
    return text.encode("latin-1", "replace")


def _result_files(precious: bytes) -> Iterator[BadInput]:
    rng = np.random.default_rng(7)
    commands = (("show", "x.h5"), ("rerun", "x.h5"), ("diff", "precious.h5", "x.h5"), ("report", "x.h5"))
    for number in range(15):
        for damage in DAMAGES.values():
            files = {"x.h5": damage(precious, rng)}
            yield BadInput("result files", commands[number % 4], files)


def _disks() -> Iterator[BadInput]:
    for size in (0, 1, 100, 3000, 9000, 20000):
        yield BadInput("disk", CHEAP, largest_file=size)
    for line in ("geometry --out a.glb", "geometry --out a.png", "report precious.h5"):
        yield BadInput("disk", tuple(line.split()), largest_file=2000)


def _limits() -> Iterator[BadInput]:
    plans: tuple[tuple[str, ...], ...] = (
        (),
        ("--fidelity", "quasi-static"),
        ("--fidelity", "quasi-static", "--set", "pinion.runout=10 um"),
        ("--fidelity", "full"),
        ("--set", "test.speed=0.001 rpm"),
        ("--set", "mesh.law=teeth"),
        ("--mesh", "general-contact", "--set", "fidelity.profile_samples=400"),
        ("--set", "pinion.teeth=40"),
        ("--robust",),
    )
    for number, plan in enumerate(plans):
        limit = 0.5 + 1.5 * number
        yield BadInput("time limits", (*LONG, *plan, "--time-limit", f"{limit} s"), limit=limit)


def _endless_files() -> Iterator[BadInput]:
    """Pipes, devices, folders and files of others where a command reads one."""
    for number, line in enumerate(FILE_LINES):
        for place in (ENDLESS[0], ENDLESS[1], ENDLESS[2 + number % (len(ENDLESS) - 2)]):
            names = {kind: f"x.{kind}" for kind in ("h5", "csv", "toml")}
            special = {name: place for kind, name in names.items() if f"{{{kind}}}" in line}
            yield BadInput("endless files", tuple(line.format(**names).split()), special=special)


def _hostile_files(precious: bytes) -> Iterator[BadInput]:
    """Results that lead out of themselves or declare more than they hold; JSON nested deep."""
    for change in CHANGES:
        files = {"x.h5": changed(precious, change)}
        for line in ("show x.h5", "rerun x.h5", "report x.h5", "diff x.h5 precious.h5"):
            yield BadInput("hostile files", tuple(line.split()), files)
    many = 10**5
    deep = ("[" * many, '{"a":' * many, "[" + "[]," * many + "[]]", '{"filetype": "rps_exudyn-study"}', "\0")
    for text in deep:
        for line in ("collect s", "report s", "fit free.csv --like s/study.json", "study s/study.json"):
            yield BadInput("hostile files", tuple(line.split()), {"s/study.json": text.encode()})


def changed(content: bytes, change: Callable[[h5py.File], object]) -> bytes:
    """The file of a result after a change, with a checksum that fits."""

    def fill(file: h5py.File) -> None:
        with h5py.File(h5py.h5f.open_file_image(without_checksum(content))) as sound:
            for name in sound:
                sound.copy(name, file)
            for name, value in sound.attrs.items():
                file.attrs[name] = value
        change(file)

    return with_checksum(file_image(fill))


def _virtual(file: h5py.File, name: str) -> None:
    layout = h5py.VirtualLayout((3,), "u1")
    layout[:] = h5py.VirtualSource("secret.txt", "x", (3,))
    file.create_virtual_dataset(name, layout)


def _link(file: h5py.File, name: str) -> None:
    file[name] = h5py.ExternalLink("precious.h5", "/")


def _outside(file: h5py.File, name: str) -> None:
    file.create_dataset(name, (len(SECRET),), "u1", external=[("secret.txt", 0, len(SECRET))])


def _vast(file: h5py.File, name: str) -> None:
    file.create_dataset(name, (10**12,), "f8", chunks=(1000,))


def _soft(file: h5py.File, name: str) -> None:
    file[name] = h5py.SoftLink("/nowhere")


def _replaced(make: Callable[[h5py.File, str], object], name: str) -> Callable[[h5py.File], object]:
    def change(file: h5py.File) -> None:
        del file[name]
        make(file, name)

    return change


def _attribute(name: str, value: object) -> Callable[[h5py.File], object]:
    return lambda file: file.attrs.__setitem__(name, value)


CHANGES = (
    *(
        _replaced(make, name)
        for make in (_virtual, _link, _outside, _vast, _soft)
        for name in ("signals/pinion_torque", "summary/torque_mean", "signals")
    ),
    _attribute("parameters", '{"a":' * 10**4),
    _attribute("findings", "[]"),
    _attribute("solver", "null"),
    _attribute("scene", "../x"),
    _attribute("status", "<script>alert(1)</script>"),
    _attribute("version", [10**9, 0]),
    _attribute("version", "x"),
    _attribute("fidelity", '{"name": {}}'),
    _attribute("message", "\x1b]0;title\x07"),
)


def _requests() -> Iterator[BadInput]:
    """What no page of the explorer sends."""
    host, kind = "Host: 127.0.0.1\r\n", "Content-Type: application/json\r\n"
    plain = (f"{verb} {path} HTTP/1.0\r\n{host}\r\n" for path in PATHS for verb in ("GET", "POST"))
    texts = [*REQUESTS, *plain]
    for path in ("/curve", "/gear"):
        bodies = [dumps({"state": state, "tab": "x", "number": 1}) for state in STATES]
        bodies += ["", "{", "[" * 10**4, "null"]
        bodies += [f'{{"state": {{}}, "number": {number}}}' for number in ("[]", '"x"')]
        ends = [*(f"Content-Length: {len(body)}\r\n\r\n{body}" for body in bodies)]
        ends += [f"{head}\r\n\r\n{{}}" for head in HEADS]
        texts += [f"POST {path} HTTP/1.0\r\n{host}{kind}{end}" for end in ends]
    for text in texts:
        yield BadInput("explorer", ("explore",), request=text.encode("latin-1"))


def stands_in(folder: Path, bad: BadInput, precious: bytes) -> None:
    """Write the files that a bad input finds in its folder."""
    (folder / "precious.h5").write_bytes(precious)
    (folder / "secret.txt").write_bytes(SECRET)
    (folder / "free.csv").write_text(_free_curve())
    for name, content in bad.files.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_bytes(content)
    for name, place in bad.special.items():
        if place == "pipe":
            os.mkfifo(folder / name)
        else:
            (folder / name).symlink_to(place)


@cache
def _free_curve() -> str:
    rows = (f"{angle},{0.6 + 0.02 * np.cos(np.radians(6 * angle)):.4f}" for angle in range(361))
    return "\n".join(("pinion_angle [deg],pinion_torque [N m]", *rows)) + "\n"
