"""The laws "teeth" and "line" against finite elements of whole teeth, on named gears.

The reference replaces the compliance of the teeth by that of elements (`law_elements`), with more stations on
a line, in the same runs: free torque with plain flanks and with tip relief and crowning, and a load. Beside
them stand the yields along the lines of contact, of pinion and rack apart, and what finer elements change.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import nullcontext
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

import rps_exudyn as rps
from benchmarks.measure import quickest
from benchmarks.topic import Columns, Topic, load_data, markdown, save_data, table_of
from rps_exudyn.analysis.rack_motion import rack_poses
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.pages.charts import style
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.law_error import WITHIN, law_error, tip_truncation
from rps_exudyn.results.result import Result
from rps_exudyn.solvers.gear_forces import exchanged
from rps_exudyn.tooth_contact.line_loads import loads_data
from verification.law_elements import by_elements, line_yields, one_body, pool_of
from verification.tooth_elements import Division

DATA, CHART = "elements.json", "yields.png"
GEARS: Mapping[str, Sequence[float]] = {
    "default": (6, 1.83, 25, 10, 1.0, 18.2, 14, 24, 8.5),
    "A": (6, 1.83, 25, 10, 0.65, 17.6, 14, 24, 8.5),
    "D": (5, 2.20, 20, 5, 0.85, 18.4, 16, 24, 8.5),
    "E": (6, 1.75, 30, 8, 1.0, 18.2, 16, 24, 8.5),
    "F": (7, 1.60, 27, 8, 0.6, 17.0, 18, 24, 8.5),
    "P": (5, 2.10, 36, 0, 0.7, 19.6, 16, 24, 8.5),
    "R": (7, 1.80, 15, 15, 0.6, 18.2, 18, 24, 8.5),
    "S": (6, 2.00, 20, 0, 0.85, 19.2, 17, 26, 9.0),
    "T": (8, 1.50, 32, 6, 0.5, 18.6, 15, 22, 7.6),
    "U": (7, 1.90, 22, 4, 0.75, 20.6, 20, 28, 9.8),
    "V": (5, 1.75, 33, 12, 1.0, 16.4, 13, 22, 7.8),
}
"""Name -> z, m_n [mm], beta_p, beta_r [deg], x, d_a, b, bar, reference line above its axis [mm]."""
FORMS: Mapping[str, Mapping[str, object]] = {
    "plain": {},
    "relief 10 um over 1.5 mm, crowning 8 um": {
        "pinion.tip_relief": "10 um",
        "pinion.tip_relief_length": "1.5 mm",
        "pinion.crowning": "8 um",
    },
}
LOAD = 2000 / 9.80665  # of the load test [kg]
COARSE, FINE = Division(flank=3, along=8, half_tooth=1, fillet=1, root=1, core=2), Division()
ANGLES = 12  # over a pitch, at which yields are compared
FLANKS = "same flank", "opposite flank"
RACKS = "guided", "free"
SHARES = 0.5, 0.95  # quantiles of the errors of yields
PRESETS, REPEATS = ("quasi-static", "flank"), 4  # of the cost
QUASI_STATIC = Fidelity.preset("quasi-static")
REFERENCE, FINE_STATIONS = "elements", {"strip_stations": 8}


def gear_of(name: str) -> SteeringGear:
    """Return a named gear for one tooth pitch."""
    z, m, helix, tooth, shift, *sizes = GEARS[name]
    tip, face, bar, line = (1e-3 * size for size in sizes)
    pinion = {"teeth": int(z), "normal_module": 1e-3 * m, "helix_angle": f"{helix} deg"}
    pinion |= {"profile_shift": shift, "tip_diameter": tip, "face_width": face}
    rack = {"tooth_angle": f"{tooth} deg", "bar_diameter": bar, "reference_height": line}
    gear: dict[str, object] = {f"pinion.{name}": value for name, value in pinion.items()}
    gear |= {f"rack.{name}": value for name, value in rack.items()}
    gear |= {"bush.inner_diameter": 1e-3 * (sizes[2] + 1), "test.turns": 1 / z, "test.start_angle": 0.0}
    return SteeringGear().replace(gear)


def run(
    folder: Path, gears: Sequence[str] = tuple(GEARS), coarse: Division = COARSE, fine: Division = FINE
) -> None:
    """Compare the laws on these gears; what the file has already is kept."""
    file, first = folder / DATA, gear_of(gears[0])
    found = load_data(file) if file.exists() else {"gears": {}}
    rows = {name: found["gears"].setdefault(name, {}) for name in gears}
    work = [(row, case, make) for name, row in rows.items() for case, make in cases_of(gear_of(name), coarse)]
    work.append((found, "cost", lambda: cost(first.replace({"test.turns": 1.0}))))
    work.append((found, "finer", lambda: numbers(free(first, "guided", REFERENCE, fine))))
    work.append((found, "course", lambda: yields(first, coarse)[1]))
    for row, case, make in work:
        if case not in row:
            row[case] = make()
            save_data(file, {key: value for key, value in found.items() if key != "origin"})
    draw(found["course"], folder / CHART)


# --- runs ----------------------------------------------------------------------------------------------
def cases_of(gear: SteeringGear, division: Division) -> Iterator[tuple[str, Callable[[], Any]]]:
    """What is compared of a gear: its name, and what makes its numbers."""
    for form, settings in FORMS.items():
        formed = gear.replace(settings)
        for rack in RACKS:
            yield f"{form}, {rack}", partial(by_laws, partial(free, formed, rack), division)
    yield "loaded", partial(by_laws, partial(loaded, gear), division)
    yield "yields", lambda: yields(gear, division)[0]


def by_laws(of_law: Callable[[str, Division], Result], division: Division) -> dict[str, Any]:
    """Numbers of a case by the reference and by both laws."""
    return {law: numbers(of_law(law, division)) for law in (REFERENCE, "teeth", "line")}


def expected(name: str, form: str) -> float | None:
    """The error that law "line" states of a gear's mean free torque."""
    error = law_error(gear_of(name).replace({"mesh.law": "line", **FORMS[form]}), QUASI_STATIC.model_dump())
    return error.expected if error else None


