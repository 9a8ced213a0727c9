"""The discrete servo of S1 as matrices: a sampled position loop around a second-order velocity loop and an integrator."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from profiles.polynomial import FloatArray


@dataclass(frozen=True)
class Servo:
    """Parameters of the discrete servo (S1).

    Parameters
    ----------
    bandwidth
        Natural frequency of the velocity loop ``omega`` (rad/s).
    damping
        Damping ratio of the velocity loop ``zeta``.
    position_gain
        Gain of the position loop ``K`` (1/s).
    sample_time
        Sampling period ``dT`` (s).
    velocity_feedforward
        Share ``alpha`` of the command's velocity that is fed forward; 1 cancels the following error at constant speed.
    """

    bandwidth: float
    damping: float
    position_gain: float
    sample_time: float
    velocity_feedforward: float


PAPER_RANGES: dict[str, tuple[float, float]] = {
    "bandwidth": (80.0, 150.0),
    "damping": (0.7, 0.9),
    "position_gain": (10.0, 50.0),
    "sample_time": (1e-3, 8e-3),
}
"""Ranges of the servo's parameters in S1, by name in `Servo`, in SI units."""


@dataclass(frozen=True, eq=False)
class SampledPlant:
    """Velocity loop and integrator, held over a time: ``z(t + h) = transition @ z(t) + input * u``.

    The state ``z`` is (velocity's derivative (m/s²), velocity (m/s), position (m)); the input ``u`` is the velocity reference
    (m/s), constant over the time.
    """

    transition: FloatArray
    input: FloatArray


def plant_matrices(servo: Servo) -> tuple[FloatArray, FloatArray]:
    """Continuous plant ``z' = A z + b u``: ``omega² / (s² + 2 zeta omega s + omega²)`` and an integrator (S1).

    Returns
    -------
    (A, b)
        Shapes ``(3, 3)`` and ``(3,)``; state as in `SampledPlant`.
    """
    w, z = servo.bandwidth, servo.damping
    a = np.array([[-2 * z * w, -w * w, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    return a, np.array([w * w, 0.0, 0.0])


def sample_plant(servo: Servo, time: float) -> SampledPlant:
    """Discretise the plant exactly for an input held over ``time`` (s): closed form of the matrix exponential.

    The velocity loop has the poles ``-zeta omega ± omega sqrt(zeta² - 1)``: a damped oscillation, a double pole or two real
    poles, told apart by the sign of ``zeta² - 1``; one formula with ``sinc``-like functions covers all three.
    """
    w, z = servo.bandwidth, servo.damping
    sigma = z * w
    discriminant = (z * z - 1.0) * w * w  # square of half the distance between the poles
    # c = exp(-sigma t) cosh(d t), s = exp(-sigma t) sinh(d t) / d with d = sqrt(discriminant), real whatever its sign
    e = math.exp(-sigma * time)
    angle = math.sqrt(abs(discriminant)) * time
    if angle < 1e-4:  # series about the double pole; the next term is below 1e-16
        q = discriminant * time * time
        c, s = e * (1.0 + q / 2 + q * q / 24), e * time * (1.0 + q / 6 + q * q / 120)
    elif discriminant < 0:
        c, s = e * math.cos(angle), e * math.sin(angle) / math.sqrt(-discriminant)
    else:
        slow, fast = math.exp(angle - sigma * time), math.exp(-angle - sigma * time)
        c, s = 0.5 * (slow + fast), 0.5 * (slow - fast) / math.sqrt(discriminant)
    # velocity loop in (v', v): exp(M t) = (c + sigma s) I + s M, M = [[-2 sigma, -w²], [1, 0]]
    f = np.array([[c - sigma * s, -w * w * s], [s, c + sigma * s]])
    # position: integral of the velocity; from v'' + 2 sigma v' + w² v = w² u follows
    # w² (p(t) - p(0)) = w² u t - (v'(t) - v'(0)) - 2 sigma (v(t) - v(0))
    transition = np.zeros((3, 3))
    transition[:2, :2] = f
    transition[2, 0] = (1.0 - f[0, 0] - 2 * sigma * f[1, 0]) / (w * w)
    transition[2, 1] = (-f[0, 1] + 2 * sigma * (1.0 - f[1, 1])) / (w * w)
    transition[2, 2] = 1.0
    # rest at v = u: the response to the input is what is missing from the response to that state
    held = np.array([-f[0, 1], 1.0 - f[1, 1], 0.0])
    held[2] = time - (held[0] + 2 * sigma * held[1]) / (w * w)
    return SampledPlant(transition, held)


def closed_loop(servo: Servo) -> tuple[FloatArray, FloatArray]:
    """Close the loop at the samples: ``z[k+1] = A z[k] + B (c[k], c[k-1])`` with the command's samples ``c`` (m).

    The controller of S1 holds ``u[k] = K (c[k] - p[k]) + alpha (c[k] - c[k-1]) / dT`` over each sampling period; its input
    is the position ``p`` at the sampling instant, its feed-forward the backward difference of the command.

    Returns
    -------
    (A, B)
        Shapes ``(3, 3)`` and ``(3, 2)``.
    """
    plant = sample_plant(servo, servo.sample_time)
    gain, lead = servo.position_gain, servo.velocity_feedforward / servo.sample_time
    a = plant.transition.copy()
    a[:, 2] -= plant.input * gain
    return a, np.outer(plant.input, [gain + lead, -lead])


def spectral_radius(servo: Servo) -> float:
    """Largest magnitude of the closed loop's poles in the z-plane; the servo is stable below 1."""
    return float(np.abs(np.linalg.eigvals(closed_loop(servo)[0])).max())
