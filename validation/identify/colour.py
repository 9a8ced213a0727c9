"""Noise that is not white: its level at the frequencies where the parameters are seen widens their confidence."""

from __future__ import annotations

import math

import numpy as np

from camwright.profiles.polynomial.profile import FloatArray
from camwright.profiles.servo import Servo
from camwright.validation.identify.fit import CONFIDENCE, Minimum, TraceFit

_AROUND = 4
"""Bins on either side over which the weight of a frequency is spread: noise is much the same beside it."""


def with_colour(fit: TraceFit, found: Minimum) -> Minimum:
    """Widen the confidence by the noise where it counts.

    The parameters are seen at the frequencies of the motion, where rounding, a command between the rows and a motion of its own leave more
    than white noise of the same rms. The level there is that of the residual in these bins, each weighed by what the parameters move in
    it, less the share that the fit took out. It is known from a few dozens of bins only, so Student's t takes the place of the normal.

    Parameters
    ----------
    found
        The fit.
    """
    from scipy.special import stdtrit

    rows = len(fit.times)
    residual = fit.residual(found.values, found.clock)
    slopes = fit.slopes(found.values, found.names, None)
    if not slopes.any():  # at the end of their ranges parameters may move nothing
        return found
    weight = _shares(slopes)
    taken = _shares(np.concatenate([slopes, fit.free(Servo(**found.values)).T], axis=1))
    spread = np.ones(2 * _AROUND + 1) / (2 * _AROUND + 1)
    weight = np.convolve(np.concatenate([weight[-_AROUND:], weight, weight[:_AROUND]]), spread, "valid")
    left = weight * (1.0 - np.minimum(taken, 1.0))
    power = np.abs(np.fft.fft(residual)) ** 2 / rows
    white = float(residual @ residual) / (rows - len(found.names) - 3)
    level = max(float(weight @ power) / (float(left.sum()) * white), 1.0)
    freedom = float(left.sum()) ** 2 / float(left @ left)
    factor = math.sqrt(level) * float(stdtrit(freedom, 0.975)) / CONFIDENCE
    return found.widened(dict.fromkeys(found.names, factor))


def _shares(rows: FloatArray) -> FloatArray:
    """Say how much of each frequency some directions hold, 1 for all of it; shape ``(n,)``, both signs of the frequency."""
    sizes = np.linalg.norm(rows, axis=0)
    basis, values, _ = np.linalg.svd(rows[:, sizes > 0.0] / sizes[sizes > 0.0], full_matrices=False)
    basis = basis[:, values > 1e-9 * values[0]]
    return np.asarray((np.abs(np.fft.fft(basis, axis=0)) ** 2).sum(axis=1) / len(rows))
