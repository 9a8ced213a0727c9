"""The smoothest motion from rest to rest: the least mean square of the jerk where one limit binds, or the speed's and one more.

The motion is unique, so it is its own mirror image: half of it decides. Away from the limits the jerk is a parabola over time (Pontryagin:
it is the costate of the acceleration) whose second derivative is the same all along; it is zero where the acceleration is held, and where
the speed is. Other limits that bind together have no form here.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from camwright.profiles.halving import halved

HALVINGS = 60
TOUCHED, HELD = float(Fraction(8, 15)), 0.6
"""Mean speeds over the limit's: above the first the speed touches its limit in the middle, above the second it is held there."""


@dataclass(frozen=True)
class SmoothestMotion:
    """A smoothest motion in unit time, by its pieces.

    Parameters
    ----------
    lengths
        Durations of its pieces.
    accelerations
        Bernstein coefficients of the acceleration, cubic on each piece, neighbours sharing one.
    held
        For each piece, what is held on it: ``"jerk"``, ``"acceleration"``, ``"speed"`` or nothing.
    top
        Greatest speed, acceleration and jerk.
    mean_square
        Mean square of the jerk.
    """

    lengths: tuple[float, ...]
    accelerations: tuple[float, ...]
    held: tuple[str, ...]
    top: tuple[float, float, float]
    mean_square: float


def smoothest(distance: float, speed: float, acceleration: float, jerk: float) -> SmoothestMotion | None:
    """Return the motion over a distance in unit time; None where it reaches none of the limits, or more than one kind.

    - speed ``V`` held over ``1 - 2 r``: ``v = V s² (6 - 8 s + 3 s²)`` with ``s = t / r`` and ``r = 5/4 (1 - D/V)``;
    - speed touched in the middle: ``v = α s² + β s³ + γ s⁴`` with ``s = 2 t``, ``α = 30 D - 12 V``;
    - acceleration ``A`` held: the last parabola, from ``d`` before the middle, has ``c = 3 A / d³``, the first lasts ``r`` with
      ``r²/4 - r³/3 = d³/3``, and ``d`` is such that the way is right;
    - jerk ``J`` held at both ends: the parabola between them lasts ``2 d``, with ``d² = 5/12 - 10 D/J``;
    - jerk held for ``r``, then a parabola for ``x`` to the speed that is held: ``V/J = r²/2 + r x/2 + x²/12``, and ``x`` such that the
      way is right;
    - acceleration held, then a parabola for ``e`` to the speed that is held: the first lasts ``y e``, the hold ``(g - 1/2) e`` with
      ``g = (1/6 - y³/3) / y²``, ``V/A = e (y - y⁴/2 + g (1 - 2 y³))``, and ``y`` such that the way is right.
    """
    for found in (
        _speed_bound(distance, speed),
        _acceleration_bound(distance, acceleration),
        _jerk_bound(distance, jerk),
        _jerk_and_speed_bound(distance, speed, jerk),
        _acceleration_and_speed_bound(distance, speed, acceleration),
    ):
        if found is not None and all(
            value <= limit * (1 + 1e-12) for value, limit in zip(found.top, (speed, acceleration, jerk), strict=True)
        ):
            return found
    return None


