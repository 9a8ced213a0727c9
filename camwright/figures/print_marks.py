"""The figure of print marks: how far a cut may be moved, by what the controller does, over the speed of the line."""

from __future__ import annotations

import numpy as np

from camwright.figures.panel import first_frame, head, page, stroked, wide_frame
from camwright.figures.strokes import BLACK, LINES, Stroke
from camwright.house.numbers import unit_shown
from camwright.house.pictures import APART, Area, DrawnLine, DrawnMarks, Item, Picture
from camwright.production.marks import Marks

_LOOKS: tuple[tuple[str, str, Stroke, str], ...] = (
    ("redesign", "next length designed anew", LINES["optimised"], "#e0eef6"),
    ("master_phase", "phase of the master", LINES["linear_return"], "#faebe0"),
    ("slave_offset", "offset of the slave", LINES["poly_3_4_5"], "#e0efeb"),
)
"""Of each method: its name, words for it, the stroke of its ends, and the colour of what lies between them."""

_TALLEST = 1.5
"""Part of the cut length to which the picture is cut off where a range goes farther, or has no end."""

_PANEL = 192.0
"""Height of the panel (pt)."""


def print_marks_figure(found: Marks) -> Picture:
    """Draw the earliest and the latest correction over the line speed; a range without an end goes to the picture's edge."""
    job, units = found.job, found.job.units
    length, speed = units.shown["m"].factor, units.shown["m/s"].factor
    edge = _TALLEST * job.cut.length
    speeds = np.array([each.line_speed for each in found.by_speed]) * speed
    areas: list[Item] = []
    lines: list[DrawnLine] = []
    dots: list[Item] = []
    for method, words, stroke, colour in _LOOKS:
        shown = [each for each in (each.ranges[method] for each in found.by_speed) if each is not None]
        if len(shown) < len(found.by_speed):
            continue
        low = np.array([max(-edge, -edge if each.earliest is None else each.earliest) for each in shown]) * length
        high = np.array([min(edge, edge if each.latest is None else each.latest) for each in shown]) * length
        outline = np.concatenate([np.stack([speeds, low], axis=1), np.stack([speeds, high], axis=1)[::-1]])
        areas.append(Area(outline, colour))
        lines.append(stroked(stroke, np.stack([speeds, low], axis=1), words))
        ends = np.stack([speeds, high], axis=1)[high < edge * length]
        lines.append(stroked(stroke, ends))
        # what was computed; between these it is drawn straight
        dots += [DrawnMarks(points, stroke.colour, 3.5, "disc") for points in (np.stack([speeds, low], axis=1), ends)]
    top = float(speeds[-1])
    lowest = min((each.redesign.earliest or 0.0) for each in found.by_speed)
    heights = np.array([1.1 * max(lowest, -edge), 0.6 * job.cut.length]) * length
    zero = DrawnLine(np.array([[0.0, 0.0], [top, 0.0]]), BLACK, 1.0)
    heading = head(job.name, "how far a print mark may move the cut")
    frame = wide_frame(
        first_frame(heading),
        _PANEL,
        np.array([0.0, heights[0]]),
        np.array([top, heights[1]]),
        [*areas, zero, *lines, *dots],
        f"line speed ({unit_shown('m/s', units)})",
        f"mark early (−)\nor late (+) ({unit_shown('m', units)})",
        apart=APART,
    )
    return page(heading, [frame], [line for line in lines if line.label])
