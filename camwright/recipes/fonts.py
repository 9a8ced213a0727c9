"""What of a user's text the fonts of a printed recipe can show."""

from __future__ import annotations

import re
import textwrap
import unicodedata
from functools import cache
from pathlib import Path

from camwright.house.fonts import font_files
from camwright.recipes.user_text import spelled

_LONGEST_WORD = 24
_LONG_WORD = re.compile(rf"[^\s\u2e80-\uffff]{{{_LONGEST_WORD + 1},}}")  # Chinese can be broken anywhere as it is
_BREAK = "\u200b"  # where a line may end, without width


def printable(text: str) -> str:
    r"""Write a user's text so that every character of it can be printed.

    What no font here shows, and what is not meant to be seen (controls, marks of direction), is written as its code point, such as
    ``⟨U+1F600⟩``; line ends stay. Words longer than a line may be broken anywhere.

    Examples
    --------
    >>> printable("Messer 切刀 \u202e\U0001f98a")
    'Messer 切刀 ⟨U+202E⟩⟨U+1F98A⟩'
    """
    text = spelled(text, lambda letter: has_glyph(ord(letter)) and unicodedata.category(letter)[0] != "C")
    return _LONG_WORD.sub(lambda word: _BREAK.join(textwrap.wrap(word[0], _LONGEST_WORD)), text)


def has_glyph(code: int) -> bool:
    """Whether one of the fonts shows a code point."""
    return any(code in _covered(file) for file in _fonts())


@cache
def _fonts() -> tuple[Path, Path]:
    """Keep where the fonts are."""
    return font_files()


@cache
def _covered(file: Path) -> frozenset[int]:
    """Code points that a font has a glyph for; the large one is not looked into where the other has them all."""
    from fontTools.ttLib import TTFont

    with TTFont(file, lazy=True) as font:
        return frozenset(font.getBestCmap())
