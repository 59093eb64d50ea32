"""A rack that is not straight in a yoke with little clearance: when the yoke stops, and what that does.

The pinion is turned over the middle of the rack's travel, where the bar stands with its bow towards the yoke
or away from it. The torque varies by the bow and by the stopping yoke together; service manuals allow racks
bent by 0.15 to 0.3 mm and a variation of 0.4 to 0.7 N m. Clearance of the plunger in its bore shows what a
plunger does that cannot tilt: the slope of the bar lifts it by half of the seat's length times the slope.
"""

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

import rps_exudyn as rps
from benchmarks.topic import Topic, load_data, markdown, save_data, shown
from rps_exudyn.base.errors import InputError
from rps_exudyn.pages.charts import style
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Status

BOWS = tuple((np.arange(7) * 0.05e-3).tolist())  # [m]
CLEARANCES = (20e-6, 35e-6, 50e-6, 80e-6, 110e-6, 150e-6)  # [m]
ALLOWED = (0.4, 0.7)  # variation of the torque that manuals allow [N m]
TURNS = 3.0  # about the middle of the travel
MODEL = Fidelity.preset("quasi-static").replace({"rack": "flexible", "step_angle": "3 deg"})
BASE: dict[str, object] = {"test.turns": TURNS, "test.start_angle": -np.pi * TURNS, "rack.modes": 4}
BORES = (0.0, 0.05e-3, 0.1e-3, 0.2e-3)  # clearances of the plunger in its bore [m]
TILTED = ((0.15e-3, 20e-6), (0.3e-3, 20e-6), (0.3e-3, 50e-6))  # bow and clearance of the yoke [m]
DATA = "bow.json"
PICTURE = "bow.png"


def run(
    folder: Path,
    bows: tuple[float, ...] = BOWS,
    clearances: tuple[float, ...] = CLEARANCES,
    bores: tuple[float, ...] = BORES,
) -> None:
    """Sweep the bow [m] for each clearance [m], and the plunger's clearance in its bore; keep and draw it."""
    cases = shown(measured(bow, clearance) for clearance in clearances for bow in bows)
    tilted = [measured(*case, bore) for bore in bores for case in TILTED]
    save_data(folder / DATA, {"cases": cases, "tilted": tilted})
    style.save(picture(cases), folder / PICTURE)


def measured(bow: float, clearance: float, bore: float = 0.0) -> dict[str, Any]:
    """One case: variation of the torque, the share of the travel with a stopped yoke, its largest force."""
    case: dict[str, Any] = {"bow": bow, "clearance": clearance, "bore": bore}
    yoke = {"yoke.clearance": clearance, "yoke.bore_clearance": bore}
    gear = SteeringGear().replace({**BASE, **yoke, "rack.bow": bow})
    try:
        result = rps.run("free-pinion-torque", gear, fidelity=MODEL)
    except InputError as error:
        return case | {"message": str(error)}
    if result.status is not Status.OK:
        return case | {"message": f"{result.status}: {result.message}"}
    return case | {
        "variation": result.summary["torque_peak_to_peak"],
        "stopped": float(np.mean(result["yokenut_force"] > 0)),
        "nut_force": float(result["yokenut_force"].max()),
    }


def picture(cases: list[dict[str, Any]]) -> Figure:
    """Variation of the torque over the bow, one curve for each clearance, and what manuals allow."""
    figure, (axes,) = style.panels([4.2])
    clearances = clearances_shown(cases)
    for colour, clearance in zip(style.SEVERAL, clearances, strict=False):
        known = [case for case in cases if case["clearance"] == clearance and "variation" in case]
        bow, varies = ([case[name] for case in known] for name in ("bow", "variation"))
        label = f"clearance {1e6 * clearance:.0f} µm{' or more' if clearance == clearances[-1] else ''}"
        axes.plot(1e3 * np.array(bow), varies, "o-", color=colour, markersize=3, label=label)
    axes.axhspan(*ALLOWED, **style.BAND, label="allowed by manuals")
    axes.axvspan(0.15, 0.3, color="#38761d", alpha=0.08, linewidth=0, label="bow allowed by manuals")
    axes.set_yscale("log")
    axes.set_xlabel("bow of the toothed part [mm]")
    axes.set_ylabel("variation of the pinion torque [N m]")
    axes.legend(fontsize=8, ncols=2)
    style.title(figure, "A bent rack in its yoke: variation of the free pinion torque over three turns")
    return figure


def clearances_shown(cases: list[dict[str, Any]]) -> list[float]:
    """Clearances at which the yoke stops, and the first one at which it does not: larger ones are like it."""
    stops = [case["clearance"] for case in cases if case.get("stopped")]
    clearances = sorted({case["clearance"] for case in cases})
    return clearances[: sum(each <= max(stops, default=0.0) for each in clearances) + 1]


def tilt_table(folder: Path) -> str:
    """Variation of the torque by the clearance of the plunger in its bore; bold where the yoke stops."""
    tilted = load_data(folder / DATA)["tilted"]
    rows = []
    for bore in sorted({case["bore"] for case in tilted}):
        cells = [_cell(case) for case in tilted if case["bore"] == bore]
        rows.append([f"{1e3 * bore:.2f}", *cells])
    heads = [f"bow {1e3 * bow:.2f} mm, {1e6 * clearance:.0f} µm" for bow, clearance in TILTED]
    return markdown(["clearance in the bore mm", *heads], rows)


def _cell(case: dict[str, Any]) -> str:
    if "variation" not in case:
        return "*no equilibrium*" if "no-convergence" in case["message"] else "*refused*"
    text = f"{case['variation']:.3f}"
    return f"**{text}** ({case['stopped']:.0%}, {case['nut_force']:.0f} N)" if case["stopped"] else text


TOPIC = Topic(
    "1 min",
    "flexible_rack",
    run,
    {"bows": (0.0, 0.1e-3), "clearances": (50e-6,), "bores": (0.0,)},
    {"bow_tilt": tilt_table},
)
