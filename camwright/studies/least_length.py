"""The least cut length at which something holds, from where it is expected."""

from __future__ import annotations

from collections.abc import Callable

from camwright.profiles.halving import narrowed, zero_between

STEEP = 50.0
"""What a share of the tolerance is taken to fall by, as a logarithm, while the cut length grows by a share of itself: the first step is
laid by it, further ones by what it was seen to fall by."""

AWARE_STEEP = 25.0
"""The same for servo-aware commands, whose error falls less."""

_LEAST_STEP, _GREATEST_STEP, _GROWTH = 0.6, 1.25, 2.0
"""Bounds of these steps, in resolutions and as what the first share is taken to fall by, and by what each further one may and must be
longer."""

_FAR, _CLOSE = 0.3, 0.1
"""A sketch that keeps its tolerance by so great a share, as a logarithm, needs no whole look until that place is told; nor does one that
misses it by more than the other: what is near to it is worse on the whole."""

_DEEP = 1.25
"""Shares that are kept by more than this, as a logarithm, are not told apart: no line leads from there to the edge."""

_FLATTER = 0.4
"""No step takes the share to fall by less than so much of what the one before took: near the edge it is not known so well."""

BEYOND = 1.1
"""Steps go so much farther than to where the share would be zero, to the other side of the edge."""


def nowhere(_length: float) -> tuple[float, float]:
    """Expect no length."""
    return 0.0, STEEP


def least_length(
    missed: Callable[[float], float],
    near: float,
    ends: tuple[float, float],
    resolution: float,
    steep: float = STEEP,
    expected: Callable[[float], tuple[float, float]] = nowhere,
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
    steep
        What the share is taken to fall by, as `STEEP`.
    expected
        After a look at a length that fails, where the edge is expected (m), and what the share is taken to fall by there; a step that would
        be shorter goes there. 0 where that is not told.

    Returns
    -------
    float or None
        A length (m) that was looked at and holds, while one shorter by the resolution does not, as was seen or as follows where the share
        falls by no less than a share of the length; or the least of all. ``None`` where the longest fails.
    """

    def seen(length: float) -> float:
        return max(missed(length), -_DEEP)

    (low, high), length, longer = ends, min(max(near, ends[0]), ends[1]), 1.0
    fails: tuple[float, float] | None = None
    holds: tuple[float, float] | None = None
    greatest = _GREATEST_STEP / steep
    while fails is None or holds is None:
        before = fails or holds
        found = seen(length)
        if found > 0.0:
            if length >= high:
                return None
            fails = length, found
        else:
            if length <= low or found >= -resolution:
                return length
            holds = length, found
        zero = zero_between((length, found), before)
        if zero is not None and zero != length:
            steep = max(abs(found) * length / (BEYOND * abs(zero - length)), _FLATTER * steep)
        step = max(min(abs(found) / steep, longer * greatest), longer * _LEAST_STEP * resolution)
        length = min(length * (1.0 + step), high) if found > 0.0 else max(length / (1.0 + step), low)
        longer *= _GROWTH
        if fails is not None and holds is None and (there := expected(fails[0]))[0] > length:
            length, steep, fails = min(there[0], high), there[1] / BEYOND, None
    return narrowed(seen, fails, holds, resolution)[0]


class SketchedFirst:
    """By how much something is missed, as `least_length` asks: by a sketch, which misses no more than the whole; near the edge, by all.

    From the first place on that is near to it and fails all is looked at: a line through values of both kinds leads nowhere.

    Parameters
    ----------
    sketch, whole
        By how much is missed at a place; no sketch where it would be the whole.
    """

    def __init__(self, sketch: Callable[[float], float] | None, whole: Callable[[float], float]) -> None:
        self._sketch, self._whole = sketch, whole
        self._known: dict[float, float] = {}
        self._misled = False

    def __call__(self, at: float) -> float:
        """Say by how much is missed at a place."""
        if self._sketch is not None and not self._misled:
            missed = self._sketch(at)
            if missed > _CLOSE or missed < -_FAR:
                return missed
            self._misled = self.by_all(at) > 0.0
        return self.by_all(at)

    def by_all(self, at: float) -> float:
        """Say by how much the whole misses at a place."""
        if at not in self._known:
            self._known[at] = self._whole(at)
        return self._known[at]
