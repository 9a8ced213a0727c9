"""The message catalogue: every word that a recipe shows, in every language, for PDF, HTML and XLSX alike."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

from camwright.house.language import LANGUAGES, Language, filled
from camwright.house.numbers import METRIC, Units, in_print, number, unit_shown, units_of
from camwright.house.toml_file import toml_data

DECIMAL: dict[Language, str] = {"en": ".", "de": ",", "zh": "."}
"""What stands before decimals."""

_FEED = {"metric": "1000 mm", "inch": "40 in"}
"""How much material is fed to see which way the master counts, by units."""

_MESSAGES = Path(__file__).parent / "messages"


@dataclass(frozen=True)
class Catalogue:
    """Messages of one language.

    Parameters
    ----------
    messages
        Messages by key, with ``{name}`` where a value belongs.
    phrases
        What targets say in English (titles and import steps) in this language; empty for English.
    units
        Units in which its reader reads lengths and speeds.
    """

    language: Language
    messages: dict[str, str]
    phrases: dict[str, str]
    units: Units = METRIC

    def __call__(self, key: str, **values: str) -> str:
        """Give a message, its values filled in."""
        return filled(self.messages[key], values)

    def number(self, value: float | None, digits: int = 5) -> str:
        """Write a number in the unit that it is in, with so many significant digits."""
        return self("nothing") if value is None else in_print(number(value, digits), self.units)

    def named(self, group: str, name: str) -> str:
        """Name something that the rest of the program knows by a word, such as a check; the word itself if it has no name here."""
        return self.messages.get(f"{group}.{name}", name.replace("_", " "))

    def phrase(self, english: str) -> str:
        """Give what a target says in English in this language."""
        return self.phrases.get(english, english)


def catalogue(language: Language, units: Units = METRIC) -> Catalogue:
    """Give the messages of a language, for a reader of these units."""
    return _kept(language, replace(units, decimal=DECIMAL[language]))


@lru_cache(maxsize=2 * len(LANGUAGES))
def _kept(language: Language, units: Units) -> Catalogue:
    """Read the messages of a language once for all that ask, with the default units or by their name."""
    phrases = _MESSAGES / f"{language}-targets.json"
    messages = {key: _in_units(text, units) for key, text in _read(_MESSAGES / f"{language}.json").items()}
    return Catalogue(language, messages, _read(phrases) if language != "en" else {}, units)


def catalogue_of(language: Language, job: str) -> Catalogue:
    """Read the messages that a recipe is written with: its language, and the units of its job file's text."""
    return catalogue(language, units_of(toml_data(job, "job", "job file")))


def _in_units(text: str, units: Units) -> str:
    """Put the names of units into a message."""
    names = {"length_unit": unit_shown("m", units), "speed_unit": unit_shown("m/s", units), "feed": _FEED[units.name]}
    return filled(text, names)


def _read(file: Path) -> dict[str, str]:
    return {str(key): str(text) for key, text in json.loads(file.read_text(encoding="utf-8")).items()}
