"""Judging rebuilt tables: what the number format loses over wraps, limits with their allowance, sync."""

from __future__ import annotations

import numpy as np
import pytest
from knives import KNIFE, cut

from camwright.profiles.errors import InputError
from camwright.profiles.limits import Limits
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.returns import baseline
from camwright.profiles.servo import Servo
from camwright.profiles.task import Task
from camwright.validation.rebuilt import ALLOWANCE, TableJudgement, judge_table

LIMITS = Limits(200 / 60, 30.0, 3000.0)
SERVO = Servo(120.0, 0.7, 35.0, 0.004, 1.0)
SMOOTH = baseline("poly_3_4_5", Task(KNIFE, cut(), LIMITS))


def judged(profile: CamProfile, limits: Limits = LIMITS, origin: str = "return", wraps: int = 3) -> TableJudgement:
    return judge_table(profile, Task(KNIFE, cut(origin=origin), limits), SERVO, wraps)


def failed(judgement: TableJudgement) -> set[str]:
    return {check.name for check in judgement.checks if not check.passed}


def value(judgement: TableJudgement, name: str) -> float:
    found = next(check for check in judgement.checks if check.name == name).value
    assert found is not None
    return found


@pytest.mark.parametrize("origin", ["return", "cut"])
def test_a_sound_cycle_passes(origin: str) -> None:
    judgement = judged(baseline("poly_3_4_5", Task(KNIFE, cut(origin=origin), LIMITS)), origin=origin)
    assert judgement.passed
    assert value(judgement, "sync_position") <= 1e-14
    assert value(judgement, "sync_ratio") <= 1e-12
    assert value(judgement, "closure") <= 1e-14


@pytest.mark.parametrize("wraps", [3, 10])
def test_what_a_cycle_loses_adds_up(wraps: int) -> None:
    loss = 1e-5
    judgement = judged(SMOOTH.add_line(-loss / 0.6), wraps=wraps)
    assert value(judgement, "closure") == pytest.approx(wraps * loss)
    assert value(judgement, "sync_position") == pytest.approx(wraps * loss)  # at the end of the last wrap
    assert value(judgement, "sync_ratio") == pytest.approx(loss / 0.6)
    assert judged(SMOOTH.add_line(-9e-5 / 0.6)).passed is False
    short = judged(SMOOTH.scale(master=1 - 1e-5), wraps=wraps)
    assert value(short, "period") == pytest.approx(wraps * 6e-6)


def test_limits_have_their_allowance() -> None:
    v = 80 / 60
    u = np.linspace(0, 1, 100_001)
    law = 0.2 / 0.4**2 * v**2  # D / T², the correction's height over the return squared
    peak = law * float(np.abs(60 * u - 180 * u**2 + 120 * u**3).max())
    exact = judged(SMOOTH, Limits(10.0, peak * 1.0001, 1e9))
    assert value(exact, "acceleration") == pytest.approx(peak, rel=1e-8)
    assert not failed(exact)
    assert not failed(judged(SMOOTH, Limits(10.0, peak / (1 + ALLOWANCE) * 1.001, 1e9)))
    assert failed(judged(SMOOTH, Limits(10.0, peak / (1 + ALLOWANCE) * 0.999, 1e9))) == {"acceleration"}
    assert failed(judged(SMOOTH, Limits(1.0, 1e9, 1e9))) == {"speed"}


def test_the_jerk_is_the_mean_over_a_sample_time_at_the_worst_phase() -> None:
    # third differences average the jerk over three samples with the quadratic B-spline: below the true peak, near to it
    true = (80 / 60) ** 3 * float(np.abs(SMOOTH(np.linspace(0, 0.6, 9001), 3)).max())
    fine = judge_table(SMOOTH, Task(KNIFE, cut(), LIMITS), Servo(120.0, 0.7, 35.0, 0.0005, 1.0))
    assert true * 0.97 < value(fine, "jerk") < true * (1 + 1e-4)
    assert value(judged(SMOOTH), "jerk") < value(fine, "jerk")


def test_a_jump_of_the_ratio_is_an_acceleration_over_a_sample_time() -> None:
    # the linear return: the ratio steps from 1 to 1/2, in one sample time
    judgement = judged(baseline("linear_return", Task(KNIFE, cut(), LIMITS)))
    assert value(judgement, "acceleration") == pytest.approx(0.5 * (80 / 60) / 0.004, rel=1e-3)
    assert "acceleration" in failed(judgement)


def test_reversal_is_found() -> None:
    long = cut(1.4)
    profile = baseline("poly_3_4_5", Task(KNIFE, long, LIMITS))
    judgement = judge_table(profile, Task(KNIFE, long, LIMITS), SERVO)
    assert "reversal" in failed(judgement)
    allowed = judge_table(profile, Task(KNIFE, long, Limits(10.0, 30.0, 3000.0, reversal=True)), SERVO)
    assert value(allowed, "reversal") > 0.1
    assert "reversal" not in failed(allowed)


def test_an_unstable_servo_and_a_broken_join_fail() -> None:
    judgement = judge_table(SMOOTH, Task(KNIFE, cut(), LIMITS), Servo(80.0, 0.7, 200.0, 0.008, 1.0))
    assert failed(judgement) == {"shear_zone_error"}
    assert [check.value for check in judgement.checks if check.name == "shear_zone_error"] == [None]
    table = SMOOTH.coefficients.copy()
    table[1, 0] += 1e-6
    assert "position_joins" in failed(judged(CamProfile(SMOOTH.breaks.copy(), table)))


def test_what_cannot_be_judged_is_refused() -> None:
    with pytest.raises(InputError, match="at least 3 wraps; got 2"):
        judged(SMOOTH, wraps=2)
    with pytest.raises(InputError, match=r"master period is 660 mm, but the cut length is 600 mm; check the units"):
        judged(SMOOTH.scale(master=1.1))
