"""Cutting IEC 61131-3 structured text into words."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import NamedTuple

from camwright.profiles.tables.cam_table import LARGEST_VALUE
from camwright.profiles.tables.text import refuse, shown

MOST_TOKENS = 200_000

_WORD = re.compile(
    r"(?P<blank>(?:[\s\ufeff]+|//[^\n]*|\{[^{}\n]{0,2000}\})*)"
    r"(?:(?P<comment>\(\*|/\*)"
    r"|(?P<based>(?:2|8|16)\#[0-9A-Fa-f][0-9A-Fa-f_]{0,31})"
    r"|(?P<number>[0-9][0-9_]{0,40}(?:\.[0-9][0-9_]{0,40})?(?:[eE][+-]?[0-9]{1,4})?)"
    r"|(?P<name>[A-Za-z_][A-Za-z0-9_]{0,200})"
    r"|(?P<string>'[^'\n]{0,400}'|\"[^\"\n]{0,400}\")"
    r"|(?P<op>:=|=>|\.\.|[()\[\],;:.#+*/<>=&^%@$|?!`~\\-]))?",
    re.ASCII,
)


_BLANK, _DIGITS = r"[ \t]{0,99}", r"[0-9]{1,40}(?:\.[0-9]{1,40})?(?:[eE][+-]?[0-9]{1,4})?"
_MEMBER = re.compile(rf"([A-Za-z_][A-Za-z0-9_]{{0,200}}){_BLANK}:={_BLANK}([+-]?)({_DIGITS})")
_ONE = rf"{_BLANK}[A-Za-z_][A-Za-z0-9_]{{0,200}}{_BLANK}:={_BLANK}[+-]?{_DIGITS}{_BLANK}"
_MEMBERS = re.compile(rf"{_ONE}(?:,{_ONE}){{0,99}}\)")


class Token(NamedTuple):
    """A word of the text: what kind, as written, in which line; where it ends, and how many words there are so far."""

    kind: str
    text: str
    line: int
    end: int = 0
    number: int = 0


def tokens_of(text: str, place: str, behind: Token | None = None) -> Iterator[Token]:
    """Cut the text into words, from its beginning or behind one of them; comments, pragmas and blanks are passed over.

    Raises
    ------
    InputError
        A character that no word begins with, a comment without an end, more than `MOST_TOKENS` words.
    """
    at, line, count = (0, 1, 0) if behind is None else (behind.end, behind.line, behind.number)
    match = _WORD.match
    while True:
        found = match(text, at)
        if found is None:  # the pattern matches even the empty text
            return
        kind, word = found.lastgroup, found.end("blank")
        if word > at:
            line += text.count("\n", at, word)
        at = found.end()
        if kind == "comment":
            close = text.find("*)" if text[word] == "(" else "*/", at)
            if close < 0:
                raise refuse(place, line, "a comment begins here and never ends")
            line += text.count("\n", at, close)
            at = close + 2
        elif kind is None or kind == "blank":
            if at == len(text):
                return
            raise refuse(place, line, f"the character {shown(text[at])} begins nothing that is known here")
        else:
            count += 1
            if count > MOST_TOKENS:
                raise refuse(place, line, f"the text goes on beyond {MOST_TOKENS} words; no cam table needs as many")
            yield Token(kind, text[word:at], line, at, count)


_END = Token("end", "", 0)


class Words:
    """The words of a text, one after another: the one that stands here, and the one after it."""

    def __init__(self, text: str, place: str) -> None:
        self.place = place
        self.line = 1
        self._text = text
        self._rest = tokens_of(text, place)
        self.now, self.after = _END, next(self._rest, _END)
        self.step()

    def step(self) -> Token:
        """Go on by one word and return the one left behind."""
        past = self.now
        self.now, self.after = self.after, next(self._rest, _END)
        self.line = self.now.line or self.line
        return past

    def accept(self, text: str) -> bool:
        """Go on if this is the word that stands here."""
        word = self.now.text
        if word == text or word.upper() == text:
            self.step()
            return True
        return False

    def expect(self, text: str) -> None:
        """Go on if this is the word that stands here, refuse otherwise."""
        if not self.accept(text):
            raise self.refusal(f"{text!r} is missing before {shown(self.now.text) if self.now.text else 'the end'}")

    def members(self) -> dict[str, float] | None:
        """Go on behind a structure of nothing but numbers in one line, ``(a := 1.0, b := -2)``, and give them by lower-case names.

        None where another begins here, or one with a fault: word by word it is said where that lies. Tables are long lists of such
        structures, and one match of a pattern takes a tenth of the time of their words.
        """
        found = _MEMBERS.match(self._text, self.now.end) if self.now.text == "(" else None
        if found is None:
            return None
        pairs = _MEMBER.findall(found[0])
        members = {name.lower(): float(sign + digits) for name, sign, digits in pairs}
        words = self.now.number + 4 * len(pairs) + sum(1 for _, sign, _ in pairs if sign)
        within = all(abs(value) <= LARGEST_VALUE for value in members.values())
        if len(members) < len(pairs) or words > MOST_TOKENS or not within:
            return None
        self._rest = tokens_of(self._text, self.place, Token("op", ")", self.now.line, found.end(), words))
        self.now, self.after = next(self._rest, _END), next(self._rest, _END)
        self.line = self.now.line or self.line
        return members

    def close(self, bracket: str) -> None:
        """Go on behind the next closing bracket."""
        while self.now.kind != "end" and not self.accept(bracket):
            self.step()

    def refusal(self, reason: str) -> Exception:
        """Make an error at the present line."""
        return refuse(self.place, self.line, reason)
