"""The message catalogue of the bending sheet: every word that it shows, in every language, for PDF and HTML alike."""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Literal, get_args

SheetLanguage = Literal["en", "de", "zh"]
LANGUAGES: tuple[SheetLanguage, ...] = get_args(SheetLanguage)

_MESSAGES = Path(__file__).parent / "messages"


@dataclass(frozen=True)
class SheetWords:
    """Messages of one language, and how it writes numbers.

    Parameters
    ----------
    language
        The language.
    messages
        Messages by key, with ``{name}`` where a value belongs.
    """

    language: SheetLanguage
    messages: dict[str, str]

    def __call__(self, key: str, **values: str) -> str:
        """Give a message, its values filled in."""
        text = self.messages[key]
        for name, value in values.items():
            text = text.replace(f"{{{name}}}", value)
        return text

    def number(self, value: float, form: str) -> str:
        """Write a number in a format of Python, such as ``".3f"``, with the decimal mark of the language."""
        text = f"{value:{form}}"
        return text.replace(".", ",") if self.language == "de" else text


@cache
def sheet_words(language: SheetLanguage) -> SheetWords:
    """Read the messages of a language."""
    return SheetWords(language, json.loads((_MESSAGES / f"{language}.json").read_text(encoding="utf-8")))
