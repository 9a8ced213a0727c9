"""The figure of a cut list: the speed of the line over it, and how far the servo is off at each cut."""

from __future__ import annotations

import numpy as np

from camwright.figures.panel import across, first_frame, head, page, stroked, wide_frame
from camwright.figures.strokes import LIMIT, LINES
from camwright.house.numbers import unit_shown
from camwright.house.pictures import APART, DrawnMarks, Picture
from camwright.production.cut_list import ListStudy

_ABOVE, _BELOW, _GAP = 180.0, 120.0, 18.0
"""Heights of the panels, and room between them (pt)."""


def line_plan_figure(study: ListStudy) -> Picture:
    """Draw the plan over time with each piece's highest speed, and below the sync error at each cut."""
    planned, run = study.planned, study.run
    job, plan = planned.job, planned.line
    units = job.units
    speed, length = units.shown["m/s"].factor, units.shown["m"].factor
    ends = plan.when(np.concatenate([[0.0], np.cumsum(planned.asked.gaps)]))
    time = np.unique(np.concatenate([np.linspace(0.0, plan.time, 2001), plan.times]))
    last = float(max(ends[-1], plan.time))
    steps = np.stack([np.repeat(ends, 2)[1:-1], np.repeat(planned.highest * speed, 2)], axis=1)
    highest = stroked(LIMIT, steps, "highest speed of each piece")
    drawn = stroked(LINES["optimised"], np.stack([time, plan.speed(time) * speed], axis=1), "plan")
    words = "greatest sync error of each piece"
    marks = DrawnMarks(
        np.stack([ends[1:], run.sync_errors * length], axis=1), LINES["linear_return"].colour, 4.0, "disc", words
    )
    tolerance = across(job.cut.sync_tolerance * length, 0.0, last, "sync tolerance")
    heading = head(
        job.name,
        f"{planned.asked.pieces} pieces in {plan.time:.4g} s, at the slowest piece's speed {planned.time_at_slowest:.4g} s",
    )
    top = first_frame(heading)
    fastest = 1.08 * float(planned.highest.max()) * speed
    worst = 1.08 * float(max(run.sync_errors.max(), job.cut.sync_tolerance)) * length
    frames = [
        wide_frame(
            top,
            _ABOVE,
            np.zeros(2),
            np.array([last, fastest]),
            [highest, drawn],
            "",
            f"line speed ({unit_shown('m/s', units)})",
            apart=APART,
        ),
        wide_frame(
            top + _ABOVE + _GAP,
            _BELOW,
            np.zeros(2),
            np.array([last, worst]),
            [tolerance, marks],
            "time (s)",
            f"sync error ({unit_shown('m', units)})",
            apart=APART,
        ),
    ]
    return page(heading, frames, [highest, drawn, marks, tolerance])
