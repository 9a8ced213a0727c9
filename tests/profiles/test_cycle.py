"""`Cut`: where the zones of a cutting cycle lie, with either origin."""

from __future__ import annotations

from dataclasses import FrozenInstanceError, replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from camwright.profiles.cut import Cut

CUT = Cut(
    length=0.6, line_speed=1.5, sync_zone=0.2, shear_zone=0.04, shear_zone_at=0.16, sync_tolerance=1e-4, origin="return"
)


def test_zones_with_the_origin_at_the_return() -> None:
    assert CUT.return_zone == pytest.approx(0.4)
    assert CUT.period == pytest.approx(0.4)
    assert CUT.return_start == 0.0
    assert CUT.sync_start == CUT.return_zone
    assert CUT.sync_parts == ((CUT.return_zone, 0.6),)
    assert CUT.shear_start == pytest.approx(0.56)


def test_zones_with_the_origin_at_the_cut() -> None:
    cut = replace(CUT, origin="cut")
    assert cut.return_zone == CUT.return_zone
    assert cut.return_start == 0.1
    assert cut.sync_start == -0.1
    assert cut.sync_parts == ((0.0, 0.1), (0.5, 0.6))
    assert cut.shear_start == pytest.approx(0.06)


@given(st.floats(0.05, 5), st.floats(0.01, 0.99), st.sampled_from(["return", "cut"]))
def test_zones_fill_the_cycle(length: float, share: float, origin: str) -> None:
    cut = replace(CUT, length=length, sync_zone=share * length, origin=origin)
    parts = cut.sync_parts
    assert sum(end - start for start, end in parts) == pytest.approx(cut.sync_zone, rel=1e-9)
    assert all(0.0 <= start < end <= length for start, end in parts)
    assert cut.sync_zone + cut.return_zone == pytest.approx(length, rel=1e-15)
    # one period on from its start, the sync zone begins again, where the return ends
    assert (cut.return_start + cut.return_zone) % length == pytest.approx(cut.sync_start % length, rel=1e-9)


def test_a_cut_cannot_be_changed() -> None:
    with pytest.raises(FrozenInstanceError):
        CUT.length = 1.0  # type: ignore[misc]
