"""The standard motion laws on the unit interval, as a table with sources.

A law is a rest-to-rest motion of unit height in unit time: ``s(0) = 0``, ``s(1) = 1``; placing it on a machine is the work of
`camwright.profiles.returns`. Every law is carried as pieces of polynomials. Sinusoids are Taylor polynomials of degree 15 on pieces of at
most an eighth of a period of the sine: the first power left out of the acceleration is below 1e-15 of its amplitude.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np

from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import CamProfile, FloatArray

_TAYLOR_DEGREE = 15
_TAYLOR_ANGLE = math.pi / 4


@dataclass(frozen=True)
class Law:
    """A motion law: its name in the house, what it is, where it is defined, and how it is built."""

    name: str
    title: str
    source: str
    build: Callable[[], CamProfile]


def from_acceleration(widths: list[float], levels: list[float]) -> CamProfile:
    """Integrate a continuous, piecewise linear acceleration from rest and scale the motion to unit height and length.

    Parameters
    ----------
    widths
        Lengths of the ``n`` pieces, in any unit; pieces of zero length are left out.
    levels
        The ``n + 1`` accelerations at the ends of the pieces, in any unit.
    """
    x = s = v = 0.0
    breaks: list[float] = [0.0]
    rows: list[list[float]] = []
    for h, a, b in zip(widths, levels, levels[1:], strict=False):
        if h == 0.0:
            continue
        rows.append([s, v, a / 2, (b - a) / (6 * h)])
        s += h * v + h * h * (2 * a + b) / 6
        v += h * (a + b) / 2
        x += h
        breaks.append(x)
    return CamProfile.from_arrays(breaks, rows).scale(master=1 / x, slave=1 / s).over(0.0, 1.0)


def _sine(frequency: float, phase: float, origin: float) -> FloatArray:
    """Taylor coefficients of ``sin(frequency * x + phase)`` about ``origin``."""
    start = frequency * origin + phase
    powers = np.arange(_TAYLOR_DEGREE + 1)
    factorial = np.array([math.factorial(int(p)) for p in powers], dtype=np.float64)
    derivative = np.array([math.sin(start), math.cos(start), -math.sin(start), -math.cos(start)])[powers % 4]
    return np.asarray(derivative * frequency**powers / factorial)


def _steps(start: float, end: float, frequency: float) -> FloatArray:
    """Give breaks between ``start`` and ``end`` at most `_TAYLOR_ANGLE` of the sine apart."""
    count = max(1, math.ceil((end - start) * abs(frequency) / _TAYLOR_ANGLE - 1e-9))
    return np.linspace(start, end, count + 1)


def _linear() -> CamProfile:
    return CamProfile.from_arrays([0.0, 1.0], [[0.0, 1.0]])


def _parabolic() -> CamProfile:
    return CamProfile.from_arrays([0.0, 0.5, 1.0], [[0.0, 0.0, 2.0], [0.5, 2.0, -2.0]])


def _cubic() -> CamProfile:
    return CamProfile.from_arrays([0.0, 1.0], [[0.0, 0.0, 3.0, -2.0]])


def _poly_3_4_5() -> CamProfile:
    return CamProfile.from_arrays([0.0, 1.0], [[0.0, 0.0, 0.0, 10.0, -15.0, 6.0]])


def _poly_4_5_6_7() -> CamProfile:
    return CamProfile.from_arrays([0.0, 1.0], [[0.0, 0.0, 0.0, 0.0, 35.0, -84.0, 70.0, -20.0]])


def _acceleration_trapezoid() -> CamProfile:
    return from_acceleration([1 / 8, 1 / 4, 1 / 8, 1 / 8, 1 / 4, 1 / 8], [0.0, 1.0, 1.0, 0.0, -1.0, -1.0, 0.0])


def _velocity_trapezoid() -> CamProfile:
    # a third each of constant acceleration, constant velocity and constant deceleration; V = 3/2, A = 9/2
    return CamProfile.from_arrays([0.0, 1 / 3, 2 / 3, 1.0], [[0.0, 0.0, 2.25], [0.25, 1.5, 0.0], [0.75, 1.5, -2.25]])


def _double_s() -> CamProfile:
    # a third each of acceleration, constant velocity and deceleration; a quarter of each ramp is a jerk phase
    r = 1 / 12
    return from_acceleration([r, 2 * r, r, 4 * r, r, 2 * r, r], [0.0, 1.0, 1.0, 0.0, 0.0, -1.0, -1.0, 0.0])


def _cycloid() -> CamProfile:
    # s = x - sin(2 pi x) / (2 pi)
    w = 2 * math.pi
    return _from_acceleration_series([(0.0, 1.0, lambda x: w * _sine(w, 0.0, x))], w)


def _modified_trapezoid() -> CamProfile:
    # acceleration: quarter sine, constant, quarter sine down and on to the other side, mirrored; amplitude c, s'' = c on top
    c = 8 * math.pi / (2 + math.pi)  # Neklutin: 4.888
    w = 4 * math.pi
    pieces: list[tuple[float, float, Callable[[float], FloatArray]]] = [
        (0.0, 1 / 8, lambda x: c * _sine(w, 0.0, x)),
        (1 / 8, 3 / 8, lambda _: np.array([c])),
        (3 / 8, 5 / 8, lambda x: c * _sine(w, -math.pi, x)),
        (5 / 8, 7 / 8, lambda _: np.array([-c])),
        (7 / 8, 1.0, lambda x: c * _sine(w, -2 * math.pi, x)),
    ]
    return _from_acceleration_series(pieces, w)


def _modified_sine() -> CamProfile:
    # acceleration: quarter sine of frequency 4 pi, then a sine three times slower, then the end like the start
    c = 4 * math.pi**2 / (4 + math.pi)  # 5.528
    fast, slow = 4 * math.pi, 4 * math.pi / 3
    pieces: list[tuple[float, float, Callable[[float], FloatArray]]] = [
        (0.0, 1 / 8, lambda x: c * _sine(fast, 0.0, x)),
        (1 / 8, 7 / 8, lambda x: c * _sine(slow, math.pi / 3, x)),
        (7 / 8, 1.0, lambda x: c * _sine(fast, -2 * math.pi, x)),
    ]
    return _from_acceleration_series(pieces, fast)


def _from_acceleration_series(
    pieces: list[tuple[float, float, Callable[[float], FloatArray]]], frequency: float
) -> CamProfile:
    """Integrate Taylor pieces of an acceleration twice, from rest."""
    breaks: list[float] = [0.0]
    rows: list[FloatArray] = []
    s = v = 0.0
    for start, end, series in pieces:
        for left, right in zip(_steps(start, end, frequency), _steps(start, end, frequency)[1:], strict=False):
            a = series(float(left))
            p = np.arange(len(a))
            row = np.concatenate([[s, v], a / ((p + 1) * (p + 2))])
            h = float(right - left)
            s = float(np.polynomial.polynomial.polyval(h, row))
            v = float(np.polynomial.polynomial.polyval(h, row[1:] * np.arange(1, len(row))))
            rows.append(row)
            breaks.append(float(right))
    return CamProfile.from_arrays(breaks, rows)


_VDI = "VDI 2143 part 1 (1980)"
_NORTON = "R. L. Norton, Cam Design and Manufacturing Handbook, 2nd ed., ch. 3"
_BIAGIOTTI = "L. Biagiotti, C. Melchiorri, Trajectory Planning for Automatic Machines and Robots (2008), ch. 3"

LAWS: dict[str, Law] = {
    law.name: law
    for law in (
        Law("linear", "linear (constant velocity)", _BIAGIOTTI, _linear),
        Law("parabolic", "parabolic (constant acceleration, bang-bang)", _VDI, _parabolic),
        Law("cubic", "cubic (polynomial 2-3)", _BIAGIOTTI, _cubic),
        Law("velocity_trapezoid", "trapezoid of velocity, thirds", _BIAGIOTTI, _velocity_trapezoid),
        Law("acceleration_trapezoid", "trapezoid of acceleration, ramps of 1/8", _VDI, _acceleration_trapezoid),
        Law("double_s", "double-S, thirds with jerk phases of 1/12", _BIAGIOTTI, _double_s),
        Law("cycloid", "cycloid (inclined sine)", _VDI, _cycloid),
        Law("modified_trapezoid", "modified trapezoid", _NORTON, _modified_trapezoid),
        Law("modified_sine", "modified sine", _NORTON, _modified_sine),
        Law("poly_3_4_5", "polynomial 3-4-5 (quintic)", _VDI, _poly_3_4_5),
        Law("poly_4_5_6_7", "polynomial 4-5-6-7", _NORTON, _poly_4_5_6_7),
    )
}


@cache
def law(name: str) -> CamProfile:
    """Return a motion law of the table by its name: unit height over the unit interval.

    Raises
    ------
    InputError
        The table holds no such law.

    Examples
    --------
    >>> peak = law("poly_3_4_5").extrema(order=1)[1]
    >>> round(peak.value, 12), round(peak.at, 12)
    (1.875, 0.5)
    """
    if name not in LAWS:
        raise InputError(f"there is no motion law {name!r}; the laws are {', '.join(LAWS)}")
    return LAWS[name].build()
