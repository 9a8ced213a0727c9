"""Figures: the bent rule over the drawing, and the time table beside the paper's."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from camwright.bender.catalogue import SheetWords
from camwright.bender.program_file import BentOutline
from camwright.design.bender.moves import TimeTable
from camwright.house.picture_files import write_pictures
from camwright.house.pictures import DASHED, DrawnLine, DrawnMarks, Frame, Picture
from camwright.profiles.bender.outline import Outline
from camwright.profiles.polynomial.profile import FloatArray

_BENDS_SHOWN = 6
_PER_MOVE = 60
_FINENESS = 3000
"""A view's width over the coarseness of arcs drawn in it."""

_GRID = 12.0
"""Frames begin and end on multiples of this (pt), whole pixels of the PNG."""

_WIDTH = 54 * _GRID
_LEFT, _BETWEEN, _RIGHT, _BOTTOM, _TOP = (n * _GRID for n in (5, 5, 1, 5, 4))
_WIDEST, _TALLEST = 30 * _GRID, 34 * _GRID
"""Width of the figures, margins, and the greatest width and height of the view of the whole (pt)."""

_DRAWN, _BENT, _WORST, _START, _PAPER, _BRIDGE = "#b9c4d0", "#11304f", "#c1121f", "#2a9d3a", "#8d99a6", "#e08e0b"


def draw(outline: BentOutline, directory: Path, name: str, words: SheetWords) -> None:
    """Write both figures of an outline as SVG and PNG: ``<name>-proof`` and ``<name>-times``."""
    write_pictures({f"{name}-proof": _proof(outline, words), f"{name}-times": _times(outline, words)}, directory)


def outline_path(outline: Outline, coarseness: float | FloatArray) -> FloatArray:
    """Return points along an outline (m), arcs as chords within a distance of them (m), one for all or one a segment."""
    radius = np.where(outline.arcs, outline.radii, 1.0)
    widest = 2 * np.arccos(1 - np.minimum(coarseness / radius, 0.5))
    steps = np.maximum(1, np.ceil(np.abs(outline.included) / widest)).astype(np.int64)
    segment = np.repeat(np.arange(len(steps)), steps)
    inner = np.arange(len(segment)) - np.repeat(np.cumsum(steps) - steps, steps)
    turn = outline.included[segment] * inner / steps[segment]
    centre = np.where(outline.arcs[:, None], outline.centres, 0.0)[segment]
    out = outline.points[segment] - centre
    cos, sin = np.cos(turn), np.sin(turn)
    turned = centre + np.stack([cos * out[:, 0] - sin * out[:, 1], sin * out[:, 0] + cos * out[:, 1]], axis=1)
    return np.vstack([turned, outline.points[-1:]])


