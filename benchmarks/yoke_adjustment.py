"""Gears of unknown setting that are measured, fitted and adjusted once, as the fit's line states.

No measurement stands behind these numbers. The gears are drawn from the set `unknown`: a workshop has no
drawing. 14 parameters vary, of which a fit has six; it expects the default gear. The truth has another
contact law (teeth) than the fit, and the record has noise, repeatability, an error of its zero and steps.
Limits are those that ship with the package, and with them the rotation torque of a manual of a gear without
assistance. After its adjustment each gear is simulated again.
"""

import tomllib
from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.topic import ROOT, Topic, digits, load_data, markdown, save_data
from rps_exudyn.assessment.requirements.judging import settings_of_test
from rps_exudyn.base.units import to_si
from rps_exudyn.inference.fitting.adjustment import Adjustment, adjustment_of
from rps_exudyn.inference.fitting.bench_tests import measurement_of
from rps_exudyn.inference.fitting.fit import fit
from rps_exudyn.inference.uncertainty.input_sets import uncertain_inputs
from rps_exudyn.inference.uncertainty.samples import Samples
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.limit import Limit
from rps_exudyn.results.requirements import read_limits
from rps_exudyn.scenes.yoke_setting import turned_back
from rps_exudyn.simulate.run import simulate
from rps_exudyn.solvers.yoke_stop import lift_of_torque
from verification.made_up_curves import FREE, BenchNoise, measured_curve, with_noise

DATA, SCENE = "yoke_adjustment.json", "free-pinion-torque"
MANUAL = ROOT / "validation" / "suzuki-rotation" / "row.toml"
NOISE = BenchNoise(0.01, step=0.005, repeatability=0.02, zero=0.02)
LIMITED = {
    "free_torque": "torque_mean",
    "variation_on_centre": "torque_on_centre_variation",
    "variation_off_centre": "torque_off_centre_variation",
}
"""Requirement -> the metric that it limits."""
STATES = {"before": "before", "plug": "after the plug's turn", "spring": "after plug or spring"}


def limit_sets() -> dict[str, Mapping[str, Limit]]:
    """Name -> requirement -> limit."""
    manual = tomllib.loads(MANUAL.read_text(encoding="utf-8"))["data"]
    low, high = (to_si(manual[end], "N*m") for end in ("low", "high"))
    shipped = read_limits()
    return {
        "shipped": shipped,
        f"mean of {low:g} to {high:g} N m": shipped | {"free_torque": Limit(low, high, "manual")},
    }


def run(folder: Path, gears: int = 200, seed: int = 11) -> None:
    """Adjust each gear once by each set of limits; keep what it was and what it is then."""
    expected, cases = SteeringGear(), []
    points = Samples.drawn(uncertain_inputs(expected, "unknown", {}), gears, seed)
    for number, settings in enumerate(points.settings()):
        test = settings_of_test(expected, SCENE, 1.0) | {"mesh.law": "teeth"}
        cases.append(case(expected.replace(settings | test), np.random.default_rng([seed, number])))
        print(number, cases[-1]["before"], flush=True)
    save_data(folder / DATA, {"cases": cases})


def case(gear: SteeringGear, random: np.random.Generator) -> dict[str, Any]:
    """Measure, fit and adjust a gear; return its torque before and after, and what the line stated."""
    before, curve = state_of(gear)
    found: dict[str, Any] = {"before": before, "adjusted": {}}
    found["depth"] = gear.pinion.runout - gear.yoke.clearance
    fitted = fit(measurement_of([measured_curve(with_noise(curve, NOISE, random), FREE)]), other_law=False)
    for name, limits in limit_sets().items():
        line = adjustment_of(fitted, limits)
        assert line is not None
        found["adjusted"][name] = adjusted(gear, line)
        contact = line.contact
    if contact:
        ends = [contact.depth * np.exp(sign * 1.96 * contact.depth_sd) for sign in (-1, 1)]
        found["contact"] = {"depth": contact.depth, "interval": ends}
    return found


