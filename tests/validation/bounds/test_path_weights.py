"""Weights of the squared torque's value function: they keep their inequality, and come near what a cone programme says is the best."""

from __future__ import annotations

import math
from dataclasses import replace

import clarabel
import numpy as np
import pytest
from scipy.sparse import csc_array

from camwright.profiles.polynomial.profile import FloatArray
from camwright.validation.bounds import path_weights
from camwright.validation.bounds.path_dual import square_tube, standing_square
from camwright.validation.bounds.path_spline import PathSpline
from camwright.validation.bounds.path_task import PathTask
from camwright.validation.bounds.path_weights import ENOUGH, MOST, square_weights

EVEN = PathTask(np.full(501, 2.0), 6.0, (3.0, 3.0), 2.4, 100.0)
COST = 4.0 * 12 * (6.0 - 7.2) ** 2 / 2.4**3
"""Least integral of its squared torque."""
BENT = PathTask(2.0 + np.sin(np.linspace(0.0, 5.0, 501)), 6.0, (3.0, 2.0), 3.0, 100.0, friction=0.3)
LEVEL = 14.0
"""Of a tube about it without standstill."""
ASKED = (30, 12)


def kept(spline: PathSpline, weights: FloatArray, x: FloatArray, energy: FloatArray) -> FloatArray:
    """By how much the inequality is kept at places, by the rows of a programme instead of a column's factors."""
    columns, linear, slope = spline.rows(x.ravel(), energy.ravel())
    by_linear, by_slope = ((rows * weights[columns]).sum(axis=1) for rows in (linear, slope))
    return np.asarray(by_linear - 0.25 * by_slope**2 * np.sqrt(energy.ravel()))


def greatest(spline: PathSpline, x: FloatArray, energy: FloatArray, level: float) -> float:
    """Greatest value of all weights that keep the inequality at places, by Clarabel, as a share of the level."""
    count, size, per_place = x.size, spline.size, level / spline.whole
    unit = np.full(size, level)
    unit[-1] = level / -spline.ends()[-1]
    columns, linear, slope = spline.rows(x.ravel(), energy.ravel())
    cones = np.zeros((count, 3, size))
    for row in range(count):
        np.add.at(cones[row, 0], columns[row], -0.5 * linear[row] / per_place)
        np.add.at(cones[row, 2], columns[row], -0.5 * slope[row] / per_place * math.sqrt(per_place))
        cones[row, 2] *= energy.ravel()[row] ** 0.25
    cones[:, 1] = cones[:, 0]
    matrix, goal = csc_array(cones.reshape(3 * count, size) * unit), -spline.ends() * unit / level
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    kind, right = [clarabel.SecondOrderConeT(3)] * count, np.tile([0.5, -0.5, 0.0], count)
    answer = clarabel.DefaultSolver(csc_array((size, size)), goal, matrix, right, kind, settings).solve()
    return -float(answer.obj_val)


@pytest.mark.parametrize(
    ("task", "level"),
    [(EVEN, 1.02 * COST), (BENT, LEVEL), (replace(BENT, time=2.6), LEVEL)],
    ids=["even", "bent", "quick"],
)
def test_they_keep_the_inequality_and_are_all_but_the_best(task: PathTask, level: float) -> None:
    spline = PathSpline(task, square_tube(task, level))
    x, energy = spline.places(*ASKED)
    weights = square_weights(spline, x[0], energy, level)
    assert kept(spline, weights, x, energy).min() > 0.0
    share, best = float(spline.ends() @ weights) / level, greatest(spline, x, energy, level)
    assert 0.0 < best < MOST
    assert best - 3 * ENOUGH < share <= best + 1e-6


def test_where_a_motion_may_stand_the_price_of_time_is_positive() -> None:
    slow = replace(EVEN, time=7.0)
    level = 1.05 * standing_square(slow)
    spline = PathSpline(slow, square_tube(slow, level))
    assert spline.stands
    x, energy = spline.places(*ASKED)
    weights = square_weights(spline, x[0], energy, level)
    assert weights[-1] > 0.0
    assert kept(spline, weights, x, energy).min() > 0.0


def test_it_ends_where_more_than_the_level_is_proved() -> None:
    """Below what any motion costs there is no best: the sum grows without end."""
    level = 0.9 * COST
    spline = PathSpline(EVEN, square_tube(EVEN, level))
    x, energy = spline.places(*ASKED)
    weights = square_weights(spline, x[0], energy, level)
    assert float(spline.ends() @ weights) / level == pytest.approx(MOST, rel=1e-9)
    assert kept(spline, weights, x, energy).min() > 0.0


def test_what_rounding_ends_still_keeps_the_inequality(monkeypatch: pytest.MonkeyPatch) -> None:
    made = path_weights._System
    steps: list[int] = []

    def fails_later(*given: FloatArray) -> object:
        steps.append(0)
        if len(steps) > 5:
            raise np.linalg.LinAlgError
        return made(*given)  # type: ignore[arg-type]

    monkeypatch.setattr(path_weights, "_System", fails_later)
    spline = PathSpline(BENT, square_tube(BENT, LEVEL))
    x, energy = spline.places(*ASKED)
    assert kept(spline, square_weights(spline, x[0], energy, LEVEL), x, energy).min() > 0.0
