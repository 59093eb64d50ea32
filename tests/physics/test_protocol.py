"""The predictions on the page of the measuring protocol: those of the closed form at drawn gears."""

import re
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from rps_exudyn.inference.fitting.bench_tests import named_test
from rps_exudyn.inference.fitting.prediction import formula_means
from rps_exudyn.inference.fitting.unknowns import LEVEL
from rps_exudyn.inference.uncertainty.input_sets import uncertain_inputs
from rps_exudyn.inference.uncertainty.samples import Samples
from rps_exudyn.parameters.gear import SteeringGear

PAGE = Path(__file__).parents[2] / "docs" / "measuring-protocol.md"
ROW = re.compile(
    r"^\| `(?P<test>[\w@-]+)` (?P<way>forth|back) \| (?P<numbers>[-0-9. |]+) \| (N m|N) \|$", re.M
)
SAMPLES = 1000


@cache
def predicted(test: str) -> np.ndarray:
    """Nominal value, 5 and 95 % of gears of the series, and of unknown gears, (5, ways); N m or N."""
    gear, (bench, _) = SteeringGear(), named_test(f"{test}=none")
    found = [np.array(formula_means(gear, bench))]
    for kind in ("series", "unknown"):
        joint = uncertain_inputs(gear, kind, {})
        inputs = replace(joint, each={path: each for path, each in joint.items() if path in LEVEL})
        points = Samples.drawn(inputs, SAMPLES, seed=1)
        values = [formula_means(gear.replace(point), bench) for point in points.settings()]
        found += [*np.quantile(values, [0.05, 0.95], axis=0)]
    return np.array(found)


@pytest.mark.parametrize(
    "row", list(ROW.finditer(PAGE.read_text("utf-8"))), ids=lambda row: f"{row['test']} {row['way']}"
)
def test_a_printed_prediction_is_that_of_the_closed_form(row: re.Match[str]) -> None:
    printed = [float(each) for each in re.findall(r"-?\d+\.?\d*", row["numbers"])]
    at = 0 if row["way"] == "forth" else 1
    assert printed == pytest.approx(predicted(row["test"])[:, at], rel=0.01, abs=0.002)


def test_all_tests_of_the_programme_are_predicted() -> None:
    rows = {row["test"] for row in ROW.finditer(PAGE.read_text("utf-8"))}
    assert rows == {
        "free",
        "yoke-out",
        "bearing",
        "rack-push",
        "rack-on-rollers",
        "load-test@70kg",
        "load-test@120kg",
    }
