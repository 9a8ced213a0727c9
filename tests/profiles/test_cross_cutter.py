"""The cross-cutter of S2: cases, critical length, the curve where the patent has none, and what is refused."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camwright.profiles.cross_cutter import (
    QUINTIC_RATIO,
    CrossCut,
    quintic_return,
    standstill,
)
from camwright.profiles.cut import Cut
from camwright.profiles.errors import InputError
from camwright.profiles.limits import Limits
from camwright.profiles.machines import RotaryKnife
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.returns import assemble, law_return
from camwright.profiles.task import Task

FREE = Limits(math.inf, math.inf, math.inf)
"""Nothing here asks for limits."""

L_K, L_S = 0.4, 0.2
CRITICAL = CrossCut(L_K, L_S, 1.0).critical_length
HOLE = st.floats(CRITICAL, 0.7)
EXACT = 1e-12


def hermite(conditions: list[tuple[float, int, float]]) -> np.ndarray:
    """Solve for the polynomial whose derivative of an order at X has a value: (X, order, value), ascending powers."""
    size = len(conditions)
    rows = [
        [math.perm(p, order) * X ** (p - order) if p >= order else 0.0 for p in range(size)]
        for X, order, _ in conditions
    ]
    return np.linalg.solve(np.array(rows), np.array([value for *_, value in conditions]))


def normalised(length: float, height: float, X: float) -> tuple[float, float, float]:
    """Y, V, A of S2's normalised return by its boundary conditions, naively."""
    K = height / length

    def at(conditions: list[tuple[float, int, float]], x: float, size: float) -> tuple[float, float, float]:
        poly = np.polynomial.Polynomial(hermite(conditions))
        return size * poly(x / size), poly.deriv()(x / size), poly.deriv(2)(x / size) / size

    if K >= 7 / 15:
        return at([(0, 0, 0), (1, 0, K), (0, 1, 1), (1, 1, 1), (0, 2, 0), (1, 2, 0)], X, 1.0)
    if X > 0.5:
        y, v, a = normalised(length, height, 1.0 - X)
        return K - y, v, -a
    down = [(0, 0, 0), (0, 1, 1), (0, 2, 0), (1, 1, 0), (1, 2, 0)]
    if K > 2 / 5:
        return at([*down, (1, 0, K)], X, 0.5)
    part = 2.5 * K / 2
    return at([*down, (1, 3, 0)], X, part) if part > X else (K / 2, 0.0, 0.0)


def seam_free(cycle: CamProfile) -> None:
    """Check that the cycle goes on in value, ratio and ratio slope, and never reverses."""
    assert max(np.abs(cycle.jumps(order)).max() for order in (0, 1, 2)) < EXACT
    assert cycle.extrema(order=1)[0].value > -EXACT


def test_critical_length_of_the_patent() -> None:
    assert pytest.approx(float(Fraction(2, 10) / Fraction(7, 15) + Fraction(2, 10)), 1e-15) == CRITICAL
    assert pytest.approx(628.5714285714286, abs=1e-9) == CRITICAL * 1e3


@pytest.mark.parametrize(
    ("length", "case", "least", "stand", "marked"),
    [
        (0.3, 1, 1.0, 0.0, False),
        (0.4, 2, 1.0, 0.0, False),
        (math.nextafter(0.4, 1.0), 3, 1.0, 0.0, False),
        (0.6, 3, 0.0625, 0.0, False),
        (0.629, 3, 0.0, 0.0, True),
        (0.6999, 3, 0.0, 0.0, True),
        (0.7, 3, 0.0, 0.0, False),
        (0.9, 3, 0.0, 0.2, False),
    ],
)
def test_cases_of_the_patent(length: float, case: int, least: float, stand: float, marked: bool) -> None:
    cut = CrossCut(L_K, L_S, length)
    assert (cut.case, cut.completed) == (case, marked)
    assert cut.least_ratio == pytest.approx(least, abs=EXACT)
    assert cut.standstill == pytest.approx(stand, abs=EXACT)
    assert cut.cycle().extrema(order=1)[0].value == pytest.approx(least, abs=EXACT)


def test_at_the_critical_length_the_quintic_touches_zero_and_is_not_marked() -> None:
    cut = CrossCut(L_K, L_S, CRITICAL)
    assert not cut.completed
    least = cut.cycle().extrema(order=1)[0]
    assert least.value == pytest.approx(0.0, abs=EXACT)
    assert least.at == pytest.approx(cut.cut_length / 2, abs=1e-9)


def test_at_700_mm_the_standstill_has_no_length() -> None:
    cut = CrossCut(L_K, L_S, 0.7)
    assert cut.standstill == 0.0
    assert cut.cycle().pieces == 4


def test_lengths_in_whole_millimetres_at_the_ends_of_the_hole_are_the_patents_own() -> None:
    for sync in range(10, 200, 7):
        for step in range(1, 40):
            stand, touch = ((sync + a * step, sync + b * step) for a, b in ((2, 5), (7, 15)))
            for circumference, length in (stand, touch):
                cut = CrossCut(circumference / 1000, sync / 1000, length / 1000)
                assert (cut.standstill, cut.completed) == (0.0, False)


