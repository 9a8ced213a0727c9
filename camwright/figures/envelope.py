"""The map of cut length and line speed as a figure: what is possible, and what binds beside and beyond it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from camwright.figures.marks import blank_figure, patch_mark
from camwright.figures.saving import written
from camwright.figures.style import LINES, WIDTH
from camwright.studies.envelope import EnvelopeAnswer

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


BINDING: dict[str, tuple[str, str]] = {
    "speed": ("#56b4e9", ""),
    "acceleration": ("#e69f00", "////"),
    "jerk": ("#cc79a7", "...."),
    "reversal": ("#f0e442", "\\\\\\\\"),
    "stroke": ("#44aa99", "xxxx"),
    "motor": ("#d55e00", "++++"),
    "sync_zone": ("#bbbbbb", "----"),
}
"""Colour and hatch of each limit: colour-blind safe, and told apart in black and white."""

BEYOND = 0.30
POSSIBLE = 0.85
"""Strength of the colour where a cut is not possible and where it is."""


def envelope_figure(answer: EnvelopeAnswer, directory: Path) -> list[Path]:
    """Write the map of a job: ``envelope.svg`` and ``envelope.png`` in an existing directory."""
    return written(lambda: draw_envelope(answer), directory, "envelope")


def draw_envelope(answer: EnvelopeAnswer) -> Figure:
    """Draw the map: coloured by the limit that binds, strong where a cut is possible; highest line speeds as lines."""
    figure = blank_figure(0.72 * WIDTH)
    axes = figure.subplots()
    found = answer.envelope
    _cells(axes, answer)
    _edges(axes, answer)
    axes.set(xlabel="cut length (mm)", ylabel="line speed (m/min)")
    axes.set_title(f"{answer.job.name}: the limit that binds, in strong colour where a cut is possible")
    axes.grid(visible=False)
    axes.plot(
        answer.job.cut.length * 1e3,
        answer.job.cut.line_speed * 60,
        marker="o",
        markersize=6,
        markerfacecolor="white",
        color="black",
        linestyle="none",
        label="the job",
        zorder=6,
    )
    names = [name for name in BINDING if any(point.binding == name for point in found.points)]
    names += [name for name in BINDING if name not in names and any(row.binding == name for row in found.rows)]
    patches = [
        patch_mark(
            facecolor=BINDING[name][0],
            hatch=BINDING[name][1],
            edgecolor="#555555",
            linewidth=0.4,
            label=name.replace("_", " "),
        )
        for name in names
    ]
    lines = axes.get_legend_handles_labels()[0]
    figure.legend(handles=[*lines, *patches], loc="outside lower center", ncols=3)
    return figure


def _cells(axes: Axes, answer: EnvelopeAnswer) -> None:
    """Colour each cell by what forbids it, and below the highest line speed each cut length by what would bind first."""
    found = answer.envelope
    lengths = np.array([row.length for row in found.rows]) * 1e3
    speeds = np.unique([point.line_speed for point in found.points]) * 60
    across, up = _borders(lengths), _borders(speeds)
    across[0], across[-1], up[0] = lengths[0], lengths[-1], 0.0
    edge = np.array(answer.perfect) * [1e3, 60.0]
    for i, row in enumerate(found.rows):
        column = [point for point in found.points if point.length == row.length]
        lowest = 0.0  # the edge does not run along the cells: what forbids the lowest of them forbids all below it
        for j, point in enumerate(column):
            if point.optimised and j + 1 < len(column):
                continue
            colour, hatch = BINDING[row.binding if point.optimised else point.binding]
            _fill(axes, across[i : i + 2], lowest, up[j + 1], _mixed(colour, BEYOND), 1, hatch)
            lowest = up[j + 1]
        inside = edge[(edge[:, 0] > across[i]) & (edge[:, 0] < across[i + 1]), 0]
        x = np.array([across[i], *inside, across[i + 1]])
        y = np.interp(x, edge[:, 0], edge[:, 1])  # straight between the nodes of the edge, which are close enough
        _fill(axes, x, 0.0, y, _mixed(BINDING[row.binding][0], POSSIBLE), 2, "")
    axes.set(xlim=(lengths[0], lengths[-1]), ylim=(0.0, up[-1]))


def _fill(
    axes: Axes,
    x: np.ndarray,
    low: float,
    high: float | np.ndarray,
    colour: tuple[float, float, float],
    order: int,
    hatch: str,
) -> None:
    """Fill below a line; an edge of the same colour closes the seam to the next."""
    axes.fill_between(x, low, high, facecolor=colour, edgecolor=colour, linewidth=0.5, zorder=order)
    if hatch:
        axes.fill_between(x, low, high, facecolor="none", edgecolor="#777777", linewidth=0.0, hatch=hatch, zorder=order)


def _mixed(colour: str, strength: float) -> tuple[float, float, float]:
    """Mix a colour with white."""
    from matplotlib.colors import to_rgb

    red, green, blue = (1.0 - strength * (1.0 - part) for part in to_rgb(colour))
    return red, green, blue


def _edges(axes: Axes, answer: EnvelopeAnswer) -> None:
    """Draw the highest line speeds, each with nodes so close that what is drawn is true everywhere."""
    rows = answer.envelope.rows
    linear = [(row.length, np.nan if row.linear is None else row.linear) for row in rows]
    optimised = LINES["optimised"]
    for edge, label, style in (
        (linear, "linear (speed limit only, eq. 8)", LINES["linear_return"]),
        (answer.quintic, "quintic, perfect axis", LINES["poly_3_4_5"]),
        (answer.perfect, "optimised, perfect axis", optimised),
        (answer.within, "optimised, axis in tolerance", {**optimised, "linestyle": "--"}),
    ):
        axes.plot(*(np.array(edge) * [1e3, 60.0]).T, label=label, **{**style, "zorder": 5})


def _borders(centres: np.ndarray) -> np.ndarray:
    middle = 0.5 * (centres[:-1] + centres[1:])
    return np.concatenate([[2 * centres[0] - middle[0]], middle, [2 * centres[-1] - middle[-1]]])
