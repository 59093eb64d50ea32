"""Laws of dry friction: Coulomb's with a zone about zero, Stribeck's, and bristles with a state.

A bristle is a spring across the contact that slides at its end (LuGre): with its deflection z over the
presliding displacement delta, the slip s, its direction d and Stribeck's curve g,

    dz = (ds - |ds| z / g) / delta,        friction = mu N (z + tau dz/dt),        stored = mu N delta z^2 / 2

(Canudas de Wit et al., IEEE Trans. Autom. Control 40 (1995), 419). Over a step of even slip its solution is

    z_1 = g d + (z_0 - g d) exp(-|s| / (delta g)),

exact, stable for any step, and independent of the rate where g is. What it loses, mu N |v| z^2 / g and the
damping's part, is never negative: the damping time is cut to 4 delta g / |v|.
"""

import numpy as np

from rps_exudyn.base.compiled import inline, record, record_type
from rps_exudyn.forces.memory import TIME, Patches
from rps_exudyn.parameters.friction_law import LAWS, PLAIN_LAW, FrictionLaw

KINDS = {name: number for number, name in enumerate(LAWS)}  # by which kernels tell laws apart
COULOMB = KINDS[PLAIN_LAW]

# What a patch remembers, from its first column on: sums over its points of load times deflection, and load
ALONG, ACROSS, LOAD = 0, 1, 2
PATCH = 3

ROUNDED = 0.04  # of the friction zone, over which a tangent rounds the corner at its edge


LAW = record_type(
    [
        ("kind", "i8"),
        ("has_state", "i8"),
        ("surplus", "f8"),  # static over kinetic friction, less 1
        ("speed", "f8"),  # Stribeck's [m/s]
        ("exponent", "f8"),
        ("load_exponent", "f8"),
        ("usual_load", "f8"),  # [N]
        ("presliding", "f8"),  # [m]
        ("damping", "f8"),  # [s]
        ("place", "i8"),  # column of its first patch in the state, see `memory`
    ]
)
"""Record of a friction law: what it has beside coefficient and zone."""

PLAIN = record(
    LAW,
    kind=COULOMB,
    has_state=0,
    surplus=0.0,
    speed=1.0,
    exponent=2.0,
    load_exponent=1.0,
    usual_load=1.0,
    presliding=1.0,
    damping=0.0,
    place=0,
)


def law_of(part: FrictionLaw, patches: Patches, count: int = 1, usual_load: float = 1.0) -> np.record:
    """Return the record of a part's law; its bristles get `count` patches of the gear's.

    `usual_load` [N] is that under which a load exponent changes nothing.
    """
    facts = part.facts
    return record(
        LAW,
        kind=KINDS[part.friction_law],
        has_state=int(facts.has_state),
        surplus=part.surplus,
        speed=part.stribeck_speed,
        exponent=part.stribeck_exponent,
        load_exponent=float(getattr(part, "load_exponent", 1.0)) if facts.falls else 1.0,
        usual_load=usual_load,
        presliding=part.bristle_travel,
        damping=part.bristle_damping,
        place=patches.taken(PATCH * count) if facts.has_state else 0,
    )


@inline
def coulomb(normal_force, friction, slip, zone):  # type: ignore[no-untyped-def]
    """Friction over slip speed [N s/m]: mu N / max(|v|, zone), Exudyn's regularisation."""
    return friction * normal_force / max(slip, zone)


@inline
def constant_drag(size, rate, zone):  # type: ignore[no-untyped-def]
    """Friction of constant size, with the sign of the rate and linear in it below the zone."""
    return size * rate / max(abs(rate), zone)


@inline
def stribeck(slip, law):  # type: ignore[no-untyped-def]
    """Stribeck's curve g: friction at a slip speed over that at high speed."""
    if law.surplus == 0:
        return 1.0
    return 1.0 + law.surplus * np.exp(-((slip / law.speed) ** law.exponent))


@inline
def by_load(load, law):  # type: ignore[no-untyped-def]
    """Factor of the friction of a contact under its whole load."""
    if law.load_exponent == 1.0 or not load > 0:
        return 1.0
    return (load / law.usual_load) ** (law.load_exponent - 1.0)


