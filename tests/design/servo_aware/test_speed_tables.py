"""Tables added by powers of the line speed: series and quotient by other roads, the axis by the validation's simulation."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from camwright.design.servo_aware.speed_tables import rational, response_series, smooth_cycle, speed_cam
from camwright.profiles.cut import Cut
from camwright.profiles.limits import Limits
from camwright.profiles.machines import LinearCarriage, Machine, RotaryKnife
from camwright.profiles.servo import Servo, mean_lag
from camwright.profiles.task import Task
from camwright.validation.servo.monte_carlo import shear_zone_errors
from camwright.validation.servo.sampled_axis import mean_response

PAPER = Servo(120.0, 0.7, 35.0, 0.004, 1.0)
LATE = replace(PAPER, velocity_feedforward=0.8, dead_time=0.003, lead_time=0.0005)
FED = replace(PAPER, acceleration_feedforward=2.5e-4, jerk_feedforward=1.5e-6)
KNIFE, LIMITS = RotaryKnife(0.4), Limits(200 / 60, 100.0, 20_000.0)
CUT = Cut(0.3, 80 / 60, 0.12, 0.04, 0.08, 1e-4, shaped=True)


def worst(machine: Machine, cut: Cut, servo: Servo, order: int, share: float) -> float:
    """Sync error of the sum at a share of the line speed, over 64 phases (m)."""
    task = Task(machine, cut, LIMITS)
    cam, slower = speed_cam(task, servo, order), task.at_speed(share * cut.line_speed)
    return float(shear_zone_errors(cam.at(share * cut.line_speed), slower, [servo], 64)[0])


@pytest.mark.parametrize("servo", [PAPER, LATE, FED, replace(PAPER, sample_time=0.001, damping=1.0)])
def test_the_series_is_the_response_at_low_frequencies(servo: Servo) -> None:
    """Against the validation's response to a sine, which is found on another road; its first term is the lag at constant speed."""
    series = response_series(servo, 6)
    assert series[0] == pytest.approx(1.0, abs=1e-12)
    assert series[1] == pytest.approx(-mean_lag(servo) + servo.lead_time, abs=1e-12)
    rates = np.array([0.0, 1.0, 2.0])  # the first stands for a constant command
    expected = mean_response(servo, rates)
    found = ((1j * rates[:, None]) ** np.arange(7)) @ series
    assert np.abs(found - expected).max() <= 1e-8


def test_without_sampling_the_quotient_is_the_loop() -> None:
    """At a hundredth of a millisecond: ``D = 1 + alpha s / K``, ``N = 1 + s/K + 2 zeta s²/(omega K) + s³/(omega² K)``."""
    quick = replace(PAPER, sample_time=1e-5, velocity_feedforward=0.9)
    series = response_series(quick, 6)
    top = np.array([1.0, 1 / 35.0, 1.4 / (120.0 * 35.0), 1.0 / (120.0**2 * 35.0)])
    bottom = np.array([np.convolve(series, top)[k] for k in range(4)])
    assert bottom == pytest.approx(np.array([1.0, 0.9 / 35.0, 0.0, 0.0]), abs=2e-6)
    np.testing.assert_allclose(np.convolve(series, top)[4:7], 0.0, atol=2e-9)


@pytest.mark.parametrize("order", [2, 3])
def test_the_quotient_has_the_series(order: int) -> None:
    series = response_series(LATE, 2 * order)
    bottom, top = rational(series, order)
    product = np.convolve(series, top)[: 2 * order + 1]
    scale = 0.02 ** np.arange(2 * order + 1)
    assert np.abs((product[: order + 1] - bottom) / scale[: order + 1]).max() <= 1e-9
    assert np.abs(product[order + 1 :] / scale[order + 1 :]).max() <= 1e-9


@pytest.mark.parametrize(
    ("machine", "cut"),
    [
        (KNIFE, CUT),
        (KNIFE, replace(CUT, origin="cut", sync_ratio=1.01)),
        (LinearCarriage(0.8), replace(CUT, length=0.6)),
    ],
)
def test_the_axis_is_in_sync_at_every_line_speed(machine: Machine, cut: Cut) -> None:
    errors = [worst(machine, cut, PAPER, 3, share) for share in np.linspace(0.1, 1.0, 7)]
    assert max(errors) <= 4e-6
    assert errors[3] <= 5e-7


def test_more_tables_leave_less_and_a_quicker_clock_less_still() -> None:
    """The published knife at 300 mm: 0.75, 0.49 and 0.0021 mm at 80 m/min; with 1 ms 0.0001 mm."""
    task = Task(KNIFE, CUT, LIMITS)
    alone = float(shear_zone_errors(smooth_cycle(task, 5), task, [PAPER], 64)[0])
    assert alone == pytest.approx(0.75e-3, rel=0.05)
    assert worst(KNIFE, CUT, PAPER, 2, 1.0) == pytest.approx(0.49e-3, rel=0.05)
    assert worst(KNIFE, CUT, PAPER, 3, 1.0) <= 3e-6
    assert worst(KNIFE, CUT, replace(PAPER, sample_time=0.001), 3, 1.0) <= 2e-7
    assert worst(KNIFE, CUT, LATE, 3, 0.8) <= 5e-6


def test_the_sum_is_a_command_without_jumps() -> None:
    cam = speed_cam(Task(KNIFE, CUT, LIMITS), PAPER, 3)
    assert [float(table.advance) for table in cam.tables] == pytest.approx([0.4, 0.0, 0.0, 0.0], abs=1e-12)
    command = cam.at(1.0)
    for order, size in ((0, 0.4), (1, 1.0), (2, 50.0)):
        assert np.abs(command.jumps(order)).max() <= 1e-9 * size
    x = np.linspace(0.0, 0.3, 50)
    assert command(x) == pytest.approx(sum(table(x) for table in cam.tables), abs=1e-12)
    assert cam.at(0.5)(x) == pytest.approx(sum(table(x) * 0.5**n for n, table in enumerate(cam.tables)), abs=1e-12)
