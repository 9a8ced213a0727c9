"""The command ``camwright quick``: what it prints, writes and refuses."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from camwright.cli.main import main
from camwright.house.owned import LIST
from camwright.jobs.job import load_job
from camwright.profiles.cross_cutter import CrossCut
from camwright.stored.profile_files import read_cycle
from camwright.studies.quick import quick_answer, quick_cam_text, quick_rows, read_cross_cut

EXAMPLE = Path(__file__).parents[2] / "examples" / "cross-cutter.toml"
KEYS = ["case", "critical_length_mm", "min_ratio", "standstill_mm", "completed"]


def options(circumference: str = "400mm", sync: str = "200mm", length: str = "600mm") -> list[str]:
    return ["quick", "--circumference", circumference, "--sync", sync, "--length", length]


def asked(capsys: pytest.CaptureFixture[str], *more: str, **lengths: str) -> dict[str, Any]:
    assert main([*options(**lengths), "--json", *more]) == 0
    shown = capsys.readouterr()
    assert shown.err == ""
    answer = json.loads(shown.out)
    assert isinstance(answer, dict)
    return answer


@pytest.mark.parametrize(
    ("length", "case", "least", "stand", "completed"),
    [
        ("300mm", 1, 1.0, 0.0, False),
        ("400 mm", 2, 1.0, 0.0, False),
        ("0.4 m", 2, 1.0, 0.0, False),
        ("600mm", 3, 0.0625, 0.0, False),
        ("65 cm", 3, 0.0, 0.0, True),
        ("700mm", 3, 0.0, 0.0, False),
        ("900mm", 3, 0.0, 200.0, False),
    ],
)
def test_quick_prints_the_promised_object(
    length: str, case: int, least: float, stand: float, completed: bool, capsys: pytest.CaptureFixture[str]
) -> None:
    answer = asked(capsys, length=length)
    assert list(answer) == KEYS
    assert (answer["case"], answer["completed"]) == (case, completed)
    assert answer["critical_length_mm"] == pytest.approx(4400 / 7, abs=1e-9)
    assert answer["min_ratio"] == pytest.approx(least, abs=1e-12)
    assert answer["standstill_mm"] == pytest.approx(stand, abs=1e-9)


@pytest.mark.parametrize(
    ("length", "words"),
    [
        ("300mm", ["1: the knife runs faster", "quintic"]),
        ("400mm", ["2: the knife runs with the line", "straight line"]),
        ("600mm", ["3: the knife runs slower", "0.0625", "628.571 mm"]),
        ("650mm", ["completed: the patent defines no curve for this cut length"]),
        ("900mm", ["decelerate, stand, accelerate", "200 mm of material"]),
    ],
)
def test_quick_shows_a_table(length: str, words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(options(length=length)) == 0
    shown = capsys.readouterr()
    assert all(word in shown.out for word in words)
    assert shown.err == ""
    assert main([*options(length=length), "--quiet"]) == 0
    assert capsys.readouterr() == ("", "")


@pytest.mark.parametrize("length", ["300mm", "400mm", "600mm", "650mm", "900mm"])
def test_the_file_holds_the_cycle(length: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    answer = asked(capsys, "--out", str(tmp_path / "new"), length=length)
    file = tmp_path / "new" / "cam.csv"
    assert list(answer) == [*KEYS, "files"]
    assert answer["files"] == [str(file)]
    assert sorted(entry.name for entry in file.parent.iterdir()) == [LIST, "cam.csv"]
    cut = read_cross_cut("400mm", "200mm", length)
    assert file.read_text() == quick_cam_text(cut)
    assert f"# completed: {str(cut.completed).lower()}\n" in file.read_text()
    job = load_job(EXAMPLE)
    read = read_cycle(file, replace(job, cut=replace(job.cut, length=cut.cut_length)))[0]
    x = np.linspace(0.0, cut.cut_length, 500)
    np.testing.assert_allclose(read(x), cut.cycle()(x), atol=1e-12)


def test_the_cycle_passes_the_checks_of_the_example(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    job = load_job(EXAMPLE)
    assert job.cut.origin == "cut"
    lengths = (job.machine.circumference, job.cut.sync_zone, job.cut.length)
    assert CrossCut(*lengths) == read_cross_cut("400mm", "200mm", "900mm")
    assert main([*options(length="900mm"), "--out", str(tmp_path), "--quiet"]) == 0
    assert main(["validate", str(tmp_path / "cam.csv"), "--job", str(EXAMPLE), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["profile"]["min_speed_m_per_s"] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(
    ("lengths", "message"),
    [
        ({"length": "600"}, "--length '600': a number without a unit; write e.g. \"600 mm\""),
        ({"length": "0 mm"}, "--length '0 mm': zero; a length greater than zero is expected"),
        ({"length": "-600mm"}, "--length '-600mm': negative"),
        ({"sync": "200 m/min"}, "--sync '200 m/min': a speed, but a length is expected"),
        ({"circumference": "wide"}, "--circumference 'wide': not a length"),
        ({"sync": "400mm"}, "sync zone = 400 mm: not below the circumference of 400 mm"),
        ({"length": "150mm"}, "sync zone = 200 mm: not below the cut length of 150 mm"),
    ],
)
@pytest.mark.parametrize("as_json", [False, True])
def test_bad_lengths_end_with_2_and_leave_nothing(
    lengths: dict[str, str], message: str, as_json: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    more = ["--json"] if as_json else []
    assert main([*options(**lengths), "--out", str(tmp_path / "new"), *more]) == 2
    shown = capsys.readouterr()
    assert f"camwright: {message}" in shown.err
    assert (message in json.loads(shown.out)["message"]) if as_json else (shown.out == "")
    assert list(tmp_path.iterdir()) == []


def test_all_faults_are_told(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(options("400", "0mm", "600 kg")) == 2
    lines = capsys.readouterr().err.splitlines()
    assert [line.split()[1] for line in lines] == ["--circumference", "--sync", "--length"]
    assert main(options("400mm", "700mm", "600mm")) == 2
    assert len(capsys.readouterr().err.splitlines()) == 2


def test_a_length_that_is_not_given_is_missed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["quick", "--circumference", "400mm", "--length", "600mm"]) == 2
    assert "Missing option '--sync'" in capsys.readouterr().err


def test_the_answer_takes_the_measures_of_the_cut() -> None:
    cut = CrossCut(0.4, 0.2, 0.6)
    assert quick_answer(cut)["min_ratio"] == pytest.approx(0.0625, abs=1e-12)
    assert dict(quick_rows(cut))["least ratio"] == "0.0625"
