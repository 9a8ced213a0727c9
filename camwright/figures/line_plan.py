"""The figure of a cut list: the speed of the line over it, and how far the servo is off at each cut."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from camwright.figures.marks import blank_figure
from camwright.figures.saving import written
from camwright.figures.style import LIMIT, LINES
from camwright.house.numbers import unit_shown
from camwright.production.cut_list import ListStudy

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def line_plan_figure(study: ListStudy, directory: Path) -> list[Path]:
    """Write the figure: ``line-plan.svg`` and ``line-plan.png`` in an existing directory."""
    return written(lambda: draw_line_plan(study), directory, "line-plan")


def draw_line_plan(study: ListStudy) -> Figure:
    """Draw the plan over time with each piece's highest speed, and below the sync error at each cut."""
    planned, run = study.planned, study.run
    job, plan = planned.job, planned.line
    units = job.units
    speed, length = units.shown["m/s"].factor, units.shown["m"].factor
    ends = plan.when(np.concatenate([[0.0], np.cumsum(planned.asked.gaps)]))
    figure = blank_figure(4.6)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    time = np.unique(np.concatenate([np.linspace(0.0, plan.time, 2001), plan.times]))
    above.stairs(planned.highest * speed, ends, label="highest speed of each piece", baseline=None, **LIMIT)
    above.plot(time, plan.speed(time) * speed, label="plan", **LINES["optimised"])
    above.set_ylabel(f"line speed ({unit_shown('m/s', units)})")
    above.set_ylim(0.0, 1.08 * float(planned.highest.max()) * speed)
    below.plot(
        ends[1:], run.sync_errors * length, linestyle="none", marker="o", markersize=3, color="#d55e00",
        label="greatest sync error of each piece",
    )  # fmt: skip
    below.axhline(job.cut.sync_tolerance * length, color="black", linewidth=0.8, label="sync tolerance")
    below.set(xlabel="time (s)", ylabel=f"sync error ({unit_shown('m', units)})", ylim=(0.0, None))
    figure.suptitle(
        f"{job.name}: {planned.asked.pieces} pieces in {plan.time:.4g} s, at the slowest piece's speed "
        f"{planned.time_at_slowest:.4g} s",
        fontsize=9.5,
    )
    handles = [*above.get_legend_handles_labels()[0], *below.get_legend_handles_labels()[0]]
    figure.legend(handles=handles, loc="outside lower center", ncols=4)
    return figure
