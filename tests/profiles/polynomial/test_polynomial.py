"""`CamProfile`: evaluation, extrema and algebra of pieces of polynomials, against scipy and dense sampling."""

from __future__ import annotations

import json
import math
from itertools import pairwise
from typing import Any, Literal

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.integrate import quad
from scipy.interpolate import PPoly

from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import CamProfile, join, steps
from camwright.profiles.polynomial.rows import ascending

FloatArray = NDArray[np.float64]


@st.composite
def profiles(draw: st.DrawFn, continuous: bool = False) -> CamProfile:
    """Draw a profile of one to six pieces of degree up to five, of any length, anywhere; it may jump at its breaks."""
    pieces, degree = draw(st.integers(1, 6)), draw(st.integers(0, 5))
    start = draw(st.floats(-3, 3))
    steps = draw(st.lists(st.floats(0.05, 2.0), min_size=pieces, max_size=pieces))
    numbers = st.floats(-10, 10, allow_subnormal=False)
    row = st.lists(numbers, min_size=degree + 1, max_size=degree + 1)
    table = draw(st.lists(row, min_size=pieces, max_size=pieces))
    profile = CamProfile.from_arrays(start + np.concatenate([[0.0], np.cumsum(steps)]), table)
    if continuous:
        level = profile.coefficients.copy()
        level[1:, 0] -= np.cumsum(profile.jumps(0, seam=False))
        profile = CamProfile(profile.breaks.copy(), level)
    return profile


def inside(profile: CamProfile, count: int = 401) -> FloatArray:
    """Places all over the domain, no breaks among them."""
    x = np.linspace(profile.start, profile.end, count + 2)[1:-1]
    return np.asarray(x[np.abs(x[:, None] - profile.breaks[None, :]).min(axis=1) > 1e-9])


def as_ppoly(profile: CamProfile, order: int = 0) -> PPoly:
    """Give the same function as scipy's."""
    function = PPoly(profile.coefficients[:, ::-1].T, profile.breaks)
    return function.derivative(order) if order else function


def size(profile: CamProfile, order: int = 0) -> float:
    """Largest magnitude that any single term of a derivative reaches: the yardstick for rounding."""
    table = profile._derived(order)
    width = np.diff(profile.breaks)[:, None]
    return float(np.abs(table * width ** np.arange(table.shape[1])).sum(axis=1).max()) + 1e-300


# -- evaluation ---------------------------------------------------------------------------------------------------------


@given(profiles(), st.integers(0, 6))
def test_values_are_those_of_scipy(profile: CamProfile, order: int) -> None:
    x = np.concatenate([inside(profile), profile.breaks])
    assert np.abs(profile(x, order) - as_ppoly(profile, order)(x)).max() <= 1e-13 * size(profile, order)


def test_shape_of_the_positions_is_kept() -> None:
    profile = CamProfile.from_arrays([0.0, 1.0], [[0.0, 1.0]])
    assert profile(np.zeros((2, 3))).shape == (2, 3)
    assert profile(0.5).shape == ()
    assert profile([]).shape == (0,)


def test_break_belongs_to_the_stated_side() -> None:
    profile = CamProfile.from_arrays([0.0, 1.0, 3.0], [[1.0, 1.0], [5.0, -1.0]])
    assert float(profile(1.0)) == 5.0
    assert float(profile(1.0, side="left")) == 2.0
    assert float(profile(1.0, 1)) == -1.0
    assert float(profile(1.0, 1, side="left")) == 1.0
    for side in ("left", "right"):  # beyond the first and the last break there is nothing
        assert float(profile(0.0, side=side)) == 1.0  # type: ignore[arg-type]
        assert float(profile(3.0, side=side)) == 3.0  # type: ignore[arg-type]


@given(profiles(continuous=True), st.integers(-3, 3), st.integers(0, 2))
def test_repeated_cycle_advances_the_slave(profile: CamProfile, turns: int, order: int) -> None:
    x = inside(profile)
    away = profile(x + turns * profile.length, order, outside="repeat")
    expected = profile(x, order) + (turns * profile.advance if order == 0 else 0.0)
    # the shift itself rounds the positions, which moves the value by the steepness
    moved = 8 * np.finfo(float).eps * (abs(profile.start) + 4 * profile.length) * size(profile, order + 1)
    assert np.abs(away - expected).max() <= moved + 1e-12 * size(profile, order)


