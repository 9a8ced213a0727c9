"""Structures of numbers are read at one stroke: as word by word, faults included."""

from __future__ import annotations

import numpy as np
import pytest

from camwright.profiles.errors import InputError
from camwright.profiles.tables.st_words import Words
from camwright.profiles.tables.structured_text import Other, parse

_PIECES = (
    *(
        "(",
        ")",
        "a",
        ":=",
        "1.5",
        "-",
        "+",
        " ",
        "\n",
        ",",
        "[",
        "]",
        "16#FF",
        "1e5",
        "1e400",
        "1e13",
        "(* c *)",
        "//x\n",
    ),
    *(
        "(a := 1, b := 2)",
        "(a:=1,A:=2)",
        "(a := -1.0)",
        "(A:=1 , B := 2.5e-3)",
        ";",
        "x : INT := ",
        "x := ",
        "'s'",
        "$é",
    ),
    *("1_000", "9" * 41),
)


def _read(text: str) -> str:
    try:
        return repr(parse(text, "file"))
    except InputError as error:
        return str(error)


def test_structures_of_numbers_are_read_as_word_by_word(monkeypatch: pytest.MonkeyPatch) -> None:
    draw = np.random.default_rng(0)
    begun = "v : ARRAY[0..3] OF T := "
    texts = [begun * (n % 2) + "".join(draw.choice(_PIECES, draw.integers(1, 15))) for n in range(5000)]
    found = [_read(text) for text in texts]
    assert sum("Struct" in each for each in found) > 50
    with monkeypatch.context() as slow:
        slow.setattr(Words, "members", lambda _: None)
        assert [_read(text) for text in texts] == found


def test_a_list_of_structures_is_not_read_word_by_word() -> None:
    words = Words("(a := 1.0, B := -2e-3) , c", "file")
    assert words.members() == {"a": 1.0, "b": -2e-3}
    assert (words.now.text, words.after.text) == (",", "c")


@pytest.mark.parametrize(
    ("text", "line"), [("a := (1 + 2;\nb := 3;\n", 2), ("a := (b + 2", 1), ("a := (1 2 (3);", 1), ("a := ((1);", 1)]
)
def test_a_bracket_that_is_never_closed_is_refused(text: str, line: int) -> None:
    with pytest.raises(InputError) as caught:
        parse(text, "here")
    assert str(caught.value) == f"here, line {line}: a bracket is never closed"


@pytest.mark.parametrize(("text", "value"), [("((1.5))", 1.5), ("(1 + (2 * [3, 4]) - 4)", Other(1))])
def test_a_bracket_around_no_members_holds_a_number_or_an_expression(text: str, value: object) -> None:
    (assignment,) = parse(f"a := {text};", "here").assignments
    assert assignment.value == value
