"""Choosing points: what is skipped must not change what is chosen."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from knives import KNIVES, UNITS, chosen, knife

from camwright import load_job
from camwright.drives.export import export_possible
from camwright.profiles.cut import Cut
from camwright.profiles.limits import Limits
from camwright.profiles.machines import RotaryKnife
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.returns import baseline
from camwright.profiles.tables.candidates import (
    _evenly,
    candidates,
    required_points,
    zone_ends,
)
from camwright.profiles.tables.deviation import Deviation, deviation, glance
from camwright.profiles.tables.knots import (
    Accuracy,
    ChosenTable,
    _rebuilt,
    choose,
    table_units,
)
from camwright.profiles.tables.targets import TARGETS
from camwright.profiles.task import Task
from camwright.validation.rebuilt import judge_table

FREE = Limits(math.inf, math.inf, math.inf)
"""Nothing here asks for limits."""

FINE = Accuracy(1e-9, 1e-6, 1e-4)
"""More than most targets reach: the nearest is chosen then."""


def naive(profile: CamProfile, target: str, accuracy: Accuracy) -> ChosenTable:
    """Look at every candidate closely, one after the other."""
    units = table_units(TARGETS[target], profile, UNITS)
    required = required_points(profile, zone_ends(profile))
    peak = profile.peak(2)
    allowed = np.array([accuracy.position, accuracy.ratio, accuracy.acceleration * peak])
    best: tuple[float, ChosenTable] | None = None
    for x in candidates(profile, TARGETS[target], required, allowed, None):
        table, rebuilt = _rebuilt(profile, TARGETS[target], units, x)
        found = deviation(profile, rebuilt)
        parts = [found.position / accuracy.position, found.ratio / accuracy.ratio]
        parts += [] if found.acceleration is None else [found.acceleration / accuracy.acceleration]
        if best is None or max(parts) < best[0]:
            best = max(parts), ChosenTable(table, rebuilt, found)
        if max(parts) <= 1:
            break
    assert best is not None
    return best[1]


@pytest.mark.parametrize("accuracy", [Accuracy(), FINE])
@pytest.mark.parametrize("name", ["jerk-limited", "of degree 15"])
@pytest.mark.parametrize(
    "target", ["br", "logix", "sew", "s7-1500t-points", "twincat-cnc", "pacdrive", "schneider-asc"]
)
def test_the_choice_is_that_of_looking_at_every_candidate(target: str, name: str, accuracy: Accuracy) -> None:
    profile = knife(name)
    found = choose(profile, TARGETS[target], table_units(TARGETS[target], profile, UNITS), accuracy)
    expected = naive(profile, target, accuracy)
    assert np.array_equal(found.table.x, expected.table.x)
    assert found.deviation == expected.deviation


@pytest.mark.parametrize("name", KNIVES)
@pytest.mark.parametrize("target", TARGETS)
def test_a_glance_is_a_lower_bound_of_the_deviation(target: str, name: str) -> None:
    profile = knife(name)
    choice = chosen(target, name)
    peak = profile.peak(2)
    low, true = glance(profile, choice.rebuilt, peak), choice.deviation
    assert 0 <= low.position <= true.position
    assert 0 <= low.ratio <= true.ratio
    assert (low.acceleration is None) == (true.acceleration is None)
    if low.acceleration is not None and true.acceleration is not None:
        assert low.acceleration <= true.acceleration


def test_deviation_in_closed_form() -> None:
    # the chord of x² on [0, 1]: off by 1/4 in the middle, the ratio by 1 at the ends, and it jumps at the seam
    parabola = CamProfile.from_arrays([0.0, 1.0], [[0.0, 0.0, 1.0]])
    chord = CamProfile.from_arrays([0.0, 1.0], [[0.0, 1.0]])
    assert deviation(parabola, chord) == Deviation(0.25, 1.0, 1.0)
    assert glance(parabola, chord, 2.0).ratio == 1.0
    halves = CamProfile.from_arrays([0.0, 0.5, 1.0], [[0.0, 0.5], [0.25, 1.5]])
    assert deviation(parabola, halves) == Deviation(0.0625, 0.5, None)


@given(st.lists(st.tuples(st.floats(1e-3, 2.0), st.integers(1, 50)), min_size=1, max_size=12), st.floats(-5.0, 5.0))
def test_even_points_are_those_of_linspace(pieces: list[tuple[float, int]], start: float) -> None:
    breaks = start + np.concatenate([[0.0], np.cumsum([width for width, _ in pieces])])
    counts = np.array([count for _, count in pieces])
    expected = [
        np.linspace(left, right, count + 1)[1:]
        for left, right, count in zip(breaks[:-1], breaks[1:], counts, strict=True)
    ]
    assert np.array_equal(_evenly(breaks[:-1], breaks[1:], counts), np.concatenate(expected))


def test_the_same_motion_is_judged_once(monkeypatch: pytest.MonkeyPatch) -> None:
    judge, calls = judge_table, []

    def counted(rebuilt: CamProfile, *rest: object) -> object:
        calls.append((rebuilt.breaks.tobytes(), rebuilt.coefficients.tobytes()))
        return judge(rebuilt, *rest)  # type: ignore[arg-type]

    monkeypatch.setattr("camwright.drives.export.judge_table", counted)
    job = load_job()
    results = export_possible(baseline("double_s", job.task), job, ["codesys", "twincat", "pacdrive", "csv", "logix"])[
        0
    ]
    assert len(results) == 5
    assert len(calls) == len(set(calls)) < 2 * len(results)
    alone = export_possible(baseline("double_s", job.task), job, ["pacdrive"])[0][0]
    assert alone.judgement.checks == results[2].judgement.checks


@pytest.mark.parametrize("law", ["cubic", "parabolic", "velocity_trapezoid"])
def test_a_jump_of_the_acceleration_is_missed_and_said_to_be(law: str) -> None:
    profile = baseline(law, Task(RotaryKnife(0.4), Cut(0.6, 80 / 60, 0.2, 0.04, 0.16, 1e-4), FREE))
    target = TARGETS["csv"]
    found = choose(profile, target, table_units(target, profile, UNITS), Accuracy())
    assert found.table.points <= target.max_points
    assert not Accuracy().kept_by(found.deviation)
