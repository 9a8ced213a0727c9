"""The bend list: every bend with its line, feed, angles and times, for the CSV file and the sheet."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import groupby
from typing import Any

import numpy as np

from camwright.bender.job import BenderJob
from camwright.bender.program_file import BentOutline
from camwright.profiles.bender.bridges import bridge_places

_HEADER = (
    "bend,line,feed_mm,workpiece_angle_deg,radius_mm,mould_angle_deg,springback_deg,"
    "feed_start_s,bend_start_s,return_start_s,bridges_mm,cut_lines"
)
_ROW = "%d,N%03d,%.3f,%.4f,%s,%.3f,%.4f,%.4f,%.4f,%.4f,%s,%s"


def bend_rows(outline: BentOutline, job: BenderJob, most: int) -> Iterator[tuple[Any, ...]]:
    """List the first bends of an outline, ``most`` of them or all.

    Yields
    ------
    (bend, line, feed, turn, radius, mould, springback, feed_start, bend_start, return_start)
        Its number from 1 and its line in the program; the feed before it (mm); workpiece angle (degrees), positive to the left; radius
        of the arc that it is a part of (mm), infinite at a corner; mould angle; what is added for springback; times from the start (s).
    """
    count = min(most, outline.plan.bends)
    turns, moulds = np.degrees(outline.plan.turns[:count]), outline.program.bends[:count] / 1e3
    numbers = job.numbering.numbers(outline.program.blocks)[outline.program.bend_blocks()[:count]]
    return zip(
        range(1, count + 1),
        numbers.tolist(),
        (outline.program.feeds[:count] / 1e3).tolist(),
        turns.tolist(),
        (1e3 * outline.plan.radii[:count]).tolist(),
        moulds.tolist(),
        (np.abs(moulds) - np.abs(turns)).tolist(),
        outline.run.times.feed_start[:count].tolist(),
        outline.run.times.bend_start[:count].tolist(),
        outline.run.times.return_start[:count].tolist(),
        strict=True,
    )


@dataclass(frozen=True)
class BridgeRow:
    """One bridge.

    Parameters
    ----------
    number
        Its number, from 1.
    after
        Number of the bend before it, 0 for the start of the rule.
    begin, end
        Where it begins and ends, from the bend before it (mm).
    middle
        Its middle along the rule (mm).
    line
        Line number of the machine's cut, ``None`` where it is cut by hand.
    """

    number: int
    after: int
    begin: float
    end: float
    middle: float
    line: int | None


def bridge_rows(outline: BentOutline, job: BenderJob) -> list[BridgeRow]:
    """List the bridges of an outline."""
    if not outline.bridges:
        return []
    lines: list[int | None] = [None] * len(outline.bridges)
    if job.bridges.command is not None:
        lines = job.numbering.numbers(outline.program.blocks)[outline.program.cut_blocks()].tolist()
    middles = bridge_places(outline.program, outline.bridges).tolist()
    return [
        BridgeRow(i + 1, bridge.side, 1e3 * (bridge.from_bend - bridge.width / 2),
                  1e3 * (bridge.from_bend + bridge.width / 2), middle / 1e3, line)
        for i, (bridge, middle, line) in enumerate(zip(outline.bridges, middles, lines, strict=True))
    ]  # fmt: skip


def csv_text(outline: BentOutline, job: BenderJob) -> str:
    """Write the bend list as CSV, units in the header; the last row is the feed after the last bend.

    Bridges stand in the row of the feed that they are a part of, from the bend before them.
    """
    lines = [_HEADER]
    bridges = {
        side: (
            ";".join(f"{row.begin:.3f}-{row.end:.3f}" for row in rows),
            ";".join(f"N{row.line:03d}" for row in rows if row.line is not None),
        )
        for side, rows in _by_side(bridge_rows(outline, job)).items()
    }
    for i, line, feed, turn, radius, *others in bend_rows(outline, job, outline.plan.bends):
        size = "" if math.isinf(radius) else f"{radius:.4f}"
        lines.append(_ROW % (i, line, feed, turn, size, *others, *bridges.get(i - 1, ("", ""))))
    end = ",".join(bridges.get(outline.plan.bends, ("", "")))
    lines.append(f"end,,{outline.program.feeds[-1] / 1e3:.3f},,,,,{outline.run.times.feed_start[-1]:.4f},,,{end}")
    return "\n".join(lines) + "\n"


def _by_side(rows: list[BridgeRow]) -> dict[int, list[BridgeRow]]:
    return {side: list(group) for side, group in groupby(rows, key=lambda row: row.after)}
