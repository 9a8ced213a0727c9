"""recipe.html: the recipe as one page that needs nothing else."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from camwright.recipes.catalogue import catalogue_of
from camwright.recipes.figure import figure_svg
from camwright.recipes.model import Recipe
from camwright.recipes.sheet import sheet

_TEMPLATES = Path(__file__).parent / "templates"


def recipe_html(recipe: Recipe) -> str:
    """Write a recipe as a page."""
    words = catalogue_of(recipe.language, recipe.job.toml)
    return page(sheet(recipe, words), figure_svg(recipe, words))


def page(data: dict[str, Any], drawing: str = "") -> str:
    """Write a sheet as a page; every text but the drawing is escaped, and the page may load nothing."""
    import jinja2

    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(_TEMPLATES), autoescape=True, undefined=jinja2.StrictUndefined
    )
    return environment.get_template("recipe.html").render(**data, drawing=drawing)
