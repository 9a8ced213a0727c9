"""Cutting IEC 61131-3 structured text into words."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import NamedTuple

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


class Token(NamedTuple):
    """A word of the text: what kind, as written, in which line."""

    kind: str
    text: str
    line: int


def tokens_of(text: str, place: str) -> Iterator[Token]:
    """Cut the text into words; comments, pragmas and blanks are passed over.

    Raises
    ------
    InputError
        A character that no word begins with, a comment without an end, more than `MOST_TOKENS` words.
    """
    at, line, count = 0, 1, 0
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
            yield Token(kind, text[word:at], line)


_END = Token("end", "", 0)


class Words:
    """The words of a text, one after another: the one that stands here, and the one after it."""

    def __init__(self, text: str, place: str) -> None:
        self.place = place
        self.line = 1
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

    def close(self, bracket: str) -> None:
        """Go on behind the next closing bracket."""
        while self.now.kind != "end" and not self.accept(bracket):
            self.step()

    def refusal(self, reason: str) -> Exception:
        """Make an error at the present line."""
        return refuse(self.place, self.line, reason)
