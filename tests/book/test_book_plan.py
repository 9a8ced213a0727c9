"""The plan of a book: numbers, names, the job of each combination."""

from __future__ import annotations

import pickle
import tomllib
from dataclasses import replace
from fractions import Fraction
from itertools import product
from pathlib import Path

import pytest
from books import JOB, ROOT, small_book
from hypothesis import given, settings
from hypothesis import strategies as st

from camwright.book.plan import plan_book
from camwright.jobs.job import load_job, parse_job
from camwright.jobs.toml_text import toml_text
from camwright.profiles.errors import InputError
from camwright.profiles.tables.target import Header

EXAMPLES = sorted((ROOT / "examples").glob("*.toml"))


def test_combinations_are_numbered_by_length_then_speed_then_objective() -> None:
    book = small_book()
    found = [book.combination(number) for number in range(1, len(book) + 1)]
    assert [(of.length, of.line_speed, of.objective) for of in found] == list(
        product(book.lengths, book.line_speeds, book.objectives)
    )
    assert [of.number for of in found if of.first] == [1, 5, 9]
    assert len({of.folder for of in found}) == len(book)
    assert found[4].folder == "designs/450mm/60m-per-min/peak_acceleration"


@pytest.mark.parametrize("file", EXAMPLES, ids=lambda file: file.stem)
def test_the_job_of_a_combination_is_the_job_with_its_numbers(file: Path) -> None:
    job = load_job(file)
    book = plan_book(job, "811.3:991.3:90", "17:29:6", ["rms_acceleration"])
    of = book.combination(5)
    found = book.job(of)
    assert of.length == Fraction(9013, 10_000)
    cut = replace(job.cut.designed_at(23 / 60), length=0.9013)
    same = replace(job, name=found.name, cut=cut, objective="rms_acceleration")
    assert repr(found) == repr(same)  # of a free crank the place of the sync zone is not a number, which equals nothing
    assert repr(parse_job(found.text, "again")) == repr(found)


def test_a_speed_without_an_end_of_its_digits_is_kept_as_a_float() -> None:
    book = plan_book(load_job(JOB), "600", "1 km/h", [])
    assert book.job(book.combination(1)).cut.line_speed == 1000 / 3600


def test_names_in_the_controller_differ() -> None:
    book = plan_book(load_job(JOB), "250:1200:12.5", "40:120:20", ["peak_jerk", "rms_jerk"])
    names = [book.job(book.combination(number)).name for number in range(1, len(book) + 1, 7)]
    assert len({Header(name, "1").identifier for name in names}) == len(names)


def test_a_long_name_stays_within_what_a_job_may_be_called() -> None:
    job = replace(load_job(JOB), name="x" * 60)
    book = plan_book(job, "600", "80", [])
    assert len(book.job(book.combination(1)).name) == 60


VALUES = st.recursive(
    st.one_of(st.text(), st.booleans(), st.integers(-(2**60), 2**60), st.floats(allow_nan=False, allow_infinity=False)),
    lambda inner: st.lists(inner, max_size=3),
    max_leaves=6,
)
TABLES = st.recursive(
    st.dictionaries(st.text(), VALUES, max_size=4),
    lambda inner: st.dictionaries(st.text(), st.one_of(VALUES, inner), max_size=4),
    max_leaves=8,
)


@settings(deadline=None)
@given(TABLES)
def test_job_text_is_read_back_as_it_was(data: dict[str, object]) -> None:
    assert tomllib.loads(toml_text(data)) == data


def test_tables_in_arrays_are_written_too() -> None:
    data = {"a": [{"b": "c", "d": [1, 2]}, {}]}
    assert tomllib.loads(toml_text(data)) == data


def test_all_faults_are_told_at_once() -> None:
    with pytest.raises(InputError) as caught:
        plan_book(load_job(JOB), "250 s", "40:20:1", ["peak_acceleration", "least_noise"], "csv,abacus")
    text = str(caught.value)
    assert "--length: '250 s': a time" in text
    assert "--line-speed '40:20:1': the start lies beyond the stop" in text
    assert "--objective 'least_noise': there is no such objective; the objectives are peak_acceleration" in text
    assert "there is no target 'abacus'" in text


def test_an_objective_that_is_none_for_the_job_is_refused_at_once() -> None:
    with pytest.raises(InputError, match=r"--objective rms_torque: \[objective\] minimise.*inertia"):
        plan_book(load_job(JOB), "600", "80", ["rms_jerk", "rms_torque"])


def test_targets_are_named_by_their_option() -> None:
    with pytest.raises(InputError, match="--targets names one or more targets"):
        plan_book(load_job(JOB), "600", "80", [], " , ")


def test_too_many_designs_are_refused() -> None:
    with pytest.raises(
        InputError, match=r"1000 lengths, 101 line speeds and 1 objectives are 101000 designs, the limit"
    ):
        plan_book(load_job(JOB), "1:1000:1", "20:120:1", [])


def test_values_that_are_written_alike_are_refused() -> None:
    with pytest.raises(InputError, match="neighbouring values are the same to 15 digits"):
        plan_book(load_job(JOB), "600", "59999999:59999999.0000004:0.00000007", [])


def test_a_fingerprint_tells_books_apart() -> None:
    book = small_book()
    others = [
        small_book(targets="codesys"),
        small_book(objectives=["peak_jerk"]),
        small_book(ranges=("250:650:100", "60:120:60")),
        replace(book, versions=(("camwright", "0"), *book.versions[1:])),
        replace(book, job_sha256="0" * 64),
    ]
    assert len({each.fingerprint for each in (book, *others)}) == 6
    assert pickle.loads(pickle.dumps(book)).fingerprint == small_book().fingerprint  # noqa: S301 - our own
