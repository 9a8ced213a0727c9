"""A whole book: what it holds, against designs made one by one; going on with it; refusals."""

from __future__ import annotations

import csv
import hashlib
import json
import math
import re
import shutil
from collections.abc import Callable, Sequence
from dataclasses import replace
from html import unescape
from pathlib import Path
from typing import Any

import openpyxl
import pytest
from books import JOB, contents, inline_crew, small_book

from camwright.book import making
from camwright.book.entry import Entry
from camwright.book.folder import BookFolder
from camwright.book.making import Made, make_chunk
from camwright.book.plan import Book, Combination, plan_book
from camwright.book.run import make_book
from camwright.design.feasible.extremes import extremes
from camwright.design.optimise import Solution, solve
from camwright.design.production.marks import redesigned
from camwright.drives.export import export_possible
from camwright.jobs.job import load_job
from camwright.jobs.wording import words
from camwright.profiles.errors import (
    InfeasibleError,
    InputError,
    SolverError,
)
from camwright.profiles.mark_range import MarkRange
from camwright.profiles.objective import CommandObjective, of_command
from camwright.profiles.task import Task
from camwright.stored.design_file import read_design
from camwright.validation.production.line_ramp import line_ramp
from camwright.validation.report import ValidationReport, judge
from camwright.validation.servo.response import greatest_shear_zone_error


