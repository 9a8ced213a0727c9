"""The rotary knife: what it is to be in sync with it."""

from __future__ import annotations

import math

import numpy as np
import pytest

from camwright.profiles.cut import Cut
from camwright.profiles.errors import InputError
from camwright.profiles.machines import RotaryKnife

CUT = Cut(0.6, 80 / 60, 0.2, 0.04, 0.16, 1e-4)


def test_pitch_is_the_circumference_over_the_blades() -> None:
    assert RotaryKnife(0.4).pitch == 0.4
    assert RotaryKnife(0.4, blades=2).pitch == 0.2


def test_motor_turns_once_a_circumference_and_gear() -> None:
    knife = RotaryKnife(0.4, gear_ratio=5.0)
    assert knife.motor_ratio * knife.circumference == pytest.approx(2 * math.pi * 5.0, rel=1e-14)


def test_sync_zone_is_the_line_of_ratio_one() -> None:
    sync = RotaryKnife(0.4).sync_profile(CUT)
    x = np.linspace(0.0, 0.2, 101)
    assert (sync.start, sync.end) == (0.0, 0.2)
    assert np.array_equal(sync(x), x)
    assert np.array_equal(sync(x, 1), np.ones_like(x))
    assert sync.advance == 0.2


def test_cut_point_is_at_mid_sync_zone() -> None:
    knife = RotaryKnife(0.4)
    assert knife.sync_start(CUT) == -0.1
    assert knife.sync_start(CUT) + float(knife.sync_profile(CUT)(0.1)) == pytest.approx(0.0, abs=1e-16)


def test_horizontal_sync_keeps_the_edge_with_the_material() -> None:
    knife = RotaryKnife(0.4, sync="horizontal")
    cut = Cut(0.6, 80 / 60, 0.1, 0.0, 0.0, 1e-4)
    sync, x = knife.sync_profile(cut), np.linspace(0.0, 0.1, 1001)
    y = knife.sync_start(cut) + sync(x)
    assert np.abs(knife.radius * np.sin(y / knife.radius) - (x - 0.05)).max() <= 1e-12
    # the edge's velocity along the material is the material's
    assert np.abs(sync(x, 1) * np.cos(y / knife.radius) - 1.0).max() <= 1e-9
    assert np.abs(knife.tool(y) - (x - 0.05)).max() <= 1e-12
    assert np.abs(knife.tool_ratio(y) * sync(x, 1) - 1.0).max() <= 1e-9


def test_tangential_mismatch_is_what_the_edge_lacks_along_the_material() -> None:
    knife = RotaryKnife(0.4)
    angle = 0.1 / knife.radius
    assert knife.tangential_mismatch(CUT) == pytest.approx(1 - math.cos(angle), rel=1e-12)


def test_horizontal_sync_over_too_long_a_zone_is_refused() -> None:
    knife = RotaryKnife(0.4, sync="horizontal")
    longest = 2 * knife.radius * math.sin(math.radians(80))
    assert knife.greatest_sync_zone(1.0) == pytest.approx(longest, rel=1e-14)
    with pytest.raises(InputError, match=rf"sync zone = 0\.2 m: takes the blade beyond .*{longest - 1e-6:.6f} m"):
        knife.sync_profile(CUT)
