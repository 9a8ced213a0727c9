"""Arcs as bends: the paper's equal steps, and the fewest bends within a chord error."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from outlines import outline_of

from camwright.profiles.bender.division import (
    DivisionRule,
    EqualSides,
    EqualSteps,
    FewestBends,
)
from camwright.profiles.bender.plan import plan_bends
from camwright.profiles.errors import InputError

CIRCLE = outline_of([[5e-3, 0], [-5e-3, 0], [5e-3, 0]], [1, 1])
RULES: list[DivisionRule] = [EqualSides(25), EqualSteps(2e-3), FewestBends(5e-5)]


def test_a_circle_has_25_bends_of_14_4_degrees():
    plan = plan_bends(CIRCLE, EqualSides(), math.radians(0.01))
    assert plan.bends == 25
    assert np.degrees(plan.turns) == pytest.approx(np.full(25, 14.4), abs=1e-9)
    assert plan.chord_error == pytest.approx(5e-3 * (1 / math.cos(math.radians(7.2)) - 1))


def test_step_by_hand():
    # number of bends = arc length / step
    division = EqualSteps(1e-3)(np.array([10e-3]), np.array([math.pi / 2]))
    assert division.bends[0] == round(10 * math.pi / 2)


@given(st.floats(1e-3, 1.0), st.floats(0.01, 2 * math.pi), st.integers(0, 2))
def test_division_spends_the_angle_and_its_error_is_that_of_the_polygon(radius: float, included: float, rule: int):
    r, a = np.array([radius]), np.array([included])
    division = RULES[rule](r, a)
    n, first, step = int(division.bends[0]), float(division.first[0]), float(division.step[0])
    assert 2 * first + (n - 1) * step == pytest.approx(included, rel=1e-12)
    assert 0 < first < math.pi / 2
    # the polygon by points: start, bends, end, and where its sides come nearest to the centre
    at = first + step * np.arange(n)
    out = radius / math.cos(first)
    points = np.vstack(
        [
            [radius, 0],
            out * np.stack([np.cos(at), np.sin(at)], axis=1),
            radius * np.array([[math.cos(included), math.sin(included)]]),
        ]
    )
    middles = 0.5 * (points[1:-2] + points[2:-1])
    away = np.abs(np.hypot(*np.vstack([points, middles]).T) - radius).max()
    assert float(division.error(r)[0]) == pytest.approx(away, abs=1e-12 * radius + 1e-15)


@given(st.floats(1e-3, 1.0), st.floats(0.01, 2 * math.pi), st.floats(1e-6, 2e-4))
def test_fewest_bends_keep_the_chord_error_and_one_less_does_not(radius: float, included: float, error: float):
    r, a = np.array([radius]), np.array([included])
    division = FewestBends(error)(r, a)
    assert float(division.error(r)[0]) <= error * (1 + 1e-6)
    n = int(division.bends[0])
    if n > 1:
        # the widest angles that n - 1 bends can cover within the error
        e = error / radius
        widest_first = min(math.acos(1 / (1 + e)), math.radians(60))
        widest_step = min(2 * math.acos((1 - e) / (1 + e)), math.radians(120))
        assert 2 * widest_first + (n - 2) * widest_step < included * (1 + 1e-7)


def test_fewer_bends_than_equal_sides_at_the_same_error():
    paper = plan_bends(CIRCLE, EqualSides(), math.radians(0.01))
    plan = plan_bends(CIRCLE, FewestBends(paper.chord_error), math.radians(0.01))
    assert plan.bends == 18  # sides centred on the circle: 25 / sqrt(2)
    assert plan.chord_error <= paper.chord_error


@pytest.mark.parametrize("make", [lambda: EqualSides(2), lambda: EqualSteps(0.0), lambda: FewestBends(-1.0)])
def test_refused(make: object):
    with pytest.raises(InputError, match=r"at least 3 sides|must be positive"):
        make()  # type: ignore[operator]


def test_plan_of_corner_and_tangent_arc():
    # 20 mm, tangent quarter of 10 mm radius, 20 mm, corner of 90° to the right, 10 mm
    points = np.array([[0, 0], [20, 0], [30, 10], [30, 30], [40, 30]]) * 1e-3
    plan = plan_bends(outline_of(points, [0, math.tan(math.pi / 8), 0, 0]), EqualSides(), math.radians(0.01))
    assert plan.bends == 6 + 1  # round(25 / 4) and the corner
    assert np.degrees(plan.turns) == pytest.approx([15.0] * 6 + [-90.0])
    assert plan.segments.tolist() == [1] * 6 + [3]
    assert plan.radii == pytest.approx([10e-3] * 6 + [math.inf])
    assert plan.feeds[0] == pytest.approx(20e-3 + 10e-3 * math.tan(math.radians(7.5)))
    assert plan.feeds[-1] == pytest.approx(10e-3)
