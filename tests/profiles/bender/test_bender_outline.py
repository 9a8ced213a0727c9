"""Outlines: the paper's relations for bulges, and the workpiece angles at every kind of joint."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from outlines import outline_of

from camwright.profiles.bender.outline import wrapped
from camwright.profiles.errors import InputError

QUARTER = 0.414214


def test_bulge_of_a_quarter_circle():
    # from (0, 0) to (10, 10) to the left: centre (0, 10), radius 10
    outline = outline_of([[0, 0], [10, 10]], [QUARTER])
    assert outline.included[0] == pytest.approx(math.pi / 2, abs=1e-5)
    assert outline.radii[0] == pytest.approx(10, rel=1e-5)
    assert outline.centres[0] == pytest.approx([0, 10], abs=1e-4)
    assert outline.lengths[0] == pytest.approx(10 * math.pi / 2, rel=1e-5)


@given(st.floats(1e-6, 3.0), st.floats(-3, 3), st.booleans())
def test_arc_against_the_printed_formulas(mu: float, direction: float, left: bool):
    bulge = mu if left else -mu
    chord = 0.03
    end = chord * np.array([math.cos(direction), math.sin(direction)])
    outline = outline_of([[0, 0], end], [bulge])
    alpha = 4 * math.atan(mu)
    assert abs(outline.included[0]) == pytest.approx(alpha, rel=1e-12)
    assert outline.radii[0] == pytest.approx(chord / (2 * math.sin(alpha / 2)), rel=1e-8)
    for point in outline.points:
        assert math.dist(point, outline.centres[0]) == pytest.approx(outline.radii[0], rel=1e-8)
    # tangents stand square on the radii, the arc running around its centre
    for heading, point in zip(outline.headings, outline.points, strict=True):
        out = (point - outline.centres[0]) / outline.radii[0]
        along = np.array([math.cos(heading[0]), math.sin(heading[0])])
        assert out @ along == pytest.approx(0, abs=1e-7)
        assert out[0] * along[1] - out[1] * along[0] == pytest.approx(1 if left else -1, abs=1e-7)


@pytest.mark.parametrize(
    ("points", "bulges", "turn"),
    [
        ([[0, 0], [1, 0], [1, 1]], [0, 0], 90),  # line - line
        ([[0, 0], [1, 0], [2, 1]], [0, math.tan(math.pi / 8)], 0),  # line - arc, tangent
        ([[0, 0], [1, 0], [2, 1]], [0, -math.tan(math.pi / 8)], 90),  # line - arc, corner
        ([[0, 0], [1, 1], [0, 2]], [math.tan(math.pi / 8)] * 2, 0),  # arc - arc, tangent
        ([[0, 0], [2, 0], [4, 0]], [1, 1], -180),  # arc - arc, a cusp
        ([[0, 0], [1, 1], [1, 2]], [math.tan(math.pi / 8), 0], 0),  # arc - line, tangent
        ([[0, 0], [1, 1], [2, 1]], [math.tan(math.pi / 8), 0], -90),  # arc - line, corner
    ],
)
def test_workpiece_angle_at_joints(points: list[list[float]], bulges: list[float], turn: float):
    found = math.degrees(outline_of(points, bulges).turns[0])
    assert (
        abs(found) == pytest.approx(abs(turn), abs=1e-9) if abs(turn) == 180 else found == pytest.approx(turn, abs=1e-9)
    )


def test_turning_of_a_closed_outline_is_one_turn():
    outline = outline_of([[0, 0], [4, 0], [5, 1], [5, 3], [0, 3], [0, 0]], [0, math.tan(math.pi / 8), 0, 0.2, 0])
    seam = float(wrapped(outline.headings[0][:1] - outline.headings[1][-1:])[0])
    assert float(outline.turns.sum() + outline.included.sum()) + seam == pytest.approx(2 * math.pi)


def test_reverse_and_begin_at():
    outline = outline_of([[0, 0], [4, 0], [4, 3], [0, 0]], [0, 0.5, 0])
    back = outline.reverse()
    assert back.points[1].tolist() == [4, 3]
    assert back.bulges.tolist() == [0, -0.5, 0]
    assert back.turns == pytest.approx(-outline.turns[::-1])
    moved = outline.begin_at(3.9, 0.1)
    assert moved.points.tolist() == [[4, 0], [4, 3], [0, 0], [4, 0]]
    assert moved.bulges.tolist() == [0.5, 0, 0]
    line = outline_of([[0, 0], [1, 0], [2, 2]])
    assert line.begin_at(2, 2).points[0].tolist() == [2, 2]
    assert line.begin_at(0, 1) is line


@pytest.mark.parametrize(
    ("points", "bulges", "message"),
    [
        ([[0, 0], [1, 0], [1, 0]], [0, 0], "segment 2 has no length"),
        ([[0, 0], [math.nan, 0]], [0], "NaN or infinite"),
        ([[0, 0], [1, 0]], [math.inf], "NaN or infinite"),
        ([[0, 0]], [], "at least one segment"),
        ([[0, 0], [1, 0]], [0, 0], "needs n \\+ 1 points"),
    ],
)
def test_refused(points: list[list[float]], bulges: list[float], message: str):
    with pytest.raises(InputError, match=message):
        outline_of(points, bulges, "LINE #2F")
