"""The line speeds of a recipe's release: the status line, its frame, marks in tables, and the scrap on the way up."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import cast

import pytest

from camwright.house.language import Language
from camwright.recipes.build import MadeRecipe
from camwright.recipes.catalogue import catalogue
from camwright.recipes.model import Recipe, SpeedPart
from camwright.recipes.release import boxed, marked, released_speeds, status_text, warnings
from camwright.recipes.sheet import sheet

OWN = 80 / 60


def of(made: MadeRecipe, *parts: SpeedPart) -> Recipe:
    return replace(made.recipe, speed_band=parts)


@pytest.mark.parametrize(
    ("language", "status"),
    [
        ("en", "Released from 0 to 80 m/min: every check passed at these line speeds"),
        ("de", "Freigegeben von 0 bis 80 m/min: alle Prüfungen bei diesen Bandgeschwindigkeiten bestanden"),
        ("zh", "已放行，线速度 0 至 80 m/min：在这些线速度下所有检查均通过"),
    ],
)
def test_the_status_names_both_ends(made: MadeRecipe, language: Language, status: str) -> None:
    assert status_text(made.recipe, catalogue(language)) == status
    assert not boxed(made.recipe)
    assert warnings(made.recipe, catalogue(language)) == []


def test_a_gap_below_is_boxed_and_its_scrap_told(made: MadeRecipe) -> None:
    words = catalogue("en")
    recipe = of(made, SpeedPart(1.0, OWN, "shear_zone_error", "jerk"))
    assert status_text(recipe, words).startswith("Released from 60 to 80 m/min")
    assert boxed(recipe)
    below, scrap = warnings(recipe, words)
    assert below == "Below 60 m/min a check fails: Sync error in the shear zone."
    assert "go through 0 to 60 m/min: what is cut there is scrap, 500 mm each time" in scrap  # v²/(2 a)
    shown = sheet(recipe, words)
    assert shown["boxed"]
    heads = next(each for each in shown["sections"] if each["key"] == "section.speeds")["blocks"][0]["head"]
    assert heads[1:] == ["✗ 10", "✗ 25", "✗ 50", "100"]
    record = next(each for each in shown["sections"] if each["key"] == "section.record")["blocks"][0]["rows"]
    assert [row[0].startswith("✗") for row in record][-3:] == [True, True, False]


def test_several_parts_and_an_end_beyond_the_job(made: MadeRecipe) -> None:
    words = catalogue("en")
    recipe = of(made, SpeedPart(0.0, 0.5, "none", "settling"), SpeedPart(1.0, 2.0, "settling", "jerk"))
    assert status_text(recipe, words).startswith("Released from 0 to 30 and from 60 to 120 m/min")
    assert boxed(recipe)
    assert [line for line in warnings(recipe, words) if "scrap" in line] == [
        line for line in warnings(recipe, words) if "30 to 60 m/min" in line
    ]
    assert marked("x", recipe, 0.7) == "✗ x"
    assert marked("x", recipe, 1.5) == "x"


def test_a_job_whose_own_speed_is_outside_says_so(made: MadeRecipe) -> None:
    recipe = of(made, SpeedPart(0.0, 1.0, "none", "servo_tolerance"))
    assert "Not released at the job's own line speed of 80 m/min." in warnings(recipe, catalogue("en"))


def test_ends_are_rounded_to_the_inside(made: MadeRecipe) -> None:
    recipe = of(made, SpeedPart(1.0000049, 1.2999951, "settling", "settling"))
    assert "from 60.001 to 77.999 m/min" in status_text(recipe, catalogue("en"))


def test_a_part_that_is_one_speed_is_told_as_one(made: MadeRecipe) -> None:
    recipe = of(
        made, SpeedPart(0.0, 0.5, "none", "settling"), SpeedPart(OWN - 1e-7, OWN + 1e-7, "shear_zone_error", "jerk")
    )
    for language, told in (
        ("en", "from 0 to 30 and at 80 m/min"),
        ("de", "von 0 bis 30 und bei 80 m/min"),
        ("zh", "0 至 30 以及 恰为 80 m/min"),
    ):
        words = catalogue(cast("Language", language))
        assert told in status_text(recipe, words)


def test_speeds_outside_are_marked_in_every_table(made: MadeRecipe) -> None:
    words = catalogue("en")
    shown = sheet(of(made, SpeedPart(1.0, OWN, "shear_zone_error", "jerk")), words)
    for key in ("section.line_ramp", "section.marks"):
        blocks = next(each for each in shown["sections"] if each["key"] == key)["blocks"]
        speeds = [row[0] for row in blocks[0]["rows"]]
        assert [speed.startswith("✗ ") for speed in speeds] == [
            float(speed.removeprefix("✗ ")) < 60.0 for speed in speeds
        ]
        assert any(speed.startswith("✗") for speed in speeds)
        assert blocks[1]["text"] == words("speeds.outside")


def test_what_failed_stands_beside_the_status(made: MadeRecipe) -> None:
    words, recipe = catalogue("en"), made.recipe
    table = recipe.tables[0]
    failed = replace(
        table, released=False, files=(), checks=(replace(table.checks[0], passed=False), *table.checks[1:])
    )
    withheld = replace(recipe, released=False, tables=(failed,))
    assert warnings(withheld, words) == [f"Not passed: {words.named('check', table.checks[0].name)} ({table.target})."]
    steps = next(each for each in sheet(withheld, words)["sections"] if each["key"] == "section.import")["blocks"][0]
    assert "checklist" not in [each["kind"] for each in steps["blocks"]]  # there is no file to import


@pytest.mark.parametrize("language", ["en", "de", "zh"])
@pytest.mark.parametrize("part", [SpeedPart(0.0, 0.5, "none", "settling"), None])
def test_a_sheet_that_is_not_released_calls_no_line_speed_released(
    made: MadeRecipe, language: Language, part: SpeedPart | None
) -> None:
    """It said so in the box, and below that the cam was released up to 31 m/min."""
    words = catalogue(language)
    recipe = replace(of(made, *([part] if part else [])), released=False)
    text = json.dumps(sheet(recipe, words)["sections"], ensure_ascii=False)
    for key in ("speeds.outside", "before.outside"):
        assert words(key) not in text
    assert words("speeds.failing") in text
    assert words("range.released", released=released_speeds(recipe, words)) not in text
    assert (words("range.passes", released=released_speeds(recipe, words)) in text) is bool(part)
    assert words("range.released", released=released_speeds(made.recipe, words)) in json.dumps(
        sheet(made.recipe, words)["sections"], ensure_ascii=False
    )
