"""What a recipe says of the ramps of the line."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from camwright import load_job
from camwright.cli.views.line_ramps import plc_words
from camwright.design.optimise import solve
from camwright.house.language import LANGUAGES, Language
from camwright.jobs.numbers import job_numbers
from camwright.recipes.build import MadeRecipe
from camwright.recipes.catalogue import catalogue
from camwright.recipes.facts import limit_facts
from camwright.recipes.model import JobRecord
from camwright.recipes.ramps import ramp_blocks, ramp_record
from camwright.studies.line_ramps import line_ramps

RAMPING = load_job(Path(__file__).parents[2] / "examples" / "ramping-line.toml")
FOUND = line_ramps(solve(RAMPING.task, "peak_acceleration").profile, RAMPING)


def test_the_record_has_the_numbers_of_the_study() -> None:
    record = ramp_record(FOUND)
    assert record.acceleration == pytest.approx(1.0, rel=1e-3)
    assert record.stop == pytest.approx(5.0, rel=1e-3)
    assert record.stop_length == pytest.approx((80 / 60) ** 2 / 10, rel=1e-3)
    assert record.by_acceleration_alone == pytest.approx(21.15, abs=0.05)
    assert record.sync_error == pytest.approx(5.0 * (2 * 0.7 / 120 + 0.004) / 35, rel=0.05)
    assert [round(each.line_speed * 60) for each in record.by_speed] == list(range(4, 84, 4))


@pytest.mark.parametrize("language", LANGUAGES)
def test_the_sheet_tells_two_numbers_for_the_plc(made: MadeRecipe, language: Language) -> None:
    words = catalogue(language)
    recipe = replace(made.recipe, line_ramp=ramp_record(FOUND), job=JobRecord(RAMPING.text, job_numbers(RAMPING)))
    table, *texts = ramp_blocks(recipe, words)
    assert [row[0] for row in table["rows"]] == ["20", "40", "60", "80"]
    assert [row[1:3] for row in table["rows"]][-1] == ["1", "5"]
    plc = texts[0]["text"]
    assert all(part in plc for part in ("80", "1 m/s²", "5 m/s²", words("binding.jerk")))
    assert "2.27 mm".replace(".", words.units.decimal) in texts[-1]["text"]
    assert {fact.name: fact.value for fact in limit_facts(recipe) if fact.group == "line"} == {
        "line.acceleration": 1.0, "line.stop": 5.0, "line.jerk": 50.0,
    }  # fmt: skip


def test_a_cam_that_bears_no_ramp_says_so(made: MadeRecipe) -> None:
    record = made.recipe.line_ramp
    assert record is not None
    assert (record.acceleration, record.stop, record.stop_length, record.sync_error) == (0.0, 0.0, None, None)
    _, plc, alone = ramp_blocks(made.recipe, catalogue("en"))
    assert "ramps up to 0 m/s² (jerk), emergency stop up to 0 m/s²" in plc["text"]
    assert "21.1" in alone["text"]


def test_what_rounding_leaves_of_a_ramp_is_none(made: MadeRecipe) -> None:
    """A crank's jerk limit that is used up left 0.13 mm/s², and 935 m of material that run through."""
    up_to = FOUND.up_to
    speeding, braking = (
        replace(each, value=value) for each, value in ((up_to.speeding, 1.398e-4), (up_to.braking, 1.336e-4))
    )
    found = replace(FOUND, up_to=replace(up_to, speeding=speeding, braking=braking))
    assert found.stop_length is None
    assert "ramps up to 0 m/s² (jerk), emergency stop up to 0 m/s²;" in plc_words(found)
    left = ramp_record(found)
    _, plc, *others = ramp_blocks(replace(made.recipe, line_ramp=left), catalogue("en"))
    assert "ramps up to 0 m/s² (jerk), emergency stop up to 0 m/s²" in plc["text"]
    assert not [each for each in others if "935" in each["text"]]


@pytest.mark.parametrize("allowed", [False, True])
def test_a_carriage_runs_backwards_whatever_the_job_says_and_a_knife_only_if_it_may(
    made: MadeRecipe, saw: MadeRecipe, allowed: bool
) -> None:
    for recipe, told in ((made.recipe, allowed), (saw.recipe, True)):
        numbers = {**recipe.job.si, "limits": {**recipe.job.si["limits"], "reversal": allowed}}
        facts = limit_facts(replace(recipe, job=replace(recipe.job, si=numbers)))
        assert [fact.value for fact in facts if fact.key == "reversal"] == [told]


def test_an_older_recipe_is_set_without(made: MadeRecipe) -> None:
    older = replace(made.recipe, line_ramp=None)
    assert len(ramp_blocks(older, catalogue("en"))) == 1
