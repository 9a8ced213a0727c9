"""The discrete servo of S1 as matrices: a sampled position loop around a second-order velocity loop and an integrator."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from camwright.profiles.halving import halved
from camwright.profiles.polynomial.profile import FloatArray


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
    dead_time
        Time from measuring the master until the set value takes effect in the position loop: encoder, cam calculation,
        bus (s).
    lead_time
        Time by which the controller predicts the master ahead (s).
    acceleration_feedforward, jerk_feedforward
        Factors ``beta`` (s²) and ``gamma`` (s³) on the command's acceleration ``a`` and jerk ``j``, which are added to the position that
        the loop regulates to: it asks for ``K (c + beta a + gamma j - p) + alpha v``. With ``beta = 2 zeta / (omega K)`` and
        ``gamma = 1 / (omega² K)`` the velocity loop is made up for, but for sampling. With 0 they are the equations 1 and 2 of S1.

    Examples
    --------
    >>> from camwright import Servo
    >>> Servo(120.0, 0.7, 35.0, 0.004, 1.0, dead_time=0.002, lead_time=0.0005).delay
    0.0015
    """

    bandwidth: float
    damping: float
    position_gain: float
    sample_time: float
    velocity_feedforward: float
    dead_time: float = 0.0
    lead_time: float = 0.0
    acceleration_feedforward: float = 0.0
    jerk_feedforward: float = 0.0

    @property
    def drive(self) -> tuple[float, ...]:
        """Weights of the command's samples, newest first, in the velocity reference (1/s): two, or four with feed-forward beyond velocity.

        Derivatives of the command are backward differences.
        """
        step, gain = self.sample_time, self.position_gain
        lead = self.velocity_feedforward / step
        if not self.acceleration_feedforward and not self.jerk_feedforward:
            return gain + lead, -lead
        second, third = gain * self.acceleration_feedforward / step**2, gain * self.jerk_feedforward / step**3
        return gain + lead + second + third, -lead - 2 * second - 3 * third, second + 3 * third, -third

    @property
    def delay(self) -> float:
        """Time by which the position loop sees the command late (s): at time ``t`` it sees that of ``t - delay``."""
        return self.dead_time - self.lead_time

    @property
    def loop(self) -> Servo:
        """The position loop alone: the same servo without dead time and lead."""
        return replace(self, dead_time=0.0, lead_time=0.0) if self.dead_time or self.lead_time else self

    def at_speed(self, share: float) -> Servo:
        """Give the servo that does at the full line speed what this one does at a share of it.

        A cam is fixed over the master: at ``share`` of the line speed the same motion takes ``1 / share`` of the time. The loop, its clock
        and its delays are as quick as before, so against the motion they are ``1 / share`` times as quick: over the master the axis is that
        of a servo of ``(omega / share, zeta, K / share, share dT, share T_d)`` at the full line speed. Exact, at every sampling phase.

        Parameters
        ----------
        share
            Line speed over the full line speed, above 0.

        Examples
        --------
        >>> slower = Servo(120.0, 0.7, 35.0, 0.004, 1.0, dead_time=0.002, acceleration_feedforward=2e-4).at_speed(0.5)
        >>> slower.bandwidth, slower.position_gain, slower.sample_time, slower.dead_time, slower.acceleration_feedforward
        (240.0, 70.0, 0.002, 0.001, 5e-05)
        """
        return Servo(  # of thousands of servos: `replace` takes three times as long
            self.bandwidth / share,
            self.damping,
            self.position_gain / share,
            self.sample_time * share,
            self.velocity_feedforward,
            self.dead_time * share,
            self.lead_time * share,
            self.acceleration_feedforward * share**2,
            self.jerk_feedforward * share**3,
        )


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


@lru_cache(maxsize=4096)
def sample_plant(servo: Servo, time: float) -> SampledPlant:
    """Discretise the plant exactly for an input held over ``time`` (s), as `plant_rows` has it."""
    rows = np.array(plant_rows(servo, time))
    rows.setflags(write=False)  # kept for whoever asks next
    return SampledPlant(rows[:, :3], rows[:, 3])


