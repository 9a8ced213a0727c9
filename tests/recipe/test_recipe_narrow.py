"""recipe.html on the screen of a phone: nothing beyond its edge, no number in two lines, each value with its name."""

from __future__ import annotations

import re
import shutil
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest

from camwright.house.language import LANGUAGES
from camwright.recipes.build import MadeRecipe
from camwright.recipes.html import recipe_html

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")

BEYOND = """() => [...document.querySelectorAll('body *')].filter(each => !each.closest('svg'))
    .filter(each => each.scrollWidth > each.clientWidth + 1 && each.clientWidth > 0
                    || each.getBoundingClientRect().right > 360.5)
    .map(each => each.outerHTML.slice(0, 120))"""
"""What is wider than its place or ends beyond the screen."""

NUMBERS = """() => [...document.querySelectorAll('.wide td.n')].map(each => {
    const range = document.createRange(); range.selectNodeContents(each);
    return [each.textContent, new Set([...range.getClientRects()].map(rect => Math.round(rect.top))).size]; })"""
"""Text of each number and how many lines it takes."""


class Cells(HTMLParser):
    """Tables with headings: their headings, and the names that their cells carry."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tables: list[tuple[list[str], list[str]]] = []
        self._heading = False
        self.feed(text)

    def handle_starttag(self, tag, attrs):  # noqa: D102 - HTMLParser's
        self._heading = tag == "th"
        if tag == "thead":
            self.tables.append(([], []))
        name = dict(attrs).get("data-name")
        if tag == "th" and self.tables:
            self.tables[-1][0].append("")
        if tag == "td" and name is not None:
            self.tables[-1][1].append(name)

    def handle_endtag(self, tag):  # noqa: ARG002, D102 - HTMLParser's
        self._heading = False

    def handle_data(self, data):  # noqa: D102 - HTMLParser's
        if self._heading and self.tables:
            self.tables[-1][0][-1] += data


@pytest.mark.parametrize("language", LANGUAGES)
def test_each_value_carries_the_heading_of_its_column(made: MadeRecipe, saw: MadeRecipe, language: Any) -> None:
    for recipe in (made.recipe, saw.recipe):
        tables = Cells(recipe_html(replace(recipe, language=language))).tables
        assert len(tables) >= 8
        for heads, names in tables:
            assert names
            assert names == heads * (len(names) // len(heads))


@pytest.mark.slow
@pytest.mark.parametrize("language", LANGUAGES)
def test_at_360_pixels_nothing_is_cut_and_no_number_broken(
    made: MadeRecipe, saw: MadeRecipe, language: Any, tmp_path: Path
) -> None:
    api = pytest.importorskip("playwright.sync_api", reason="Playwright is not installed")
    if CHROMIUM is None:
        pytest.skip("no Chromium is installed: apt-get install chromium")
    with api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": 360, "height": 740})
        for recipe in (made.recipe, saw.recipe):
            (tmp_path / "recipe.html").write_text(recipe_html(replace(recipe, language=language)), encoding="utf-8")
            page.goto((tmp_path / "recipe.html").as_uri())
            assert page.evaluate("document.documentElement.scrollWidth") == 360
            assert page.evaluate(BEYOND) == []
            broken = [text for text, lines in page.evaluate(NUMBERS) if re.search(r"\d", text) and lines > 1]
            assert broken == []
        browser.close()
