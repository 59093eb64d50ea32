"""What limits accuracy besides numerics: torques by every contact law, cost over size; and their file."""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from rps_exudyn.base.atomic import replacing
from rps_exudyn.base.errors import InputError
from rps_exudyn.verification.work_precision import power_law

NAME = "limits.json"


@dataclass(frozen=True, eq=False)
class Limits:
    """Arrays over one tooth pitch, and series of sizes with their costs."""

    angle: np.ndarray  # (n,) [rad]
    torques: dict[str, np.ndarray]  # by law, (n,) [N m]
    default: str  # name of the package's law
    zones: list[tuple[float, float]]  # friction zone over the smallest sliding speed, mean off by [%]
    scaling: dict[str, tuple[np.ndarray, np.ndarray]]  # sizes, CPU seconds, (m,) each

    @property
    def exponents(self) -> list[float]:
        """p of cost ~ size^p, series by series."""
        return [power_law(size, cost)[0] for size, cost in self.scaling.values()]

    def save(self, folder: Path) -> None:
        """Whole or not at all.

        Raises:
            InputError: the file cannot be written.
        """
        told = {
            "angle": np.round(self.angle, 6).tolist(),
            "torques": {name: np.round(values, 7).tolist() for name, values in self.torques.items()},
            "default": self.default,
            "zones": self.zones,
            "scaling": {name: [size.tolist(), cost.tolist()] for name, (size, cost) in self.scaling.items()},
            "exponents": dict(zip(self.scaling, self.exponents, strict=True)),
        }
        with replacing(folder / NAME) as partial:
            partial.write_text(json.dumps(told) + "\n")


def load_limits(folder: Path) -> Limits:
    """What `save` wrote.

    Raises:
        InputError: it is not there, or damaged.
    """
    path = folder / NAME
    try:
        told = json.loads(path.read_text(encoding="utf-8"))
        return Limits(
            np.array(told["angle"]),
            {name: np.array(values) for name, values in told["torques"].items()},
            told["default"],
            [(zone, off) for zone, off in told["zones"]],
            {name: (np.array(size), np.array(cost)) for name, (size, cost) in told["scaling"].items()},
        )
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise InputError(f"{path} is no file of studies/accuracy_limits.py: {error}.") from error
