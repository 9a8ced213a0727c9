"""cam.csv: what is written is read back, and tables are rebuilt as the profiles that they stand for."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import BPoly

from camwright.profiles.cut import Cut
from camwright.profiles.errors import InputError
from camwright.profiles.limits import Limits
from camwright.profiles.machines import RotaryKnife
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.returns import BASELINES, baseline
from camwright.profiles.tables.cam_csv import (
    rebuild,
    table_positions,
    write_cam_csv,
)
from camwright.profiles.tables.cam_rows import read_cam_csv
from camwright.profiles.task import Task

FREE = Limits(math.inf, math.inf, math.inf)
"""Nothing here asks for limits."""

KNIFE = RotaryKnife(0.4)
CUT = Cut(0.6, 80 / 60, 0.2, 0.04, 0.16, 1e-4)


def three_breaks(first: float, second: float) -> CamProfile:
    return CamProfile.from_arrays([0.0, first, second, 1.0], [[0.0, 1.0]] * 3)


def test_positions_are_equidistant_but_for_the_breaks() -> None:
    profile = three_breaks(0.31, 0.72)
    x = table_positions(profile, 11)
    expected = np.linspace(0.0, 1.0, 11)
    expected[3], expected[7] = 0.31, 0.72
    np.testing.assert_array_equal(x, expected)


def test_breaks_that_lie_together_take_no_positions_from_elsewhere() -> None:
    breaks = np.concatenate([[0.0], np.linspace(0.5, 0.5001, 50), [1.0]])
    x = table_positions(CamProfile.from_arrays(breaks, [[0.0, 1.0]] * (len(breaks) - 1)), 92)
    assert np.isin(breaks, x).all()
    np.testing.assert_allclose(np.diff(x)[[*range(21), *range(70, 91)]], 0.5 / 21, rtol=3e-4)


@given(st.lists(st.floats(0.0, 1.0), min_size=2, max_size=30, unique=True), st.integers(0, 40))
def test_every_break_has_a_position_and_positions_increase(places: list[float], more: int) -> None:
    breaks = np.unique(np.round([0.0, 1.0, *places], 9))
    profile = CamProfile.from_arrays(breaks, [[0.0, 1.0]] * (len(breaks) - 1))
    x = table_positions(profile, len(breaks) + more)
    assert len(x) == len(breaks) + more
    assert (np.diff(x) > 0).all()
    assert np.isin(breaks, x).all()


def test_too_few_points_are_refused_with_the_least_number() -> None:
    with pytest.raises(InputError, match=r"points = 3: too few to hold the 4 ends .*; write points = 4 or more"):
        table_positions(three_breaks(0.3, 0.7), 3)
    np.testing.assert_array_equal(table_positions(three_breaks(0.01, 0.02), 4), [0.0, 0.01, 0.02, 1.0])


def test_the_text_is_comments_a_header_and_rows() -> None:
    profile = CamProfile.from_arrays([0.0, 1.0], [[0.0, 0.0, 0.5, 0.25]])
    text = write_cam_csv(profile, 3, ["job: two\nlines", "b"])
    assert text.splitlines() == [
        "# job: two lines",
        "# b",
        "x [mm],y [mm],dy/dx [1],d2y/dx2 [1/m],d3y/dx3 [1/m^2]",
        "0.0,0.0,0.0,1.0,1.5",
        "500.0,156.25,0.6875,1.75,1.5",
        "1000.0,750.0,1.75,2.5,1.5",
    ]


@pytest.mark.parametrize("name", BASELINES)
def test_a_smooth_baseline_survives_its_table(name: str) -> None:
    profile = baseline(name, Task(KNIFE, CUT, FREE))
    rows = read_cam_csv(write_cam_csv(profile, 361, []), "")
    table = rebuild(rows.x, rows.y, rows.dy, rows.d2y)
    x = np.linspace(0.0, CUT.length, 5001)
    np.testing.assert_allclose(rows.y, profile(rows.x), atol=1e-15)
    if (
        max(np.abs(profile.jumps(order)).max() for order in (1, 2)) < 1e-9
    ):  # a row holds one value, so jumps are not in the table
        np.testing.assert_allclose(table(x), profile(x), atol=1e-12)
        np.testing.assert_allclose(table(x, 2), profile(x, 2), atol=1e-4 * np.abs(profile(x, 2)).max())


def test_cubic_pieces_come_back_as_themselves_without_noise() -> None:
    profile = baseline("acceleration_trapezoid", Task(KNIFE, CUT, FREE))
    rows = read_cam_csv(write_cam_csv(profile, 361, []), "")
    table = rebuild(rows.x, rows.y, rows.dy, rows.d2y)
    assert not table.coefficients[:, 4:].any()
    for order in range(4):
        for found, known in zip(table.extrema(order), profile.extrema(order), strict=True):
            assert found.value == pytest.approx(known.value, rel=1e-10, abs=1e-12)
    in_sync = table.restrict(0.4, 0.6)
    assert in_sync.extrema(1)[0].value == in_sync.extrema(1)[1].value == 1.0


def test_rows_with_derivatives_are_quintics_as_scipys() -> None:
    generator = np.random.default_rng(5)
    x = np.cumsum(generator.uniform(0.5, 1.5, 12))
    y, dy, d2y = generator.normal(size=(3, 12))
    table = rebuild(x, y, dy, d2y)
    twin = BPoly.from_derivatives(x, np.column_stack([y, dy, d2y]))
    fine = np.linspace(x[0], x[-1], 500)
    for order in range(3):
        np.testing.assert_allclose(
            table(fine, order), twin.derivative(order)(fine) if order else twin(fine), atol=1e-11
        )


@pytest.mark.parametrize(
    "header",
    ["x [mm],y [mm]", "x_mm,y_mm", "x (mm), y (mm)", " x [ mm ] ,y[mm]", "\ufeffx [mm],y [mm]", "# note\n\nx_mm,y_mm"],
)
def test_units_stand_in_brackets_or_after_an_underscore(header: str) -> None:
    rows = read_cam_csv(header + "\r\n0,0\r\n1,2\r\n\r\n2,3\r\n3,9e0", "")
    np.testing.assert_array_equal(rows.x, [0.0, 0.001, 0.002, 0.003])
    np.testing.assert_array_equal(rows.y, [0.0, 0.002, 0.003, 0.009])
    assert rows.dy is None


def test_columns_may_have_other_units_and_another_order() -> None:
    text = "d2y/dx2 [1/mm],y [in],x [m],dy/dx [1],d3y/dx3 [1/m^2]\n" + "\n".join(f"1,10,{i},0.5,7" for i in range(4))
    rows = read_cam_csv(text, "")
    assert rows.dy is not None
    assert rows.d2y is not None
    assert (rows.x[1], rows.y[0], rows.dy[0], rows.d2y[0]) == (1.0, 0.254, 0.5, 1000.0)


GOOD = "x [mm],y [mm]\n0,0\n1,1\n2,2\n3,3\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "t.csv: there is no table in it; write a header like x [mm],y [mm]"),
        ("# only\n# comments\n", "t.csv: there is no table in it"),
        (GOOD.replace("x [mm]", "x [s]"), "t.csv, line 1: column x cannot be in 's'; its unit is one of m, mm"),
        (GOOD.replace("y [mm]", "dydx [1]"), "there is no column 'dydx [1]'; did you mean dy/dx?"),
        (GOOD.replace("y [mm]", "x [mm]"), "t.csv, line 1: column x stands there twice"),
        (GOOD.replace("y [mm]", "dy/dx [1]"), "t.csv, line 1: column y is missing"),
        ("x [mm];y [mm]\n0;0\n", "t.csv: 1 rows; a cam table needs 4 at least"),
        (GOOD.replace("3,3\n", ""), "t.csv: 3 rows; a cam table needs 4 at least"),
        (GOOD.replace("2,2", "2,nan"), "t.csv, line 4: 'nan' is not a finite number"),
        (GOOD.replace("2,2", "2,inf"), "t.csv, line 4: 'inf' is not a finite number"),
        (GOOD.replace("2,2", "2,1e999"), "t.csv, line 4: '1e999' is not a finite number"),
        (GOOD.replace("2,2", "2,two"), "t.csv, line 4: 'two' is not a finite number"),
        (GOOD.replace("2,2", "2,1_0"), "t.csv, line 4: '1_0' is not a finite number"),
        (GOOD.replace("2,2", "2,"), "t.csv, line 4: '' is not a finite number"),
        (GOOD.replace("2,2", "2,2,2"), "t.csv, line 4: 3 cells where the header has 2"),
        (GOOD.replace("2,2", "2"), "t.csv, line 4: 1 cells where the header has 2"),
        (GOOD.replace("2,2", "1,2"), "t.csv, line 4: x does not increase from the row before"),
        (GOOD.replace("3,3", "1.5,3"), "t.csv, line 5: x does not increase from the row before"),
        (GOOD.replace("2,2", "1.0000000000000002,2"), "t.csv, line 4: x does not increase from the row before"),
    ],
)  # fmt: skip
def test_what_is_no_table_is_refused_with_its_line(text: str, message: str) -> None:
    with pytest.raises(InputError) as caught:
        read_cam_csv(text, "t.csv")
    assert message in str(caught.value)
