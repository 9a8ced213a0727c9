"""The message catalogue: the same keys and placeholders in every language, nothing left untranslated, every word with a glyph."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import pytest

from camwright import load_job
from camwright.house.language import LANGUAGES, Language
from camwright.jobs.numbers import job_numbers
from camwright.profiles.machines import MACHINES
from camwright.profiles.machines.fields import fields_of
from camwright.profiles.tables.targets import TARGETS
from camwright.recipes.build import MadeRecipe
from camwright.recipes.catalogue import catalogue
from camwright.recipes.facts import PRODUCT, SERVO
from camwright.recipes.pdf import has_glyph
from camwright.recipes.sheet import sheet

ROOT = Path(__file__).parents[2]
PLACEHOLDER = re.compile(r"\{(\w+)\}")
SAME_IN_GERMAN = {
    "head.revision", "start.master",
    "nothing", "binding.none", "binding.not_found", "section.servo", "section.import", "head.camwright", "figure.master",
    "figure.position", "column.slave", "column.master", "record.name", "sheet.parameters",
}  # fmt: skip
SAME_IN_CHINESE = {"nothing", "binding.none", "binding.not_found"}


@pytest.mark.parametrize("language", LANGUAGES)
def test_every_language_has_the_same_keys_and_placeholders(language: Language) -> None:
    english, other = catalogue("en").messages, catalogue(language).messages
    assert list(other) == list(english)
    for key, text in other.items():
        assert text.strip() == text != ""
        assert sorted(PLACEHOLDER.findall(text)) == sorted(PLACEHOLDER.findall(english[key])), key


@pytest.mark.parametrize(("language", "same"), [("de", SAME_IN_GERMAN), ("zh", SAME_IN_CHINESE)])
def test_nothing_is_left_untranslated(language: Language, same: set[str]) -> None:
    english, other = catalogue("en").messages, catalogue(language).messages
    assert {key for key, text in other.items() if text == english[key]} <= same


@pytest.mark.parametrize("language", ["de", "zh"])
def test_titles_and_import_steps_of_all_targets_are_translated(language: Language) -> None:
    said = {text for target in TARGETS.values() for text in (target.title, *target.steps)}
    assert set(catalogue(language).phrases) == said
    untranslated = {text for text in said if catalogue(language).phrase(text) == text}
    assert all(text in {target.title for target in TARGETS.values()} for text in untranslated)


@pytest.mark.parametrize("language", LANGUAGES)
def test_every_character_of_the_catalogue_has_a_glyph(language: Language) -> None:
    words = catalogue(language)
    letters = set("".join([*words.messages.values(), *words.phrases.values()]))
    assert {letter for letter in letters if not has_glyph(ord(letter))} == set()


def test_chinese_is_written_in_chinese() -> None:
    words = catalogue("zh")
    for key, text in {**words.messages, **words.phrases}.items():
        if key not in SAME_IN_CHINESE and "EasyMotion" not in text and "Cam Loader" not in text and "IDE" not in text:
            assert re.search(r"[\u4e00-\u9fff]|，", text), key


def test_every_key_is_used_and_every_used_key_exists() -> None:
    code = "\n".join(file.read_text(encoding="utf-8") for file in sorted((ROOT / "camwright/recipes").glob("*.py")))
    literal = set(re.findall(r'words\(\s*"([\w.]+)"', code))
    assert literal <= set(catalogue("en").messages)
    machine_keys = {f"machine.{each.key}" for machine in MACHINES.values() for each in fields_of(machine)} | {
        "machine.kind"
    }
    groups = (
        "column",
        "word",
        "binding",
        "before",
        "check",
        "table_check",
        "record",
        "line",
        "change",
        "change_check",
        "step",
    )  # put together from a group and a name
    for key in catalogue("en").messages:
        assert key.partition(".")[0] in groups or key in machine_keys or f'"{key}"' in code, key


@pytest.mark.parametrize("kind", MACHINES)
def test_every_machine_is_named_and_has_its_instructions(kind: str) -> None:
    keys = {f"machine.{each.key}" for each in fields_of(MACHINES[kind])}
    words = {f"before.{what}.{kind}" for what in ("direction", "scale", "zero")} | {f"word.{kind}"}
    assert keys | words <= set(catalogue("en").messages)


@pytest.mark.parametrize(
    "name", ["paper-600", "flying-saw", "chasing-shear", "thick-product", "cross-cutter", "flying-punch"]
)
def test_every_number_of_a_job_has_a_name(name: str) -> None:
    numbers = job_numbers(load_job(ROOT / "examples" / f"{name}.toml"))
    assert set(numbers["cut"]) <= set(PRODUCT)
    assert set(numbers["servo"]) <= set(SERVO)
    for key in (*(f"machine.{key}" for key in numbers["machine"]), *numbers["cut"], *numbers["servo"]):
        assert key in catalogue("en").messages, key


@pytest.mark.parametrize("language", ["de", "zh"])
def test_a_set_recipe_shows_no_english_sentence(made: MadeRecipe, saw: MadeRecipe, language: Language) -> None:
    english = catalogue("en")
    known = {text for text in english.messages.values() if len(text) > 12 and "{" not in text}
    known |= {step for target in TARGETS.values() for step in target.steps}
    for recipe in (made.recipe, saw.recipe):
        shown = str(sheet(replace(recipe, language=language), catalogue(language)))
        assert [text for text in known if text in shown] == []
        assert "{" not in "".join(re.findall(r"'text': '([^']*)'", shown))


def test_every_check_has_a_name(made: MadeRecipe, saw: MadeRecipe) -> None:
    checks = {check.name for each in (made, saw) for check in each.recipe.checks}
    checks |= {check.name for each in (made, saw) for table in each.recipe.tables for check in table.checks}
    assert {f"check.{name}" for name in checks} <= set(catalogue("en").messages)


def test_german_has_a_decimal_comma_and_only_versions_a_point(made: MadeRecipe, saw: MadeRecipe) -> None:
    for recipe in (made.recipe, saw.recipe):
        made_sheet = sheet(replace(recipe, language="de", note=""), catalogue("de"))
        sections = [
            section for section in made_sheet["sections"] if section["key"] != "section.import"
        ]  # names versions
        german = str((sections, made_sheet["groups"], made_sheet["status"], made_sheet["warnings"]))
        german = re.sub(r"'widths': \[[^\]]*\]", "", german)
        assert re.findall(r".{20}\d\.\d", german) == []
        assert len(re.findall(r"\d,\d", german)) > 20


def test_a_length_along_the_stroke_says_where_it_is_counted_from() -> None:
    for language in LANGUAGES:
        words = catalogue(language)
        assert words("check.stroke") != words("machine.stroke") != words("table_check.stroke")
    assert catalogue("en")("check.stroke") == "Distance from mid stroke"
    assert catalogue("en")("table_check.stroke") == "Beyond the stroke"


def test_chinese_has_the_terms_of_the_trade() -> None:
    said = "".join(catalogue("zh").messages.values())
    for term in ("追剪小车", "电子凸轮", "原点", "纯滞后时间"):
        assert term in said, term


def test_every_check_that_a_report_can_have_is_translated() -> None:
    sources = "".join(path.read_text(encoding="utf-8") for path in (ROOT / "validation").rglob("*.py"))
    named = set(re.findall(r"Check\(\s*\"([a-z_]+)\"", sources)) - {"recorded_sync_error"}  # a trace's, on no sheet
    assert len(named) > 5
    for language in LANGUAGES:
        assert {f"check.{name}" for name in (*named, "sync_over_line_speeds")} <= set(catalogue(language).messages)
