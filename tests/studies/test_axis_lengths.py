"""How short a piece can be cut with the axis in sync, and what the commands say of servo-aware designs."""

from __future__ import annotations

import contextlib
import io
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from camwright import load_job
from camwright.cli.main import main
from camwright.design.optimise_axis import solve_axis
from camwright.design.servo_aware.axis_problem import AxisProblem
from camwright.design.servo_aware.command_basis import Command
from camwright.design.servo_aware.programme import AxisProgramme
from camwright.jobs.job import Job
from camwright.profiles.errors import InfeasibleError
from camwright.profiles.limits import Limits
from camwright.profiles.machines import LinearCarriage, RotaryKnife
from camwright.profiles.servo import mean_lag
from camwright.studies.axis_lengths import axis_lengths, in_shear_zone
from camwright.studies.axis_study import solve_job
from camwright.validation.servo.response import servo_response

EXAMPLES = Path(__file__).parents[2] / "examples"
CASE_A = (
    (EXAMPLES / "paper-600.toml")
    .read_text()
    .replace('"30 m/s^2"', '"100 m/s^2"')
    .replace('"3000 m/s^3"', '"20000 m/s^3"')
)
AWARE = CASE_A.replace("[objective]", '[objective]\nservo_aware = true\ncommand = "shaped"')


def job_file(folder: Path, text: str) -> str:
    path = folder / "job.toml"
    path.write_text(text, encoding="utf-8")
    return str(path)


def answer(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, dict[str, Any]]:
    code = main([*arguments, "--json"])
    return code, json.loads(capsys.readouterr().out)


