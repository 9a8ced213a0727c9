"""The least cut length at which something holds, from where it is expected."""

from __future__ import annotations

import math
from collections.abc import Callable

_STEEP = 50.0
"""What a share of the tolerance is taken to fall by, as a logarithm, while the cut length grows by a share of itself: first steps are laid
by it."""

_LEAST_STEP, _GREATEST_STEP, _GROWTH = 0.6, 0.025, 2.0
"""Bounds of these steps, in resolutions and as a share of the length, and by what each further one is longer."""

_SPARE = 0.4
"""Room left beside a guess, in resolutions, for it to lie on the other side of the edge than the last length did."""

_SLOW = 3
"""After so many guesses in a row that leave more than half of a range its middle is looked at."""


def least_length(
    missed: Callable[[float], float], near: float, ends: tuple[float, float], resolution: float
) -> float | None:
    """Find the least length at which something holds, as if it held at every longer one.

    Parameters
    ----------
    missed
        By how much it is missed at a length (m), as the logarithm of a share: at most zero where it holds, infinite where no more is known.
    near
        Where the length is expected (m).
    ends
        Lengths that are looked at (m).
    resolution
        Accuracy of the length, relative to it.

    Returns
    -------
    float or None
        A length (m) that was looked at and holds, while one shorter by the resolution does not, as was seen or as follows where the share
        falls by no less than a share of the length; or the least of all. ``None`` where the longest fails.
    """
    (low, high), length, longer = ends, min(max(near, ends[0]), ends[1]), 1.0
    fails: tuple[float, float] | None = None
    holds: tuple[float, float] | None = None
    while fails is None or holds is None:
        found = missed(length)
        if found > 0.0:
            if length >= high:
                return None
            fails = length, found
        else:
            if length <= low or found >= -resolution:
                return length
            holds = length, found
        step = longer * max(min(abs(found) / _STEEP, _GREATEST_STEP), _LEAST_STEP * resolution)
        length = min(length * (1.0 + step), high) if found > 0.0 else max(length / (1.0 + step), low)
        longer *= _GROWTH
    return _narrowed(missed, fails, holds, resolution)


def _narrowed(
    missed: Callable[[float], float], fails: tuple[float, float], holds: tuple[float, float], resolution: float
) -> float:
    """Look where a straight line reaches zero, at the middle where that leaves more than half again and again or only signs are known.

    The line goes through both ends, or through an end and the length that it moved from, where it moved twice: it is bent least there.
    """
    before: tuple[float, float] | None = None
    moved: bool | None = None
    slow, spare = 0, _SPARE * resolution * holds[0]
    while (width := holds[0] - fails[0]) > resolution * holds[0] and holds[1] < -resolution:
        length = 0.5 * (fails[0] + holds[0])
        if slow < _SLOW and width > 2.0 * spare:
            end, other = (fails, holds) if moved else (holds, fails)
            zero = _zero(end, before) or _zero(end, other)
            if zero is not None:
                zero += spare if moved or moved is None else -spare
                length = min(max(zero, fails[0] + spare), holds[0] - spare)
        found = missed(length)
        before = (fails if found > 0.0 else holds) if moved == (found > 0.0) else None
        moved = found > 0.0
        if moved:
            fails = length, found
        else:
            holds = length, found
        slow = slow + 1 if holds[0] - fails[0] > 0.5 * width else 0
    return holds[0]


def _zero(one: tuple[float, float], other: tuple[float, float] | None) -> float | None:
    """Where the line through two points reaches zero, if it falls."""
    if other is None or not math.isfinite(one[1] - other[1]) or (one[1] - other[1]) * (one[0] - other[0]) >= 0.0:
        return None
    return one[0] - one[1] * (one[0] - other[0]) / (one[1] - other[1])
