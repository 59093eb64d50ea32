"""Laws of dry friction: Coulomb's with a zone about zero, Stribeck's, and bristles that remember.

A bristle is a spring across the contact that slides at its end (LuGre): with its deflection z over the
presliding displacement delta, the slip s, its direction d and Stribeck's curve g,

    dz = (ds - |ds| z / g) / delta,        friction = mu N (z + tau dz/dt),        stored = mu N delta z^2 / 2

(Canudas de Wit et al., IEEE Trans. Autom. Control 40 (1995), 419). Over a step of even slip its solution is

    z_1 = g d + (z_0 - g d) exp(-|s| / (delta g)),

exact, stable for any step, and independent of the rate where g is. What it loses, mu N |v| z^2 / g and the
damping's part, is never negative: the damping time is cut to 4 delta g / |v|.
"""

from typing import NamedTuple

import numpy as np

from rps_exudyn.base.compiled import borrowing, kernel
from rps_exudyn.forces.memory import NO_MEMORY, TIME, Memory
from rps_exudyn.parameters.friction_law import FrictionLaw

COULOMB, STRIBECK, BRISTLE = 0, 1, 2
KINDS = {"coulomb": COULOMB, "stribeck": STRIBECK, "bristle": BRISTLE}

# What a patch remembers, from its first column on: sums over its points of load times deflection, and load
ALONG, ACROSS, LOAD = 0, 1, 2
PATCH = 3


class Law(NamedTuple):
    """A friction law for the kernels: what it knows beside coefficient and zone."""

    kind: int
    surplus: float  # static over kinetic friction, less 1
    speed: float  # Stribeck's [m/s]
    exponent: float
    load_exponent: float
    usual_load: float  # [N]
    presliding: float  # [m]
    damping: float  # [s]
    memory: np.ndarray  # (2, .) of the gear at a step's begin and end, see `memory`
    place: int  # first column of its first patch


PLAIN = Law(COULOMB, 0.0, 1.0, 2.0, 1.0, 1.0, 1.0, 0.0, NO_MEMORY, 0)


def law_of(part: FrictionLaw, memory: Memory, patches: int = 1, usual_load: float = 1.0) -> Law:
    """Return a part's law; `patches` contacts of a bristle get room in the memory.

    `usual_load` [N] is that under which a load exponent changes nothing.
    """
    kind = KINDS[part.friction_law]
    return Law(
        kind,
        part.static_ratio - 1.0 if kind else 0.0,  # Coulomb's law knows one coefficient
        part.stribeck_speed,
        part.stribeck_exponent,
        float(getattr(part, "load_exponent", 1.0)) if kind else 1.0,
        usual_load,
        part.bristle_travel,
        part.bristle_damping,
        memory.rows if kind == BRISTLE else NO_MEMORY,
        memory.taken(PATCH * patches) if kind == BRISTLE else 0,
    )


@kernel
def coulomb(normal_force, friction, slip, zone):  # type: ignore[no-untyped-def]
    """Friction over slip speed [N s/m]: mu N / max(|v|, zone), Exudyn's regularisation."""
    return friction * normal_force / max(slip, zone)


@kernel
def constant_drag(size, rate, zone):  # type: ignore[no-untyped-def]
    """Friction of constant size, with the sign of the rate and linear in it below the zone."""
    return size * rate / max(abs(rate), zone)


@borrowing
def stribeck(slip, law):  # type: ignore[no-untyped-def]
    """Stribeck's curve g: friction at a slip speed over that at high speed."""
    if law.surplus == 0:
        return 1.0
    return 1.0 + law.surplus * np.exp(-((slip / law.speed) ** law.exponent))


@borrowing
def by_load(load, law):  # type: ignore[no-untyped-def]
    """Factor of the friction of a contact under its whole load."""
    if law.load_exponent == 1.0 or not load > 0:
        return 1.0
    return (load / law.usual_load) ** (law.load_exponent - 1.0)


@borrowing
def step_of(law):  # type: ignore[no-untyped-def]
    """Duration of the step [s]; infinite at the start of a motion that has gone on for long."""
    return law.memory[1, TIME] - law.memory[0, TIME]


@borrowing
def clear(patch, law):  # type: ignore[no-untyped-def]
    """Begin to add up what a patch will remember."""
    for i in range(PATCH):
        law.memory[1, patch + i] = 0.0


@borrowing
def bristle(load, along, across, patch, friction, law):  # type: ignore[no-untyped-def]
    """Friction against a slip velocity at a point of a patch, its components, and the power lost.

    Points share their patch's deflection at the begin of a step, the mean weighed with the load; within the
    step each follows its own slip.
    """
    memory, slip, h = law.memory, np.sqrt(along * along + across * across), step_of(law)
    before = memory[0, patch + LOAD]
    z_a, z_b = 0.0, 0.0
    if before > 0:
        z_a, z_b = memory[0, patch + ALONG] / before, memory[0, patch + ACROSS] / before
    g, t_a, t_b = stribeck(slip, law), z_a, z_b
    damped = 0.0
    if slip > 0 and h > 0:
        g_a, g_b = g * along / slip, g * across / slip
        rest = np.exp(-slip * h / (law.presliding * g))
        t_a, t_b = g_a + (z_a - g_a) * rest, g_b + (z_b - g_b) * rest
        if law.damping > 0:
            damped = min(law.damping, 4 * law.presliding * g / slip) / h
    memory[1, patch + ALONG] += load * t_a
    memory[1, patch + ACROSS] += load * t_b
    memory[1, patch + LOAD] += load
    size = friction * load
    lost = slip * (t_a * t_a + t_b * t_b) / g
    if damped > 0:
        d_a, d_b = damped * (t_a - z_a), damped * (t_b - z_b)
        lost += (d_a * t_a + d_b * t_b) * slip / g + law.presliding * (d_a * d_a + d_b * d_b) / (damped * h)
        t_a, t_b = t_a + d_a, t_b + d_b
    return size * t_a, size * t_b, size * max(lost, 0.0)


@borrowing
def stored(patch, friction, law):  # type: ignore[no-untyped-def]
    """Energy of a patch's bristles at the end of the step [J]."""
    load = law.memory[1, patch + LOAD]
    if not load > 0:
        return 0.0
    a, b = law.memory[1, patch + ALONG], law.memory[1, patch + ACROSS]
    return 0.5 * friction * law.presliding * (a * a + b * b) / load
