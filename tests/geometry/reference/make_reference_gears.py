"""Makes reference_gears.json: tooth forms of seven gears, computed without this package.

    pip install py_gearworks==0.0.24          # in an environment of its own
    python make_reference_gears.py

Flanks, and the trochoid of a sharp-cornered cutter, come from py_gearworks (Gergely Bencsik, Apache 2.0),
which finds them by intersecting curves numerically. Roots of rounded cutters, which it does not know, come
from the definition of a generated tooth space: at radius R it is as wide as the widest place that any point
of the cutter at that radius reaches while it rolls by (`space_half_angle`); no law of gearing is used.
Lengths in modules, angles in radians.
"""

import json
import re
from importlib.metadata import version
from pathlib import Path

import numpy as np
from py_gearworks.base_classes import ToothLimitParam
from py_gearworks.gearteeth import InvoluteUndercutTooth
from scipy.optimize import brentq, minimize_scalar

DEGREE = np.pi / 180
# teeth, pressure angle, helix angle, profile shift, dedendum, fillet radius, tip radius
GEARS = {
    "paper": (6, 20, 25, 1.0, 1.25, 0.38, 4.95),
    "five teeth": (5, 20, 25, 0.9, 1.25, 0.38, 4.2),
    "undercut": (6, 20, 25, 0.3, 1.25, 0.38, 4.4),
    "left hand": (8, 17.5, -30, 0.6, 1.25, 0.3, 6.0),
    "spur, sharp cutter": (12, 20, 0, 0.5, 1.25, 0.0, 7.3),
    "undercut, sharp cutter": (8, 20, 15, 0.0, 1.2, 0.0, 5.0),
    "twenty teeth": (20, 25, 12, 0.1, 1.25, 0.25, 11.2),
}


def transverse(gear):
    teeth, alpha, beta, shift, *_ = gear
    r = teeth / (2 * np.cos(beta * DEGREE))
    alpha_t = np.arctan(np.tan(alpha * DEGREE) / np.cos(beta * DEGREE))
    half = (np.pi / 2 + 2 * shift * np.tan(alpha * DEGREE)) / teeth  # half angle of the tooth at r
    return r, alpha_t, half


def flank(gear, radii):
    """Half angles of the tooth on the involute."""
    curve = tooth(gear).generate_involute_curve()[1]
    return [polar(curve, radius, 0.0, 2.0)[1] for radius in radii]


def sharp_root(gear, count):
    """Points (R, half angle of the tooth) on py_gearworks' trochoid, and where it meets the involute."""
    chain = tooth(gear).generate_tooth_curve()
    start = np.hypot(*chain[1](0)[:2])
    points = [chain[0](t)[:2] for t in np.linspace(0, 1, count + 2)[1:-1]]
    points = [(float(np.hypot(*p)), float(abs(np.arctan2(p[1], p[0])))) for p in points]
    deepest = min(range(count), key=lambda i: points[i][0])  # what is before it lies inside the tooth space
    return float(start), points[deepest + 1 :]


def tooth(gear):
    teeth, _, _, shift, dedendum, _, tip = gear
    r, alpha_t, half = transverse(gear)
    limits = ToothLimitParam(h_a=tip - r, h_d=dedendum - shift, h_o=2.0)
    return InvoluteUndercutTooth(half, r, 0, alpha_t, limits, 2 * np.pi / teeth)


def polar(curve, radius, low, high):
    t = brentq(lambda t: np.hypot(*curve(t)[:2]) - radius, low, high, xtol=1e-15, rtol=8.9e-16)
    x, y = curve(t)[:2]
    return t, float(abs(np.arctan2(y, x)))


def cutter_half_width(gear, depth):
    """Half width of the cutter's tooth across its trace, `depth` below the reference line."""
    _, alpha, _, _, dedendum, rho, _ = gear
    alpha *= DEGREE
    centre_depth = dedendum - rho
    centre = np.pi / 4 - centre_depth * np.tan(alpha) - rho / np.cos(alpha)
    if depth <= centre_depth + rho * np.sin(alpha):
        return np.pi / 4 - depth * np.tan(alpha)
    return centre + np.sqrt(max(rho**2 - (depth - centre_depth) ** 2, 0.0))


def space_half_angle(gear, radius):
    """Half the tooth space at `radius`: the widest place the rolling cutter reaches there."""
    teeth, _, beta, shift, dedendum, _, _ = gear
    r = teeth / (2 * np.cos(beta * DEGREE))
    root = r + shift - dedendum
    widest = np.arccos(root / radius)

    def reach(angle):  # of the cutter's point at (radius, angle from Y): what it adds by rolling with it
        height = radius * np.cos(angle)
        half = cutter_half_width(gear, r + shift - height) / np.cos(beta * DEGREE)
        roll = (radius * np.sin(angle) - half) / r  # the cutter's right side is at this angle at this roll
        return angle - roll

    grid = np.linspace(-widest, widest, 4001)
    best = grid[int(np.argmax([reach(angle) for angle in grid]))]
    step = grid[1] - grid[0]
    found = minimize_scalar(
        lambda angle: -reach(angle),
        bounds=(max(best - step, -widest), min(best + step, widest)),
        method="bounded",
        options={"xatol": 1e-12},
    )
    return float(max(-found.fun, reach(widest), reach(-widest)))


def reference(gear):
    teeth, _, _, shift, dedendum, rho, tip = gear
    r, alpha_t, _ = transverse(gear)
    base, root = r * np.cos(alpha_t), r + shift - dedendum
    outer = np.linspace(max(base, root) + 0.4 * (tip - max(base, root)), tip, 6)
    inner = np.linspace(root, max(base, root) + 0.4 * (tip - max(base, root)), 9)[1:]
    entry = {
        "teeth": teeth,
        "pressure_angle": gear[1] * DEGREE,
        "helix_angle": gear[2] * DEGREE,
        "profile_shift": shift,
        "dedendum": dedendum,
        "fillet_radius": rho,
        "tip_radius": tip,
        "flank": [[float(R), half] for R, half in zip(outer, flank(gear, outer), strict=True)],
        "space": [[float(R), space_half_angle(gear, R)] for R in inner],
    }
    if rho == 0 and base > root:
        entry["sharp_form_radius"], entry["sharp_root"] = sharp_root(gear, 10)
    return entry


def compact(table):
    """JSON with one line per number pair."""
    return re.sub(r"\[\s+([-\d.e]+),\s+([-\d.e]+)\s+\]", r"[\1, \2]", json.dumps(table, indent=1))


if __name__ == "__main__":
    table = {
        "made_with": f"py_gearworks {version('py_gearworks')}",
        "gears": {name: reference(gear) for name, gear in GEARS.items()},
    }
    target = Path(__file__).with_name("reference_gears.json")
    target.write_text(compact(table) + "\n")
