"""The loop that corrects the cut by print marks: how much of an error to correct when it is known some cuts late, in closed form.

The error of cut ``k`` is known ``n`` cuts later, and a share ``K`` of it is put on the next length: ``e[k+1] = e[k] - K (e[k-n] + w[k-n])``
with the noise ``w`` of the sensor.
"""

from __future__ import annotations

import math

import numpy as np


def greatest_gain(delay: int) -> float:
    """Gain at which the loop begins to swing for ever, ``2 sin(pi / (2 (2 n + 1)))``: it must stay below.

    The characteristic polynomial ``z^(n+1) - z^n + K`` has a pair of roots on the unit circle there.
    """
    return 2.0 * math.sin(math.pi / (2.0 * (2 * delay + 1)))


def gain_without_overshoot(delay: int) -> float:
    """Greatest gain whose answer to a step does not overshoot, ``n^n / (n+1)^(n+1)``: the two real roots meet. 1 without a delay."""
    return (delay / (delay + 1)) ** delay / (delay + 1)


def noise_share(gain: float, delay: int = 0) -> float:
    """Variance of the cut over that of the sensor's noise; ``K / (2 - K)`` without a delay. Infinite where the loop is not stable.

    Parameters
    ----------
    gain
        Share of the error that is corrected.
    delay
        Cuts by which it is known late.
    """
    if not 0.0 < gain < greatest_gain(delay):
        return 0.0 if gain == 0.0 else math.inf
    # the covariance of the last n + 1 errors: P = F P F' + K² b b', solved as a linear system
    size = delay + 1
    step = np.eye(size, k=-1)
    step[0, 0] += 1.0
    step[0, -1] -= gain
    drive = np.zeros((size, size))
    drive[0, 0] = gain**2
    found = np.linalg.solve(np.eye(size**2) - np.kron(step, step), drive.ravel())
    return float(found[0])


def best_gain(stretch: float, noise: float) -> float:
    """Gain of least variance against a random walk of the material and the noise of the sensor, without a delay (Kalman).

    ``K = (-l + sqrt(l² + 4 l)) / 2`` with the variance of the walk, a step a cut, over that of the noise.

    Parameters
    ----------
    stretch, noise
        Standard deviations of a step of the walk and of the sensor, in one unit; not both zero.
    """
    if noise == 0.0:
        return 1.0
    ratio = (stretch / noise) ** 2
    return 0.5 * (-ratio + math.sqrt(ratio * ratio + 4.0 * ratio))
