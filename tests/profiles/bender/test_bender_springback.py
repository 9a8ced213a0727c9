"""Springback tables: the paper's samples, interpolation and its inverse, and the tables that cannot be true."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from outlines import outline_of

from camwright.profiles.bender.curve import Curve
from camwright.profiles.bender.division import EqualSides
from camwright.profiles.bender.plan import plan_bends
from camwright.profiles.bender.springback import Interpolation, Springback
from camwright.profiles.errors import InputError


def make(
    angles: list[list[float]], radii: list[list[float]] | None = None, how: Interpolation = "linear"
) -> Springback:
    a = np.radians(np.array(angles, dtype=float).reshape(-1, 2))
    r = np.array(radii or [], dtype=float).reshape(-1, 2)
    return Springback("sample", a[:, 0], a[:, 1], r[:, 0] * 1e-3, np.radians(r[:, 1]), interpolation=how)


PRINTED = make([[15, 16.8], [20, 17.5]], [[5.5, 16.9], [6.0, 16.8]])


def test_printed_samples():
    assert math.degrees(PRINTED.mould_angle(math.radians(15))) == pytest.approx(16.8, abs=1e-12)
    for gamma in (15.5, 17.0, 20.0):  # beta = 16.8 + 0.14 (gamma - 15)
        assert math.degrees(PRINTED.mould_angle(math.radians(gamma))) == pytest.approx(16.8 + 0.14 * (gamma - 15))
    for radius in (5.5, 5.7, 6.0):  # beta = 16.9 - 0.2 (R - 5.5), for the step of 14.4°
        factor = float(PRINTED.factor(np.array([radius * 1e-3]))[0])
        found = math.degrees(PRINTED.mould_angle(math.radians(14.4), factor))
        assert found == pytest.approx(16.9 - 0.2 * (radius - 5.5), abs=1e-12)


def test_printed_table_under_bends_by_row():
    warnings = PRINTED.warnings()
    assert len(warnings) == 1
    assert "angle table, row 2" in warnings[0]
    assert "17.500° is less than the workpiece angle 20.000°" in warnings[0]


@pytest.mark.parametrize("how", ["linear", "cubic"])
@given(angle=st.floats(0.001, 169.9), left=st.booleans())
def test_inverse(how: Interpolation, angle: float, left: bool):
    table = make([[0, 0], [15, 16.8], [20, 22.5], [45, 47.2], [90, 90], [170, 175]], how=how)
    turn = math.radians(angle if left else -angle)
    mould = table.mould_angle(turn)
    assert math.copysign(1, mould) == math.copysign(1, turn)
    assert table.workpiece_angle(mould) == pytest.approx(turn, rel=1e-12)
    factor = 1.2
    assert table.workpiece_angle(table.mould_angle(turn, factor), factor) == pytest.approx(turn, rel=1e-12)


def test_cubic_against_scipy_and_rising():
    from scipy.interpolate import PchipInterpolator

    x, y = np.array([0.0, 15, 20, 45, 90, 170]), np.array([0.0, 16.8, 22.5, 47.2, 90, 175])
    curve, judge = Curve.monotone_cubic(x, y), PchipInterpolator(x, y)
    at = np.linspace(0, 170, 1701)
    values = np.array([curve.value(t) for t in at.tolist()])
    assert values == pytest.approx(judge(at), abs=1e-10)
    assert (np.diff(values) > 0).all()


@pytest.mark.parametrize("how", ["linear", "cubic"])
def test_carried_on_beyond_the_rows_and_back(how: Interpolation):
    table = make([[10, 12], [20, 23], [40, 44]], how=how)
    for degrees in (5.0, 45.0):
        turn = math.radians(degrees)
        assert table.workpiece_angle(table.mould_angle(turn)) == pytest.approx(turn, rel=1e-12)


@pytest.mark.parametrize(
    ("angles", "radii", "message"),
    [
        ([[15, 16.8], [20, 16.0]], [], "row 2: the mould angle 16.000° does not exceed the 16.800° of row 1"),
        ([[15, 16.8], [15, 17.0]], [], "row 2: the workpiece angle 15.000 ° does not exceed"),
        ([[15, 16.8]], [], "has 1 rows"),
        ([[0, 0], [math.nan, 20]], [], "workpiece angle is negative, NaN"),
        ([[0, 0], [20, 22]], [[6, 16.8], [5, 16.9]], "radius table, row 2: the radius 5.000 mm does not exceed"),
    ],
)
def test_refused_by_row(angles: list[list[float]], radii: list[list[float]], message: str):
    with pytest.raises(InputError, match=message):
        make(angles, radii)


def test_radius_rows_that_cannot_be_true():
    warnings = make([[0, 0], [20, 22]], [[5, 16.8], [10, 16.0], [20, 16.4], [30, 14.0]]).warnings()
    assert any("radius table, row 4" in text and "under-bends" in text for text in warnings)
    assert any("radius table, row 3" in text and "turns back" in text for text in warnings)


def test_what_the_table_does_not_cover():
    points = np.array([[0, 0], [20, 0], [20, 20], [22, 20], [24, 22]]) * 1e-3
    plan = plan_bends(outline_of(points, [0, 0, 0, 0.41]), EqualSides(), math.radians(0.01))
    faults = PRINTED.faults(plan)
    assert any("bend 1 at (20.000, 0.000) mm: workpiece angle 90.000° lies outside" in text for text in faults)
    assert any("segment 4: radius" in text and "begins at 5.500 mm" in text for text in faults)


def test_without_a_radius_table_arcs_follow_the_angles():
    table = make([[0, 0], [20, 22]])
    assert np.isnan(table.by_radius(np.array([5e-3, math.inf]))).all()
    assert np.isnan(PRINTED.by_radius(np.array([5e-3, math.inf]))).tolist() == [False, True]
