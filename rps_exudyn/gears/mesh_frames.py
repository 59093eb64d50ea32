"""Where a surface's pinion or rack stands in its file, from the surface alone.

Pinion: the flanks are a helicoid with z equal teeth. With Z along the axis and theta + tau Z the polar angle
taken back by the twist tau, every point of a flank of side s = +-1 lies at

    theta + tau Z = c + s delta(R)  (mod 2 pi / z),      n_Z = tau R n_theta

with one curve delta(R) for all. tau follows from the normals' mode, z and c from the harmonics of n_theta
over theta + tau Z. Then axis (two tilts, two shifts), tau, c and a polynomial delta are the least squares of
normal distances, R n_theta (theta + tau Z - c - s delta). That asks for no involute and no closed surface.

Rack: the flanks of a side are planes n . p = d + k q, tooth k after tooth. Of all directions that normals
have, the flanks' have the largest area in at least three such planes. n, d, q are the least squares of
positions. Two families give the step from tooth to tooth but along the traces n1 x n2. There the teeth's
middles count, or the bar's surfaces along the travel. The bar's axis is that of the round part of these.

Angles and places of own gears come back to 1e-4 degrees and 0.1 um (`tests/geometry/test_mesh_frames.py`).
"""

from dataclasses import dataclass

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.mesh_file import Surface, unit_of

TEETH = (3, 40)  # of a pinion, as `pinion.teeth` allows
STEEP = 0.4  # least n_theta of a flank: involutes end at a pressure angle of 60 degrees
STEEPEST = 3.0  # tangent of a helix angle at the tips
CLEAR = 0.5  # share of the first harmonic of equal teeth in n_theta
STEPS = 6  # of least squares
UNLIKE = 0.005  # of the tip radius or pitch, by which the flanks of equal teeth differ at most
ASTRAY = 0.15  # of a flank's normal from its helicoid's [rad]
DEGREE = 6  # of delta(R)
USED = 200_000  # triangles, drawn from those of larger surfaces
CONE = np.cos(np.deg2rad(4))  # within which normals belong to one family of planes
DIRECTIONS = 24  # of normals with the largest areas, tried as a rack's flanks
ALONG = 0.1  # n . X of the bar's surfaces at most
LEAST_ARC = 0.05  # second over first moment of the normals of a bar, all around 1
ROUND = 0.05  # of the radius, that half the triangles of a round bar are out of place at most
OUTLIER = 5.0  # median deviations, beyond which a dent or a burr has no weight
ROUNDING = 1e-7  # of single precision, in the surface's size
BINS = 4096  # of the places of a family's planes
FINEST = 1e-3  # least gap between planes of a family, in the surface's size


@dataclass(frozen=True, eq=False)
class Placement:
    """A rigid transform from a file's numbers to a frame of the package."""

    unit: str  # name of the file's unit
    scale: float  # its size [m]
    axes: np.ndarray  # those of the frame as rows, in the file, shape (3, 3)
    origin: np.ndarray  # that of the frame in the file [m], shape (3,)
    form_error: float  # root mean square distance of the flanks from the fitted surface [m]

    def place(self, points: np.ndarray) -> np.ndarray:
        """Return points of the file (..., 3) in the frame [m]."""
        return (np.asarray(points) * self.scale - self.origin) @ self.axes.T


@dataclass(frozen=True, eq=False)
class PinionPlacement(Placement):
    """Of a pinion: a tooth space is centred on +Y in the middle of the face; k points to the longer end."""

    teeth: int
    twist: float  # turn of the transverse section per length [rad/m]
    tip_diameter: float  # [m]
    face_width: float  # of the teeth [m]


