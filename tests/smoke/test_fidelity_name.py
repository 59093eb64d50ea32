"""The name of a fidelity never hides what was changed in it."""

from rps_exudyn.parameters.fidelity import Fidelity


def test_name_says_what_was_changed() -> None:
    changed = Fidelity.preset("full").replace({"bush": "condensed"})
    assert changed.name == "full with bush condensed"
    assert changed.replace({"step_angle": "0.1 deg"}).name == "full with bush condensed, step_angle 0.1 deg"
    assert changed.replace({}) == changed
