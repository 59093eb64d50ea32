"""Rigid motion from a body's node coordinates: Exudyn's RotationRxyz in compiled form.

Angles (a, b, c) turn a body by Rx(a) Ry(b) Rz(c); its angular velocity is G (a', b', c'). A force f and a
moment m about the body's reference point act on the coordinates as (f, G^T m).
"""

from typing import NamedTuple

import numpy as np

from rps_exudyn.base.compiled import inline

Vector = tuple[float, float, float]


def rotation_matrix(angles: np.ndarray) -> np.ndarray:
    """Return the rotation body -> housing, shape (3, 3), of angles (3,) [rad]."""
    matrix = np.empty((3, 3))
    fill_rotation.py_func(angles, matrix)
    return matrix


@inline
def fill_rotation(angles, matrix):  # type: ignore[no-untyped-def]
    """Fill the rotation body -> housing (3, 3)."""
    ca, sa = np.cos(angles[0]), np.sin(angles[0])
    cb, sb = np.cos(angles[1]), np.sin(angles[1])
    cc, sc = np.cos(angles[2]), np.sin(angles[2])
    matrix[0, 0], matrix[0, 1], matrix[0, 2] = cb * cc, -cb * sc, sb
    matrix[1, 0], matrix[1, 1], matrix[1, 2] = ca * sc + sa * sb * cc, ca * cc - sa * sb * sc, -sa * cb
    matrix[2, 0], matrix[2, 1], matrix[2, 2] = sa * sc - ca * sb * cc, sa * cc + ca * sb * sc, ca * cb


def spin_map(angles: np.ndarray) -> np.ndarray:
    """Return G: angle rates -> angular velocity in the housing frame, shape (3, 3)."""
    ca, sa = np.cos(angles[0]), np.sin(angles[0])
    cb, sb = np.cos(angles[1]), np.sin(angles[1])
    return np.array([[1.0, 0.0, sb], [0.0, ca, -sa * cb], [0.0, sa, ca * cb]])


# --- vectors as tuples, which need no memory ---------------------------------------------------------
@inline
def vector(x):  # type: ignore[no-untyped-def]
    """An array (3,) as a tuple."""
    return x[0], x[1], x[2]


@inline
def plus(a, b):  # type: ignore[no-untyped-def]
    """The sum a + b."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@inline
def minus(a, b):  # type: ignore[no-untyped-def]
    """The difference a - b."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@inline
def scaled(k, a):  # type: ignore[no-untyped-def]
    """The multiple k a."""
    return k * a[0], k * a[1], k * a[2]


@inline
def dot(a, b):  # type: ignore[no-untyped-def]
    """The scalar product a . b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inline
def cross(a, b):  # type: ignore[no-untyped-def]
    """The vector product a x b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


class Turn(NamedTuple):
    """A body's x axis, and how its spin follows from the rates of its angles."""

    axis: Vector  # in the housing
    about_b: Vector  # spin per rate of the second angle; of the first it is (1, 0, 0)
    about_c: Vector  # and of the third


@inline
def turn_of(angles):  # type: ignore[no-untyped-def]
    """The first column of the rotation matrix and the last two of G."""
    ca, sa = np.cos(angles[0]), np.sin(angles[0])
    cb, sb = np.cos(angles[1]), np.sin(angles[1])
    cc, sc = np.cos(angles[2]), np.sin(angles[2])
    return Turn(
        (cb * cc, ca * sc + sa * sb * cc, sa * sc - ca * sb * cc), (0.0, ca, sa), (sb, -sa * cb, ca * cb)
    )


@inline
def spin_of(turn, rates):  # type: ignore[no-untyped-def]
    """Angular velocity G (a', b', c')."""
    b, c = turn.about_b, turn.about_c
    return rates[0] + c[0] * rates[2], b[1] * rates[1] + c[1] * rates[2], b[2] * rates[1] + c[2] * rates[2]


@inline
def on_angles(turn, moment):  # type: ignore[no-untyped-def]
    """Moments on the angles, G^T m."""
    return moment[0], dot(turn.about_b, moment), dot(turn.about_c, moment)