def test_seam_belongs_to_the_stated_cycle() -> None:
    profile = CamProfile.from_arrays([0.0, 0.5, 1.0], [[0.0, 1.0], [0.5, 3.0]])
    for turn in (-2, 0, 1, 5):
        seam = float(turn)
        assert float(profile(seam, 1, outside="repeat")) == 1.0
        assert float(profile(seam, 1, outside="repeat", side="left")) == 3.0
        assert float(profile(seam, outside="repeat")) == 2.0 * turn
        assert float(profile(seam, outside="repeat", side="left")) == 2.0 * turn


def test_shape_in_numbers() -> None:
    profile = CamProfile.from_arrays([1.0, 2.0, 4.0], [[1.0], [2.0, 0.5, 0.25]])
    assert (profile.start, profile.end, profile.length) == (1.0, 4.0, 3.0)
    assert (profile.pieces, profile.degree) == (2, 2)
    assert profile.advance == 2.0 + 0.5 * 2 + 0.25 * 4 - 1.0


@given(profiles(), st.integers(0, 3))
def test_jumps_are_right_minus_left(profile: CamProfile, order: int) -> None:
    jumps = profile.jumps(order)
    assert len(jumps) == profile.pieces
    step = 1e-9
    across = as_ppoly(profile, order)
    inner = profile.breaks[1:-1]
    naive = np.append(
        across(inner + step) - across(inner - step),
        0.0 if order == 0 else across(profile.start + step) - across(profile.end - step),
    )
    assert np.abs(jumps - naive).max() <= 3 * step * size(profile, order + 1) + 1e-12 * size(profile, order)
    assert np.array_equal(profile.jumps(order, seam=False), jumps[:-1])


# -- extrema and means ---------------------------------------------------------------------------------------------------


@given(profiles(), st.integers(0, 3))
def test_extrema_bound_dense_samples_and_are_reached(profile: CamProfile, order: int) -> None:
    low, high = profile.extrema(order)
    scale = 1e-9 * size(profile, order)
    x = np.concatenate([inside(profile, 4001), profile.breaks])
    values = np.concatenate([profile(x, order), profile(x, order, side="left")])
    assert low.value <= values.min() + scale
    assert high.value >= values.max() - scale
    for extremum in (low, high):
        sides = [float(profile(extremum.at, order, side=side)) for side in ("left", "right")]  # type: ignore[arg-type]
        assert min(abs(value - extremum.value) for value in sides) <= scale


def test_extrema_in_closed_form() -> None:
    quintic = CamProfile.from_arrays([0.0, 1.0], [[0, 0, 0, 10, -15, 6]])
    ratio = quintic.extrema(1)[1]
    assert (ratio.value, ratio.at) == (pytest.approx(15 / 8, rel=1e-14), pytest.approx(0.5, rel=1e-7))
    low, high = quintic.extrema(2)
    assert high.value == pytest.approx(10 / math.sqrt(3), rel=1e-14)
    assert low.value == pytest.approx(-10 / math.sqrt(3), rel=1e-14)
    assert high.at == pytest.approx((3 - math.sqrt(3)) / 6, rel=1e-12)
    low, high = quintic.extrema(3)
    assert (low.value, high.value) == (pytest.approx(-30, rel=1e-14), 60.0)
    assert (low.at, high.at) == (pytest.approx(0.5, rel=1e-12), 0.0)


def test_extremum_at_a_double_root_is_found() -> None:
    flat = CamProfile.from_arrays([0.0, 1.0], [[-(0.3**4), 4 * 0.3**3, -6 * 0.3**2, 4 * 0.3, -1.0]])  # -(x - 0.3)^4
    assert flat.extrema(0)[1].value == pytest.approx(0.0, abs=1e-15)


def test_first_of_equal_extrema_is_named() -> None:
    hold = CamProfile.from_arrays([0.0, 1.0, 2.0, 3.0], [[0.0, 1.0], [1.0], [1.0, -1.0]])
    assert hold.extrema(0)[1].at == 1.0
    assert hold.extrema(0)[0].at == 0.0


