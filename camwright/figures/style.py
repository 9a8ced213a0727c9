"""The look of all figures: sizes, colours, line styles that hold up in black and white, and the marks of zones."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from camwright.profiles.cut import Cut
from camwright.profiles.laws import LAWS

if TYPE_CHECKING:
    from matplotlib.axes import Axes


WIDTH = 6.7
"""Width of a figure (in): the text width of an A4 page, 170 mm."""

RC: dict[str, Any] = {
    "axes.axisbelow": True,
    "axes.grid": True,
    "axes.labelsize": 8,
    "axes.linewidth": 0.6,
    "axes.titlesize": 8.5,
    "figure.constrained_layout.w_pad": 0.06,
    "figure.dpi": 200,
    "font.family": "DejaVu Sans",
    "font.size": 8,
    "grid.color": "#e4e4e4",
    "grid.linewidth": 0.5,
    "hatch.linewidth": 0.5,
    "legend.fontsize": 8,
    "legend.frameon": False,
    "svg.hashsalt": "camwright",
    "xtick.labelsize": 7.5,
    "ytick.labelsize": 7.5,
}
"""Settings beside matplotlib's own defaults; the salt makes the identifiers in an SVG the same each time."""

LINES: dict[str, dict[str, Any]] = {
    "optimised": {"color": "#0072b2", "linestyle": "-", "linewidth": 1.7, "zorder": 4},
    "linear_return": {"color": "#d55e00", "linestyle": (0, (5, 1.6)), "linewidth": 1.2, "zorder": 3},
    "poly_3_4_5": {"color": "#007a5a", "linestyle": (0, (6, 1.5, 1.2, 1.5)), "linewidth": 1.2, "zorder": 2},
}
"""Colour (Okabe and Ito's palette, told apart by colour-blind readers) and dash of each profile drawn."""

_TITLES = {
    "linear_return": "linear return",
    "quintic": "quintic with standstill",
    "crank_tabulated": "tabulated crank",
    "screw_carriage": "screw-driven carriage",
}

SYNC_COLOUR = "#ececec"
SHEAR_COLOUR = "#cfcfcf"
LIMIT: dict[str, Any] = {"color": "black", "linestyle": (0, (1, 1.5)), "linewidth": 1.0, "zorder": 1.5}


def title(name: str) -> str:
    """Write the name of a profile in words."""
    return LAWS[name].title if name in LAWS else _TITLES.get(name, name)


def zone_parts(cut: Cut, start: float, length: float) -> list[tuple[float, float]]:
    """Give a zone as parts of the period ``[0, x_c]``: two where it goes over the seam.

    Parameters
    ----------
    cut
        The cut.
    start
        Master position at which the zone begins (m), of any cycle.
    length
        Length of the zone (m).
    """
    first = start % cut.length
    last = first + length
    return [(first, last)] if last <= cut.length * (1 + 1e-12) else [(first, cut.length), (0.0, last - cut.length)]


def shade_zones(axes: Axes, cut: Cut) -> None:
    """Shade the sync zone and the shear zone of a cycle; the master is drawn in mm."""
    for start, end in cut.sync_parts:
        axes.axvspan(start * 1e3, end * 1e3, color=SYNC_COLOUR, linewidth=0, zorder=0)
    for start, end in zone_parts(cut, cut.shear_start, cut.shear_zone):
        shade_shear_zone(axes, start, end)


def shade_shear_zone(axes: Axes, start: float, end: float) -> None:
    """Shade a shear zone given in m; one of no length is drawn as a line."""
    if end > start:
        axes.axvspan(
            start * 1e3, end * 1e3, facecolor=SHEAR_COLOUR, edgecolor="#8c8c8c", hatch="////", linewidth=0, zorder=0.5
        )
    else:
        axes.axvline(start * 1e3, color="#8c8c8c", linewidth=1.2, zorder=0.5)
