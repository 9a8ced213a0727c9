"""recipe.pdf: the recipe typeset by typst, its figure as vectors, its fonts embedded and every text such that they show it."""

from __future__ import annotations

import json
import re
import shutil
import tempfile
import textwrap
import unicodedata
from functools import cache
from pathlib import Path
from typing import Any

from camwright.house.fonts import font_files, font_folders
from camwright.recipes.blocks import spelled
from camwright.recipes.catalogue import catalogue_of
from camwright.recipes.figure import figure_svg
from camwright.recipes.model import Recipe
from camwright.recipes.sheet import sheet

_TEMPLATE = Path(__file__).parent / "templates" / "recipe.typ"


def recipe_pdf(recipe: Recipe) -> bytes:
    """Typeset a recipe; the same recipe gives the same bytes."""
    words = catalogue_of(recipe.language, recipe.job.toml)
    return typeset(sheet(recipe, words), recipe.provenance.camwright, figure_svg(recipe, words))


def typeset(data: dict[str, Any], version: str, drawing: str = "") -> bytes:
    """Typeset a sheet, made by a version of camwright, with its drawing (SVG)."""
    import typst

    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        shutil.copyfile(_TEMPLATE, place / "recipe.typ")
        (place / "data.json").write_text(json.dumps(_printable({**data, "version": version})), encoding="utf-8")
        (place / "cam.svg").write_text(drawing, encoding="utf-8")
        return bytes(
            typst.compile(
                str(place / "recipe.typ"),
                root=folder,
                font_paths=font_folders(),
                ignore_system_fonts=True,
                timestamp=0,
            )
        )


def _printable(data: Any) -> Any:
    """Make every text in nested lists and tables printable."""
    if isinstance(data, str):
        return printable(data)
    if isinstance(data, dict):
        return {key: _printable(value) for key, value in data.items()}
    return [_printable(value) for value in data] if isinstance(data, list) else data


_LONGEST_WORD = 24
_LONG_WORD = re.compile(rf"[^\s\u2e80-\uffff]{{{_LONGEST_WORD + 1},}}")  # Chinese can be broken anywhere as it is
_BREAK = "\u200b"  # where a line may end, without width


def printable(text: str) -> str:
    r"""Write a user's text so that every character of it can be printed.

    What no font here shows, and what is not meant to be seen (controls, marks of direction), is written as its code point, such as
    ``⟨U+1F600⟩``; line ends stay. Words longer than a line may be broken anywhere.

    Examples
    --------
    >>> printable("Messer 切刀 \u202e\U0001f98a")
    'Messer 切刀 ⟨U+202E⟩⟨U+1F98A⟩'
    """
    text = spelled(text, lambda letter: has_glyph(ord(letter)) and unicodedata.category(letter)[0] != "C")
    return _LONG_WORD.sub(lambda word: _BREAK.join(textwrap.wrap(word[0], _LONGEST_WORD)), text)


def has_glyph(code: int) -> bool:
    """Whether one of the fonts shows a code point."""
    return any(code in _covered(file) for file in font_files())


@cache
def _covered(file: Path) -> frozenset[int]:
    """Code points that a font has a glyph for; the large one is not looked into where the other has them all."""
    from fontTools.ttLib import TTFont

    with TTFont(file, lazy=True) as font:
        return frozenset(font.getBestCmap())
