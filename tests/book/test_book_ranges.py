"""Ranges of lengths and speeds: exact values, units, every refusal."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camwright.book.ranges import MOST_VALUES, parse_range
from camwright.profiles.errors import InputError


def lengths(text: str) -> tuple[Fraction, ...]:
    return tuple(parse_range(text, "--length", "length", "mm"))


@settings(deadline=None)
@given(start=st.integers(1, 5000), step=st.integers(1, 500), count=st.integers(1, 60), rest=st.integers(0, 499))
def test_a_range_holds_start_and_stop_and_every_step(start: int, step: int, count: int, rest: int) -> None:
    # tenths of a millimetre, so that steps are no binary fractions
    last = start + (count - 1) * step
    stop = last + min(rest, step - 1)
    found = lengths(f"{start / 10}:{stop / 10}:{step / 10}")
    assert found == tuple(Fraction(tenths, 10_000) for tenths in range(start, stop + 1, step))
    assert found[-1] == Fraction(last, 10_000)


@pytest.mark.parametrize("text", ["250mm:1200mm:10mm", "0.25 m:1.2 m:10", "250:1200:10", " 25 cm : 120cm : 0.01m "])
def test_units_may_be_mixed(text: str) -> None:
    assert lengths(text) == tuple(Fraction(value, 1000) for value in range(250, 1201, 10))


def test_one_value_is_a_range() -> None:
    assert lengths("600") == lengths("600:600:10") == lengths("60 cm") == (Fraction(3, 5),)


def test_speeds_are_metres_a_minute() -> None:
    assert tuple(parse_range("40:120:20", "--line-speed", "speed", "m/min")) == tuple(
        Fraction(value, 60) for value in (40, 60, 80, 100, 120)
    )


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("250:1200", "not start:stop:step and not one value; write e.g. 600:1200:10 (mm) or 600"),
        ("1:2:3:4", "not start:stop:step"),
        ("", "not a length"),
        ("250 s:1200:10", "--length, start: '250 s': a time, but a length is expected"),
        ("250:1200:0", "--length, step: '0 mm': zero; a length greater than zero is expected"),
        ("250:1200:-10", "--length, step: '-10 mm': negative"),
        ("1200:250:10", "the start lies beyond the stop; write the smaller value first, 250:1200:10"),
        ("1:2000:1", f"2000 values, the limit is {MOST_VALUES}; take a step of at least 0.002001 m"),
        ("a:b:c", "--length, start: 'a': not a length"),
        ("250:nan:10", "--length, stop: 'nan': not a length"),
        ("1e99:2e99:1e98", "outside the range of a length"),
    ],
)
def test_what_is_no_range_is_refused(text: str, words: str) -> None:
    with pytest.raises(InputError) as caught:
        lengths(text)
    assert words in str(caught.value)
    assert str(caught.value).startswith("--length")


def test_every_part_that_is_wrong_is_named() -> None:
    with pytest.raises(InputError) as caught:
        lengths("250 s:1200 kg:x")
    assert [fault.split(":")[0] for fault in caught.value.faults] == [
        "--length, start",
        "--length, stop",
        "--length, step",
    ]
