"""A recipe of a job that was written in inches is read in inches, in every language and file; the same job in metres in millimetres."""

from __future__ import annotations

import io
import re
from dataclasses import replace

import openpyxl
import pypdf
import pytest
from inch_job import JOB

from camwright.house.language import LANGUAGES
from camwright.house.numbers import INCH, METRIC
from camwright.jobs.job import parse_job
from camwright.recipes.build import MadeRecipe, designed, make_recipe
from camwright.recipes.catalogue import DECIMAL, catalogue
from camwright.recipes.compare import compare_recipes
from camwright.recipes.html import recipe_html
from camwright.recipes.pdf import recipe_pdf
from camwright.recipes.xlsx import recipe_xlsx


@pytest.fixture(scope="module")
def made() -> MadeRecipe:
    return make_recipe(designed(parse_job(JOB, "boards.toml")), ["csv"], "en", "")


@pytest.mark.parametrize("language", LANGUAGES)
def test_pdf_and_page_speak_of_inches(made: MadeRecipe, language: str) -> None:
    recipe = replace(made.recipe, language=language)  # type: ignore[arg-type]
    text = "".join(page.extract_text() for page in pypdf.PdfReader(io.BytesIO(recipe_pdf(recipe))).pages)
    page = re.sub(r"<style.*?</style>|<svg.*?</svg>", "", recipe_html(recipe), flags=re.DOTALL)
    for said in (text, page):
        for part in (
            "24 in",
            "260 ft/min",
            "650 ft/min",
            "100 ft/s²",
            "10000 ft/s³",
            f"1{DECIMAL[recipe.language]}5 in",
            "40 in",
        ):
            assert re.sub(r"\s", "", part) in re.sub(r"\s", "", said), part
        assert not re.search(r"(?<![\w.])[0-9.]+\s?(mm|m/min)(?![a-z])", said)


def test_the_figure_counts_its_master_in_inches(made: MadeRecipe) -> None:
    svg = re.findall(r"<svg.*</svg>", recipe_html(made.recipe), flags=re.DOTALL)[0]
    assert "master x (in)" in svg
    assert "(ft/s²)" in svg
    assert not re.search(r"\(mm\)|\(m/s²\)", svg)


def test_the_workbook_counts_in_inches(made: MadeRecipe) -> None:
    book = openpyxl.load_workbook(io.BytesIO(recipe_xlsx(made.recipe)))
    rows = {row[0].value: (row[1].value, row[2].value) for row in book.worksheets[0].iter_rows()}
    words = catalogue("en", INCH)
    assert rows[words("length")] == (pytest.approx(24.0), "in")
    assert rows[words("line_speed")] == (pytest.approx(260.0), "ft/min")
    assert rows[words("acceleration")] == (pytest.approx(100.0), "ft/s²")
    assert words("column.line_speed") in [cell.value for cell in book.worksheets[1][1]]


def test_a_comparison_is_told_in_the_units_of_the_newer_recipe(made: MadeRecipe) -> None:
    wider = parse_job(JOB.replace('"1.5 in"', '"1.25 in"'), "boards.toml")
    changes = {
        each.name: each for each in compare_recipes(made.recipe, make_recipe(designed(wider), ["csv"], "en", "").recipe)
    }
    assert (changes["shear_zone"].unit, changes["shear_zone"].before) == ("in", pytest.approx(1.5))


def test_every_message_has_its_units_filled_in() -> None:
    for units, absent in ((METRIC, r"\b(in|ft/min)\)"), (INCH, r"(?<![a-zä])mm(?![a-zä])|m/min(?!\w)")):
        for language in LANGUAGES:
            for key, text in catalogue(language, units).messages.items():
                assert "_unit}" not in text, key
                assert "{feed}" not in text, key
                assert not re.search(absent.replace("m/min", "(?<!f)m/min") if units is INCH else absent, text), (
                    key,
                    text,
                )
