"""The figure of a simulated shift: the line's speed, the sync error at each cut, and how the lengths spread."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from camwright.figures.marks import blank_figure
from camwright.figures.saving import written
from camwright.figures.style import LIMIT, LINES, title
from camwright.house.numbers import unit_shown
from camwright.production.simulation import MOTIONS, ShiftStudy
from camwright.profiles.polynomial.profile import FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_DOTS = 600
"""Pieces drawn one by one; of more, the worst of each of so many stretches."""

_MARKS = {"optimised": "o", "linear_return": "x"}


def shift_figure(study: ShiftStudy, directory: Path) -> list[Path]:
    """Write the figure: ``shift.svg`` and ``shift.png`` in an existing directory."""
    return written(lambda: draw_shift(study), directory, "shift")


def draw_shift(study: ShiftStudy) -> Figure:
    """Draw speed and sync errors over time, and the histogram of the length errors."""
    planned, units = study.planned, study.planned.job.units
    speed, length = units.shown["m/s"].factor, units.shown["m"].factor
    figure = blank_figure(6.2)
    above, middle, below = figure.subplots(3, 1, height_ratios=(2, 3, 3))
    line = planned.line
    time = np.unique(np.concatenate([np.linspace(0.0, study.cut_times[-1], 2001), line.times]))
    time = time[time <= study.cut_times[-1]]
    above.plot(time, line.speed(time) * speed, color="black", linewidth=1.2)
    above.set(ylabel=f"line speed\n({unit_shown('m/s', units)})", ylim=(0.0, None))
    above.sharex(middle)
    for motion in MOTIONS:
        at, error = _thinned(study.cut_times, study.runs[motion].nominal.sync_errors)
        look: dict[str, Any] = {"color": LINES[motion]["color"], "marker": _MARKS[motion], "markersize": 3}
        middle.plot(at, error * length, linestyle="none", label=title(motion), **look)
    middle.axhline(planned.job.cut.sync_tolerance * length, label="sync tolerance", **LIMIT)
    middle.set(xlabel="time (s)", ylabel=f"sync error of each piece\n({unit_shown('m', units)})", ylim=(0.0, None))
    _histogram(below, study, length)
    below.set(xlabel=f"length less what was asked ({unit_shown('m', units)})", ylabel="pieces")
    figure.suptitle(f"{planned.job.name}: {planned.asked.pieces} pieces, {study.cut_times[-1]:.5g} s", fontsize=9.5)
    figure.legend(handles=middle.get_legend_handles_labels()[0], loc="outside lower center", ncols=3)
    return figure


def _histogram(axes: Axes, study: ShiftStudy, length: float) -> None:
    """Draw the histograms as outlines; the counts as powers of ten, so that the few bad pieces are seen."""
    for motion in MOTIONS:
        look = {name: LINES[motion][name] for name in ("color", "linestyle", "linewidth")}
        axes.stairs(np.maximum(study.histogram(motion), 0.5), study.edges * length, baseline=0.5, **look)
    axes.set_yscale("log")
    axes.set_ylim(bottom=0.5)


def _thinned(time: FloatArray, error: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Of many pieces keep the worst of each stretch."""
    if len(time) <= _DOTS:
        return time, error
    firsts = np.linspace(0, len(time), _DOTS, endpoint=False).astype(np.intp)
    worst = np.array(
        [first + int(part.argmax()) for first, part in zip(firsts, np.split(error, firsts[1:]), strict=True)]
    )
    return time[worst], error[worst]
