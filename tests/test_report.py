"""The list of checks: what passes on the paper's job, and which check fails for which fault."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from profiles.cycle import Cut
from profiles.errors import InputError
from profiles.limits import Limits
from profiles.machines import RotaryKnife
from profiles.polynomial import CamProfile
from profiles.returns import baseline
from profiles.servo import Servo
from validation import Check, ValidationReport, validate

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
    return validate(baseline(name, KNIFE, cut), machine, cut, limits, servo)


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
    profile = baseline("double_s", KNIFE, CUT)
    coefficients = profile.coefficients.copy()
    coefficients[-1, 1] += 1e-6
    report = validate(CamProfile(profile.breaks.copy(), coefficients), KNIFE, CUT, LIMITS, PAPER)
    faults = failed(report)
    assert faults["sync_ratio"].value == pytest.approx(1e-6, rel=1e-6)
    assert {"position_closure", "ratio_joins"} <= set(faults)


def test_a_table_of_rounded_points_is_judged_and_fails_for_its_jumps() -> None:
    profile = baseline("cycloid", KNIFE, CUT)
    x = np.linspace(0.0, 0.6, 181)
    y = np.round(profile(x), 6)
    table = CamProfile(x, np.column_stack([y[:-1], np.diff(y) / np.diff(x)]))
    faults = failed(validate(table, KNIFE, CUT, LIMITS, PAPER))
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
        validate(baseline("double_s", KNIFE, CUT), KNIFE, replace(CUT, length=0.7), LIMITS, PAPER)
