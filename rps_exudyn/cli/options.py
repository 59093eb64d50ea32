"""The options of several commands: gear and model, uncertain inputs, columns of measured files, JSON."""

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import check_depth
from rps_exudyn.base.units import short, to_si
from rps_exudyn.cli.output import note

if TYPE_CHECKING:
    from rps_exudyn.inference.uncertainty.joint import JointInputs
    from rps_exudyn.parameters.gear import Setup, SteeringGear

Flag = Annotated[bool, Parameter(negative=(), show_default=False)]


def _flag(name: str, help: str) -> Parameter:
    """An option without a value, or one that may be repeated."""
    return Parameter(name=name, negative=(), show_default=False, help=help)


Json = Annotated[bool, _flag("--json", "Print the result as JSON.")]
All = Annotated[bool, _flag("--all", "Print every number.")]

Jobs = Annotated[
    int | None, Parameter(help="Number of processes; default: one per processor, where that is faster.")
]

Inputs = Annotated[
    str | None,
    Parameter(
        help="Uncertain inputs: series (scatter about this gear), unknown (any gear with such teeth) or own "
        '(only parameters given as "300 N +- 30 N"). Default: own if there are any, else series.'
    ),
]

Columns = Annotated[
    tuple[str, ...],
    _flag(
        "--column",
        'QUANTITY="TITLE [unit]": column of the measured file that holds a quantity, where the header '
        'does not state it, for instance --column pinion_torque="M2 [N cm]"; may be repeated.',
    ),
]

Priors = Annotated[
    tuple[str, ...],
    _flag(
        "--prior",
        'PATH="VALUE +- DEVIATION": what is expected of a parameter and its standard deviation, for '
        'instance --prior yoke.preload="300 N +- 10 %"; may be repeated.',
    ),
]

Freed = Annotated[
    tuple[str, ...],
    _flag(
        "--free",
        "PATH of a parameter that is fitted, instead of the usual ones, such as --free bush.drag; "
        "bow and angle error beside them; may be repeated.",
    ),
]


@Parameter(name="*")
@dataclass(frozen=True)
class Printing:
    """Options that choose what is printed of a sheet."""

    every: All = False
    quiet: Flag = False
    """Print only errors."""
    json: Json = False

    def check(self) -> None:
        """Refuse options that contradict each other.

        Raises:
            InputError: they do.
        """
        if self.quiet and (self.every or self.json):
            raise InputError("--quiet prints nothing but errors; leave out --all and --json.")


HEAD_ALONE = Printing()


@Parameter(name="*")
@dataclass(frozen=True)
class GearOptions:
    """Options that choose the gear."""

    gear: Path | None = None
    """TOML file of the gear; default: the gear of the paper."""
    settings: Annotated[tuple[str, ...], Parameter(name="--set", negative=(), show_default=False)] = ()
    """PATH=VALUE: replace one parameter, for instance --set yoke.preload="400 N"; may be repeated."""

    def load(self) -> "SteeringGear":
        """The gear."""
        from rps_exudyn.parameters.gear import SteeringGear

        settings, malformed = parse_settings(self.settings)
        with _reporting_together(malformed):
            return SteeringGear.from_tables(self.tables(), settings, where=str(self.gear or ""))

    def states(self, path: str) -> bool:
        """Whether the gear's file or a setting gives a parameter."""
        table, name = path.split(".")
        return path in parse_settings(self.settings)[0] or name in self.tables().get(table, {})

    def carried(self) -> "JointInputs":
        """Path -> distribution of the parameters that carry one, or samples of a fit."""
        from rps_exudyn.inference.uncertainty.input_sets import carried

        return carried(self.tables(), parse_settings(self.settings)[0])

    def drawn(self) -> "JointInputs":
        """The same for a band; on standard error, which settings part samples of a fit that vary together."""
        own = self.carried()
        if own.parted:
            note(
                f"{', '.join(own.parted)}: the setting replaces samples of the fit, which vary together with "
                f"those of {', '.join(own.posterior)}; apart from each other they make the band wider."
            )
        return own

    def say_medians(self) -> None:
        """Name on standard error the parameters that carry a distribution, of which the median is taken."""
        own = self.carried()
        if paths := [path for path in own if path not in own.posterior]:
            note(
                f"{', '.join(paths)}: the run uses the median of the distribution; --band computes the band."
            )

    def tables(self) -> dict[str, Any]:
        """The tables of the gear's file; {} without one."""
        from rps_exudyn.parameters.gear import SteeringGear

        return SteeringGear.tables_in(self.gear) if self.gear else {}


