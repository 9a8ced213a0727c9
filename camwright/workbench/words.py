"""The words of the page in a language: its own, and those of the recipes where both name the same thing."""

from __future__ import annotations

import json
from collections.abc import Mapping

from camwright.house.language import Language
from camwright.jobs.keys import JobKey, job_keys
from camwright.recipes.catalogue import DECIMAL, catalogue
from camwright.workbench.files import PAGE

_SHARED = ("check.", "word.", "binding.")
"""Groups of messages of the recipes that the page names things by too."""


def page_words(language: Language) -> dict[str, str]:
    """Give the words of a language by key.

    ``field.PATH`` is what a key of the job file is called, ``meaning.PATH`` what it means, ``decimal`` what stands before decimals.
    """
    own: dict[str, str] = json.loads((PAGE / "words" / f"{language}.json").read_text(encoding="utf-8"))
    messages = catalogue(language).messages
    shared = {key: text for key, text in messages.items() if key.startswith(_SHARED)}
    fields: dict[str, str] = {}
    for key in job_keys():
        fields[f"meaning.{key.path}"] = key.meaning
        label = _label(key, messages)
        if label is not None:
            fields[f"field.{key.path}"] = label
    return {"decimal": DECIMAL[language]} | shared | fields | own


def _label(key: JobKey, messages: Mapping[str, str]) -> str | None:
    """Find what the recipes call a key: those of a machine by their place, the others by their name."""
    return messages.get(key.path if key.table == "machine" else key.name)
