"""``camwright cutlist`` and ``camwright simulate``: files, answers, exit codes, a second run, figures."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from camwright.cli.main import main
from camwright.jobs.job import BUNDLED_JOB
from camwright.production.list_file import read_line_run

JOB = str(BUNDLED_JOB)
RAMP = ("--line-acceleration", "1 m/s^2")


@pytest.fixture
def order(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "order.csv").write_text("length [mm],quantity,kind\n600,3\n300,3\n600,2\n600,1,crop\n")
    return "order.csv"


def said(capsys: pytest.CaptureFixture[str]) -> dict[str, object]:
    answer: dict[str, object] = json.loads(capsys.readouterr().out)
    return answer


def test_a_list_is_worked_out_and_written(order: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["cutlist", JOB, order, *RAMP, "--targets", "csv,codesys,logix", "--json"]) == 0
    answer = said(capsys)
    assert {"pieces", "cams", "transitions", "time_s", "time_at_slowest_s", "scrap_mm", "matrix", "seams"} <= set(
        answer
    )
    assert answer["scrap_mm"] == pytest.approx(600.0)
    files = [Path(str(file)) for file in answer["files"]]  # type: ignore[attr-defined]
    assert all((tmp_path / file).is_file() for file in files)
    assert {"cut-list.csv", "cams.csv", "changes.csv", "line-speed.csv", "line-plan.svg", "line-plan.png"} <= {
        file.name for file in files
    }
    assert {file.parent.name for file in files if file.parent.parent.name} >= {"csv", "codesys", "logix"}


def test_the_same_list_gives_the_same_bytes_and_a_shorter_one_leaves_no_old_table(
    order: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    call = ["cutlist", JOB, order, *RAMP, "--out", "made", "--json", "--no-figures"]
    assert main(call) == 0
    before = {file: file.read_bytes() for file in (tmp_path / "made").rglob("*") if file.is_file()}
    assert main(call) == 0
    assert {file: file.read_bytes() for file in (tmp_path / "made").rglob("*") if file.is_file()} == before
    assert len(list((tmp_path / "made" / "csv").glob("*.csv"))) == 2
    (tmp_path / "order.csv").write_text("length [mm],quantity\n600,3\n")
    assert main(call) == 0
    assert len(list((tmp_path / "made" / "csv").glob("*.csv"))) == 1
    capsys.readouterr()


def test_the_plan_runs_in_the_simulation(order: str, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert main(["cutlist", JOB, order, *RAMP, "--out", "made", "--quiet", "--no-figures"]) == 0
    assert main(["simulate", JOB, "--list", order, "--line", "made/line-speed.csv", "--json"]) == 0
    answer = said(capsys)
    assert (answer["line"], answer["pieces"], answer["pieces_too_fast"], answer["pieces_ramped_too_hard"]) == (
        "given",
        9,
        0,
        0,
    )
    assert (tmp_path / "out" / "paper-600-shift" / "shift.png").is_file()
    assert main(["simulate", JOB, "--list", order, *RAMP, "--no-figures", "--json", "--out", "planned"]) == 0
    again = said(capsys)
    assert again["line"] == "planned"
    assert again["time_s"] == pytest.approx(answer["time_s"], rel=1e-9)


def test_a_line_of_limited_jerk_is_planned_and_run_within_it(
    order: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = Path(JOB).read_text(encoding="utf-8") + '\n[line]\nacceleration = "1 m/s^2"\njerk = "5 m/s^3"\n'
    (tmp_path / "smooth.toml").write_text(text)
    assert main(["cutlist", "smooth.toml", order, "--out", "made", "--no-figures", "--json"]) == 0
    answer = said(capsys)
    assert answer["line_jerk_m_per_s3"] == 5.0
    assert 4.051 < float(str(answer["time_s"])) < 4.133  # without a limit of the jerk, and with the slow pieces steady
    run = read_line_run(tmp_path / "made" / "line-speed.csv")
    assert run.accelerations is not None
    assert run.hardest <= 1.0 + 1e-9
    assert (abs(np.diff(run.accelerations)) <= 5.0 * (1 + 1e-6) * np.diff(run.times) + 1e-12).all()
    call = ["simulate", "smooth.toml", "--list", order, "--no-figures", "--json"]
    assert main([*call, "--line", "made/line-speed.csv", "--out", "given"]) == 0
    given = said(capsys)
    assert (given["pieces_too_fast"], given["pieces_ramped_too_hard"]) == (0, 0)
    assert main([*call, "--out", "planned"]) == 0
    planned = said(capsys)
    assert (planned["line"], planned["time_s"]) == ("planned", pytest.approx(given["time_s"], rel=1e-6))


def test_servos_are_drawn_where_the_job_gives_ranges(
    order: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = (
        Path(JOB)
        .read_text(encoding="utf-8")
        .replace("[objective]", '[servo.tolerance]\nbandwidth = "10 %"\n\n[objective]')
    )
    (tmp_path / "ranged.toml").write_text(text)
    assert main(["simulate", "ranged.toml", "--list", order, *RAMP, "--no-figures", "--json"]) == 0
    answer = said(capsys)
    assert answer["servos"] == 9
    assert main(["simulate", JOB, "--list", order, *RAMP, "--no-figures", "--json", "--out", "plain"]) == 0
    assert said(capsys)["servos"] == 1


def test_tables_fit_a_narrow_terminal(order: str, capsys: pytest.CaptureFixture[str]) -> None:
    for call in (["cutlist", JOB, order], ["simulate", JOB, "--list", order]):
        assert main([*call, *RAMP, "--no-figures"]) == 0
        tables = [line for line in capsys.readouterr().out.splitlines() if line[:1] in "┏┃│└"]
        assert tables
        assert max(map(len, tables)) <= 84


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (["cutlist", JOB, "order.csv"], "how hard the line ramps is not stated"),
        (["cutlist", JOB, "none.csv", *RAMP], "none.csv: there is no such cut list"),
        (
            ["cutlist", JOB, "order.csv", "--line-acceleration", "1e9 m/s^2"],
            "the line's ramp is 1e9 m/s², a jump; a plan takes at most 10000 m/s²",
        ),
        (
            ["cutlist", JOB, "order.csv", "--line-acceleration", "1e-9 m/s^2"],
            "which is none; a plan takes 1e−6 m/s² at least",
        ),
        (
            ["cutlist", JOB, "far.csv", *RAMP],
            "far.csv, line 3: a piece of 1e9 mm is longer than 200000 mm, the longest that a cam is for with a sync zone of 200 mm",
        ),
        (["cutlist", JOB, "order.csv", *RAMP, "--out", ""], "--out: the name is empty"),
        (
            ["simulate", JOB, "--list", "order.csv", "--line", "creep.csv"],
            "the list takes 2.7e+08 s on this line, which is 1.35e+11 samples of the servos; at most 3e+08 are run",
        ),
        (["simulate", JOB, "--list", "order.csv", *RAMP, "--noise", "1 km"], "--noise: 1000000 mm a sample"),
        (["cutlist", JOB, "order.csv", "--line-acceleration", "1 m"], "a length, but an acceleration is expected"),
        (["simulate", JOB, "--list", "order.csv"], "how hard the line ramps is not stated"),
        (
            ["simulate", JOB, "--list", "order.csv", "--line", "order.csv", *RAMP],
            "--line-acceleration: the line's speed is given by --line",
        ),
        (
            ["simulate", JOB, "--list", "order.csv", "--line", "order.csv"],
            "order.csv, line 2: 2 cells where the header has 3",
        ),
        (["simulate", JOB, "--list", "order.csv", *RAMP, "--servos", "3"], "--servos: the job gives no ranges"),
    ],
)
def test_bad_input_is_refused_in_words(
    call: list[str], message: str, order: str, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("far.csv").write_text("length [mm],quantity\n600,3\n1e9,1\n")
    Path("creep.csv").write_text("time [s],speed [m/min]\n0,1e-6\n1,1e-6\n")
    assert main(call) == 2
    error = capsys.readouterr().err
    assert message in error
    assert "Traceback" not in error
