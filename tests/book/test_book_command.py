"""The command ``camwright book``: what it prints, what it ends with, its progress."""

from __future__ import annotations

import io
import json
import sys
from pathlib import Path

import pytest
from books import JOB, inline_crew

from camwright.book import workers
from camwright.cli.book import progress
from camwright.cli.main import main

ASKED = ["book", str(JOB), "--length", "600:650:50", "--line-speed", "80"]


@pytest.fixture
def inline(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Do the work in this process; gives the numbers of workers that were asked for."""
    asked: list[int] = []

    def crew(jobs: int) -> workers.Crew:
        asked.append(jobs)
        return inline_crew()

    monkeypatch.setattr("camwright.cli.book.local_crew", crew)
    return asked


def test_the_answer_has_the_agreed_keys(inline: list[int], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*ASKED, "--out", str(tmp_path / "book"), "--json", "--targets", "csv,codesys"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert {key: answer[key] for key in ("designs", "infeasible", "failed", "resumed")} == {
        "designs": 2,
        "infeasible": 0,
        "failed": 0,
        "resumed": 0,
    }
    assert answer["designs_per_s"] > 0
    assert 10 < answer["peak_rss_mb"] < 8000  # of this process, which has run other tests before
    assert [Path(file).name for file in answer["files"]] == [
        "index.html",
        "index.xlsx",
        "index.csv",
        "limits.csv",
        "book.json",
    ]
    assert all(Path(file).exists() for file in answer["files"])
    names = {path.name for path in (tmp_path / "book/designs/600mm/80m-per-min/peak_acceleration").iterdir()}
    assert {"design.json", "report.json", "C00001_L600_V80_bdba6d61_cam.csv"} < names
    assert any(name.endswith((".st", ".xml")) for name in names)
    assert main([*ASKED, "--out", str(tmp_path / "book"), "--json", "--targets", "csv,codesys", "--resume"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert (answer["designs"], answer["resumed"], answer["designs_per_s"]) == (2, 2, 0.0)


def test_people_are_told_how_it_ended(
    inline: list[int], tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main([*ASKED, "--jobs", "7"]) == 0
    shown = capsys.readouterr()
    assert "paper-600: a book of 2 designs" in shown.out
    assert "2 made at" in shown.out
    assert "wrote out/paper-600-book/limits.csv" in shown.out
    assert not shown.err
    assert inline == [2]  # no more workers than designs
    assert main([*ASKED, "--resume", "--quiet"]) == 0
    assert capsys.readouterr() == ("", "")


def test_faults_of_all_options_are_told(capsys: pytest.CaptureFixture[str]) -> None:
    command = [
        "book",
        str(JOB),
        "--length",
        "250 s:1200:10",
        "--line-speed",
        "80:40:1",
        "--objective",
        "speed",
        "--json",
    ]
    assert main(command) == 2
    shown = capsys.readouterr()
    answer = json.loads(shown.out)
    assert (answer["status"], answer["exit_code"]) == ("error", 2)
    assert len(answer["message"].splitlines()) == 3
    assert shown.err.count("camwright: --") == 3


def test_the_progress_shows_rate_and_remaining_time(monkeypatch: pytest.MonkeyPatch) -> None:
    class Terminal(io.StringIO):
        def isatty(self) -> bool:
            return True

    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("COLUMNS", "100")
    with progress(100, quiet=False) as told:
        told(40)
        for done in range(41, 60):
            told(done)
    shown = terminal.getvalue()
    assert "40/100" in shown
    assert "59/100" in shown
    assert "designs/s" in shown


@pytest.mark.parametrize("quiet", [True, False])
def test_without_a_terminal_there_is_no_progress(quiet: bool, capsys: pytest.CaptureFixture[str]) -> None:
    with progress(10, quiet=quiet) as told:
        told(5)
    assert capsys.readouterr() == ("", "")