def test_the_standstill_stands() -> None:
    cycle = CrossCut(L_K, L_S, 0.9).cycle()
    low, high = cycle.restrict(0.35, 0.55).extrema(0)
    assert low.value == high.value == pytest.approx(L_K / 2, abs=EXACT)


@given(HOLE)
def test_between_the_patents_curves_the_cycle_is_smooth_and_never_reverses(length: float) -> None:
    cut = CrossCut(L_K, L_S, length)
    cycle = cut.cycle()
    seam_free(cycle)
    assert cycle.advance == pytest.approx(L_K, abs=EXACT)
    assert cut.standstill == 0.0
    assert cycle.extrema(order=1)[1].value <= 1.0 + EXACT


def test_between_the_patents_curves_at_many_lengths() -> None:
    for length in np.linspace(CRITICAL, 0.7, 401):
        seam_free(CrossCut(L_K, L_S, float(length)).cycle())


@pytest.mark.parametrize("mean", [Fraction(2, 5), Fraction(3, 7), Fraction(9, 20), Fraction(7, 15)])
def test_the_completion_in_exact_numbers(mean: Fraction) -> None:
    """V = (1 - u)² (1 + 2 u + q u²), q = 30 K - 15: boundary values, mean, and sign by its second factor."""
    q = 30 * mean - 15
    V = [Fraction(1), Fraction(0), q - 3, 2 - 2 * q, q]
    assert V[0] == 1
    assert V[1] == 0
    assert sum(V) == 0
    assert sum(p * c for p, c in enumerate(V)) == 0
    assert sum(c / (p + 1) for p, c in enumerate(V)) == mean
    assert q < 0  # so the second factor is concave and least at an end, where it is 1 or:
    assert 3 + q >= 0
    made = quintic_return(2.0, float(2 * mean))
    ratio = made.coefficients[0, 1:] * np.arange(1, 6)
    if mean < Fraction(7, 15):
        np.testing.assert_allclose(ratio, np.array(V, dtype=float), atol=EXACT)


@pytest.mark.parametrize("mean", [7 / 15, 2 / 5])
def test_the_completion_meets_the_patents_curves_at_both_ends(mean: float) -> None:
    x = np.linspace(0.0, 0.5, 101)
    left, right = quintic_return(0.5, 0.5 * mean * (1 - 1e-11)), quintic_return(0.5, 0.5 * mean * (1 + 1e-11))
    for order in (0, 1, 2):
        np.testing.assert_allclose(left(x, order), right(x, order), atol=1e-7)  # V'' ~ 4 / part, and the parts differ


@given(st.floats(0.05, 3.0), st.floats(0.02, 2.5), st.floats(0.0, 1.0))
def test_the_return_by_its_boundary_conditions(length: float, mean: float, where: float) -> None:
    height = mean * length
    back = quintic_return(length, height)
    y, v, a = normalised(length, height, where)
    x = min(where * length, back.end)
    scale = 1.0 / min(1.0, mean)
    assert float(back(x)) == pytest.approx(y * length, abs=1e-9 * length)
    assert float(back(x, 1)) == pytest.approx(v, abs=1e-9 * scale)
    assert float(back(x, 2)) * length == pytest.approx(a, abs=1e-7 * scale)


@given(st.floats(0.01, 10.0), st.floats(-3.0, 0.0) | st.floats(1e-3, 5.0))
def test_the_return_leaves_and_meets_the_sync_zone(length: float, mean: float) -> None:
    height = mean * length
    back = quintic_return(length, height)
    assert (back.start, back.end) == (0.0, length)
    assert back.advance == pytest.approx(height, abs=EXACT * length)
    for x in (0.0, length):
        assert float(back(x, 1)) == pytest.approx(1.0, abs=1e-11)
        assert float(back(x, 2)) * (min(length, height) if height > 0.0 else length) == pytest.approx(0.0, abs=1e-10)
    if height > 0.0:
        assert back.extrema(order=1)[0].value > -EXACT
        jumps = back.jumps(2)[:-1] * min(length, height)
        assert np.abs(jumps).max(initial=0.0) < 1e-10


@given(st.floats(0.1, 2.0), st.floats(QUINTIC_RATIO, 4.0) | st.floats(-2.0, 0.0))
def test_above_the_critical_ratio_and_for_a_slave_that_comes_back_it_is_the_law_3_4_5(
    length: float, mean: float
) -> None:
    height = mean * length
    if 0.0 < height < length * QUINTIC_RATIO * (1 + 1e-12):
        height = length * QUINTIC_RATIO * (1 + 1e-12)
    x = np.linspace(0.0, length, 50)
    np.testing.assert_allclose(
        quintic_return(length, height)(x), law_return("poly_3_4_5", length, height)(x), atol=1e-13 * length
    )


