"""What physics forbids: when a job is refused, what binds, by how much, and what works instead."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camwright.design.feasible.feasibility import edge, feasible_lengths, is_feasible, shortest_length
from camwright.design.feasible.refusal import require_feasible
from camwright.profiles.closed_forms.reach import greatest_reach
from camwright.profiles.cut import Cut
from camwright.profiles.errors import InfeasibleError, Suggestion
from camwright.profiles.limits import Limits
from camwright.profiles.machines import RotaryKnife
from camwright.profiles.message import rounded_to
from camwright.profiles.task import Task

KNIFE = RotaryKnife(0.4)
CUT = Cut(0.3, 1.0, 0.1, 0.0, 0.0, 1e-4)  # 0.3 m of knife in 0.2 s: 0.1 m over the line
LIMITS = Limits(2.5, 30.0, 3000.0)


def refusal(machine: RotaryKnife, cut: Cut, limits: Limits) -> InfeasibleError:
    with pytest.raises(InfeasibleError) as raised:
        require_feasible(Task(machine, cut, limits))
    assert raised.value.exit_code == 3
    return raised.value


@settings(max_examples=200)
@given(st.floats(-1, 1), st.floats(0.05, 0.9), st.floats(1.0, 4.0), st.floats(0, 6), st.floats(3, 14), st.booleans())
def test_feasible_is_what_the_reach_allows(
    off: float, share: float, speed: float, acceleration: float, jerk: float, reversal: bool
) -> None:
    """The return is the line plus a motion from rest to rest, ahead of it or behind it."""
    length = 0.4 * math.exp(off)
    cut = replace(CUT, length=length, sync_zone=share * min(length, 0.4))
    limits = Limits(speed, math.exp(acceleration), math.exp(jerk), reversal)
    distance, room = abs(0.4 - length), speed - 1.0
    if length > 0.4:
        room = 1.0 + (speed if reversal else 0.0)
    reach = greatest_reach(cut.return_zone, max(room, 1e-300), limits.acceleration, limits.jerk)
    if abs(reach / max(distance, 1e-300) - 1) < 1e-9:
        return
    assert is_feasible(Task(KNIFE, cut, limits)) == (reach >= distance)


@pytest.mark.parametrize(
    ("limits", "binding", "needed"),
    [
        (Limits(1.55, 30.0, 3000.0), "speed", None),
        (Limits(2.5, 10.2, 3000.0), "acceleration", None),
        (Limits(4.0, 1e3, 390.0), "jerk", 32 * 0.1 / 0.2**3),
    ],
)
def test_the_binding_limit_is_named_with_what_is_missing(limits: Limits, binding: str, needed: float | None) -> None:
    error = refusal(KNIFE, CUT, limits)
    assert error.binding == binding
    assert error.excess is not None
    assert error.excess > 0
    factor = 60.0 if binding == "speed" else 1.0
    least = getattr(limits, binding) + error.excess / factor
    if needed is not None:
        assert least == pytest.approx(needed, rel=1e-9)
    assert is_feasible(Task(KNIFE, CUT, replace(limits, **{binding: least * (1 + 1e-9)})))
    assert not is_feasible(Task(KNIFE, CUT, replace(limits, **{binding: least * (1 - 1e-6)})))
    assert f"{binding} binds" in str(error)
    assert error.unit in str(error)
    assert "length 0.3 m at line speed 1 m/s, sync zone 0.1 m" in str(error)


def test_the_refusal_offers_changes_that_work_and_are_the_nearest() -> None:
    limits = Limits(1.55, 30.0, 3000.0)
    error = refusal(KNIFE, CUT, limits)
    offers = {suggestion.change: suggestion for suggestion in error.suggestions}
    assert {"line_speed", "length", "speed"} <= set(offers)
    slower = offers["line_speed"]
    assert slower.unit == "m/min"
    assert is_feasible(Task(KNIFE, replace(CUT, line_speed=slower.value / 60), limits))
    assert not is_feasible(Task(KNIFE, replace(CUT, line_speed=1.002 * slower.value / 60), limits))
    longer = offers["length"]
    assert longer.unit == "mm"
    assert 300 < longer.value < 400
    assert is_feasible(Task(KNIFE, replace(CUT, length=longer.value / 1e3), limits))
    assert not is_feasible(Task(KNIFE, replace(CUT, length=0.998 * longer.value / 1e3), limits))
    for suggestion in error.suggestions:
        if suggestion.change != "reversal":
            assert f'"{suggestion.value:.15g} {suggestion.unit}"' in str(error)


def test_a_cut_so_long_that_the_knife_would_run_backwards() -> None:
    cut = replace(CUT, length=2.4, sync_zone=0.3)
    for limits in (Limits(2.0, 30.0, 300.0), Limits(2.0, 3.6, 30.0)):
        if is_feasible(Task(KNIFE, cut, limits)):
            continue
        error = refusal(KNIFE, cut, limits)
        for suggestion in error.suggestions:
            if suggestion == Suggestion("reversal", 1.0, ""):
                assert is_feasible(Task(KNIFE, cut, replace(limits, reversal=True)))


def test_reversal_is_offered_where_it_alone_works() -> None:
    """Standing still is not enough: 1.6 m behind the line in 1.7 s, with ramps that need their time."""
    cut, limits = replace(CUT, length=2.0, sync_zone=0.3), Limits(2.0, 8.0, 60.0)
    assert not is_feasible(Task(KNIFE, cut, limits))
    assert is_feasible(Task(KNIFE, cut, replace(limits, reversal=True)))
    error = refusal(KNIFE, cut, limits)
    assert Suggestion("reversal", 1.0, "") in error.suggestions
    assert "reversal = true" in str(error)


def test_speed_limit_below_the_line() -> None:
    error = refusal(KNIFE, CUT, Limits(0.9, 30.0, 3000.0))
    assert error.binding == "speed"
    for suggestion in error.suggestions:
        if suggestion.change == "line_speed":
            assert suggestion.value / 60 < 0.9


def test_a_job_that_needs_everything_says_what_works() -> None:
    """Too fast in every respect: no limit alone would do, but a slower line or a longer cut does."""
    error = refusal(KNIFE, CUT, Limits(1.05, 1.0, 10.0))
    assert {"line_speed", "length"} <= {suggestion.change for suggestion in error.suggestions}
    assert error.excess is None
    assert "no other value of it alone would do" in str(error)


@given(st.floats(1.0, 1e6), st.floats(1e-6, 0.999999))
def test_edge_is_the_last_value_that_works(bad: float, share: float) -> None:
    threshold = share * bad
    found = edge(lambda x: x <= threshold, 0.0, bad)
    assert found == pytest.approx(threshold, rel=1e-14)
    assert found is not None
    assert found <= threshold


def test_edge_where_nothing_works() -> None:
    assert edge(lambda _: False, 0.0, 1.0) is None


@given(st.floats(1e-6, 1e9), st.integers(3, 9), st.booleans())
def test_rounding_goes_one_way(value: float, digits: int, up: bool) -> None:
    rounded = rounded_to(value, digits, up)
    assert rounded == pytest.approx(value, rel=10.0 ** (1 - digits) * 1.0001)
    slack = 1e-6 * 10.0 ** (1 - digits) * 1.01  # what already stands on the digit stays there
    assert rounded >= value * (1 - slack) if up else rounded <= value * (1 + slack)
    assert float(f"{rounded:.{digits}g}") == pytest.approx(rounded, rel=1e-12)


@pytest.mark.parametrize("line_speed", [0.5, 1.0, 2.0])
def test_the_shortest_cut_is_the_same_for_every_cut_length(line_speed: float) -> None:
    tasks = [Task(KNIFE, replace(CUT, length=length, line_speed=line_speed), LIMITS) for length in (0.3, 0.41, 0.9)]
    shortest = shortest_length(tasks[0])
    assert shortest is not None
    assert [shortest_length(task) for task in tasks] == [shortest] * 3
    works = feasible_lengths(tasks[1])
    assert works(shortest)
    assert not works(math.nextafter(shortest, 0.0))
    assert edge(works, 4.0, CUT.sync_zone) == pytest.approx(shortest, rel=1e-14)


def test_no_shortest_cut_is_told_where_no_limits_are_enough() -> None:
    assert shortest_length(Task(KNIFE, CUT, replace(LIMITS, speed=0.5))) is None