@dataclass(frozen=True, eq=False)
class RackPlacement(Placement):
    """Of a rack: tooth 0 in the middle of all is centred at X = 0; X points to the longer end."""

    teeth: int  # whole teeth
    pitch: float  # along X [m]
    tooth_angle: float  # of the traces to the cross direction [rad]
    pressure_angles: tuple[float, float]  # of flanks that drive to +X and to -X [rad]
    addendum: float  # of the tips above the line where tooth and space are equal [m]
    bar_diameter: float | None  # of the round part; None without one [m]
    reference_height: float  # of that line above the bar's axis, or of the drawing's without a bar [m]


# --- pinion ----------------------------------------------------------------------------------------
def place_pinion(surface: Surface) -> PinionPlacement:
    """Return how a surface becomes the pinion in the pinion frame.

    Raises:
        InputError: it has no teeth about an axis, has inverted normals, or the size of no pinion.
    """
    unit_sized, centre, size = _unit_sized(surface)
    inertia, mesh_normals = (
        np.einsum("i,ij,ik->jk", unit_sized.areas, each, each)
        for each in (unit_sized.corners.mean(axis=1), unit_sized.normals)
    )
    guesses = [
        _guess(unit_sized, np.roll(np.linalg.eigh(tensor)[1].T, k, axis=0))
        for tensor in (inertia, mesh_normals)
        for k in range(3)
    ]
    _, clarity, teeth = max(guesses, key=lambda each: each[0])
    for _ in range(STEPS if clarity > CLEAR else 0):
        teeth = _fitted(unit_sized, teeth)
    if clarity < CLEAR or teeth.form_error > UNLIKE * teeth.tip_radius:
        raise InputError("shows no equal teeth about an axis")
    p = (unit_sized.corners - teeth.centre) @ teeth.axes.T
    of_flanks = p[teeth.flanks].reshape(-1, 3)
    if teeth.outward < 0:
        raise InputError("has inverted normals: those of its flanks point into the teeth")
    bottom, top = of_flanks[:, 2].min(), of_flanks[:, 2].max()
    middle = (bottom + top) / 2
    up = 1.0 if p[..., 2].max() - middle >= middle - p[..., 2].min() - ROUNDING else -1.0
    name, unit = unit_of(size * teeth.tip_radius, "tip radius")
    space = teeth.tooth + np.pi / teeth.number - teeth.twist * middle
    towards_rack = np.array([np.cos(space), np.sin(space), 0]) @ teeth.axes
    k = up * teeth.axes[2]
    axes = np.stack([np.cross(towards_rack, k), towards_rack, k])
    origin = centre + size * (teeth.centre + middle * teeth.axes[2])
    return PinionPlacement(
        unit=name,
        scale=unit,
        axes=axes,
        origin=unit * origin,
        form_error=unit * size * teeth.form_error,
        teeth=teeth.number,
        twist=teeth.twist / (unit * size),
        tip_diameter=2 * unit * size * teeth.tip_radius,
        face_width=unit * size * float(top - bottom),
    )


def _unit_sized(surface: Surface) -> tuple[Surface, np.ndarray, float]:
    """Return up to `USED` triangles moved to the centre of area and scaled to unit size; centre and size."""
    corners, areas = surface.corners, surface.areas
    if len(corners) > USED:
        chosen = np.random.default_rng(0).choice(len(corners), USED, replace=False)
        corners, areas = corners[chosen], areas[chosen]
    centre = areas @ corners.mean(axis=1) / areas.sum()
    size = float(np.ptp(corners, axis=(0, 1)).max())
    return Surface((corners - centre) / size), centre, size


@dataclass(frozen=True, eq=False)
class _Teeth:
    """Equal teeth about an axis, in a surface of unit size."""

    axes: np.ndarray  # as rows, the last one along the axis
    centre: np.ndarray  # a point of it
    number: int
    twist: float
    tooth: float  # polar angle of a tooth's middle at the centre
    flanks: np.ndarray  # numbers of triangles
    outward: float = 0.0  # above 0: normals of the flanks point away from the axis
    form_error: float = 0.0
    tip_radius: float = 0.0


