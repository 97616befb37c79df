"""The sides of a hole as functions, for tripatch.Side.from_functions: nothing of a mesh in them.

Side k of TriPatch is opposite corner k; in holes.py it has the number k + 1.
"""

from __future__ import annotations

import numpy as np
import tripatch
from numpy.polynomial import chebyshev

from .holes import Hole, unit

DEGREES = (30, 60, 120, 240)  # of the Chebyshev series along a side: the least whose tail is rounding
RADIUS, TURNS = 0.05, 2 * np.pi * np.arange(16) / 16  # of Cauchy's integrals across it


def _series(f):
    """A function of t in [0, 1], (k,) -> (k,) or (k, 3), as the coefficients of its Chebyshev series in 2 t - 1."""
    for degree in DEGREES:
        series = chebyshev.chebinterpolate(lambda x: f((x + 1) / 2), degree)
        if np.abs(series[-3:]).max() < 1e-12 * np.abs(series).max():
            break
    return series


def _value(series, t):
    return chebyshev.chebval(2 * np.asarray(t) - 1, series).T


def _slope(series):
    return 2 * chebyshev.chebder(series)


def _across(hole: Hole, i):
    """First and second derivative of the strip across side i, as functions of t."""

    def derivative(order):
        def of(t):
            d = np.tile(RADIUS * np.exp(1j * TURNS), len(t))
            points = hole.strip(i, np.repeat(t, len(TURNS)), d)[0].reshape(len(t), len(TURNS), 3)
            return order * (points * np.exp(-1j * order * TURNS)[:, None]).mean(1).real / RADIUS**order

        return of

    return derivative(1), derivative(2)


def _sides(hole: Hole):
    """Series of position and of the first and second derivative across, of TriPatch's sides 0, 1, 2."""
    for k in range(3):
        i = (k + 1) % 3
        first, second = _across(hole, i)
        yield _series(lambda t, i=i: hole.strip(i, t, np.zeros(len(t)))[0]), _series(first), _series(second)


def chart(hole: Hole) -> list:
    """Sides with the derivatives of the hole's own strips."""
    return [
        tripatch.Side.from_functions(
            lambda t, c=c: _value(c, t),
            lambda t, c=c: _value(_slope(c), t),
            lambda t, r=r: _value(r, t),
            q=lambda t, q=q: _value(q, t),
        )
        for c, r, q in _sides(hole)
    ]


def arc_length(hole: Hole) -> list:
    """The same sides by arc length, with unit conormals and the normal curvature across: all that the geometry alone tells."""
    return [_by_arc_length(*series) for series in _sides(hole)]


def _by_arc_length(c, r, q):
    dc, ddc, dr = _slope(c), _slope(_slope(c)), _slope(r)
    length = chebyshev.chebint(_series(lambda t: np.linalg.norm(_value(dc, t), axis=1))) / 2
    start, whole = _value(length, 0.0), _value(length, 1.0) - _value(length, 0.0)
    t_known = np.linspace(0, 1, 1001)
    u_known = (_value(length, t_known) - start) / whole

    def speed(t):
        return np.linalg.norm(_value(dc, t), axis=1, keepdims=True)

    def place(u):
        t = np.interp(u, u_known, t_known)
        for _ in range(4):
            t = np.clip(t - (_value(length, t) - start - whole * u) / speed(t)[:, 0], 0, 1)
        return t

    def conormal(t):
        """The part of r at a right angle to the side, and how much of c' was taken off."""
        along, across = _value(dc, t), _value(r, t)
        slant = (along * across).sum(1, keepdims=True) / speed(t) ** 2
        return across - slant * along, slant

    def curvature(u):
        t = place(u)
        across, slant = conormal(t)
        normal = unit(np.cross(_value(r, t), _value(dc, t)))
        second = _value(q, t) - 2 * slant * _value(dr, t) + slant**2 * _value(ddc, t)
        return normal * (normal * second).sum(1, keepdims=True) / (across**2).sum(1, keepdims=True)

    return tripatch.Side.from_functions(
        lambda u: _value(c, place(u)),
        lambda u: _value(dc, place(u)) * whole / speed(place(u)),
        lambda u: unit(conormal(place(u))[0]),
        q=curvature,
    )
