"""The corpus of bad inputs: commands, and what stands in their folder or environment."""

import random
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from benchmarks.bad_inputs.damaged_files import DAMAGES
from benchmarks.topic import ROOT
from rps_exudyn.parameters.gear import Setup

CHEAP = ("run", "--fidelity", "closed-form", "--out", "precious.h5")
LONG = ("run", "--out", "long.h5", "--set", "fidelity.step_angle=0.002 deg", "--set", "test.turns=1.4")

VALUES = (
    "", " ", "nan", "-inf", "1e400", "-1e308", "1e-320", "3 parsecs", "3 N N", "three", "0x10", "1,5",
    "[1, 2]",
    "{a=1}", "true", "None", "1/0", "__import__('os')", "½", "１２", "µm", "5 mm deg", "--5", "'", '"', "\\",
    "%s",
    "9" * 400, "a" * 3000, "\udcff", "🛞", "1e5 km", "-1 mm", "-3", "0", "1e9", "$HOME", "../..", "*",
)  # fmt: skip
WORDS = (
    "", "-", "--", "---", "--help=3", "--no-json", "--json=maybe", "--out", "--out=", "--set", "--set==",
    "--set=a=b=c",
    "--jobs=0", "--jobs=-1", "--jobs=many", "--cluster=", "--cluster=nowhere", "--time-limit=0",
    "--time-limit=-1 s",
    "--time-limit=nan", "--time-limit=1e400 s", "--time-limit=3 m", "--accuracy=0%", "--accuracy=1",
    "--accuracy=-1%",
    "--accuracy=nan%", "--fidelity=", "--mesh=", "--plot=", "--plot=/dev/null/a.png", "--out=/a/b/c.h5",
    "--out=.h5",
    "--out=a.h5/", "--out=\0.h5", "--measured=.", "--measured=nothing.csv", "--gear=.", "--gear=/dev/null",
    "🛞",
    "precious.h5/x", "..", "~", "/", "/dev/null", "\udcff", "a" * 5000, "nothing.h5", "--robust=3",
    "--version=3",
)  # fmt: skip
COMMANDS = ("run", "study", "show", "diff", "rerun", "geometry", "describe", "collect", "report", "nothing")
TOML = (
    "", "\0", "\ufeff[yoke]\npreload = 300\n", "[yoke", "yoke = 3", "[yoke]\npreload = \n",
    "[yoke]\npreload = nan",
    "[yoke]\npreload = inf", "[yoke]\npreload = 1979-05-27", "[yoke]\npreload = {}", "[yoke]\npreload = []",
    "[yoke]\npreload = true", '[yoke]\npreload = "300"', "[yoke]\n[yoke]", "[yoke]\npreload = 1\npreload = 2",
    "[[yoke]]\npreload = 300", "[yoke.preload]\nvalue = 3", "[Yoke]\npreload = 300", "[yoke]\nPreload = 300",
    '["yoke\\u0000"]\npreload = 300', "a = " + "[" * 3000, "[yoke]\npreload = " + "9" * 5000, "x = 1\n" * 3,
    '[yoke]\npreload = "3 N"\nextra = 1', "[test]\nturns = -1", "[test]\nspeed = 0", "[pinion]\nteeth = 6.5",
    "[pinion]\nteeth = 1000000000", "\x80\x81", "<gear/>", '{"yoke": {"preload": 300}}', "# nothing\n" * 1000,
)  # fmt: skip
DISTRIBUTIONS = (
    "1 +- -1", "1 +- 0", "+-", "+- 3", "1 +-", "1 +- 1 +- 1", "nan +- 1", "1 +- nan", "1 +- inf",
    "1e400 +- 1",
    "uniform(1)", "uniform()", "uniform(2, 1)", "uniform(1, 1)", "uniform(1, nan)", "uniform(-5, 3)",
    "normal(1, -1)", "normal(0, 1)", "lognormal(1, 1)", "lognormal(-1, 2)", "lognormal(1, nan)",
    "loguniform(0, 1)", "beta(1, 2)", "uniform(1 parsec, 2 parsec)", "uniform((1), 2)", "1 +- 1 parsec",
    "uniform(0, 1e300)", "1 ± ½", "normal(" + "9" * 400 + ", 1)",
)  # fmt: skip
BANDS = (
    ("--band", "0"), ("--band", "-5"), ("--band", "7"), ("--band", "1e3"), ("--band", "9" * 30), ("--band=",),
    ("--band", "9", "10"), ("--inputs", "series"), ("--band", "9", "--inputs", "all"),
    ("--band", "9", "--accuracy", "1%"), ("--band", "9", "--robust"), ("--band", "9", "--time-limit", "9 s"),
)  # fmt: skip
TABLES = (
    "", "pinion_angle [deg],pinion_torque [N m]\n", "a,b\n1,2\n",
    "pinion_angle [deg],pinion_torque [N m]\n1\n",
    "pinion_angle [deg],pinion_torque [N m]\n1,x\n", "pinion_angle [deg],pinion_torque [N m]\nnan,nan\n",
    "pinion_angle [deg],pinion_torque [N m]\n1e400,2\n", "pinion_angle [m],pinion_torque [N m]\n1,2\n2,3\n",
    "pinion_angle [deg],pinion_angle [deg],pinion_torque [N m]\n1,2,3\n", "\0\0\0",
    "\ufeff" * 3, '"', "x" * 200000,
    "pinion_angle [deg];pinion_torque [N m]\n1;2\n", "pinion_angle [deg],pinion_torque [N m]\n" + "1,2\n" * 3,
)  # fmt: skip
ENVIRONMENTS = (
    {"HOME": "/nowhere"}, {"HOME": ""}, {"TMPDIR": "/nowhere"}, {"TERM": "nothing"}, {"TERM": ""},
    {"COLUMNS": "0"},
    {"COLUMNS": "-5"}, {"COLUMNS": "many"}, {"LANG": "C", "LC_ALL": "C"}, {"LC_ALL": "nonsense"},
    {"PYTHONIOENCODING": "ascii"}, {"PYTHONIOENCODING": "utf-16"}, {"MPLBACKEND": "nonsense"},
    {"MPLCONFIGDIR": "/dev/null"}, {"NO_COLOR": "1", "FORCE_COLOR": "1"}, {"OMP_NUM_THREADS": "many"},
    {"HDF5_USE_FILE_LOCKING": "nonsense"}, {"PYTHONWARNINGS": "error::DeprecationWarning"}, {"TZ": "nowhere"},
    {"SOURCE_DATE_EPOCH": "never"}, {"PATH": ""}, {"GIT_DIR": "/nowhere"}, {"PYTHONOPTIMIZE": "2"},
)  # fmt: skip
CACHES = (
    {"NUMBA_CACHE_DIR": "/dev/null"}, {"NUMBA_CACHE_DIR": "/proc"}, {"NUMBA_CACHE_DIR": "precious.h5"},
    {"XDG_CACHE_HOME": "/dev/null"}, {"NUMBA_CACHE_DIR": "", "XDG_CACHE_HOME": "", "HOME": "/dev/null"},
)  # fmt: skip
SIGNALS = ("SIGINT", "SIGTERM", "SIGHUP", "SIGPIPE", "SIGINT", "SIGUSR1")


