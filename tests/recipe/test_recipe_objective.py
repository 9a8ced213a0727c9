"""A job that makes the sync error least says so wherever its objective is named."""

from __future__ import annotations

import io

import openpyxl
import pytest

from camwright import Design, optimise
from camwright.book.plan import plan_book
from camwright.figures.profile import profile_figure
from camwright.house.language import Language
from camwright.jobs.job import BUNDLED_JOB, parse_job
from camwright.recipes.build import MadeRecipe, make_recipe
from camwright.recipes.catalogue import catalogue
from camwright.recipes.sheet import sheet
from camwright.recipes.xlsx import recipe_xlsx
from camwright.stored.design_file import StoredDesign
from camwright.studies.envelope import envelope_answer
from camwright.studies.tradeoff import trade_off, tradeoff_answer

SHORT = (
    BUNDLED_JOB.read_text(encoding="utf-8")
    .replace('length = "600 mm"', 'length = "300 mm"')
    .replace('sync_zone = "200 mm"', 'sync_zone = "120 mm"')
    .replace('sync_tolerance = "0.1 mm"', 'sync_tolerance = "0.25 mm"')
    .replace('acceleration = "30 m/s^2"', 'acceleration = "100 m/s^2"')
    .replace('jerk = "3000 m/s^3"', 'jerk = "20000 m/s^3"')
    .replace('minimise = "peak_acceleration"', 'minimise = "sync_error"\nservo_aware = true\ncommand = "shaped"')
)
ALONE = SHORT.replace("servo_aware = true", 'servo_aware = true\nline_speeds = "100 %"').replace('"0.25 mm"', '"1 mm"')
ROBUST = f'{ALONE}\n[servo.tolerance]\nposition_gain = "2 %"\n'


@pytest.fixture(scope="module", params=[SHORT, ROBUST], ids=["one servo", "a range of servos"])
def design(request: pytest.FixtureRequest) -> Design:
    return optimise(parse_job(request.param, "job.toml"))


@pytest.fixture(scope="module")
def made(design: Design) -> MadeRecipe:
    return make_recipe(StoredDesign(design.profile, design.job), ["csv"])


def test_the_recipe_names_the_sync_error_and_its_value(design: Design, made: MadeRecipe) -> None:
    objective = made.recipe.objective
    assert (objective.name, objective.unit) == ("sync_error", "m")
    assert objective.value is not None
    # the design predicts at its own places, the recipe simulates: to the share that the band is drawn in by
    assert objective.value == pytest.approx(design.objective, rel=2e-2)


@pytest.mark.parametrize("language", ["en", "de", "zh"])
def test_the_sheet_names_it_in_each_language(made: MadeRecipe, language: Language) -> None:
    words = catalogue(language)
    value = made.recipe.objective.value
    assert value is not None
    head = dict(sheet(made.recipe, words)["head"])
    assert head[words("head.objective")].startswith(f"{words('word.sync_error')}: ")
    assert head[words("head.objective")].endswith(" mm")


def test_the_workbook_names_it(made: MadeRecipe) -> None:
    page = openpyxl.load_workbook(io.BytesIO(recipe_xlsx(made.recipe)))["parameters"]
    rows = {row[0]: row[1] for row in page.iter_rows(values_only=True) if row[0]}
    assert "sync error" in str(rows[catalogue("en")("head.objective")])


def test_figure_and_view_name_it(design: Design) -> None:
    title = profile_figure(design.comparison).title
    assert title.splitlines()[0].endswith("minimised: sync error")


def test_the_index_of_a_book_names_it(design: Design) -> None:
    book = plan_book(design.job, "300:310:10 mm", "80 m/min")
    assert book.objectives == ("sync_error",)
    assert book.parameters()["objective"] == ["sync_error"]
    assert [book.job(book.combination(number)).objective for number in (1, 2)] == ["sync_error"] * 2


@pytest.mark.slow
def test_a_map_and_a_trade_off_name_what_stands_for_it(design: Design) -> None:
    assert envelope_answer(design.job, 2).objective == "peak_acceleration"


def test_design_and_solution_do_not_share_a_name(design: Design) -> None:
    assert design.objective == design.solution.minimised
    assert not hasattr(design.solution, "objective")
    assert design.solution.objective_name == design.job.objective == "sync_error"


def test_a_trade_off_is_sorted_by_what_stands_for_it() -> None:
    result = trade_off(parse_job(SHORT.replace("120 mm", "80 mm").replace('"80 m/min"', '"20 m/min"'), ""))
    assert tradeoff_answer(result, [])["sorted_by"] == "peak_acceleration"
    values = [row.values["peak_acceleration"] for row in result.rows]
    bounded = [value for value in values if value is not None]
    assert bounded == sorted(bounded)
