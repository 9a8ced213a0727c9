"""Bands that cover a range of line speeds: held, overlapping, and as few as a search over all coverings on a grid finds."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camwright.studies.covering import FOUND_TO, MOST_BANDS, Covering, Overlap, Uncovered, cover

STEADY = Overlap(0.05, 0.5, 0.0)


def power(scale: float, exponent: float, top: float) -> float:
    """Least lower end of a band, rising with its upper end: what is asked of a narrower band is asked of a wider one too."""
    return scale * top**exponent


def fewest_on_grid(reach, low: float, high: float, overlap: Overlap, points: int = 400) -> float:
    """Fewest bands with ends on a grid, by trying every band after every other."""
    grid = np.geomspace(high, low, points + 1)
    held = (grid[:, None] >= np.array([reach(top) for top in grid])) & (grid[:, None] < grid)  # end, top
    follows = grid[:, None] >= np.array([overlap.top(end) for end in grid])  # top, end before it
    reached, before = held[:, 0], np.zeros(points + 1, dtype=bool)
    for count in range(1, 60):
        if reached[-1]:
            return count
        if (reached & ~before).sum() == 0:
            break
        before, reached = reached, reached | (held @ (follows @ reached))
    return math.inf


@given(
    st.floats(0.15, 0.8),
    st.floats(0.8, 1.6),
    st.floats(0.05, 0.6),
    st.sampled_from([STEADY, Overlap(0.2, 0.5, 0.0), Overlap(0.05, 0.5, 0.01)]),
)
def test_bands_cover_and_none_are_spared(scale: float, exponent: float, low: float, overlap: Overlap) -> None:
    def reach(top: float) -> float:
        return power(scale, exponent, top)

    def holds(end: float, top: float) -> bool:
        return end >= reach(top)

    found = cover(holds, lambda end, top: not holds(end, top), low, 1.0, overlap)
    fewest = fewest_on_grid(reach, low, 1.0, overlap)
    if isinstance(found, Uncovered):
        assert fewest > MOST_BANDS or overlap.top(reach(found.top)) > found.top * (1.0 - 3.0 * FOUND_TO)
        return
    bands = found.bands
    assert bands[0][0] == low
    assert bands[-1][1] == 1.0
    assert all(holds(*band) for band in bands)
    for slower, faster in itertools.pairwise(bands):
        assert slower[1] == pytest.approx(overlap.top(faster[0]), rel=1e-15)
        assert reach(faster[1]) <= faster[0] <= reach(faster[1]) * (1.0 + 1.01 * FOUND_TO)
    assert found.at_least <= fewest
    assert found.at_least <= len(bands) <= found.at_least + 1
    assert found.fewest == (len(bands) == found.at_least)


def test_what_is_not_shown_is_not_said() -> None:
    def holds(end: float, top: float) -> bool:
        return end >= 0.5 * top

    found = cover(holds, lambda *_: False, 0.1, 1.0, STEADY)
    assert isinstance(found, Covering)
    assert len(found.bands) == 4
    assert found.at_least == 1
    assert not found.fewest


def test_one_band_that_holds_all_is_the_fewest() -> None:
    assert cover(lambda *_: True, lambda *_: False, 0.1, 1.0, STEADY) == Covering(((0.1, 1.0),), 1)


@pytest.mark.parametrize(("scale", "overlap"), [(0.97, STEADY), (0.5, Overlap(0.05, 0.5, 0.6)), (0.93, STEADY)])
def test_bands_too_narrow_or_too_many_are_told_by_the_speed(scale: float, overlap: Overlap) -> None:
    found = cover(lambda end, top: end >= scale * top, lambda end, top: end < scale * top, 0.01, 1.0, overlap)
    assert isinstance(found, Uncovered)
    assert 0.01 < found.top <= 1.0


@given(st.floats(0.01, 0.5), st.floats(0.05, 2.0), st.floats(0.0, 1.0), st.floats(0.02, 2.0))
def test_a_change_is_over_before_a_band_ends(share: float, length: float, ramp: float, low: float) -> None:
    overlap = Overlap(share, length, ramp)
    top = overlap.top(low)
    down, up = overlap.switching(low, top)
    assert low <= down < up <= top
    assert math.sqrt(up**2 + 2.0 * ramp * length) == pytest.approx(top, rel=1e-12)
    assert math.sqrt(max(0.0, down**2 - 2.0 * ramp * length)) == pytest.approx(low, rel=1e-9)
    assert overlap.least(top) == pytest.approx(low, rel=1e-9)
    assert up**2 - down**2 == pytest.approx(((1.0 + share) ** 2 - 1.0) * low**2, rel=1e-6)
