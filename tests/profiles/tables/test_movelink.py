"""Cycles of Trio's MOVELINK calls: against the ratio integrated by hand, in the forms people write them, and every rejection."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camwright.profiles.errors import InputError
from camwright.profiles.tables.movelink import LAYOUT
from camwright.profiles.tables.targets import detect, read_table

SHEAR = """' flying shear: up to the line, with it, off it, home
BASE(0)
up = 100 : home = -300
WHILE IN(3) = ON
  MOVELINK(50, up, up, 0, 1)      ' half of the way that the material goes
  MOVELINK(200, 200, 0, 0, 1)
  OP(8, ON)
  MOVELINK(50, 100, 0, 100, 1) : MOVELINK(home, 400, 150, 50, 1)
WEND
"""
RATIOS = ((0, 0.0), (100, 1.0), (300, 1.0), (400, 0.0), (550, -1.0), (750, -1.0), (800, 0.0))


def test_a_shear_is_the_integral_of_its_ratio() -> None:
    assert detect(SHEAR, "shear.bas") is LAYOUT
    table = read_table(LAYOUT, SHEAR, "shear.bas")
    profile = LAYOUT.rebuild(table)
    x = np.linspace(0.0, 800.0, 80_001)
    ratio = np.interp(x, *np.array(RATIOS).T)
    naive = np.concatenate([[0.0], np.cumsum(0.5 * (ratio[1:] + ratio[:-1]) * np.diff(x))])
    assert profile(x) == pytest.approx(naive, abs=1e-6)
    assert profile(x, 1)[:-1] == pytest.approx(ratio[:-1], abs=1e-9)
    assert profile(800.0) == pytest.approx(0.0, abs=1e-9)
    assert table.notes == (
        "4 MOVELINK calls in the order of the file are taken as one cycle over a link distance of 800",
    )


@given(st.floats(-500, 500), st.floats(1, 500), st.floats(0, 500), st.floats(0, 500))
def test_one_call_goes_its_distance_and_ramps_are_shortened_in_proportion(
    distance: float, link: float, speeding: float, slowing: float
) -> None:
    text = f"MOVELINK({distance:.17f}, {link:.17f}, {speeding:.17f}, {slowing:.17f}, 1)"
    profile = LAYOUT.rebuild(LAYOUT.read(text, "one.bas"))
    share = min(1.0, link / max(speeding + slowing, 1e-300))
    assert profile(profile.end) == pytest.approx(distance, abs=1e-9)
    assert profile.end == pytest.approx(link)
    half = 0.5 * share * (speeding + slowing)
    peak = max(profile.extrema(1), key=lambda found: abs(found.value)).value
    assert peak == pytest.approx(distance / (link - half), rel=1e-6, abs=1e-9)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("50, up, up, 0, 1", "50, up, up", "line 5: .* has 3 arguments, not 5 or more"),
        ("200, 200, 0, 0, 1", "200, speed*2, 0, 0, 1", "line 6: "),
        ("200, 200, 0, 0, 1", "200, 0, 0, 0, 1", "line 6: MOVELINK over 0, with ramps of 0 and 0, is no motion"),
        ("200, 200, 0, 0, 1", "200, 200, -5, 0, 1", "ramps of -5 and 0, is no motion"),
        ("200, 200, 0, 0, 1)", "200, 200, 0, 0, 1) AXIS(2)", "line 6: the MOVELINK calls move more than one axis"),
        ("MOVELINK(200, 200, 0, 0, 1)", "MOVE(200)", r"line 6: 'MOVE\(200\)' is not read beside MOVELINK calls"),
        ("MOVELINK(200, 200, 0, 0, 1)", "IF a THEN MOVELINK(2, 2, 0, 0, 1)", "is not read beside MOVELINK calls"),
        (
            "MOVELINK(200, 200, 0, 0, 1)",
            "MOVELINK(200, 200, 50, 0, 1)",
            "line 6: MOVELINK begins from standstill while the call before it ends moving",
        ),
    ],
)
def test_what_is_no_cycle_is_refused(old: str, new: str, message: str) -> None:
    assert old in SHEAR
    with pytest.raises(InputError, match=message):
        LAYOUT.read(SHEAR.replace(old, new), "shear.bas")


def test_a_program_without_calls_is_refused() -> None:
    with pytest.raises(InputError, match="there is no call MOVELINK"):
        LAYOUT.read("WAIT IDLE\n", "shear.bas")
