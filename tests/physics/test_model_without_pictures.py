"""A model that is only solved has no shapes to show, and weighs the same."""

from typing import Any

import numpy as np
import pytest

from rps_exudyn.gears.solids import plunger_solid
from rps_exudyn.multibody.bodies import shapes_of
from rps_exudyn.multibody.model import build_model
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear

GEAR = SteeringGear()


def bodies_of(pictured: bool) -> tuple[dict[str, dict[str, Any]], list[Any]]:
    """What Exudyn holds of each body, and the shapes that its viewer shows of the plunger."""
    model = build_model(GEAR, Fidelity.preset("flank"), pictured=pictured)
    found = {name: model.mbs.GetObject(number) for name, number in model.bodies.items()}
    shapes = shapes_of(model, plunger_solid, "orange")
    model.release()
    return found, shapes


def test_model_without_pictures_weighs_the_same() -> None:
    """To rounding: the plunger's mass is declared, and its solid's density follows from it."""
    (shown, shapes), (solved, none) = bodies_of(True), bodies_of(False)
    assert shown["rack"]["mass"] == solved["rack"]["mass"] > 1.0
    assert shown["pinion"]["inertia"] == solved["pinion"]["inertia"] > 0.0
    assert plunger_solid(GEAR).mass_properties.mass == pytest.approx(solved["plunger"]["mass"], rel=1e-13)
    assert len(shapes) == 1
    assert np.size(shapes[0]["triangles"]) == plunger_solid(GEAR).faces.size
    assert none == []
