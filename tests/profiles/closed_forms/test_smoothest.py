"""The smoothest motions in closed form: integrated, against quadratic programmes on a grid, and against the quintic."""

from __future__ import annotations

import cvxpy as cp
import numpy as np
import pytest

from camwright.profiles.closed_forms.smoothest import SmoothestMotion, smoothest

FAR = 1e9
CASES = [
    (1.5, FAR, FAR),
    (1.2, FAR, FAR),
    (1.8, FAR, FAR),
    (FAR, 5.0, FAR),
    (FAR, 4.3, FAR),
    (FAR, FAR, 50.0),
    (FAR, FAR, 42.0),
    (1.5, FAR, 80.0),
    (1.3, FAR, 130.0),
    (1.6, 5.5, FAR),
    (1.55, 5.6, FAR),
]


def _integrated(motion: SmoothestMotion) -> tuple[float, float, float, tuple[float, float, float]]:
    """Way, last speed, mean square of the jerk and greatest values of a motion, by sums over fine steps."""
    coefficients, way, speed, square, top = np.array(motion.accelerations), 0.0, 0.0, 0.0, np.zeros(3)
    for k, length in enumerate(motion.lengths):
        b, s = coefficients[3 * k : 3 * k + 4], np.linspace(0.0, 1.0, 4001)
        a = b[0] * (1 - s) ** 3 + 3 * b[1] * s * (1 - s) ** 2 + 3 * b[2] * s**2 * (1 - s) + b[3] * s**3
        steps = 3 * np.diff(b)
        jerk = (steps[0] * (1 - s) ** 2 + 2 * steps[1] * s * (1 - s) + steps[2] * s**2) / length
        v = speed + np.concatenate([[0.0], np.cumsum(a[1:] + a[:-1])]) * length / 8000
        way, speed = way + float(np.trapezoid(v, dx=length / 4000)), float(v[-1])
        square += float(np.trapezoid(jerk**2, dx=length / 4000))
        top = np.maximum(top, [np.abs(each).max() for each in (v, a, jerk)])
    return way, speed, square, tuple(top)


@pytest.mark.parametrize("limits", CASES)
def test_it_covers_its_way_within_its_limits(limits: tuple[float, float, float]) -> None:
    motion = smoothest(1.0, *limits)
    assert motion is not None
    way, speed, square, top = _integrated(motion)
    assert sum(motion.lengths) == pytest.approx(1.0, abs=1e-12)
    assert (way, speed) == (pytest.approx(1.0, abs=1e-6), pytest.approx(0.0, abs=1e-12))
    assert square == pytest.approx(motion.mean_square, rel=1e-6)
    assert top == pytest.approx(motion.top, rel=1e-6)
    assert square > 720.0  # the quintic's


@pytest.mark.parametrize("limits", CASES)
def test_a_quadratic_programme_on_a_grid_finds_nothing_better(limits: tuple[float, float, float]) -> None:
    motion, count = smoothest(1.0, *limits), 160
    assert motion is not None
    h, jerk = 1.0 / count, cp.Variable(count)
    summed = np.tril(np.ones((count, count)))
    a = h * summed @ jerk
    before = cp.hstack([0.0, a[:-1]])
    v = summed @ (h * before + h**2 / 2 * jerk)
    way = cp.sum(h * cp.hstack([0.0, v[:-1]]) + h**2 / 2 * before + h**3 / 6 * jerk)
    kept = [limit * (1 - 1e-3) >= cp.abs(each) for each, limit in zip((v, a, jerk), limits, strict=True) if limit < FAR]
    least = cp.Problem(cp.Minimize(cp.sum_squares(jerk) * h), [way == 1.0, a[-1] == 0.0, v[-1] == 0.0, *kept]).solve(
        solver="CLARABEL"
    )
    assert motion.mean_square <= float(least)
    assert motion.mean_square == pytest.approx(float(least), rel=2e-2)


def test_where_no_limit_is_reached_or_two_are_it_says_nothing() -> None:
    assert smoothest(1.0, 1.9, 5.8, 61.0) is None
    assert smoothest(1.0, 1.5, 5.2, 60.0) is None
    assert smoothest(1.0, 0.99, FAR, FAR) is None