@dataclass(frozen=True)
class BadInput:
    """One bad input.

    Attributes:
        topic: what is bad.
        arguments: of the command; `precious.h5` in its folder must survive it.
        files: name -> content of files that stand in its folder.
        environment: variables that are set for it; it then runs in a process of its own.
        largest_file: bytes beyond which no file can grow, as on a full disk [bytes].
        signal: what it is sent, `after` seconds.
        limit: seconds of `--time-limit`.
    """

    topic: str
    arguments: tuple[str, ...]
    files: dict[str, bytes] = field(default_factory=dict)
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
    rng = random.Random(500)
    return [
        *_settings(rng),
        *_words(rng),
        *_gear_files(),
        *_study_files(rng),
        *_measured(),
        *_result_files(precious),
        *_disks(),
        *_environments(),
        *_signals(),
        *_distributions(),
        *_limits(),
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


def _gear_files() -> Iterator[BadInput]:
    for content in TOML:
        files = {"gear.toml": content.encode("latin-1", "replace")}
        yield BadInput("gear files", (*CHEAP, "--gear", "gear.toml"), files)


def _study_files(rng: random.Random) -> Iterator[BadInput]:
    """Shipped studies with a piece cut out, doubled or exchanged."""
    shipped = sorted((ROOT / "studies").glob("*.toml"))
    for number in range(80):
        text = rng.choice(shipped).read_text()
        first = rng.randrange(len(text))
        last = min(first + rng.randrange(1, 60), len(text))
        middle = ("", text[first:last] * 2, rng.choice(VALUES))[number % 3]
        content = (text[:first] + middle + text[last:]).encode("utf-8", "replace")
        yield BadInput("study files", ("study", "s.toml", "--dry-run"), {"s.toml": content})
    for toml in TOML[:20]:
        files = {"s.toml": toml.encode("latin-1", "replace")}
        yield BadInput("study files", ("study", "s.toml", "--dry-run"), files)


def _measured() -> Iterator[BadInput]:
    for content in TABLES:
        files = {"m.csv": content.encode()}
        yield BadInput("measured curves", (*CHEAP, "--measured", "m.csv"), files)


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
    for arguments in (
        ("geometry", "--out", "a.glb"),
        ("geometry", "--out", "a.png"),
        ("report", "precious.h5"),
    ):
        yield BadInput("disk", arguments, largest_file=2000)


def _environments() -> Iterator[BadInput]:
    for environment in ENVIRONMENTS:
        yield BadInput("environment", CHEAP, environment=environment)
    for environment in CACHES:
        yield BadInput("cache", CHEAP, environment=environment)


def _signals() -> Iterator[BadInput]:
    for number, name in enumerate(SIGNALS):
        yield BadInput("signals", LONG, signal=name, after=6.0 + number)
        yield BadInput("signals", (*LONG, "--time-limit", "60 s"), signal=name, after=7.0 + number)


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


def stands_in(folder: Path, bad: BadInput, precious: bytes) -> None:
    """Write the files that a bad input finds in its folder."""
    (folder / "precious.h5").write_bytes(precious)
    for name, content in bad.files.items():
        (folder / name).write_bytes(content)
