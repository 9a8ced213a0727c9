"""recipe.html read back: one file, nothing fetched, every text escaped, the figure inside."""

from __future__ import annotations

import re
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest

from camwright.house.language import LANGUAGES, Language
from camwright.recipes.build import MadeRecipe
from camwright.recipes.catalogue import catalogue
from camwright.recipes.figure import figure_svg
from camwright.recipes.html import recipe_html

VOID = {"meta", "link", "br", "hr", "img", "input"}


class Page(HTMLParser):
    """Tags, attributes and texts of a page; refuses tags that do not nest."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.attributes: list[tuple[str, str, str]] = []
        self.texts: list[str] = []
        self.open: list[str] = []
        self.feed(text)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag, attrs):  # noqa: D102 - HTMLParser's
        self.tags.append(tag)
        self.attributes += [(tag, name, value or "") for name, value in attrs]
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):  # noqa: D102 - HTMLParser's
        self.tags.append(tag)
        self.attributes += [(tag, name, value or "") for name, value in attrs]

    def handle_endtag(self, tag):  # noqa: D102 - HTMLParser's
        assert self.open.pop() == tag

    def handle_data(self, data):  # noqa: D102 - HTMLParser's
        self.texts.append(data)


@pytest.mark.parametrize("language", LANGUAGES)
def test_one_file_that_fetches_nothing(made: MadeRecipe, saw: MadeRecipe, language: Language) -> None:
    for recipe in (made.recipe, saw.recipe):
        text = recipe_html(replace(recipe, language=language))
        assert len(text.encode()) < 2_000_000
        assert text.startswith("<!doctype html>")
        page = Page(text)
        assert not {"script", "link", "img", "iframe", "object", "embed", "form", "base"} & set(page.tags)
        assert not [
            each for each in page.attributes if each[1] in ("src", "href", "action") or each[1].startswith("on")
        ]
        assert page.tags.count("figure") == 1
        assert "svg" in page.tags
        assert ("html", "lang", {"en": "en", "de": "de", "zh": "zh-Hans"}[language]) in page.attributes
        assert not re.search(r"@import|url\((?!#)", text)
        assert "default-src 'none'" in text
        for key in catalogue(language).messages:
            if key.startswith("section."):
                assert catalogue(language)(key) in page.texts


NAMES = [
    "<script>alert(1)</script>",
    '"><img src=x onerror=alert(1)>',
    "</title></style><b>&amp;{{ 7*7 }}{% raw %}",
    "]]> --> <!-- \u202eevil\x07\u2028",
]


@pytest.mark.parametrize("name", NAMES)
def test_any_text_of_a_user_is_text(made: MadeRecipe, name: str) -> None:
    plain = Page(recipe_html(made.recipe))
    page = Page(recipe_html(replace(made.recipe, name=name, note=f"{name}\n{name}")))
    assert sorted(page.tags) == sorted([*plain.tags, "tr", "th", "td", "bdi"])  # the note's row and nothing else
    assert not [each for each in page.attributes if each[1].startswith("on")]
    shown = name.replace("\u202e", "⟨U+202E⟩").replace("\x07", "⟨U+0007⟩").replace("\u2028", "\u2028")
    assert any(shown.partition("\u2028")[0] in text for text in page.texts)


def test_controls_are_spelled_out(made: MadeRecipe) -> None:
    text = recipe_html(replace(made.recipe, note="a\x00b\u202ec"))
    assert "a⟨U+0000⟩b⟨U+202E⟩c" in text
    assert not re.search(r"[\x00-\x08\x0b-\x1f\u202a-\u202e]", text)


def curves(svg: str) -> list[list[tuple[float, float]]]:
    """Points of the curves of a figure, which are its thickest lines (pt)."""
    paths = re.findall(r'<path d="M([^"]+)" stroke="#000" stroke-width="1.5"/>', svg)
    numbers = [list(map(float, path.split())) for path in paths]
    return [list(zip(each[::2], each[1::2], strict=True)) for each in numbers]


def test_the_figure_tells_lines_and_zones_apart_without_colour(made: MadeRecipe) -> None:
    svg = figure_svg(made.recipe, catalogue("en"))
    colours = set(re.findall(r'(?:fill|stroke)="(#\w+)"', svg))
    assert all(
        len(set(re.findall("..", colour[1:] if len(colour) == 7 else colour[1:] * 2))) == 1 for colour in colours
    )  # greys
    assert len(curves(svg)) == 3
    assert 'fill="url(#cam-hatch)"' in svg
    assert "stroke-dasharray" in svg


@pytest.mark.parametrize("language", LANGUAGES)
def test_the_text_of_the_figure_can_be_copied(made: MadeRecipe, language: str) -> None:
    words = catalogue(language)
    texts = re.findall(r"<text [^>]*>([^<]+)</text>", figure_svg(made.recipe, words))
    assert {words(f"figure.{key}") for key in ("master", "sync", "shear", "limit")} <= set(texts)
    assert {"0", "400", "600"} <= set(texts)


def test_the_figure_draws_the_cam(made: MadeRecipe) -> None:
    svg = figure_svg(made.recipe, catalogue("en"))
    found = re.search(r'<svg width="([\d.]+)" height="([\d.]+)" viewBox', svg)
    assert found is not None
    width = float(found[1])
    position, ratio, _ = curves(svg)
    for line in curves(svg):
        across = [x for x, _ in line]
        assert across == sorted(across)
        assert (across[0], across[-1]) == (0.0, width)
    low, high = position[0][1], position[-1][1]
    at = np.interp(width / 3, *zip(*position, strict=True))  # x = 200 mm, where y = 100 of 400 mm
    assert (low - at) / (low - high) == pytest.approx(0.25, abs=0.001)
    assert ratio[-1][1] == pytest.approx(ratio[0][1], abs=0.02)  # 1 at both ends


def test_import_steps_name_the_units_of_the_files(made: MadeRecipe) -> None:
    facts = [text for text in Page(recipe_html(made.recipe)).texts if "points" in text and "rebuilt" in text.lower()]
    assert len(facts) == 3
    assert all("mm" in text for text in facts)  # of the CSV, too, though it is read as metres
