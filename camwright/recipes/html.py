"""recipe.html: the recipe as one page that needs nothing else."""

from __future__ import annotations

from pathlib import Path

from camwright.recipes.catalogue import catalogue_of
from camwright.recipes.figure import figure_svg
from camwright.recipes.model import Recipe
from camwright.recipes.sheet import sheet

_TEMPLATES = Path(__file__).parent / "templates"


def recipe_html(recipe: Recipe) -> str:
    """Write a recipe as a page; every text is escaped, and the page may load nothing."""
    import jinja2

    words = catalogue_of(recipe.language, recipe.job.toml)
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(_TEMPLATES), autoescape=True, undefined=jinja2.StrictUndefined
    )
    return environment.get_template("recipe.html").render(**sheet(recipe, words), drawing=figure_svg(recipe, words))
