"""The command ``camwright marks``: its JSON, its table, its loop, its rejections, other machines and units."""

import csv
import json
from pathlib import Path
from typing import Any

import pytest

from camwright.cli.main import main
from camwright.jobs.examples import example
from camwright.production.mark_offsets import dead_time

PAPER = str(example("paper-600").path)


def called(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    """Call the command; gives exit code, output and errors."""
    code = main(["marks", *arguments])
    spoken = capsys.readouterr()
    return code, spoken.out, spoken.err


def answered(capsys: pytest.CaptureFixture[str], *arguments: str) -> dict[str, Any]:
    code, out, err = called(capsys, *arguments, "--json", "--no-figures")
    assert code == 0, (out, err)
    return dict(json.loads(out))


def job(place: Path, *changes: tuple[str, str], name: str = "paper-600") -> str:
    text = example(name).path.read_text()
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    file = place / "job.toml"
    file.write_text(text)
    return str(file)


def test_the_answer_for_the_machine_of_the_paper(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    found = answered(capsys, PAPER, "--out", str(tmp_path))
    assert found["earliest_mm"] == pytest.approx(-263.38, abs=5e-3)
    assert found["latest_mm"] is None
    assert found["proved"]
    assert found["by_method"]["master_phase"]["earliest_mm"] == 0.0
    assert found["by_method"]["master_phase"]["by_acceleration_alone"]["earliest_mm"] == pytest.approx(-121.6, abs=0.05)
    assert len(found["by_speed"]) == 10
    assert found["by_speed"][-1]["earliest_mm"] == found["earliest_mm"]
    assert [each["earliest_mm"] for each in found["by_speed"]] == sorted(
        each["earliest_mm"] for each in found["by_speed"]
    )
    assert {file.name for file in tmp_path.iterdir()} == {".camwright.json", "marks.csv", "marks.json"}
    assert json.loads((tmp_path / "marks.json").read_text()) == found


@pytest.mark.parametrize(("length", "earliest"), [("450 mm", -113.38), ("350 mm", -13.38)])
def test_other_lengths(length: str, earliest: float, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    file = job(tmp_path, ('"600 mm"', f'"{length}"'))
    assert answered(capsys, file, "--out", str(tmp_path / "out"))["earliest_mm"] == pytest.approx(earliest, abs=5e-3)


def test_the_table_lies_inside_what_was_found(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    found = answered(capsys, PAPER, "--out", str(tmp_path))
    rows = list(csv.DictReader((tmp_path / "marks.csv").read_text().splitlines()))
    assert [float(row["line_speed_m_per_min"]) for row in rows] == pytest.approx([8.0 * k for k in range(1, 11)])
    for row, each in zip(rows, found["by_speed"], strict=True):
        assert each["earliest_mm"] <= float(row["redesign_earliest_mm"]) <= each["earliest_mm"] + 1.001e-3
        assert row["redesign_latest_mm"] == ""  # no limit
        assert float(row["master_phase_latest_mm"]) <= each["master_phase"]["latest_mm"]


def test_the_loop(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    loop = answered(capsys, PAPER, "--out", str(tmp_path), "--delay", "2", "--noise", "1 mm", "--stretch", "1 mm")[
        "loop"
    ]
    assert (loop["greatest_gain"], loop["gain_without_overshoot"]) == pytest.approx((0.618, 0.148), abs=5e-4)
    assert loop["best_gain"] == pytest.approx(0.618, abs=5e-4)
    assert loop["delay_cuts"] == 2


def test_dead_time_is_the_slope_of_measured_offsets(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    file = tmp_path / "offsets.csv"
    lines = [f"{v},{0.4 + v / 60 * 1.0:.6f}" for v in (10, 20, 40, 80)]  # 1 ms, so 1 mm at 60 m/min
    file.write_text("line_speed_m_per_min,offset_mm\n" + "\n".join(lines) + "\n\n")
    found = answered(capsys, PAPER, "--out", str(tmp_path / "out"), "--offsets", str(file))["dead_time"]
    assert found["time_ms"] == pytest.approx(1.0, rel=1e-5)
    assert found["constant_mm"] == pytest.approx(0.4, rel=1e-5)
    assert found["greatest_residual_mm"] < 1e-5
    _, out, _ = called(capsys, PAPER, "--out", str(tmp_path / "out"), "--offsets", str(file), "--no-figures")
    assert "dead time 1 ms" in out
    assert "marks.csv" in out


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("speed [m/min],offset [mm]\n20,1.1\n40,1.4\n80,2.0\n", "utf-8"),
        ("Geschwindigkeit [m/min];Versatz [mm]\n20;1,1\n40;1,4\n80;2,0\n", "utf-16"),
        ("速度（m/min）\t偏移（mm）\n20\t1.1\n40\t1.4\n80\t2.0\n", "gb18030"),
        ("# shift 2\nline_speed_m_per_s;offset_m\n0,5;0,00125\n1;0,0017\n1,5;0,00215\n", "cp1252"),
    ],
)
def test_offsets_as_spreadsheets_write_them(text: str, code: str, tmp_path: Path) -> None:
    file = tmp_path / "offsets.csv"
    file.write_bytes(text.encode(code))
    found = dead_time(file)
    assert found.time == pytest.approx(0.9e-3)
    assert found.constant == pytest.approx(0.8e-3)


def test_kollmorgens_table(tmp_path: Path) -> None:
    """The maker's example: -3.1992° at 4000 rpm, so 0.0008 deg per rpm, are -133.33 µs."""
    file = tmp_path / "offsets.csv"
    turn = 1.0  # a metre a turn
    rows = [(speed, -3.1992 / 4000 * speed / 360 * turn) for speed in (500, 1000, 2000, 4000)]
    file.write_text("line_speed_m_per_min,offset_m\n" + "".join(f"{v},{y!r}\n" for v, y in rows))
    assert dead_time(file).time * 1e6 == pytest.approx(-133.3, abs=0.1)


def test_other_machines(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    found = answered(capsys, str(example("thick-product").path), "--out", str(tmp_path / "thick"))
    assert found["by_method"]["slave_offset"] is None  # its ratio changes in sync
    assert found["earliest_mm"] < -100
    crank = job(
        tmp_path,
        ("gear_ratio = 10", 'gear_ratio = 10\nsync_at = "98 deg"'),
        ('"rms_torque"', '"rms_acceleration"'),
        name="chasing-shear",
    )
    found = answered(capsys, crank, "--out", str(tmp_path / "crank"))
    assert found["earliest_mm"] < -100
    assert found["latest_mm"] is None
    assert found["proved"]


def test_a_job_in_inches_is_told_in_inches(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    file = job(tmp_path, ('"600 mm"', '"24 in"'), ('"80 m/min"', '"260 ft/min"'))
    code, out, _ = called(capsys, file, "--out", str(tmp_path / "out"))
    assert code == 0
    assert "over the line speed (in)" in out
    assert "ft/min" in out
    assert " mm" not in out


def test_a_shaped_command_bears_a_redesign_only(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    """Its axis is in sync by what the command does: a phase or an offset would change that."""
    file = job(tmp_path, ('["8 m/min", "80 m/min"]', '"80 m/min"'), name="short-cut")
    found = answered(capsys, file, "--out", str(tmp_path / "out"))
    assert found["by_method"]["master_phase"]["latest_mm"] == 0.0
    assert found["by_method"]["slave_offset"] is None
    assert found["earliest_mm"] < 0


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--delay", "-1"), "--delay takes 0 to 1000 cuts; got -1"),
        (("--noise", "1 mm"), "--noise and --stretch go together"),
        (("--stretch", "1 mm"), "--noise and --stretch go together"),
        (("--noise", "0 mm", "--stretch", "0 mm"), "both zero"),
        (("--noise", "1", "--stretch", "1 mm"), "a number without a unit"),
        (("--offsets", "nowhere.csv"), "there is no such file of offsets"),
    ],
)
def test_rejections(options: tuple[str, ...], words: str, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    code, _, err = called(capsys, PAPER, "--out", str(tmp_path / "out"), *options)
    assert (code, words in err) == (2, True), err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("speed,offset\n1,2\n", "line 1: column speed has no unit; write a header like speed [m/min],offset [mm]"),
        ("when,offset [mm]\n1,2\n", "line 1: there is no column speed"),
        ("line_speed_m_per_min,offset_mm\n10,1\n20,2\n", "2 line speeds; measure offsets at 3 at least"),
        ("line_speed_m_per_min,offset_mm\n10,1\n20,two\n30,3\n", "line 3: offset 'two' is not a finite number"),
        ("line_speed_m_per_min,offset_mm\n10,1\n20\n30,3\n", "line 3: 1 cells where the header has 2"),
        (
            "line_speed_m_per_min,offset_mm\n-10,1\n20,2\n30,3\n",
            "line 2: a line speed of -0.166667 m/s and an offset of 0.001 m",
        ),
        ("line_speed_m_per_min,offset_mm\n10,nan\n20,2\n30,3\n", "line 2: 'nan' is no number"),
    ],
)
def test_faults_of_measured_offsets(text: str, words: str, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    file = tmp_path / "offsets.csv"
    file.write_text(text)
    code, _, err = called(capsys, PAPER, "--out", str(tmp_path / "out"), "--offsets", str(file))
    assert (code, words in err) == (2, True), err
    assert "Traceback" not in err


def test_a_cut_that_cannot_be_done_is_refused(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    code, _, err = called(capsys, job(tmp_path, ('"600 mm"', '"300 mm"')), "--out", str(tmp_path / "out"))
    assert code == 3
    assert "What works" in err


def test_the_same_job_gives_the_same_bytes(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    for place in ("a", "b"):
        assert called(capsys, PAPER, "--out", str(tmp_path / place), "--quiet")[0] == 0
    for file in (tmp_path / "a").iterdir():
        assert file.read_bytes() == (tmp_path / "b" / file.name).read_bytes()
