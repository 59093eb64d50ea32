"""The force laws are called without Python code on the way to a kernel's data."""

import sys
from types import FrameType
from typing import Any

import numpy as np

from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.solvers.gear_forces import gear_forces


def test_type_of_a_handle_is_read_without_python() -> None:
    """Numba takes an exception on its way to a handle's type for a missing type: an alarm or Ctrl-C that
    Python hears there would be lost. Without Python code there is no place to hear one."""
    balance = gear_forces(SteeringGear(), Fidelity.preset("flank")).statics
    state = np.zeros(8), np.zeros(8)
    balance.force(*state, balance.data)
    called: list[str] = []

    def note(frame: FrameType, event: str, argument: Any) -> None:
        if event == "call":
            called.append(frame.f_code.co_qualname)

    sys.setprofile(note)
    try:
        balance.force(*state, balance.data)
    finally:
        sys.setprofile(None)
    assert called  # what numba itself calls is seen
    assert [name for name in called if name.endswith("_numba_type_")] == []
