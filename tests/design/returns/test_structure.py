"""Reading the few pieces of an optimum off a grid, and tidying what the solver leaves."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from camwright.design.returns import solver
from camwright.design.returns.bernstein import ScaledMotion, piece_coefficients
from camwright.design.returns.closed_starts import known_start
from camwright.design.returns.grids import on_grid
from camwright.design.returns.measures import excess, objective_value
from camwright.design.returns.scaling import ScaledProblem
from camwright.design.returns.structure import (
    SEVEN_ARCS,
    extreme_motion,
    from_extreme,
    read_cubic,
    read_quintic,
    readings_of,
    subdivide,
    tidy,
)
from camwright.profiles.closed_forms.reach import greatest_reach, least_acceleration, least_jerk

PEAK = ScaledProblem(1.0, 0.0, 0.0, 0.0, -10.0, 10.0, 100.0, 100.0, "peak_acceleration")


@pytest.mark.parametrize(
    ("jerk", "speed"), [(35.0, 9.0), (50.0, 9.0), (200.0, 9.0), (1e3, 9.0), (1e4, 9.0), (300.0, 1.3)]
)
def test_seven_arcs_are_found_near_where_they_are(jerk: float, speed: float) -> None:
    problem = replace(PEAK, greatest_ratio=speed, least_ratio=-speed, greatest_jerk=jerk)
    extreme = extreme_motion(problem)
    assert extreme is not None
    exact = from_extreme(extreme)
    grid, success, _ = on_grid(problem, np.full(40, 1 / 40), 0.0)
    assert success
    start, arcs = read_cubic(grid, problem)
    assert arcs == SEVEN_ARCS
    assert start.lengths.sum() == pytest.approx(1.0, abs=1e-12)
    assert (start.lengths >= 0).all()
    assert np.abs(np.cumsum(start.lengths) - np.cumsum(exact.lengths)).max() <= 0.1
    assert np.abs(start.accelerations - exact.accelerations).max() <= 0.1 * extreme.acceleration


@given(st.floats(33, 1e4), st.floats(1.05, 3.0), st.sampled_from(["peak_acceleration", "peak_jerk"]))
def test_extreme_motion_needs_the_least(jerk: float, speed: float, objective: str) -> None:
    problem = replace(PEAK, greatest_ratio=speed, least_ratio=-speed, greatest_jerk=jerk, objective=objective)  # type: ignore[arg-type]
    assume(greatest_reach(1.0, speed, 100.0, jerk) > 1.001)
    extreme = extreme_motion(problem)
    assert extreme is not None
    profile = from_extreme(extreme).profile()
    if objective == "peak_acceleration":
        assert profile.extrema(2)[1].value == pytest.approx(least_acceleration(1.0, 1.0, speed, jerk), rel=1e-9)
    else:
        assert profile.extrema(3)[1].value == pytest.approx(least_jerk(1.0, 1.0, speed, 100.0), rel=1e-9)
    assert float(profile(1.0)) == pytest.approx(1.0, rel=1e-6)


def test_no_extreme_motion_from_moving_ends_or_within_a_stroke() -> None:
    assert extreme_motion(replace(PEAK, end_ratio=0.1)) is None
    assert extreme_motion(replace(PEAK, start_slope=0.1)) is None
    assert extreme_motion(replace(PEAK, end_slope=0.1)) is None
    assert extreme_motion(replace(PEAK, greatest_position=1.0)) is None


@given(
    st.lists(st.one_of(st.just(0.0), st.floats(1e-6, 1.0)), min_size=1, max_size=7).filter(lambda x: sum(x) > 0.1),
    st.integers(30, 200),
)
def test_subdivision_keeps_the_ends_of_the_arcs(raw: list[float], count: int) -> None:
    arcs = np.array(raw) / sum(raw)
    lengths = subdivide(arcs, count)
    assert len(lengths) == count
    assert lengths.sum() == pytest.approx(1.0, abs=1e-12)
    nodes = np.concatenate([[0.0], np.cumsum(lengths)])
    for end in np.cumsum(arcs):
        assert np.abs(nodes - end).min() <= 1e-12


# -- starts in closed form ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("objective", ["peak_acceleration", "rms_acceleration", "peak_jerk"])
@settings(max_examples=15)
@given(st.floats(1.03, 3.0), st.floats(0.05, 2.0), st.floats(0.05, 4.0))
def test_programme_confirms_the_closed_form_and_the_grid_comes_to_the_same(
    objective: str, speed: float, acceleration: float, jerk: float
) -> None:
    problem = replace(
        PEAK,
        objective=objective,  # type: ignore[arg-type]
        greatest_ratio=speed,
        least_ratio=-speed,
        greatest_slope=4 * np.exp(acceleration),
        greatest_jerk=32 * np.exp(jerk),
    )
    assume(greatest_reach(1.0, speed, problem.greatest_slope, problem.greatest_jerk) > 1.001)
    known, iterations = solver._confirmed(problem)
    assert known is not None
    assert iterations < 20
    assert excess(known, problem) <= 5e-10
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(solver, "known_start", lambda _: None)
        by_grid, status, _ = solver._solve_scaled(problem)
    assert status is solver.SolveStatus.OPTIMAL
    assert objective_value(known, problem.objective) == pytest.approx(
        objective_value(by_grid, problem.objective), rel=1e-7
    )


@pytest.mark.parametrize(
    ("change", "arcs"),
    [
        ({"objective": "peak_acceleration"}, ("free", "hold", "fall", "free", "hold", "free")),
        ({"objective": "peak_jerk"}, ("free", "fall", "free", "free")),
        ({"objective": "rms_acceleration"}, ("free", "fall", "free", "free")),
        ({"objective": "rms_acceleration", "greatest_slope": 5.0}, ("free", "hold", "fall", "free", "hold", "free")),
        ({"objective": "rms_acceleration", "greatest_ratio": 1.4}, ("free", "free", "cruise", "free", "free")),
        ({"objective": "peak_acceleration", "greatest_ratio": 1.4}, SEVEN_ARCS),
    ],
)
def test_a_start_has_the_arcs_that_do_not_vanish(change: dict[str, object], arcs: tuple[str, ...]) -> None:
    problem = replace(PEAK, greatest_jerk=200.0, **change)  # type: ignore[arg-type]
    known = known_start(problem)
    assert known is not None
    motion, found = known
    assert found == arcs
    profile = motion.profile()
    assert float(profile(1.0)) == pytest.approx(1.0, rel=1e-9)
    value = objective_value(profile, problem.objective)
    assert value ** (2 if problem.objective == "rms_acceleration" else 1) == pytest.approx(motion.objective, rel=1e-9)


@pytest.mark.parametrize("change", [{"objective": "rms_jerk"}, {"end_ratio": 0.1}, {"start_slope": 1.0}])
def test_no_start_without_a_closed_form(change: dict[str, object]) -> None:
    assert known_start(replace(PEAK, **change)) is None  # type: ignore[arg-type]


# -- quintic structure ----------------------------------------------------------------------------------------------------

JERK = replace(PEAK, objective="rms_jerk", greatest_slope=4.0, greatest_jerk=50.0, greatest_ratio=0.9, least_ratio=-0.9)


def cubic_acceleration(values: list[float]) -> ScaledMotion:
    """Straight lines between the values, as pieces of degree 3 of equal length."""
    a = np.interp(np.arange((len(values) - 1) * 3 + 1) / 3, np.arange(len(values)), values)
    count = len(values) - 1
    return ScaledMotion(np.full(count, 1 / count), a, 0.0)


@pytest.mark.parametrize("touched", [False, True])
def test_arcs_are_told_by_the_active_limit_with_free_pieces_between(touched: bool) -> None:
    # 0.08 at the jerk limit 50 rises by 4: a ramp, a hold at 4, something, and the same down
    lengths = np.array([0.08, 0.12, 0.3, 0.3, 0.12, 0.08])
    a = np.interp(np.arange(19) / 3, np.arange(7), [0.0, 4.0, 4.0, 0.0, -4.0, -4.0, 0.0])
    problem = replace(JERK, greatest_ratio=9.0, least_ratio=-9.0)
    motion, arcs = read_quintic(ScaledMotion(lengths, a, 0.0), problem, touched)
    assert arcs[:3] == ("ramp", "free", "hold")
    assert arcs[-3:] == ("hold", "free", "ramp")
    assert motion.lengths.sum() == pytest.approx(1.0)
    assert motion.lengths[1] == pytest.approx((0.08 + 0.12) / 3)
    assert motion.degree == 3
    if not touched:  # the middle touches the limit at its ends only
        assert arcs[3:-3] == ("free",)


def test_a_touched_limit_ends_a_piece() -> None:
    motion = cubic_acceleration([0.0, 2.0, 4.0, 2.0, 0.0, -2.0, -4.0, -2.0, 0.0])
    problem = replace(JERK, greatest_ratio=9.0, least_ratio=-9.0)
    assert read_quintic(motion, problem, touched=False)[1] == ("free",)
    assert read_quintic(motion, problem, touched=True)[1] == ("free", "hold", "free", "hold", "free")


def test_a_short_cruise_may_be_a_touched_speed() -> None:
    """The speed reaches 0.9 on one interval of ten: read as a cruise and as a point between two free arcs."""
    x = np.linspace(0, 1, 11)
    a = np.interp(np.arange(31) / 30, x, [0, 4, 4, 1, 0.1, 0, 0, -0.1, -1, -4, 0])
    motion = ScaledMotion(np.full(10, 0.1), a, 0.0)
    top = float(motion.nodes()[1].max())
    readings = readings_of(
        motion, replace(JERK, greatest_ratio=top, least_ratio=-9.0, greatest_slope=9.0, greatest_jerk=999.0)
    )
    found = {arcs: start for start, arcs in readings}
    assert ("free", "cruise", "free") in found
    start = found["fall", "free"]
    assert start.lengths == pytest.approx([0.55, 0.45])
    assert start.degree == 3


def test_a_quintic_is_read_without_loss() -> None:
    """On one free piece a cubic acceleration keeps its values."""
    whole = np.array([0.0, 20.0, -20.0, 0.0])
    s = np.linspace(0, 1, 11)
    exact = 60 * s - 180 * s**2 + 120 * s**3
    thirds = []
    for left, right in pairwise(s):
        x = left + (right - left) * np.arange(4) / 3
        v = 60 * x - 180 * x**2 + 120 * x**3
        thirds += [
            v[0],
            (-5 * v[0] + 18 * v[1] - 9 * v[2] + 2 * v[3]) / 6,
            (2 * v[0] - 9 * v[1] + 18 * v[2] - 5 * v[3]) / 6,
        ]
    grid = ScaledMotion(np.full(10, 0.1), np.append(thirds, exact[-1]), 720.0)
    problem = replace(JERK, greatest_ratio=9.0, least_ratio=-9.0, greatest_slope=9.0, greatest_jerk=99.0)
    motion, arcs = read_quintic(grid, problem, touched=True)
    assert arcs == ("free",)
    assert motion.accelerations == pytest.approx(whole, abs=1e-9)


# -- tidying ----------------------------------------------------------------------------------------------------------------


def noisy(motion: ScaledMotion, seed: int, size: float) -> ScaledMotion:
    rng = np.random.default_rng(seed)
    a = motion.accelerations + size * rng.normal(size=len(motion.accelerations))
    a[[0, -1]] = 0.0
    lengths = motion.lengths * (1 + size * rng.normal(size=len(motion.lengths)))
    return ScaledMotion(lengths, a, motion.objective)


@given(st.integers(0, 1000), st.floats(40, 1e5))
def test_tidied_motion_meets_its_ends_to_rounding(seed: int, jerk: float) -> None:
    problem = replace(PEAK, greatest_jerk=jerk)
    extreme = extreme_motion(replace(problem, greatest_jerk=0.9 * jerk))
    assert extreme is not None
    motion = tidy(noisy(from_extreme(extreme), seed, 1e-10), problem)
    profile = motion.profile()
    assert float(profile(1.0)) == pytest.approx(1.0, abs=1e-14)
    assert float(profile(1.0, 1)) == pytest.approx(0.0, abs=1e-13)
    assert excess(profile, problem) <= 5e-10
    assert profile.extrema(3)[1].value <= jerk * (1 + 1e-12)


def test_false_corners_and_vanished_pieces_go() -> None:
    lengths = np.array([0.1, 0.15, 0.0, 0.25, 0.25, 0.0, 0.25])
    level = 16 / 3 * 0.25
    a = np.array([0.0, 0.4 * level, level, level, 0.0, -level, -level, 0.0])
    motion = tidy(ScaledMotion(lengths, a, 0.0), replace(PEAK, height=level * 0.25**2 * 2))
    assert motion.lengths.tolist() == pytest.approx([0.25, 0.5, 0.25])
    assert motion.accelerations.tolist() == pytest.approx([0.0, level, -level, 0.0])


def test_tidying_leaves_a_polished_quintic_as_it_is() -> None:
    """The hull of a long piece's jerk is far wider than its jerk: it must not be taken for a broken limit."""
    # jerk 60, -30, 60 at ends and middle; its Bernstein coefficients are 60, -120, 60
    motion = ScaledMotion(np.ones(1), np.array([0.0, 20.0, -20.0, 0.0]), 720.0)
    problem = replace(PEAK, objective="rms_jerk", greatest_jerk=61.0)
    tidied = tidy(motion, problem)
    assert tidied.lengths == pytest.approx([1.0], abs=1e-15)
    assert tidied.accelerations == pytest.approx([0.0, 20.0, -20.0, 0.0], abs=1e-12)
    two = ScaledMotion(np.array([0.5, 0.5]), np.array([0.0, 10.0, 5.0, 0.0, -5.0, -10.0, 0.0]), 720.0)
    tidied = tidy(two, problem)
    assert tidied.lengths == pytest.approx([0.5, 0.5], abs=1e-12)
    assert piece_coefficients(tidied.accelerations, 3).shape == (2, 4)
