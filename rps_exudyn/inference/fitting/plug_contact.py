"""The contact of plunger and yoke plug once per turn, from the curves of a free torque in both directions.

An eccentric pinion lifts the rack by e cos(phi), phi counted from its high point. Where that exceeds the
clearance c, the plug stops the plunger with a stiffness k. With r = max(0, cos(phi) - c / e), and the part
T_P of the torque that the preload P makes,

    half the difference of both directions rises by g r,  g = T_P / P k e,
    half the sum is -(P e + k e^2 r) sin(phi).

The width of the rise states c / e; its size and the half sum state e. The depth is e - c.
"""

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from rps_exudyn.inference.fitting.level_fit import stepped
from rps_exudyn.inference.fitting.noise import waves
from rps_exudyn.inference.fitting.unknowns import settings_of
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.solvers.closed_form import first_order_torque, torque_per_preload
from rps_exudyn.solvers.yoke_stop import stop_stiffness

if TYPE_CHECKING:
    from rps_exudyn.inference.fitting.fitted import Fit

SECTIONS = 72  # of a turn, whose medians noise and spikes hardly move
HALF_WIDTHS = np.radians(np.arange(15.0, 181.0, 5.0))  # of the rise; 180 degrees: contact all the way
SEEN = 20.0  # chi squared of a rise, three unknowns: 2e-4 by chance
AS_GOOD = 6.0  # chi squared by which waves of any phase, as of a coupling, may explain the curves better
STIFFNESS = 0.2  # standard deviation of the stop's: ISO 6336-1 against measured stiffness of teeth
UNLIKELY = 9.2  # chi squared of what states the runout, two degrees of freedom: 1 % by chance
LEAST_PART = 0.05  # of a torque that a contact leaves to friction without it
SURE = 0.01  # least deviation of a preload's logarithm


@dataclass(frozen=True)
class PlugContact:
    """The plunger touches the plug once per turn."""

    angle: float  # of the pinion in the file, where it is deepest [rad]
    rise: float  # of the friction torque there [N m]
    mean_rise: float  # over a turn [N m]
    clearance: float  # below 0 where it touches all the way [m]
    depth: float  # [m]
    depth_sd: float  # standard deviation of its logarithm


@dataclass(frozen=True)
class _Rise:
    """A rise of a half width, at the phase where it explains friction and half sum best."""

    width: float  # [rad]
    high: float  # angle of its middle [rad]
    squares: np.ndarray  # of friction and half sum that it leaves (2,)
    gains: np.ndarray  # of friction's rise, of the runout's wave and of its rise (3,) [N m]
    units: np.ndarray  # their standard deviations for a unit of noise (3,)
    inflation: np.ndarray  # of the variance of friction and half sum, as neighbours are correlated (2,)

    @property
    def mean(self) -> float:
        """Mean over a turn of friction's rise."""
        return float(self.gains[0] * (np.sin(self.width) - self.width * np.cos(self.width)) / np.pi)


def preload_part(gear: SteeringGear, mean: float) -> float:
    """Return the part of a mean free torque that the spring's force makes [N m]."""
    return float(mean * torque_per_preload(gear) * gear.yoke.preload / first_order_torque(gear))


def plug_contact(fit: "Fit") -> PlugContact | None:
    """Return the contact of plunger and plug once per turn; None where the curves show none.

    A coupling has a wave of any phase: a rise counts if it explains friction and half sum as well as that.
    """
    if fit.level is None or "pinion.runout" not in {each.path for each in fit.problem.unknowns}:
        return None
    angle, friction, stored = _sections(fit)
    teeth, turn = fit.gear.pinion.teeth, 2 * np.pi
    of_teeth = [
        n * teeth + beside for n in (1, 2) for beside in (-1, 0, 1)
    ]  # their ripple grows with the load
    plain = np.column_stack([np.ones_like(angle), waves(angle, turn, of_teeth)])
    if angle.size < 2 * plain.shape[1]:
        return None
    with_wave = np.column_stack([plain, waves(angle, turn, (1,))])
    of_waves, nothing = (
        np.array([_left(columns, each) for each in (friction, stored)]) for columns in (with_wave, plain)
    )
    nothing[1] = of_waves[1]  # a runout needs no contact
    phased = (_best_phase(plain, angle, friction, stored, width) for width in HALF_WIDTHS)
    tried = [each for each in phased if each is not None]
    if not tried:
        return None
    best = min(tried, key=lambda each: float(each.squares.sum()))
    variance = best.squares * best.inflation / (angle.size - plain.shape[1] - 2)
    if sum((nothing - best.squares) / variance) < SEEN or max((best.squares - of_waves) / variance) > AS_GOOD:
        return None
    level = fit.level.value
    gear = _gear_of_level(fit, level - best.mean)
    found = [_runout_of(gear, fit.preload_sd, level - each.mean, each, variance) for each in tried]
    lifts, sds, doubts = np.array(found).T
    if min(doubts) > UNLIKELY:
        return None
    doubts = doubts + [sum((each.squares - best.squares) / variance) for each in tried]
    weight = np.exp((min(doubts) - doubts) / 2)
    weight /= weight.sum()
    cosines = np.cos([each.width for each in tried])
    depths = lifts + np.log(1 - cosines)
    depth = float(weight @ depths)
    return PlugContact(
        angle=best.high,
        rise=float(weight @ ((1 - cosines) * [each.gains[0] for each in tried])),
        mean_rise=float(weight @ [each.mean for each in tried]),
        clearance=float(weight @ (np.exp(lifts) * cosines)),
        depth=float(np.exp(depth)),
        depth_sd=float(np.sqrt(weight @ ((depths - depth) ** 2 + sds**2))),
    )


