"""`Language`: the languages that recipes, sheets and the workbench speak."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal, get_args

Language = Literal["en", "de", "zh"]

LANGUAGES: tuple[Language, ...] = get_args(Language)


def filled(message: str, values: Mapping[str, str]) -> str:
    """Fill values in where a message has their names, as ``{name}``."""
    for name, value in values.items():
        message = message.replace(f"{{{name}}}", value)
    return message
