"""The map of cut length and line speed as a figure: what is possible, and what binds beside and beyond it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from camwright.plots.files import written
from camwright.plots.style import LINES, WIDTH

if TYPE_CHECKING:
    from camwright.envelope import EnvelopeAnswer
    from design.envelope import Envelope

BINDING: dict[str, tuple[str, str]] = {
    "speed": ("#56b4e9", ""),
    "acceleration": ("#e69f00", "////"),
    "jerk": ("#cc79a7", "...."),
    "reversal": ("#f0e442", "\\\\\\\\"),
    "stroke": ("#999999", "xxxx"),
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
    figure = Figure(figsize=(WIDTH, 0.72 * WIDTH), layout="constrained")
    axes = figure.subplots()
    found = answer.envelope
    _cells(axes, found)
    _edges(axes, found)
    axes.set(xlabel="cut length (mm)", ylabel="line speed (m/min)")
    axes.set_title(f"{answer.job.name}: what is possible, and the limit that binds")
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
        Patch(
            facecolor=BINDING[name][0],
            hatch=BINDING[name][1],
            edgecolor="#555555",
            linewidth=0.4,
            label=f"{name.replace('_', ' ')} binds",
        )
        for name in names
    ]
    if any(row.optimised is not None for row in found.rows):
        patches.append(Patch(facecolor="#999999", label="strong: possible"))
    if any(not point.optimised for point in found.points):
        patches.append(
            Patch(facecolor=_pale("#999999"), edgecolor="#777777", linewidth=0.4, label="pale: not possible")
        )
    lines = axes.get_legend_handles_labels()[0]
    figure.legend(handles=[*lines, *patches], loc="outside lower center", ncols=4)
    return figure


def _cells(axes: Axes, found: Envelope) -> None:
    """Colour each cell by what forbids it, and below the highest line speed each cut length by what would bind first."""
    lengths = np.unique([point.length for point in found.points]) * 1e3
    speeds = np.unique([point.line_speed for point in found.points]) * 60
    left, right = lengths[0], lengths[-1]
    across, up = _borders(lengths), _borders(speeds)
    up[0] = 0.0
    across[0], across[-1] = left, right
    fastest = np.array([np.nan if row.optimised is None else row.optimised * 60 for row in found.rows])
    forbidden = [point for point in found.points if not point.optimised]
    for point in forbidden:
        i, j = (
            int(np.argmin(np.abs(grid - at)))
            for grid, at in ((lengths, point.length * 1e3), (speeds, point.line_speed * 60))
        )
        colour, hatch = BINDING[point.binding]
        axes.fill_between(
            [across[i], across[i + 1]],
            # down into the cell that the edge crosses: what is possible covers it
            0.0 if j == 0 else up[j - 1],
            up[j + 1],
            facecolor=_pale(colour),
            hatch=hatch,
            edgecolor="#777777",
            linewidth=0.0,
            zorder=1 - 1e-3 * j,
        )
    for i, row in enumerate(found.rows):
        if not np.isfinite(fastest[i]):
            continue
        # the edge runs straight from one cut length to the next, where there is one
        x = np.array([across[i], lengths[i], across[i + 1]])
        near = np.isfinite(fastest)
        y = np.interp(x, lengths[near], fastest[near])
        axes.fill_between(x, 0.0, y, facecolor="white", linewidth=0.0, zorder=2)
        axes.fill_between(x, 0.0, y, facecolor=BINDING[row.binding][0], alpha=POSSIBLE, linewidth=0.0, zorder=2)
    axes.set(xlim=(left, right), ylim=(0.0, up[-1]))


def _pale(colour: str) -> tuple[float, float, float]:
    """Mix a colour with white."""
    red, green, blue = (1.0 - BEYOND * (1.0 - part) for part in to_rgb(colour))
    return red, green, blue


def _edges(axes: Axes, found: Envelope) -> None:
    labels = {"linear": ("linear_return", "linear return (speed limit only, eq. 8)"), "quintic": ("poly_3_4_5", "quintic return"),
              "optimised": ("optimised", "optimised return")}  # fmt: skip
    x = [row.length * 1e3 for row in found.rows]
    for name, (style, label) in labels.items():
        speeds = [getattr(row, name) for row in found.rows]
        y = [np.nan if speed is None else speed * 60 for speed in speeds]
        axes.plot(x, y, label=label, **{**LINES[style], "zorder": 5})


def _borders(centres: np.ndarray) -> np.ndarray:
    middle = 0.5 * (centres[:-1] + centres[1:])
    return np.concatenate([[2 * centres[0] - middle[0]], middle, [2 * centres[-1] - middle[-1]]])