@given(profiles(), st.integers(0, 3), st.floats(0.0, 0.45), st.floats(0.55, 1.0))
def test_mean_square_is_that_of_quadrature(profile: CamProfile, order: int, first: float, last: float) -> None:
    start, end = profile.start + first * profile.length, min(profile.end, profile.start + last * profile.length)
    nodes = np.concatenate([[start], profile.breaks[(profile.breaks > start) & (profile.breaks < end)], [end]])
    total = sum(
        quad(lambda x: float(profile(x, order)) ** 2, a, b, epsabs=0, epsrel=1e-10)[0]
        for a, b in pairwise(nodes)
        if b - a > 1e-9
    )
    scale = size(profile, order) ** 2
    assert profile.mean_square(order, start, end) == pytest.approx(total / (end - start), rel=1e-8, abs=1e-8 * scale)


def test_mean_square_in_closed_form() -> None:
    quintic = CamProfile.from_arrays([0.0, 1.0], [[0, 0, 0, 10, -15, 6]])
    assert quintic.mean_square(2) == pytest.approx(120 / 7, rel=1e-14)
    assert quintic.mean_square(3) == pytest.approx(720, rel=1e-14)
    assert quintic.scale(master=2.0, slave=3.0).mean_square(3) == pytest.approx(720 * (3 / 8) ** 2, rel=1e-14)


# -- algebra -------------------------------------------------------------------------------------------------------------


@given(profiles(), st.floats(-5, 5), st.floats(-5, 5))
def test_shift_moves(profile: CamProfile, master: float, slave: float) -> None:
    moved = profile.shift(master, slave)
    x = inside(moved)
    back = np.clip(x - master, profile.start, profile.end)
    near = np.abs(back[:, None] - profile.breaks[None, :]).min(axis=1) > 1e-12
    rounding = 1e-14 * size(profile, 1) * 20 + 1e-13 * (size(profile) + abs(slave))
    assert np.abs(moved(x) - (profile(back) + slave))[near].max() <= rounding


@given(profiles(), st.floats(0.1, 10), st.floats(-10, 10))
def test_scale_stretches(profile: CamProfile, master: float, slave: float) -> None:
    stretched = profile.scale(master, slave)
    x = inside(profile)
    assert np.abs(
        stretched(np.clip(x * master, stretched.start, stretched.end)) - slave * profile(x)
    ).max() <= 1e-12 * (abs(slave) * (size(profile) + size(profile, 1)) + 1e-300)
    back = stretched.scale(1 / master, 1.0)
    assert np.abs(back.coefficients - slave * profile.coefficients).max() <= 1e-12 * (
        abs(slave) * float(np.abs(profile.coefficients).max()) + 1e-300
    )


@given(profiles(), st.floats(-5, 5))
def test_added_line_changes_position_and_ratio_only(profile: CamProfile, slope: float) -> None:
    sum_of_both = profile.add_line(slope)
    x = inside(profile)
    scale = 1e-12 * (size(profile) + 20 * abs(slope))
    assert np.abs(sum_of_both(x) - profile(x) - slope * (x - profile.start)).max() <= scale
    assert np.abs(sum_of_both(x, 1) - profile(x, 1) - slope).max() <= 1e-12 * (size(profile, 1) + abs(slope))
    assert np.array_equal(sum_of_both(x, 2), profile(x, 2))


@given(profiles(), st.floats(0.02, 0.98))
def test_parts_join_to_the_whole(profile: CamProfile, share: float) -> None:
    middle = profile.start + share * profile.length
    whole = join(profile.restrict(profile.start, middle), profile.restrict(middle, profile.end))
    x = inside(profile)
    for order in range(3):
        assert np.abs(whole(x, order) - profile(x, order)).max() <= 1e-11 * size(profile, order)


@given(profiles(continuous=True), st.integers(1, 4))
def test_repeat_strings_cycles_together(profile: CamProfile, cycles: int) -> None:
    many = profile.repeat(cycles)
    assert many.pieces == cycles * profile.pieces
    assert many.length == pytest.approx(cycles * profile.length, rel=1e-12)
    assert many.advance == pytest.approx(cycles * profile.advance, rel=1e-9, abs=1e-11 * size(profile))
    x = inside(profile)
    for n in range(cycles):
        there = np.clip(x + n * profile.length, many.start, many.end)
        assert np.abs(many(there) - profile(x) - n * profile.advance).max() <= 1e-11 * (
            size(profile) + size(profile, 1)
        )


