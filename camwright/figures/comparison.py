"""The comparison figure: peaks, root mean squares and settling length of all profiles as bars."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from camwright.figures.panel import RIGHT, WIDTH, first_frame, head, page, stroked
from camwright.figures.strokes import LIMIT, LINES
from camwright.figures.style import broken_note, title
from camwright.house.numbers import converted, number, unit_shown
from camwright.house.pictures import Bar, Frame, Item, Note, Picture, Tick
from camwright.house.pictures import ticks as spread_ticks
from camwright.house.svg import text_width
from camwright.profiles.objective import OBJECTIVES
from camwright.studies.comparison import Comparison
from camwright.studies.measured import Measured

_BASELINE = "#b5b5b5"
_NOTHING = "#ffffff"
_BEYOND = 1e-9
"""Part of a limit by which rounding may exceed it."""

_FAR = 4.0
"""A limit is drawn as a line if it is at most this many times the longest bar, else named in words."""

_LEFT, _GAP, _ROW, _HEADING = 156.0, 12.0, 22.0, 36.0
"""Room for the names, between two columns, for a profile, and for the headings (pt)."""

_HALF = 0.33
"""Half the height of a bar, as a part of its row."""

_CLEAR = 4.0
"""Room between two numbers of a scale (pt)."""

_BROAD = 1.55
"""Width of a column, as a multiple of its longest bar: numbers stand beside the bars."""


@dataclass(frozen=True)
class _MeasureColumn:
    """A measure of all profiles, in the units shown; the word for what has none."""

    heading: str
    values: Sequence[float | None]
    limit: float | None
    without: str = "unbounded"


def bars_figure(comparison: Comparison) -> Picture:
    """Draw the measures of all profiles side by side by the job's objective, what breaks a limit marked and at the bottom.

    What is unbounded, and what does not exist, has a hatched bar over the whole panel and says so.

    Parameters
    ----------
    comparison
        The profiles measured.
    """
    job, rows = comparison.job, comparison.rows
    columns = _columns(comparison)
    heading = head(job.name, f"all profiles, by {OBJECTIVES[job.objective].words}") + broken_note(rows)
    top = first_frame(heading) + _HEADING
    width = (WIDTH - _LEFT - RIGHT + _GAP) / len(columns) - _GAP
    ticks = [Tick(float(-i), _label(row), row.name == "optimised") for i, row in enumerate(rows)]
    names = [row.name for row in rows]
    frames = [
        _panel(column, names, ticks if i == 0 else (), (_LEFT + i * (width + _GAP), top, width))
        for i, column in enumerate(columns)
    ]
    return page(heading, frames, _legend(frames))


def _columns(comparison: Comparison) -> list[_MeasureColumn]:
    """Choose the measures that are drawn."""
    job, rows = comparison.job, comparison.rows
    units, slave = job.units, job.machine.slave_unit
    acceleration, jerk = (units.measure(f"{slave}/s^{order}") for order in (2, 3))
    length, millimetres = converted(1.0, "m", units), unit_shown("m", units)

    def scaled(values: Sequence[float | None], factor: float) -> list[float | None]:
        return [None if value is None else value * factor for value in values]

    columns = [
        _MeasureColumn(
            f"peak acc.\n({acceleration.printed})",
            scaled([row.motion.peak_acceleration for row in rows], acceleration.factor),
            job.limits.acceleration * acceleration.factor,
        ),
        _MeasureColumn(
            f"RMS acc.\n({acceleration.printed})",
            scaled([row.motion.rms_acceleration for row in rows], acceleration.factor),
            None,
        ),
        _MeasureColumn(
            f"peak jerk\n({jerk.printed})",
            scaled([row.motion.peak_jerk for row in rows], jerk.factor),
            job.limits.jerk * jerk.factor,
        ),
        _MeasureColumn(f"RMS jerk\n({jerk.printed})", scaled([row.motion.rms_jerk for row in rows], jerk.factor), None),
        _MeasureColumn(
            f"settling\n({millimetres})", scaled([row.response.settling for row in rows], length), None, "not in zone"
        ),
    ]
    if job.objective == "sync_error":
        errors = scaled([row.value("sync_error") for row in rows], length)
        worst = "worst sync\nerror" if rows[0].worst_error is not None else "sync error\n"
        columns.append(
            _MeasureColumn(f"{worst} ({millimetres})".replace("\n ", "\n"), errors, job.cut.sync_tolerance * length)
        )
    asked = OBJECTIVES[job.objective if OBJECTIVES[job.objective].of == "motor" else "rms_torque"]
    loads = [row.value(asked.name) for row in rows]
    if any(load is not None for load in loads):
        columns.insert(2, _MeasureColumn(f"{asked.words}\n({'J' if asked.form == 'drawn' else 'N·m'})", loads, None))
    return columns


def _label(row: Measured) -> str:
    """Name a profile, marked if it breaks a limit of the job."""
    name = title(row.name).split(" (")[0].split(",")[0]
    return name if row.within_limits else f"{name} †"


def _legend(frames: Sequence[Frame]) -> list[Item]:
    """Tell what is there to be seen, in a fixed order."""
    order = ("optimised", "baseline", "beyond the limit", "unbounded or none", "limit of the drive")
    seen = {item.label: item for frame in frames for item in frame.items}
    if "beyond the limit" in seen:
        seen["beyond the limit"] = Bar((0.0, 0.0), (1.0, 1.0), _BASELINE, "lines", "beyond the limit")
    seen.setdefault("baseline", Bar((0.0, 0.0), (1.0, 1.0), _BASELINE, "", "baseline"))
    seen.setdefault("optimised", Bar((0.0, 0.0), (1.0, 1.0), LINES["optimised"].colour, "", "optimised"))
    return [seen[label] for label in order if label in seen]


def _panel(
    column: _MeasureColumn, names: Sequence[str], ticks: Sequence[Tick], place: tuple[float, float, float]
) -> Frame:
    """Draw one measure of all profiles, its numbers written beside the bars; arguments end with left, top and width (pt)."""
    limit = column.limit
    longest = max((value for value in column.values if value is not None), default=0.0) or limit or 1.0
    drawn = limit is not None and limit <= _FAR * longest
    items: list[Item] = []
    low, high = -(len(names) - 0.4), 0.6
    if limit is not None and drawn:
        longest = max(longest, limit)
        items.append(stroked(LIMIT, np.array([[limit, low], [limit, high]]), "limit of the drive"))
    for i, (name, value) in enumerate(zip(names, column.values, strict=True)):
        items += _bar(-float(i), name, value, column, _BROAD * longest)
    left, top, width = place
    return Frame(
        left, top, width, _ROW * (len(names) + 0.2), np.array([0.0, low]), np.array([_BROAD * longest, high]), items,
        "" if drawn or limit is None else f"limit {number(limit)}: off scale", "", column.heading,
        xticks=_xticks(_BROAD * longest, width), yticks=ticks, numbers=True, edges=False,
    )  # fmt: skip


def _xticks(high: float, width: float) -> list[Tick]:
    """Choose ticks from zero whose numbers stand clear of each other and of those of the next column."""
    chosen: list[Tick] = []
    for most, share in ((3, 1.0), (3, 0.8), (2, 0.8), (2, 0.6)):
        values, texts = spread_ticks(0.0, share * high, most)
        chosen = [Tick(value, text) for value, text in zip(values, texts, strict=True)]
        ends = [(value / high * width, 0.5 * text_width(text)) for value, text in zip(values, texts, strict=True)]
        apart = all(there + half + _CLEAR <= then - beside for (there, half), (then, beside) in pairwise(ends))
        if apart and sum(ends[-1]) <= width:
            break
    return chosen


def _bar(at: float, name: str, value: float | None, column: _MeasureColumn, width: float) -> list[Item]:
    """Draw the bar of a profile at a height, and what is written to it."""
    low, high = at - _HALF, at + _HALF
    if value is None:
        return [
            Bar((0.0, low), (width, high), _NOTHING, "crosses", "unbounded or none"),
            Note((0.5 * width, at), column.without, "middle", size=8.0, boxed=True),
        ]
    beyond = column.limit is not None and value > column.limit * (1 + _BEYOND)
    colour, label = (LINES["optimised"].colour, "optimised") if name == "optimised" else (_BASELINE, "baseline")
    return [
        Bar((0.0, low), (value, high), colour, "lines" if beyond else "", "beyond the limit" if beyond else label),
        Note((value, at), number(value, 4), "start", (3.0, 0.0), 8.0),
    ]