def run_by(scene: str, gear: SteeringGear, rack: str, law: str, division: Division) -> Result:
    """A run by a law, or by "teeth" with the compliance of elements."""
    elastic = law == REFERENCE
    model = QUASI_STATIC.replace({"rack": rack, **(FINE_STATIONS if elastic else {})})
    with exchanged(by_elements(division)) if elastic else nullcontext():
        return rps.run(scene, gear.replace({"mesh.law": "teeth" if elastic else law}), fidelity=model)


def free(gear: SteeringGear, rack: str, law: str, division: Division) -> Result:
    """The free torque over one pitch."""
    return run_by("free-pinion-torque", gear, rack, law, division)


def loaded(gear: SteeringGear, law: str, division: Division) -> Result:
    """The load test over one pitch, the rack guided."""
    return run_by("load-test", gear.replace({"test.load_mass": LOAD}), "guided", law, division)


def cost(gear: SteeringGear) -> dict[str, dict[str, Any]]:
    """Least CPU time of the solver [s] over a turn, and the steps of both its levels: preset -> law."""

    def least(preset: str, law: str) -> dict[str, float]:
        by_law = gear.replace({"mesh.law": law})
        best = quickest(lambda: rps.run("free-pinion-torque", by_law, fidelity=preset), REPEATS)
        steps = best["pinion_angle"].size - 1
        return {"seconds": best.counters["solver_cpu"], "steps": steps + steps // 2}

    return {preset: {law: least(preset, law) for law in ("line", "teeth")} for preset in PRESETS}


def numbers(result: Result) -> dict[str, Any]:
    """What is compared of a run; its message where it failed."""
    names = (MEAN, RIPPLE, EFFICIENCY)
    found: dict[str, Any] = {name: result.summary[name] for name in names if name in result.summary}
    if "rack_y" in result.signals:
        found["approach"] = -float(np.mean(result["rack_y"]))
    if EFFICIENCY in found:
        raising = slice(0, result["pinion_angle"].size // 2)
        travel = result.summary["rack_gain"] / (2 * np.pi) * result["pinion_angle"]
        found["lag"] = float(np.mean((travel - result["rack_displacement"])[raising]))
    return found | ({} if result.status is rps.Status.OK else {"message": result.message})


# --- yields along the lines of contact -----------------------------------------------------------------
class Line(NamedTuple):
    """A line of contact under an even load on it, or on the opposite flank of its tooth."""

    flank: str
    place: np.ndarray  # along it [m]
    law: np.ndarray  # yields [m^2/N]
    elastic: np.ndarray


def yields(gear: SteeringGear, division: Division) -> tuple[dict[str, Any], list[Any]]:
    """Errors of yields by law over the largest by elements of their line, the pinion's with the twist of its
    core: median and 95 % quantile per body and flank; and the lines of the first pose."""
    result = run_by("free-pinion-torque", gear, "guided", "teeth", division)
    pair, handle = GearPair.of(gear), loads_data(gear).records
    points, tilts, _ = rack_poses(pair, result.signals)
    chosen = np.linspace(0, len(points) - 1, ANGLES + 1).astype(int)[:-1]
    errors: dict[str, list[float]] = {}
    course = []
    for body in ("pinion", "rack"):
        arguments = one_body(handle, pool_of(pair.design, division), body)
        for k in chosen:
            at = line_yields(-float(result["pinion_angle"][k]), points[k], tilts[k], *arguments)
            for line in along_lines(at, body):
                off = np.abs(line.law - line.elastic) / np.abs(line.elastic).max()
                errors.setdefault(f"{body}, {line.flank}", []).extend(off.tolist())
                if k == chosen[0]:
                    course.append([body, *(x if isinstance(x, str) else x.tolist() for x in line)])
    found = {name: np.quantile(values, SHARES).tolist() for name, values in errors.items()}
    return found, course


def along_lines(at: Any, body: str) -> Iterator[Line]:
    """Each line under 1 N/m on it, and on the other flank of its tooth of a body."""
    teeth = at.tooth if body == "pinion" else at.rack_tooth
    for side, tooth in sorted({(int(s), int(t)) for s, t in zip(at.side, teeth, strict=True)}):
        line = (at.side == side) & (teeth == tooth)
        place = np.cumsum(at.length[line]) - at.length[line] / 2
        for flank, other in zip(FLANKS, (side, -side), strict=True):
            load = np.where((at.side == other) & (teeth == tooth), at.length, 0.0)
            if load.any():
                yield Line(flank, place, (at.law @ load)[line], (at.elements @ load)[line])


# --- tables and chart ----------------------------------------------------------------------------------
LAWS = "teeth", "line"
MEAN, RIPPLE, EFFICIENCY = "torque_mean", "torque_peak_to_peak", "efficiency_forward"


def gears_of(folder: Path) -> Mapping[str, Any]:
    """Name of a gear -> its cases."""
    gears: Mapping[str, Any] = load_data(folder / DATA)["gears"]
    return gears


def off(case: Mapping[str, Any], law: str, name: str = MEAN) -> float:
    """A law's number over that by elements - 1; nan where one of them is missing."""
    return float(case[law].get(name, np.nan) / case[REFERENCE].get(name, np.nan) - 1)


def percent(value: float) -> str:
    """A difference in %."""
    return f"{100 * value:+.2f}"


def gears_table(folder: Path) -> str:
    """What the laws differ by over all gears, rack guided: plain, with forms, under a load."""
    gears = gears_of(folder)
    plain, formed = ([found[f"{form}, guided"] for found in gears.values()] for form in FORMS)
    differences = {
        "`teeth`, plain": [off(case, "teeth") for case in plain],
        "`teeth`, formed": [off(case, "teeth") for case in formed],
        "`line`, plain": [off(case, "line") for case in plain],
        "`line`, formed": [off(case, "line") for case in formed],
        "ripple of `teeth`, plain": [off(case, "teeth", RIPPLE) for case in plain],
        "ripple of `teeth`, formed": [off(case, "teeth", RIPPLE) for case in formed],
        "lag of `teeth` under 2 kN": [off(found["loaded"], "teeth", "lag") for found in gears.values()],
    }
    rows = [
        (name, percent(values[0]), *(percent(of(values)) for of in (np.nanmin, np.nanmedian, np.nanmax)))
        for name, values in differences.items()
    ]
    return markdown(("difference in %", "default gear", "smallest", "median", "largest"), rows)


def yields_table(folder: Path) -> str:
    """Errors of yields along lines of contact, medians over the gears and the worst of them."""
    gears = gears_of(folder).values()
    rows = []
    for name in next(iter(gears))["yields"]:
        errors = np.array([each["yields"][name] for each in gears if name in each["yields"]])
        cells = [f"{100 * of(errors[:, i]):.0f}" for i in range(len(SHARES)) for of in (np.median, np.max)]
        rows.append((name, *cells))
    head = "yield", "median error %", "of the worst gear %", "95 % below %", "of the worst gear %"
    return markdown(head, rows)


def summary_table(folder: Path) -> str:
    """What the laws are off by over all gears and flank forms."""
    gears = gears_of(folder).values()
    free_cases = [found[f"{form}, {rack}"] for found in gears for form in FORMS for rack in RACKS]
    guided = [found[f"{form}, guided"] for found in gears for form in FORMS]
    rows = []
    for law in LAWS:
        means = [off(case, law) for case in free_cases]
        shares = [1 + off(case, law, RIPPLE) for case in guided]
        loads = [(found["loaded"][law], found["loaded"][REFERENCE]) for found in gears]
        points = [one.get(EFFICIENCY, np.nan) - of.get(EFFICIENCY, np.nan) for one, of in loads]
        rms = f"(RMS {100 * np.sqrt(np.nanmean(np.square(means))):.2f})"
        spans = [_span(means, "+.2f"), _span(points, "+.2f"), _span(shares, ".0f")]
        rows.append((f"`{law}`", f"{spans[0]} {rms}", *spans[1:]))
    head = "law", "mean free torque %", "efficiency under 2 kN, points", "ripple, % of theirs"
    return markdown(head, rows)


def _span(values: Sequence[float], form: str) -> str:
    return f"{100 * np.nanmin(values):{form}} to {100 * np.nanmax(values):{form}}"


def finer_table(folder: Path) -> str:
    """What finer elements change on the default gear, rack guided."""
    data = load_data(folder / DATA)
    coarse = next(iter(data["gears"].values()))["plain, guided"][REFERENCE]
    names = {MEAN: "mean torque", RIPPLE: "ripple", "approach": "approach"}
    rows = [(title, percent(coarse[name] / data["finer"][name] - 1)) for name, title in names.items()]
    return markdown(("of elements as published", "from finer ones, %"), rows)


def cost_table(folder: Path) -> str:
    """CPU time of law "teeth" over that of law "line", single runs and a step of them."""
    rows = []
    for preset, found in load_data(folder / DATA)["cost"].items():
        line, teeth = (found[law] for law in ("line", "teeth"))
        cells = []
        for unit, name in ((1e3, "runs"), (1e6, "steps")):
            one, other = (unit * each["seconds"] / each.get(name, 1) for each in (line, teeth))
            cells += [f"{one:.3g}", f"{other:.3g}", f"{other / one:.1f}"]
        rows.append((f"`{preset}`", *cells))
    head = "preset", "run: line ms", "teeth ms", "ratio", "step: line us", "teeth us", "ratio"
    return markdown(head, rows)


def line_table(folder: Path) -> str:
    """Error of law "line" on plain flanks by the tips' truncation: as printed, and each gear left out of a
    fit of that formula to the others."""
    gears = gears_of(folder)
    t = np.array([tip_truncation(gear_of(name)) for name in gears])
    error = np.array([off(found["plain, guided"], "line") for found in gears.values()])
    rests = {"as printed": error - np.array([expected(name, "plain") for name in gears])}
    if t.size > 2:
        left = [np.polyfit(np.delete(t, i), np.delete(error, i), 1) for i in range(t.size)]
        fitted = [np.polyval(c, x) for c, x in zip(left, t, strict=True)]
        rests["each left out of the fit"] = error - fitted
    columns: Columns = {
        "error of `line` less the formula's": lambda row: row[0],
        "RMS %": lambda row: f"{100 * np.sqrt(np.mean(row[1] ** 2)):.2f}",
        "largest %": lambda row: f"{100 * np.abs(row[1]).max():.2f}",
        f"within {100 * WITHIN:g} %": lambda row: f"{(np.abs(row[1]) <= WITHIN).sum()} of {row[1].size}",
    }
    return table_of(rests.items(), columns)


def draw(course: Sequence[Any], path: Path) -> None:
    """Draw yields along the lines of contact of one pose: elements as marks, the law as lines."""
    with mpl.rc_context({"font.size": 9.5}):
        figure = Figure(figsize=(8.5, 6.5), layout="constrained")
        axes = dict(zip(("pinion", "rack"), figure.subplots(2, 1), strict=True))
    for body, axis in axes.items():
        for flank, colour in zip(FLANKS, style.SEVERAL, strict=False):
            for number, (_, _, place, law, elastic) in enumerate(
                line for line in course if (line[0], line[1]) == (body, flank)
            ):
                label = None if number else f"load on the {flank}"
                at = 1e3 * np.array(place)
                axis.plot(at, 1e12 * np.array(law), color=colour, linewidth=1.2)
                axis.plot(at, 1e12 * np.array(elastic), "o", color=colour, markersize=4, label=label)
        axis.set_title(body.capitalize(), loc="left", fontsize=10)
        axis.set_ylabel("yield [nm/(N/mm)]")
        axis.grid(color="#e4e4e4")
        axis.legend(loc="upper left", bbox_to_anchor=(1, 1), frameon=False)
    axes["rack"].set_xlabel("place along the line of contact [mm]")
    style.title(figure, "Lines under an even load: finite elements (marks), law teeth (lines)")
    style.save(figure, path)


TINY = Division(flank=1, along=2, half_tooth=1, fillet=1, root=1, core=1)
TOPIC = Topic(
    "5 min",
    "tooth_compliance",
    run,
    {"gears": ("default",), "coarse": TINY, "fine": TINY},
    {
        "laws_off": summary_table,
        "laws_gears": gears_table,
        "laws_yields": yields_table,
        "laws_line": line_table,
        "laws_cost": cost_table,
        "elements_finer": finer_table,
    },
)
