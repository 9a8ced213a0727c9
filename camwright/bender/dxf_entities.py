"""DXF entities as pieces of outlines: what is known of each kind, and why others are refused."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from camwright.bender.dxf_curves import polyline_of
from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import FloatArray

_FRAME = 16
"""Flag of a vertex that frames a fitted spline and is no part of the line."""

_PLANE = 1e-9
"""Difference of height, in drawing units, up to which an entity lies in a plane."""


@dataclass(frozen=True, eq=False)
class Piece:
    """A stretch of die line from one entity.

    Parameters
    ----------
    points, bulges
        As in `camwright.profiles.bender.outline.Outline`, in drawing units.
    name
        Kind, handle and layer of the entity.
    flattening
        Largest distance of the piece from the curve that it stands for, in drawing units; 0 for lines and arcs.
    """

    points: FloatArray
    bulges: FloatArray
    name: str
    flattening: float = 0.0

    @property
    def closed(self) -> bool:
        """Whether the piece ends where it begins."""
        return bool((self.points[0] == self.points[-1]).all())

    def reverse(self) -> Piece:
        """Return the same stretch from its other end."""
        return Piece(self.points[::-1], -self.bulges[::-1], self.name, self.flattening)


def describe(entity: Any) -> str:
    """Kind, handle and layer of an entity, for messages."""
    handle = entity.dxf.handle or getattr(entity.source_block_reference, "dxf", entity.dxf).handle
    origin = "" if entity.dxf.handle else "in block reference "
    return f"{entity.dxftype()} {origin}#{handle} on layer {entity.dxf.layer}"


def piece_of(entity: Any, flattening: float) -> Piece | None:
    """Turn an entity into a piece; nothing for an entity that is no line work.

    Parameters
    ----------
    entity
        The ezdxf entity.
    flattening
        Largest distance of a curve from its polyline, in drawing units.

    Raises
    ------
    InputError
        The entity is line work that cannot be bent: not flat, without length, not finite.
    """
    kind = entity.dxftype()
    if kind not in _READERS:
        return None
    name = describe(entity)
    try:
        points, bulges, distance = _READERS[kind](entity, flattening)
    except (ArithmeticError, ValueError, LookupError) as error:  # what the library makes of NaN or missing numbers
        raise InputError(f"{name}: its geometry cannot be used: {error}") from error
    piece = Piece(points, bulges, name, distance)
    if not (np.isfinite(points).all() and np.isfinite(bulges).all()):
        raise InputError(f"{name}: a coordinate or bulge is NaN or infinite; draw the entity again")
    if len(bulges) == 0:
        raise InputError(f"{name}: it has fewer than two vertices; remove it")
    empty = np.flatnonzero((np.diff(points, axis=0) == 0).all(axis=1))
    if len(empty):
        x, y = points[empty[0]]
        raise InputError(f"{name}: segment {empty[0] + 1} has no length, at ({x:g}, {y:g}); remove the doubled vertex")
    return piece


def _flat(name: str, heights: ArrayLike) -> None:
    z = np.asarray(heights, dtype=np.float64)
    if len(z) and float(np.ptp(z)) > _PLANE:
        raise InputError(
            f"{name}: it is three-dimensional, from z = {z.min():g} to {z.max():g}; flatten it to one height, a "
            "die line is "
            "a plane drawing"
        )


def _sense(entity: Any) -> float:
    """Tell whether an entity is drawn on the plane's face (1) or seen from behind (-1)."""
    direction = entity.dxf.extrusion
    if abs(direction.x) > _PLANE or abs(direction.y) > _PLANE or direction.z == 0:
        raise InputError(
            f"{describe(entity)}: its plane is tilted (extrusion {direction}); turn it into the drawing plane"
        )
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
        raise InputError(f"{describe(entity)}: it is a mesh, not a line; remove it")
    vertices = [vertex for vertex in entity.vertices if not vertex.dxf.flags & _FRAME]
    places = [vertex.dxf.location for vertex in vertices]
    _flat(describe(entity), [place.z for place in places])
    sense = 1.0 if entity.is_3d_polyline else _sense(entity)
    bulges = [vertex.dxf.get("bulge", 0.0) for vertex in vertices]
    return _polyline([(place.x, place.y) for place in places], bulges, bool(entity.is_closed), sense)


