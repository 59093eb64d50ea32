"""The rack: a round bar with straight teeth milled into it.

Rack frame: origin on the bar's axis above the pitch point at rack displacement 0, axes parallel to the
housing's. The teeth point to -Y; tooth 0 is centred at X = 0. The bush is on the +X side.

    Z x chord        ____            end view: the teeth's tips are cut to a flat land, so that the
                    /    \\           bar's chord, and with it the face width, grows towards the root
                   (  +   )  bar axis
                    \\____/   root
                      --     tips (land)
                        -Y

A flank is a plane. On tooth j, side s (the side of the pinion flank it meets) it holds the point
j p_x X + s pi m_n / 4 u - h Y with the normal s cos alpha_n u - sin alpha_n Y, u across the teeth.
The flanks of a variable ratio are those of `generated_rack`.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from manifold3d import Manifold

from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.basic_rack import arc_segments, rack_tooth, sagitta, straight_depth
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.generated_rack import GeneratedRack
from rps_exudyn.gears.polyhedron import cylinder, lofted, prism
from rps_exudyn.parameters.gear import SteeringGear

MOST_TEETH = 2000
"""Of a rack's body; it takes 1.5 s to make."""
TRIAL = 8  # chords along each direction of a generated flank, by which their number is found
MOST_OF_FLANK = 4096  # pieces of one: fewer serve up to q_a / |Q| of 0.9, beyond which it has a corner


@dataclass(frozen=True, eq=False)
class RackFlank:
    """One plane flank and its edges, rack frame."""

    tooth: int
    side: int
    point: np.ndarray  # on the reference line, Z = 0 [m], shape (3,)
    normal: np.ndarray  # unit, out of the tooth, shape (3,)
    trace: np.ndarray  # unit vector along the tooth, shape (3,)
    tip_height: float  # Y of the tip line [m]
    form_height: float  # Y where the root fillet begins [m]
    bar_radius: float  # [m]

    def half_chord(self, Y: np.ndarray | float) -> np.ndarray:
        """Largest |Z| on the flank at height Y: the round bar's half chord [m]."""
        return np.sqrt(np.maximum(self.bar_radius**2 - np.square(Y), 0))


