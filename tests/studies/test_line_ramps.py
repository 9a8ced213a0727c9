"""What studies make of the ramps of a line: which profiles keep the limits, and up to which line speed a cam is released."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

from camwright.answers.line_ramps import line_ramps_answer
from camwright.cli.main import main
from camwright.cli.views.line_ramps import plc_words
from camwright.design.optimise import solve
from camwright.jobs.job import Job, load_job, parse_job
from camwright.profiles.line import STEADY, Line
from camwright.profiles.polynomial.profile import CamProfile
from camwright.studies.line_ramps import designed_ramps, line_ramps
from camwright.studies.speed_band import RAMP, job_band
from camwright.studies.within_limits import keeps_limits
from camwright.validation.motion import measure_motion
from camwright.validation.production.line_ramp import line_ramp
from camwright.validation.report import judge

FILE = Path(__file__).parents[2] / "examples" / "ramping-line.toml"


@cache
def cams() -> tuple[Job, CamProfile, CamProfile]:
    """Give the job of a line that ramps, the cam that bears it, and the optimum of a steady line."""
    job = load_job(FILE)
    return (
        job,
        solve(job.task, "peak_acceleration").profile,
        solve(job.task.with_line(STEADY), "peak_acceleration").profile,
    )


def test_a_profile_that_does_not_bear_the_ramps_breaks_a_limit() -> None:
    job, bears, steady = cams()
    assert keeps_limits(bears, measure_motion(bears, job.task), job)
    assert not keeps_limits(steady, measure_motion(steady, job.task), job)
    assert keeps_limits(steady, measure_motion(steady, job.task), replace(job, line=STEADY))


def test_a_cam_is_released_up_to_the_line_speed_at_which_it_bears_the_ramps() -> None:
    job, bears, steady = cams()
    band = job_band(bears, job, judge(bears, job.task, job.servo))
    assert band.parts == ((0.0, job.cut.line_speed),)
    assert band.binds == (("none", RAMP),)
    lower = job_band(steady, job, judge(steady, job.task, job.servo))
    ((_, top),), ((_, binds),) = lower.parts, lower.binds
    assert binds == RAMP
    assert 0.9 * job.cut.line_speed < top < job.cut.line_speed
    allowed = line_ramp(steady, job.task.at_speed(top))
    assert allowed.speeding.value >= 1.0
    assert allowed.braking.value >= 5.0
    beyond = line_ramp(steady, job.task.at_speed(1.002 * top))
    assert beyond.speeding.value < 1.0 or beyond.braking.value < 5.0


def test_the_answer_has_the_keys_that_are_promised() -> None:
    job, bears, steady = cams()
    answer = line_ramps_answer(line_ramps(bears, job))
    assert answer is not None
    assert answer["acceleration_m_per_s2"] == pytest.approx(1.0, rel=1e-3)
    assert answer["stop_m_per_s2"] == pytest.approx(5.0, rel=1e-3)
    assert answer["by_acceleration_alone_m_per_s2"] == pytest.approx(21.15, abs=0.01)
    assert answer["stop_length_mm"] == pytest.approx(178, abs=0.5)
    assert [set(row) for row in answer["by_speed"]] == [
        {"line_speed_m_per_s", "acceleration_m_per_s2", "stop_m_per_s2", "binds", "at_m"}
    ] * 20
    assert answer["by_speed"][-1]["line_speed_m_per_s"] == pytest.approx(80 / 60)
    assert answer["sync_error"]["within_tolerance"] is False
    none = line_ramps_answer(line_ramps(steady, replace(job, line=STEADY)))
    assert none is not None
    assert (none["acceleration_m_per_s2"], none["stop_length_mm"], none["sync_error"]) == (0.0, None, None)
    assert line_ramps_answer(None) is None
    json.dumps(answer, allow_nan=False)


def test_a_job_without_a_cam_has_no_answer() -> None:
    assert designed_ramps(replace(cams()[0], line=Line(50.0))) is None


def test_an_inch_job_reads_its_ramps_in_feet() -> None:
    text = FILE.read_text(encoding="utf-8").replace('"600 mm"', '"24 in"').replace('"1 m/s^2"', '"3 ft/s^2"')
    job = parse_job(text, "inch")
    words = plc_words(line_ramps(solve(job.task, "peak_acceleration").profile, job))
    assert "ramps up to 3 ft/s² (jerk), emergency stop up to 16.4 ft/s²" in words
    assert "m/s²" not in words.replace("ft/s²", "")


def test_validate_judges_anyone_s_cam_by_the_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    _, _, steady = cams()
    x = [k / 500 * 0.6 for k in range(501)]
    rows = [
        f"{1e3 * at:.9f},{1e3 * float(steady(at)):.12f},{float(steady(at, 1)):.12f},{float(steady(at, 2)):.12f}"
        for at in x
    ]
    table = tmp_path / "cam.csv"
    table.write_text("x [mm],y [mm],dy/dx [1],d2y/dx2 [1/m]\n" + "\n".join(rows), encoding="utf-8")
    assert main(["validate", str(table), "--job", str(FILE), "--json"]) == 1
    answer = json.loads(capsys.readouterr().out)
    checks = {check["name"]: check for check in answer["checks"]}
    assert not checks["line_ramp"]["passed"]
    assert answer["line_ramp"]["by_acceleration_alone_m_per_s2"] == pytest.approx(21.15, abs=0.2)
