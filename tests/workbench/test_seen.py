"""What the plots and the servo view are made from: samples of designs, axes at every phase, files laid over."""

from __future__ import annotations

import base64
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from starlette.testclient import TestClient

from camwright.jobs.job import Job, load_job
from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.returns import baseline
from camwright.stored.design_text import design_text
from camwright.studies.design import optimise
from camwright.validation.motor import motor_torque
from camwright.validation.servo.response import servo_response
from camwright.validation.servo.simulation import simulate
from camwright.workbench.overlay import overlay
from camwright.workbench.preview import drawn_design, preview
from camwright.workbench.sampling import samples
from camwright.workbench.servo import servo_view

EXAMPLES = Path(__file__).parents[2] / "examples"


def example(name: str) -> Job:
    return load_job(EXAMPLES / f"{name}.toml")


@pytest.mark.parametrize("name", ["chasing-shear", "flying-saw"])
def test_once_proved_the_design_is_drawn_and_not_what_stood_in_for_it(name: str) -> None:
    result = optimise(example(name))
    shown = drawn_design(design_text(result))
    assert shown["exact"] is True
    x = np.array(shown["samples"]["x_m"])
    scale = np.abs(shown["samples"]["y"]).max()
    np.testing.assert_allclose(shown["samples"]["y"], result.profile(x), atol=1e-6 * scale)


def test_torque_is_that_of_the_judge() -> None:
    for name in ("chasing-shear", "flying-saw"):
        result = optimise(example(name))
        task, profile = result.job.task, result.profile
        found = samples(profile, task)
        x = np.array(found["x_m"])[1:-1]
        torque = motor_torque(profile, task)
        away = np.abs(x[:, None] - torque.breaks).min(axis=1) > 1e-9  # at a jump both sides are true
        expected = torque(x)[away]
        np.testing.assert_allclose(np.array(found["torque"])[1:-1][away], expected, atol=1e-6 * np.abs(expected).max())


def test_the_plots_hold_peaks_that_are_narrower_than_a_step() -> None:
    """A corner at the limit of the jerk may be a quarter of a step wide."""
    cam = CamProfile.from_arrays(
        [0.0, 1e-4, 2e-4, 0.6], [[0.0, 1.0, 0.0, 5e4], [0.0, 1.0015, 15.0, -5e4], [0.0, 1.003]]
    )
    found, v = samples(cam, example("paper-600").task), 80 / 60
    for order, name in ((1, "speed"), (2, "acceleration")):
        least, greatest = (extremum.value * v**order for extremum in cam.extrema(order))
        assert (min(found[name]), max(found[name])) == pytest.approx((least, greatest), rel=1e-6, abs=1e-9)
    assert len({len(column) for column in found.values()}) == 1


def test_a_limit_that_is_touched_is_named() -> None:
    text = (EXAMPLES / "paper-600.toml").read_text(encoding="utf-8")
    assert preview(text)["binding"] == ["reversal", "jerk"]
    tight = text.replace('"30 m/s^2"', '"9.2 m/s^2"').replace("peak_acceleration", "rms_acceleration")
    assert "acceleration" in preview(tight)["binding"]


@pytest.mark.parametrize("share", [1.0, 0.75])
def test_the_servo_view_is_the_judges_simulation(share: float) -> None:
    result = optimise(example("paper-600"))
    job, cut = result.job, result.job.cut
    shown = servo_view(design_text(result), share, curve=True)
    task = job.task.at_speed(share * cut.line_speed)
    response = servo_response(result.profile, task, job.servo)
    assert shown["response"]["shear_zone_error"] == response.shear_zone_error
    assert len(shown["phases"]) == response.phases == 16
    low, high = shown["shear_zone_m"]
    seen = [
        abs(error)
        for phase in shown["phases"]
        for x, error in zip(phase["x_m"], phase["error_m"], strict=True)
        if low <= x <= high
    ]
    assert max(seen) == pytest.approx(response.shear_zone_error, rel=0.05)  # the page gets a part of the points
    speeds, errors = (np.array(shown["over_line_speed"][key]) for key in ("line_speed_m_per_s", "error_m"))
    at_job = errors[np.argmin(np.abs(speeds - cut.line_speed))]
    assert at_job == pytest.approx(result.report.servo.shear_zone_error, rel=1e-5)