def _proof(outline: BentOutline, words: SheetWords) -> Picture:
    """Lay the bent rule over the drawing: the whole of it, and a close view of the largest deviation."""
    bent, worst, deviation = 1e3 * outline.proof.points, 1e3 * outline.proof.worst, 1e3 * outline.proof.deviation
    drawn = 1e3 * outline_path(outline.plan.outline, 1e-3 * float(np.ptp(bent, axis=0).max()) / _FINENESS)
    reach = _window(outline, worst)
    seen = _seen(outline.plan.outline, worst, reach)
    fine = 1e3 * outline_path(outline.plan.outline, 1e-3 * np.where(seen, reach, np.inf) / _FINENESS)
    bends = bent[1:-1][(np.abs(bent[1:-1] - worst) <= reach).all(axis=1)]
    under, over = (
        DrawnLine(drawn, _DRAWN, 3.5, words("figure.drawing")),
        DrawnLine(bent, _BENT, 0.9, words("figure.bent")),
    )
    marks = DrawnMarks(bends, _BENT, 4.0, "disc", words("figure.bends"))
    place = DrawnMarks(
        worst[None, :], _WORST, 13.0, "ring", words("figure.worst", value=words.number(deviation, ".4f"))
    )
    start = DrawnMarks(bent[:1], _START, 6.0, "square", words("figure.start"))
    bridges = [
        DrawnLine(path, _BRIDGE, 3.0, "" if i else words("figure.bridge"))
        for i, path in enumerate(_bridge_paths(outline))
    ]
    close = DrawnLine(_inside(fine, worst, reach), _DRAWN, 6.0), DrawnLine(_inside(bent, worst, reach), _BENT, 0.9)

    size = np.ptp(drawn, axis=0)
    half = 0.56 * np.maximum(size, 0.35 * size.max())  # a straight line gets some room beside it
    middle = 0.5 * (drawn.min(axis=0) + drawn.max(axis=0))
    frame = _GRID * np.floor(half * min(_WIDEST / half[0], _TALLEST / half[1]) / _GRID + 1e-9)
    half = frame * float((half / frame).max())  # as much along x as along y
    width, height = frame.tolist()
    square = min(_WIDTH - width - _LEFT - _BETWEEN - _RIGHT, _TALLEST)
    content = max(height, square)
    above = [_TOP + _GRID * math.floor(0.5 * (content - up) / _GRID) for up in (height, square)]
    panels = (
        Frame(_LEFT, above[0], width, height, middle - half, middle + half, (under, over, *bridges, start, place), "x (mm)", "y (mm)"),
        Frame(_LEFT + width + _BETWEEN, above[1], square, square, worst - reach, worst + reach, (*close, *bridges, marks, place),
              "x (mm)", title=words("figure.close")),
    )  # fmt: skip
    closing = outline.proof.closing_error
    ends = (
        words("figure.open")
        if closing is None
        else words("figure.closing", value=words.number(1000.0 * closing, ".4f"))
    )
    length = words.number(1e3 * outline.proof.rule_length, ".1f")
    title = words("figure.title", name=outline.program.name, bends=str(outline.plan.bends), length=length, ends=ends)
    return Picture(
        _WIDTH, _TOP + content + _BOTTOM, title, _LEFT, panels, (under, over, *bridges[:1], marks, place, start)
    )


def _bridge_paths(outline: BentOutline) -> list[FloatArray]:
    """Stretches of the bent rule that are cut out (mm), each of shape ``(2, 2)``."""
    points = 1e3 * outline.proof.points
    found = []
    for bridge in outline.bridges:
        start, way = points[bridge.side], points[bridge.side + 1] - points[bridge.side]
        reach = 1e3 * np.array([[bridge.from_bend - bridge.width / 2], [bridge.from_bend + bridge.width / 2]])
        found.append(start + reach * way / np.hypot(*way))
    return found


def _seen(outline: Outline, centre: FloatArray, reach: float) -> NDArray[np.bool_]:
    """Tell which segments may be seen in a square (mm)."""
    points = 1e3 * outline.points - centre
    # an arc stays this near to its chord
    rise = np.where(outline.arcs, 0.5e3 * np.hypot(*outline.chords.T) * np.maximum(1.0, np.abs(outline.bulges)), 0.0)
    low, high = np.minimum(points[:-1], points[1:]) - rise[:, None], np.maximum(points[:-1], points[1:]) + rise[:, None]
    return np.asarray(((low <= reach) & (high >= -reach)).all(axis=1))


def _inside(points: FloatArray, centre: FloatArray, reach: float) -> FloatArray:
    """Those sides of a polyline that may be seen in a square, NaN between stretches."""
    start, end = points[:-1] - centre, points[1:] - centre
    seen = ((np.minimum(start, end) <= reach) & (np.maximum(start, end) >= -reach)).all(axis=1)
    keep = np.concatenate([seen, [False]]) | np.concatenate([[False], seen])
    shown = np.where(keep[:, None], points, np.nan)
    return np.asarray(shown[keep | np.roll(keep, -1)], dtype=np.float64)