@Parameter(name="*")
@dataclass(frozen=True)
class SetupOptions(GearOptions):
    """Options that choose the gear and its model."""

    fidelity: str | None = None
    """Model preset: full, flank (default), quasi-static, reduced or closed-form; see `describe fidelity`."""
    mesh: str | None = None
    """Contact model of the teeth (overrides --fidelity): general-contact, triangles or flank."""
    bush: str | None = None
    """Bush model (overrides --fidelity): chain, condensed or rigid."""
    yoke: Annotated[str | None, Parameter(show=False)] = None
    """Model of the yoke, of which `body` remains."""
    rack: str | None = None
    """Rack model (overrides --fidelity): by-scene, free, guided or flexible."""
    pinion: str | None = None
    """Pinion support (overrides --fidelity): by-scene, rigid or supported."""
    solver: str | None = None
    """Solver (overrides --fidelity): generalized-alpha, equilibrium, reduced or closed-form."""

    def load(self) -> "Setup":
        """Gear and fidelity, or an InputError with everything that is wrong with both."""
        from rps_exudyn.parameters.fidelity import PRESETS, preset_table, unknown_preset
        from rps_exudyn.parameters.gear import Setup

        settings, problems = parse_settings(self.settings)
        settings |= {f"fidelity.{part}": choice for part, choice in self._parts().items()}
        tables = self.tables()
        if "fidelity" in tables:
            problems.append(
                f"{self.gear}: fidelity is no table of a gear; choose it by --fidelity and --set."
            )
        for path in ("fidelity.name", "fidelity.based_on"):
            if settings.pop(path, None):
                problems.append(f"{path} cannot be set: it names what was chosen.")
        base = self.fidelity or "flank"
        if base not in PRESETS:
            problems.append(unknown_preset(base))
        preset = preset_table(base) if base in PRESETS else {}
        with _reporting_together(problems):
            return Setup.from_tables(tables | {"fidelity": preset}, settings, where=str(self.gear or ""))

    def preset_alone(self) -> str | None:
        """The preset named, or None: the only choice of the model that --accuracy allows.

        Raises:
            InputError: single choices of the model, which --accuracy makes itself.
        """
        if own := self.choices():
            raise InputError(f"--accuracy chooses the model itself; leave out {', '.join(own)}.")
        return self.fidelity

    def choices(self) -> list[str]:
        """The options that choose single parts of the model."""
        settings, _ = parse_settings(self.settings)
        own = [f"--{part}" for part in self._parts()]
        return own + [f"--set {path}" for path in settings if path.startswith("fidelity.")]

    def _parts(self) -> dict[str, str]:
        """The options that choose a part of the fidelity, by its name there."""
        parts = {part: getattr(self, part) for part in ("mesh", "bush", "yoke", "rack", "pinion", "solver")}
        return {part: choice for part, choice in parts.items() if choice is not None}


PAPER_GEAR, PAPER_SETUP = GearOptions(), SetupOptions()


def parse_settings(texts: Iterable[str]) -> tuple[dict[str, Any], list[str]]:
    """Path -> value from PATH=VALUE texts, and a sentence for each text that is not of this form."""
    settings, malformed = {}, []
    for text in texts:
        path, _, value = text.partition("=")
        if value.strip() and all(name.strip() for name in path.split(".")):
            settings[path.strip()] = _value(value.strip())
        else:
            malformed.append(
                f"--set {short(text)} is no setting; write PATH=VALUE, for instance yoke.preload=400."
            )
    return settings, malformed


def _value(text: str) -> Any:
    """The TOML value (6, -1, true) that the text reads as, else the text itself ("400 N")."""
    import tomllib

    try:
        tables = tomllib.loads(f"value = {text}")
        check_depth(tables, "a value")
    except (ValueError, RecursionError):  # no TOML, a number with more digits than Python reads, too deep
        return text
    return tables["value"] if len(tables) == 1 else text


@contextmanager
def _reporting_together(problems: list[str]) -> Iterator[None]:
    """Raise these problems, and those of the block's own InputError, as one InputError."""
    try:
        yield
    except InputError as error:
        raise InputError(problems + error.problems) from None
    if problems:
        raise InputError(problems)


def rated_torque_of(text: str) -> float:
    """Return the torque that --rated-torque gives [N m].

    Raises:
        InputError: the text is no torque.
    """
    try:
        return to_si(text, "N*m")
    except ValueError as error:
        raise InputError(f"--rated-torque {error}.") from None


def chosen_columns(texts: Iterable[str]) -> Mapping[str, str]:
    """Quantity -> title and unit.

    Raises:
        InputError: a text that is not of the form QUANTITY=TITLE.
    """
    chosen = {}
    for text in texts:
        name, equals, title = text.partition("=")
        if not (equals and title.strip()):
            raise InputError(
                f'--column {text} is no choice; write QUANTITY="TITLE [unit]", for instance '
                '--column pinion_torque="M2 [N cm]".'
            )
        chosen[name.strip()] = title.strip()
    return chosen
