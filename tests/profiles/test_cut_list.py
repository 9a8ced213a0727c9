"""Gaps of a cut list."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camwright.profiles.cut_list import PIECE_KINDS, CutList, ListRow
from camwright.profiles.line_run import LineRun

rows = st.lists(
    st.builds(
        ListRow,
        st.integers(100, 2000).map(lambda mm: mm / 1000),
        st.integers(1, 4),
        st.sampled_from(PIECE_KINDS),
        st.integers(1, 99),
    ),
    min_size=1,
    max_size=12,
).map(lambda found: (*found, ListRow(0.5, 1, "cut", 100)))


@given(rows)
def test_all_material_lies_in_some_gap(found: tuple[ListRow, ...]) -> None:
    asked = CutList(found)
    assert asked.gaps.sum() == pytest.approx(sum(row.length * row.quantity for row in found))
    assert len(asked.gaps) == asked.pieces == len(asked.crops) == len(asked.lines)


@given(rows)
def test_gaps_are_those_of_a_walk_along_the_material(found: tuple[ListRow, ...]) -> None:
    gaps, crops, since = [], [], 0.0
    for row in found:
        for _ in range(row.quantity):
            since += row.length
            if row.kind != "skip":
                gaps.append(since)
                crops.append(row.kind == "crop")
                since = 0.0
    asked = CutList(found)
    assert asked.gaps == pytest.approx(gaps, abs=1e-9)
    assert asked.crops.tolist() == crops
    assert asked.scrap == pytest.approx(sum(gap for gap, crop in zip(gaps, crops, strict=True) if crop))


def test_lengths_that_differ_by_less_than_a_nanometre_are_one() -> None:
    asked = CutList((ListRow(0.3), ListRow(0.1 + 0.2), ListRow(0.3 + 2e-9)))
    assert len(np.unique(asked.gaps)) == 2


@given(
    st.lists(st.tuples(st.floats(0.01, 5.0), st.floats(0.0, 3.0)), min_size=2, max_size=8).filter(
        lambda rows: any(speed > 0.01 for _, speed in rows)
    ),
    st.floats(0.0, 1.0),
)
def test_when_is_the_inverse_of_passed(steps: list[tuple[float, float]], share: float) -> None:
    times = np.cumsum([step for step, _ in steps]) - steps[0][0]
    run = LineRun(times, np.array([speed for _, speed in steps]))
    x = share * run.length
    assert float(run.passed(run.when(x))) == pytest.approx(x, abs=1e-9)


def test_a_line_whose_acceleration_changes_evenly() -> None:
    """From 1 m/s over a peak of 1.5 m/s and back: cubics over the time, and their inverse."""
    run = LineRun(np.array([0.0, 1.0, 3.0, 4.0]), np.array([1.0, 1.5, 1.5, 1.0]), np.array([0.0, 1.0, -1.0, 0.0]))
    t = np.linspace(0.0, 4.0, 4001)
    v = run.speed(t)
    assert run.passed(t) == pytest.approx(
        np.concatenate([[0.0], np.cumsum(0.5 * np.diff(t) * (v[1:] + v[:-1]))]), abs=1e-6
    )
    assert run.when(run.passed(t)) == pytest.approx(t, abs=1e-12)
    assert run.when([-1.0, run.length + 2.0]).tolist() == [-1.0, 6.0]
    places = np.array([0.0, float(run.passed(1.5)), run.length])
    assert run.fastest_between(places).tolist() == pytest.approx([float(run.speed(1.5)), 2.0])
    assert run.hardest_between(places).tolist() == [1.0, 1.0]
    assert run.hardest == 1.0


def test_a_line_run_adds_up_like_a_sum_of_small_steps() -> None:
    run = LineRun(np.array([0.0, 1.0, 2.0, 5.0]), np.array([0.0, 2.0, 2.0, 0.5]))
    t = np.linspace(0.0, 6.0, 600_001)
    v = np.interp(t, run.times, run.speeds)
    x = np.concatenate([[0.0], np.cumsum(0.5 * (v[1:] + v[:-1]) * np.diff(t))])
    assert np.abs(run.passed(t) - x).max() < 1e-8
    assert np.abs(run.speed(t) - v).max() < 1e-12


def test_fastest_and_hardest_between_places() -> None:
    run = LineRun(np.array([0.0, 1.0, 2.0, 4.0]), np.array([1.0, 1.0, 2.0, 0.0]))
    places = np.array([0.0, 0.5, 1.0, 2.5, 4.5])  # corners at 0, 1, 2.5 and 4.5 m
    assert run.fastest_between(places) == pytest.approx([1.0, 1.0, 2.0, 2.0])
    assert run.hardest_between(places) == pytest.approx([0.0, 0.0, 1.0, 1.0])
    assert run.hardest == 1.0
    assert run.hardest_between(np.array([0.9, 1.1, 1.2])) == pytest.approx([1.0, 1.0])


def test_where_the_line_stands_the_first_moment_counts_and_beyond_its_end_none() -> None:
    run = LineRun(np.array([0.0, 1.0, 4.0, 5.0, 6.0]), np.array([2.0, 0.0, 0.0, 2.0, 0.0]))
    assert run.when([1.0]).tolist() == [1.0]
    assert run.when([3.1]).tolist() == [float("inf")]
