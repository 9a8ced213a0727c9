"""Entries and the journal: nothing is lost, nothing is taken for another book's."""

from __future__ import annotations

import json
import shutil
import sqlite3
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from books import contents, inline_crew, small_book
from hypothesis import given, settings
from hypothesis import strategies as st

from camwright.book.entry import Entry, Limit
from camwright.book.folder import BookFolder
from camwright.book.journal import Journal
from camwright.book.run import make_book
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
    stored = sqlite3.connect(tmp_path / "journal.sqlite").execute("SELECT value FROM book WHERE key = 'parameters'")
    assert json.loads(stored.fetchone()[0])["targets"] == ["csv"]


def interrupted(root: Path) -> Path:
    """Make a book whose process is gone after 8 designs, as it lies on the disk; give its journal."""
    book = small_book()

    def place(folder: BookFolder, entry: Entry, texts: dict[str, str]) -> None:
        if entry.number > 8:
            raise OSError(28, "No space left on device")
        PLACED(folder, entry, texts)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(BookFolder, "place", place)
        with pytest.raises(InputError, match="what is done is kept"):
            make_book(book, root, inline_crew())
    return root / ".book" / "journal.sqlite"


PLACED = BookFolder.place


@pytest.fixture(scope="module")
def broken_off(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Give the folder of a book that was interrupted."""
    root = tmp_path_factory.mktemp("books") / "book"
    interrupted(root)
    return root


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    """Give the files of the same book, never interrupted."""
    root = tmp_path_factory.mktemp("books") / "book"
    make_book(small_book(), root, inline_crew())
    return contents(root)


def told(*statements: str) -> Callable[[Path], None]:
    def change(journal: Path) -> None:
        base = sqlite3.connect(journal, isolation_level=None)
        base.execute("PRAGMA writable_schema = ON")
        for statement in statements:
            base.execute(statement)
        base.close()

    return change


def rewritten(change: Callable[[bytes], bytes]) -> Callable[[Path], None]:
    return lambda journal: (journal.write_bytes(change(journal.read_bytes())), None)[1]


DAMAGE: dict[str, tuple[Callable[[Path], None], str]] = {
    "broken off": (rewritten(lambda data: data[: len(data) // 2]), "damaged"),
    "broken off within a page": (rewritten(lambda data: data[:-1000]), "damaged"),
    "empty": (rewritten(lambda data: data[:0]), "it is empty, but designs are there"),
    "a changed byte": (rewritten(lambda data: data.replace(b'"peak_speed":', b'"peak_spded":', 1)), "entry . is not what was entered"),
    "a changed value": (
        told("UPDATE designs SET entry = replace(entry, '\"objective\":', '\"objective\":1')"),
        "entry . is not what was entered",
    ),
    "another layout": (told("UPDATE book SET value = '1' WHERE key = 'version'"), "of version 1, this camwright reads 2"),
    "that of an earlier version": (told("DELETE FROM book WHERE key = 'version'"), "of version 1, this camwright reads 2"),
    "rows twice": (
        told(
            "CREATE TABLE more (number INTEGER, entry TEXT NOT NULL, sha256 TEXT NOT NULL) STRICT",
            "INSERT INTO more SELECT * FROM designs",
            "INSERT INTO more SELECT * FROM designs",
            "DROP TABLE designs",
            "ALTER TABLE more RENAME TO designs",
        ),
        "its tables are not those of a journal",
    ),
    "a row under two numbers": (
        told("INSERT INTO designs SELECT 9, entry, sha256 FROM designs WHERE number = 3"),
        "entry 9 is not what was entered",
    ),
    "rows exchanged": (
        told(
            "UPDATE designs SET number = 100 WHERE number = 3",
            "UPDATE designs SET number = 3 WHERE number = 4",
            "UPDATE designs SET number = 4 WHERE number = 100",
        ),
        "entry 3 is not what was entered",
    ),
    "no JSON": (told("UPDATE designs SET entry = 'none' WHERE number = 2"), "entry 2 is not what was entered"),
    "parameters that are no JSON": (told("UPDATE book SET value = '{' WHERE key = 'parameters'"), "differs from the book's fingerprint"),
    "another job": (
        told(
            "UPDATE book SET value = '00' WHERE key = 'fingerprint'",
            "UPDATE book SET value = replace(value, 'sha256\": \"', 'sha256\": \"0')"),
        r"holds another book, --resume cannot go on with it: the job file \(SHA-256\) 0",
    ),
    "another job, unreadable": (
        told("UPDATE book SET value = '00' WHERE key = 'fingerprint'", "UPDATE book SET value = '[' WHERE key = 'parameters'"),
        "what book it belongs to cannot be read",
    ),
    "another database": (
        lambda journal: (journal.unlink(), told("CREATE TABLE mine (x)")(journal), None)[2],
        "its layout is of version unknown",
    ),
    "no database": (rewritten(lambda data: b"{}" * len(data)), "not the journal of a book"),
    "missing": (lambda journal: journal.unlink(), "not empty, and holds no book to go on with"),
}  # fmt: skip


@pytest.mark.parametrize("kind", DAMAGE)
def test_a_damaged_journal_is_refused_with_a_way_out(kind: str, broken_off: Path, tmp_path: Path) -> None:
    root = tmp_path / "book"
    shutil.copytree(broken_off, root)
    change, message = DAMAGE[kind]
    change(root / ".book" / "journal.sqlite")
    before = {path: data for path, data in contents(root).items() if not path.startswith(".book")}
    with pytest.raises(InputError, match=message) as caught:
        make_book(small_book(), root, inline_crew(), resume=True)
    assert "another --out" in str(caught.value)
    assert {path: data for path, data in contents(root).items() if not path.startswith(".book")} == before


def test_no_changed_byte_changes_the_book(broken_off: Path, whole: dict[str, bytes], tmp_path: Path) -> None:
    """Any byte of the journal may be another: refused, or the book comes out as it was, made anew where it must be."""
    data = (broken_off / ".book" / "journal.sqlite").read_bytes()
    random = np.random.default_rng(5)
    refused: list[str] = []
    for number in range(12):
        root = tmp_path / str(number)
        shutil.copytree(broken_off, root)
        at = int(random.integers(len(data)))
        (root / ".book" / "journal.sqlite").write_bytes(data[:at] + bytes([data[at] ^ 0x21]) + data[at + 1 :])
        try:
            make_book(small_book(), root, inline_crew(), resume=True)
        except InputError as error:
            refused.append(str(error))
        else:
            assert contents(root) == whole
    assert refused
    assert all("another --out" in message or "another camwright book at work" in message for message in refused)


def test_what_lies_beside_the_files_of_a_design_stays(
    broken_off: Path, whole: dict[str, bytes], tmp_path: Path
) -> None:
    root = tmp_path / "book"
    shutil.copytree(broken_off, root)
    place = next(iter(sorted(root.glob("designs/450mm/*/*"))))
    (place / "notes.txt").write_text("mine")
    (place / "design.json").unlink()
    assert make_book(small_book(), root, inline_crew(), resume=True).resumed == 7
    note = (place / "notes.txt").relative_to(root).as_posix()
    assert contents(root) == {**whole, note: b"mine"}


@pytest.mark.parametrize("where", [".book", ".book/new", ".book/journal.sqlite", "designs/450mm", "index.csv"])
def test_a_planted_link_is_not_followed(where: str, broken_off: Path, tmp_path: Path) -> None:
    root, outside = tmp_path / "book", tmp_path / "outside"
    shutil.copytree(broken_off, root)
    outside.mkdir()
    (outside / "new").mkdir()
    (outside / "new" / "precious.txt").write_text("mine")
    if (root / where).is_dir():
        shutil.copytree(root / where, outside, dirs_exist_ok=True)
        shutil.rmtree(root / where)
    elif (root / where).exists():
        (outside / "file").write_bytes((root / where).read_bytes())
        (root / where).unlink()
    target = outside / "file" if (outside / "file").exists() else outside
    (root / where).symlink_to(target)
    before = contents(outside)
    with pytest.raises(InputError, match=r"a link or a device, which no book holds; it is not followed: remove it"):
        make_book(small_book(), root, inline_crew(), resume=True)
    assert contents(outside) == before


def test_a_link_in_an_empty_folder_is_not_followed(tmp_path: Path) -> None:
    (tmp_path / "outside" / "new").mkdir(parents=True)
    (tmp_path / "outside" / "new" / "precious.txt").write_text("mine")
    (tmp_path / "book").mkdir()
    (tmp_path / "book" / ".book").symlink_to(tmp_path / "outside")
    for resume in (False, True):
        with pytest.raises(InputError, match="it is not followed"):
            make_book(small_book(), tmp_path / "book", inline_crew(), resume=resume)
    assert (tmp_path / "outside" / "new" / "precious.txt").read_text() == "mine"


def test_the_list_of_a_complete_book_protects_itself(whole: dict[str, bytes], tmp_path: Path) -> None:
    root = tmp_path / "book"
    for path, data in whole.items():
        (root / path).parent.mkdir(parents=True, exist_ok=True)
        (root / path).write_bytes(data)
    assert make_book(small_book(), root, inline_crew(), resume=True).resumed == 12
    text = (root / "book.json").read_text()
    (root / "book.json").write_text(text.replace('"passed": ', '"passed": 1', 1))
    with pytest.raises(InputError, match=r"was changed or broke off; make the book anew in another --out"):
        make_book(small_book(), root, inline_crew(), resume=True)
