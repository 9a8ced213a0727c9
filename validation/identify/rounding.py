"""What the rounding of recorded positions to counts does to a fit: it is no white noise where the axis meets the counts in step."""

from __future__ import annotations

import math

import numpy as np

from camwright.profiles.polynomial.profile import FloatArray
from camwright.profiles.servo import Servo
from camwright.validation.identify.fit import Minimum, TraceFit

_FINEST = 1e-8
"""Count below which nothing is rounded, as a part of the signal's range."""

_OFF = 1e-4
"""Part of a count that a position may be off the grid."""

_KINDS = 8
"""Steps of different size, in counts, that a grid must have been met by: a motion of two speeds is no grid."""

_DRAWS = 64
_SEED = 20


def count_of(signal: FloatArray) -> float:
    """Give the count of which all positions are whole multiples from one another; 0 if there is none.

    The greatest common divisor of the steps between the positions that occur, by Euclid's algorithm with a tolerance.
    """
    least = _FINEST * float(np.ptp(signal))
    if not least > 0.0:
        return 0.0
    steps = np.diff(np.unique(signal))
    steps = steps[steps > least]
    if not len(steps):
        return 0.0
    grid = float(steps.min())
    while grid > least:
        rest = steps - grid * np.round(steps / grid)
        worst = float(np.abs(rest).max())
        if worst <= _OFF * grid:
            moves = np.round(np.abs(np.diff(signal)) / grid)
            return grid if len(np.unique(moves)) >= _KINDS else 0.0
        grid = float(np.abs(rest)[np.abs(rest) > _OFF * grid].min())
    return 0.0


def with_rounding(fit: TraceFit, found: Minimum, command: float, actual: float) -> Minimum:
    """Widen the confidence by what rounding does to the parameters.

    The fitted axis is rounded as the recorded one was, the zero of the counts anywhere, its noise added before; and the command alike.
    What that moves the parameters by, many times, is what it may have done here. Where the noise is more than a count this is that of
    white noise, which the confidence holds already; where positions meet the counts in step, at a steady speed, it is far more.

    Parameters
    ----------
    found
        The fit.
    command, actual
        Counts of the two signals (unit of the trace), 0 where they are not rounded.
    """
    if not (command or actual):
        return found
    servo, random = Servo(**found.values), np.random.default_rng(_SEED)
    slopes = fit.slopes(found.values, found.names, None)
    size = np.sqrt((slopes**2).sum(axis=0))
    scale = np.where(size > 0.0, size, 1.0)  # at the end of its range a parameter may move nothing
    back = np.linalg.pinv(slopes / scale) / scale[:, None]
    axis, asked = fit.mean(servo), fit.command(fit.times)
    variance = found.cost / (len(fit.times) - len(found.names) - 3)
    white = math.sqrt(max(variance - actual**2 / 12.0, 0.0))
    moved = np.zeros(len(found.names))
    for _ in range(_DRAWS):
        error = random.normal(0.0, white, len(axis)) if white else np.zeros(len(axis))
        if actual:
            place = axis + error + actual * random.random()
            error = error + actual * np.round(place / actual) - place
        if command:
            place = asked + command * random.random()
            error = error - fit.filtered(servo, command * np.round(place / command) - place)
        moved += (back @ error) ** 2
    errors = np.sqrt(np.diag(back @ back.T) * variance)
    factors = np.maximum(np.sqrt(moved / _DRAWS) / np.where(errors > 0.0, errors, np.inf), 1.0)
    return found.widened(dict(zip(found.names, factors.tolist(), strict=True)))