def test_roll_at_the_end_but_for_rounding_is_at_the_start() -> None:
    profile = CamProfile.from_arrays([0.0, 0.3, 0.9], [[0.0, 1.0], [0.3, 1.0]])
    rolled = profile.roll(float(np.nextafter(0.9, 0.0)))
    assert rolled.breaks.tolist() == profile.breaks.tolist()


@given(profiles(continuous=True), st.floats(0.0, 0.999))
def test_roll_begins_elsewhere(profile: CamProfile, share: float) -> None:
    start = profile.start + share * profile.length
    rolled = profile.roll(start)
    assert rolled.start == 0.0
    assert float(rolled(0.0)) == pytest.approx(0.0, abs=1e-11 * size(profile))
    assert rolled.length == pytest.approx(profile.length, rel=1e-12)
    assert rolled.advance == pytest.approx(profile.advance, abs=1e-10 * size(profile))
    x = inside(rolled)
    expected = profile(x + start, outside="repeat") - float(profile(start))
    assert np.abs(rolled(x) - expected).max() <= 1e-10 * (size(profile) + size(profile, 1))


# -- storage -------------------------------------------------------------------------------------------------------------


@given(profiles())
def test_json_gives_back_every_bit(profile: CamProfile) -> None:
    read = CamProfile.from_dict(json.loads(json.dumps(profile.to_dict())))
    assert read.breaks.tobytes() == profile.breaks.tobytes()
    assert read.coefficients.tobytes() == profile.coefficients.tobytes()


def test_profiles_cannot_be_changed() -> None:
    profile = CamProfile.from_arrays([0.0, 1.0], [[0.0, 1.0]])
    with pytest.raises(ValueError, match="read-only"):
        profile.coefficients[0, 0] = 1.0
    with pytest.raises(ValueError, match="read-only"):
        profile.breaks[0] = 1.0


# -- what is refused -----------------------------------------------------------------------------------------------------

RAMP = CamProfile.from_arrays([0.0, 1.0], [[0.0, 1.0]])


@pytest.mark.parametrize(
    ("breaks", "coefficients", "message"),
    [
        (
            [0.0, 1.0, 2.0],
            [[0.0]],
            r"needs n \+ 1 breaks and n rows of coefficients; got breaks \(3,\) and coefficients \(1, 1\)",
        ),
        ([0.0], [], "at least one piece with at least one coefficient"),
        ([0.0, 1.0], [[]], "at least one piece with at least one coefficient"),
        ([0.0, math.nan], [[1.0]], "must be finite numbers; one is NaN or infinite"),
        ([0.0, 1.0], [[math.inf]], "must be finite numbers; one is NaN or infinite"),
        ([0.0, 1.0, 1.0], [[0.0], [0.0]], r"breaks must increase: break 2 \(.*1\.0.* m\) does not lie beyond break 1"),
        ([0.0, 2.0, 1.0], [[0.0], [0.0]], r"breaks must increase: break 2"),
    ],
)
def test_malformed_profiles_are_refused(breaks: list[float], coefficients: list[list[float]], message: str) -> None:
    with pytest.raises(InputError, match=message) as raised:
        CamProfile.from_arrays(breaks, coefficients)
    assert raised.value.exit_code == 2