@pytest.fixture(scope="module")
def limits(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """Ask once for the limits of the issue's case A, as a user does."""
    path = job_file(tmp_path_factory.mktemp("case-a"), CASE_A)
    said = io.StringIO()
    with contextlib.redirect_stdout(said):
        assert main(["limits", path, "--json"]) == 0
    found = json.loads(said.getvalue())
    assert isinstance(found, dict)
    return found


def case_a() -> Job:
    return replace(load_job(EXAMPLES / "paper-600.toml"), limits=Limits(200 / 60, 100.0, 20_000.0))


def test_the_issues_shortest_cuts(limits: dict[str, Any]) -> None:
    lengths, strict = limits["axis_minimum_cut_length_mm"], limits["axis_minimum_cut_length_axis_limits_mm"]
    assert set(lengths) == {"linear_return", "poly_3_4_5", "in_sync", "shaped"}
    assert lengths["linear_return"] == pytest.approx(301.0, abs=3.0)
    assert lengths["in_sync"] <= 250.0
    assert lengths["shaped"] <= 204.0
    assert lengths["linear_return"] < lengths["poly_3_4_5"] < 400.0
    # with the limits on the axis too
    assert lengths["in_sync"] < strict["in_sync"] <= 260.0
    assert lengths["shaped"] < strict["shaped"] <= 215.0
    assert lengths["linear_return"] == pytest.approx(limits["minimum_cut_length_mm"]["linear_return_to_tolerance"])


def test_a_shaped_cut_of_that_length_is_designed_and_a_shorter_one_refused(limits: dict[str, Any]) -> None:
    job, least = case_a(), limits["axis_minimum_cut_length_mm"]["shaped"] * 1e-3
    for length, holds in ((1.0005 * least, True), (least - 1.5e-4, False)):
        cut = replace(job.cut, length=length, sync_zone=0.04, shear_zone_at=0.0, shaped=True)
        if holds:
            solution = solve_axis(job.task.with_cut(cut), "peak_acceleration", "shaped", (job.servo,))
            assert (
                servo_response(solution.profile, job.task.with_cut(cut), job.servo).shear_zone_error
                <= cut.sync_tolerance
            )
        else:
            with pytest.raises(InfeasibleError):
                solve_axis(job.task.with_cut(cut), "peak_acceleration", "shaped", (job.servo,), suggest=False)


def test_no_longer_sync_zone_holds_a_shorter_cut(limits: dict[str, Any]) -> None:
    job, least = case_a(), limits["axis_minimum_cut_length_mm"]["in_sync"] * 1e-3
    for zone in (0.041, 0.046, 0.06, 0.09):
        cut = replace(job.cut, length=least - 1.5e-4, sync_zone=zone, shear_zone_at=zone - job.cut.shear_zone)
        assert (
            AxisProgramme(AxisProblem(job.task.with_cut(cut), "in_sync", (job.servo,), False)).missed(ratio=True) > 0.0
        )


@pytest.mark.parametrize("command", ["in_sync", "shaped"])
def test_programmes_that_go_on_from_one_beside_say_what_those_from_nothing_do(command: Command) -> None:
    job, last = case_a(), None
    for length in (0.3, 0.292, 0.293):
        cut = in_shear_zone(job.cut, length if command == "in_sync" else length - 0.048, job.cut.shear_zone)
        problem = AxisProblem(job.task.with_cut(cut), command, (job.servo,), True)
        last = AxisProgramme(problem, last, own=True)
        fresh = AxisProgramme(problem)
        assert (last.missed(ratio=True) <= 0.0) == (fresh.missed(ratio=True) <= 0.0)
        least = fresh.least_share()
        assert least is not None
        assert last.least_share() == pytest.approx(least, rel=2e-2, abs=5e-3)  # below that motion matters more


def test_machines_that_the_equations_are_not_about_have_none() -> None:
    job = case_a()
    assert axis_lengths(replace(job, machine=LinearCarriage(0.9))) is None
    assert axis_lengths(replace(job, machine=RotaryKnife(0.4, sync="horizontal"))) is None
    assert axis_lengths(replace(job, cut=replace(job.cut, sync_ratio=1.05))) is None


def test_limits_of_other_machines_are_null(capsys: pytest.CaptureFixture[str]) -> None:
    code, said = answer(capsys, "limits", str(EXAMPLES / "flying-saw.toml"))
    assert code == 0
    assert said["axis_minimum_cut_length_mm"] == dict.fromkeys(("linear_return", "poly_3_4_5", "in_sync", "shaped"))


@pytest.mark.parametrize("command", ["shaped", "in_sync"])
def test_design_says_what_the_axis_does(capsys: pytest.CaptureFixture[str], tmp_path: Path, command: str) -> None:
    text = AWARE.replace('"shaped"', f'"{command}"')
    job = job_file(tmp_path, text)
    code, said = answer(capsys, "design", job, "--no-figures", "--out", str(tmp_path / "out"))
    assert code == 0
    axis = said["servo_aware"]
    assert axis["mode"] == command
    assert axis["phases"] == 16
    assert axis["designed_error_mm"] == pytest.approx(axis["simulated_error_mm"], abs=1e-6)
    assert axis["simulated_error_mm"] <= 0.1
    assert axis["axis_limits"] is True
    assert said["robust"] is None
    names = {check["name"] for check in said["checks"]}
    assert {"axis_speed", "axis_acceleration", "axis_reversal", "shear_zone_error"} <= names
    assert ("sync_ratio" in names) == (command == "in_sync")
    # the cam that was written is judged the same
    code, judged = answer(capsys, "validate", str(tmp_path / "out" / "design.json"), "--job", job)
    assert (code, judged["passed"]) == (0, True)


def test_design_says_what_lead_makes_up_for_and_what_servos_of_the_ranges_do(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    # without a lead dead time is another offset at every line speed, which no one cam makes up for
    alone = AWARE.replace("servo_aware = true", 'servo_aware = true\nline_speeds = "100 %"')
    text = alone.replace("velocity_feedforward = 1.0", 'velocity_feedforward = 1.0\ndead_time = "2 ms"') + (
        '\n[servo.tolerance]\nposition_gain = "5 %"\n'
    )
    code, said = answer(capsys, "design", job_file(tmp_path, text), "--no-figures", "--out", str(tmp_path / "out"))
    assert code == 0
    assert said["lead_time_ms"] == pytest.approx(2.0)
    for name in ("length_error_mm", "length_error_with_lead_mm", "length_variation_mm"):
        assert set(said[name]) == {"10", "25", "50", "100"}
    robust = said["robust"]
    assert (robust["draws"], robust["vertices"]) == (10_000, 2)
    assert robust["worst_error_mm"] <= 1.1 * robust["designed_worst_error_mm"]
    assert robust["designed_worst_error_mm"] <= 0.1


def test_the_least_sync_error_is_an_objective(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    text = AWARE.replace('minimise = "peak_acceleration"', 'minimise = "sync_error"')
    code, said = answer(capsys, "design", job_file(tmp_path, text), "--no-figures", "--out", str(tmp_path / "out"))
    assert code == 0
    assert (said["objective"]["name"], said["objective"]["unit"]) == ("sync_error", "m")
    assert said["objective"]["value"] <= 1e-6
    assert said["objective"]["lower_bound"] is None
    blind = load_job(EXAMPLES / "paper-600.toml")
    assert mean_lag(blind.servo) == 0.0


def test_a_tolerance_out_of_reach_ends_with_exit_code_3(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    text = AWARE.replace('"shaped"', '"in_sync"\nline_speeds = "100 %"')
    text = text.replace('"600 mm"', '"250 mm"').replace('"200 mm"', '"80 mm"')
    code, said = answer(capsys, "design", job_file(tmp_path, text), "--no-figures", "--out", str(tmp_path / "out"))
    assert code == 3
    assert (said["status"], said["binding"]) == ("infeasible", "sync_tolerance")
    assert said["excess"]["unit"] == "mm"
    assert {each["change"] for each in said["suggestions"]} == {
        "command",
        "line_speed",
        "length",
        "sync_tolerance",
    }  # each designs and passes
    assert not (tmp_path / "out").exists()
    with pytest.raises(InfeasibleError) as caught:  # a book does not search for ways out
        solve_job(load_job(Path(job_file(tmp_path, text))), suggest=False)
    assert caught.value.suggestions == ()


@pytest.mark.slow
def test_a_crank_is_designed_for_its_torque(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    text = (EXAMPLES / "chasing-shear.toml").read_text()
    torques = []
    for command in ("in_sync", "shaped"):
        aware = text.replace("[objective]", f'[objective]\nservo_aware = true\ncommand = "{command}"')
        arguments = ["design", job_file(tmp_path, aware), "--no-figures", "--out", str(tmp_path / command)]
        code, said = answer(capsys, *arguments)
        assert code == 0
        assert said["objective"]["name"] == "rms_torque"
        assert said["servo_aware"]["designed_error_mm"] == pytest.approx(
            said["servo_aware"]["simulated_error_mm"], abs=1e-6
        )
        torques.append(said["objective"]["value"])
    assert torques[1] < 0.7 * torques[0]
