"""Laws of dry friction: Coulomb's with a zone about zero, Stribeck's, and bristles, which have a state.

Bristles are n elasto-plastic elements side by side, springs of fixed stiffness k_i = w_i phi_0 / (H_i delta)
that slide where their force reaches a limit (Masing 1926, Iwan 1966); delta is the travel of the first
loading, phi_0 the friction under the usual load. The limit w_i phi follows the load N and Stribeck's curve g,
phi = mu N g(v), at the end of a step with the slip s:

    trial t_i = f_i + k_i s,        f_i <- t_i min(1, w_i phi / |t_i|),        friction = sum f_i.

Because no k_i depends on the load, no history of slip and load makes energy: friction . s less the change of
sum f_i^2 / (2 k_i) is never negative. A damping time tau adds tau times each spring's rate to what the limit
holds.

A patch is where points share elements: one side of the teeth, the seat, the bush, the bearings. Its slip is
the mean over the points, weighted with N g, its friction is distributed in the same way, so that in steady
sliding each point has its own Stribeck friction against its own slip.

State of the elements along a motion: an array (2, m), start and end of a step. Columns are the time, the
coordinates of the stack, and for each patch the limit, the work lost so far, and the elements' forces along
and across. Kernels read the start and write the end at each evaluation; the solver sets the end's time
before, and copies the end to the next start once the step is found. Slip is then what the coordinates moved
over the step.
"""

from dataclasses import dataclass

import numpy as np

from rps_exudyn.base.compiled import changed, inline, record, record_type
from rps_exudyn.parameters.friction_law import LAWS, MOST_ELEMENTS, PLAIN_LAW, FrictionLaw

KINDS = {name: number for number, name in enumerate(LAWS)}  # numbers of the laws in the kernels
COULOMB = KINDS[PLAIN_LAW]

ELEMENT_TRAVELS = (
    (2.0,),
    (0.8967, 3.0717),
    (0.5953, 1.6368, 3.804),
    (0.4442, 1.1247, 2.1212, 4.197),
)
"""H_i of 1 to 4 elements: slip of the first loading at which each begins to slide, over delta."""
ELEMENT_SHARES = (
    (1.0,),
    (0.4907, 0.5093),
    (0.2695, 0.4297, 0.3008),
    (0.16708, 0.29097, 0.32567, 0.21628),
)
"""w_i: each one's share of the limit. Both fit 1 - exp(-s / delta) to 0.153, 0.046, 0.023, 0.014."""

# State of a patch, from its first column on
LIMIT, LOST, FORCES = 0, 1, 2

TIME, PLACES = 0, 1
MOST_COORDINATES = 93  # of a rack with as many modes as `rack.modes` allows, and a supported pinion
PATCHES = PLACES + MOST_COORDINATES
MOST_PATCHES = 7  # two sides of the teeth, seat, bush, bearings, shaft along its axis, plunger in its bore
STATE_SIZE = PATCHES + MOST_PATCHES * (FORCES + 2 * MOST_ELEMENTS)

# Sums over the points of a patch: what friction of size 1 along and across exerts, slip, N g, N, N g'
ALONG, ACROSS, SLIP_ALONG, SLIP_ACROSS, WEIGHT, WHOLE_LOAD, FALL = 0, 6, 12, 13, 14, 15, 16
FRICTION_ALONG, FRICTION_ACROSS = 17, 18  # of the patch, found from the others [N]
PATCH_SUMS = 19

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
        ("elements", "i8"),
        ("stiffness", "f8", (MOST_ELEMENTS,)),  # of each element [N/m]
        ("share", "f8", (MOST_ELEMENTS,)),  # of the limit
        ("damping", "f8"),  # over stiffness [s]
        ("place", "i8"),  # column of its first patch in the state
    ]
)
"""Record of a friction law: what it has beside coefficient and zone."""

PLAIN = changed(np.zeros(1, LAW)[0], kind=COULOMB, speed=1.0, exponent=2.0, load_exponent=1.0, usual_load=1.0)


@dataclass(eq=False)
class Patches:
    """Columns of one gear's patches of `elements` elements each; `needed` once a part has some."""

    elements: int = 1
    _used: int = PATCHES

    def taken(self, count: int) -> int:
        """Return the first column of some new patches."""
        first = self._used
        self._used += count * (FORCES + 2 * self.elements)
        return first

    @property
    def needed(self) -> bool:
        """Return whether any part has bristles."""
        return self._used > PATCHES