def test_a_share_that_is_none_is_refused(bench: TestClient) -> None:
    design = design_text(optimise(example("paper-600")))
    for share in (0, -1, 3, float("1e9")):
        answer = bench.post("/api/servo", json={"design": design, "share": share}).json()
        assert answer["exit_code"] == 2
        assert f'"share" is {share:g}; it is a line speed over that of the job' in answer["message"]
    assert "design: not JSON" in bench.post("/api/servo", json={"design": "no"}).json()["message"]
    assert "design: not a design.json" in bench.post("/api/cam", json={"design": "{}"}).json()["message"]


def recording(job: Job, profile: CamProfile, cycles: int = 3, offset: float = 0.137) -> bytes:
    """Record command and axis of a running machine, from anywhere in the cycle."""
    times = np.arange(0.0, cycles * job.cut.period, 1e-3)
    x = times * job.cut.line_speed + offset
    run = simulate(profile, job.cut, job.servo)
    command = profile(x, outside="repeat")
    error = np.interp(
        x % job.cut.length, run.master[0] % job.cut.length, run.command[0] - run.axis[0], period=job.cut.length
    )
    rows = zip(times, command, command - error, strict=True)
    lines = [f"{1e3 * t:.3f},{1e3 * a:.6f},{1e3 * b:.6f}" for t, a, b in rows]
    return "\n".join(["time [ms],command [mm],actual [mm]", *lines]).encode()


def test_a_recording_is_laid_over_its_design() -> None:
    job = example("paper-600")
    result = optimise(job)
    text = (EXAMPLES / "paper-600.toml").read_text(encoding="utf-8")
    found = overlay(text, recording(job, result.profile), "scope.csv", design=design_text(result))
    assert found["kind"] == "trace"
    x, y = (np.array(found["samples"][key]) for key in ("x_m", "y"))
    np.testing.assert_allclose(y, result.profile(x), atol=2e-6)
    lag = y - np.array(found["actual"]["y"])
    run = simulate(result.profile, job.cut, job.servo)
    assert np.abs(lag).max() == pytest.approx(np.abs(run.command - run.axis).max(), rel=0.02)
    inside = (x > 0.41) & (x < 0.59)
    np.testing.assert_allclose(np.array(found["samples"]["ratio"])[inside], 1.0, atol=2e-3)
    with pytest.raises(InputError, match="a recording is laid over a design"):
        overlay(text, recording(job, result.profile), "scope.csv")


def test_a_table_is_laid_as_its_drive_runs_it() -> None:
    job = example("paper-600")
    cam = baseline("poly_3_4_5", job.task)
    x = np.linspace(0.0, job.cut.length, 361)
    data = "\n".join(
        ["x [mm],y [mm]", *(f"{1e3 * a:.6f},{1e3 * b:.9f}" for a, b in zip(x, cam(x), strict=True))]
    ).encode()
    found = overlay((EXAMPLES / "paper-600.toml").read_text(encoding="utf-8"), data, "running.csv")
    assert found["kind"] == "table"
    assert max(found["samples"]["acceleration"]) == pytest.approx(12.83, rel=1e-3)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"time [ms],command [mm],actual [mm]\n0,0,0\n500,1,1\n1000,2,2\n", "nothing.csv: "),
        (b"nothing", "nothing.csv"),
    ],
)
def test_what_cannot_be_laid_is_refused(data: bytes, message: str, bench: TestClient) -> None:
    result = optimise(example("paper-600"))
    body = {
        "toml": (EXAMPLES / "paper-600.toml").read_text(encoding="utf-8"),
        "design": design_text(result),
        "name": "nothing.csv",
        "base64": base64.b64encode(data).decode(),
    }
    answer = bench.post("/api/overlay", json=body).json()
    assert answer["exit_code"] == 2
    assert message in answer["message"]


def test_a_carriage_and_a_crank_have_their_servo_view() -> None:
    for name in ("flying-saw", "chasing-shear"):
        job = replace(example(name), servo_tolerance=None)
        shown = servo_view(design_text(optimise(job)))
        assert len(shown["meeting"]) == len(shown["phases"])
        assert all(len(phase["x_m"]) == len(phase["error_m"]) > 10 for phase in shown["phases"])
