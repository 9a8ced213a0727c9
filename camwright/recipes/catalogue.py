"""The message catalogue: every word that a recipe shows, in every language, for PDF, HTML and XLSX alike."""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import get_args

from camwright.recipes.model import Language

LANGUAGES: tuple[Language, ...] = get_args(Language)

_MESSAGES = Path(__file__).parent / "messages"


@dataclass(frozen=True)
class Catalogue:
    """Messages of one language.

    Parameters
    ----------
    language
        The language.
    messages
        Messages by key, with ``{name}`` where a value belongs.
    phrases
        What targets say in English (titles and import steps) in this language; empty for English.
    """

    language: Language
    messages: dict[str, str]
    phrases: dict[str, str]

    def __call__(self, key: str, **values: str) -> str:
        """Give a message, its values filled in."""
        text = self.messages[key]
        for name, value in values.items():
            text = text.replace(f"{{{name}}}", value)
        return text

    def named(self, group: str, name: str) -> str:
        """Name something that the rest of the program knows by a word, such as a check; the word itself if it has no name here."""
        return self.messages.get(f"{group}.{name}", name.replace("_", " "))

    def phrase(self, english: str) -> str:
        """Give what a target says in English in this language."""
        return self.phrases.get(english, english)


@lru_cache(maxsize=len(LANGUAGES))
def catalogue(language: Language) -> Catalogue:
    """Read the messages of a language."""
    phrases = _MESSAGES / f"{language}-targets.json"
    return Catalogue(language, _read(_MESSAGES / f"{language}.json"), _read(phrases) if language != "en" else {})


def _read(file: Path) -> dict[str, str]:
    return {str(key): str(text) for key, text in json.loads(file.read_text(encoding="utf-8")).items()}