def _line(entity: Any, _: float) -> tuple[Any, Any, float]:
    start, end = entity.dxf.start, entity.dxf.end
    _flat(describe(entity), [start.z, end.z])
    return np.array([[start.x, start.y], [end.x, end.y]]), np.zeros(1), 0.0


def _arc(entity: Any, _: float) -> tuple[Any, Any, float]:
    if not (math.isfinite(entity.dxf.start_angle) and math.isfinite(entity.dxf.end_angle)):
        raise InputError(f"{describe(entity)}: an angle is NaN or infinite; draw the entity again")
    sweep = (entity.dxf.end_angle - entity.dxf.start_angle) % 360.0 or 360.0
    return _round(entity, math.radians(entity.dxf.start_angle), math.radians(sweep))


def _circle(entity: Any, _: float) -> tuple[Any, Any, float]:
    return _round(entity, 0.0, 2 * math.pi)


def _round(entity: Any, start: float, sweep: float) -> tuple[Any, Any, float]:
    sense, centre, radius = _sense(entity), entity.dxf.center, entity.dxf.radius
    if not radius > 0:
        raise InputError(f"{describe(entity)}: radius {radius:g}; it must be positive")
    parts = 1 if sweep <= math.pi else 2  # a bulge above 1 loses digits
    angle = start + sweep * np.arange(parts + 1) / parts
    points = np.stack([centre.x + radius * np.cos(angle), centre.y + radius * np.sin(angle)], axis=1)
    if sweep == 2 * math.pi:
        points[-1] = points[0]
    return points * [sense, 1.0], np.full(parts, sense * math.tan(sweep / parts / 4)), 0.0


def _curve(entity: Any, flattening: float) -> tuple[Any, Any, float]:
    places, distance = polyline_of(entity, flattening)
    _flat(describe(entity), places[:, 2])
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


def _not_placed(entity: Any, reason: str) -> None:
    if entity.dxftype() in _READERS:
        raise InputError(f"{describe(entity)}: it cannot be put in the place of its block reference: {reason}")


def require_bounded(document: Any, most: int, depth: int) -> None:
    """Refuse a drawing whose block references unfold to too much, before any of them is unfolded.

    Raises
    ------
    InputError
        References nested deeper than ``depth``, or more than ``most`` entities in all.
    """
    sizes: dict[tuple[str, int], int] = {}

    def size(layout: Any, name: str, level: int) -> int:
        if (name, level) not in sizes:
            total = 0
            for entity in layout:
                if entity.dxftype() != "INSERT":
                    total += 1
                    continue
                if level == depth:
                    raise InputError(f"{describe(entity)}: blocks are nested more than {depth} deep; explode them")
                inner = document.blocks.get(entity.dxf.name)
                if inner is not None:
                    total += max(1, entity.mcount) * size(inner, entity.dxf.name, level + 1)
            sizes[name, level] = total
        return sizes[name, level]

    if size(document.modelspace(), "", 0) > most:
        raise InputError(f"block references unfold to more than {most} entities; purge what is no die line")


def walk(layout: Any, layer: str | None = None) -> Iterator[tuple[Any, str]]:
    """Go through a layout's entities, those inside block references too, each with the layer it appears on.

    Parameters
    ----------
    layout
        Model space, or the entities of a block reference in their places.
    layer
        Layer of that reference, which the block's entities on layer 0 take; ``None`` in model space.
    """
    for entity in layout:
        own = layer if layer is not None and entity.dxf.layer == "0" else entity.dxf.layer
        if entity.dxftype() != "INSERT":
            yield entity, own
            continue
        for cell in entity.multi_insert() if entity.mcount > 1 else (entity,):
            yield from walk(cell.virtual_entities(skipped_entity_callback=_not_placed), own)
