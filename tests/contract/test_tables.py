"""What is promised of tables for drives, by what is written and judged."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from camwright import load_job
from camwright.drives.export import export_possible
from camwright.profiles.limits import Limits
from camwright.profiles.returns import baseline
from camwright.validation.rebuilt import judge_table

JOB = load_job()
CYCLE = baseline("poly_3_4_5", JOB.task)
PEAK = (80 / 60) ** 2 * 0.2 / 0.4**2 * 10 / 3**0.5
"""Peak acceleration of the quintic (m/s²)."""


@pytest.mark.parametrize("share", [0.9, 1.1])
@pytest.mark.parametrize("name", ["speed", "acceleration", "jerk"])
def test_a_table_may_exceed_a_limit_by_one_per_cent(name: str, share: float) -> None:
    wide = Limits(1e3, 1e4, 1e7)
    judged = judge_table(CYCLE, JOB.task.with_limits(wide), JOB.servo)
    found = {check.name: check.value for check in judged.checks}[name]
    assert found is not None
    if name == "acceleration":
        assert found == pytest.approx(PEAK, rel=1e-9)
    limits = {"speed": 1e3, "acceleration": 1e4, "jerk": 1e7} | {name: found / (1 + share * 0.01)}
    judged = judge_table(CYCLE, JOB.task.with_limits(Limits(**limits)), JOB.servo)
    assert {check.name for check in judged.checks if not check.passed} == (set() if share < 1 else {name})


def test_three_wraps_are_run() -> None:
    assert judge_table(CYCLE, JOB.task, JOB.servo).wraps == 3
    (written,) = export_possible(CYCLE, JOB, ["csv"])[0]
    assert written.judgement.wraps == 3


def missed(law: str, length: float, target: str) -> tuple[float, float, float]:
    """How far the motion that a drive makes of its table is off: position (m), ratio, acceleration over its peak."""
    cut = replace(JOB.cut, length=length)
    profile = baseline(law, JOB.task.with_cut(cut))
    (written,) = export_possible(profile, replace(JOB, cut=cut), [target])[0]
    rebuilt = written.units.to_si(written.target.rebuild(written.table))
    x = np.linspace(1e-9, length - 1e-9, 40_001)
    position, ratio, slope = (float(np.abs(rebuilt(x, order) - profile(x, order)).max()) for order in range(3))
    return position, ratio, slope / float(np.abs(profile(x, 2)).max())


@pytest.mark.parametrize(
    ("law", "length", "target", "which"),
    [
        ("modified_sine", 0.45, "sew", 2),  # the next fewer points are 1.3 % off
        ("poly_3_4_5", 0.6, "sew", 0),
        ("poly_3_4_5", 0.6, "lenze", 1),  # straight lines
    ],
)
def test_points_keep_the_motion_within_the_promised_error(law: str, length: float, target: str, which: int) -> None:
    promised = (1e-6, 1e-3, 0.01)
    found = missed(law, length, target)
    assert found[which] > 0.5 * promised[which]  # as few points as that allows
    kept = found if target == "sew" else found[:2]  # between straight lines the acceleration is unbounded
    assert all(error <= allowed for error, allowed in zip(kept, promised, strict=False))
