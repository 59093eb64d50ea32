"""Parameters that follow from others where nobody gives them, so that teeth and module can be varied alone.

    pinion.tip_diameter     standard addendum h_aP, shortened until the crest is as wide as usual
    pinion.shaft_diameter   as large a part of the root diameter as on the default gear
    rack.reference_height   teeth that reach as far towards the bar's surface as those of the default gear

What is given stays. A given value counts as not given where a setting changes one of the others and it is
what would have followed before: the shipped gear file states 18.2 mm, which follows from its teeth.
"""

import math
from collections.abc import Callable, Mapping
from functools import cache
from typing import Any, NamedTuple

from rps_exudyn.base import units

DIGITS = 8  # of a metre: derived lengths are rounded to 10 nm
SAME = 0.5e-8  # [m]
LARGEST = 10.0  # beyond it something else is wrong [m]


class Teeth(NamedTuple):
    """What teeth and bar are derived from, SI; the defaults are those of the default gear."""

    teeth: float = 6
    module: float = 1.83e-3
    pressure_angle: float = math.radians(20)
    helix_angle: float = math.radians(25)
    profile_shift: float = 1.0
    addendum: float = 1.0  # of the basic rack, in modules
    dedendum: float = 1.25
    bar_diameter: float = 24e-3

    @property
    def reference_radius(self) -> float:
        """r_p = z m_n / (2 cos beta_p) [m]."""
        return self.teeth * self.module / (2 * math.cos(self.helix_angle))

    @property
    def root_radius(self) -> float:
        """r_p + x m_n - h_fP m_n [m]."""
        return self.reference_radius + (self.profile_shift - self.dedendum) * self.module

    def crest(self, radius: float) -> float:
        """Normal tooth thickness at a radius [m], in modules: s_n = 2 R psi_R cos beta_R (ISO 21771)."""
        alpha_t = math.atan(math.tan(self.pressure_angle) / math.cos(self.helix_angle))
        base = self.reference_radius * math.cos(alpha_t)
        alpha = math.acos(min(base / radius, 1.0))
        half = (math.pi / 2 + 2 * self.profile_shift * math.tan(self.pressure_angle)) / self.teeth
        half += (math.tan(alpha_t) - alpha_t) - (math.tan(alpha) - alpha)
        beta = math.atan(math.tan(self.helix_angle) * radius / self.reference_radius)
        return 2 * radius * half * math.cos(beta) / self.module


DEFAULT = Teeth()
_TIP, _SHAFT, _HEIGHT = 18.2e-3, 11e-3, 8.5e-3  # of the default gear [m]

SOURCES = {
    "pinion.teeth": "teeth",
    "pinion.normal_module": "module",
    "pinion.pressure_angle": "pressure_angle",
    "pinion.helix_angle": "helix_angle",
    "pinion.profile_shift": "profile_shift",
    "basic_rack.addendum": "addendum",
    "basic_rack.dedendum": "dedendum",
    "rack.bar_diameter": "bar_diameter",
}
"""Path of a parameter -> its name in `Teeth`."""
_UNITS = {"module": "m", "bar_diameter": "m", "pressure_angle": "rad", "helix_angle": "rad"}


def tip_diameter(gear: Teeth) -> float:
    """Tip diameter d_a [m]."""
    standard = gear.reference_radius + (gear.profile_shift + gear.addendum) * gear.module
    if gear.crest(standard) >= _default_crest():
        return 2 * standard
    low, high = gear.reference_radius, standard  # the crest narrows from one to the other
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if gear.crest(middle) > _default_crest() else (low, middle)
    return 2 * low


def shaft_diameter(gear: Teeth) -> float:
    """Diameter of the shaft that carries the gear [m]."""
    return _SHAFT * gear.root_radius / DEFAULT.root_radius


def reference_height(gear: Teeth) -> float:
    """Height of the rack's reference line above the bar's axis [m]."""
    reach = (_HEIGHT + DEFAULT.addendum * DEFAULT.module) / DEFAULT.bar_diameter
    return reach * gear.bar_diameter - gear.addendum * gear.module


DERIVED: Mapping[str, Callable[[Teeth], float]] = {
    "pinion.tip_diameter": tip_diameter,
    "pinion.shaft_diameter": shaft_diameter,
    "rack.reference_height": reference_height,
}


@cache
def _default_crest() -> float:
    return DEFAULT.crest(_TIP / 2)


def derived_values(tables: Mapping[str, Any]) -> dict[str, float]:
    """Path -> value [m] of what follows from the tables of a gear; {} where they are no gear.

    Wrong values are left to the gear's own checks.
    """
    teeth = {}
    for path, name in SOURCES.items():
        if (value := value_in(tables, path)) is not None:
            try:
                teeth[name] = units.to_si(value, _UNITS.get(name, ""))
            except ValueError:
                return {}
    try:
        values = {path: round(rule(Teeth(**teeth)), DIGITS) for path, rule in DERIVED.items()}
    except (ArithmeticError, ValueError):
        return {}
    return {path: value for path, value in values.items() if 0 < value < LARGEST}


def completed(tables: Mapping[str, Any]) -> dict[str, Any]:
    """The tables with what follows from them and is not given; as they are where none of its sources is."""
    missing = [path for path in DERIVED if value_in(tables, path) is None]
    if not missing or all(value_in(tables, path) is None for path in SOURCES):
        return dict(tables)
    values = derived_values(tables)
    return with_values(tables, {path: values[path] for path in missing if path in values})


def without_followers(tables: Mapping[str, Any], settings: Mapping[str, Any]) -> dict[str, Any]:
    """The tables without values that follow from the others, where settings change one of those."""
    if not any(path in SOURCES for path in settings):
        return dict(tables)
    values = derived_values(tables)
    return with_values(
        tables,
        {path: None for path, value in values.items() if path not in settings and _is(tables, path, value)},
    )


def _is(tables: Mapping[str, Any], path: str, value: float) -> bool:
    try:
        given = units.to_si(value_in(tables, path), "m")
    except ValueError:
        return False
    return abs(given - value) < SAME


def value_in(tables: Mapping[str, Any], path: str) -> Any:
    """The value at a dotted path of nested tables, as dictionaries or models; None where there is none."""
    value: Any = tables
    for name in path.split("."):
        value = value.get(name) if isinstance(value, Mapping) else getattr(value, name, None)
    return value


def with_values(tables: Mapping[str, Any], values: Mapping[str, Any]) -> dict[str, Any]:
    """The tables with values at dotted paths of two names replaced; None takes one away."""
    changed = dict(tables)
    for path, value in values.items():
        table, _, name = path.partition(".")
        if not isinstance(changed.get(table, {}), Mapping):
            continue
        inner = {**changed.get(table, {}), name: value}
        changed[table] = {key: item for key, item in inner.items() if item is not None}
    return changed
