"""Ellipses and splines as polylines whose distance from the curve is measured."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import FloatArray

MOST_SEGMENTS = 200_000

_LOOKED_AT = np.array([0.0, 0.25, 0.5, 0.75, 1.0])
"""Places on a stretch of the curve: its ends, and where its distance from the chord is measured; three, since a
stretch with a turning point may meet its chord in the middle."""

_GREATEST = 1e100
"""Coordinate whose square is a number still."""

Curve = Callable[[FloatArray], FloatArray]
"""Places of shape ``(n, 3)`` on a curve at parameters of shape ``(n,)``."""


def polyline_of(entity: Any, tolerance: float) -> tuple[FloatArray, float]:
    """Turn an ELLIPSE or SPLINE into a polyline with its vertices on the curve.

    Parameters
    ----------
    entity
        The ezdxf entity.
    tolerance
        Largest distance of the curve from the polyline, in drawing units.

    Returns
    -------
    (points, distance)
        Points of shape ``(n, 3)``, and the largest distance that was measured.

    Raises
    ------
    InputError
        The polyline needs more than `MOST_SEGMENTS` segments.
    """
    curve, parameters = (_ellipse if entity.dxftype() == "ELLIPSE" else _spline)(entity)
    return flatten(curve, parameters, tolerance)


def flatten(curve: Curve, parameters: FloatArray, tolerance: float) -> tuple[FloatArray, float]:
    """Halve stretches of a curve until each lies within the tolerance of its chord; results as in `polyline_of`."""
    start, end = parameters[:-1], parameters[1:]
    done: list[FloatArray] = []
    distance = 0.0
    count = 0
    while len(start):
        at = start[:, None] + (end - start)[:, None] * _LOOKED_AT
        places = curve(at.ravel()).reshape(*at.shape, 3)
        if not (np.abs(places) < _GREATEST).all():
            raise InputError("a coordinate is NaN, infinite or absurd; draw the entity again")
        away = _from_chord(places)
        near = away <= tolerance
        distance = max(distance, float(away[near].max(initial=0.0)))
        done.append(start[near])
        count += len(start)
        if count > MOST_SEGMENTS:
            raise InputError(f"it needs more than {MOST_SEGMENTS} segments; draw it again or allow more flattening")
        start, end, middle = start[~near], end[~near], at[~near, 2]
        start, end = np.concatenate([start, middle]), np.concatenate([middle, end])
    return curve(np.append(np.sort(np.concatenate(done)), parameters[-1])), distance


def _from_chord(places: FloatArray) -> FloatArray:
    """Largest distance of the places between both ends of a stretch from its chord, shape ``(n,)``."""
    chord = places[:, -1] - places[:, 0]
    out = places[:, 1:-1] - places[:, :1]
    square = (chord**2).sum(axis=1)[:, None]
    along = (out * chord[:, None, :]).sum(axis=2) / np.where(square > 0, square, 1.0)
    foot = np.clip(along, 0.0, 1.0)[..., None] * chord[:, None, :]
    return np.asarray(np.sqrt(((out - foot) ** 2).sum(axis=2)).max(axis=1), dtype=np.float64)


def _ellipse(entity: Any) -> tuple[Curve, FloatArray]:
    tool = entity.construction_tool()
    centre, major, minor = (np.array(tuple(axis)) for axis in (tool.center, tool.major_axis, tool.minor_axis))
    span = tool.param_span
    if not (np.isfinite([*centre, *major, *minor]).all() and math.isfinite(span)):
        raise InputError("a coordinate or parameter is NaN or infinite; draw the entity again")

    def curve(t: FloatArray) -> FloatArray:
        return np.asarray(centre + np.cos(t)[:, None] * major + np.sin(t)[:, None] * minor, dtype=np.float64)

    return curve, tool.start_param + np.linspace(0.0, span, 9)


def _spline(entity: Any) -> tuple[Curve, FloatArray]:
    tool = entity.construction_tool()
    knots = np.array(tool.knots())
    if not np.isfinite(knots).all():
        raise InputError("a knot is NaN or infinite; draw the entity again")
    # a curve whose knots do not crowd at its ends is defined between these two only
    first, last = knots[tool.order - 1], knots[tool.count]
    inner = np.unique(knots[(knots >= first) & (knots <= last)])
    parameters = np.append((inner[:-1, None] + np.diff(inner)[:, None] * [0.0, 0.25, 0.5, 0.75]).ravel(), inner[-1])

    def curve(t: FloatArray) -> FloatArray:
        return np.array([tuple(place) for place in tool.points(t.tolist())], dtype=np.float64).reshape(-1, 3)

    return curve, parameters