@pytest.fixture(scope="module")
def done(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Give the folder of a small book that was made without interruption."""
    root = tmp_path_factory.mktemp("book") / "done"
    answer = make_book(small_book(), root, inline_crew())
    assert (answer.counts.designs, answer.resumed, answer.exit_code) == (12, 0, 1)
    return root


def rows(root: Path, name: str = "index.csv") -> list[dict[str, str]]:
    """Rows of a CSV of the book."""
    lines = (root / name).read_text(encoding="utf-8").splitlines()
    return list(csv.DictReader(line for line in lines if not line.startswith("#")))


def test_the_index_says_what_designs_made_one_by_one_say(done: Path) -> None:
    """The same numbers by solver, validation and ``camwright.drives.export``, each called for itself with the job's own objects."""
    book, job = small_book(), load_job(JOB)
    found = rows(done)
    assert len(found) == len(book) == 12
    ends = set()
    for number, row in enumerate(found, start=1):
        of = book.combination(number)
        cut = replace(job.cut, length=float(of.length), line_speed=float(of.line_speed))
        own = replace(job, cut=cut, objective=of.objective)
        assert (float(row["length_mm"]), float(row["line_speed_m_per_min"])) == (
            float(of.length * 1000),
            float(of.line_speed * 60),
        )
        ends.add(row["status"])
        if row["status"] == "infeasible":
            with pytest.raises(InfeasibleError) as caught:
                solve(own.task.with_cut(cut), own.objective)
            assert row["binding"] == caught.value.binding
            assert words(caught.value.message).startswith(row["reason"])
            assert not row["folder"]
            continue
        solution = solve(own.task.with_cut(cut), own.objective)
        report = judge(solution.profile, own.task.with_cut(cut), own.servo)
        (table,) = export_possible(solution.profile, own, ["csv"])[0]
        assert (row["status"] == "passed") == (report.passed and table.passed)
        failed = [check.name for check in report.checks if not check.passed]
        failed += [f"csv: {check.name}" for check in table.judgement.checks if not check.passed]
        assert row["failed_checks"] == "; ".join(failed)
        assert float(row["value"]) == solution.minimised
        assert float(row["rms_acceleration_m_per_s2"]) == report.tool.rms_acceleration
        assert report.servo is not None
        assert float(row["following_error_mm"]) == report.servo.peak_following_error * 1e3
        assert row["tables"] == (f"csv:{table.table.points}" if table.passed else "")
        stored = read_design(done / row["folder"] / "design.json")
        assert (stored.profile.coefficients == solution.profile.coefficients).all()
        assert stored.job.cut == cut
        files = sorted(path.name for path in (done / row["folder"]).iterdir())
        tables = [name for name in files if name not in ("design.json", "report.json")]
        assert len(tables) == int(table.passed)
        known_by = f"C{number:05d}_L{row['length_mm'][:-2]}_V{row['line_speed_m_per_min'][:-2]}_"
        assert all(name.startswith(known_by) and name.endswith("_cam.csv") for name in tables)
    assert ends == {"passed", "check_failed", "infeasible"}


def test_the_limit_table_gives_the_highest_speed_and_what_forbids_the_next(done: Path) -> None:
    """A naive twin: look through the index for each length and objective."""
    job, index = load_job(JOB), rows(done)
    limits = rows(done, "limits.csv")
    assert len(limits) == 6
    for row in limits:
        own = [
            entry for entry in index if (entry["length_mm"], entry["objective"]) == (row["length_mm"], row["objective"])
        ]
        works = [float(entry["line_speed_m_per_min"]) for entry in own if entry["status"] == "passed"]
        highest = max(works, default=None)
        assert row["highest_line_speed_m_per_min"] == ("" if highest is None else str(highest))
        beyond = [entry for entry in own if float(entry["line_speed_m_per_min"]) > (highest or 0.0)]
        assert row["next_line_speed_m_per_min"] == (beyond[0]["line_speed_m_per_min"] if beyond else "")
        if beyond and beyond[0]["status"] == "infeasible":
            assert row["binding"] == beyond[0]["binding"]
        elif beyond:
            assert set(row["binding"].split()) <= set(re.split("; (?:csv: )?|csv: ", beyond[0]["failed_checks"]))
        far = extremes(job.task.with_cut(replace(job.cut, length=float(row["length_mm"]) / 1e3)))
        assert far.max_line_speed is not None
        found = float(row["physical_line_speed_m_per_min"])
        assert far.max_line_speed * 60 * (1 - 1e-6) <= found <= far.max_line_speed * 60
        assert row["physical_binding"] == far.line_speed_binding
        assert highest is None or highest <= float(row["axis_in_tolerance_line_speed_m_per_min"]) <= found
        if highest is None:
            assert (row["mark_earliest_mm"], row["mark_latest_mm"]) == ("", "")
            assert (row["line_ramp_m_per_s2"], row["line_stop_m_per_s2"]) == ("", "")
        else:
            cut = replace(job.cut, length=float(row["length_mm"]) / 1e3, line_speed=highest / 60)
            marks = redesigned(job.task.with_cut(cut))
            assert float(row["mark_earliest_mm"]) == pytest.approx(marks.earliest * 1e3, abs=1.001e-3)
            assert float(row["mark_earliest_mm"]) >= marks.earliest * 1e3
            assert row["mark_latest_mm"] == ("" if marks.latest is None else f"{int(marks.latest * 1e6) / 1e3}")
            cam = solve(job.task.with_cut(cut), of_command(row["objective"])).profile
            allowed = line_ramp(cam, job.task.with_cut(cut))
            for name, value in (("ramp", allowed.ramp.value), ("stop", allowed.braking.value)):
                assert float(row[f"line_{name}_m_per_s2"]) == pytest.approx(value, rel=1e-6, abs=1e-5)
                assert float(row[f"line_{name}_m_per_s2"]) <= value


def test_all_three_indexes_say_the_same(done: Path) -> None:
    index, limits = rows(done), rows(done, "limits.csv")
    workbook = openpyxl.load_workbook(done / "index.xlsx")
    assert workbook.sheetnames == ["designs", "limits", "about"]
    for sheet, expected in (("designs", index), ("limits", limits)):
        head, *lines = workbook[sheet].iter_rows(values_only=True)
        assert list(head) == list(expected[0])
        for line, row in zip(lines, expected, strict=True):
            for cell, text in zip(line, row.values(), strict=True):
                if isinstance(cell, int | float):
                    assert cell == pytest.approx(float(text), rel=1e-15)
                else:
                    assert (cell or "") == text
    page = (done / "index.html").read_text(encoding="utf-8")
    assert '<meta name="viewport" content="width=device-width">' in page
    assert page.count('<div class="wide"><table>') == page.count("<table>")  # wide tables scroll, the page does not
    assert "://" not in page  # nothing from a network
    for row in index:
        if row["folder"]:
            assert f'href="{row["folder"]}/"' in page
            assert (done / row["folder"] / "design.json").exists()
        else:
            assert row["reason"] in unescape(page)


def test_the_list_of_files_is_complete_and_true(done: Path) -> None:
    listed = json.loads((done / "book.json").read_text(encoding="utf-8"))
    found = contents(done)
    assert {file["path"]: file["sha256"] for file in listed["files"]} == {
        path: hashlib.sha256(data).hexdigest() for path, data in found.items() if path != "book.json"
    }
    assert listed["counts"]["designs"] == 12
    assert not (done / ".book").exists()


def stopping(after: int) -> object:
    """Make a work function that is interrupted after some chunks."""
    left = after

    def work(book: Book, numbers: Sequence[int]) -> list[Made]:
        nonlocal left
        left -= 1
        if left < 0:
            raise KeyboardInterrupt
        return make_chunk(book, numbers)

    return work


@pytest.mark.parametrize("after", [0, 1, 4])
def test_a_book_that_was_interrupted_ends_with_the_same_bytes(done: Path, tmp_path: Path, after: int) -> None:
    book, root = small_book(), tmp_path / "book"
    with pytest.raises(KeyboardInterrupt):
        make_book(book, root, inline_crew(stopping(after)))
    assert (root / ".book" / "journal.sqlite").exists()
    assert not (root / "book.json").exists()
    with pytest.raises(InputError, match="holds a book that is not complete; go on with it by --resume"):
        make_book(book, root, inline_crew())
    told: list[int] = []
    answer = make_book(book, root, inline_crew(), resume=True, told=told.append)
    # two chunks of two designs are in flight at a time
    assert answer.resumed == told[0] == 2 * (after - after % 2)
    assert told == list(range(told[0], 13))
    assert contents(root) == contents(done)


def test_what_was_done_is_not_done_again_unless_its_files_differ(done: Path, tmp_path: Path) -> None:
    book, root = small_book(), tmp_path / "book"
    with pytest.raises(KeyboardInterrupt):
        make_book(book, root, inline_crew(stopping(5)))
    folders = [root / book.combination(number).folder for number in (5, 6, 7)]
    shutil.rmtree(folders[0])
    damaged = folders[1] / "design.json"
    damaged.write_bytes(damaged.read_bytes().replace(b"1", b"2", 1))
    made: list[int] = []

    def work(book: Book, numbers: Sequence[int]) -> list[Made]:
        made.extend(numbers)
        return make_chunk(book, numbers)

    answer = make_book(book, root, inline_crew(work), resume=True)
    assert sorted(made) == [5, 6, 9, 10, 11, 12]
    assert answer.resumed == 6
    assert contents(root) == contents(done)


def test_files_without_a_line_in_the_journal_are_made_again(done: Path, tmp_path: Path) -> None:
    """What a process leaves that is killed between moving the files and writing the journal."""
    book, root = small_book(), tmp_path / "book"
    with pytest.raises(KeyboardInterrupt):
        make_book(book, root, inline_crew(stopping(2)))
    place = root / book.combination(9).folder
    place.mkdir(parents=True)
    (place / "design.json").write_text("half")
    (root / ".book" / "new" / "10").mkdir(parents=True)
    assert make_book(book, root, inline_crew(), resume=True).resumed == 4
    assert contents(root) == contents(done)


def test_a_complete_book_is_answered_for(done: Path, tmp_path: Path) -> None:
    book, root = small_book(), tmp_path / "book"
    shutil.copytree(done, root)
    (root / ".book").mkdir()  # killed while clearing away
    answer = make_book(book, root, inline_crew(), resume=True)
    assert (answer.resumed, answer.rate, answer.exit_code) == (12, 0.0, 1)
    assert not (root / ".book").exists()
    with pytest.raises(InputError, match="holds a complete book; choose another --out"):
        make_book(book, root, inline_crew())
    with pytest.raises(InputError, match="--targets csv there, codesys now"):
        make_book(small_book(targets="codesys"), root, inline_crew(), resume=True)
    file = root / "designs/650mm/60m-per-min/peak_acceleration/report.json"
    file.write_bytes(file.read_bytes() + b" ")
    with pytest.raises(
        InputError, match=f"1 of its files are missing or were changed, the first {file.relative_to(root)}"
    ):
        make_book(book, root, inline_crew(), resume=True)
    (root / "book.json").write_text("{}")
    with pytest.raises(InputError, match=r"not the list of a book's files"):
        make_book(book, root, inline_crew(), resume=True)


def test_resume_begins_a_book_that_is_not_there(done: Path, tmp_path: Path) -> None:
    (tmp_path / "book" / ".book").mkdir(parents=True)  # killed before the journal was there
    assert make_book(small_book(), tmp_path / "book", inline_crew(), resume=True).resumed == 0
    assert contents(tmp_path / "book") == contents(done)


def test_a_folder_with_other_files_is_refused(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("mine")
    for resume, advice in ((False, "choose another --out"), (True, "leave out --resume")):
        with pytest.raises(InputError, match=f"not empty, and holds no book to go on with; {advice}"):
            make_book(small_book(), tmp_path, inline_crew(), resume=resume)
    assert [file.name for file in tmp_path.iterdir()] == ["notes.txt"]


def test_a_folder_that_cannot_be_made_is_refused(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(InputError, match="the folder of the book cannot be made"):
        make_book(small_book(), tmp_path / "file" / "book", inline_crew())


def test_a_disk_that_is_full_keeps_what_is_done(done: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    book, root = small_book(), tmp_path / "book"
    placed = BookFolder.place

    def place(folder: BookFolder, entry: Entry, texts: dict[str, str]) -> None:
        if entry.number > 8:
            raise OSError(28, "No space left on device")
        placed(folder, entry, texts)

    with monkeypatch.context() as patch:
        patch.setattr(BookFolder, "place", place)
        with pytest.raises(InputError, match=r"cannot be written: .*No space left on device; what is done is kept"):
            make_book(book, root, inline_crew())
    assert make_book(book, root, inline_crew(), resume=True).resumed == 8
    assert contents(root) == contents(done)


def test_a_solver_that_fails_is_listed(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    def solve(*given: object, **named: object) -> None:
        raise SolverError("the solver ended without an answer")

    monkeypatch.setattr("camwright.studies.axis_study.solve", solve)
    book = plan_book(load_job(JOB), "600", "60:80:20", [])
    answer = make_book(book, tmp_path / "book", inline_crew())
    assert (answer.counts.failed, answer.exit_code) == (2, 4)
    assert [row["status"] for row in rows(tmp_path / "book")] == ["failed", "failed"]
    assert {row["reason"] for row in rows(tmp_path / "book")} == {"the solver ended without an answer"}
    assert rows(tmp_path / "book", "limits.csv")[0]["binding"] == "solver"


def test_combinations_that_are_no_job_are_listed(tmp_path: Path) -> None:
    book = plan_book(load_job(JOB), "150:600:450", "80:220:140", [])
    answer = make_book(book, tmp_path / "book", inline_crew())
    found = rows(tmp_path / "book")
    assert [row["status"] for row in found] == ["infeasible", "infeasible", "passed", "infeasible"]
    assert "[cut] sync_zone = 200 mm: not below [cut] length = 150 mm" in found[0]["reason"]
    assert [row["binding"] for row in found] == ["sync_zone", "sync_zone", "", "speed"]
    assert answer.exit_code == 0


def test_a_book_of_nothing_that_works_is_infeasible(tmp_path: Path) -> None:
    book = plan_book(load_job(JOB), "250", "120", [])
    assert make_book(book, tmp_path / "book", inline_crew()).exit_code == 3


def test_the_worst_servo_of_the_ranges_stands_beside_the_jobs_own(tmp_path: Path) -> None:
    """A row failed by ``servo_tolerance`` while the one error that it gave was within the tolerance."""
    text = JOB.read_text(encoding="utf-8") + '\n[servo.tolerance]\nbandwidth = "30 %"\n'
    (tmp_path / "job.toml").write_text(text, encoding="utf-8")
    make_book(plan_book(load_job(tmp_path / "job.toml"), "600", "100", []), tmp_path / "book", inline_crew())
    (row,) = rows(tmp_path / "book")
    assert row["failed_checks"] == "servo_tolerance"
    stored = read_design(tmp_path / "book" / row["folder"] / "design.json")
    worst = max(
        greatest_shear_zone_error(stored.profile, stored.job.task, replace(stored.job.servo, bandwidth=120.0 * share))
        for share in (0.7, 1.0, 1.3)
    )
    assert float(row["worst_shear_zone_error_mm"]) == pytest.approx(1e3 * worst, rel=1e-6)
    assert float(row["shear_zone_error_mm"]) < 0.1 < float(row["worst_shear_zone_error_mm"])
    assert "worst servo mm" in (tmp_path / "book" / "index.html").read_text(encoding="utf-8")


def test_targets_that_cannot_take_a_cam_are_listed(tmp_path: Path) -> None:
    job = tmp_path / "job.toml"
    job.write_text(JOB.read_text(encoding="utf-8").replace('"400 mm"', '"400.00003 mm"'), encoding="utf-8")
    book = plan_book(load_job(job), "600", "80", [], "csv,br")
    make_book(book, tmp_path / "book", inline_crew())
    (row,) = rows(tmp_path / "book")
    assert row["status"] == "check_failed"
    assert row["failed_checks"] == "br: refused"
    assert "br: this drive takes whole periods" in row["reason"]
    assert row["tables"].startswith("csv:")


def test_names_are_escaped_and_no_cell_is_a_formula(tmp_path: Path) -> None:
    job = tmp_path / "job.toml"
    text = JOB.read_text(encoding="utf-8")
    job.write_text(text.replace('name = "paper-600"', 'name = "=1+1&\'SUM(A1) {script} @x"'), encoding="utf-8")
    make_book(plan_book(load_job(job), "600", "80", []), tmp_path / "book", inline_crew())
    page = (tmp_path / "book" / "index.html").read_text(encoding="utf-8")
    assert "=1+1&amp;&#x27;SUM(A1)" in page
    workbook = openpyxl.load_workbook(tmp_path / "book" / "index.xlsx")
    types = {cell.data_type for sheet in workbook for line in sheet.iter_rows() for cell in line}
    assert types <= {"s", "n", "inlineStr"}
    assert workbook["about"]["B2"].value == "=1+1&'SUM(A1) {script} @x"
    for name in ("index.csv", "limits.csv"):
        for row in rows(tmp_path / "book", name):
            assert not any(cell and cell[0] in "=+@" for cell in row.values())


def test_workers_of_another_version_are_refused(tmp_path: Path) -> None:
    book = replace(small_book(), versions=(("camwright", "9.9.9"),))
    with pytest.raises(InputError, match=r"a worker runs camwright \S+, but this book is made with 9\.9\.9"):
        make_book(book, tmp_path / "book", inline_crew())


def test_what_nobody_foresaw_is_a_row_and_the_book_goes_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def breaks(task: Task, objective: CommandObjective, *, suggest: bool) -> Solution:
        if objective == "rms_acceleration":
            raise ZeroDivisionError("by nothing")
        return solve(task, objective, suggest=suggest)

    monkeypatch.setattr("camwright.studies.axis_study.solve", breaks)
    book = plan_book(load_job(JOB), "600", "60:80:20", ["rms_acceleration", "peak_jerk"])
    answer = make_book(book, tmp_path / "book", inline_crew())
    assert (answer.counts.failed, answer.counts.passed + answer.counts.check_failed) == (2, 2)
    reasons = [row["reason"] for row in rows(tmp_path / "book") if row["status"] == "failed"]
    assert all("a fault of camwright, not of the job: ZeroDivisionError: by nothing" in reason for reason in reasons)


def test_an_error_that_nobody_foresaw_is_the_row_of_its_job(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The book goes on, ends with what was found, and going on with it changes nothing."""
    own = making.make

    def make(book: Book, combination: Combination) -> tuple[Entry, dict[str, str]]:
        if combination.number == 3:
            raise ZeroDivisionError("float division by zero")
        return own(book, combination)

    monkeypatch.setattr(making, "make", make)
    root = tmp_path / "book"
    answer = make_book(small_book(), root, inline_crew())
    assert (answer.counts.designs, answer.counts.failed, answer.exit_code) == (12, 1, 4)
    found = rows(root)
    assert found[2]["status"] == "failed"
    assert "float division by zero" in found[2]["reason"]
    assert [row["status"] for row in found].count("failed") == 1
    before = contents(root)
    again = make_book(small_book(), root, inline_crew(), resume=True)
    assert (again.counts.failed, again.resumed) == (1, 12)
    assert contents(root) == before


def without_a_number(report: ValidationReport) -> ValidationReport:
    """Give a report whose peak speed is no number."""
    return replace(report, tool=replace(report.tool, peak_speed=math.nan))


def raises(error: Exception) -> Callable[[object], object]:
    """Make what a call gives that ends in an error."""

    def end(_given: object) -> object:
        raise error

    return end


@pytest.mark.parametrize(
    ("point", "becomes", "words"),
    [
        ("judge", without_a_number, "not JSON compliant"),
        ("fastest_line", lambda _: (math.nan, "speed"), "float"),
        ("next_lengths", lambda _: MarkRange(math.nan, None), "not JSON compliant"),
        ("solve_job", raises(ValueError("\udc80\x00\x1b[31m")), "ValueError: \\udc80\\x00\\x1b[31m"),
        ("fastest_line", raises(SolverError("no end")), "no end"),
        ("next_lengths", raises(SolverError("no end")), "no end"),
        ("export_possible", raises(MemoryError()), "MemoryError"),
    ],
)
def test_whatever_a_design_ends_in_is_its_row(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    point: str,
    becomes: Callable[[Any], object],
    words: str,
) -> None:
    """At any depth: a number that is none, a text that no file can hold, a solver without an answer."""
    own, calls = getattr(making, point), []

    def once(*given: object, **named: object) -> object:
        calls.append(1)
        found = own(*given, **named)
        return becomes(found) if len(calls) == 1 else found

    monkeypatch.setattr(making, point, once)
    root, book = tmp_path / "book", plan_book(load_job(JOB), "600", "60:80:20", [], "csv")
    answer = make_book(book, root, inline_crew())
    assert answer.exit_code == 4
    assert [row["status"] for row in rows(root)] == ["failed", "passed"]
    assert words in rows(root)[0]["reason"]
    assert len(rows(root, "limits.csv")) == 1
    before = contents(root)
    assert make_book(book, root, inline_crew(), resume=True).exit_code == 4
    assert contents(root) == before


def test_a_design_of_a_book_says_that_its_bound_was_not_computed(done: Path) -> None:
    for file in done.rglob("design.json"):
        answer = json.loads(file.read_text(encoding="utf-8"))
        assert answer["lower_bound_method"] == "not computed"
        assert (answer["objective"]["lower_bound"], answer["objective"]["gap"]) == (None, None)