def adjusted(gear: SteeringGear, line: Adjustment) -> dict[str, Any]:
    """Return a gear's states after what is to be done of the adjustment, and the contact's depth then [m]."""
    turned = turned_back(gear, line.turn)
    found: dict[str, Any] = {"left": gear.pinion.runout - turned.yoke.clearance}
    if line.turn:
        found["plug"] = state_of(turned)[0]
    if line.spring_change:
        force = turned.yoke.preload * (1 + line.spring_change)
        found["spring"] = state_of(turned.replace({"yoke.preload": force}))[0]
    return found


def states_of(case: Mapping[str, Any], name: str) -> dict[str, Mapping[str, float]]:
    """Return the states of a gear by a set of limits; without an adjustment it stays as it is."""
    found = {"before": case["before"]}
    found["plug"] = case["adjusted"][name].get("plug", found["before"])
    return found | {"spring": case["adjusted"][name].get("spring", found["plug"])}


def state_of(gear: SteeringGear) -> tuple[dict[str, float], dict[str, np.ndarray]]:
    """Return requirement -> value of a gear, and its free torque.

    Raises:
        RuntimeError: the simulation fails.
    """
    result = simulate(SCENE, gear, Fidelity.preset("quasi-static"))
    if result.status != "ok":
        raise RuntimeError(f"{result.status}: {result.message}")
    values = {name: abs(result.summary[metric]) for name, metric in LIMITED.items()}
    values["rated_lift"] = lift_of_torque(gear, gear.test.lift_torque)
    rounded = {name: float(f"{value:.6g}") for name, value in values.items()}
    return rounded, {"pinion_angle": result["pinion_angle"], "value": result["pinion_torque"]}


def missed(state: Mapping[str, float], limits: Mapping[str, Limit]) -> list[str]:
    """Names of the requirements that a gear does not keep."""
    return [name.replace("_", " ") for name, value in state.items() if not limits[name].keeps(value)]


def shares_table(folder: Path) -> str:
    """Gears within limits before and after, of all and of those whose plunger touches the plug."""
    cases = load_data(folder / DATA)["cases"]
    groups = {"all gears": cases, "plunger touches the plug": [each for each in cases if each["depth"] > 0]}
    rows = []
    for name, limits in limit_sets().items():
        for words, group in groups.items():
            states = [states_of(each, name) for each in group]
            kept = (sum(not missed(state[key], limits) for state in states) for key in STATES)
            rows.append(
                (name, words, len(group), *(f"{digits(100 * n / max(len(group), 1), 3)} %" for n in kept))
            )
    return markdown(("limits", "of", "number", *STATES.values()), rows)


def causes_table(folder: Path) -> str:
    """Causes of what is beyond limits after the adjustment."""
    cases, rows = load_data(folder / DATA)["cases"], []
    for name, limits in limit_sets().items():
        causes: Counter[str] = Counter()
        for each in cases:
            if beyond := missed(states_of(each, name)["spring"], limits):
                unseen = (
                    "contact with the plug not seen" if "contact" not in each else "plug turned too little"
                )
                causes[unseen if each["adjusted"][name]["left"] > 0 else ", ".join(beyond)] += 1
        texts = (f"{number} {cause}" for cause, number in causes.most_common())
        rows.append((name, "; ".join(texts) or "none"))
    return markdown(("limits", "gears beyond them after the adjustment"), rows)


def contacts_table(folder: Path) -> str:
    """How often a contact is seen, by its depth, and how often the interval of the depth holds it."""
    cases, rows = load_data(folder / DATA)["cases"], []
    for words, low, high in (
        ("none", -1.0, 0.0),
        ("to 4 \u00b5m", 0.0, 4e-6),
        ("above 4 \u00b5m", 4e-6, 1.0),
    ):
        group = [each for each in cases if low < each["depth"] <= high]
        seen = [each for each in group if "contact" in each]
        holds = sum(e["contact"]["interval"][0] <= e["depth"] <= e["contact"]["interval"][1] for e in seen)
        rows.append((words, len(group), len(seen), holds if low >= 0 else ""))
    return markdown(("depth of the contact", "gears", "seen", "interval holds"), rows)


TOPIC = Topic(
    takes="2 min",
    folder="fit",
    run=run,
    toy={"gears": 2},
    tables={
        "yoke_adjustment": shares_table,
        "yoke_adjustment_causes": causes_table,
        "yoke_contacts": contacts_table,
    },
)
