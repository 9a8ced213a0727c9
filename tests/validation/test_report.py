"""The list of checks: what passes on the paper's job, and which check fails for which fault."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from camwright.profiles.cut import Cut
from camwright.profiles.errors import InputError
from camwright.profiles.limits import Limits
from camwright.profiles.machines import (
    CrankSlider,
    LinearCarriage,
    Machine,
    RotaryKnife,
)
from camwright.profiles.motor import MotorCurve
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.returns import baseline
from camwright.profiles.servo import Servo
from camwright.profiles.task import Task
from camwright.validation.check import Check
from camwright.validation.report import ValidationReport, judge

KNIFE = RotaryKnife(0.4)
CUT = Cut(0.6, 80 / 60, 0.2, 0.04, 0.16, 1e-4)
LIMITS = Limits(200 / 60, 30.0, 3000.0)
PAPER = Servo(120.0, 0.7, 35.0, 0.004, 1.0)
NAMES = (
    "position_closure",
    "position_joins",
    "ratio_joins",
    "ratio_slope_joins",
    "sync_ratio",
    "speed",
    "acceleration",
    "jerk",
    "reversal",
    "servo_stability",
    "following_error",
    "crossing",
    "settling",
    "shear_zone_error",
    "minimum_cut_length",
    "physical_cut_length",
)


def judged(
    name: str, cut: Cut = CUT, limits: Limits = LIMITS, servo: Servo = PAPER, machine: RotaryKnife = KNIFE
) -> ValidationReport:
    return judge(baseline(name, Task(KNIFE, cut, LIMITS)), Task(machine, cut, limits), servo)


def failed(report: ValidationReport) -> dict[str, Check]:
    return {check.name: check for check in report.checks if not check.passed}


@pytest.mark.parametrize("name", ["double_s", "acceleration_trapezoid", "poly_3_4_5", "cycloid", "modified_sine"])
@pytest.mark.parametrize("origin", ["return", "cut"])
def test_a_smooth_cycle_passes_every_check_on_the_paper_s_job(name: str, origin: str) -> None:
    report = judged(name, replace(CUT, origin=origin))
    assert failed(report) == {}
    assert report.passed
    assert tuple(check.name for check in report.checks) == NAMES
    assert report.servo is not None
    assert len(report.sweep.cases) == 17


def test_the_linear_return_fails_where_its_speed_jumps() -> None:
    report = judged("linear_return")
    assert not report.passed
    faults = failed(report)
    assert set(faults) == {"ratio_joins", "acceleration", "jerk"}
    assert (faults["acceleration"].value, faults["jerk"].value) == (None, None)
    assert faults["ratio_joins"].value == pytest.approx(0.5)
    assert faults["acceleration"].at == pytest.approx(0.4)


def test_a_jump_of_the_acceleration_is_an_unbounded_jerk() -> None:
    faults = failed(judged("parabolic"))
    assert set(faults) == {"ratio_slope_joins", "jerk"}
    assert faults["jerk"].value is None
    assert faults["jerk"].at == pytest.approx(0.2)


@pytest.mark.parametrize(
    ("name", "quantity"), [("speed", "peak_speed"), ("acceleration", "peak_acceleration"), ("jerk", "peak_jerk")]
)
def test_each_limit_is_held_to_rounding(name: str, quantity: str) -> None:
    peak = getattr(judged("double_s").motion, quantity)
    assert name not in failed(judged("double_s", limits=replace(LIMITS, **{name: peak * (1 - 1e-10)})))
    check = failed(judged("double_s", limits=replace(LIMITS, **{name: peak * (1 - 1e-8)})))[name]
    assert check.value == pytest.approx(peak, rel=1e-12)
    assert check.limit == pytest.approx(peak, rel=2e-8)


def test_a_profile_that_runs_backwards_fails_unless_reversal_is_allowed() -> None:
    long = replace(CUT, length=1.5)
    wide = Limits(200 / 60, 100.0, 20_000.0)
    check = failed(judged("cycloid", long, wide))["reversal"]
    report = judged("cycloid", long, replace(wide, reversal=True))
    assert check.value == pytest.approx(-report.motion.min_speed)
    assert check.at == pytest.approx(0.65)
    assert "reversal" not in failed(report)


def test_a_profile_that_does_not_close_fails() -> None:
    check = failed(judged("double_s", machine=RotaryKnife(0.401)))["position_closure"]
    assert check.value == pytest.approx(1e-3)


def test_a_ratio_off_by_a_millionth_in_sync_fails() -> None:
    profile = baseline("double_s", Task(KNIFE, CUT, LIMITS))
    coefficients = profile.coefficients.copy()
    coefficients[-1, 1] += 1e-6
    report = judge(CamProfile(profile.breaks.copy(), coefficients), Task(KNIFE, CUT, LIMITS), PAPER)
    faults = failed(report)
    assert faults["sync_ratio"].value == pytest.approx(1e-6, rel=1e-6)
    assert {"position_closure", "ratio_joins"} <= set(faults)


def test_a_table_of_rounded_points_is_judged_and_fails_for_its_jumps() -> None:
    profile = baseline("cycloid", Task(KNIFE, CUT, LIMITS))
    x = np.linspace(0.0, 0.6, 181)
    y = np.round(profile(x), 6)
    table = CamProfile(x, np.column_stack([y[:-1], np.diff(y) / np.diff(x)]))
    faults = failed(judge(table, Task(KNIFE, CUT, LIMITS), PAPER))
    assert {"ratio_joins", "sync_ratio", "acceleration", "jerk"} <= set(faults)
    assert faults["acceleration"].value is None


def test_a_sync_zone_shorter_than_settling_and_shear_zone_fails_eq6() -> None:
    short = replace(CUT, sync_zone=0.11, shear_zone_at=0.07)
    faults = failed(judged("double_s", short))
    assert {"settling", "shear_zone_error"} <= set(faults)
    assert faults["shear_zone_error"].value > CUT.sync_tolerance
    assert "eq. 6" in faults["settling"].source


def test_eq5_is_named_without_a_shear_zone() -> None:
    report = judged("double_s", replace(CUT, shear_zone=0.0, shear_zone_at=0.2))
    settling = next(check for check in report.checks if check.name == "settling")
    assert "eq. 5" in settling.source
    assert settling.value == report.servo.settling


def test_an_unstable_servo_fails_without_a_response() -> None:
    report = judged("double_s", servo=replace(PAPER, position_gain=200.0))
    faults = failed(report)
    assert report.servo is None
    names = {"servo_stability", "following_error", "crossing", "settling", "shear_zone_error", "minimum_cut_length"}
    assert set(faults) == names
    assert faults["servo_stability"].value > 1.0
    assert faults["settling"].value is None


def test_a_cut_shorter_than_the_physical_bound_fails_it() -> None:
    short = replace(CUT, length=0.21, sync_zone=0.1, shear_zone_at=0.06)
    faults = failed(judged("double_s", short))
    assert faults["physical_cut_length"].value > short.length
    assert faults["physical_cut_length"].limit == short.length


def test_another_cut_s_profile_is_refused() -> None:
    with pytest.raises(InputError, match=r"runs over the master from 0\.0 m to 0\.6 m"):
        judge(baseline("double_s", Task(KNIFE, CUT, LIMITS)), Task(KNIFE, replace(CUT, length=0.7), LIMITS), PAPER)


CARRIAGE = LinearCarriage(0.7, home=0.1, mass=30.0, travel_per_turn=0.04)
CRANK = CrankSlider(0.15, 0.6, 0.02, 0.5, 20.0, 10.0, 1.5)
QUICK = Servo(1000.0, 0.8, 120.0, 0.0005, 1.0)
OPEN = Limits(100.0, 1e4, 1e6)
SHORT = replace(CUT, sync_zone=0.1, shear_zone_at=0.05)


@pytest.mark.parametrize(
    "machine",
    [CARRIAGE, CRANK, replace(KNIFE, sync="horizontal"), RotaryKnife(0.8, blades=2, sync="horizontal")],
    ids=["carriage", "crank", "horizontal", "two blades"],
)
@pytest.mark.parametrize("origin", ["return", "cut"])
def test_a_quintic_passes_every_check_of_its_machine(machine: Machine, origin: str) -> None:
    cut = replace(SHORT, origin=origin, sync_ratio=1.03, sync_tolerance=1e-3)
    limits = replace(OPEN, reversal=isinstance(machine, RotaryKnife))
    report = judge(baseline("poly_3_4_5", Task(machine, cut, LIMITS)), Task(machine, cut, limits), QUICK)
    assert failed(report) == {}
    names = {check.name for check in report.checks}
    assert ("stroke" in names) == isinstance(machine, LinearCarriage)
    assert not names & {"minimum_cut_length", "physical_cut_length"}  # closed forms of tangential knives
    units = {check.name: check.unit for check in report.checks}
    assert units["speed"] == ("rad/s" if isinstance(machine, CrankSlider) else "m/s")
    assert units["ratio_slope_joins"] == ("rad/m^2" if isinstance(machine, CrankSlider) else "1/m")
    assert (report.tool == report.motion) == (machine.slave_unit == "m")
    assert (report.tangential_mismatch is None) == (not isinstance(machine, RotaryKnife))


def test_a_carriage_that_leaves_its_stroke_fails_at_the_place() -> None:
    cycle = baseline("poly_3_4_5", Task(CARRIAGE, SHORT, LIMITS))
    way = cycle.extrema(0)[1].value - cycle.extrema(0)[0].value
    check = failed(judge(cycle, Task(replace(CARRIAGE, stroke=0.99 * way), SHORT, OPEN), QUICK))["stroke"]
    assert check.limit == pytest.approx(0.99 * way / 2)
    assert check.value == pytest.approx(way / 2, rel=1e-9)
    assert float(cycle(check.at, 1)) == pytest.approx(0.0, abs=1e-6)
    assert "stroke" not in failed(judge(cycle, Task(replace(CARRIAGE, stroke=1.001 * way), SHORT, OPEN), QUICK))


def test_a_carriage_may_run_back_whatever_the_limits_say() -> None:
    cycle = baseline("poly_3_4_5", Task(CARRIAGE, SHORT, LIMITS))
    assert "reversal" not in failed(judge(cycle, Task(CARRIAGE, SHORT, OPEN), QUICK))
    slow = -0.9 * SHORT.line_speed * cycle.extrema(1)[0].value
    assert {"speed", "reversal"} <= set(failed(judge(cycle, Task(CARRIAGE, SHORT, replace(OPEN, speed=slow)), QUICK)))


def test_minimum_lengths_with_over_speed_are_those_of_a_faster_line() -> None:
    fast = replace(CUT, sync_ratio=1.1)
    report = judge(baseline("cycloid", Task(KNIFE, fast, LIMITS)), Task(KNIFE, fast, LIMITS), PAPER)
    check = {check.name: check for check in report.checks}["minimum_cut_length"]
    zone = report.servo.settling + fast.shear_zone
    # eq. 8 with the slave's travel of 1.1 l_s in the sync zone
    assert check.value == pytest.approx(zone + fast.line_speed * (KNIFE.pitch - 1.1 * zone) / LIMITS.speed, rel=1e-12)


def test_a_motor_s_curve_is_judged_where_it_is_given() -> None:
    cycle = baseline("poly_3_4_5", Task(CRANK, SHORT, LIMITS))
    motor = judge(cycle, Task(CRANK, SHORT, OPEN), QUICK).motor
    torque, speed = motor.peak_torque, motor.peak_speed

    def faults(points: tuple[tuple[float, float], ...]) -> dict[str, Check]:
        return failed(judge(cycle, Task(CRANK, SHORT, replace(OPEN, motor=MotorCurve(points))), QUICK))

    assert faults(((0.0, torque), (speed, torque))) == {}
    weak = faults(((0.0, 0.9 * torque), (speed, 0.9 * torque)))
    assert set(weak) == {"motor_torque"}
    assert weak["motor_torque"].value == pytest.approx(torque, rel=1e-9)
    assert weak["motor_torque"].limit == pytest.approx(0.9 * torque, rel=1e-12)
    assert set(faults(((0.0, torque), (0.9 * speed, torque)))) == {"motor_speed", "motor_torque"}


def test_a_motor_s_curve_and_a_jump_of_the_speed() -> None:
    limits = replace(OPEN, motor=MotorCurve(((0.0, 1.0), (1e4, 1.0))))
    linear = baseline("linear_return", Task(CARRIAGE, SHORT, LIMITS))
    assert failed(judge(linear, Task(CARRIAGE, SHORT, limits), QUICK))["motor_torque"].value is None
    names = {check.name for check in judge(linear, Task(replace(CARRIAGE, mass=0.0), SHORT, limits), QUICK).checks}
    assert "motor_speed" in names
    assert "motor_torque" not in names  # the job does not say what the motor moves
