"""The options of the command line that concern measured files."""

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from rps_exudyn.base.errors import InputError
from rps_exudyn.cli.kept import say

if TYPE_CHECKING:
    from rps_exudyn.results.result import MeasuredTorque

Columns = Annotated[
    tuple[str, ...],
    Parameter(
        name="--column",
        negative=(),
        show_default=False,
        help='QUANTITY="TITLE [unit]": which column of a measured file holds what, where its header does not '
        'tell, for instance --column pinion_torque="M2 [N cm]"; may be repeated.',
    ),
]

Priors = Annotated[
    tuple[str, ...],
    Parameter(
        name="--prior",
        negative=(),
        show_default=False,
        help='PATH="VALUE +- DEVIATION": what is expected of a parameter and its standard deviation, for '
        'instance --prior yoke.preload="300 N +- 10 %"; may be repeated.',
    ),
]

Freed = Annotated[
    tuple[str, ...],
    Parameter(
        name="--free",
        negative=(),
        show_default=False,
        help="PATH of a parameter that is fitted, instead of the usual ones, such as --free bush.drag; may "
        "be repeated.",
    ),
]


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


def read_measured(path: Path, columns: Sequence[str]) -> "MeasuredTorque":
    """The measured torque in a file; what was assumed is said on standard error.

    Raises:
        InputError: no such file, or one that is no curve.
    """
    from rps_exudyn.measured.reading import read_measured_torque

    measured = read_measured_torque(path, chosen_columns(columns))
    say(f"{path}: {'; '.join(measured.assumed)}.")
    return measured
