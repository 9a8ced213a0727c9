"""Entries and the journal: nothing is lost, nothing is taken for another book's."""

from __future__ import annotations

import json
import sqlite3
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import pytest
from books import small_book
from hypothesis import given, settings
from hypothesis import strategies as st

from camwright.book.entry import Entry, Limit
from camwright.book.journal import Journal
from camwright.profiles.errors import InputError

NUMBER = st.one_of(st.none(), st.floats(allow_nan=False, allow_infinity=False))
ENTRIES = st.builds(
    Entry,
    number=st.integers(1, 100_000),
    status=st.sampled_from(["passed", "check_failed", "infeasible", "failed"]),
    objective=NUMBER,
    unit=st.text(),
    peak_speed=NUMBER,
    settling=NUMBER,
    failed_checks=st.lists(st.text()).map(tuple),
    tables=st.lists(st.tuples(st.text(), st.integers())).map(tuple),
    binding=st.text(),
    reason=st.text(),
    limit=st.one_of(st.none(), st.builds(Limit, NUMBER, st.text())),
    files=st.lists(st.tuples(st.text(), st.text())).map(tuple),
)


@settings(deadline=None)
@given(ENTRIES)
def test_an_entry_is_read_back_bit_by_bit(entry: Entry) -> None:
    assert repr(Entry.from_json(entry.to_json())) == repr(entry)  # repr tells zero from minus zero


def test_what_is_added_is_there_after_the_process_is_gone(tmp_path: Path) -> None:
    book = small_book()
    path = tmp_path / "journal.sqlite"
    entries = [Entry(number, "passed", objective=number / 3) for number in (7, 2, 11)]
    with Journal(path, book) as journal:
        for entry in entries:
            journal.add(entry)
        journal.add(replace(entries[0], objective=0.5))
        # what lies on the disk now, the write-ahead log with it, is what a killed process leaves
        for name in ("journal.sqlite", "journal.sqlite-wal"):
            (tmp_path / f"killed-{name}").write_bytes((tmp_path / name).read_bytes())
    with Journal(tmp_path / "killed-journal.sqlite", book) as journal:
        assert [entry.number for entry in journal.entries()] == [2, 7, 11]
        assert [entry.objective for entry in journal.entries()] == [2 / 3, 0.5, 11 / 3]
        journal.forget(7)
        assert journal.numbers() == {2, 11}


def test_another_book_is_told_by_what_differs(tmp_path: Path) -> None:
    path = tmp_path / "book" / ".book" / "journal.sqlite"
    path.parent.mkdir(parents=True)
    Journal(path, small_book()).close()
    other = small_book(targets="codesys,csv", ranges=("250:850:200", "60:120:60"))
    other = replace(other, versions=(("camwright", "9.9"),))
    with pytest.raises(InputError) as caught:
        Journal(path, other)
    text = str(caught.value)
    assert text.startswith(f"{tmp_path / 'book'}: holds another book, --resume cannot go on with it: ")
    assert "--length 250:650:200 mm there, 250:850:200 mm now" in text
    assert "--targets csv there, codesys,csv now" in text
    assert "casadi" in text
    assert "camwright 9.9 now" in text
    assert "--line-speed" not in text
    assert "--objective" not in text


def test_a_journal_in_use_is_refused(tmp_path: Path) -> None:
    book = small_book()
    with Journal(tmp_path / "journal.sqlite", book), pytest.raises(InputError, match="at work in this folder"):
        Journal(tmp_path / "journal.sqlite", book)


@pytest.mark.parametrize("data", [b"not a database, but long enough to be taken for one" * 3, b"\x00" * 100])
def test_what_is_no_journal_is_refused(tmp_path: Path, data: bytes) -> None:
    (tmp_path / "journal.sqlite").write_bytes(data)
    with pytest.raises(InputError, match="not the journal of a book"):
        Journal(tmp_path / "journal.sqlite", small_book())


def test_a_journal_that_was_just_made_is_no_other_book(tmp_path: Path) -> None:
    (tmp_path / "journal.sqlite").write_bytes(b"")
    with Journal(tmp_path / "journal.sqlite", small_book()) as journal:
        assert journal.numbers() == set()
    with closing(sqlite3.connect(tmp_path / "journal.sqlite")) as base:
        stored = base.execute("SELECT value FROM book WHERE key = 'parameters'").fetchone()
    assert json.loads(stored[0])["targets"] == ["csv"]
