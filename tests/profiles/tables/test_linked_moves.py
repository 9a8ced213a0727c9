"""Cycles of Trio's MOVELINK and FLEXLINK calls: the ratio integrated by hand, the forms people write, every rejection."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camwright.profiles.errors import InputError
from camwright.profiles.tables.linked_moves import LAYOUT
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
        "4 linked moves in the order of the file are taken as one cycle over a link distance of 800",
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


CURVES = {
    0: lambda t: 0.5 * (1 - np.cos(np.pi * t)),
    1: lambda t: t**5 * (126 - 420 * t + 540 * t**2 - 315 * t**3 + 70 * t**4),
    2: lambda t: t**4 * (35 - 84 * t + 70 * t**2 - 20 * t**3),
    3: lambda t: t**3 * (10 - 15 * t + 6 * t**2),
    4: lambda t: t,
}
MANUAL = {0: 1.55, 1: 2.42, 2: 2.16, 3: 1.86, 4: 1.0}
"""Peak acceleration beside a straight ramp, as Trio's reference prints it for the kinds of ramps."""


@pytest.mark.parametrize("kind", CURVES)
def test_a_flexlink_is_an_even_move_and_one_on_it(kind: int) -> None:
    """500 more between 80 and 95 % of 10 000, half of it speeding up: the reference's own example, with each kind of ramp."""
    text = f"BASE(0)\nFLEXLINK(10000, 500, 10000, 80, 5, 50, 50, 1, {kind << 10})\n"
    assert detect(text, "flex.bas") is LAYOUT
    profile = LAYOUT.rebuild(LAYOUT.read(text, "flex.bas"))
    x = np.linspace(0.0, 10_000.0, 100_001)
    up = np.clip((x - 8000.0) / 750.0, 0.0, 1.0)
    ratio = 1.0 + 500.0 / 750.0 * CURVES[kind](np.where(x < 8750.0, up, np.clip((9500.0 - x) / 750.0, 0.0, 1.0)))
    assert profile(x, 1) == pytest.approx(ratio, abs=1e-7)
    naive = np.concatenate([[0.0], np.cumsum(0.5 * (ratio[1:] + ratio[:-1]) * np.diff(x))])
    assert profile(x) == pytest.approx(naive, abs=1e-4)
    peak = max(abs(found.value) for found in profile.extrema(2)) / (500.0 / 750.0 / 750.0)
    assert peak == pytest.approx(MANUAL[kind], rel=0.02)
    assert peak == pytest.approx({0: np.pi / 2, 1: 315 / 128, 2: 35 / 16, 3: 15 / 8, 4: 1.0}[kind], rel=1e-5)


def test_a_flexlink_may_stand_and_a_movelink_may_keep_a_base() -> None:
    """The reference's examples: standing 60 % of the way; from 1 down to 1/3 and on to rest, with curves, in three calls."""
    stands = LAYOUT.rebuild(LAYOUT.read("FLEXLINK(0, 10000, 20000, 60, 0, 50, 50, 1)", "f.bas"))
    assert stands(np.array([0.0, 12_000.0, 16_000.0, 20_000.0])) == pytest.approx([0.0, 0.0, 5000.0, 10_000.0])
    three = "MOVELINK(200, 250, 100, 0, 2, 16)\nMOVELINK(60, 90, 0, 90, 2, 16, 0, 30)\nML(110, 360, 0, 60, 2, 16)\n"
    profile = LAYOUT.rebuild(LAYOUT.read(three, "three.bas"))
    assert profile(np.array([50.0, 100.0, 250.0, 295.0, 340.0, 640.0, 670.0]), 1) == pytest.approx(
        [0.5, 1.0, 1.0, 2 / 3, 1 / 3, 1 / 3, 1 / 6]
    )
    assert profile(700.0) == pytest.approx(370.0)
    assert np.abs(profile.jumps(2, seam=False)).max() < 1e-9


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("50, up, up, 0, 1", "50, up, up", "line 5: .* has 3 arguments, not 5 or more"),
        ("200, 200, 0, 0, 1", "200, speed*2, 0, 0, 1", "line 6: "),
        ("200, 200, 0, 0, 1", "200, 0, 0, 0, 1", "line 6: MOVELINK over 0, with ramps of 0 and 0, is no motion"),
        ("200, 200, 0, 0, 1", "200, 200, -5, 0, 1", "ramps of -5 and 0, is no motion"),
        ("200, 200, 0, 0, 1)", "200, 200, 0, 0, 1) AXIS(2)", "line 6: the linked moves move more than one axis"),
        ("MOVELINK(200, 200, 0, 0, 1)", "MOVE(200)", r"line 6: 'MOVE\(200\)' is not read beside linked moves"),
        ("MOVELINK(200, 200, 0, 0, 1)", "IF a THEN MOVELINK(2, 2, 0, 0, 1)", "is not read beside linked moves"),
        (
            "200, 200, 0, 0, 1",
            "200, 200, 0, 0, 1, 5136",
            "line 6: .* 10 to 12 of the options 5136 ask for the curve 5; there are 0 to 4",
        ),
        ("200, 200, 0, 0, 1", "200, 200, 0, 0, 1, 1.5", "line 6: '1.5' is not a whole number"),
        (
            "MOVELINK(200, 200, 0, 0, 1)",
            "FLEXLINK(200, 0, 200, 0, 0, 50, 50)",
            "line 6: .* has 7 arguments, not 8 or more",
        ),
        (
            "MOVELINK(200, 200, 0, 0, 1)",
            "FLEXLINK(200, 9, 200, 60, 40, 50, 50, 1)",
            "line 6: FLEXLINK over 200, with 60 and 40 % of it left out and ramps of 50 and 50 % of the rest, is no motion",
        ),
        (
            "MOVELINK(200, 200, 0, 0, 1)",
            "FLEXLINK(200, 9, 200, 0, 0, 60, 50, 1)",
            "ramps of 60 and 50 % of the rest, is no motion",
        ),
        (
            "MOVELINK(200, 200, 0, 0, 1)",
            "MOVELINK(200, 200, 0, 50, 1)",
            "line 8: the move begins at the ratio 1 while the ramp before it ends at 0",
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
