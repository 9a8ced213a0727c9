"""Auditing foreign cams: units, zeros, straight lines, machines; the answer and the figure."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from camwright import load_job
from camwright.cli.main import main
from camwright.drives.audit import Audit, audit, audit_answer
from camwright.drives.export import export
from camwright.figures.audit import audit_figures
from camwright.jobs.job import Job
from camwright.profiles.cut import Origin
from camwright.profiles.errors import InputError
from camwright.profiles.machines import CrankSlider
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.returns import baseline
from camwright.profiles.servo import Servo
from camwright.profiles.tables.cam_table import Unit, Units

JOB = load_job()
PROFILE = baseline("double_s", JOB.task)
EXAMPLES = Path(__file__).parents[2] / "examples"


def columns(place: Path, profile: CamProfile, begin: float = 0.0, master: float = 1.0, slave: float = 1.0) -> Path:
    x = np.linspace(0.0, profile.length, 241)
    y = profile(x + begin, outside="repeat")
    place.write_text(
        "".join(f"{a * master!r};{b * slave - 3!r}\n" for a, b in zip(x.tolist(), y.tolist(), strict=True))
    )
    return place


def of(result: Audit, name: str) -> float:
    value = next(check.value for check in result.judgement.checks if check.name == name)
    assert value is not None
    return value


@pytest.mark.parametrize("target", ["logix", "codesys", "kollmorgen-kas", "trio"])
def test_an_audit_finds_what_was_written(target: str, tmp_path: Path) -> None:
    (written,) = export(PROFILE, JOB, [target])
    name, text = next(iter(written.files.items()))
    (tmp_path / name).write_bytes(text.encode())
    result = audit(tmp_path / name, JOB)
    assert result.target.name == target
    assert result.judgement.passed
    answer = audit_answer(result, tmp_path / name)
    json.dumps(answer, allow_nan=False)
    assert set(answer) >= {"target", "knots", "profile", "optimum", "saving", "checks"}
    assert set(answer["saving"]) == {"peak_acceleration_rel", "rms_acceleration_rel"}
    if target == "trio":
        assert answer["profile"]["peak_acceleration_m_per_s2"] is None  # straight lines: unbounded
        assert answer["saving_by"] == "differences at the sample time"
        own, best = (answer["sampled"][key]["peak_acceleration"] for key in ("profile", "optimum"))
    else:
        assert answer["saving_by"] == "exact"
        own, best = (answer[key]["peak_acceleration_m_per_s2"] for key in ("profile", "optimum"))
    assert own > best
    assert answer["saving"]["peak_acceleration_rel"] == pytest.approx(1 - best / own)


def test_differences_of_straight_lines_approach_the_acceleration_of_the_curve(tmp_path: Path) -> None:
    # 8192 lines of 0.07 mm: at 1 ms, 1.3 mm, the corners are smoothed out
    job = replace(JOB, servo=replace(JOB.servo, sample_time=0.001))
    (written,) = export(PROFILE, job, ["technosoft"], points=8192, force=True)
    name, text = next(iter(written.files.items()))
    (tmp_path / name).write_text(text)
    result = audit(tmp_path / name, job, target="technosoft")
    v, x = job.cut.line_speed, np.linspace(0, 0.4, 20_001)
    true = v**2 * np.abs(PROFILE(x, 2))
    assert result.sampled.peak_acceleration == pytest.approx(
        float(true.max()), rel=0.03
    )  # rounding to 0.1 um over 1 ms
    assert result.sampled.rms_acceleration == pytest.approx(float(np.sqrt(np.mean(true**2))), rel=0.01)
    assert result.saving("peak_acceleration") == pytest.approx(0.32, abs=0.02)


@pytest.mark.parametrize("units", [None, "deg,mm"])
def test_columns_in_degrees_of_the_cycle(units: str | None, tmp_path: Path) -> None:
    result = audit(columns(tmp_path / "c.csv", PROFILE, master=360 / 0.6, slave=1e3), JOB, units=units)
    assert result.judgement.passed
    assert of(result, "sync_position") < 1e-6
    assert result.cycle.length == pytest.approx(0.6)


@pytest.mark.parametrize("origin", ["return", "cut"])
@pytest.mark.parametrize("begin", [0.0, 0.05, 0.3, 0.55])
def test_the_zeros_of_master_and_slave_are_the_users_affair(origin: Origin, begin: float, tmp_path: Path) -> None:
    job = replace(JOB, cut=replace(JOB.cut, origin=origin))
    profile = baseline("cycloid", job.task)
    result = audit(columns(tmp_path / "c.csv", profile, begin=begin), job, units="m,m")
    assert of(result, "sync_position") < 2e-6
    assert any("master zero is not the job's" in note for note in result.notes) == (begin > 0)
    if begin:
        found = float(next(note for note in result.notes if "zero" in note).split(" begins ")[1].split(" mm")[0]) * 1e-3
        assert found == pytest.approx(0.6 - begin, abs=4e-4)


def test_a_cam_that_is_nowhere_in_sync_fails(tmp_path: Path) -> None:
    x = np.linspace(0, 0.6, 121)
    wave = x * (2 / 3) + 0.02 * np.sin(2 * np.pi * x / 0.6)
    (tmp_path / "c.csv").write_text("".join(f"{a!r},{b!r}\n" for a, b in zip(x.tolist(), wave.tolist(), strict=True)))
    result = audit(tmp_path / "c.csv", JOB)
    assert {check.name for check in result.judgement.checks if not check.passed} >= {"sync_position", "sync_ratio"}


@pytest.mark.parametrize(
    ("text", "units", "message"),
    [
        ("0,0\n1,1\n2,0\n", None, "its unit cannot be told from the pitch"),
        ("0,0\n300,1\n600,400\n", "deg,mm", "master period is 1000 mm, but the cut length is 600 mm; check the units"),
        ("0,0\n300,1\n600,400\n", "parsec,mm", "there is no unit 'parsec' here"),
        ("x [mm],y [mm]\n0,0\n1,1\n2,2\n600,400\n", "mm,mm", r"states its units \(m,m\); leave --units out"),
        (
            "x [mm],y [rad]\n0,0\n1,1\n2,2\n600,4\n",
            None,
            "the slave is counted in rad, but that of the job's machine in m",
        ),
    ],
)
def test_what_is_no_cam_of_the_job_is_refused(text: str, units: str | None, message: str, tmp_path: Path) -> None:
    (tmp_path / "c.csv").write_text(text)
    with pytest.raises(InputError, match=message):
        audit(tmp_path / "c.csv", JOB, units=units)


def test_a_carriage_counted_in_steps(tmp_path: Path) -> None:
    job = load_job(EXAMPLES / "flying-saw.toml")
    (written,) = export(baseline("double_s", job.task), job, ["trio"], force=True)
    name, text = next(iter(written.files.items()))
    (tmp_path / name).write_text(text)
    with pytest.raises(InputError, match="--units cycle,mm"):
        audit(tmp_path / name, job)
    result = audit(tmp_path / name, job, units="cycle,0.1 um")
    assert of(result, "sync_position") < 1e-5
    assert of(result, "stroke") < 0


def test_a_crank_is_placed_as_the_file_says(tmp_path: Path) -> None:
    free = load_job(EXAMPLES / "chasing-shear.toml")
    assert isinstance(free.machine, CrankSlider)
    job: Job = replace(free, machine=replace(free.machine, sync_at=math.radians(85)))
    profile = baseline("poly_3_4_5", job.task)
    (written,) = export(
        profile, job, ["codesys"], force=True, units=Units(Unit("mm", 1e-3), Unit("deg", math.radians(1), "rad"))
    )
    name, text = next(iter(written.files.items()))
    (tmp_path / name).write_text(text)
    result = audit(tmp_path / name, free)
    assert isinstance(result.job.machine, CrankSlider)
    assert result.job.machine.sync_at == math.radians(85)
    assert of(result, "sync_position") < 2e-6
    assert result.table.y[-1] == pytest.approx(360)
    (tmp_path / name).write_text(text.replace("sync_at", "sync"))
    with pytest.raises(InputError, match=r"give \[machine\] sync_at"):
        audit(tmp_path / name, free)


def test_an_unstable_servo_is_said(tmp_path: Path) -> None:
    job = replace(JOB, servo=Servo(80.0, 0.7, 200.0, 0.008, 1.0))
    result = audit(columns(tmp_path / "c.csv", PROFILE), job)
    assert not result.judgement.passed
    assert audit_answer(result, tmp_path / "c.csv")["profile"]["servo"] is None


def test_the_command_writes_the_figure(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "job.toml").write_text(JOB.text)
    file = columns(tmp_path / "c.csv", PROFILE, master=1e3, slave=1e3)
    call = ["audit", str(file), "--job", str(tmp_path / "job.toml"), "--units", "mm,mm"]
    assert main([*call, "--out", str(tmp_path / "out"), "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert [Path(name).name for name in answer["files"]] == ["audit.svg", "audit.png"]
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["audit.png", "audit.svg"]
    assert main([*call, "--out", str(tmp_path / "none"), "--no-figures"]) == 0
    assert "peak acceleration (m/s²)" in capsys.readouterr().out
    assert not (tmp_path / "none").exists()
    weak = JOB.text.replace('acceleration = "30 m/s^2"', 'acceleration = "10 m/s^2"')
    (tmp_path / "job.toml").write_text(weak)
    assert main([*call, "--no-figures", "--quiet"]) == 1
    assert main(["audit", str(tmp_path / "none.csv"), "--job", str(tmp_path / "job.toml"), "--no-figures"]) == 2


def test_the_figure_is_the_same_each_time(tmp_path: Path) -> None:
    result = audit(columns(tmp_path / "c.csv", PROFILE), JOB)
    pictures = []
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        pictures.append([path.read_bytes() for path in audit_figures(result, tmp_path / name)])
    assert pictures[0] == pictures[1]
    for words in (b"running cam", b"peak jerk"):
        assert len(pictures[0][0]) > 10_000
        assert words in pictures[0][0]
