"""Tables of a recipe that is not released: none where the cam fails, no start where its target has no cam."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from camwright.profiles.line import Line
from camwright.recipes.build import MadeRecipe, make_recipe
from camwright.recipes.catalogue import catalogue
from camwright.recipes.production import found_ramps
from camwright.recipes.ramp_tables import start_tables
from camwright.recipes.verify import examine
from camwright.recipes.write import recipe_files
from camwright.stored.design_file import StoredDesign

RAMPING = Line(acceleration=1.0)
"""A ramp that a cam which was designed for a steady line does not bear."""


@pytest.fixture(scope="module")
def failed(paper_design: StoredDesign) -> MadeRecipe:
    job = replace(paper_design.job, line=RAMPING)
    return make_recipe(replace(paper_design, job=job), ["csv", "codesys"])


def test_no_table_is_written_where_the_cam_fails_what_no_table_is_asked(failed: MadeRecipe) -> None:
    recipe = failed.recipe
    assert not recipe.released
    assert [check.name for check in recipe.checks if not check.passed] == ["line_ramp"]
    tables = [*recipe.tables, *(table for motion in recipe.start_tables for table in motion.tables)]
    assert len(tables) == 2 * 4
    assert all(check.passed for table in tables for check in table.checks)
    assert not any(table.released or table.files for table in tables)
    assert failed.tables == {}


def test_the_sheet_says_so_and_the_folder_is_verified(failed: MadeRecipe, tmp_path: Path) -> None:
    files = recipe_files(failed)
    page = files["recipe.html"].decode()
    words = catalogue("en")
    assert page.count(">✗</td>") == 2 * 3
    assert page.count(f"✗ {words('start.no_cam')}") == 2
    assert page.count(words("import.not_released")) == 2
    assert words("start.files") not in page
    for path, data in files.items():
        (tmp_path / path).write_bytes(data)  # no folder is needed
    assert examine(tmp_path).faults == ()


def test_a_start_is_written_for_the_targets_that_have_a_cam(paper_design: StoredDesign) -> None:
    found = found_ramps(paper_design)
    records, texts = start_tables(found, ["csv", "codesys"], ["codesys"])
    assert [[(table.target, table.released) for table in record.tables] for record in records] == [
        [("csv", False), ("codesys", True)]
    ] * 3
    assert sorted(texts) == sorted(
        file.path for record in records for table in record.tables if table.target == "codesys" for file in table.files
    )
    assert len(texts) == 3
