"""DXF entities as pieces of outlines: what is known of each kind, and why others are refused."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from camwright.bender.dxf_curves import polyline_of
from camwright.bender.piece import Piece
from camwright.profiles.errors import InputError
from camwright.profiles.notice import Notice, Number

_FRAME = 16
"""Flag of a vertex that frames a fitted spline and is no part of the line."""

MOST_BULGE = 1e6
"""Greatest bulge: above it, a circle of a quarter of a million chords, the chord is what was drawn."""

_PLANE = 1e-9
"""Difference of height, in drawing units, up to which an entity lies in a plane."""


def title(entity: Any, origin: str = "", layer: str | None = None) -> Notice:
    """Kind, handle and layer of an entity, for messages; of one inside a block also where it is placed."""
    source = entity if entity.dxf.handle else entity.source_of_copy
    what = entity.dxftype() if source is None else f"{entity.dxftype()} #{source.dxf.handle}"
    shown = entity.dxf.layer if layer is None else layer
    if origin:
        return Notice("{what} in block reference {origin} on layer {layer}", what=what, origin=origin, layer=shown)
    return Notice("{what} on layer {layer}", what=what, layer=shown)


def is_line_work(entity: Any) -> bool:
    """Whether an entity is of a kind that can be bent."""
    return entity.dxftype() in _READERS


@dataclass(frozen=True, eq=False)
class Drawn:
    """What an entity gives.

    Parameters
    ----------
    piece
        The line (drawing units); ``None`` if the entity has no length.
    notes
        What of it was left out or taken otherwise.
    """

    piece: Piece | None
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Resolution:
    """How finely a drawing is read, in drawing units.

    Parameters
    ----------
    flattening
        Largest distance of a curve from its polyline.
    least
        Length below which a segment has none.
    greatest
        Greatest coordinate that is believed.
    """

    flattening: float
    least: float
    greatest: float


def piece_of(entity: Any, name: str, resolution: Resolution) -> Drawn:
    """Turn an entity of line work into a piece.

    Parameters
    ----------
    entity
        The ezdxf entity.
    name
        What it is called in messages.
    resolution
        How finely the drawing is read.

    Raises
    ------
    InputError
        The entity is line work that cannot be bent: not flat, without length, not finite.
    """
    try:
        points, bulges, distance = _READERS[entity.dxftype()](entity, resolution.flattening)
    except InputError as error:
        raise InputError(*(f"{name}: {fault}" for fault in error.faults)) from error
    except Exception as error:  # whatever the library makes of NaN, missing or absurd numbers
        reason = str(error) or type(error).__name__
        raise InputError(f"{name}: its geometry cannot be used: {reason}") from error
    if not (np.isfinite(points).all() and np.isfinite(bulges).all()):
        raise InputError(f"{name}: a coordinate or bulge is NaN or infinite; draw the entity again")
    if len(points) and float(np.abs(points).max()) > resolution.greatest:
        raise InputError(
            f"{name}: a coordinate of {np.abs(points).max():g}, beyond the {resolution.greatest:g} that are believed; move the "
            "drawing to its origin"
        )
    if len(bulges) == 0:
        return Drawn(None, (Notice("{name} (no length)", name=name),))
    return cleaned(Piece(points, bulges, name, distance), resolution.least)


def cleaned(piece: Piece, least: float) -> Drawn:
    """Leave out what has no length, and take arcs that no machine could tell from a line as lines."""
    points, bulges = piece.points, piece.bulges
    notes: list[str] = []
    absurd = np.abs(bulges) > MOST_BULGE
    if absurd.any():
        bulge = Number(float(bulges[absurd][0]), "g")
        notes.append(Notice("bulge {bulge} of {name}, taken as a line", bulge=bulge, name=piece.name))
        bulges = np.where(absurd, 0.0, bulges)
    chord = np.hypot(*np.diff(points, axis=0).T)
    lasting = (chord > 0) & (chord * np.maximum(np.abs(bulges), 1.0) > least)
    if not lasting.any():
        return Drawn(None, (Notice("{name} (no length)", name=piece.name),))
    if not lasting.all():
        notes.append(Notice("segment without length of {name}", name=piece.name))
        points, bulges = points[np.concatenate([[True], lasting])], bulges[lasting]
        if piece.closed:
            points[-1] = points[0]
    return Drawn(replace(piece, points=points, bulges=bulges), tuple(notes))


def _flat(heights: ArrayLike) -> None:
    z = np.asarray(heights, dtype=np.float64)
    if len(z) and float(np.ptp(z)) > _PLANE:
        raise InputError(
            f"it is three-dimensional, from z = {z.min():g} to {z.max():g}; flatten it to one height, a die line is a "
            "plane drawing"
        )


def _sense(entity: Any) -> float:
    """Tell whether an entity is drawn on the plane's face (1) or seen from behind (-1)."""
    direction = entity.dxf.extrusion
    if abs(direction.x) > _PLANE or abs(direction.y) > _PLANE or direction.z == 0:
        raise InputError(f"its plane is tilted (extrusion {direction}); turn it into the drawing plane")
    return math.copysign(1.0, direction.z)


