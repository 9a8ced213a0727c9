"""The sampled servo at any times: what it makes of a command that is known as a curve, from an unknown beginning."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from camwright.profiles.polynomial.profile import FloatArray
from camwright.profiles.servo import Servo, closed_loop, sample_plant

ComplexArray = NDArray[np.complex128]

# Powers of the loop below this are not followed any further.
_FORGOTTEN = 1e-20


def axis_response(
    servo: Servo, clock: float, command: Callable[[FloatArray], FloatArray], times: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Position of the axis at given times, and what an unknown beginning can add to it.

    Exact at any time: the samples by the closed loop's recursion, between them the plant under its held input. At the last sample before
    the first time the axis stands on its command; every other state there adds a combination of the rows returned.

    Parameters
    ----------
    servo
        The servo, dead time and lead included.
    clock
        Time of one of its samples (s).
    command
        The command over time (m or rad).
    times
        Ascending times (s), shape ``(n,)``.

    Returns
    -------
    (position, free)
        Shapes ``(n,)`` and ``(3, n)``.
    """
    step, gain = servo.sample_time, servo.position_gain
    first, last = (math.floor((float(time) - clock) / step) for time in (times[0], times[-1]))
    before = len(servo.drive) - 1
    seen = command(clock - servo.delay + step * np.arange(first - before, last + 1, dtype=np.float64))
    base = float(seen[before])
    drive = np.convolve(seen - base, servo.drive, "valid")

    # states from rest, x[k + 1] = A x[k] + b d[k]: what d does at once, then what is twice as many samples old each time
    loop, held = closed_loop(servo)[0], sample_plant(servo, step).input
    state = np.zeros((3, len(drive)))
    state[:, 1:] = held[:, None] * drive[:-1]
    power, age = loop, 1
    while age < len(drive) and np.abs(power).max() > _FORGOTTEN:
        state[:, age:] += power @ state[:, :-age]
        power, age = power @ power, 2 * age
    # a state that can be reached is a combination of b, A b and A² b: three shifts of one decay
    decay, power = held[:, None], loop
    while decay.shape[1] < len(drive) + 2:
        decay, power = np.concatenate([decay, power @ decay], axis=1), power @ power

    place = (times - clock) / step
    whole: FloatArray = np.floor(place)
    sample = whole.astype(np.intp) - first
    slope, velocity, reference = _position_rows(servo, (place - whole) * step)
    held_still = 1.0 - gain * reference  # the reference is f - K p
    position = base + slope * state[0][sample] + velocity * state[1][sample] + held_still * state[2][sample]
    position += reference * drive[sample]
    free = np.empty((3, len(times)))
    for shift in range(3):
        later = decay[:, sample + shift]
        free[shift] = slope * later[0] + velocity * later[1] + held_still * later[2]
    return position, free


def _position_rows(servo: Servo, times: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Position of the plant after some times, by the velocity's derivative, the velocity and the held reference at their beginning.

    The last row of `camwright.profiles.servo.sample_plant`, for many times.
    """
    w = servo.bandwidth
    sigma = servo.damping * w
    root = np.emath.sqrt((servo.damping**2 - 1.0) * w * w).item()
    decay = np.exp(-sigma * times)
    c = decay * np.cosh(root * times).real
    s = decay * (np.sinh(root * times) / root).real if root else decay * times
    velocity = (w * w * s + 2 * sigma * (1.0 - c - sigma * s)) / (w * w)
    return (1.0 - c - sigma * s) / (w * w), velocity, times - velocity


def mean_response(servo: Servo, rates: FloatArray) -> ComplexArray:
    """Frequency response of the axis to its command, mean over all phases of the sampling clock.

    For a command ``exp(j w t)`` the samples of the reference are those of the closed loop at ``z = exp(j w dT)``; of what the hold makes
    of them, only the part at ``w`` is the same for all phases.

    Parameters
    ----------
    rates
        Angular frequencies (rad/s), the first of them 0.
    """
    return ripple_response(servo, rates, 0)


def ripple_response(servo: Servo, rates: FloatArray, harmonic: int) -> ComplexArray:
    """Frequency response of the axis about a harmonic of the sampling rate.

    The hold makes of ``exp(s t)`` parts at ``s_h = s + j h 2 pi / dT``, all integers ``h``: the axis is the sum of
    ``response * exp(s t) * exp(j h 2 pi (t - clock) / dT)`` over these.

    Parameters
    ----------
    rates
        Angular frequencies (rad/s), of either sign, the first of them 0.
    harmonic
        The harmonic ``h``; 0 for the part that does not depend on the clock.
    """
    step, gain, w = servo.sample_time, servo.position_gain, servo.bandwidth
    plant = sample_plant(servo, step)
    (a, b, _), (c, d, _), (e, f, _) = plant.transition.tolist()
    p, q, r = plant.input.tolist()
    s = 1j * rates[1:]
    z = np.exp(s * step)
    # position of the sampled plant: (z - 1) x3 = e x1 + f x2 + r u with the velocity loop's (z - M) (x1, x2) = (p, q) u
    loop = (z - a) * (z - d) - b * c
    sampled = (e * ((z - d) * p + b * q) + f * ((z - a) * q + c * p)) / loop + r
    drive = sum(weight * z**-number for number, weight in enumerate(servo.drive))
    reference = drive * (z - 1.0) / (z - 1.0 + gain * sampled)
    beside = s + 2j * np.pi * harmonic / step
    hold = (1.0 - 1.0 / z) / (beside * step)
    found = np.full(
        len(rates), 1.0 if harmonic == 0 else 0.0, dtype=np.complex128
    )  # at rest the axis stands on its command
    found[1:] = (
        np.exp(-s * servo.delay)
        * reference
        * hold
        * (w * w / (beside * (beside * beside + 2 * servo.damping * w * beside + w * w)))
    )
    return found


def decays(servo: Servo, times: FloatArray) -> FloatArray:
    """How the closed loop forgets its beginning at the first of some times: a row for each pole, shape ``(3, n)``."""
    poles = np.linalg.eigvals(closed_loop(servo)[0]).astype(np.complex128)
    poles = poles[np.argsort(poles.imag)]
    samples = (times - times[0]) / servo.sample_time
    sizes, angles = np.log(np.maximum(np.abs(poles), 1e-300)), np.angle(poles)
    found: FloatArray = np.exp(sizes[:, None] * samples)
    if poles[2].imag > 0.0:  # a pair: both have the same size, and share its sine and its cosine
        found[0] *= np.sin(angles[2] * samples)
        found[2] *= np.cos(angles[2] * samples)
    return found
