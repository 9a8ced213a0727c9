"""Names of tables: two jobs never share one, in a folder or in a controller, whatever their names."""

from __future__ import annotations

import re

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camwright.profiles.tables.target import Header

LETTERS = st.text(st.sampled_from("aA1- _刀é"), min_size=1, max_size=30)


def identifier(name: str) -> str:
    return Header(name, "1").identifier


@pytest.mark.parametrize(
    "names",
    [
        ("刀具一", "刀具二"),
        ("x-1", "x 1", "x_1", "x--1", "X-1", "x.1"),
        ("a" * 24, "a" * 25, "a" * 60, "a" * 59 + "b"),
        ("café", "cafe\u0301", "caf"),
        ("", "cam", "Cam", "-"),
        ("1", "cam-1", "01"),
    ],
)
def test_names_that_look_alike_have_their_own_tables(names: tuple[str, ...]) -> None:
    assert len({identifier(name).lower() for name in names}) == len(names)


def test_no_name_can_be_written_that_takes_the_identifier_of_another() -> None:
    other = identifier("x 1")
    assert identifier(other.replace("_", "-")) != other


def test_plain_names_stay_as_they_are() -> None:
    assert [identifier(name) for name in ("paper-600", "saw", "m6-4")] == ["paper_600", "saw", "m6_4"]


@settings(deadline=None)
@given(LETTERS, LETTERS)
def test_an_identifier_is_one_and_belongs_to_one_name(one: str, other: str) -> None:
    assert re.fullmatch(r"[A-Za-z](_?[A-Za-z0-9])*", identifier(one))
    assert len(identifier(one)) <= 24
    assert (one == other) is (identifier(one).lower() == identifier(other).lower())
