"""Quantities with units: read exactly, refused clearly, never evaluated."""

from __future__ import annotations

import math
import subprocess
import sys
import time
from fractions import Fraction

import pytest
import unit_table
from hypothesis import given
from hypothesis import strategies as st

from camwright.house.units import KINDS, quantity, shown
from camwright.profiles.errors import InputError


@pytest.mark.parametrize(
    ("text", "kind", "value"),
    [
        ("600 mm", "length", 600 / 1000),
        ("24 in", "length", 24 * 127 / 5000),
        ("2 ft", "length", 2 * 381 / 1250),
        ("9 mm", "length", 9 / 1000),
        ("0.5 µm", "length", 0.5e-6),
        ("80 m/min", "speed", 80 / 60),
        ("80 m / min", "speed", 80 / 60),
        ("1.2e3 mm/s", "speed", 1.2),
        ("30 m/s^2", "acceleration", 30.0),
        ("30 m/s²", "acceleration", 30.0),
        ("30 m/s/s", "acceleration", 30.0),
        ("30 m*s**-2", "acceleration", 30.0),
        ("30 m·s⁻²", "acceleration", 30.0),
        ("3000 m/s^3", "jerk", 3000.0),
        ("4 ms", "time", 0.004),
        ("120 rad/s", "angular rate", 120.0),
        ("1 rpm", "angular rate", float(Fraction("3.14159265358979323846") / 30)),
        ("35 1/s", "gain", 35.0),
        ("35 /s", "gain", 35.0),
        ("35 s^-1", "gain", 35.0),
        ("90 deg", "angle", math.pi / 2),
        (" 90 ° ", "angle", math.pi / 2),
        ("+.5 rev", "angle", math.pi),
        ("2000 rad/s^2", "angular acceleration", 2000.0),
        ("50000 rad/s³", "angular jerk", 50000.0),
        ("20 kg", "mass", 20.0),
        ("250 g", "mass", 0.25),
        ("10 lb", "mass", 4.5359237),
        ("0.05 kg m^2", "inertia", 0.05),
        ("0.05 kg*m^2", "inertia", 0.05),
        ("0.05 kg·m²", "inertia", 0.05),
        ("500 kg cm^2", "inertia", 0.05),
        ("12 N m", "torque", 12.0),
        ("12 N*m", "torque", 12.0),
        ("12 Nm", "torque", 12.0),
        ("12 kg m^2/s^2", "torque", 12.0),
        ("12000 N mm", "torque", 12.0),
    ],
)
def test_a_quantity_is_the_float_nearest_to_its_value(text: str, kind: str, value: float) -> None:
    assert quantity(text, kind) == value


@given(st.integers(1, 10**9), st.integers(0, 6))
def test_millimetres_are_rounded_once(digits: int, places: int) -> None:
    text = f"{digits / 10**places:.{places}f}"
    exact = Fraction(text) / 1000
    if KINDS["length"].least <= exact <= KINDS["length"].greatest:
        assert quantity(f"{text} mm", "length") == float(exact)


@pytest.mark.parametrize("kind", KINDS)
def test_every_example_is_of_its_kind_and_of_no_other(kind: str) -> None:
    assert quantity(KINDS[kind].example, kind) > 0
    for other in KINDS.keys() - {kind}:
        with pytest.raises(InputError, match=f"{KINDS[kind].name}, but {KINDS[other].name} is expected"):
            quantity(KINDS[kind].example, other)


@pytest.mark.parametrize(
    ("value", "kind", "message"),
    [
        (200, "speed", '200: a number without a unit; write e.g. "200 m/min"'),
        (0.5, "length", '0.5: a number without a unit; write e.g. "0.5 mm"'),
        ("5", "length", "'5': a number without a unit; write e.g. \"5 mm\""),
        (float("nan"), "length", 'nan: a number without a unit; write e.g. "600 mm"'),
        pytest.param(10**5000, "length", "an integer of more than 60 digits: a number without a unit", id="huge"),
        (True, "length", 'True: not a length with a unit; write e.g. "600 mm"'),
        (["1 m"], "length", "['1 m']: not a length with a unit"),
        ("", "length", "'': not a length, a finite number and a unit"),
        ("nan m", "length", "'nan m': not a length, a finite number and a unit"),
        ("inf m", "length", "'inf m': not a length, a finite number and a unit"),
        ("1e999 m", "length", "'1e999 m': outside the range of a length, 1e-09 to 1e+06 m"),
        ("1e-999 m", "length", "'1e-999 m': outside the range of a length"),
        ("-3 m", "length", "'-3 m': negative; a length greater than zero is expected"),
        ("0 mm", "length", "'0 mm': zero; a length greater than zero is expected"),
        ("5 m", "speed", "'5 m': a length, but a speed is expected"),
        ("5 m^2", "length", "'5 m^2': a quantity in length^2, but a length is expected"),
        ("5 m/m", "length", "'5 m/m': a number without dimension, but a length is expected"),
        ("120 1/s", "angular rate", "'120 1/s': a gain, but an angular rate is expected"),
        ("20 degC", "length", "'20 degC': there is no unit 'degC'"),
        ("3 mmm", "length", "'3 mmm': there is no unit 'mmm'"),
        ("3 м", "length", "'3 м': there is no unit 'м'"),
        ("٣ m", "length", "'٣ m': not a length, a finite number and a unit"),
        ("1_0 m", "length", "'1_0 m': '_0 m' is not a unit"),
        ("3 m m", "length", "'3 m m': a quantity in length^2, but a length is expected"),
        ("3 m/s s", "length", "'3 m/s s': 'm/s s' is not a unit"),
        ("3 1/s m", "speed", "'3 1/s m': '1/s m' is not a unit"),
        ("12 kg", "torque", "'12 kg': a mass, but a torque is expected; write e.g. \"12 N m\""),
        ("5 11/s", "gain", "'5 11/s': '11/s' is not a unit"),
        ("10**10**10 m", "length", "'10**10**10 m': '**10**10 m' is not a unit"),
        ("1 m**9**9", "length", "'1 m**9**9': 'm**9**9' is not a unit"),
        ("3 __import__('os')", "length", "is not a unit"),
        ("x" * 10_000, "length", "longer than 100 characters"),
        ("\x1b[31m3 m", "length", r"'\x1b[31m3 m': not a length"),
    ],
)  # fmt: skip
def test_what_is_no_quantity_is_refused_with_the_way_out(value: object, kind: str, message: str) -> None:
    with pytest.raises(InputError) as caught:
        quantity(value, kind)
    assert message in str(caught.value)
    assert "write e.g. " in str(caught.value)
    assert len(str(caught.value)) < 250


