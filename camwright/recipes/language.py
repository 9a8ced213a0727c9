"""`Language`: the languages that recipes, sheets and the workbench speak."""

from __future__ import annotations

from typing import Literal, get_args

Language = Literal["en", "de", "zh"]

LANGUAGES: tuple[Language, ...] = get_args(Language)
