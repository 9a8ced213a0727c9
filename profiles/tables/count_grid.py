"""Positions that are whole counts of an encoder: the grid is found, and the cam that rounds to it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from camwright.profiles.polynomial.profile import FloatArray
from camwright.profiles.tables.cam_table import CamTable

_FEWEST = 60
"""Points from which on rounding can be told from motion."""
_TRIED = 400
_OFF_GRID = 0.05
"""Part of a count by which positions may miss the grid: they are printed with so many digits."""
_TELLS = 0.01
"""Part of the greatest second difference that the rounding may make up before it counts."""
_STRIDES = 90
"""Parts of the cycle over which the cam's own second difference is seen through the rounding."""
_ONE = 1e-9
"""Part of the travel within which two positions are one."""
_EVEN = 0.02
"""Part of a step by which the points may miss even spacing: the master is counted too."""
_ROUNDS = 50
_UNEVEN = 1e-4
"""Part of a step by which steps that are meant to be even may differ before their rounding counts."""
_COARSEST = 0.9
"""Part of a step that its rounding may make up: beyond, rows are left out or doubled."""


@dataclass(frozen=True)
class Counted:
    """A table whose positions are whole counts.

    Parameters
    ----------
    table
        The smoothest table that misses the counts by no more than rounding does.
    count
        Size of a count in the table's unit.
    note
        A sentence about it.
    """

    table: CamTable
    count: float
    note: str


def evened(table: CamTable) -> CamTable | None:
    """Take the rounding of evenly spaced master positions off, where it would shake the ratio.

    A position that misses its place by half a grain makes the step beside it wrong by as much, and the ratio with it. The places are
    those of even steps that all positions are rounded from, the middle of what these leave open. ``None`` where steps are even, or are
    not so for another reason than rounding, or where the table states ratios of its own.
    """
    if not np.isnan(table.ratio).all() or table.points < _FEWEST:
        return None
    h = table.period / (table.points - 1)
    off = table.x - (table.x[0] + h * np.arange(table.points))
    if float(np.ptp(np.diff(table.x))) <= _UNEVEN * h:
        return None
    grain = grid_of(table.x) or grain_of(table.x)
    if not float(np.ptp(off)) <= 1.001 * grain < _COARSEST * h:
        return None
    begin = float(table.x[0]) + 0.5 * float(off.max() + off.min())
    unit = "" if table.units is None else f" {table.units.master.symbol}"
    note = f"the master's positions are rounded to {grain:.6g}{unit}, {100 * grain / h:.2g} % of their even steps: that is taken off"
    return replace(table, x=begin + h * np.arange(table.points, dtype=np.float64), notes=(*table.notes, note))


def smoothed(table: CamTable) -> CamTable | None:
    """Give the smoothest table that misses evenly spaced positions by no more than rounding to their count does, whatever its law.

    ``None`` where they are no counts, or too few.
    """
    steps = np.diff(table.x)
    h = table.period / (table.points - 1)
    if table.points < _FEWEST or np.abs(steps - h).max() > _EVEN * h:
        return None
    count = grid_of(table.y)
    return None if count is None else replace(table, y=_smoothed(table.y, count))


_FINE = 1e-5
_MOST_DIGITS = 9
_SIGNIFICANT = range(4, 14)
"""Digits of numbers that are written with a floating point."""
_UNITS = (1.0, 1e3, 1e2, 1e6, 1e3 / 25.4)
"""Units in a metre, in which numbers of 32 bits may have been written."""
_OFF_DIGIT = 1e-15
"""What a decimal number may be off its digits, as a part of it: it is stored in binary."""


def without_rounding(table: CamTable) -> Counted | None:
    """Take the rounding to counts off a table of positions, where it would drown the acceleration.

    A count of size ``q`` moves a second difference over a step ``h`` by up to ``2 q / h²``. The smoothed positions have
    the least sum of squared third differences among those that miss the counts by ``q / √12`` (rms), as rounding does.
    Only tables of splines through evenly spaced positions are smoothed; ``None`` where there is nothing to take off.
    """
    if set(table.laws) != {"spline"} or not np.isnan(table.ratio).all() or table.points < _FEWEST:
        return None
    steps = np.diff(table.x)
    h = table.period / (table.points - 1)
    if np.abs(steps - h).max() > _EVEN * h:
        return None
    grid = grid_of(table.y)
    count = max(grid or 0.0, _last_digit(table.y))
    if 2.0 * count / h**2 <= _TELLS * _bend(table.y, h):
        return None
    smooth = _smoothed(table.y, count)
    what = f"whole counts of {count:.6g}" if count == grid else f"rounded to {count:.6g} where they are great"
    note = (
        f"the slave's positions are {what} ({table.advance / count:.6g} a cycle): their rounding is taken off, "
        "and the cam is compared by differences at the sample time (more digits in the file show more)"
    )
    return Counted(replace(table, y=smooth), count, note)