@inline
def step_of(memory):  # type: ignore[no-untyped-def]
    """Duration of the step [s]; infinite at the start of a motion that has gone on for long."""
    return memory[1, TIME] - memory[0, TIME]


@inline
def clear(patch, memory):  # type: ignore[no-untyped-def]
    """Begin to add up what a patch will remember."""
    for i in range(PATCH):
        memory[1, patch + i] = 0.0


@inline
def bristle(load, along, across, patch, friction, law, memory):  # type: ignore[no-untyped-def]
    """Friction against a slip velocity at a point of a patch, its components, and the power lost.

    Points share their patch's deflection at the begin of a step, the mean weighed with the load; within the
    step each follows its own slip.
    """
    slip, h = np.sqrt(along * along + across * across), step_of(memory)
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


@inline
def stored(patch, friction, law, memory):  # type: ignore[no-untyped-def]
    """Energy of a patch's bristles at the end of the step [J]."""
    load = memory[1, patch + LOAD]
    if not load > 0:
        return 0.0
    a, b = memory[1, patch + ALONG], memory[1, patch + ACROSS]
    return 0.5 * friction * law.presliding * (a * a + b * b) / load


# --- tangents --------------------------------------------------------------------------------------
@inline
def stribeck_slope(slip, law):  # type: ignore[no-untyped-def]
    """Derivative of Stribeck's curve by the slip speed [s/m]."""
    if law.surplus == 0 or not slip > 0:
        return 0.0
    ratio = (slip / law.speed) ** law.exponent
    return -law.surplus * law.exponent * ratio / slip * np.exp(-ratio)


@inline
def rubbing(along, across, patch, friction, zone, law, memory):  # type: ignore[no-untyped-def]
    """Friction over load against a slip velocity, its components, and their derivatives by it.

    Returns f_a, f_b and the symmetric part of df/dv as its values along the slip and across it, and its
    direction: (f_a, f_b, along the slip, across it, d_a, d_b) [-, -, s/m, s/m, -, -]. Of bristles, the
    derivative is that in the slip's own direction and across it, their state at the step's start being small
    against what the step adds or parallel to it.
    """
    slip = np.sqrt(along * along + across * across)
    d_a, d_b = (along / slip, across / slip) if slip > 0 else (1.0, 0.0)
    g, rise = stribeck(slip, law), stribeck_slope(slip, law)
    if not law.has_state:
        drag = friction * g / max(slip, zone)
        # over the corner at the zone's edge the slope fades: Newton's method would jump to and fro there
        within = min(max((1 + ROUNDED / 2 - slip / zone) / ROUNDED, 0.0), 1.0)
        ahead = friction * (within * (g + slip * rise) / zone + (1 - within) * rise)
        return drag * along, drag * across, ahead, drag, d_a, d_b
    h, before = step_of(memory), memory[0, patch + LOAD]
    z_a, z_b = 0.0, 0.0
    if before > 0:
        z_a, z_b = memory[0, patch + ALONG] / before, memory[0, patch + ACROSS] / before
    if not 0 < h < np.inf:
        drag = friction * g / max(slip, zone)
        return friction * g * d_a, friction * g * d_b, 0.0, drag, d_a, d_b
    rest = np.exp(-slip * h / (law.presliding * g))
    damped = min(law.damping, 4 * law.presliding * g / max(slip, 1e-30)) / h if law.damping > 0 else 0.0
    z_d = z_a * d_a + z_b * d_b
    t_a, t_b = g * d_a + (z_a - g * d_a) * rest, g * d_b + (z_b - g * d_b) * rest
    # t = g (1 - r) d + r z, r = exp(-v h / (delta g)): along d, and across it where d turns by 1/v
    r_v = -rest * h / law.presliding * (g - slip * rise) / (g * g)
    ahead = rise * (1 - rest) + (z_d - g) * r_v
    aside = g * (1 - rest) / slip if slip * h > 1e-9 * law.presliding else h / law.presliding
    t_a, t_b = t_a + damped * (t_a - z_a), t_b + damped * (t_b - z_b)
    size = friction * (1 + damped)
    return friction * t_a, friction * t_b, size * ahead, size * aside, d_a, d_b
