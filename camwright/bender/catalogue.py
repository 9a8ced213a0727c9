"""The message catalogue of the bending sheet: every word that it shows, in every language, for PDF and HTML alike."""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from camwright.house.language import Language, filled
from camwright.profiles.notice import Notice, Number

_MESSAGES = Path(__file__).parent / "messages"


@dataclass(frozen=True)
class SheetWords:
    """Messages of one language, and how it writes numbers.

    Parameters
    ----------
    messages
        Messages by key, with ``{name}`` where a value belongs.
    notices
        What is said for the templates of notices, which are English.
    """

    language: Language
    messages: dict[str, str]
    notices: dict[str, str]

    def __call__(self, key: str, **values: str) -> str:
        """Give a message, its values filled in."""
        return filled(self.messages[key], values)

    def said(self, told: str) -> str:
        """Say a notice in the language; what is none, such as the words of a library, stays as it is."""
        if not isinstance(told, Notice):
            return told
        values = {
            name: self.number(value.value, value.form) if isinstance(value, Number) else self.said(value)
            for name, value in told.values.items()
        }
        return self.notices.get(told.text, told.text).format(**values)

    def number(self, value: float, form: str) -> str:
        """Write a number in a format of Python, such as ``".3f"``, with the decimal mark of the language."""
        text = f"{value:{form}}"
        return text.replace(".", ",") if self.language == "de" else text


@cache
def sheet_words(language: Language) -> SheetWords:
    """Read the messages of a language."""
    messages = json.loads((_MESSAGES / f"{language}.json").read_text(encoding="utf-8"))
    return SheetWords(language, messages, {} if language == "en" else _notices(language))


def _notices(language: Language) -> dict[str, str]:
    entries = json.loads((_MESSAGES / "notices.json").read_text(encoding="utf-8"))
    return {english: said[language] for english, said in entries.items()}
