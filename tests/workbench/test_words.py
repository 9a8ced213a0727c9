"""The words of the page: every language has them all, and all that the page asks for."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from starlette.testclient import TestClient

from camwright.jobs.job import load_job
from camwright.jobs.keys import job_keys
from camwright.profiles.laws import LAWS
from camwright.profiles.objective import OBJECTIVES
from camwright.studies.comparison import law_names

EXAMPLES = Path(__file__).parents[2] / "examples"
PAGE = Path(__file__).parents[2] / "camwright" / "workbench" / "page"
ASKED = {
    word
    for file in (*PAGE.rglob("*.js"), *PAGE.rglob("*.html"))
    for word in re.findall(r'\bword\("([^"]+)"\)|data-(?:word|label)="([^"]+)"', file.read_text(encoding="utf-8"))
    for word in word
    if word
}


@pytest.fixture(scope="module", params=["en", "de", "zh"])
def words(request: pytest.FixtureRequest, bench: TestClient) -> dict[str, str]:
    found: dict[str, str] = bench.get("/api/words", params={"language": request.param}).json()
    return found


def test_what_the_page_asks_for_is_there(words: dict[str, str]) -> None:
    assert len(ASKED) > 100
    assert words.keys() >= ASKED
    assert all(words.values())


def test_names_of_the_program_have_words(words: dict[str, str]) -> None:
    assert {f"word.{name}" for name in OBJECTIVES} <= words.keys()
    assert set(LAWS) - {"linear"} <= words.keys()
    assert {f"table.{key.table}" for key in job_keys() if key.table} <= words.keys()
    for example in EXAMPLES.glob("*.toml"):
        job = load_job(example)
        assert set(law_names(job.task if job.machine.placed else job.task.placed_midway())) <= words.keys()
    assert words["check.sync_ratio"]  # of the recipes' catalogue


def test_every_language_has_the_same_words() -> None:
    known = {path.stem: json.loads(path.read_text(encoding="utf-8")) for path in (PAGE / "words").glob("*.json")}
    assert set(known) == {"en", "de", "zh"}
    for language, words in known.items():
        own = [key for key in words if not key.startswith("meaning.")]
        assert own == [key for key in known["en"] if not key.startswith("meaning.")], language


def test_every_key_of_a_job_is_named_and_explained_in_every_language(words: dict[str, str]) -> None:
    paths = {key.path for key in job_keys()}
    assert {f"{group}.{path}" for group in ("field", "meaning") for path in paths} <= words.keys()
    of_jobs = {key.partition(".")[2] for key in words if key.startswith(("meaning.", "field."))}
    assert of_jobs <= paths, "words of keys that no job has"


def test_meanings_are_translated_and_the_english_ones_stand_in_one_place() -> None:
    known = {path.stem: json.loads(path.read_text(encoding="utf-8")) for path in (PAGE / "words").glob("*.json")}
    paths = {key.path: key.meaning for key in job_keys()}
    assert not any(key.startswith("meaning.") for key in known["en"])
    for language in ("de", "zh"):
        meanings = {key.partition(".")[2]: text for key, text in known[language].items() if key.startswith("meaning.")}
        assert meanings.keys() == paths.keys()
        assert all(text != paths[path] for path, text in meanings.items())


def test_another_language_is_refused(bench: TestClient) -> None:
    answer = bench.get("/api/words", params={"language": "../en"})
    assert answer.status_code == 422
    assert "it is en, de, zh" in answer.json()["message"]
