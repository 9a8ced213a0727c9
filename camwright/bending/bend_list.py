"""The bend list: every bend with its line, feed, angles and times, for the CSV file and the sheet."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camwright.bending.job import BenderJob
from camwright.bending.program_file import BentOutline

_HEADER = (
    "bend,line,feed_mm,workpiece_angle_deg,radius_mm,mould_angle_deg,springback_deg,"
    "feed_start_s,bend_start_s,return_start_s"
)


@dataclass(frozen=True)
class BendRow:
    """One bend.

    Parameters
    ----------
    bend
        Its number, from 1.
    line
        Line number of the bend in the program.
    feed
        Feed before it (mm).
    turn
        Workpiece angle (degrees), positive to the left.
    radius
        Radius of the arc that it is a part of (mm), ``None`` at a corner.
    mould
        Mould angle (degrees), positive to the left.
    feed_start, bend_start, return_start
        Times (s) from the start of the program.
    """

    bend: int
    line: int
    feed: float
    turn: float
    radius: float | None
    mould: float
    feed_start: float
    bend_start: float
    return_start: float

    @property
    def compensation(self) -> float:
        """What is added for springback (degrees)."""
        return abs(self.mould) - abs(self.turn)


def bend_rows(outline: BentOutline, job: BenderJob, most: int | None = None) -> list[BendRow]:
    """List the bends of an outline, the first ``most`` of them if that is given."""
    count = outline.plan.bends if most is None else min(most, outline.plan.bends)
    numbers = job.numbering.numbers(outline.program.blocks)[outline.program.bend_blocks()[:count]]
    columns = zip(
        numbers.tolist(),
        (outline.program.feeds[:count] / 1e3).tolist(),
        np.degrees(outline.plan.turns[:count]).tolist(),
        (1e3 * outline.plan.radii[:count]).tolist(),
        (outline.program.bends[:count] / 1e3).tolist(),
        outline.times.feed_start[:count].tolist(),
        outline.times.bend_start[:count].tolist(),
        outline.times.return_start[:count].tolist(),
        strict=True,
    )
    return [
        BendRow(i + 1, line, feed, turn, None if radius == float("inf") else radius, mould, *times)
        for i, (line, feed, turn, radius, mould, *times) in enumerate(columns)
    ]


def csv_text(outline: BentOutline, job: BenderJob) -> str:
    """Write the bend list as CSV, units in the header; the last row is the feed after the last bend."""
    lines = [_HEADER]
    lines += [
        f"{row.bend},N{row.line:03d},{row.feed:.3f},{row.turn:.4f},"
        f"{'' if row.radius is None else f'{row.radius:.4f}'},{row.mould:.3f},{row.compensation:.4f},"
        f"{row.feed_start:.4f},{row.bend_start:.4f},{row.return_start:.4f}"
        for row in bend_rows(outline, job)
    ]
    lines.append(f"end,,{outline.program.feeds[-1] / 1e3:.3f},,,,,{outline.times.feed_start[-1]:.4f},,")
    return "\n".join(lines) + "\n"