@given(st.floats(0.05, 2.0), st.floats(0.01, 0.99), st.floats(0.01, 0.99), st.booleans())
def test_any_cut_closes_and_agrees_with_a_return_placed_on_the_knife(
    circumference: float, sync_part: float, cut_part: float, longer: bool
) -> None:
    length = circumference / cut_part if longer else circumference * cut_part
    sync = sync_part * min(circumference, length)
    cross = CrossCut(circumference, sync, length)
    cycle = cross.cycle()
    assert (cycle.start, cycle.end) == (0.0, length)
    assert cycle.advance == pytest.approx(circumference, abs=1e-12 * max(length, circumference))
    assert cycle.extrema(order=1)[0].value == pytest.approx(cross.least_ratio, abs=1e-9)
    cut = Cut(length, 1.0, sync, 0.0, sync / 2, 1e-4, "cut")
    other = assemble(quintic_return(cut.return_zone, circumference - sync), Task(RotaryKnife(circumference), cut, FREE))
    x = np.linspace(0.0, length, 101)
    np.testing.assert_allclose(cycle(x), other(x), atol=1e-11 * max(length, circumference))


def test_equal_lengths_make_one_straight_line() -> None:
    cycle = CrossCut(0.4, 0.2, 0.4).cycle()
    assert cycle.pieces == 1
    assert cycle.advance == 0.4


def test_a_vanishing_sync_zone_has_the_limits_of_the_formulas() -> None:
    cut = CrossCut(0.4, 1e-8, 0.9)
    assert cut.critical_length == pytest.approx(0.4 * 15 / 7, rel=1e-7)
    seam_free(cut.cycle())


@given(st.floats(0.01, 0.99), st.floats(1.0, 9e5), st.booleans())
def test_the_sync_zone_may_be_as_long_or_short_as_messages_say(part: float, factor: float, swap: bool) -> None:
    lengths = (part, part * factor)
    circumference, length = lengths[::-1] if swap else lengths
    for sync in (1e-10 * part, 2 * part * factor):
        with pytest.raises(InputError) as caught:
            CrossCut(circumference, sync, length)
        for fault in caught.value.faults:
            advice = [1e-3 * float(word) for word in fault.split("en it to ")[1:] for word in word.split()[:1]]
            assert len(advice) == 1
            if advice[0] <= min(lengths):  # of two faults the shorter limit counts
                assert CrossCut(circumference, advice[0], length).cycle().advance == pytest.approx(circumference)


@pytest.mark.parametrize(
    ("lengths", "messages"),
    [
        (
            (0.4, 0.4, 0.6),
            [
                "sync zone = 400 mm: not below the circumference of 400 mm, so the knife would turn a whole turn",
                " in sync; shorten it to 399.9999988 mm at most",
            ],
        ),
        (
            (0.4, 0.3, 0.3),
            [
                "sync zone = 300 mm: not below the cut length of 300 mm, so no return zone is left; ",
                "shorten it to 299.9999992 mm at most, or cut longer",
            ],
        ),
        ((0.4, 0.7, 0.6), ["not below the circumference of 400 mm", "not below the cut length of 600 mm"]),
        (
            (0.4, 1e-10, 0.6),
            ["sync zone = 1e-07 mm: below a billionth of 600 mm", "lengthen it to 1.2e-06 mm at least"],
        ),
        (
            (0.4, 1e-8, 1e-7),
            ["cut length below a millionth of the circumference of 400 mm; it must be 0.0004 mm at least"],
        ),
        ((1e-7, 1e-8, 0.4), ["circumference below a millionth of the cut length of 400 mm"]),
        (
            (-0.4, math.nan, math.inf),
            [
                "circumference = -400 mm: outside the range of lengths, 1e-12 m to 1e+12 m",
                "sync zone = nan mm: outside the range",
                "cut length = inf mm: outside the range",
            ],
        ),
        ((0.4, 0.0, 0.6), ["sync zone = 0 mm: outside the range of lengths, 1e-12 m to 1e+12 m"]),
    ],
)
def test_lengths_that_do_not_work_are_refused(lengths: tuple[float, float, float], messages: list[str]) -> None:
    with pytest.raises(InputError) as caught:
        CrossCut(*lengths)
    for message in messages:
        assert message in str(caught.value)


@pytest.mark.parametrize(
    "zone", [(0.0, 0.1), (-1.0, 0.1), (math.inf, 0.1), (math.nan, 0.1), (1e-300, 0.1), (1.0, math.nan), (1.0, -1e300)]
)
def test_a_return_out_of_range_is_refused(zone: tuple[float, float]) -> None:
    with pytest.raises(
        InputError, match=r"the return zone must be 1e-12 m to 1e\+12 m long, and the travel 1e\+12 m at"
    ):
        quintic_return(*zone)


def test_a_return_that_hardly_moves_is_refused_and_the_least_travel_works() -> None:
    with pytest.raises(InputError, match=r"would hardly move; give it 5e-11 m or more to travel"):
        quintic_return(0.5, 4e-11)
    assert quintic_return(0.5, 5e-11).advance == pytest.approx(5e-11, rel=1e-6)


def test_a_slave_that_comes_back_neither_stands_nor_is_marked() -> None:
    assert standstill(0.5, -0.2) == 0.0
    assert quintic_return(0.5, -0.2).extrema(order=1)[0].value < 0.0
