"""The command ``camwright trace``: verdict, files, answers, refusals."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from camwright.cli.main import main
from camwright.jobs.job import BUNDLED_JOB, load_job
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.returns import baseline
from camwright.stored.profile_files import cam_text
from camwright.studies.design import optimise

JOB = str(BUNDLED_JOB)


def recording(place: Path, drift: float = 0.0, cam: CamProfile | None = None) -> Path:
    """Write a run of 12 cuts of a cam, the quintic's if none is given, whose axis loses a length (m) from cut to cut."""
    job = load_job()
    profile = baseline("poly_3_4_5", job.task) if cam is None else cam
    times = 1e-3 * np.arange(round(12 * job.cut.period / 1e-3))
    master = 0.1 + job.cut.line_speed * times
    command = profile(master, outside="repeat")
    actual = command - drift * np.round((master - 0.5) / 0.6)
    rows = zip(1e3 * times, 1e3 * master, 1e3 * command, 1e3 * actual, strict=True)
    lines = [",".join(f"{value:.6f}" for value in row) for row in rows]
    file = place / "run.csv"
    file.write_text("\n".join(["time [ms],master [mm],command [mm],actual [mm]", *lines]) + "\n", encoding="utf-8")
    return file


@pytest.fixture(scope="module")
def cam(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Write the cam of the recordings as a table."""
    design = optimise(load_job())
    profile = baseline("poly_3_4_5", design.job.task)
    grid = np.linspace(0.0, 0.6, 1201)
    lines = [f"{1e3 * x:.6f},{1e3 * float(profile(x)):.9f}" for x in grid.tolist()]
    file = tmp_path_factory.mktemp("cam") / "cam.csv"
    file.write_text("\n".join(["x [mm],y [mm]", *lines]) + "\n", encoding="utf-8")
    (file.parent / "optimum.csv").write_text(cam_text(design), encoding="utf-8")
    return file


def test_a_run_within_tolerance(tmp_path: Path, cam: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out"
    file = recording(tmp_path, 1e-6)
    assert main(["trace", str(file), "--job", JOB, "--design", str(cam), "--out", str(out), "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["passed"] is True
    assert answer["master"] == "recorded"
    assert answer["errors"]["total"]["drift_mm_per_cut"] == pytest.approx(-1e-3, rel=0.01)
    assert answer["errors"]["command"]["drift_mm_per_cut"] == pytest.approx(0.0, abs=1e-6)
    assert [cut["number"] for cut in answer["cuts"]] == list(range(1, len(answer["cuts"]) + 1))
    assert answer["cuts"][0]["length_mm"] is None
    assert answer["cuts"][3]["length_mm"] == pytest.approx(600.001, abs=1e-5)
    assert sorted(Path(each).name for each in answer["files"]) == ["trace.png", "trace.svg"]
    assert sorted(each.name for each in out.iterdir()) == [".camwright.json", "trace.png", "trace.svg"]
    first = (out / "trace.svg").read_bytes()
    assert main(["trace", str(file), "--job", JOB, "--design", str(cam), "--out", str(out), "--quiet"]) == 0
    assert (out / "trace.svg").read_bytes() == first


def test_a_run_out_of_tolerance_says_what_it_is(tmp_path: Path, cam: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = recording(tmp_path, 5e-5)
    assert main(["trace", str(file), "--job", JOB, "--design", str(cam), "--no-figures"]) == 1
    shown = capsys.readouterr().out
    for words in (
        "Errors told apart (mm)",
        "FAILED",
        "NOT within the sync tolerance; mostly drift",
        "drift: the tool loses 0.05 mm each cut, so every piece is long by that; the axis drifts off its command",
        "simulated servo",
    ):
        assert words in " ".join(shown.split())
    assert "wrote" not in shown


def test_the_design_is_made_anew_where_none_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = recording(tmp_path, 1e-6, optimise(load_job()).profile)
    assert main(["trace", str(file), "--job", JOB, "--no-figures", "--json"]) == 0
    errors = json.loads(capsys.readouterr().out)["errors"]
    assert errors["total"]["drift_mm_per_cut"] == pytest.approx(-1e-3, rel=0.01)
    assert errors["command"]["scatter_mm"] < 1e-5


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--gear", "0"], "--gear 0: it is recorded travel over the slave's"),
        (["--line-speed", "40"], "40"),
        (["--design", "none.json"], "none.json: there is no such profile file"),
    ],
)
def test_bad_options_are_refused(
    tmp_path: Path, cam: Path, capsys: pytest.CaptureFixture[str], options: list[str], message: str
) -> None:
    design = [] if "--design" in options else ["--design", str(cam)]
    assert main(["trace", str(recording(tmp_path)), "--job", JOB, *design, "--no-figures", "--json", *options]) == 2
    captured = capsys.readouterr()
    assert message in captured.err
    assert json.loads(captured.out)["exit_code"] == 2


@pytest.mark.parametrize("content", ["", "\0\1\2", "a,b\n", "time [ms],command [mm],actual [mm]\n1,2\n", "x" * 30_000])
def test_a_bad_file_is_refused(tmp_path: Path, cam: Path, capsys: pytest.CaptureFixture[str], content: str) -> None:
    file = tmp_path / "bad.csv"
    file.write_text(content, encoding="utf-8")
    assert main(["trace", str(file), "--job", JOB, "--design", str(cam), "--no-figures"]) == 2
    assert str(file) in capsys.readouterr().err
