"""recipe.pdf: the recipe typeset by typst, its figure as vectors, its fonts embedded."""

from __future__ import annotations

import json
import shutil
import tempfile
from pathlib import Path
from typing import Any

from camwright.house.fonts import font_folders
from camwright.recipes.catalogue import catalogue_of
from camwright.recipes.figure import figure_svg
from camwright.recipes.fonts import printable
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
