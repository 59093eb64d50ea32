"""The command line `rps-exudyn`: run, show, geometry, describe.

Exit status: 0 done; 1 the simulation failed (its file says how); 2 wrong input, one sentence for each problem
on standard error. What a command needs is imported by the command, so that `--help` and `describe` are quick.
"""

import sys
import tomllib
from collections.abc import Iterable, Sequence
from contextlib import redirect_stdout
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import App, CycloptsError, Parameter, UnusedCliTokensError

from rps_exudyn.errors import InputError

if TYPE_CHECKING:
    from rps_exudyn.parameters import SteeringGear
    from rps_exudyn.result import Result

DONE, FAILED, WRONG_INPUT, INTERRUPTED = 0, 1, 2, 130

RESULT_FILES = (".h5", ".hdf5")

app = App(
    name="rps-exudyn",
    help="Rack-and-pinion steering gears: pinion torque, its variation, and how far to trust it.",
    version=lambda: version("rps-exudyn"),
)

Flag = Annotated[bool, Parameter(negative=(), show_default=False)]


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return the exit status."""
    try:
        return app(arguments, exit_on_error=False, print_error=False, result_action="return_value") or DONE
    except InputError as error:
        return _refuse(error.problems)
    except CycloptsError as error:
        return _refuse([_sentence(error)])
    except KeyboardInterrupt:
        _say("interrupted; nothing was written.")
        return INTERRUPTED


@Parameter(name="*")
@dataclass(frozen=True)
class GearOptions:
    """Which gear."""

    gear: Path | None = None
    """TOML file of the gear; without it the paper's gear."""
    settings: Annotated[tuple[str, ...], Parameter(name="--set", negative=(), show_default=False)] = ()
    """PATH=VALUE: one parameter replaced, for instance --set yoke.preload="400 N"; may be repeated."""

    def load(self) -> "SteeringGear":
        """The gear, or an InputError with everything that is wrong with it."""
        from rps_exudyn.parameters import SteeringGear

        settings, malformed = _settings(self.settings)
        try:
            if self.gear is None:
                gear = SteeringGear.from_tables({}, settings)
            else:
                gear = SteeringGear.from_toml(self.gear, settings)
        except InputError as error:
            raise InputError(malformed + error.problems) from None
        if malformed:
            raise InputError(malformed)
        return gear


PAPER_GEAR = GearOptions()


@app.command
def run(
    scene: str = "free-pinion-torque",
    /,
    *,
    gear: GearOptions = PAPER_GEAR,
    fidelity: str = "full",
    mesh: str | None = None,
    bush: str | None = None,
    solver: str | None = None,
    out: Path | None = None,
    plot: Path | None = None,
    json: Flag = False,
) -> int:
    """Simulate one scene: print a summary, write an HDF5 file and a picture.

    A failed run never replaces an existing file: it is written beside it as NAME.failed.

    Args:
        scene: what the test rig does.
        fidelity: what is modelled how.
        mesh: contact of the teeth, if other than the fidelity's.
        bush: model of the bush, if other than the fidelity's.
        solver: solver, if other than the fidelity's.
        out: HDF5 file; without it SCENE.h5 in the current folder.
        plot: picture (.png, .svg, .pdf); without it a .png beside the HDF5 file.
        json: print the summary as JSON.
    """
    from rps_exudyn import simulate
    from rps_exudyn.charts.style import PICTURES
    from rps_exudyn.fidelity import Fidelity

    chosen = gear.load()
    parts = {"mesh": mesh, "bush": bush, "solver": solver}
    model = Fidelity.preset(fidelity).replace({part: name for part, name in parts.items() if name})
    out = _checked_output(out or Path(f"{scene}.h5"), RESULT_FILES)
    plot = _checked_output(plot or out.with_suffix(".png"), PICTURES)
    with redirect_stdout(sys.stderr):  # what libraries say; standard output is for the result
        result = simulate.run(scene, chosen, fidelity=model)
    _print_result(result, json, files=_keep(result, out, plot))
    return _verdict(result)


@app.command
def show(file: Path, /, *, json: Flag = False) -> int:
    """Print the summary of a result.

    Args:
        file: HDF5 file that `run` wrote.
        json: print it as JSON.
    """
    from rps_exudyn.result import load

    _print_result(load(file), json)
    return DONE


