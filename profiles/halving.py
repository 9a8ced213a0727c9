"""Where something begins to work: the edge between a value that does and one that does not, by halving."""

from __future__ import annotations

from collections.abc import Callable

_MOST = 200
"""Halvings at most; between two floats of usual size there are fewer before they are neighbours."""


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
