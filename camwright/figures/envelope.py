"""The map of cut length and line speed as a figure: what is possible, and what binds beside and beyond it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from camwright.figures.panel import LEFT, NOTHING, RIGHT, WIDTH, first_frame, head, page, stroked
from camwright.figures.strokes import BLACK, LINES, Stroke
from camwright.house.numbers import converted, unit_shown
from camwright.house.pictures import Area, DrawnLine, DrawnMarks, Frame, Hatch, Item, Picture
from camwright.profiles.polynomial.profile import FloatArray
from camwright.studies.envelope import EnvelopeAnswer

BINDING: dict[str, tuple[str, Hatch]] = {
    "speed": ("#56b4e9", ""),
    "acceleration": ("#e69f00", "lines"),
    "jerk": ("#cc79a7", "dots"),
    "reversal": ("#f0e442", "back"),
    "stroke": ("#44aa99", "crosses"),
    "motor": ("#d55e00", "plus"),
    "sync_zone": ("#bbbbbb", "level"),
}
"""Colour and hatch of each limit: colour-blind safe, and told apart in black and white."""

BEYOND = 0.30
POSSIBLE = 0.85
"""Strength of the colour where a cut is not possible and where it is."""

_PANEL = 348.0
"""Height of the map (pt)."""


def envelope_figure(answer: EnvelopeAnswer) -> Picture:
    """Draw the map: coloured by the limit that binds, strong where a cut is possible; highest line speeds as lines."""
    found, units = answer.envelope, answer.job.units
    shown = np.array([converted(1.0, "m", units), converted(1.0, "m/s", units)])
    speeds = np.unique([point.line_speed for point in found.points])
    top = float(_borders(speeds)[-1]) * shown[1]
    ends = np.array([found.rows[0].length, found.rows[-1].length]) * shown[0]
    edges = _edges(answer, shown)
    cut = answer.job.cut
    job = DrawnMarks(np.array([[cut.length, cut.line_speed]]) * shown, BLACK, 7.0, "open", "the job")
    heading = head(answer.job.name, "the limit that binds, in strong colour where a cut is possible")
    frame = Frame(
        LEFT, first_frame(heading), WIDTH - LEFT - RIGHT, _PANEL, np.array([ends[0], 0.0]), np.array([ends[1], top]),
        [*_cells(answer, speeds, shown), *edges, job], f"cut length ({unit_shown('m', units)})",
        f"line speed ({unit_shown('m/s', units)})", apart=30.0,
    )  # fmt: skip
    names = [name for name in BINDING if any(point.binding == name for point in found.points)]
    names += [name for name in BINDING if name not in names and any(row.binding == name for row in found.rows)]
    legend: list[Item] = [*edges, job]
    legend += [Area(NOTHING, BINDING[name][0], BINDING[name][1], name.replace("_", " ")) for name in names]
    return page(heading, [frame], legend)


def _cells(answer: EnvelopeAnswer, speeds: FloatArray, shown: FloatArray) -> Iterator[Area]:
    """Colour each cell by what forbids it, and below the highest line speed each cut length by what would bind first."""
    found = answer.envelope
    lengths = np.array([row.length for row in found.rows]) * shown[0]
    across, up = _borders(lengths), _borders(speeds * shown[1])
    across[0], across[-1], up[0] = lengths[0], lengths[-1], 0.0
    edge = np.array(answer.perfect) * shown
    below: list[Area] = []
    for i, row in enumerate(found.rows):
        column = [point for point in found.points if point.length == row.length]
        lowest = 0.0  # the edge does not run along the cells: what forbids the lowest of them forbids all below it
        for j, point in enumerate(column):
            if point.optimised and j + 1 < len(column):
                continue
            colour, hatch = BINDING[row.binding if point.optimised else point.binding]
            (left, right), high = across[i : i + 2], up[j + 1]
            corners = np.array([[left, lowest], [right, lowest], [right, high], [left, high]])
            yield Area(corners, _mixed(colour, BEYOND), hatch)
            lowest = high
        inside = edge[(edge[:, 0] > across[i]) & (edge[:, 0] < across[i + 1]), 0]
        x = np.array([across[i], *inside, across[i + 1]])
        y = np.interp(x, edge[:, 0], edge[:, 1])  # straight between the nodes of the edge, which are close enough
        floor = np.array([[across[i + 1], 0.0], [across[i], 0.0]])
        below.append(Area(np.concatenate([np.stack([x, y], axis=1), floor]), _mixed(BINDING[row.binding][0], POSSIBLE)))
    yield from below


def _mixed(colour: str, strength: float) -> str:
    """Mix a colour with white."""
    parts = (int(colour[at : at + 2], 16) for at in (1, 3, 5))
    return "#" + "".join(f"{round(255 - strength * (255 - part)):02x}" for part in parts)


def _edges(answer: EnvelopeAnswer, shown: FloatArray) -> list[DrawnLine]:
    """Draw the highest line speeds: nodes are so close that what is drawn is true everywhere, or the legend says that it is not."""
    rows = answer.envelope.rows
    linear = [(row.length, np.nan if row.linear is None else row.linear) for row in rows]
    optimised = LINES["optimised"]
    between = ", found at the map's lengths" if answer.sampled else ""
    return [
        stroked(stroke, np.array(edge) * shown, label)
        for edge, label, stroke in (
            (linear, "linear (speed limit only, eq. 8)", LINES["linear_return"]),
            (answer.quintic, "quintic, perfect axis", LINES["poly_3_4_5"]),
            (answer.perfect, "optimised, perfect axis", optimised),
            (answer.within, f"optimised, axis in tolerance{between}", Stroke("#00304d", 2.2, (7.0, 4.0))),
        )
    ]


def _borders(centres: FloatArray) -> FloatArray:
    middle = 0.5 * (centres[:-1] + centres[1:])
    return np.concatenate([[2 * centres[0] - middle[0]], middle, [2 * centres[-1] - middle[-1]]])