@app.command
def geometry(
    *, gear: GearOptions = PAPER_GEAR, out: Path | None = None, force: Flag = False, json: Flag = False
) -> int:
    """Print the geometry report; write the solids or their drawing.

    Args:
        out: solids (.glb, .stl) or drawing (.png, .svg, .pdf).
        force: build an undercut gear all the same.
        json: print the report as JSON.
    """
    from rps_exudyn import printed
    from rps_exudyn.charts.geometry import draw_geometry
    from rps_exudyn.charts.style import PICTURES
    from rps_exudyn.gears.checks import geometry_report
    from rps_exudyn.gears.export import FORMATS, export_solids

    chosen = gear.load()
    if out:
        _checked_output(out, (*FORMATS, *PICTURES))
    report = geometry_report(chosen, force)
    if out and out.suffix.lower() in FORMATS:
        export_solids(chosen, out)
    elif out:
        draw_geometry(chosen, out, force)
    files = [out] if out else []
    if json:
        printed.print_json(report.as_dict() | {"files": files})
    else:
        printed.print_geometry(report, files)
    return DONE


@app.command
def describe(path: str = "", /, *, gear: GearOptions = PAPER_GEAR, json: Flag = False) -> int:
    """Print parameters: value, unit, meaning, and where the value is from.

    Args:
        path: a parameter such as yoke.preload, or a table such as yoke; without it all.
        json: print them as JSON.
    """
    from rps_exudyn import printed
    from rps_exudyn.parameters import SteeringGear

    items = SteeringGear.declared_at(path)
    if json:
        printed.print_json(printed.parameters_as_dict(gear.load(), items))
    else:
        printed.print_parameters(gear.load(), items)
    return DONE


# --- input -------------------------------------------------------------------------------------


def _settings(texts: Iterable[str]) -> tuple[dict[str, Any], list[str]]:
    """Path -> value from PATH=VALUE texts, and a sentence for each text that is not of this form."""
    settings, malformed = {}, []
    for text in texts:
        path, _, value = text.partition("=")
        if path.strip() and value.strip():
            settings[path.strip()] = _value(value.strip())
        else:
            malformed.append(f"--set {text} is no setting; write PATH=VALUE, for instance yoke.preload=400.")
    return settings, malformed


def _value(text: str) -> Any:
    """What reads as a TOML value (6, -1, true) is that, anything else is text ("400 N")."""
    try:
        tables = tomllib.loads(f"value = {text}")
    except tomllib.TOMLDecodeError:
        return text
    return tables["value"] if len(tables) == 1 else text


def _checked_output(path: Path, suffixes: tuple[str, ...]) -> Path:
    from rps_exudyn.atomic import check_writable

    if path.suffix.lower() not in suffixes:
        raise InputError(f"{path} cannot be written: its name must end in {' or '.join(suffixes)}.")
    check_writable(path)
    return path


# --- output ------------------------------------------------------------------------------------


def _keep(result: "Result", out: Path, plot: Path) -> list[Path]:
    """Write both files and return where they are; a failed run does not replace existing ones."""
    from rps_exudyn.charts.torque import draw_torque
    from rps_exudyn.outcome import Status

    if result.status is not Status.OK and (out.exists() or plot.exists()):
        out, plot = (path.with_suffix(f".failed{path.suffix}") for path in (out, plot))
    result.save(out)
    if not result.signals:
        return [out]
    draw_torque(result, plot)
    return [out, plot]


def _print_result(result: "Result", json: bool, files: Iterable[Path] = ()) -> None:
    from rps_exudyn import printed

    if json:
        printed.print_json(printed.result_as_dict(result, files))
    else:
        printed.print_result(result, files)


def _verdict(result: "Result") -> int:
    from rps_exudyn.outcome import Status

    if result.status is Status.OK:
        return DONE
    _say(f"the simulation failed ({result.status}): {result.message.rstrip('.')}. {result.status.remedy}")
    return FAILED


def _sentence(error: CycloptsError) -> str:
    """What the command line's grammar does not allow."""
    if isinstance(error, UnusedCliTokensError):
        surplus = " ".join(error.unused_tokens or ())
        return f"{surplus} is more than the command takes; --help shows what it takes."
    return " ".join(str(error).split())


def _refuse(problems: Iterable[str]) -> int:
    for problem in problems:
        _say(problem)
    return WRONG_INPUT


def _say(sentence: str) -> None:
    print(f"rps-exudyn: {sentence}", file=sys.stderr)
