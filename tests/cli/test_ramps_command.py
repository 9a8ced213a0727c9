"""The command ``camwright ramps``: its JSON, its files, its refusals, other units."""

import json
from pathlib import Path
from typing import Any

import pytest

from camwright.cli.main import main
from camwright.jobs.examples import example
from camwright.profiles.polynomial.profile import CamProfile

PAPER = str(example("paper-600").path)


def called(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    """Call the command; gives exit code, output and errors."""
    code = main(["ramps", *arguments])
    spoken = capsys.readouterr()
    return code, spoken.out, spoken.err


def answered(capsys: pytest.CaptureFixture[str], *arguments: str) -> dict[str, Any]:
    code, out, err = called(capsys, *arguments, "--json", "--no-figures")
    assert code == 0, (out, err)
    return dict(json.loads(out))


def test_the_answer_for_the_machine_of_the_paper(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    found = answered(capsys, PAPER, "--out", str(tmp_path))
    for name in ("ramp_in", "ramp_out"):
        part = found[name]
        assert (part["arc_mm"], part["master_mm"], part["time_ms"]) == pytest.approx((100, 200, 150), rel=1e-9)
        assert part["peak_acceleration_m_per_s2"] == pytest.approx(9.07177, abs=1e-5)
        assert part["lower_bound_m_per_s2"] == pytest.approx(part["peak_acceleration_m_per_s2"], rel=1e-9)
    assert found["one_shot"]["master_mm"] == pytest.approx(600, rel=1e-9)
    assert found["one_shot"]["peak_acceleration_m_per_s2"] == pytest.approx(9.07177, abs=1e-5)
    assert found["least_arc_mm"] == pytest.approx(36.296, abs=1e-3)
    assert found["standstill_up_to_m_per_s"] * 60 == pytest.approx(138.24, abs=5e-3)
    assert found["first_cut"]["sensor_ahead_mm"] == pytest.approx(185.9, abs=0.05)
    assert found["passed"]
    assert {file.name for file in tmp_path.iterdir()} == {
        ".camwright.json",
        "one_shot_paper_600_cam.csv",
        "ramp_in_paper_600_cam.csv",
        "ramp_out_paper_600_cam.csv",
        "ramps.json",
        "report.json",
    }
    stored = json.loads((tmp_path / "ramps.json").read_text())
    assert CamProfile.from_dict(stored["profiles"]["one_shot"]).length == pytest.approx(0.6)


def test_parks_are_lengths_angles_or_chosen(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    same = [
        answered(capsys, PAPER, "--out", str(tmp_path), "--park", park)["ramp_in"]["arc_mm"]
        for park in ("auto", "-200 mm", "200 mm", "180 deg", "0.5 rev")
    ]
    assert same == pytest.approx([100.0] * 5)


def test_what_is_made_least_and_the_latency_are_options(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    found = answered(
        capsys, PAPER, "--out", str(tmp_path), "--minimise", "shortest", "--latency", "0 ms", "--park", "-154.444444 mm"
    )
    assert found["ramp_in"]["time_ms"] == pytest.approx(68.06, abs=5e-3)
    assert found["ramp_in"]["master_mm"] == pytest.approx(90.74, abs=5e-3)
    assert found["ramp_in"]["objective"]["lower_bound"] * 1e3 == pytest.approx(90.74, abs=0.01)
    assert found["first_cut"]["sensor_ahead_mm"] == pytest.approx(172.593, abs=1e-3)
    cool = answered(capsys, PAPER, "--out", str(tmp_path), "--minimise", "rms_acceleration")
    assert cool["ramp_in"]["objective"]["unit"] == "m^2/s^3"
    assert cool["ramp_in"]["lower_bound_m_per_s2"] is None


def test_people_are_told_the_same(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    code, out, _ = called(capsys, PAPER, "--out", str(tmp_path), "--to", "codesys,kollmorgen-kas")
    assert code == 1  # the start cannot be closed by a cyclic spline
    for words in (
        "Start and stop at 80 m/min",
        "minimised: peak acceleration",
        "the knife stands at −200 mm",
        "185.93 mm",
    ):
        assert words in out
    assert "not every drive can run them" in out
    assert (tmp_path / "ramps.png").exists()
    assert (tmp_path / "one_shot_paper_600_kas.csv").exists()
    assert not (tmp_path / "ramp_in_paper_600_kas.csv").exists()


def test_a_crank_is_answered_in_rad(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    job = tmp_path / "crank.toml"
    text = example("chasing-shear").path.read_text().replace("gear_ratio = 10", 'gear_ratio = 10\nsync_at = "98 deg"')
    job.write_text(text)
    found = answered(capsys, str(job), "--out", str(tmp_path / "out"))
    assert found["ramp_in"]["arc_mm"] is None
    assert found["ramp_in"]["arc_rad"] > 1.0
    assert found["ramp_in"]["peak_acceleration_rad_per_s2"] >= found["ramp_in"]["lower_bound_rad_per_s2"] * (1 - 1e-9)
    assert "deg" in found["park"]


def test_a_job_in_inches_is_told_in_inches(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    job = tmp_path / "inch.toml"
    job.write_text(
        example("paper-600").path.read_text().replace('"600 mm"', '"24 in"').replace('"80 m/min"', '"260 ft/min"')
    )
    code, out, _ = called(capsys, str(job), "--out", str(tmp_path / "out"))
    assert code == 0
    assert "ft/min" in out
    assert " in " in out
    assert " mm " not in out.split("Tables as the drives")[0].replace("position", "")
    code, _, err = called(capsys, str(job), "--park", "-4 in")
    assert code == 3
    assert " in and needs" in err or " in before the sync zone" in err


@pytest.mark.parametrize(
    ("options", "code", "words"),
    [
        (("--park", "-132.6667 mm"), 3, "backing up first would do"),
        (("--park", "-132.6667 mm"), 3, "park earlier, at -136.297 mm (--park); [cut] line_speed = "),
        (("--park", "12"), 2, "--park: '12': a number without a unit"),
        (("--park", "home"), 2, "or write auto"),
        (("--minimise", "jerk"), 2, "--minimise takes one of peak_acceleration, rms_acceleration, shortest"),
        (("--latency", "10"), 2, "--latency: '10': a number without a unit"),
        (("--latency", "-1 ms"), 2, "--latency: '-1 ms': negative"),
        (("--to", "nobody"), 2, "nobody"),
        (("--minimise", "shortest", "--to", "br"), 2, "br: "),
    ],
)
def test_rejections(
    options: tuple[str, ...], code: int, words: str, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    found, _, err = called(capsys, PAPER, "--out", str(tmp_path / "out"), *options)
    assert (found, words in err) == (code, True), err
    assert "Traceback" not in err
    assert not (tmp_path / "out").exists()


def test_a_park_beside_the_guide_is_refused(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    saw = str(Path(__file__).parents[2] / "examples/flying-saw.toml")
    code, _, err = called(capsys, saw, "--out", str(tmp_path / "out"), "--park", "-1 mm")
    assert code == 3
    assert "--park: the carriage stands at -1 mm, outside its stroke from 0 mm to 1200 mm" in err
    assert "tried: park later, at 0 mm (--park)" in err
    assert not (tmp_path / "out").exists()


def test_the_same_job_gives_the_same_bytes(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    for place in ("a", "b"):
        assert called(capsys, PAPER, "--out", str(tmp_path / place), "--quiet")[0] == 0
    for file in (tmp_path / "a").iterdir():
        assert file.read_bytes() == (tmp_path / "b" / file.name).read_bytes()


def test_an_older_table_of_what_is_withheld_is_set_aside(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    old = tmp_path / "ramp_in_paper_600_kas.csv"
    old.write_text("old")
    called(capsys, PAPER, "--out", str(tmp_path), "--to", "kollmorgen-kas", "--no-figures", "--json")
    assert not old.exists()
    assert (tmp_path / "ramp_in_paper_600_kas.csv.withheld-old").read_text() == "old"


def test_own_older_tables_are_set_aside_when_an_axis_that_is_late_withholds_the_new_ones(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    text = (Path(__file__).parents[2] / "examples/flying-saw.toml").read_text(encoding="utf-8")
    saw = tmp_path / "saw.toml"
    saw.write_text(text)
    options = ("--out", str(tmp_path), "--no-figures", "--json")
    assert called(capsys, str(saw), *options)[0] == 0
    saw.write_text(text.replace("sync_tolerance", 'shear_zone_at = "0 mm"\nsync_tolerance', 1))
    code, _, err = called(capsys, str(saw), *options)
    assert code == 1, err
    tables = sorted(file.name for file in tmp_path.glob("*.csv*"))
    assert tables == [f"{kind}_flying_saw_cam.csv.withheld-old" for kind in ("one_shot", "ramp_in", "ramp_out")]