def _speed_bound(distance: float, speed: float) -> SmoothestMotion | None:
    share = distance / speed
    if not TOUCHED < share < 1.0:
        return None
    if share >= HELD:
        r = 1.25 * (1.0 - share)
        peak = 4.0 * speed / r
        return SmoothestMotion(
            (r, 1.0 - 2.0 * r, r),
            (0.0, peak, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -peak, 0.0),
            ("", "speed", ""),
            (speed, 4.0 / 9.0 * peak, 12.0 * speed / r**2),
            2.0 * 19.2 * speed**2 / r**3,
        )
    alpha = 30.0 * distance - 12.0 * speed
    beta, gamma = 4.0 * speed - 2.0 * alpha, alpha - 3.0 * speed
    first, second = 4.0 / 3.0 * alpha, 8.0 / 3.0 * alpha + 2.0 * beta
    # where the jerk, 4 (2 α + 6 β s + 12 γ s²), is zero the acceleration is greatest; one of its zeros is within the half
    root = (36.0 * beta**2 - 96.0 * alpha * gamma) ** 0.5
    s = next(s for s in ((-6.0 * beta + root) / (24.0 * gamma), (-6.0 * beta - root) / (24.0 * gamma)) if 0.0 < s < 1.0)
    ends = (8.0 * alpha, 4.0 * (2.0 * alpha + 6.0 * beta + 12.0 * gamma))
    square = 4 * alpha**2 + 12 * alpha * beta + 12 * beta**2 + 16 * alpha * gamma + 36 * beta * gamma + 28.8 * gamma**2
    return SmoothestMotion(
        (0.5, 0.5),
        (0.0, first, second, 0.0, -second, -first, 0.0),
        ("", ""),
        (speed, 2.0 * s * (2.0 * alpha + s * (3.0 * beta + 4.0 * gamma * s)), max(abs(end) for end in ends)),
        16.0 * square,
    )


def _acceleration_bound(distance: float, acceleration: float) -> SmoothestMotion | None:
    """Hold the acceleration; None where its limit is not reached, or leaves no motion."""

    def enough(d: float) -> bool:
        r = _first(d)
        return r + d < 0.5 and 2.0 * _half_way(r, d, acceleration) > distance

    d = halved(enough, 0.0, 0.5, most=HALVINGS)[0]
    r = _first(d)
    hold = 0.5 - d - r
    if d <= 0.0 or hold <= 0.0 or abs(2.0 * _half_way(r, d, acceleration) - distance) > 1e-9 * distance:
        return None
    c = 3.0 * acceleration / d**3
    m = c * (0.5 - r)
    rise = acceleration * r - c * r**4 / 24 - m * r**3 / 6
    square = c**2 * r**5 / 20 + c * m * r**4 / 4 + m**2 * r**3 / 3 + 2.0 / 15.0 * c**2 * d**5
    a, first = acceleration, acceleration - m * r**2 / 6
    held = (a,) * 4
    return SmoothestMotion(
        (r, hold, 2.0 * d, hold, r),
        (0.0, first, a, *held, a, -a, *(-each for each in held), -a, -first, 0.0),
        ("", "acceleration", "", "acceleration", ""),
        (rise + a * hold + 5.0 / 24.0 * c * d**4, a, max(c * r**2 / 2 + m * r, c * d**2 / 2)),
        2.0 * square,
    )


def _jerk_bound(distance: float, jerk: float) -> SmoothestMotion | None:
    square = 5.0 / 12.0 - 10.0 * distance / jerk
    if not 0.0 < square < 0.25:
        return None
    d = square**0.5
    r, c = 0.5 - d, 1.5 * jerk / d**3
    a, inner = jerk * r, jerk * r + 2.0 / 3.0 * jerk * d
    x = max(d**2 - 4.0 / 3.0 * d**3, 0.0) ** 0.5  # from the middle to where the acceleration is greatest
    return SmoothestMotion(
        (r, 2.0 * d, r),
        (0.0, a / 3, 2 * a / 3, a, inner, -inner, -a, -2 * a / 3, -a / 3, 0.0),
        ("jerk", "", "jerk"),
        (
            jerk / 8 - 3.0 / 16.0 * jerk * d,
            c / 2 * (d**2 * x - x**3 / 3) - jerk * x,
            max(jerk, abs(jerk - c * d**2 / 2)),
        ),
        2.0 * jerk**2 * (0.3 / d - 0.5),
    )


