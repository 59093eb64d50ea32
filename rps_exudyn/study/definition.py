"""A study as its file defines it: a base of gear and fidelity, and axes that vary it."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from rps_exudyn.parameters.derived import is_involved, with_values
from rps_exudyn.parameters.gear import Setup
from rps_exudyn.results.block import Keep
from rps_exudyn.study.description import Axis

FIDELITY = "fidelity."


@dataclass(frozen=True)
class Study:
    """The content of a study file. `tables` and `settings` make the base that the axes vary."""

    file: Path
    title: str
    scene: str
    tables: Mapping[str, Any]
    settings: Mapping[str, Any]
    axes: tuple[Axis, ...]
    design: str
    samples: int
    seed: int
    time_limit: float  # [s]
    keep: Keep
    blocks: bool | None = None  # whether cases are kept in blocks; None: if they are many

    @property
    def name(self) -> str:
        """The file's name without its suffix."""
        return self.file.stem

    @cached_property
    def base(self) -> Setup:
        """Gear and fidelity that the axes vary.

        Raises:
            InputError: parameters that are wrong.
        """
        return Setup.from_tables(self.tables, self.settings, where=str(self.file))

    def setup(self, settings: Mapping[str, Any]) -> Setup:
        """Return the base with these settings (path -> value).

        Raises:
            InputError: they do not fit each other.
        """
        return self.base.replace(settings, where=str(self.file))

    def tables_of(self, settings: Mapping[str, Any]) -> dict[str, Any]:
        """Return the tables of a setup that is known to be right, without another validation."""
        if any(is_involved(path) or path.count(".") != 1 for path in settings):
            return self.setup(settings).model_dump()  # what follows from the settings changes too
        return with_values(self._base_tables, settings)

    @cached_property
    def _base_tables(self) -> dict[str, Any]:
        """The base in SI, so that units are converted once and not in every case."""
        return self.base.model_dump()

    def toy(self) -> "Study":
        """The same study at the smallest size: two values of each axis, or four samples."""
        return replace(self, axes=tuple(_first_two(axis) for axis in self.axes), samples=min(self.samples, 4))


def choices(settings: Mapping[str, Any]) -> dict[str, Any]:
    """The settings of the fidelity, by their names within it."""
    return {
        path.removeprefix(FIDELITY): value for path, value in settings.items() if path.startswith(FIDELITY)
    }


def _first_two(axis: Axis) -> Axis:
    if axis.values is None:
        return axis
    along = {path: values[:2] for path, values in axis.along.items()}
    return replace(axis, values=axis.values[:2], along=along)
