"""What a document is made of: blocks of plain texts that PDF and HTML know how to set; what users wrote changes nothing around it."""

from __future__ import annotations

import unicodedata
from collections.abc import Callable
from typing import Any

from camwright.house.numbers import Units, fine_length, in_print, shown
from camwright.recipes.catalogue import Catalogue

Block = dict[str, Any]
"""A ``kind`` and what belongs to it."""


def text_block(text: str, *, strong: bool = False) -> Block:
    """Make a paragraph."""
    return {"kind": "text", "text": text, "strong": strong}


def table_block(head: list[str], rows: list[list[str]], left: int = 1, widths: list[float] | None = None) -> Block:
    """Make a table whose first columns are words and whose others are numbers."""
    return {"kind": "table", "head": head, "rows": rows, "left": left, "widths": widths or []}


def length_text(value: float, unit: str, units: Units) -> str:
    """Write a value; a length to a tenth of a micrometre, the same number of digits at every speed."""
    if unit != "m":
        return shown(value, unit, 4, units)
    return in_print(f"{fine_length(value, units):z.{units.fine}f}", units).replace("-", "−")


def fixed_text(value: float | None, words: Catalogue) -> str:
    """Write a length like `length_text`, or that there is none."""
    return words("nothing") if value is None else length_text(value, "m", words.units)


def record_block(rows: list[list[str]], words: Catalogue) -> Block:
    """Set the record that is filled in at the machine: what was designed beside what is found and left."""
    return {
        "kind": "record",
        "head": [words(f"column.{key}") for key in ("quantity", "value", "as_found", "as_left")],
        "rows": rows,
        "fields": [words(f"record.{key}") for key in ("machine", "name", "date", "signature")],
    }


_SHORT = 60


def visible(text: str) -> str:
    r"""Write controls, marks of direction and the like as their code points; line ends stay.

    Examples
    --------
    >>> visible("a\u202eb\x07")
    'a⟨U+202E⟩b⟨U+0007⟩'
    """
    return spelled(text, lambda letter: unicodedata.category(letter)[0] != "C")


def spelled(text: str, is_shown: Callable[[str], bool]) -> str:
    """Write the characters that are not shown as their code points; line ends stay, all of one kind."""
    if text.isascii() and text.isprintable():
        return text
    lines = text.replace("\r\n", "\n").replace("\r", "\n")
    return "".join(x if x == "\n" or is_shown(x) else f"⟨U+{ord(x):04X}⟩" for x in lines)


def shortened(text: str) -> str:
    """Write a text on one line of at most 60 characters."""
    line = " ".join(text.split())
    return line if len(line) <= _SHORT else line[: _SHORT - 1] + "…"
