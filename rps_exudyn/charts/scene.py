"""Which picture suits a result: one for each scene, chosen here."""

from collections.abc import Callable
from pathlib import Path

from matplotlib.figure import Figure

from rps_exudyn.analysis.measured import MeasuredTorque
from rps_exudyn.charts import style
from rps_exudyn.charts.impact import impact_figure
from rps_exudyn.charts.load_test import load_test_figure
from rps_exudyn.charts.rack_push import rack_push_figure
from rps_exudyn.charts.reversal import reversal_figure
from rps_exudyn.charts.torque import torque_figure
from rps_exudyn.results.result import Result

PICTURES: dict[str, Callable[[Result, MeasuredTorque | None], Figure]] = {
    "free-pinion-torque": torque_figure,
    "load-test": load_test_figure,
    "rack-push": rack_push_figure,
    "reversal": reversal_figure,
    "yoke-impact": impact_figure,
}


def draw(result: Result, path: str | Path, measured: MeasuredTorque | None = None) -> None:
    """Save the picture of a result that has signals, a measured torque over it if there is one.

    Raises:
        InputError: the file cannot be written.
    """
    style.save(PICTURES.get(result.scene, torque_figure)(result, measured), path)
