"""recipe.xlsx read back with openpyxl: numbers are numbers, texts are texts, the points are the tables'."""

from __future__ import annotations

import io
import zipfile
from dataclasses import replace

import openpyxl
import pytest

from camwright.house.language import LANGUAGES, Language
from camwright.recipes.build import MadeRecipe
from camwright.recipes.xlsx import recipe_xlsx


def read(data: bytes) -> openpyxl.Workbook:
    return openpyxl.load_workbook(io.BytesIO(data))


def test_the_sheets(made: MadeRecipe) -> None:
    book = read(recipe_xlsx(made.recipe))
    assert book.sheetnames == [
        "parameters",
        "speeds",
        "production",
        "checks",
        "points codesys",
        "points logix",
        "points csv",
    ]


def test_parameters_are_numbers_with_units(made: MadeRecipe) -> None:
    page = read(recipe_xlsx(made.recipe))["parameters"]
    rows = {row[0]: row[1:3] for row in page.iter_rows(values_only=True) if row[0]}
    assert rows["Cut length"] == (600, "mm")
    assert rows["Line speed"] == (pytest.approx(80.0), "m/min")
    assert rows["Circumference of the blade circle"] == (400, "mm")
    assert rows["Bandwidth of the velocity loop"] == (120, "rad/s")
    assert rows["Sample time"] == (4, "ms")
    assert rows["Highest line speed at 600 mm, axis in tolerance (m/min)"] == (pytest.approx(116.72, abs=0.02), "m/min")
    assert rows["Running backwards allowed"] == ("no", None)


def test_points_are_the_points_of_the_tables(made: MadeRecipe) -> None:
    book = read(recipe_xlsx(made.recipe))
    for table in made.recipe.tables:
        rows = list(book[f"points {table.target}"].iter_rows(values_only=True))
        master, slave = table.master_unit.symbol, table.slave_unit.symbol
        assert rows[0][:3] == ("Point", f"Master ({master})", f"Slave ({slave})")
        assert [row[0] for row in rows[1:]] == list(range(1, len(table.points.master) + 1))
        assert [row[1] for row in rows[1:]] == pytest.approx(list(table.points.master), rel=1e-15)
        assert [row[2] for row in rows[1:]] == pytest.approx(list(table.points.slave), rel=1e-15)


def test_checks_of_cam_and_tables_are_there(made: MadeRecipe) -> None:
    rows = list(read(recipe_xlsx(made.recipe))["checks"].iter_rows(values_only=True))[1:]
    recipe = made.recipe
    assert len(rows) == len(recipe.checks) + sum(len(table.checks) for table in recipe.tables)
    acceleration = next(check for check in recipe.checks if check.name == "acceleration")
    assert (None, "Acceleration", pytest.approx(acceleration.value), 30, "m/s^2") in [row[:5] for row in rows]


def test_a_value_that_does_not_exist_leaves_its_cell_empty(saw: MadeRecipe) -> None:
    book = read(recipe_xlsx(saw.recipe))
    assert "Punkte trio" in book.sheetnames
    assert book["Punkte trio"]["D1"].value is None  # straight lines: no ratio
    empty = [row for row in book["Prüfungen"].iter_rows(values_only=True) if row[1] == "Schleppfehler"]
    assert empty[0][3] is None


@pytest.mark.parametrize(
    "text", ["=cmd|' /C calc'!A0", "+1+1", "-2+3", "@SUM(A1)", "\t=1", '=HYPERLINK("x")', "http://x.test"]
)
def test_no_text_becomes_a_formula_or_a_link(made: MadeRecipe, text: str) -> None:
    data = recipe_xlsx(replace(made.recipe, name=text, note=text))
    book = read(data)
    cells = [cell for page in book for row in page.iter_rows() for cell in row]
    assert not [cell for cell in cells if cell.data_type == "f"]
    assert not [cell for cell in cells if cell.hyperlink]
    found = [cell for cell in cells if cell.value == text.replace("\t", "⟨U+0009⟩")]
    assert len(found) == 2
    assert all(cell.data_type == "s" and cell.quotePrefix for cell in found)
    with zipfile.ZipFile(io.BytesIO(data)) as parts:
        assert not any(b"<f>" in parts.read(name) for name in parts.namelist())


@pytest.mark.parametrize("note", ["\x00\x07\ud800"[:2], "🦊 切刀 \u202e", "x" * 2000, "</si></sst>&lt;"])
def test_any_text_can_be_read_back(made: MadeRecipe, note: str) -> None:
    page = read(recipe_xlsx(replace(made.recipe, note=note)))["parameters"]
    rows = dict(row[:2] for row in page.iter_rows(values_only=True))
    assert len(rows["Note"]) >= len(note)


@pytest.mark.parametrize("language", LANGUAGES)
def test_the_same_recipe_gives_the_same_bytes(made: MadeRecipe, language: Language) -> None:
    recipe = replace(made.recipe, language=language)
    assert recipe_xlsx(recipe) == recipe_xlsx(recipe)
