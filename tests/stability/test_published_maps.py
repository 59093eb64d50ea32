"""What results/stability publishes is complete, and agrees with what docs/stability.md says of it."""

import json
from pathlib import Path
from typing import Any

import pytest

PUBLISHED = Path(__file__).parents[2] / "results" / "stability"
MAPS = [
    "step_stiffness",
    "step_speed",
    "step_zone",
    "step_inertia",
    "step_segments",
    "step_stiffness_spheres",
    "tolerance_segments",
    "preload_stiffness",
    "radius_preload",
]


def published(name: str) -> Any:
    return json.loads((PUBLISHED / f"{name}.json").read_text())


@pytest.mark.parametrize("name", MAPS)
def test_every_cell_of_a_map_is_computed(name: str) -> None:
    assert (PUBLISHED / f"{name}.png").exists()
    for found in published(name)["maps"]:
        assert len(found["cells"]) == len(found["y"])
        for row in found["cells"]:
            assert len(row) == len(found["x"])
            assert "not computed" not in row
        assert found["lines"]
        assert all(len(line["y"]) == len(found["x"]) for line in found["lines"])


@pytest.mark.parametrize("name", MAPS)
def test_no_wrong_cell_would_be_called_ok(name: str) -> None:
    """Guards or judge object to every wrong cell of the solvers that are offered."""
    for found in published(name)["maps"]:
        for cells, told in zip(found["cells"], found["told"], strict=False):
            assert all(is_told for cell, is_told in zip(cells, told, strict=True) if cell == "wrong")


def test_explicit_limits_are_within_10_percent_of_the_predicted_ones() -> None:
    limits = published("explicit")
    assert len(limits) >= 40
    for limit in limits:
        assert limit["measured"] / limit["predicted"] == pytest.approx(1.0, abs=0.1), limit
