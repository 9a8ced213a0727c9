"""The audit figure: ratio and acceleration of a running cam beside the optimum, and what the optimum saves."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from camwright.drives.audit import MEASURES, Audit
from camwright.figures.marks import blank_figure, line_mark, patch_mark
from camwright.figures.saving import written
from camwright.figures.style import (
    LIMIT,
    LINES,
    SHEAR_COLOUR,
    SYNC_COLOUR,
    shade_zones,
)
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.validation.rebuilt import differences

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


_THIS: dict[str, Any] = {**LINES["linear_return"], "linestyle": "-", "linewidth": 1.1}
_BEST = LINES["optimised"]
_POINTS = 3000
_ROOM = 1.15
_FAR = 4.0
"""A limit is drawn as a line if it is at most this many times the greatest value drawn, else named in words."""

_FARTHEST = 100.0
"""Bars of measures of which the optimum takes more are cut off here (%)."""

_LEAST_AXIS = 10.0
"""Least reach of the axis of savings (%)."""


def audit_figures(audit: Audit, directory: Path) -> list[Path]:
    """Write the figure of an audit: ``audit.svg`` and ``audit.png`` in an existing directory."""
    return written(lambda: audit_figure(audit), directory, "audit")


def audit_figure(audit: Audit) -> Figure:
    """Draw a running cam beside the optimum: what it asks of the drive, and the savings as bars.

    Where the cam's acceleration is unbounded, its differences at the servo's sample time are drawn, and those of the
    optimum with them.

    Parameters
    ----------
    audit
        The cam and the optimum.
    """
    cut, limits, unit = audit.job.cut, audit.job.limits, audit.job.machine.slave_unit
    v = cut.line_speed
    figure = blank_figure(6.8)
    ratio, acceleration, bars = figure.subplots(3, 1, height_ratios=[1.0, 1.25, 0.9])
    acceleration.sharex(ratio)
    for axes in (ratio, acceleration):
        shade_zones(axes, cut)
    for profile, line in ((audit.cycle, _THIS), (audit.optimum, _BEST)):
        x = _places(profile)
        ratio.plot(x * 1e3, profile(x, 1), **line)
        acceleration.plot(x * 1e3, _acceleration(audit, profile, x), **line)
    _bounds(ratio, [limits.speed / v, -limits.speed / v])
    _bounds(acceleration, [limits.acceleration, -limits.acceleration])
    how = "\nby differences" if audit.is_sampled("peak_acceleration") else ""
    ratio.set_ylabel("ratio dy/dx" if unit == "m" else "ratio dy/dx (rad/m)")
    ratio.tick_params(labelbottom=False)
    acceleration.set_ylabel(f"acceleration{how} ({unit}/s²)")
    acceleration.set_xlabel("master position x (mm)")
    acceleration.set_xlim(0.0, cut.length * 1e3)
    figure.align_ylabels([ratio, acceleration])
    _savings(bars, audit)
    figure.suptitle(
        f"{audit.job.name}: a running cam ({audit.target.name}, {audit.table.points} points) beside the optimum",
        fontsize=9.5,
    )
    figure.legend(
        handles=[
            line_mark(label="running cam", **_THIS),
            line_mark(label="optimum", **_BEST),
            line_mark(label="limit of the drive", **LIMIT),
            patch_mark(facecolor=SYNC_COLOUR, label="sync zone"),
            patch_mark(facecolor=SHEAR_COLOUR, edgecolor="#8c8c8c", hatch="////", linewidth=0, label="shear zone"),
        ],
        loc="outside lower center",
        ncols=5,
    )
    return figure


def _places(profile: CamProfile) -> FloatArray:
    """Master positions (m) of the curves: even, and at the ends of few pieces; many say no more than even ones do."""
    even = np.linspace(profile.start, profile.end, _POINTS)
    return np.union1d(even, profile.breaks) if profile.pieces < _POINTS else even


def _acceleration(audit: Audit, profile: CamProfile, x: FloatArray) -> FloatArray:
    """Acceleration over time at master positions; by differences centred there where the cam's own is unbounded."""
    cut, servo = audit.job.cut, audit.job.servo
    if not audit.is_sampled("peak_acceleration"):
        return np.asarray(profile(x, 2) * cut.line_speed**2)
    return differences(profile, x - cut.line_speed * servo.sample_time, 2, cut, servo)


def _bounds(axes: Axes, bounds: list[float]) -> None:
    """Mark limits that lie near the curves, name those that do not, and leave room around what is drawn."""
    values = np.concatenate([np.asarray(line.get_ydata(), dtype=float) for line in axes.lines])
    least, greatest = float(values.min()), float(values.max())
    reach = max(abs(least), abs(greatest)) or bounds[0]
    drawn = [b for b in bounds if abs(b) <= _FAR * reach and (b > 0 or least < 0)]
    if not drawn:
        axes.text(0.995, 0.95, f"limit {bounds[0]:.4g}: off scale", transform=axes.transAxes, ha="right", va="top",
                  fontsize=7)  # fmt: skip
    low, high = min([least, *drawn]), max([greatest, *drawn])
    middle, half = 0.5 * (low + high), 0.5 * (high - low) * _ROOM
    axes.set_ylim(middle - half, middle + half)
    for bound in drawn:
        axes.axhline(bound, **LIMIT)


def _savings(axes: Axes, audit: Audit) -> None:
    """Draw what the optimum saves of each measure (%), the values of both beside it; a bar cut off is hatched."""
    unit = audit.job.machine.slave_unit
    powers = ("/s", "/s²", "/s²", "/s³", "/s³")
    rows = list(zip(MEASURES.items(), powers, strict=True))
    savings = [100.0 * (audit.saving(name) or 0.0) for name in MEASURES]
    low, high = max(min(0.0, *savings), -_FARTHEST), max(0.0, *savings)
    room = max(high - low, _LEAST_AXIS)
    axes.set_xlim(low - (0.04 * room if low < 0 else 0.0), high + 0.95 * room)
    axes.set_xticks([tick for tick in axes.get_xticks() if low - 1e-9 <= tick <= max(high, 0.0) + 0.1 * room])
    for i, (((name, _), power), saving) in enumerate(zip(rows, savings, strict=True)):
        own, best = audit.pair(name)
        axes.barh(
            i,
            max(saving, -_FARTHEST),
            0.62,
            facecolor=_BEST["color"] if saving >= 0 else _THIS["color"],
            edgecolor="white",
            hatch="" if saving >= -_FARTHEST else "////",
            linewidth=0.0,
        )
        words = f"{saving:+.1f} %   {own:.4g} → {best:.4g} {unit}{power}"
        words += ", by differences" if audit.is_sampled(name) else ""
        axes.text(max(saving, 0.0) + 0.015 * room, i, words, ha="left", va="center", fontsize=7.5)
    axes.axvline(0.0, color="black", linewidth=0.6)
    axes.set_yticks(range(len(rows)), [title for (_, title), _ in rows])
    axes.invert_yaxis()
    axes.grid(visible=False)
    axes.tick_params(axis="y", length=0)
    axes.set_xlabel("saved by the optimum (% of the running cam)")
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