@dataclass(frozen=True)
class RackBar:
    """Ends of the bar and of its teeth."""

    pair: GearPair
    x_min: float  # ends of the bar [m]
    x_max: float
    teeth_each_way: int  # whole teeth on either side of tooth 0

    @classmethod
    def of(cls, gear: SteeringGear) -> "RackBar":
        """The bar ends `bush.end_overhang` outside the bush at full travel, and has teeth for the travel."""
        pair, bush, rack = GearPair.of(gear), gear.bush, gear.rack
        x_max = bush.distance + bush.length + rack.travel / 2 + bush.end_overhang
        needed = rack.travel / 2 + pinion_reach(pair)
        teeth = needed / pair.rack_pitch
        if pair.course is not None:
            teeth = np.abs(pair.angle_at(np.array([-needed, needed]))).max() * pair.teeth / (2 * np.pi)
        return cls(pair, x_max - rack.length, x_max, int(np.ceil(teeth)))

    @property
    def largest_displacement(self) -> float:
        """Largest displacement either way at which the pinion stays on the rack's teeth [m]."""
        return min(self._ways(self.teeth_each_way)) - pinion_reach(self.pair)

    def _ways(self, teeth: float) -> tuple[float, float]:
        """Distances of teeth, or of roots between them, from tooth 0 towards -X and +X [m]."""
        if self.pair.course is None:
            return teeth * self.pair.rack_pitch, teeth * self.pair.rack_pitch
        turn = 2 * np.pi * teeth / self.pair.teeth
        return float(self.pair.travel_at(turn)), -float(self.pair.travel_at(-turn))

    @property
    def reach(self) -> float:
        """Half the length of the toothed part on the bar's axis [m]."""
        return sum(self._ways(self.teeth_each_way + 0.5)) / 2

    @property
    def teeth(self) -> range:
        """Numbers of the teeth, in order of X."""
        return range(-self.teeth_each_way, self.teeth_each_way + 1)

    @cached_property
    def tip_height(self) -> float:
        """Y of the teeth's tips [m]."""
        return -self.pair.reference_height - self.pair.rack_addendum

    @cached_property
    def root_height(self) -> float:
        """Y of the teeth's roots [m]."""
        if self.pair.course is not None:
            return GeneratedRack.of(self.pair).root_height - self.pair.bar_axis_height
        return -self.pair.reference_height + self.pair.rack_dedendum

    @cached_property
    def toothed_ends(self) -> tuple[float, float]:
        """Smallest and largest X that the cutter reaches, at the bar's flanks [m]."""
        towards_low, towards_high = self._ways(self.teeth_each_way + 0.5)
        skew = self.pair.bar_radius * abs(np.tan(self.pair.beta_r))
        return -towards_low - skew, towards_high + skew

    def flank(self, tooth: int, side: int) -> RackFlank:
        """The flank of one tooth that meets the pinion's flanks of the same side, of a constant ratio."""
        pair = self.pair
        across = np.pi * pair.module * (tooth + side / 4)
        return RackFlank(
            tooth,
            side,
            # on Z = 0, u = X cos beta_r
            np.array([across / np.cos(pair.beta_r), -pair.reference_height, 0.0]),
            pair.rack_flank_normal(side),
            pair.trace,
            self.tip_height,
            -pair.reference_height + straight_depth(pair),
            pair.bar_radius,
        )

    def outline(self, chord_error: float) -> np.ndarray:
        """Return what the cutter leaves of the teeth and takes away below them: polygon (u, -Y) [m], (n, 2).

        Teeth from root middle to root middle, closed outside the bar; counter-clockwise.
        """
        tooth = rack_tooth(self.pair, chord_error)
        tooth[:, 1] += self.pair.reference_height  # -Y
        pitch = np.pi * self.pair.module
        teeth = np.concatenate([tooth[1:] + np.array([pitch * j, 0]) for j in self.teeth])
        first = tooth[:1] + np.array([pitch * self.teeth[0], 0])
        outside = 1.5 * self.pair.bar_radius
        close = np.array([[teeth[-1, 0], outside], [first[0, 0], outside]])
        return np.concatenate([first, teeth, close])

    def check_teeth(self) -> None:
        """Check that a body can be made.

        Raises:
            InputError: more teeth than can be modelled in seconds.
        """
        if len(self.teeth) > MOST_TEETH:
            raise InputError(
                f"rack.travel needs {len(self.teeth)} teeth on the rack; bodies are made of up to "
                f"{MOST_TEETH}, for a travel of about {MOST_TEETH * self.pair.rack_pitch:.2g} m."
            )

    def solid(self, chord_error: float) -> Manifold:
        """The bar with its teeth, rack frame, chords within `chord_error` [m].

        Raises:
            InputError: more teeth than can be modelled in seconds.
        """
        self.check_teeth()
        pair = self.pair
        segments = arc_segments(pair.bar_radius, 2 * np.pi, chord_error)
        bar = cylinder(pair.bar_radius, np.array([self.x_min, 0, 0]), np.array([self.x_max, 0, 0]), segments)
        if pair.course is not None:
            return bar - self._generated(chord_error)
        return bar - prism(self.outline(chord_error), *self.sweep)

    @property
    def sweep(self) -> tuple[np.ndarray, np.ndarray]:
        """Affine maps (3, 3) of (1, u, -Y) -> first and last place of the swept outline [m]."""
        pair = self.pair
        middle = np.column_stack([np.zeros(3), pair.cross_trace, [0, -1.0, 0]])
        # long enough for the bar's whole width at both ends of the slanted outline
        half = 1.2 * pair.bar_radius / np.cos(pair.beta_r) + self.toothed_ends[1] * abs(np.sin(pair.beta_r))
        along = np.column_stack([half * pair.trace, np.zeros((3, 2))])
        return middle - along, middle + along

    @property
    def half_width(self) -> float:
        """|Z| to which a generated rack's sections reach, outside the bar's width at the roots [m]."""
        return 1.02 * float(np.sqrt(max(self.pair.bar_radius**2 - self.root_height**2, 0.0)))

    def _generated(self, chord_error: float) -> Manifold:
        """Return what a pinion takes away along the course of its ratio: sections across the bar, lofted."""
        pair, rack, numbers = self.pair, GeneratedRack.of(self.pair), np.array(self.teeth)[:, None]
        half = self.half_width

        def sections(across: int, on_flank: int, on_root: int) -> np.ndarray:
            Z = np.linspace(-half, half, across + 1)
            teeth = rack.tooth(numbers, Z[None], on_flank + 1, on_root)
            Z = np.broadcast_to(Z[None, :, None], teeth.shape[:-1])
            return np.stack([teeth[..., 0], teeth[..., 1] - pair.bar_axis_height, Z], axis=-1)

        # on twice as fine a division the middles of chords leave them; their heights fall with 1 / n^2
        trial = sections(2 * TRIAL, 2 * TRIAL, 2 * TRIAL)
        side, root = slice(2 * TRIAL, 4 * TRIAL + 1), slice(0, 2 * TRIAL + 1)
        heights = [sagitta(trial, 1), sagitta(trial[:, :, side], 2), sagitta(trial[:, :, root], 2)]
        wanted = TRIAL * np.sqrt(np.array(heights) / (chord_error / 2))
        wanted[:2] *= min(1.0, np.sqrt(MOST_OF_FLANK / (wanted[0] * wanted[1])))
        teeth = sections(*(max(int(np.ceil(each)), 1) for each in wanted.tolist()))
        joined = np.concatenate([teeth[0, :, :1], *(teeth[:, :, 1:])], axis=1)
        end = np.full((len(joined), 1), -1.5 * pair.bar_radius)
        ends = [np.stack([joined[:, at, :1], end, joined[:, at, 2:]], axis=-1)[:, 0] for at in (-1, 0)]
        closed = np.concatenate([joined, *(each[:, None] for each in ends)], axis=1)
        first, last = ((each[:, :2] * [1, -1]) for each in (closed[0], closed[-1]))
        return lofted(closed, first, last)


def pinion_reach(pair: GearPair) -> float:
    """Length of rack on either side of the pitch point that the pinion may touch [m]."""
    skew = pair.face_width / 2 * (abs(np.sin(pair.delta)) + abs(np.tan(pair.beta_r)))
    return float(pair.tip_radius + skew)