def _jerk_and_speed_bound(distance: float, speed: float, jerk: float) -> SmoothestMotion | None:
    ratio = speed / jerk

    def ramp(x: float) -> float:
        return float((x**2 / 12 + 2.0 * ratio) ** 0.5) - x / 2

    def way(x: float) -> float:
        r = ramp(x)
        return jerk * (r**3 / 6 + r**2 * x / 2 + 0.35 * r * x**2 + x**3 / 20) + speed * (0.5 - r - x)

    longest = min((12.0 * ratio) ** 0.5, 0.5)
    x = halved(lambda x: ramp(x) + x < 0.5 and 2.0 * way(x) > distance, 0.0, longest, most=HALVINGS)[0]
    r = ramp(x)
    cruise = 1.0 - 2.0 * (r + x)
    if min(x, r, cruise) <= 0.0 or abs(2.0 * way(x) - distance) > 1e-9 * distance:
        return None
    bend = jerk * (3.0 + 6.0 * r / x)
    a, s = jerk * r, jerk / bend
    inner = a + x * jerk / 3
    peak = a + x * (jerk * (s - s**2 / 2) - bend * (s**2 / 2 - s**3 / 3))
    return SmoothestMotion(
        (r, x, cruise, x, r),
        (0.0, a / 3, 2 * a / 3, a, inner, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -inner, -a, -2 * a / 3, -a / 3, 0.0),
        ("jerk", "", "speed", "", "jerk"),
        (speed, peak, max(jerk, (bend - jerk) ** 2 / (4.0 * bend))),
        2.0 * (jerk**2 * r + x * (jerk**2 / 3 - jerk * bend / 6 + bend**2 / 30)),
    )


def _acceleration_and_speed_bound(distance: float, speed: float, acceleration: float) -> SmoothestMotion | None:
    def parts(y: float) -> tuple[float, float, float, float]:
        """Lengths of the last parabola and of the hold, speed at the end of the first parabola, and the way."""
        g = (1.0 / 6.0 - y**3 / 3.0) / y**2
        e = speed / acceleration / (y - y**4 / 2 + g * (1.0 - 2.0 * y**3))
        hold, first = e * (g - 0.5), acceleration * e * (y - y**4 / 2 - 2.0 * g * y**3)
        way = acceleration * e**2 * (y**2 / 2 - 0.4 * y**5 - 1.5 * g * y**4)
        way += first * hold + acceleration * hold**2 / 2
        way += (first + acceleration * hold) * e + 0.35 * acceleration * e**2
        return e, hold, first, 2.0 * (way + speed * (0.5 - e * (y + 1.0) - hold))

    y = halved(lambda y: parts(y)[3] > distance, 1e-3, 0.5, most=HALVINGS)[0]
    e, hold, _, way = parts(y)
    r = y * e
    cruise = 1.0 - 2.0 * (r + hold + e)
    if min(hold, cruise) <= 0.0 or abs(way - distance) > 1e-9 * distance:
        return None
    a, c = acceleration, 12.0 * acceleration / e**3
    m = c * (hold + e / 2)
    first, held = a - m * r**2 / 6, (a,) * 3
    up = (0.0, first, a, a, *held, a, 0.0, 0.0)
    square = c**2 * r**5 / 20 + c * m * r**4 / 4 + m**2 * r**3 / 3 + c**2 * e**5 / 120
    return SmoothestMotion(
        (r, hold, e, cruise, e, hold, r),
        (*up, 0.0, 0.0, *(-each for each in reversed(up))),
        ("", "acceleration", "", "speed", "", "acceleration", ""),
        (speed, a, max(c * r**2 / 2 + m * r, c * e**2 / 8)),
        2.0 * square,
    )


def _first(d: float) -> float:
    """Duration of the first parabola for that of half the last: ``r²/4 - r³/3 = d³/3``, by Newton's method from above."""
    r = 0.5
    for _ in range(HALVINGS):
        slope = r / 2 - r**2
        step = (r**2 / 4 - r**3 / 3 - d**3 / 3) / slope if slope > 0 else 0.25
        r = min(max(r - step, 1e-12), 0.5)
        if abs(step) < 1e-16:
            break
    return r


def _half_way(r: float, d: float, acceleration: float) -> float:
    """Way of half the motion."""
    c = 3.0 * acceleration / d**3
    m = c * (0.5 - r)
    hold = 0.5 - d - r
    rise = acceleration * r - c * r**4 / 24 - m * r**3 / 6
    way = acceleration * r**2 / 2 - c * r**5 / 30 - m * r**4 / 8
    way += rise * hold + acceleration * hold**2 / 2
    return way + (rise + acceleration * hold) * d + 2.0 / 15.0 * c * d**5
