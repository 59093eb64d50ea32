"""The gear's parts as solids with true faces: the same sections as those of `solids`, without chords.

Bars, roots and lands are cylinders; the flanks of a rack of constant ratio are planes, its fillets cylinders.
B-splines are the pinion's flanks and fillets, and the teeth of a variable ratio.

A modified flank ends at the tip cylinder. Where it leaves the end of the root fillet, the distance between
them fades out over the fillet.
"""

from collections.abc import Callable, Iterator
from functools import reduce

import numpy as np
from OCP.TopoDS import TopoDS_Shape

from rps_exudyn.gears import brep
from rps_exudyn.gears.basic_rack import cutter_tip, cutter_tip_centre
from rps_exudyn.gears.flank_form import FlankForm
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.generated_rack import GeneratedRack
from rps_exudyn.gears.helicoid import Flank
from rps_exudyn.gears.pinion_mesh import swept
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.gears.solids import RoundBar, bush_segment_bars, plunger_bars, yokenut_bars
from rps_exudyn.gears.trochoid import form_point, trochoid
from rps_exudyn.parameters.gear import SteeringGear

ITERATIONS = 8  # to the tip cylinder: each leaves a share of the flank's slope deviation, below 0.1

Curve = Callable[[np.ndarray], np.ndarray]
"""Points [m] of an edge, shape (1, m, 3), at parameters (1, m)."""


def pinion_brep(gear: SteeringGear) -> TopoDS_Shape:
    """Toothed part, displaced by the runout, and the shaft through its middle."""
    pair, shaft = GearPair.of(gear), gear.pinion
    teeth = brep.closed(_pinion_faces(pair, FlankForm.of(gear)))
    half = shaft.shaft_length / 2
    bar = brep.round_bar("Z", shaft.shaft_diameter / 2, -half, half)
    return brep.joined(brep.placed(teeth, np.eye(3), pair.eccentricity), bar)


def _pinion_faces(pair: GearPair, form: FlankForm) -> Iterator[brep.Points]:
    """Fillets, flanks and lands of each pitch."""
    for m in range(pair.teeth):
        behind, rising, falling = (_flank(Flank(pair, *each, form)) for each in ((m - 1, 1), (m, -1), (m, 1)))
        fillets = [_fillet(pair, form, m, flank, hand) for flank, hand in ((behind, 1), (rising, -1))]
        yield from (*fillets, rising, falling, _land(pair.tip_radius, rising, falling))
        if cutter_tip_centre(pair)[0] > brep.SEAM:  # else the fillets meet
            yield _land(pair.root_radius, *fillets)


def _flank(flank: Flank) -> brep.Points:
    """From the form circle to the tip cylinder."""
    pair, low, high = flank.pair, flank.form_tangent_length, flank.tip_tangent_length

    def points(s: np.ndarray, t: np.ndarray) -> np.ndarray:
        Z = pair.face_width * (t - 0.5)
        end = np.full(Z.shape, high)
        for _ in range(ITERATIONS):
            tip = flank.point(flank.generator(end, Z), Z)
            end = end + high - np.sqrt(tip[..., 0] ** 2 + tip[..., 1] ** 2 - pair.base_radius**2)
        q = low + s * (end - low)
        return flank.point(flank.generator(q, Z), Z)

    return points


def _fillet(pair: GearPair, form: FlankForm, space: int, flank: brep.Points, hand: int) -> brep.Points:
    """From a flank to the root cylinder, on the right (hand 1) or left of a tooth space."""
    start = form_point(pair).eta

    def points(s: np.ndarray, t: np.ndarray) -> np.ndarray:
        Z = pair.face_width * (t - 0.5).ravel()
        angle = 2 * np.pi * space / pair.teeth - form.twist(pair) * Z
        eta = np.array([start, *(start + s.ravel() * (np.pi / 2 - start))])
        exact = swept(trochoid(pair, eta) * [hand, 1], angle, Z).reshape(len(eta), len(Z), 3)
        return exact[1:] + (1 - s[..., None]) * (flank(np.zeros((1, 1)), t) - exact[:1])

    return points


def _land(radius: float, begin: brep.Points, end: brep.Points) -> brep.Points:
    """The cylinder between the last edges of two surfaces."""

    def points(s: np.ndarray, t: np.ndarray) -> np.ndarray:
        low, high = (each(np.ones((1, 1)), t) for each in (begin, end))
        angle = np.arctan2(low[..., 1], low[..., 0])
        turn = np.remainder(np.arctan2(high[..., 1], high[..., 0]) - angle, 2 * np.pi)
        angle = angle + s * turn
        x, y, Z = np.broadcast_arrays(radius * np.cos(angle), radius * np.sin(angle), low[..., 2])
        return np.stack([x, y, Z], axis=-1)

    return points


