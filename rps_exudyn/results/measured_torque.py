"""A measured torque curve, as a result keeps it beside its own signals."""

from dataclasses import dataclass, field

import h5py
import numpy as np

from rps_exudyn.results.quantities import SIGNALS

GROUP = "measured"  # of a result's file
KEPT = ("pinion_angle", "pinion_torque")


@dataclass(frozen=True, eq=False)
class MeasuredTorque:
    """A measured curve in SI units, in the order of its file."""

    name: str
    signals: dict[str, np.ndarray]  # pinion_angle [rad], pinion_torque [N m], shape (n,); or of a rack push
    assumed: tuple[str, ...] = ()  # what the reading of the file took for granted
    beside: dict[str, np.ndarray] = field(default_factory=dict)  # clock [s], speed [rad/s], line; (n,)
    left_out: tuple[str, ...] = ()  # those of `assumed` that say which rows of the file are no part of it

    def write(self, file: h5py.File) -> None:
        """Write name, angle and torque as a group of a result's file."""
        group = file.create_group(GROUP)
        group.attrs["name"] = self.name
        for name in KEPT:
            dataset = group.create_dataset(name, data=np.asarray(self.signals[name], dtype=float))
            dataset.attrs["units"] = SIGNALS[name].unit
            dataset.attrs["long_name"] = SIGNALS[name].long_name

    @classmethod
    def read(cls, file: h5py.File) -> "MeasuredTorque | None":
        """The curve in a result's file; None of a file without one.

        Raises:
            ValueError: the group is there and holds no curve.
        """
        if GROUP not in file:
            return None
        name, signals = file[GROUP].attrs["name"], {each: file[GROUP][each][()] for each in KEPT}
        angle, torque = signals.values()
        if not isinstance(name, str) or angle.ndim != 1 or angle.shape != torque.shape or angle.size < 2:
            raise ValueError(f"{GROUP} holds no curve")
        if not all(values.dtype.kind == "f" and np.isfinite(values).all() for values in signals.values()):
            raise ValueError(f"{GROUP} holds no numbers")
        return cls(name, signals)
