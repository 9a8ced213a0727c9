"""The search for the shortest cut over all sync zones, against landscapes whose least value is known."""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from camwright.profiles.cut import Cut
from camwright.validation.bounds.zone_search import ZoneSearch

PITCH, SHEAR = 0.4, 0.04
CUT = Cut(0.6, 80 / 60, 0.2, SHEAR, 0.16, 1e-4, "cut")


def always(value: float) -> Callable[[float], float]:
    """Say the same of every sync zone."""
    return lambda _: value


ANY = always(0.1)


def search(least: Callable[[float], float], fine: int = 64, lower: Callable[[float], float] = ANY) -> ZoneSearch:
    """Search where a cut holds if it is no shorter than a given least length beside its sync zone."""
    return ZoneSearch(CUT, PITCH, lower, lambda cut: least(cut.sync_zone) - cut.length, fine, 3e-6, 1e-5)


@given(st.floats(0.06, 0.38), st.floats(0.2, 0.35), st.floats(0.2, 5.0))
def test_the_valley_of_a_landscape_is_found(zone: float, length: float, slope: float) -> None:
    found, at = search(lambda tried: length + slope * abs(tried - zone)).find()
    if length > PITCH - 1e-6:
        return
    assert found == pytest.approx(length, abs=3e-6 * PITCH + slope * 2e-5 * PITCH)
    assert at == pytest.approx(zone, abs=2e-5 * PITCH + 3e-6 * PITCH / slope)


@given(st.floats(0.06, 0.2), st.floats(0.25, 0.38), st.floats(0.0, 0.05))
def test_of_two_valleys_the_deeper_is_taken(one: float, other: float, deeper: float) -> None:
    def least(tried: float) -> float:
        return min(0.25 + 2 * abs(tried - one), 0.245 - deeper + 2 * abs(tried - other))

    found, at = search(least).find()
    assert found <= 0.245 - deeper + 5e-5
    assert at == pytest.approx(other, abs=1e-4)


def test_no_length_is_below_that_of_the_shortest_return() -> None:
    found, at = search(always(0.0), lower=lambda zone: 0.3 - 0.5 * (zone - SHEAR)).find()
    assert found == pytest.approx(0.3 - 0.5 * (at - SHEAR), abs=1e-12)
    assert at == pytest.approx(PITCH, rel=1e-2)  # the longest zone has the shortest return here


def test_where_nothing_holds_it_is_the_pitch() -> None:
    assert search(always(1.0)).find() == (PITCH, PITCH)
    assert search(always(0.0), lower=always(0.5)).shorter(0.2, PITCH) is None


def test_a_gain_below_the_resolution_is_no_gain() -> None:
    one = search(always(0.3))
    assert one.shorter(0.2, 0.3 + 1e-6) is None
    assert one.shorter(0.2, 0.31) == pytest.approx(0.3, abs=3e-6 * PITCH)


def test_tried_cuts_have_their_shear_zone_at_the_end_of_the_sync_zone() -> None:
    shape = search(always(0.0)).shape(0.3, 0.1)
    assert (shape.length, shape.sync_zone, shape.shear_zone, shape.origin) == (0.3, 0.1, SHEAR, "return")
    assert shape.shear_zone_at == pytest.approx(0.06)
    assert (shape.line_speed, shape.sync_tolerance) == (CUT.line_speed, CUT.sync_tolerance)


def bisected(excess: Callable[[float], float], low: float, high: float, resolution: float) -> float:
    """Halve a range, whatever it costs: the naive twin."""
    while high - low > resolution:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if excess(middle) <= 0.0 else (middle, high)
    return high


@given(
    st.floats(0.1001, 0.3999),
    st.sampled_from([1e-3, 1.0, 1e6]),
    st.sampled_from(["line", "power", "bent", "cubic", "jump", "sign", "kink"]),
)
def test_the_edge_is_that_of_halving_bit_by_bit_at_fewer_looks(edge: float, size: float, form: str) -> None:
    looks = 0

    def excess(length: float) -> float:
        nonlocal looks
        looks += 1
        off = edge - length
        return {
            "line": size * off,
            "power": size * (edge**8 - length**8),
            "bent": size * (off + off * off),
            "cubic": size * off**3,
            "jump": off + math.copysign(size, off),
            "sign": math.copysign(math.inf, off),
            "kink": off * (size if off > 0 else 1.0),
        }[form]

    one = ZoneSearch(CUT, PITCH, ANY, lambda cut: excess(cut.length), 64, 3e-6, 1e-5)
    found = one.shorter(0.2, PITCH)
    mine, resolution = looks, 3e-6 * PITCH
    looks = 0
    assert found == bisected(excess, 0.1, PITCH - resolution, resolution)
    assert mine <= (looks if form == "sign" else 4 * looks) + 2  # the two ends
    if form in ("line", "bent"):
        assert mine <= 0.75 * looks