def rack_brep(gear: SteeringGear) -> TopoDS_Shape:
    """Bar with teeth."""
    bar = RackBar.of(gear)
    bar.check_teeth()
    stock = brep.round_bar("X", bar.pair.bar_radius, bar.x_min, bar.x_max)
    return brep.cut(stock, _gaps(bar) if bar.pair.course is None else brep.closed(_generated_faces(bar)))


def _gaps(bar: RackBar) -> TopoDS_Shape:
    """What the cutter of a constant ratio takes away; see `RackBar.outline`."""
    pair, pitch = bar.pair, np.pi * bar.pair.module
    quarter = (np.pi / 2 - pair.alpha_n) / 4
    root = cutter_tip(pair, pair.fillet_radius * (1 - np.cos(quarter))) * [-1, 1] + [pitch / 2, 0]
    tip = np.array([[pitch / 4 - pair.rack_addendum * np.tan(pair.alpha_n), pair.rack_addendum]])
    tooth = [root[::-1] * [-1, 1], tip * [-1, 1], tip, root]
    first, last = pitch * (bar.teeth[0] - 0.5), pitch * (bar.teeth[-1] + 0.5)
    outside = 1.5 * pair.bar_radius - pair.reference_height
    outline = [np.array([each]) for each in ((first, outside), (first, -pair.rack_dedendum))]
    outline += [each + np.array([pitch * j, 0]) for j in bar.teeth for each in tooth]
    outline += [np.array([each]) for each in ((last, -pair.rack_dedendum), (last, outside))]
    start, stop = bar.sweep
    return brep.prism(
        [np.insert(each + np.array([0, pair.reference_height]), 0, 1, axis=1) @ start.T for each in outline],
        (stop - start)[:, 0],
    )


def _generated_faces(bar: RackBar) -> list[brep.Points]:
    """What the pinion takes away along the course of its ratio, but for the plane sides."""
    pair, rack = bar.pair, GeneratedRack.of(bar.pair)
    half, outside = bar.half_width, -1.5 * pair.bar_radius
    last = bar.teeth[-1]

    def root(j: int, begin: float, end: float) -> brep.Points:
        def points(s: np.ndarray, t: np.ndarray) -> np.ndarray:
            Z = half * (2 * t - 1)
            X, H = rack.root_curve(j, rack.root.end * (begin + s * (end - begin)), Z)
            return np.stack(np.broadcast_arrays(X, H - pair.bar_axis_height, Z), axis=-1)

        return points

    def flank(j: int, side: int) -> brep.Points:
        def points(s: np.ndarray, t: np.ndarray) -> np.ndarray:
            Z = half * (2 * t - 1)
            deep = rack.root_curve(j if side > 0 else j - 1, side * rack.root.end, Z)[1]
            H = rack.tip_height + s * (deep - rack.tip_height)
            return np.stack(
                np.broadcast_arrays(rack.flank(side, j, H, Z), H - pair.bar_axis_height, Z), axis=-1
            )

        return points

    def edge(surface: brep.Points, s: float, height: float | None = None) -> Curve:
        """An edge along t, or what is above or below it at a height."""
        raised = ([1, 1, 1], [0, 0, 0]) if height is None else ([1, 0, 1], [0, height, 0])
        return lambda t: surface(np.full((1, 1), s), t) * raised[0] + raised[1]

    def sheet(begin: Curve, end: Curve) -> brep.Points:
        return lambda s, t: begin(t) + s[..., None] * (end(t) - begin(t))

    roots = [root(j, float(j >= -last), -float(j < last)) for j in range(-last - 1, last + 1)]
    flanks = [flank(j, side) for j in bar.teeth for side in (-1, 1)]
    lands = [sheet(edge(a, 0.0), edge(b, 0.0)) for a, b in zip(flanks[::2], flanks[1::2], strict=True)]
    ends = (roots[0], 0.0), (roots[-1], 1.0)
    walls = [sheet(edge(*each), edge(*each, outside)) for each in ends]
    return [*roots, *flanks, *lands, *walls, sheet(*(edge(*each, outside) for each in ends))]


def _drilled(bars: tuple[RoundBar, tuple[RoundBar, ...]]) -> TopoDS_Shape:
    """A round bar from which others are taken away."""
    bar, holes = bars
    return reduce(brep.cut, (brep.round_bar(*hole) for hole in holes), brep.round_bar(*bar))


PARTS: dict[str, Callable[[SteeringGear], TopoDS_Shape]] = {
    "pinion": pinion_brep,
    "rack": rack_brep,
    "plunger": lambda gear: _drilled(plunger_bars(gear)),
    "yokenut": lambda gear: _drilled(yokenut_bars(gear)),
    "bush": lambda gear: _drilled(bush_segment_bars(gear)),
}
"""Parts by name, each in its own frame."""
