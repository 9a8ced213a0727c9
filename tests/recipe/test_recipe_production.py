"""What a recipe says of starting, stopping and print marks: the same as the commands, in every language and unit."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from camwright.house.language import LANGUAGES
from camwright.jobs.examples import example
from camwright.jobs.job import load_job, parse_job
from camwright.production.marks import marks
from camwright.production.ramps import ramps
from camwright.recipes.build import MadeRecipe, designed
from camwright.recipes.catalogue import catalogue
from camwright.recipes.compare import compare_recipes
from camwright.recipes.production import found_ramps, mark_blocks, marks_of, start_blocks, start_stop
from camwright.recipes.recipe_file import parse_recipe
from camwright.recipes.sheet import sheet
from camwright.stored.design_file import StoredDesign


def test_a_recipe_says_what_the_commands_say(made: MadeRecipe, paper_design: StoredDesign) -> None:
    found, there = ramps(paper_design.job), made.recipe.start_stop
    assert there.park == found.stand.park
    assert there.ramp_in.peak_acceleration == pytest.approx(9.07177, abs=1e-5)
    assert there.one_shot_master == pytest.approx(0.6)
    assert there.standing_up_to * 60 == pytest.approx(138.24, abs=5e-3)
    assert there.passed
    by_speed = marks(paper_design.job).by_speed
    assert [row.redesign.earliest for row in made.recipe.marks] == pytest.approx(
        [each.redesign.earliest for each in by_speed]
    )
    assert made.recipe.marks[-1].redesign.earliest * 1e3 == pytest.approx(-263.38, abs=5e-3)


@pytest.mark.parametrize("language", LANGUAGES)
def test_the_sheet_has_both_sections(language: str, made: MadeRecipe) -> None:
    words = catalogue(language)
    sections = {
        section["key"]: section for section in sheet(replace(made.recipe, language=language), words)["sections"]
    }
    start, table = sections["section.start_stop"]["blocks"], sections["section.marks"]["blocks"][0]
    assert start[0]["rows"][0][1:] == ["100", "200", "150", f"9{words.units.decimal}0718"]
    assert "138.24".replace(".", words.units.decimal) in start[1]["text"]
    assert "{" not in start[1]["text"]
    assert len(table["rows"]) == 10
    assert table["rows"][-1][:3] == ["80", f"−263{words.units.decimal}3", words("marks.no_limit")]


def test_a_machine_that_cannot_stop_between_cuts_says_up_to_which_speed(made: MadeRecipe) -> None:
    text = example("paper-600").path.read_text().replace('"600 mm"', '"450 mm"').replace('"80 m/min"', '"150 m/min"')
    job = parse_job(text, "job")
    design = designed(job)
    found = start_stop(design, found_ramps(design))
    assert found.ramp_in is None
    assert found.standing_up_to * 60 == pytest.approx(138.24, abs=5e-3)
    words = catalogue("en")
    (block,) = start_blocks(replace(made.recipe, start_stop=found), words)
    assert "up to 138.24 m/min it can" in block["text"]
    assert marks_of(designed(job))[-1].redesign.latest is not None


def test_a_start_that_fails_a_check_is_marked(made: MadeRecipe) -> None:
    failed = replace(made.recipe, start_stop=replace(made.recipe.start_stop, passed=False))
    assert any(block.get("strong") for block in start_blocks(failed, catalogue("en")))


def test_a_recipe_of_an_earlier_version_has_neither(made: MadeRecipe) -> None:
    old = replace(made.recipe, start_stop=None, marks=())
    assert start_blocks(old, catalogue("en")) == []
    assert mark_blocks(old, catalogue("en")) == []
    assert not {"section.start_stop", "section.marks"} & {
        section["key"] for section in sheet(old, catalogue("en"))["sections"]
    }


def test_a_recipe_file_without_them_is_read(folder: Path) -> None:
    data = json.loads((folder / "recipe.json").read_text(encoding="utf-8"))
    del data["start_stop"], data["marks"]
    recipe = parse_recipe(json.dumps(data), "recipe.json")
    assert recipe.start_stop is None
    assert recipe.marks == ()


def test_inches(made: MadeRecipe) -> None:
    job = parse_job(example("paper-600").path.read_text().replace('"600 mm"', '"24 in"'), "job")
    words = catalogue("en", job.units)
    table = mark_blocks(made.recipe, words)[0]
    assert table["rows"][-1][1] == "−10.369"  # -263.38 mm
    assert "(in)" in table["head"][1]


def test_what_is_not_in_sync_is_a_dash(made: MadeRecipe) -> None:
    job = load_job(example("thick-product").path)
    rows = marks_of(designed(job))
    assert rows[0].slave_offset is None
    table = mark_blocks(replace(made.recipe, marks=rows), catalogue("en"))[0]
    assert table["rows"][0][-2:] == ["–", "–"]


def test_a_change_of_the_ramps_is_a_change_of_the_recipe(made: MadeRecipe) -> None:
    other = replace(made.recipe, start_stop=replace(made.recipe.start_stop, park=-0.19))
    found = [change for change in compare_recipes(made.recipe, other) if change.group == "production"]
    assert [change.name for change in found] == ["park"]


def test_rounding_of_a_slave_that_stands_is_no_change(made: MadeRecipe) -> None:
    checks = tuple(
        replace(check, value=1e-12 + (check.value or 0.0)) if check.name == "reversal" else check
        for check in made.recipe.checks
    )
    assert checks != made.recipe.checks
    assert compare_recipes(made.recipe, replace(made.recipe, checks=checks)) == []