def _sections(fit: "Fit") -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Angles of sections of a turn in the file, by how much friction exceeds that of the fitted gear there,
    and half the sum of both directions, (n,) each [N m]."""
    assert fit.level is not None
    ways = []
    for direction in (1, -1):
        passes = [p for p in fit.passes if p.test == fit.level.test.title and p.direction == direction]
        turns = np.concatenate([each.angle for each in passes]) / (2 * np.pi)
        place = np.minimum((turns % 1.0 * SECTIONS).astype(int), SECTIONS - 1)
        beside = np.concatenate([direction * (each.value - each.model) for each in passes])
        values = np.concatenate([each.value for each in passes])
        pairs = [(beside[place == i], values[place == i]) for i in range(SECTIONS)]
        ways.append([[np.median(each) if each.size else np.nan for each in pair] for pair in pairs])
    friction, stored = np.mean(ways, axis=0).T
    angle, kept = (np.arange(SECTIONS) + 0.5) * 2 * np.pi / SECTIONS, np.isfinite(friction)
    return angle[kept], friction[kept], stored[kept]


def _left(columns: np.ndarray, values: np.ndarray) -> float:
    """Sum of the squares that columns leave of values."""
    left = values - columns @ np.linalg.lstsq(columns, values, rcond=None)[0]
    return float(left @ left)


def _best_phase(
    plain: np.ndarray, angle: np.ndarray, friction: np.ndarray, stored: np.ndarray, width: float
) -> _Rise | None:
    """The best rise of a half width; None if none has all three parts."""
    basis, best = np.linalg.qr(plain)[0], None
    phases = np.arange(0, 2 * np.pi, 2 * np.pi / SECTIONS)
    phi = angle[:, None] - phases
    rises, swings = np.maximum(0.0, np.cos(phi) - np.cos(width)), -np.sin(phi)
    sets = (rises, swings, rises * swings, friction, stored)
    rise, wave, risen, friction, stored = (each - basis @ (basis.T @ each) for each in sets)
    for i, phase in enumerate(phases.tolist()):
        left, gains, units = [], [], []
        of_sum = np.column_stack([wave[:, i], risen[:, i]])
        for columns, values in ((rise[:, [i]], friction), (of_sum, stored)):
            inverse = np.linalg.inv(columns.T @ columns)
            found = inverse @ columns.T @ values
            left.append(values - columns @ found)
            gains += [*found]
            units += [*np.sqrt(np.diag(inverse))]
        squares = np.array([each @ each for each in left])
        if min(gains) > 0 and (best is None or squares.sum() < best.squares.sum()):
            lags = np.clip([each[1:] @ each[:-1] / (each @ each) for each in left], 0.0, 0.9)
            best = _Rise(width, phase, squares, np.array(gains), np.array(units), (1 + lags) / (1 - lags))
    return best


def _gear_of_level(fit: "Fit", level: float) -> SteeringGear:
    """The fitted gear, if the level of the free torque had been another one [N m]."""
    assert fit.level is not None
    rows, unknowns = fit.model.rows, list(fit.model.unknowns)
    of_level = rows.scaled & [test.of_kind.by_angle for test in rows.tests]
    factor = max(level / fit.level.value, LEAST_PART)
    model = replace(fit.model, rows=replace(rows, values=np.where(of_level, factor, 1.0) * rows.values))
    return fit.gear.replace(settings_of(unknowns, stepped(model, fit.ended.u).u))


def _runout_of(
    gear: SteeringGear, preload_sd: float, level: float, rise: _Rise, variance: np.ndarray
) -> tuple[float, float, float]:
    """Logarithm of the runout [m] that a rise shows, its deviation, and chi squared of what states it.

    Least squares of the logarithms of e, P and k: P e, k e / P and k e^2 are measured, P and k are known to
    some extent.
    """
    part = preload_part(gear, max(level, LEAST_PART * rise.mean))
    relative = np.sqrt(variance[[0, 1, 1]]) * rise.units / rise.gains
    rows = np.array([(1, -1, 1), (1, 1, 0), (2, 0, 1), (0, 1, 0), (0, 0, 1)], dtype=float)
    known = np.log([*rise.gains / [part, 1.0, 1.0], gear.yoke.preload, stop_stiffness(gear)])
    sds = np.array([*relative, max(preload_sd, SURE), STIFFNESS])
    rows, known = rows / sds[:, None], known / sds
    covariance = np.linalg.inv(rows.T @ rows)
    left = known - rows @ (found := covariance @ rows.T @ known)
    return float(found[0]), float(np.sqrt(covariance[0, 0])), float(left @ left)
