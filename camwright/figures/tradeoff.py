"""The trade-off figure: what each objective and each law costs, peak acceleration over torque and over jerk."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from camwright.figures.labels import label_points
from camwright.figures.panel import LEFT, NOTHING, RIGHT, WIDTH, first_frame, head, page
from camwright.figures.strokes import BLACK, LINES
from camwright.figures.style import title
from camwright.house.numbers import Shown
from camwright.house.pictures import Band, DrawnLine, DrawnMarks, Frame, Item, Note, Picture, Shape, Tick, ticks
from camwright.profiles.objective import CommandObjective
from camwright.profiles.polynomial.profile import FloatArray
from camwright.studies.tradeoff import Row, TradeOff, measure_words

_SAME = 2e-3
"""Share of the panel within which points count as one and share a label."""

_WIDE = 4.0
"""Greatest over least value from which an axis is logarithmic."""

_ROOM = 0.12
"""Room at both ends of an axis, as a part of what it spans."""

_STRIP = 0.27
"""Width of the strip of unbounded values, as a part of the rest."""

_PANEL, _GAP = 252.0, 48.0
"""Height of a panel, and room between the two (pt)."""

_LABEL = 8.0
"""Size of a point's label (pt)."""

_APART = 44.0
"""Least distance of ticks along x (pt)."""

_STYLES: dict[str, tuple[Shape, str, float, str]] = {
    "objective": ("disc", LINES["optimised"].colour, 6.0, "optimum of an objective"),
    "baseline": ("frame", "#8c8c8c", 7.0, "baseline"),
    "beyond": ("cross", "#555555", 5.5, "baseline that breaks a limit"),
}
"""Shape, colour and size of a point, and what it is: discs, open squares and crosses differ without colour."""


@dataclass(frozen=True)
class _Scale:
    """An axis: what it spans, in logarithms where that is a lot.

    Parameters
    ----------
    low, high
        Its ends, as they are laid out.
    wide
        Whether they are logarithms.
    edge
        Beyond this unbounded values stand; at its end where there are none.
    """

    low: float
    high: float
    wide: bool
    edge: float

    def at(self, value: float | None) -> float:
        """Give the place of a value, of an unbounded one in the middle of the strip."""
        if value is None:
            return 0.5 * (self.edge + self.high)
        return math.log10(value) if self.wide else value

    def ticks(self, most: int) -> list[Tick]:
        """Choose ticks up to the edge: round numbers, or 1, 2 and 5 of each power of ten."""
        if not self.wide:
            return [Tick(*each) for each in zip(*ticks(self.low, self.edge, most), strict=True)]
        powers = range(math.floor(self.low), math.ceil(self.edge) + 1)
        steps = (1.0, 2.0, 5.0) if self.edge - self.low < most / 3 else (1.0,)
        values = [step * 10.0**power for power in powers for step in steps]
        return [Tick(math.log10(v), f"{v:g}") for v in values if self.low <= math.log10(v) <= self.edge]


def tradeoff_figure(result: TradeOff) -> Picture:
    """Draw all profiles of a trade-off as points: peak acceleration over RMS torque, or RMS acceleration, and over peak jerk.

    Profiles of unbounded jerk stand beyond a line at the right edge; those of unbounded acceleration are named below.
    """
    bounded = [row for row in result.rows if row.values["peak_acceleration"] is not None]
    heating: CommandObjective = "rms_torque" if "rms_torque" in result.measures else "rms_acceleration"
    heading = head(result.job.name, "what each objective costs")
    top = first_frame(heading)
    unbounded = [_label(row) for row in result.rows if row.values["peak_acceleration"] is None]
    note = f"\nnot drawn, with an unbounded acceleration: {', '.join(unbounded)}" if unbounded else ""
    frames = [
        _panel(result, bounded, heating, top, ""),
        _panel(result, bounded, "peak_jerk", top + _PANEL + _GAP, note),
    ]
    kinds = [kind for kind in _STYLES if any(_kind(row) == kind for row in bounded)]
    legend: list[Item] = [_mark(kind, NOTHING, _STYLES[kind][3]) for kind in kinds]
    return page(heading, frames, legend)


