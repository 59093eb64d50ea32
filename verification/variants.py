"""Models of other physics than the chart's first reference: each is compared with its own, much finer.

That reference integrates the law `area` in three independent ways. Other contact laws, racks that bend and
friction with a state or that falls with speed have another torque; their reference is that of their own
equilibria and dynamics in fine steps, so that their points show the numerical error alone.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache

from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.friction_law import RUBBING_PARTS
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes import scene_named
from verification.references import Method, as_run, by_strips, moving, reference_of, slowly
from verification.runs import SceneReference


@dataclass(frozen=True)
class Variant:
    """Settings of the gear and of the model that make another torque."""

    gear: Mapping[str, object]
    fidelity: Mapping[str, object] = field(default_factory=dict)

    def methods(self, scene: str) -> dict[str, Method]:
        """Return the methods of its reference, of which the last works in another way than the first."""
        if scene_named(scene).at_rest:
            return {
                f"{stations} x {points} points": as_run(self._finely(stations, points))
                for stations, points in ((12, 6), (10, 5))
            }
        return self._swung(scene) if scene_named(scene).swings else self._turned()

    def _turned(self) -> dict[str, Method]:
        return {
            "equilibria, 12 stations, 0.1 deg": as_run(by_strips("0.1 deg").replace(self.fidelity)),
            "equilibria, 10 stations, 0.2 deg": as_run(
                by_strips("0.2 deg").replace({"strip_stations": 10, **self.fidelity})
            ),
            "Exudyn, 12 stations, 0.5 deg": as_run(moving("0.5 deg", 1e-5).replace(self.fidelity)),
        }

    def _swung(self, scene: str) -> dict[str, Method]:
        """Equilibria behind a column are those of the scene, which finds none in the shortest steps.

        Bristles of the teeth let a gear vibrate at 1 kHz in steps below 0.1 deg, by a quarter of its torque;
        these steps damp that, and equilibria have no vibration.
        """
        still, shortest = (slowly, "0.01 deg") if scene == "reversal" else (as_run, "0.02 deg")
        vibrates = self.gear.get("mesh.friction_law") == "bristle"
        moved = {
            f"Exudyn, 12 stations, {step}": as_run(moving(step, 1e-5).replace(self.fidelity))
            for step in (["0.1 deg"] if vibrates else ["0.01 deg", "0.02 deg"])
        }
        balanced = {
            f"equilibria, 12 stations, {step}": still(by_strips(step).replace(self.fidelity))
            for step in [shortest, *(["0.05 deg"] if vibrates else [])]
        }
        return balanced | moved if vibrates else moved | balanced

    def _finely(self, stations: int, points: int) -> Fidelity:
        strips = {"strip_stations": stations, "strip_points": points}
        return Fidelity.preset("quasi-static").replace({**strips, **self.fidelity})


LINE = {"mesh.law": "line"}
BRISTLES = LINE | {f"{part}.friction_law": "bristle" for part in RUBBING_PARTS}
VARIANTS = {
    "line": Variant(LINE),
    "teeth": Variant({"mesh.law": "teeth"}),
    "triangles": Variant(LINE, {"mesh": "triangles", "chord_error": 3e-9}),
    "bending rack": Variant(LINE | {"rack.modes": 12}, {"rack": "flexible"}),
    "Stribeck": Variant(
        LINE
        | {f"{part}.friction_law": "stribeck" for part in RUBBING_PARTS}
        | {f"{part}.static_ratio": 1.3 for part in RUBBING_PARTS}
    ),
    "supported pinion": Variant(LINE, {"pinion": "supported"}),
    "bristles": Variant(BRISTLES),
    "four bristles": Variant(BRISTLES, {"friction_elements": 4}),
}


def variant_of(gear: SteeringGear, fidelity: Fidelity) -> str:
    """Return the name of the variant that a model belongs to; "" for that of the chart's first reference."""
    if fidelity.solver == "closed-form":
        return ""
    if fidelity.mesh == "triangles":
        return "triangles"
    if fidelity.rack == "flexible":
        return "bending rack"
    if fidelity.pinion == "supported":
        return "supported pinion"
    if gear.mesh.friction_law != "coulomb":
        bristles = "four bristles" if fidelity.friction_elements == 4 else "bristles"
        return {"stribeck": "Stribeck", "bristle": bristles}[gear.mesh.friction_law]
    return "" if gear.mesh.contact_law == "area" else gear.mesh.contact_law


def of_family(family: str) -> str:
    """Return the variant of a family, named behind its comma; "" if it is of none."""
    name = family.rpartition(", ")[2]
    return name if name in VARIANTS else ""


@cache
def reference_of_variant(scene: str, name: str) -> SceneReference:
    """Return the reference of a variant's default gear."""
    variant = VARIANTS[name]
    return reference_of(scene, SteeringGear().replace(dict(variant.gear)), variant.methods(scene))