def law_of(
    part: FrictionLaw, patches: Patches, friction: float, usual_load: float = 1.0, count: int = 1
) -> np.record:
    """Return the record of a part's law; its bristles get `count` patches of the gear's.

    `friction` is a coefficient, or the friction [N] of a part under a load of 1. A load exponent changes
    nothing under `usual_load` [N], which fixes the stiffness.
    """
    facts = part.facts
    # without a state there are no elements: records of many gears then are sums over single parameters
    limit = friction * usual_load if facts.has_state else 0.0
    stiffness, share = _elements(patches.elements, limit, part.bristle_travel)
    return record(
        LAW,
        kind=KINDS[part.friction_law],
        has_state=int(facts.has_state),
        surplus=part.surplus,
        speed=part.stribeck_speed,
        exponent=part.stribeck_exponent,
        load_exponent=float(getattr(part, "load_exponent", 1.0)) if facts.falls else 1.0,
        usual_load=usual_load,
        elements=patches.elements,
        stiffness=stiffness,
        share=share,
        damping=part.bristle_damping,
        place=patches.taken(count) if facts.has_state else 0,
    )


def constant_law(patches: Patches, size: float, travel: float) -> np.record:
    """Return the record of elements under a constant limit `size` [N], which slide after `travel` [m];
    without state where there is no friction."""
    if not size:
        return changed(PLAIN)
    stiffness, share = _elements(patches.elements, size, travel)
    place = patches.taken(1)
    return changed(
        PLAIN, has_state=1, elements=patches.elements, stiffness=stiffness, share=share, place=place
    )


def _elements(n: int, limit: float, travel: float) -> tuple[np.ndarray, np.ndarray]:
    """Stiffness [N/m] and share of the limit [N] of n elements, with room for `MOST_ELEMENTS`."""
    stiffness, share = np.zeros(MOST_ELEMENTS), np.zeros(MOST_ELEMENTS)
    share[:n] = ELEMENT_SHARES[n - 1]
    stiffness[:n] = share[:n] * limit / np.multiply(ELEMENT_TRAVELS[n - 1], travel)
    return stiffness, share


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


# --- state along a motion ----------------------------------------------------------------------------
def reset(memory: np.ndarray) -> None:
    """Reset to steady sliding at the rates of the next evaluation."""
    memory[:] = 0.0
    memory[0, TIME] = -np.inf


@inline
def patch_columns(elements):  # type: ignore[no-untyped-def]
    """Return the number of columns of a patch's state."""
    return FORCES + 2 * elements


@inline
def begin_step(memory, begin, time):  # type: ignore[no-untyped-def]
    """Go to a step that begins with the state `begin` and ends at a time [s]."""
    for i in range(begin.size):
        memory[0, i] = begin[i]
    memory[1, TIME] = time


@inline
def duration(memory):  # type: ignore[no-untyped-def]
    """Duration of the step over which slip is a mean [s]; 0 where rates are those given."""
    h = memory[1, TIME] - memory[0, TIME]
    return h if 0 < h < np.inf else 0.0


# --- elements of a patch -----------------------------------------------------------------------------
@inline
def clear_patch(sums):  # type: ignore[no-untyped-def]
    """Begin to add up the points of a patch."""
    for i in range(PATCH_SUMS):
        sums[i] = 0.0


@inline
def add_point(load, along, across, law, sums):  # type: ignore[no-untyped-def]
    """Add a point with its slip velocity to the sums of its patch; return its weight N g."""
    slip = np.sqrt(along * along + across * across)
    weight = load * stribeck(slip, law)
    sums[SLIP_ALONG] += weight * along
    sums[SLIP_ACROSS] += weight * across
    sums[WEIGHT] += weight
    sums[WHOLE_LOAD] += load
    sums[FALL] += load * stribeck_slope(slip, law)
    return weight


@inline
def add_direction(first, weight, force, moment, sums):  # type: ignore[no-untyped-def]
    """Add what friction of a point's weight exerts, from the sum `first` on: `ALONG` or `ACROSS`."""
    for i in range(3):
        sums[first + i] += weight * force[i]
        sums[first + 3 + i] += weight * moment[i]