def _least_squares(columns: np.ndarray, values: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Return what minimises the weighted sum of (columns @ x - values)^2."""
    moments = columns.T * weights
    return np.linalg.lstsq(moments @ columns, moments @ values, rcond=None)[0]


def _are_usual(errors: np.ndarray, areas: np.ndarray) -> np.ndarray:
    """Return where errors are no outliers: up to `OUTLIER` times that which half the area does not exceed."""
    order = np.argsort(errors)
    half = np.searchsorted(np.cumsum(areas[order]), areas.sum() / 2)
    return errors <= OUTLIER * errors[order[half]] + ROUNDING


def _polar(surface: Surface, axes: np.ndarray, centre: np.ndarray) -> tuple[np.ndarray, ...]:
    """Radius, angle and height of the triangles' middles, and their normals along these."""
    p, n = (surface.corners.mean(axis=1) - centre) @ axes.T, surface.normals @ axes.T
    R = np.hypot(p[:, 0], p[:, 1]) + ROUNDING
    radial = (p[:, 0] * n[:, 0] + p[:, 1] * n[:, 1]) / R
    around = (p[:, 0] * n[:, 1] - p[:, 1] * n[:, 0]) / R
    return R, np.arctan2(p[:, 1], p[:, 0]), p[:, 2], radial, around, n[:, 2]


def _guess(surface: Surface, axes: np.ndarray) -> tuple[float, float, _Teeth]:
    """Return the share of equal teeth about the last of three axes in all that is steep, that in the flanks
    of the usual twist, and the teeth."""
    axes = axes * np.sign(np.linalg.det(axes))
    centre = np.zeros(3)
    R, angle, Z, _, around, n_z = _polar(surface, axes, centre)
    steep = np.abs(around) > STEEP
    if not steep.any():
        return 0.0, 0.0, _Teeth(axes, centre, 0, 0.0, 0.0, np.flatnonzero(steep))
    outer = R[steep].max()
    lead = n_z[steep] / around[steep] / R[steep] * outer
    weights = surface.areas[steep] * R[steep] ** 2
    count, edges = np.histogram(lead, np.arange(-STEEPEST, STEEPEST, ASTRAY), weights=weights)
    usual = np.abs(lead - edges[count.argmax()] - ASTRAY / 2) < ASTRAY
    twist = float(np.average(lead[usual], weights=weights[usual]) / outer) if usual.any() else 0.0
    flanks = steep & (np.abs(n_z - twist * R * around) < ASTRAY)
    loads = surface.areas[flanks] * around[flanks]
    orders = np.arange(TEETH[1] + 1)[:, None]
    waves = np.exp(-1j * orders * (angle + twist * Z)[flanks]) @ loads
    heights = np.abs(waves) * (orders[:, 0] >= TEETH[0])
    number = int(np.argmax(heights > heights.max() / 2))
    tooth = float(-np.angle(1j * waves[number])) / max(number, 1)
    coherent = float(heights.max())
    steepness = float((surface.areas * np.abs(around)).sum())
    return (
        coherent / steepness,
        coherent / max(float(np.abs(loads).sum()), ROUNDING),
        _Teeth(axes, centre, number, twist, tooth, np.flatnonzero(flanks)),
    )


def _fitted(surface: Surface, teeth: _Teeth) -> _Teeth:
    """Return the teeth after a step of least squares of normal distances of the flanks' corners."""
    R, _, _, radial, around, n_z = _polar(surface, teeth.axes, teeth.centre)
    flanks = np.flatnonzero((np.abs(around) > STEEP) & (np.abs(n_z - teeth.twist * R * around) < ASTRAY))
    if not flanks.size:
        raise InputError("shows no equal teeth about an axis")
    p = ((surface.corners[flanks] - teeth.centre) @ teeth.axes.T).reshape(-1, 3)
    n = np.repeat(surface.normals[flanks] @ teeth.axes.T, 3, axis=0)
    R = np.hypot(p[:, 0], p[:, 1])
    lever = p[:, 0] * n[:, 1] - p[:, 1] * n[:, 0]  # R n_theta
    pitch = 2 * np.pi / teeth.number
    angle = np.arctan2(p[:, 1], p[:, 0]) + teeth.twist * p[:, 2] - teeth.tooth
    distance = lever * (np.remainder(angle + pitch / 2, pitch) - pitch / 2)
    along = 2 * (R - R.min()) / max(np.ptp(R), ROUNDING) - 1
    curve = np.polynomial.legendre.legvander(along, DEGREE) * np.abs(lever)[:, None]
    tilts = np.cross(p, n)[:, :2]
    columns = np.column_stack([tilts, n[:, :2], lever * p[:, 2], -lever, -curve])
    areas = np.repeat(surface.areas[flanks], 3)
    weights = areas
    for _ in range(2):
        found = _least_squares(columns, -distance, weights)
        errors = np.abs(distance + columns @ found)
        weights = areas * _are_usual(errors, areas)
    a, b = found[:2]
    turn = np.array([[1, 0, b], [0, 1, -a], [-b, a, 1]])  # p + (a, b, 0) x p
    left, _, right = np.linalg.svd(turn)
    axes = left @ right @ teeth.axes
    shift = np.array([found[2], found[3], 0.0]) @ teeth.axes
    return _Teeth(
        axes=axes,
        centre=teeth.centre - shift,
        number=teeth.number,
        twist=teeth.twist + float(found[4]),
        tooth=teeth.tooth + float(found[5]),
        flanks=flanks,
        outward=float(surface.areas[flanks] @ radial[flanks]),
        form_error=float(np.sqrt(np.average(errors**2, weights=weights))),
        tip_radius=float(R.max()),
    )


# --- rack ------------------------------------------------------------------------------------------
def place_rack(surface: Surface, reference_height: float) -> RackPlacement:
    """Return how a surface becomes the rack in the rack frame.

    `reference_height` [m] of the drawing stands for the bar's axis where the surface has no round bar.

    Raises:
        InputError: it has fewer than three teeth with plane flanks, or the size of no rack.
    """
    part, centre, size = _unit_sized(surface)
    families = sorted(_families(part), key=lambda each: -each.area)
    opposite = [each for each in families if each.normal @ families[0].normal < 0]
    if not opposite:
        raise InputError("shows no teeth of a rack: no planes on both sides of three teeth or more")
    first, second = families[0], opposite[0]
    if first.error > UNLIKE * first.gap:
        raise InputError("shows no equal teeth of a rack")
    w = np.cross(first.normal, second.normal)
    w /= np.linalg.norm(w)
    # the step from tooth to tooth: known along both normals; along the traces by the teeth's middles
    steps = [family.middle_step(part) for family in (first, second)]
    second_gap = np.copysign(second.gap, steps[0] @ second.normal)
    along_w = float(np.mean([step @ w * np.sign(step @ steps[0]) for step in steps]))
    rows = np.stack([first.normal, second.normal, w])
    step = np.linalg.solve(rows, [np.copysign(first.gap, steps[0] @ first.normal), second_gap, along_w])
    u = step - (step @ w) * w
    normal_pitch = float(np.linalg.norm(u))
    u /= normal_pitch
    Y = np.cross(u, w)
    Y *= -np.sign(Y @ (first.normal + second.normal))

    in_flanks = np.zeros(len(part.areas), dtype=bool)
    in_flanks[np.concatenate([first.members, second.members])] = True
    X = step / np.linalg.norm(step)
    bar = _round_bar(part, X, ~in_flanks)
    if bar is not None:
        X = bar[0] * np.sign(bar[0] @ step)
    flanks = part.corners[in_flanks].reshape(-1, 3)
    p = part.corners.reshape(-1, 3) @ X
    if p.max() - (flanks @ X).max() < (flanks @ X).min() - p.min() - ROUNDING:
        X, u = -X, -u
    X = X - (X @ Y) * Y
    X /= np.linalg.norm(X)
    Z = np.cross(X, Y)
    w *= np.sign(w @ Z)

    # a tooth is between a plane of side -1 and one of side +1; u of both at the tips, and with the height
    sides = (first, second) if first.normal @ u < 0 else (second, first)
    slopes = [-(family.normal @ Y) / (family.normal @ u) for family in sides]
    tips = float((flanks @ Y).min())
    places = [
        family.offset / (family.normal @ u) + slope * tips
        for family, slope in zip(sides, slopes, strict=True)
    ]
    tip_width = float(np.remainder(places[1] - places[0], normal_pitch))
    reference = tips + (normal_pitch / 2 - tip_width) / (slopes[1] - slopes[0])
    left = places[0] + slopes[0] * (reference - tips)
    along = [part.corners[family.members].mean(axis=1) @ u for family in sides]
    numbers = [
        np.round((each - left) / normal_pitch - half) for each, half in zip(along, (0, 0.5), strict=True)
    ]
    lowest, highest = max(each.min() for each in numbers), min(each.max() for each in numbers)
    middle = left + normal_pitch * ((lowest + highest) // 2 + 0.25)

    name, unit = unit_of(size * normal_pitch / float(X @ u), "pitch")
    scale = unit * size
    if bar is None:
        height = reference + reference_height / scale
        across = float(np.average(part.corners[in_flanks].mean(axis=1) @ Z, weights=part.areas[in_flanks]))
    else:
        height, across = float(bar[1] @ Y), float(bar[1] @ Z)
    # origin: on the middle plane of tooth 0, which holds all points with this u
    origin = height * Y + across * Z
    origin = origin + (middle - origin @ u) / (X @ u) * X
    angles = [float(np.arctan2(-family.normal @ Y, abs(family.normal @ u))) for family in sides]
    return RackPlacement(
        unit=name,
        scale=unit,
        axes=np.stack([X, Y, Z]),
        origin=unit * centre + scale * origin,
        form_error=scale * float(np.hypot(first.error, second.error) / np.sqrt(2)),
        teeth=int(highest - lowest) + 1,
        pitch=scale * normal_pitch / float(X @ u),
        tooth_angle=float(np.arctan2(w @ X, w @ Z)),
        pressure_angles=(angles[0], angles[1]),
        addendum=scale * (reference - tips),
        bar_diameter=None if bar is None else 2 * scale * bar[2],
        reference_height=scale * (height - reference),
    )


@dataclass(frozen=True, eq=False)
class _Planes:
    """Equal planes one gap after another: normal . p = offset + k gap."""

    normal: np.ndarray
    offset: float
    gap: float
    members: np.ndarray  # numbers of triangles
    area: float
    error: float  # root mean square distance of the members

    def middle_step(self, part: Surface) -> np.ndarray:
        """Return the step from one plane's middle to the next, over planes that are as large as most."""
        areas, p = part.areas[self.members], part.corners[self.members].mean(axis=1)
        k = np.round((p @ self.normal - self.offset) / self.gap).astype(int)
        k -= k.min()
        of_plane = np.bincount(k, areas)
        middles = np.stack([np.bincount(k, areas * p[:, i]) for i in range(3)], axis=1)
        whole = of_plane > 0.9 * np.median(of_plane[of_plane > 0])
        return np.polyfit(np.flatnonzero(whole), middles[whole] / of_plane[whole, None], 1)[0]


def _families(part: Surface) -> list[_Planes]:
    """Return families of at least three planes, sought about the normals with the largest areas."""
    cells = np.unique(np.round(part.normals / 0.08), axis=0, return_inverse=True)[1]
    totals = np.bincount(cells, part.areas)
    middles = part.corners.mean(axis=1)
    found: list[_Planes] = []
    for cell in np.argsort(-totals)[:DIRECTIONS]:
        normal = part.area_vectors[cells == cell].sum(axis=0)
        for _ in range(3):
            normal /= np.linalg.norm(normal)
            members = np.flatnonzero(part.normals @ normal > CONE)
            normal = part.area_vectors[members].sum(axis=0)
        normal /= np.linalg.norm(normal)
        if any(normal @ each.normal > CONE for each in found):
            continue
        if (planes := _planes(part, middles, members, normal)) is not None:
            found.append(planes)
    return found


def _planes(part: Surface, middles: np.ndarray, members: np.ndarray, normal: np.ndarray) -> _Planes | None:
    """Return the planes that triangles of one direction lie in; None if these are not three at even gaps."""
    areas = part.areas[members]
    d = middles[members] @ normal
    span = float(np.ptp(d))
    if span < FINEST:
        return None
    histogram = np.histogram(d, BINS, weights=areas / areas.sum())[0]
    comb = np.abs(np.fft.rfft(histogram, 4 * BINS))[: BINS // 2]  # over gaps in the span, in quarters
    peaks = np.flatnonzero((comb[1:-1] >= comb[:-2]) & (comb[1:-1] > comb[2:]) & (comb[1:-1] > CLEAR)) + 1
    if not peaks.size:
        return None
    gap = 4 * span / float(peaks[0])
    offset = float(d[np.argmax(areas)])
    p, weights = middles[members], areas
    for _ in range(4):
        k = np.round((p @ normal - offset) / gap)
        if np.ptp(k) < 2:
            return None
        design = np.column_stack([np.ones_like(k), k])
        lines = _least_squares(design, p, weights)
        rest = p - design @ lines
        normal = np.linalg.eigh((rest.T * weights) @ rest)[1][:, 0]
        normal = normal * np.sign(part.area_vectors[members].sum(axis=0) @ normal)
        offset, gap = (float(each) for each in lines @ normal)
        if abs(gap) < FINEST:
            return None
        errors = np.abs(rest @ normal)
        kept = _are_usual(errors, areas)
        weights = areas * kept
    numbers = np.unique(k[kept])
    if len(numbers) < 3 or len(numbers) < np.ptp(numbers) / 2:
        return None
    error = float(np.sqrt(np.average(errors[kept] ** 2, weights=areas[kept])))
    return _Planes(normal, offset, gap, members[kept], float(areas[kept].sum()), error)


def _round_bar(
    part: Surface, direction: np.ndarray, others: np.ndarray
) -> tuple[np.ndarray, np.ndarray, float] | None:
    """Return direction, a point of the axis and radius of the bar; None if surfaces are not round."""
    along = others & (np.abs(part.normals @ direction) < ALONG)
    for _ in range(4):
        n, areas = part.normals[along], part.areas[along]
        spread, axes = np.linalg.eigh((n.T * areas) @ n)
        if not along.any() or spread[1] < LEAST_ARC * spread[2]:
            return None
        along[along] = _are_usual(np.abs(n @ axes[:, 0]), areas)
    p, areas = part.corners[along] @ axes[:, 1:], part.areas[along]
    kept = np.ones(len(p), dtype=bool)
    columns = np.concatenate([2 * p, np.ones((*p.shape[:2], 1))], axis=2)
    for _ in range(STEPS):  # |p|^2 = 2 p . centre + const on a circle
        weights = np.repeat(areas * kept, 3)
        *centre, rest = _least_squares(columns.reshape(-1, 3), (p**2).sum(axis=2).ravel(), weights)
        radius = float(np.sqrt(max(rest + np.dot(centre, centre), 0.0)))
        errors = np.abs(np.linalg.norm(p - centre, axis=2) - radius).max(axis=1)
        kept = _are_usual(errors, areas)
    if areas[errors < ROUND * radius].sum() < areas.sum() / 2:
        return None
    return axes[:, 0], axes[:, 1:] @ centre, radius
