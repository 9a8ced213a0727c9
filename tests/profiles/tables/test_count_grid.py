"""Positions in counts: the grid is found, and the rounding taken off."""

from __future__ import annotations

import numpy as np
import pytest

from camwright.profiles.tables.cam_table import make_table
from camwright.profiles.tables.count_grid import evened, grain_of, grid_of, without_rounding


def cam(points: int) -> tuple[np.ndarray, np.ndarray]:
    x = np.linspace(0.0, 1.0, points)
    return x, x + 0.1 * np.sin(2 * np.pi * x) / (2 * np.pi)


@pytest.mark.parametrize("turn", [36_000, 131_072, 1_048_576])
@pytest.mark.parametrize("points", [361, 1000, 3601])
def test_the_grid_is_found(turn: int, points: int) -> None:
    _, y = cam(points)
    counts = np.rint(y * turn)
    assert grid_of(counts) == 1.0
    printed = np.round(counts / turn * 360.0, 6)
    assert grid_of(printed) == pytest.approx(360.0 / turn, rel=1e-6)
    assert grid_of(y * np.sqrt(2.0)) is None


def test_points_that_stand_close_together_are_no_counts() -> None:
    """Groups of points about places a tenth apart lie on a grid of tenths, to a twentieth; but points that differ are no one count."""
    y = np.sort(np.concatenate([0.1 * k + np.linspace(-0.004, 0.004, 20) for k in range(5)]))
    assert grid_of(y) is None or grid_of(y) < 0.001
    assert grain_of(y) < 0.001


def test_the_rounding_is_taken_off() -> None:
    x, y = cam(721)
    true = float(np.abs(np.diff(y, 2)).max())
    counts = np.rint(y * 36_000)
    found = without_rounding(make_table(x, counts, law="spline"))
    assert found is not None
    assert found.count == 1.0
    assert np.abs(found.table.y - 36_000 * y).max() < 1.0
    assert np.abs(np.diff(counts, 2)).max() / 36_000 > 5 * true
    wide = found.table.y[::8] / 36_000
    assert float(np.abs(np.diff(wide, 2)).max()) == pytest.approx(64 * true, rel=0.1)
    assert "whole counts of 1 (36000 a cycle)" in found.note


def test_what_is_fine_enough_is_left_alone() -> None:
    x, y = cam(361)
    assert without_rounding(make_table(x, np.round(y, 9), law="spline")) is None
    assert without_rounding(make_table(x, np.rint(y * 36_000), law="line")) is None
    uneven = x + 0.1 * x * (1 - x)
    assert without_rounding(make_table(uneven, np.rint(y * 36_000), law="spline")) is None


@pytest.mark.parametrize("size", [1e-3, 1.0, 25.4e-3])
def test_the_last_digit_of_floating_numbers_is_that_of_the_greatest(size: float) -> None:
    _, y = cam(721)
    short = np.array([float(f"{value:.6g}") for value in 400.0 * y])
    assert grain_of(short) == pytest.approx(1e-3)
    single = (400.0 * y).astype(np.float32).astype(np.float64)
    assert grain_of(single * size) == pytest.approx(size * 2.0**-15, rel=1e-6)
    assert grain_of(400.0 * y * np.sqrt(2.0)) == 0.0


def test_the_rounding_of_even_master_positions_is_taken_off() -> None:
    x, y = cam(721)
    for grain in (0.01, 0.05, 0.4):
        stored = np.rint((600.0 * x + 0.003) / grain) * grain
        found = evened(make_table(stored, y, law="spline"))
        assert found is not None
        assert np.ptp(np.diff(found.x)) < 1e-9
        assert np.abs(found.x - stored).max() <= 0.5001 * grain
        assert f"are rounded to {grain:g}" in found.notes[-1]
    uneven = 600.0 * x + 0.2 * np.sin(40 * x)
    assert evened(make_table(uneven, y, law="spline")) is None
    assert evened(make_table(600.0 * x, y, law="spline")) is None