def grid_of(y: FloatArray) -> float | None:
    """Find the greatest number of which all positions are whole multiples apart; ``None`` if there is none.

    The steps between positions are whole multiples too, and sorted they lie so close that their gaps are few counts: from
    the gaps the count is known roughly, from the range of the steps better, from the sum of all steps best.
    """
    steps = np.diff(y)
    span = float(np.ptp(y))
    if not span > 0.0:
        return None
    ordered = np.sort(np.abs(steps))
    gaps = np.diff(ordered)
    usable = np.unique(gaps[gaps > 1e-10 * span])
    if not len(usable):
        return None
    for rough in usable[:_TRIED][::-1]:
        count = _refined(ordered, float(rough))
        if count is not None and _fits(y, steps, count):
            return count
    return None


def grain_of(y: FloatArray) -> float:
    """Find what positions are rounded to: the greatest power of ten, or count, of which they are multiples.

    Where they are written with a floating point it is the last digit of the greatest. 0 for none, and for so few points that whole
    numbers may be meant.
    """
    if len(y) < _FEWEST:
        return 0.0
    for digits in range(_MOST_DIGITS + 1):
        scaled = y * 10.0**digits
        if np.abs(scaled - np.rint(scaled)).max() <= _OFF_DIGIT * max(1.0, float(np.abs(scaled).max())):
            return max(float(10.0**-digits), _last_digit(y))
    return max(grid_of(y) or 0.0, _last_digit(y))


def _last_digit(y: FloatArray) -> float:
    """Give the last digit of the greatest of numbers that are written with as many decimal or binary digits each; 0 if they are not.

    ``%g`` writes six digits of any number; a number of 32 bits has 24 binary ones, whatever unit it is brought to.
    """
    size = np.abs(y[y != 0.0])
    if not len(size):
        return 0.0
    for unit in _UNITS:
        scaled = size * unit
        if (np.abs(scaled.astype(np.float32) - scaled) <= _OFF_DIGIT * scaled).all():
            return float(np.spacing(np.float32(scaled.max()))) / unit
    power = np.floor(np.log10(size))
    for digits in _SIGNIFICANT:
        scaled = size * 10.0 ** (digits - 1.0 - power)
        if (np.abs(scaled - np.rint(scaled)) <= _OFF_DIGIT * scaled).all():
            return float(10.0 ** (power.max() + 1.0 - digits))
    return 0.0


def spacing_rounded_to(x: FloatArray) -> float:
    """Find what master positions are rounded to: no more than evenly spaced ones miss even spacing by, nor `_FINE` of the cycle."""
    steps = np.diff(x)
    return min(grain_of(x), float(np.ptp(steps)), _FINE * float(x[-1] - x[0]))


def _refined(ordered: FloatArray, rough: float) -> float | None:
    """Improve a count by the range of the steps, then by their sum."""
    total = float(np.rint(np.diff(ordered) / rough).sum())
    if total < 1.0:
        return None
    better = float(ordered[-1] - ordered[0]) / total
    if abs(better / rough - 1.0) > 0.25:
        return None
    whole = float(np.rint(ordered / better).sum())
    return float(ordered.sum()) / whole if whole else None


def _fits(y: FloatArray, steps: FloatArray, count: float) -> bool:
    """Whether all positions lie on the grid, and no two that differ on one count of it, as those of points close together would."""
    counts = np.rint(steps / count)
    off = y[1:] - y[0] - count * np.cumsum(counts)
    apart = np.abs(steps[counts == 0.0]).max(initial=0.0)
    return bool(np.abs(off).max() <= _OFF_GRID * count and apart <= _ONE * np.ptp(y))


def _bend(y: FloatArray, h: float) -> float:
    """Greatest second difference over a stride so wide that rounding does not show."""
    stride = max(1, (len(y) - 1) // _STRIDES)
    far = y[2 * stride :] - 2.0 * y[stride:-stride] + y[: -2 * stride]
    return float(np.abs(far).max()) / (stride * h) ** 2


def _smoothed(y: FloatArray, count: float) -> FloatArray:
    """Smooth periodic positions until they miss the given ones by as much as rounding does."""
    n = len(y) - 1
    line = (y[-1] - y[0]) * np.arange(n) / n
    rest = y[:-1] - line
    spectrum = np.fft.rfft(rest)
    weight = (2.0 * np.sin(np.pi * np.arange(len(spectrum)) / n)) ** 6
    allowed = count / 12.0**0.5

    def at(power: float) -> FloatArray:
        return np.asarray(np.fft.irfft(spectrum / (1.0 + 10.0**power * weight), n))

    low, high = -8.0, 24.0
    for _ in range(_ROUNDS):
        middle = 0.5 * (low + high)
        missed = float(np.sqrt(np.mean((at(middle) - rest) ** 2)))
        low, high = (low, middle) if missed > allowed else (middle, high)
    smooth = at(low) + line
    return np.append(smooth, smooth[0] + (y[-1] - y[0]))