@pytest.mark.parametrize("x", [-1e-12, 1.0 + 1e-12])
def test_positions_outside_are_refused(x: float) -> None:
    with pytest.raises(InputError, match=r"master position .* m lies outside the profile, 0\.0 to 1\.0 m"):
        RAMP([0.5, x])


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: RAMP(0.5, order=-1), "the order of a derivative must not be negative; got -1"),
        (lambda: RAMP.scale(master=0.0), r"scaled by a positive factor only; got 0\.0"),
        (lambda: RAMP.scale(master=math.nan), "scaled by a positive factor only; got nan"),
        (lambda: RAMP.restrict(0.5, 1.5), r"the part 0\.5 to 1\.5 m does not lie inside the profile, 0\.0 to 1\.0 m"),
        (lambda: RAMP.restrict(0.5, 0.5), r"the part 0\.5 to 0\.5 m does not lie inside"),
        (lambda: RAMP.repeat(0), "repeated once or more often; got 0 cycles"),
        (lambda: RAMP.roll(1.0), r"the new start 1\.0 m does not lie inside the profile, 0\.0 to 1\.0 m"),
        (join, "nothing to join: no profile was given"),
        (lambda: join(RAMP, RAMP), r"profiles do not meet: one ends at 1\.0 m, the next begins at 0\.0 m"),
    ],
)
def test_operations_outside_their_domain_are_refused(call: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        call()


@pytest.mark.parametrize(
    ("data", "message"),
    [
        ([1, 2], "an object with the keys 'breaks' and 'coefficients', and no others"),
        ({"breaks": [0, 1]}, "an object with the keys 'breaks' and 'coefficients', and no others"),
        ({"breaks": [0, 1], "coefficients": [[1]], "more": 1}, "and no others"),
        ({"breaks": ["a", 1], "coefficients": [[1]]}, "must be lists of numbers: could not convert string"),
        ({"breaks": [0, 1, 2], "coefficients": [[1], [1, 2]]}, "must be lists of numbers: "),
        ({"breaks": [0, 1], "coefficients": [[None]]}, "must be (lists of numbers|finite)"),
        ({"breaks": 0, "coefficients": [[1]]}, r"needs n \+ 1 breaks"),
    ],
)
def test_foreign_data_are_refused(data: object, message: str) -> None:
    with pytest.raises(InputError, match=message):
        CamProfile.from_dict(data)


# -- calculus and algebra ----------------------------------------------------------------------------------------------


@given(profiles(), st.integers(1, 4))
def test_derivative_and_integral_are_those_of_scipy(profile: CamProfile, order: int) -> None:
    x = np.concatenate([inside(profile), profile.breaks])
    found = profile.derivative(order)
    assert np.array_equal(found.breaks, profile.breaks)
    assert np.abs(found(x) - as_ppoly(profile, order)(x)).max() <= 1e-13 * size(profile, order)
    area, true = profile.integral(), as_ppoly(profile).antiderivative()
    assert np.abs(area(x) - true(x)).max() <= 1e-13 * size(area)
    assert np.array_equal(area.derivative().coefficients.shape, profile.coefficients.shape)
    assert np.abs(area.derivative()(x) - profile(x)).max() <= 1e-13 * size(profile)


@given(profiles(), profiles())
def test_sum_and_product_are_those_of_the_values(left: CamProfile, right: CamProfile) -> None:
    stretched = (
        right.shift(-right.start).scale(master=left.length / right.length).shift(left.start).over(left.start, left.end)
    )
    breaks = np.union1d(left.breaks, stretched.breaks)
    a, b = left.recut(breaks), stretched.recut(breaks)
    x = inside(a)
    assert np.abs(a.plus(b)(x) - (a(x) + b(x))).max() <= 1e-13 * (size(a) + size(b))
    assert np.abs(a.times(b)(x) - a(x) * b(x)).max() <= 1e-12 * size(a) * size(b)
    if not np.array_equal(left.breaks, breaks):
        with pytest.raises(InputError, match="they have other breaks; recut one"):
            left.plus(b)
        with pytest.raises(InputError, match="they have other breaks; recut one"):
            left.times(b)


@given(profiles(), st.integers(0, 2))
def test_roots_are_where_the_derivative_changes_its_sign(profile: CamProfile, order: int) -> None:
    roots, scale = profile.roots(order), size(profile, order)
    assert (np.diff(roots) > 0).all()
    assert np.abs(profile(roots, order)).max(initial=0.0) <= 1e-9 * scale + 1e-6 * np.abs(
        profile(roots, order + 1)
    ).max(initial=0.0)
    for start, end in pairwise(profile.breaks):
        x = np.linspace(start, end, 203)[1:-1]
        values = profile(x, order)
        turns = np.flatnonzero(
            (values[1:] * values[:-1] < 0) & (np.abs(values[1:]) > 1e-9 * scale) & (np.abs(values[:-1]) > 1e-9 * scale)
        )
        assert all(((roots >= x[i]) & (roots <= x[i + 1])).any() for i in turns)


def test_roots_in_closed_form() -> None:
    rising = CamProfile.from_arrays([0.0, 1.0, 3.0], [[-0.25, 1.0], [0.5, 0.0, -0.5]])
    assert rising.roots() == pytest.approx([0.25, 2.0], abs=1e-15)
    assert CamProfile.from_arrays([0.0, 1.0], [[2.0]]).roots().size == 0
    assert CamProfile.from_arrays([0.0, 1.0], [[0.0, 0.0]]).roots().size == 0


def test_recut_and_split() -> None:
    wave = CamProfile.from_arrays([0.0, 0.4, 1.0], [[0.0, 1.0, 2.0, -3.0], [0.528, 1.16, -1.6, 2.0]])
    x = np.linspace(0.0, 1.0, 101)
    assert np.abs(wave.recut(np.array([0.0, 0.1, 0.4, 0.77, 1.0]))(x) - wave(x)).max() <= 1e-15
    finer = wave.split(np.array([0.3, 0.3 + 1e-15, 0.4 + 1e-15, 0.9]))
    assert finer.breaks.tolist() == [0.0, 0.3, 0.4, 0.9, 1.0]
    assert wave.split(np.zeros(0)) is wave


@given(profiles(), st.floats(-1e-10, 1e-10), st.floats(-1e-10, 1e-10))
def test_ends_are_put_where_they_belong_to_the_last_bit(profile: CamProfile, first: float, last: float) -> None:
    start, end = profile.start + first * profile.length, profile.end + last * profile.length
    placed = profile.over(start, end)
    assert (placed.start, placed.end) == (start, end)
    assert np.array_equal(placed.breaks[1:-1], profile.breaks[1:-1])
    assert np.array_equal(placed.coefficients, profile.coefficients)
    for wrong in ((start, end + 1e-8 * profile.length), (start - 1e-8 * profile.length, end)):
        with pytest.raises(InputError, match="must be there but for rounding; scale it first"):
            profile.over(*wrong)


def test_pieces_beyond_an_end_that_is_moved_fall_away() -> None:
    sliver = CamProfile.from_arrays([0.0, 1e-12, 1.0, 1.0 + 1e-12], [[0.0, 1.0], [1e-12, 2.0], [2.0, 3.0]])
    placed = sliver.over(1e-12, 1.0)
    assert (placed.breaks.tolist(), placed.coefficients.tolist()) == ([1e-12, 1.0], [[1e-12, 2.0]])


def test_pieces_answer_by_their_number() -> None:
    profile = CamProfile.from_arrays([0.0, 1.0, 3.0], [[1.0, 1.0], [5.0, -1.0, 0.0, 2.0]])
    assert profile.holding(np.array([-1.0, 0.0, 1.0, 3.0])).tolist() == [0, 0, 1, 1]
    assert profile.on_pieces(np.array([[0], [1]]), np.array([[0.0, 1.0], [0.0, 1.0]])).tolist() == [
        [1.0, 2.0],
        [5.0, 6.0],
    ]
    assert profile.on_pieces(np.array([1, 0]), np.array([1.0, 1.0]), 1).tolist() == [5.0, 1.0]
    assert profile.within_degree(1).tolist() == [True, False]
    assert profile.within_degree(3).tolist() == [True, True]
    assert profile.mean_ratio == profile.advance / 3.0
    assert steps(profile.breaks, np.array([2.0, 7.0]))(np.array([0.5, 1.0, 2.0])).tolist() == [2.0, 7.0, 7.0]


def test_a_roll_to_the_end_but_for_rounding_is_none() -> None:
    profile = CamProfile.from_arrays([0.0, 0.3, 0.6], [[0.0, 1.0], [0.3, 0.5]])
    rolled = profile.roll(np.nextafter(0.6, 0.0))
    assert rolled.breaks.tolist() == profile.breaks.tolist()
    assert rolled.repeat(3).length == pytest.approx(1.8)


@given(profiles(), st.integers(0, 5), st.sampled_from(["left", "right"]))
def test_one_place_has_the_value_that_it_has_among_others(
    profile: CamProfile, order: int, side: Literal["left", "right"]
) -> None:
    places = np.concatenate([profile.breaks, 0.5 * (profile.breaks[1:] + profile.breaks[:-1])])
    assert [float(profile(x, order, side=side)) for x in places.tolist()] == profile(places, order, side=side).tolist()
    assert profile(float(profile.end), outside="repeat") == profile(np.array([profile.end]), outside="repeat")[0]


@given(st.lists(st.sampled_from([0.0, 1.0, 2.5, -3.0, 1e-9])))
def test_numbers_ascend_each_once(numbers: list[float]) -> None:
    assert ascending(np.array(numbers)).tolist() == np.unique(np.array(numbers)).tolist()
