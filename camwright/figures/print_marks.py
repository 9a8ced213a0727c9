"""The figure of print marks: how far a cut may be moved, by what the controller does, over the speed of the line."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from camwright.figures.marks import blank_figure
from camwright.house.numbers import unit_shown
from camwright.production.marks import ByMethod, Marks
from camwright.profiles.mark_range import MarkRange

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_LOOKS = (
    ("redesign", "next length designed anew", "#0072b2", "-", 1.7),
    ("master_phase", "phase of the master", "#d55e00", "--", 1.3),
    ("slave_offset", "offset of the slave", "#007a5a", "-.", 1.3),
)

_TALLEST = 1.5
"""Part of the cut length to which the picture is cut off where a range goes farther, or has no end."""


def print_marks_figure(found: Marks) -> Figure:
    """Draw the earliest and the latest correction over the line speed; a range without an end goes to the picture's edge."""
    job, units = found.job, found.job.units
    length, speed = units.shown["m"].factor, units.shown["m/s"].factor
    edge = _TALLEST * job.cut.length
    figure = blank_figure(3.6)
    axes = figure.add_subplot()
    speeds = np.array([each.line_speed for each in found.by_speed]) * speed
    for method, words, colour, dashes, width in _LOOKS:
        ranges = [_of(each, method) for each in found.by_speed]
        if any(each is None for each in ranges):
            continue
        shown = [each for each in ranges if each is not None]
        low = np.array([max(-edge, -edge if each.earliest is None else each.earliest) for each in shown]) * length
        high = np.array([min(edge, edge if each.latest is None else each.latest) for each in shown]) * length
        axes.fill_between(speeds, low, high, color=colour, alpha=0.12, linewidth=0)
        axes.plot(speeds, low, color=colour, linestyle=dashes, linewidth=width, label=words, marker=".")
        axes.plot(
            speeds,
            np.where(high < edge * length, high, np.nan),
            color=colour,
            linestyle=dashes,
            linewidth=width,
            marker=".",
        )
    axes.axhline(0.0, color="black", linewidth=0.8)
    axes.set_xlim(0.0, float(speeds[-1]))
    lowest = min((each.redesign.earliest or 0.0) for each in found.by_speed)
    axes.set_ylim(1.1 * max(lowest, -edge) * length, 0.6 * job.cut.length * length)
    axes.set_xlabel(f"line speed ({unit_shown('m/s', units)})")
    axes.set_ylabel(f"mark early (−) or late (+) ({unit_shown('m', units)})")
    figure.suptitle(f"{job.name}: how far a print mark may move the cut", fontsize=9.5)
    figure.legend(loc="outside lower center", ncols=3)
    return figure


def _of(each: ByMethod, method: str) -> MarkRange | None:
    found: MarkRange | None = getattr(each, method)
    return found
