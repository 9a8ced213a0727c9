"""Reading settings files: numbers by their place, all faults at once, each with its place."""

from __future__ import annotations

from typing import Annotated, Literal

import pytest
from pydantic import Field

from camwright.house.setting_fields import (
    Settings,
    Table,
    line_field,
    number_field,
    quantity_field,
    row_field,
    whole_field,
)
from camwright.house.settings import read_settings
from camwright.house.toml_file import toml_data
from camwright.profiles.errors import InputError


class Inner(Table):
    """A table in a table."""

    _place = "left.inner"

    length: Annotated[float, *quantity_field("length")] = 0.25


class Left(Table):
    """One table."""

    _place = "left"

    length: Annotated[float, *quantity_field("length")]
    share: Annotated[float, number_field(0.0, 1.0, "from 0 to 1", "0.5")] = 0.5
    inner: Inner | None = None


class Round(Table):
    """One kind of a table."""

    _place = "shape"

    kind: Literal["round"]
    length: Annotated[float, *quantity_field("length")] = 7.0


class Square(Table):
    """Another kind."""

    _place = "shape"

    kind: Literal["square"]
    corners: Annotated[int, whole_field(1, 4, 2)]


class Entry(Table):
    """One of several tables that share a name."""

    pairs: list[Annotated[tuple[float, float], row_field("length", "angle")]]


class File(Table):
    """A file."""

    name: Annotated[str, *line_field("mine")]
    left: Left
    shape: Annotated[Round | Square, Field(discriminator="kind")]
    entry: Annotated[list[Entry], Field(min_length=1)]


RIGHT = """
name = "a"
[left]
length = "1 m"
[left.inner]
[shape]
kind = "round"
[[entry]]
pairs = [["1 mm", "0 deg"]]
"""


def read(text: str) -> tuple[File | None, Settings, list[str]]:
    settings = Settings()
    file, faults = read_settings(File, toml_data(text, "x.toml", "settings file"), settings)
    return file, settings, faults


def test_keys_of_the_same_name_are_kept_apart_defaults_too() -> None:
    file, settings, faults = read(RIGHT)
    assert faults == []
    assert file is not None
    assert file.entry[0].pairs == [(0.001, 0.0)]
    assert settings.numbers == {"left.length": 1.0, "left.inner.length": 0.25, "shape.length": 7.0, "left.share": 0.5}


def test_what_is_right_is_kept_whatever_else_is_wrong() -> None:
    file, settings, faults = read(RIGHT.replace('kind = "round"', 'kind = "round"\nlength = 3').replace("1 mm", "1 kg"))
    assert file is None
    assert len(faults) == 2
    assert settings.numbers == {"left.length": 1.0, "left.inner.length": 0.25, "left.share": 0.5}


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('name = "a"', "", 'name: missing; add e.g. name = "mine"'),
        ('name = "a"', 'name = "\\n"', r"name = '\n': not a text of 1 to 100 characters on one line"),
        ('name = "a"', "name = 3", "name = 3: not a text of 1 to 100 characters on one line"),
        ('length = "1 m"', "", '[left] length: missing; add e.g. length = "600 mm"'),
        ("[left.inner]", "[left.iner]", "[left] iner: there is no such key; did you mean inner?"),
        ("[left.inner]", "[left.inner]\nwidth = 3", "[left.inner] width: there is no such key; the keys here are length"),
        ("[left.inner]", "inner = 3", "[left] inner = 3: not a table; write [left.inner] on a line of its own"),
        ('kind = "round"', 'kind = "oval"', "[shape] kind = 'oval': not known; write \"round\" or \"square\""),
        ('kind = "round"', "", '[shape] kind: missing; add e.g. kind = "round"'),
        ('kind = "round"', 'kind = "square"', "[shape] corners: missing; add it"),
        ('kind = "round"', 'kind = "square"\ncorners = 5', "[shape] corners = 5: not a whole number from 1 to 4"),
        ("[[entry]]", "[entry]", "[[entry]] = {'pairs': [['1 mm', '0 deg']]}: not tables; add one table [[entry]] or more"),
        ("[[entry]]\npairs", "pairs", "[[entry]]: missing; add one table [[entry]] or more"),
        ('[["1 mm", "0 deg"]]', '[["1 mm", "0 deg"], ["1 mm"]]', "[[entry]] 1 pairs, row 2: ['1 mm']: not a row of two"),
        ('[["1 mm", "0 deg"]]', '[["1 mm", "0 mm"]]', "[[entry]] 1 pairs, row 1: '0 mm': a length, but an angle is expected"),
        ('[["1 mm", "0 deg"]]', "3", "[[entry]] 1 pairs = 3: not a list of rows"),
        ('pairs = [["1 mm", "0 deg"]]', "", "[[entry]] 1 pairs: missing"),
    ],
)  # fmt: skip
def test_a_fault_is_told_with_its_place_and_the_way_out(old: str, new: str, message: str) -> None:
    assert old in RIGHT
    file, _, faults = read(RIGHT.replace(old, new))
    assert file is None
    assert any(fault.startswith(message) for fault in faults), faults


def test_a_file_that_is_not_toml_is_refused() -> None:
    with pytest.raises(InputError, match=r"x.toml: not TOML: .*line 1"):
        read("name = ")