def _window(outline: BentOutline, worst: FloatArray) -> float:
    """Half width of the close view (mm): a few sides of the rule."""
    sides = 1e3 * outline.plan.feeds
    at = int(np.argmin(np.hypot(*(1e3 * outline.proof.points - worst).T)))
    near = sides[max(0, at - 1) : at + 1]
    extent = float(np.ptp(1e3 * outline.proof.points, axis=0).max())
    return float(np.clip(1.2 * near.min(initial=extent), 1.0, 0.3 * extent + 1.0))


def _times(outline: BentOutline, words: SheetWords) -> Picture:
    """Show feed and mould over time for the first bends, beside the paper's moves."""
    tables = (
        ("figure.paper", outline.run.paper_times, _PAPER, DASHED),
        ("figure.optimised", outline.run.times, _BENT, ()),
    )
    signs = np.sign(outline.moulds)
    feeds = [
        DrawnLine(_feed_track(table), colour, 1.4, words(label, time=words.number(table.total, ".2f")), dash)
        for label, table, colour, dash in tables
    ]
    moulds = [DrawnLine(_mould_track(table, signs), colour, 1.4, "", dash) for _, table, colour, dash in tables]
    rows = [(feeds, words("figure.fed")), (moulds, words("figure.mould"))][: 2 if outline.plan.bends else 1]
    last = max(float(line.points[:, 0].max()) for line in (*feeds, *moulds)) or 1.0
    top, height, width = 3 * _GRID, 14 * _GRID, _WIDTH - _LEFT - _RIGHT
    panels = []
    for i, (lines, label) in enumerate(rows):
        values = np.concatenate([line.points[:, 1] for line in lines])
        low, high = min(float(values.min()), 0.0), max(float(values.max()), 0.0)
        room = 0.05 * ((high - low) or 1.0)
        panels.append(
            Frame(_LEFT, top + i * (height + _GRID), width, height, np.array([-0.01 * last, low - room]),
                  np.array([1.01 * last, high + room]), lines, words("figure.time") if i == len(rows) - 1 else "", label,
                  grid=True, apart=30.0)
        )  # fmt: skip
    shown = min(_BENDS_SHOWN, outline.plan.bends)
    key = "figure.times.none" if not shown else "figure.times" if shown == outline.plan.bends else "figure.times.part"
    title = words(key, name=outline.program.name, shown=str(shown), count=str(outline.plan.bends))
    return Picture(
        _WIDTH, top + len(rows) * (height + _GRID) + 2 * _GRID, title, _LEFT, panels, feeds, legend_below=False
    )


def _feed_track(table: TimeTable) -> FloatArray:
    """Rule fed (mm) over time (s), shape ``(n, 2)``."""
    times, values, fed = [], [], 0.0
    for k in range(min(_BENDS_SHOWN + 1, len(table.feed_start))):
        move = table.feeds.take(np.array([k]))
        t = np.linspace(0.0, float(move.time[0]), _PER_MOVE)
        times.append(table.feed_start[k] + t)
        values.append(1e3 * (fed + move.position(t[None, :])[0]))
        fed += float(move.distance[0])
    return np.stack([np.concatenate(times), np.concatenate(values)], axis=1)


def _mould_track(table: TimeTable, signs: FloatArray) -> FloatArray:
    """Mould angle (°) over time (s), shape ``(n, 2)``."""
    times, values = [np.zeros(1)], [np.zeros(1)]
    for k in range(min(_BENDS_SHOWN, len(table.bend_start))):
        move = table.bends.take(np.array([k]))
        t = np.linspace(0.0, float(move.time[0]), _PER_MOVE)
        angle = signs[k] * np.degrees(move.position(t[None, :])[0])
        times += [table.bend_start[k] + t, table.return_start[k] + t]
        values += [angle, angle[-1] - angle]
    return np.stack([np.concatenate(times), np.concatenate(values)], axis=1)