def _polyline(
    points: list[tuple[float, float]], bulges: list[float], closed: bool, sense: float
) -> tuple[Any, Any, float]:
    if closed and len(points) > 1:
        if points[-1] == points[0]:
            bulges = bulges[:-1]
        else:
            points = [*points, points[0]]
    else:
        bulges = bulges[:-1]
    places = np.array(points, dtype=np.float64).reshape(-1, 2) * [sense, 1.0]
    return places, np.array(bulges, dtype=np.float64) * sense, 0.0


def _lwpolyline(entity: Any, _: float) -> tuple[Any, Any, float]:
    rows = entity.get_points("xyb")
    return _polyline([(x, y) for x, y, _ in rows], [b for _, _, b in rows], bool(entity.closed), _sense(entity))


def _old_polyline(entity: Any, _: float) -> tuple[Any, Any, float]:
    if entity.is_polygon_mesh or entity.is_poly_face_mesh:
        raise InputError("it is a mesh, not a line; remove it")
    vertices = [vertex for vertex in entity.vertices if not vertex.dxf.flags & _FRAME]
    places = [vertex.dxf.location for vertex in vertices]
    _flat([place.z for place in places])
    sense = 1.0 if entity.is_3d_polyline else _sense(entity)
    bulges = [vertex.dxf.get("bulge", 0.0) for vertex in vertices]
    return _polyline([(place.x, place.y) for place in places], bulges, bool(entity.is_closed), sense)


def _line(entity: Any, _: float) -> tuple[Any, Any, float]:
    start, end = entity.dxf.start, entity.dxf.end
    _flat([start.z, end.z])
    return np.array([[start.x, start.y], [end.x, end.y]]), np.zeros(1), 0.0


def _arc(entity: Any, _: float) -> tuple[Any, Any, float]:
    if not (math.isfinite(entity.dxf.start_angle) and math.isfinite(entity.dxf.end_angle)):
        raise InputError("an angle is NaN or infinite; draw the entity again")
    sweep = (entity.dxf.end_angle - entity.dxf.start_angle) % 360.0 or 360.0
    return _round(entity, math.radians(entity.dxf.start_angle), math.radians(sweep))


def _circle(entity: Any, _: float) -> tuple[Any, Any, float]:
    return _round(entity, 0.0, 2 * math.pi)


def _round(entity: Any, start: float, sweep: float) -> tuple[Any, Any, float]:
    sense, centre, radius = _sense(entity), entity.dxf.center, entity.dxf.radius
    if radius == 0:
        return np.zeros((2, 2)), np.zeros(1), 0.0
    if not radius > 0:
        raise InputError(f"radius {radius:g}; it must be positive")
    parts = 1 if sweep <= math.pi else 2  # a bulge above 1 loses digits
    angle = start + sweep * np.arange(parts + 1) / parts
    points = np.stack([centre.x + radius * np.cos(angle), centre.y + radius * np.sin(angle)], axis=1)
    if sweep == 2 * math.pi:
        points[-1] = points[0]
    return points * [sense, 1.0], np.full(parts, sense * math.tan(sweep / parts / 4)), 0.0


def _curve(entity: Any, flattening: float) -> tuple[Any, Any, float]:
    places, distance = polyline_of(entity, flattening)
    _flat(places[:, 2])
    points = places[:, :2]
    points = points[np.concatenate([[True], (np.diff(points, axis=0) != 0).any(axis=1)])]
    return points, np.zeros(len(points) - 1), distance


_READERS: dict[str, Callable[[Any, float], tuple[Any, Any, float]]] = {
    "LWPOLYLINE": _lwpolyline,
    "POLYLINE": _old_polyline,
    "LINE": _line,
    "ARC": _arc,
    "CIRCLE": _circle,
    "ELLIPSE": _curve,
    "SPLINE": _curve,
}