def _panel(result: TradeOff, rows: Sequence[Row], measure: CommandObjective, top: float, note: str) -> Frame:
    """Draw the points of a panel and label them; those at one place share a label."""
    across, up = _measure(result, measure), _measure(result, "peak_acceleration")
    pairs = [
        tuple(_times(row.values[name], unit) for name, unit in ((measure, across), ("peak_acceleration", up)))
        for row in rows
    ]
    x, y = _scale([pair[0] for pair in pairs]), _scale([pair[1] for pair in pairs])
    size = np.array([WIDTH - LEFT - RIGHT, _PANEL])
    low, high = np.array([x.low, y.low]), np.array([x.high, y.high])
    places = np.array([[x.at(a), y.at(b)] for a, b in pairs])
    items: list[Item] = []
    if x.edge < x.high:
        items += [Band(x.edge, x.high, "grey"), DrawnLine(np.array([[x.edge, y.low], [x.edge, y.high]]), BLACK, 1.0)]
        items.append(Note((x.high, y.high), "unbounded", "end", (-4.0, 8.0), _LABEL))
    items += [_mark(_kind(row), place[None]) for row, place in zip(rows, places, strict=True)]
    groups = _groups((places - low) / (high - low), [_label(row) for row in rows])
    walls = [float((x.edge - x.low) / (x.high - x.low) * size[0])] if x.edge < x.high else []
    found = label_points(
        (size[0], size[1]),
        np.array([place for place, _ in groups]) * size,
        [text for _, text in groups],
        walls=walls,
        size=_LABEL,
    )
    for (place, text), (middle, tip) in zip(groups, found, strict=True):
        centre = low + middle / size * (high - low)
        items.append(Note((float(centre[0]), float(centre[1])), text, "middle", size=_LABEL))
        if tip is not None:
            items.append(DrawnLine(low + np.array([place, tip / size]) * (high - low), "#8c8c8c", 0.6))
    return Frame(
        LEFT, top, size[0], _PANEL, low, high, items, f"{measure_words(measure)} ({across.printed}){note}",
        f"peak acceleration ({up.printed})", grid=True, xticks=x.ticks(int(size[0] / _APART)), yticks=y.ticks(8),
    )  # fmt: skip


def _measure(result: TradeOff, measure: CommandObjective) -> Shown:
    """Give the unit in which a measure is shown."""
    return result.job.units.measure(result.unit(measure))


def _times(value: float | None, unit: Shown) -> float | None:
    return None if value is None else value * unit.factor


def _kind(row: Row) -> str:
    return row.kind if row.within_limits or row.kind == "objective" else "beyond"


def _mark(kind: str, points: FloatArray, label: str = "") -> DrawnMarks:
    shape, colour, size, _ = _STYLES[kind]
    return DrawnMarks(points, colour, size, shape, label)


def _label(row: Row) -> str:
    """Name of a point: what is least in it, or the law."""
    if row.kind == "objective":
        return f"minimised {measure_words(row.name)}"
    return title(row.name).split(" (")[0].split(",")[0]


def _groups(shares: FloatArray, names: Sequence[str]) -> list[tuple[FloatArray, str]]:
    """Join the names of points that lie at one place of the panel, given as shares of it."""
    groups: list[tuple[FloatArray, str]] = []
    for share, name in zip(shares, names, strict=True):
        near = next((i for i, (place, _) in enumerate(groups) if np.abs(place - share).max() <= _SAME), None)
        if near is None:
            groups.append((share, name))
        else:
            groups[near] = groups[near][0], f"{groups[near][1]}\n{name}"
    return groups


def _scale(values: Sequence[float | None]) -> _Scale:
    """Set an axis with room for labels; unbounded values get a strip of their own at its end."""
    finite = [value for value in values if value is not None]
    least, greatest = min(finite, default=0.9), max(finite, default=1.1)
    wide = least > 0.0 and greatest > _WIDE * least
    if greatest - least <= 1e-3 * greatest:
        spread = 0.1 * greatest or 1.0
        least, greatest = least - spread, greatest + spread
    low, high = (math.log10(least), math.log10(greatest)) if wide else (least, greatest)
    room = _ROOM * (high - low)
    low, edge = low - room, high + room
    strip = _STRIP * (edge - low) if len(finite) < len(values) else 0.0
    return _Scale(low, edge + strip, wide, edge)
