"""Text from users: whatever it holds, it is seen and changes nothing around it."""

from __future__ import annotations

import unicodedata
from collections.abc import Callable

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