def test_zero_is_read_where_it_is_allowed() -> None:
    assert quantity("0 mm", "length", zero=True) == 0.0
    with pytest.raises(InputError, match=r"negative; a length not below zero is expected"):
        quantity("-1 mm", "length", zero=True)


def test_signs_are_read_where_they_are_allowed() -> None:
    assert [quantity(text, "length", signed=True) for text in ("-20 mm", "0 mm", "20 mm")] == [-0.02, 0.0, 0.02]
    with pytest.raises(InputError, match=r"outside the range of a length"):
        quantity("-1e9 m", "length", signed=True)


def test_the_example_in_messages_can_be_chosen() -> None:
    with pytest.raises(InputError, match=r'300: a number without a unit; write e\.g\. "300 rpm"'):
        quantity(300, "angular rate", example="120 rpm")


@given(st.text(max_size=200) | st.text("0123456789eE+-.*/^ ·mskin()[]1²³⁻°\\\x00\n", max_size=120))
def test_any_text_is_read_or_refused_at_once(text: str) -> None:
    begun = time.perf_counter()
    try:
        value, message = quantity(text, "length"), ""
    except InputError as error:
        value, message = 1.0, str(error)
    assert time.perf_counter() - begun < 1.0
    assert KINDS["length"].least <= value <= KINDS["length"].greatest
    assert message.isprintable()


def test_shown_values_are_one_short_printable_line() -> None:
    for value in ("a\nb", "\x1b[0m", "x" * 500, ["y" * 500], 10**5000, "ü"):
        assert shown(value).isprintable()
        assert len(shown(value)) <= 60


def test_the_units_are_those_that_pint_makes_of_the_definitions() -> None:
    assert unit_table.FILE.read_text(encoding="utf-8") == unit_table.written()


def test_no_command_loads_pint() -> None:
    code = (
        "import sys; from camwright.house.units import quantity; quantity('600 mm', 'length'); "
        "sys.exit(any(name in sys.modules for name in ('pint', 'dask')))"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


@pytest.mark.parametrize(
    ("text", "value"), [("5 kgram", 5.0), ("5 kilog", 5.0), ("5 g", 0.005), ("2 lb", 0.90718474), ("3 mg", 3e-6)]
)
def test_masses_under_all_their_names(text: str, value: float) -> None:
    """An unusual name of the kilogram once made pint define it by itself, and every mass after it crashed."""
    assert quantity(text, "mass") == value
    assert quantity("1 kg", "mass") == 1.0


def test_hertz_counts_turns_and_fpm_is_feet_per_minute() -> None:
    assert quantity("19.0986 Hz", "angular rate") == pytest.approx(2 * math.pi * 19.0986, rel=1e-15)
    assert quantity("0.02 kHz", "angular rate") == quantity("1200 rpm", "angular rate")
    assert quantity("260 fpm", "speed") == quantity("260 ft/min", "speed")


@pytest.mark.parametrize(
    ("text", "kind", "told"),
    [
        (
            "35 Hz",
            "gain",
            'hertz counts turns, and a gain has none; write "35 1/s" or, if turns are meant, "219.9 1/s"',
        ),
        ("600,5 mm", "length", 'a comma in the number; write "600.5 mm"'),
        ("0,6 m", "length", 'a comma in the number; write "0.6 m"'),
        (",5 mm", "length", 'a comma in the number; write "0.5 mm"'),
        ("1,200 mm", "length", 'write "1.200 mm" for a fraction, "1200 mm" for thousands'),
    ],
)
def test_what_was_meant_is_told_as_it_is_written(text: str, kind: str, told: str) -> None:
    with pytest.raises(InputError) as caught:
        quantity(text, kind)
    assert str(caught.value).startswith(repr(text))
    assert told in str(caught.value)
