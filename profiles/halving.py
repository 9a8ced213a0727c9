"""Where something begins to work: the edge between a value that does and one that does not, by halving or by how much is missed."""

from __future__ import annotations

import math
from collections.abc import Callable

_MOST = 200
"""Halvings at most; between two floats of usual size there are fewer before they are neighbours."""

_SPARE = 0.4
"""Room left beside a guess, in resolutions, for it to lie on the other side of the edge than the last length did."""

_ENDING = 0.9
"""Share of the resolution beside an end, to which a guess within it is moved: that on the other side of the edge it ends the search."""

_SLOW, _SLOWEST = 3, 6
"""After so many guesses in a row that leave more than half of a range its middle is looked at; of guesses that may end the search."""


def halved(
    works: Callable[[float], bool], good: float, bad: float, tolerance: float = 0.0, most: int = _MOST
) -> tuple[float, float]:
    """Narrow the interval between a value that works and one that does not, whichever is greater.

    Neither end is asked again. Where what works changes more than once between them, one of these edges is found.

    Parameters
    ----------
    works
        Whether a value does.
    good, bad
        Values that do and do not.
    tolerance
        Share of the bad end that the interval may be wide; 0 halves until the ends are neighbouring floats.
    most
        Halvings at most, for what takes long to ask.

    Returns
    -------
    (good, bad)
        The ends of what is left.

    Examples
    --------
    >>> good, bad = halved(lambda value: value * value < 2, 1.0, 2.0)
    >>> good * good < 2 <= bad * bad, bad - good < 1e-15
    (True, True)
    """
    for _ in range(most):
        middle = 0.5 * (good + bad)
        if middle in (good, bad) or abs(good - bad) <= tolerance * abs(bad):
            break
        good, bad = (middle, bad) if works(middle) else (good, middle)
    return good, bad


def narrowed(
    missed: Callable[[float], float], fails: tuple[float, float], holds: tuple[float, float], resolution: float
) -> tuple[float, float]:
    """Narrow the interval between a value that fails and a greater one that holds, by how much each misses.

    Looked at is where a straight line reaches zero, and the middle where that leaves more than half again and again or only signs are
    known. The line goes through both ends, or through an end and the value that it moved from where it moved twice: it is bent least there.

    Parameters
    ----------
    missed
        By how much it is missed at a value: at most zero where it holds, infinite where no more is known.
    fails, holds
        The ends, and what they miss.
    resolution
        Accuracy of the value, relative to it; and by how much no more need be kept.

    Returns
    -------
    (value, missed)
        The end that holds, of what is left.
    """
    before: tuple[float, float] | None = None
    moved: bool | None = None
    slow, spare, ending = 0, _SPARE * resolution * holds[0], _ENDING * resolution * holds[0]
    while (width := holds[0] - fails[0]) > resolution * holds[0] and holds[1] < -resolution:
        length = 0.5 * (fails[0] + holds[0])
        end, other = (fails, holds) if moved else (holds, fails)
        zero = zero_between(end, before) or zero_between(end, other)
        if zero is not None:
            start, way = (holds[0], -1.0) if moved is False else (fails[0], 1.0)
            step = _step(max(way * (zero - start), 0.0) + spare, width - spare, spare, ending, slow)
            length = length if step is None else start + way * step
        found = missed(length)
        again, moved = moved == (found > 0.0), found > 0.0
        last, opposite = (fails, holds) if moved else (holds, fails)
        before = last if again or math.isinf(opposite[1]) else None
        fails, holds = ((length, found), holds) if moved else (fails, (length, found))
        slow = slow + 1 if holds[0] - fails[0] > 0.5 * width else 0
    return holds


def _step(guessed: float, most: float, spare: float, ending: float, slow: int) -> float | None:
    """Give the step from an end: the one that ends the search, or the guessed one; None for the middle, after too many slow ones."""
    if slow >= _SLOWEST or most <= spare:
        return None
    if guessed <= ending:
        return ending
    return min(guessed, most) if slow < _SLOW else None


def zero_between(one: tuple[float, float], other: tuple[float, float] | None) -> float | None:
    """Where the line through two points reaches zero, if it falls."""
    if other is None or not math.isfinite(one[1] - other[1]) or (one[1] - other[1]) * (one[0] - other[0]) >= 0.0:
        return None
    return one[0] - one[1] * (one[0] - other[0]) / (one[1] - other[1])
