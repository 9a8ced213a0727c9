"""Chords that lie on an arc are bent as that arc; polygons and curves that lie on none stay as they are."""

import math
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camwright.bender.chords import with_arcs
from camwright.bender.drawing import Reading, read_drawing
from camwright.bender.piece import Piece
from camwright.profiles.bender.division import DivisionRule, EqualSides, EqualSteps, FewestBends

Make = Callable[..., Path]
GAP = 1e-5
ERROR = FewestBends(5e-5).allowed


def chords(radius: float, start: float, sweep: float, count: int) -> np.ndarray:
    """Give the vertices of an arc around the origin (mm, degrees)."""
    angle = np.radians(start + sweep * np.arange(count + 1) / count)
    return radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def piece(points: np.ndarray) -> Piece:
    return Piece(1e-3 * points, np.zeros(len(points) - 1), "LWPOLYLINE #1 on layer 0")


def test_a_quarter_between_two_lines():
    points = np.vstack([[[20, -30]], chords(20, 0, 90, 18), [[-30, 20]]])
    line, (found,) = with_arcs(piece(points), ERROR, GAP)
    assert line.points == pytest.approx(1e-3 * np.array([[20, -30], [20, 0], [0, 20], [-30, 20]]), abs=1e-15)
    assert line.bulges == pytest.approx([0, math.tan(math.pi / 8), 0])
    assert (found.chords, found.radius, found.included) == (18, pytest.approx(20e-3), pytest.approx(math.pi / 2))
    assert found.distance == pytest.approx(20e-3 * (1 - math.cos(math.radians(2.5))))
    assert "18 chords of LWPOLYLINE #1 on layer 0 lie on an arc of radius 20.000 mm and 90.00°" in found.told


@given(
    st.floats(1, 500), st.floats(-180, 180), st.floats(12, 360), st.booleans(), st.floats(-1e4, 1e4), st.integers(0, 3)
)
def test_any_arc_is_found_whole(radius: float, start: float, sweep: float, right: bool, x: float, digits: int):
    step = 2 * math.acos(1 - 0.03 / radius) if radius > 0.03 else 1.0
    count = max(3, math.ceil(math.radians(sweep) / min(step, math.radians(34))))
    points = chords(radius, start, -sweep if right else sweep, count) + np.array([x, -x])
    if digits == 3:
        points = np.round(points, 5)  # as written in a file
    if sweep > 360 - 1e-6:  # a hair less is a circle too: what is left of it is shorter than the gap
        points[-1] = points[0]
    line, found = with_arcs(piece(points), ERROR, GAP)
    assert sum(arc.chords for arc in found) == count
    assert len(found) == 1
    assert found[0].radius == pytest.approx(1e-3 * radius, rel=0.01)
    assert len(line.bulges) == (1 if abs(found[0].included) <= math.pi else 2)
    assert (np.sign(line.bulges) == (-1 if right else 1)).all()
    assert line.length == pytest.approx(1e-3 * radius * math.radians(sweep), rel=1e-3)


def test_what_is_no_arc():
    hexagon = chords(30, 0, 360, 6)
    zigzag = np.array([[5 * k, k % 2] for k in range(20)], dtype=float)
    straight = np.array([[5 * k, 0] for k in range(20)], dtype=float)
    corner = np.array([[0, 0], [20, 0], [25, 2], [26, 30]], dtype=float)
    for points in (hexagon, zigzag, straight, corner):
        line, found = with_arcs(piece(points), ERROR, GAP)
        assert found == ()
        assert line.points == pytest.approx(1e-3 * points)


def test_chords_that_are_too_long_are_told_and_left():
    line, (found,) = with_arcs(piece(chords(20, 0, 90, 9)), ERROR, GAP)
    assert len(line.bulges) == 9
    assert not found.bent
    assert found.distance == pytest.approx(20e-3 * (1 - math.cos(math.radians(5))))
    assert "9 chords of LWPOLYLINE #1 on layer 0 have their ends on an arc of radius 20.000 mm and 90.00°" in found.told
    assert "lie up to 0.0761 mm from it" in found.told


def test_one_vertex_off_the_arc_parts_it():
    points = chords(20, 0, 90, 18)
    points[9] *= 1 + 0.1 / 20  # 0.1 mm outside
    _, found = with_arcs(piece(points), ERROR, GAP)
    assert [arc.chords for arc in found] == [8, 8]


def test_lines_that_stand_for_a_curve_stay(drawing: Make):
    path = drawing(lambda m, _: m.add_spline([(0, 0), (20, 5), (40, 0), (60, -9)]))
    assert read_drawing(path, Reading(1e-5, 1e-5, arc_error=ERROR)).outlines[0].arcs.sum() == 0


def test_from_lines_of_a_drawing_and_kept_on_demand(drawing: Make):
    points = chords(20, 0, 90, 18).tolist()
    path = drawing(lambda m, _: [m.add_line(a, b) for a, b in pairwise(points)])
    found = read_drawing(path, Reading(1e-5, 1e-5, arc_error=ERROR))
    assert len(found.outlines[0].bulges) == 1
    assert any("18 chords of LINE" in text for text in found.warnings)
    assert len(read_drawing(path, Reading(1e-5, 1e-5)).outlines[0].bulges) == 18


@pytest.mark.parametrize("rule", [EqualSides(25), EqualSteps(2e-3), FewestBends(5e-5)])
@pytest.mark.parametrize("radius", [20e-3, 0.1, 0.5])
def test_the_error_that_a_rule_allows_is_that_of_its_longest_arcs(rule: DivisionRule, radius: float):
    divided = rule(np.array([radius]), np.array([2 * math.pi]))
    error = float(divided.error(np.array([radius]))[0])
    assert error <= rule.allowed(radius) * 1.02
    assert error >= rule.allowed(radius) * 0.5