@inline
def slide_patch(friction, place, law, memory, sums):  # type: ignore[no-untyped-def]
    """Fill a patch's friction by the sums over its points, whose directions and slip become means; return the
    power that it takes, the energy stored, and the work lost so far."""
    weight = sums[WEIGHT]
    if not weight > 0:
        _, _, stored, lost = slide(0.0, 0.0, 0.0, place, law, memory)
        return 0.0, stored, lost
    for i in range(SLIP_ACROSS + 1):
        sums[i] /= weight
    limit = friction * by_load(sums[WHOLE_LOAD], law) * weight
    f_a, f_b, stored, lost = slide(limit, sums[SLIP_ALONG], sums[SLIP_ACROSS], place, law, memory)
    sums[FRICTION_ALONG], sums[FRICTION_ACROSS] = f_a, f_b
    return f_a * sums[SLIP_ALONG] + f_b * sums[SLIP_ACROSS], stored, lost


@inline
def on_patch(part, sums):  # type: ignore[no-untyped-def]
    """Return what a patch's friction exerts: one of the numbers of `ALONG` and `ACROSS`."""
    return sums[FRICTION_ALONG] * sums[ALONG + part] + sums[FRICTION_ACROSS] * sums[ACROSS + part]


@inline
def slide(limit, along, across, place, law, memory):  # type: ignore[no-untyped-def]
    """Friction of elements against a slip velocity [N], its components; the energy stored and the work lost
    so far [J]. `limit` [N] is that at the end of the step."""
    h, lost, stored, f_a, f_b = memory[1, TIME] - memory[0, TIME], memory[0, place + LOST], 0.0, 0.0, 0.0
    before = memory[0, place + LIMIT]
    memory[1, place + LIMIT] = limit
    for i in range(law.elements):
        column, stiffness, most = place + FORCES + 2 * i, law.stiffness[i], law.share[i] * limit
        a, b = memory[0, column], memory[0, column + 1]
        t_a, t_b, size = _trial(a, b, along, across, h, stiffness, law)
        scale = most / size if size > most else 1.0
        t_a, t_b = scale * t_a, scale * t_b
        stiffer = 1.0
        if 0 < h < np.inf and stiffness > 0:
            stiffer += law.damping / h
            # what the spring holds of the force, and what it was stretched by
            s_a, s_b = (t_a + (stiffer - 1) * a) / stiffer, (t_b + (stiffer - 1) * b) / stiffer
            stretch = ((s_a - a) ** 2 + (s_b - b) ** 2) / stiffness
            lost += (stiffer - 1) * stretch
            if scale < 1:
                began = law.share[i] * before
                rise, x, y = most - began, stiffness * along * h, stiffness * across * h
                middle = (most + began + _sliding_from(a, b, x, y, began, rise) * rise) / 2
                lost += (size - most) * min(max(middle, 0.0), max(most, began)) / (stiffer * stiffness)
            memory[1, column], memory[1, column + 1] = s_a, s_b
        else:
            memory[1, column], memory[1, column + 1] = t_a, t_b
        f_a, f_b = f_a + t_a, f_b + t_b
        if stiffness > 0:
            stored += (memory[1, column] ** 2 + memory[1, column + 1] ** 2) / (2 * stiffness)
    memory[1, place + LOST] = lost
    return f_a, f_b, stored, lost


@inline
def _trial(a, b, along, across, h, stiffness, law):  # type: ignore[no-untyped-def]
    """Force of an element that does not slide, its components and its size; after long sliding, infinite
    against the slip."""
    if h > 0 and h < np.inf:
        stiffer = stiffness * h + stiffness * law.damping
        t_a, t_b = a + stiffer * along, b + stiffer * across
        return t_a, t_b, np.sqrt(t_a * t_a + t_b * t_b)
    if h == np.inf:
        slip = np.sqrt(along * along + across * across)
        if slip > 0 and stiffness > 0:
            return 1e300 * along / slip, 1e300 * across / slip, 1e300
        return 0.0, 0.0, 0.0
    return a, b, np.sqrt(a * a + b * b)


@inline
def _sliding_from(a, b, x, y, most, rise):  # type: ignore[no-untyped-def]
    """Part of an even step after which |(a, b) + part (x, y)| reaches most + part rise."""
    square, product = x * x + y * y - rise * rise, a * x + b * y - most * rise
    left = min(a * a + b * b - most * most, 0.0)
    root = np.sqrt(max(product * product - square * left, 0.0))
    part = 1.0
    if product > 0:
        part = -left / (product + root)
    elif square > 0:
        part = (root - product) / square
    return min(part, 1.0)


