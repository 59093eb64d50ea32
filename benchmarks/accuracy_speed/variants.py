"""Models of other physics than the chart's first reference: each is compared with its own, much finer.

That reference integrates the law `area` in three independent ways. Other contact laws, racks that bend and
friction that remembers have another torque; their reference is that of their own equilibria and dynamics in
fine steps, so that their points show the numerical error alone.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache

from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.verification.references import Method, as_run, by_strips, moving, reference_of
from rps_exudyn.verification.runs import SceneReference

PARTS = ("mesh", "yoke", "bush", "bearing")


@dataclass(frozen=True)
class Variant:
    """Settings of the gear and of the model that make another torque."""

    gear: Mapping[str, object]
    fidelity: Mapping[str, object] = field(default_factory=dict)

    def methods(self) -> dict[str, Method]:
        """Return the methods of its reference, of which the last works in another way than the others."""
        return {
            "equilibria, 12 stations, 0.1 deg": as_run(by_strips("0.1 deg").replace(self.fidelity)),
            "equilibria, 10 stations, 0.2 deg": as_run(
                by_strips("0.2 deg").replace({"strip_stations": 10, **self.fidelity})
            ),
            "Exudyn, 12 stations, 0.5 deg": as_run(moving("0.5 deg", 1e-5).replace(self.fidelity)),
        }


LINE = {"mesh.law": "line"}
VARIANTS = {
    "line": Variant(LINE),
    "teeth": Variant({"mesh.law": "teeth"}),
    "bending rack": Variant(LINE | {"rack.modes": 12}, {"rack": "flexible"}),
    "bristles": Variant(LINE | {f"{part}.friction_law": "bristle" for part in PARTS}),
}


def variant_of(gear: SteeringGear, fidelity: Fidelity) -> str:
    """Return the name of the variant that a model belongs to; "" for that of the chart's first reference."""
    if fidelity.solver == "closed-form":
        return ""
    if fidelity.rack == "flexible":
        return "bending rack"
    if gear.mesh.friction_law == "bristle":
        return "bristles"
    return "" if gear.mesh.law == "area" else gear.mesh.law


def of_family(family: str) -> str:
    """Return the variant of a family, named behind its comma; "" if it is of none."""
    name = family.rpartition(", ")[2]
    return name if name in VARIANTS else ""


@cache
def reference_of_variant(scene: str, name: str) -> SceneReference:
    """Return the reference of a variant's default gear."""
    variant = VARIANTS[name]
    return reference_of(scene, SteeringGear().replace(dict(variant.gear)), variant.methods())
