"""An accuracy, and metrics, that cannot be asked for: one sentence from command and Python alike."""

from typing import Any

import pytest

import rps_exudyn as rps
from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.simulate.by_accuracy import percent


@pytest.mark.parametrize("text", ["1", "", "%", "-1%", "0%", "nan%", "1e999%", "one%"])
def test_no_percentage(text: str) -> None:
    with pytest.raises(InputError, match="a percentage greater than 0, for instance 1%"):
        percent(text)
    assert percent("0.1 %") == 0.1


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ({"accuracy": "1%", "fidelity": Fidelity()}, "accuracy chooses the model itself"),
        ({"accuracy": "1%", "fidelity": "fast"}, "fidelity is 'fast'; it must be one of"),
        ({"accuracy": "1%", "metrics": "torque_mean"}, "metrics is torque_mean; it must be a list of names"),
        ({"metrics": ["torque_mean"]}, "metrics are those that accuracy keeps; give accuracy"),
    ],
)
def test_python_refuses_it(asked: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=said):
        rps.run("free-pinion-torque", **asked)


def test_metrics_that_the_scene_does_not_have() -> None:
    """Which these are is known from its first run."""
    with pytest.raises(InputError, match=r"hysteresis_area, which is no metric of .*; take torque_mean"):
        rps.run("free-pinion-torque", accuracy="1%", metrics=["hysteresis_area"], turns=0.1)