# --- tangents --------------------------------------------------------------------------------------
@inline
def stribeck_slope(slip, law):  # type: ignore[no-untyped-def]
    """Derivative of Stribeck's curve by the slip speed [s/m]."""
    if law.surplus == 0 or not slip > 0:
        return 0.0
    ratio = (slip / law.speed) ** law.exponent
    return -law.surplus * law.exponent * ratio / slip * np.exp(-ratio)


@inline
def rubbing(along, across, friction, zone, law):  # type: ignore[no-untyped-def]
    """Friction over load against a slip velocity by a law without state, its components, and their
    derivatives by it.

    Returns f_a, f_b and df/dv as its values along the slip and across it, and its direction:
    (f_a, f_b, along the slip, across it, d_a, d_b) [-, -, s/m, s/m, -, -].
    """
    slip = np.sqrt(along * along + across * across)
    d_a, d_b = (along / slip, across / slip) if slip > 0 else (1.0, 0.0)
    g, rise = stribeck(slip, law), stribeck_slope(slip, law)
    drag = friction * g / max(slip, zone)
    # over the corner at the zone's edge the slope fades: Newton's method would jump to and fro there
    within = min(max((1 + ROUNDED / 2 - slip / zone) / ROUNDED, 0.0), 1.0)
    ahead = friction * (within * (g + slip * rise) / zone + (1 - within) * rise)
    return drag * along, drag * across, ahead, drag, d_a, d_b


@inline
def patch_slopes(friction, place, law, memory, sums):  # type: ignore[no-untyped-def]
    """Derivatives of a patch's friction by its slip velocity (aa, ab, ba, bb), after `slide_patch`; and by
    the load of a point over its g (a, b), less what the other points then hold less of it."""
    weight, along, across = sums[WEIGHT], sums[SLIP_ALONG], sums[SLIP_ACROSS]
    if not weight > 0:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    size = friction * by_load(sums[WHOLE_LOAD], law)
    slopes = slide_slopes(size * weight, along, across, size * sums[FALL], place, law, memory)
    k_aa, k_ab, k_ba, k_bb, f_a, f_b, p_a, p_b = slopes
    size *= law.load_exponent
    return k_aa, k_ab, k_ba, k_bb, size * p_a - f_a / weight, size * p_b - f_b / weight


@inline
def slide_slopes(limit, along, across, fall, place, law, memory):  # type: ignore[no-untyped-def]
    """Derivatives of the elements' friction by the slip velocity (aa, ab, ba, bb) [N s/m]; the friction; its
    derivatives by the limit (a, b). `fall` [N s/m] is the derivative of the limit by the slip speed."""
    h, k_aa, k_ab, k_bb = memory[1, TIME] - memory[0, TIME], 0.0, 0.0, 0.0
    f_a, f_b, p_a, p_b = 0.0, 0.0, 0.0, 0.0
    slip = np.sqrt(along * along + across * across)
    for i in range(law.elements):
        column, stiffness, most = place + FORCES + 2 * i, law.stiffness[i], law.share[i] * limit
        t_a, t_b, size = _trial(memory[0, column], memory[0, column + 1], along, across, h, stiffness, law)
        stiffer = stiffness * (h + law.damping) if 0 < h < np.inf else 0.0
        if size > most:
            n_a, n_b = t_a / size, t_b / size
            if h == np.inf:
                stiffer, size = 1.0, slip
            share = law.share[i]
            drag = stiffer * most / size
            k_aa, k_ab, k_bb = k_aa + drag * n_b * n_b, k_ab - drag * n_a * n_b, k_bb + drag * n_a * n_a
            f_a, f_b = f_a + most * n_a, f_b + most * n_b
            p_a, p_b = p_a + share * n_a, p_b + share * n_b
        else:
            k_aa, k_bb, f_a, f_b = k_aa + stiffer, k_bb + stiffer, f_a + t_a, f_b + t_b
    d_a, d_b = (fall * along / slip, fall * across / slip) if slip > 0 else (0.0, 0.0)
    return k_aa + p_a * d_a, k_ab + p_a * d_b, k_ab + p_b * d_a, k_bb + p_b * d_b, f_a, f_b, p_a, p_b
