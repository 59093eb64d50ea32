"""The force laws are called without Python code on the way to the compiled one."""

import sys
from types import FrameType
from typing import Any

import numpy as np

from rps_exudyn.base.compiled import ready
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.solvers.gear_forces import gear_forces


def test_types_of_a_laws_arguments_are_read_without_python() -> None:
    """Numba takes an exception on its way to an argument's type for a missing type: an alarm or Ctrl-C that
    Python hears there would be lost. Without Python code there is no place to hear one."""
    balance = gear_forces(SteeringGear(), Fidelity.preset("flank")).statics
    law, total, tangent = ready(balance.law), np.empty(8), np.zeros((8, 8))
    state = np.zeros(8), np.zeros(8), balance.gears, 0, balance.pool, balance.works
    law(*state, 1.0, 0.0, total, tangent)
    called: list[str] = []

    def note(frame: FrameType, event: str, argument: Any) -> None:
        if event == "call":
            called.append(frame.f_code.co_qualname)

    sys.setprofile(note)
    try:
        law(*state, 1.0, 0.0, total, tangent)
    finally:
        sys.setprofile(None)
    assert called == ["line_gear"]  # the compiled law itself
    assert np.isfinite(total).all()
