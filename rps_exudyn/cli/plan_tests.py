"""The command `plan-tests`: which tests, how often and in which order, reach the wanted intervals."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rps_exudyn.base.screen import shown_progress
from rps_exudyn.cli.options import PAPER_GEAR, GearOptions, Json
from rps_exudyn.cli.output import DONE, FAILED, present
from rps_exudyn.results.sheet import Block, Grid, Line, Sheet, Text

if TYPE_CHECKING:
    from rps_exudyn.inference.fitting.plan import Plan


def plan_tests(
    *targets: str, gear: GearOptions = PAPER_GEAR, minutes: Path | None = None, json: Json = False
) -> int:
    """Plan the tests of `fit` that reach the wanted intervals in the least time.

    The exit status is 1 if no number of runs reaches a target.

    Args:
        targets: PATH=HALF, half the 95 % interval over the value, such as yoke.preload=15% mesh.friction=25%;
            default: those of the verdict "found".
        minutes: TOML file of the bench's times: [free], setup = 5, run = 5, in minutes.
    """
    from rps_exudyn.inference.fitting.plan import MINUTES, parse_targets, plan, read_minutes

    wanted = parse_targets(targets)
    times = read_minutes(minutes) if minutes else MINUTES
    with shown_progress(asked=False):
        found = plan(wanted, gear.load(), times)

    def data() -> dict[str, Any]:
        tests = [
            {
                "test": each.test.title,
                "runs": each.runs,
                "minutes": each.minutes,
                "halves": dict(each.half_intervals),
            }
            for each in found.tests
        ]
        return {"targets": wanted, "minutes": found.minutes, "tests": tests, "missed": found.missed}

    present(Sheet(text=_text(wanted, found), data=data), json=json)
    return FAILED if found.missed else DONE


def _text(wanted: Mapping[str, float], found: "Plan") -> Iterator[Block]:
    goals = ", ".join(f"{path} {_half(half)}" for path, half in wanted.items())
    yield Line(f"plan · wanted: {goals} · {found.minutes:.0f} minutes", is_bold=True)
    rows = [
        [
            each.test.title,
            f"{each.runs}",
            f"{each.minutes:.0f}",
            *(_half(each.half_intervals[path]) for path in wanted),
        ]
        for each in found.tests
    ]
    yield Grid(("test", "runs", "minutes", *(f"{path} after it" for path in wanted)), rows)
    for path, half in found.missed.items():
        yield Text(
            f"note: no number of runs brings {path} below {_half(half)} (wanted {100 * wanted[path]:.3g} %): "
            "what tests compare although nobody measured it is known no better"
        )


def _half(value: float) -> str:
    return f"+-{100 * value:.3g} %"