def plant_rows(servo: Servo, time: float) -> list[list[float]]:
    """Give the rows of a `SampledPlant`, each of the transition and the input: closed form of the matrix exponential.

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
    f00, f01, f11 = c - sigma * s, -w * w * s, c + sigma * s  # and s
    # position: integral of the velocity; from v'' + 2 sigma v' + w² v = w² u follows
    # w² (p(t) - p(0)) = w² u t - (v'(t) - v'(0)) - 2 sigma (v(t) - v(0))
    p0, p1 = (1.0 - f00 - 2 * sigma * s) / (w * w), (-f01 + 2 * sigma * (1.0 - f11)) / (w * w)
    # rest at v = u: the response to the input is what is missing from the response to that state
    held = time - (-f01 + 2 * sigma * (1.0 - f11)) / (w * w)
    return [[f00, f01, 0.0, -f01], [s, f11, 0.0, 1.0 - f11], [p0, p1, 1.0, held]]


def closed_loop(servo: Servo) -> tuple[FloatArray, FloatArray]:
    """Close the loop at the samples: ``z[k+1] = A z[k] + B (c[k], c[k-1], …)`` with the command's samples ``c`` (m).

    The controller of S1 holds ``u[k] = K (c[k] - p[k]) + alpha (c[k] - c[k-1]) / dT`` over each sampling period; its input
    is the position ``p`` at the sampling instant, its feed-forward the backward difference of the command; `Servo.drive` has the weights.

    Returns
    -------
    (A, B)
        Shapes ``(3, 3)`` and ``(3, 2)``, or ``(3, 4)`` with feed-forward beyond that of the velocity.
    """
    plant = sample_plant(servo, servo.sample_time)
    a = plant.transition.copy()
    a[:, 2] -= plant.input * servo.position_gain
    return a, np.outer(plant.input, servo.drive)


@lru_cache(maxsize=64)  # every check asks for the same few
def spectral_radius(servo: Servo) -> float:
    """Largest magnitude of the closed loop's poles in the z-plane; the servo is stable below 1.

    The poles are found as ``1 + w``, for most of them lie near 1: the characteristic polynomial ``w³ + c2 w² + c1 w + c0`` of
    ``A - I`` is divided by a real root, and the other two poles are those of the quadratic that is left.
    """
    (a, b, c), (d, e, f), (g, h, i) = closed_loop(servo)[0].tolist()
    a, e, i = a - 1.0, e - 1.0, i - 1.0
    c2 = -(a + e + i)
    c1 = a * e - b * d + a * i - c * g + e * i - f * h
    c0 = -(a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g))
    root = _real_root(c2, c1, c0)
    p = c2 + root
    q = c1 + root * p
    inside = 0.25 * p * p - q
    if inside < 0.0:
        other = math.sqrt(max(0.0, 1.0 - p + q))
    else:
        other = max(abs(1.0 - 0.5 * p + math.sqrt(inside)), abs(1.0 - 0.5 * p - math.sqrt(inside)))
    return max(abs(1.0 + root), other)


def _real_root(c2: float, c1: float, c0: float) -> float:
    """Real root of ``z³ + c2 z² + c1 z + c0``, of several the one of greatest magnitude about their mean."""
    p, q = c1 / 3 - c2 * c2 / 9, c2 * (c1 / 3 - 2 * c2 * c2 / 27) / 2 - c0 / 2
    inside = q * q + p**3
    if inside >= 0.0:
        side = math.copysign(math.sqrt(inside), q) + q
        part = math.copysign(abs(side) ** (1 / 3), side)
        root = part - p / part if part else 0.0
    else:
        root = math.copysign(2 * math.sqrt(-p) * math.cos(math.acos(min(1.0, abs(q) / math.sqrt(-(p**3)))) / 3), q)
    root -= c2 / 3
    for _ in range(2):
        slope = (3 * root + 2 * c2) * root + c1
        root -= (((root + c2) * root + c1) * root + c0) / slope if slope else 0.0
    return root


def mean_lag(servo: Servo) -> float:
    """Time by which the axis lags at constant speed (s): ``dead_time + (1 - alpha) / K`` (S1, eq. 2).

    It is the lead time that makes up for it, whatever the servo's own lead time.

    Examples
    --------
    >>> mean_lag(Servo(120.0, 0.7, 35.0, 0.004, velocity_feedforward=1.0, dead_time=0.002))
    0.002
    """
    return servo.dead_time + (1.0 - servo.velocity_feedforward) / servo.position_gain


def gain_margin(servo: Servo) -> float:
    """Factor on the position gain at which the servo becomes unstable; below 1 if it is unstable as it is.

    A gain that is small enough is always stable and one that is great enough never is: the factor is bisected to 1e-9.
    """

    def stable(factor: float) -> bool:
        return spectral_radius(replace(servo, position_gain=factor * servo.position_gain)) < 1.0

    high = 1.0
    while stable(high):
        high *= 2.0
    low = 0.5 * high
    while not stable(low):
        high, low = low, 0.5 * low
    return halved(stable, low, high, 1e-9)[0]
