"""What each sample of the command contributes to the axis: the closed servo loop written out as a sum.

The servo is linear and, but for its sampling, the same at all times. A time ``s`` after a sampling instant the axis is therefore a fixed
sum over the command's samples of the past::

    axis(k dT + s) = sum_i weights[i] c[k - i]

which stays linear when the command's samples are themselves linear in unknowns.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from camwright.profiles.errors import InputError
from camwright.profiles.message import Message
from camwright.profiles.polynomial.profile import FloatArray
from camwright.profiles.servo import (
    Servo,
    closed_loop,
    gain_margin,
    sample_plant,
    spectral_radius,
)

# The past that is left out moves the axis by less than this part of the command's travel.
FORGOTTEN = 1e-14
# Most samples of the past that a servo may need: a slower one has no use as an axis in sync, and its rows would fill the memory.
MOST_SAMPLES = 20_000


@lru_cache(maxsize=1024)
def memory(servo: Servo) -> int:
    """Count the samples of the past that still move the axis.

    Raises
    ------
    InputError
        The servo is unstable, or forgets too slowly.
    """
    radius = spectral_radius(servo)
    if not radius < 1.0:
        raise InputError(
            Message(
                f"{{@position_gain}} = {servo.position_gain:g} 1/s: the servo is unstable, its largest pole in the z-plane has the "
                f"magnitude {radius:.6g} and the limit is 1; it is stable below {servo.position_gain * gain_margin(servo):.6g} 1/s"
            )
        )
    count = max(4, math.ceil(math.log(FORGOTTEN) / math.log(max(radius, 1e-3))))
    if count > MOST_SAMPLES:
        raise InputError(
            Message(
                f"{{@position_gain}} = {servo.position_gain:g} 1/s: the servo remembers {count} samples of {servo.sample_time:g} s, the "
                f"limit for a servo-aware design is {MOST_SAMPLES}; raise the position gain or the sample time"
            )
        )
    return count


@lru_cache(maxsize=4096)
def servo_weights(servo: Servo, time: float) -> FloatArray:
    """Weights of the command's samples, newest first, a time ``0 <= time <= dT`` (s) after a sampling instant, shape ``(3, samples)``.

    For the axis' position (1), velocity (1/s) and acceleration (1/s²). Dead time and lead are the caller's.
    """
    past = _past_states(servo.loop, memory(servo.loop))
    part = sample_plant(servo.loop, time)
    after = part.transition.copy()
    after[:, 2] -= servo.position_gain * part.input
    rows = past @ after.T
    for number, weight in enumerate(servo.drive):
        rows[number] += weight * part.input
    return np.ascontiguousarray(rows.T[::-1])


@lru_cache(maxsize=512)
def state_weights(servo: Servo, count: int) -> FloatArray:
    """Weights of the command's samples, newest first, for the plant's state at a sampling instant and the reference held from there.

    Parameters
    ----------
    servo
        The servo; dead time and lead are the caller's.
    count
        Samples of the past.

    Returns
    -------
    ndarray
        Shape ``(count + 1, 4)``: the state as in `camwright.profiles.servo.SampledPlant`, and the velocity reference.
    """
    states, drive = _past_states(servo, count), servo.drive
    reference = -servo.position_gain * states[:, 2]
    reference[: len(drive)] += drive
    found: FloatArray = np.column_stack([states, reference])
    found.setflags(write=False)
    return found


@lru_cache(maxsize=256)
def greatest_gains(servo: Servo, order: int, substeps: int) -> tuple[float, float]:
    """Bound what the servo makes of the command's velocity (order 1) or acceleration (2).

    With the command's between ``low`` and ``high`` the axis' stays between ``up low - down high`` and ``up high - down low``: summed by
    parts, once or twice, the axis' derivative is a weighted sum of the command's mean velocities between samples, or of its second
    differences, which lie within the command's own range. ``up`` and ``down`` are the sums of the positive and the negative weights.

    Parameters
    ----------
    servo
        The servo; dead time and lead only shift its response.
    order
        1 or 2.
    substeps
        Equally spaced times after a sampling instant for which the bounds hold.

    Returns
    -------
    (up, down)
        The greatest over these times.
    """
    up = down = 0.0
    for time in np.arange(substeps) * (servo.sample_time / substeps):
        sums = np.cumsum(servo_weights(servo, float(time))[order])
        sums = sums if order == 1 else np.cumsum(sums)
        sums *= servo.sample_time**order
        up = max(up, float(sums[sums > 0.0].sum()))
        down = max(down, -float(sums[sums < 0.0].sum()))
    return up, down


@lru_cache(maxsize=256)
def _past_states(servo: Servo, count: int) -> FloatArray:
    """State at a sampling instant by the samples: ``z[k] = sum_i past[i] c[k - i]``, shape ``(count + 1, 3)``."""
    transition, inputs = closed_loop(servo)
    powers, power, done = inputs, transition, 1  # columns A^j B, twice as many in each round
    while done < count:
        powers = np.concatenate([powers, power @ powers], axis=1)
        power = power @ power
        done *= 2
    each = powers.reshape(3, -1, inputs.shape[1])[:, :count]
    past = np.zeros((count + 1, 3))
    for number in range(inputs.shape[1]):
        past[1 + number :] += each[:, : count - number, number].T
    return past
