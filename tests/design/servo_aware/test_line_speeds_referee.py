"""A band of line speeds against a linear programme of other rows, by another solver."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import BSpline

from camwright.design.optimise_axis import solve_axis
from camwright.profiles.cut import Cut
from camwright.profiles.limits import Limits
from camwright.profiles.machines import RotaryKnife
from camwright.profiles.servo import Servo, sample_plant
from camwright.profiles.task import Task

PAPER = Servo(120.0, 0.7, 35.0, 0.004, 1.0)
CUT = Cut(0.3, 80 / 60, 0.12, 0.04, 0.08, 1e-4, shaped=True)
LIMITS = Limits(200 / 60, 100.0, 20_000.0)
PITCH = 0.4
INTERVALS, SPEEDS, PHASES, PAST = 150, 25, 4, 320


def splines(x: np.ndarray, order: int = 0) -> np.ndarray:
    """Periodic cubic B-splines on even intervals, or their derivatives, at master positions; a column each."""
    step = CUT.length / INTERVALS
    knots = step * np.arange(-3, INTERVALS + 4)
    local = np.mod(x, CUT.length)
    table = np.zeros((len(x), INTERVALS))
    for k in range(INTERVALS + 3):
        weights = np.zeros(INTERVALS + 3)
        weights[k] = 1.0
        table[:, k % INTERVALS] += BSpline(knots, weights, 3)(local, order)
    return table


def followed(line_speed: float) -> tuple[np.ndarray, np.ndarray]:
    """Run the sampled loop, step by step, on every spline and on a line: the error in the shear zone as rows and constants."""
    start, end = CUT.length - CUT.shear_zone, CUT.length
    sample = PAPER.sample_time * line_speed
    plant, half = sample_plant(PAPER, PAPER.sample_time), sample_plant(PAPER, PAPER.sample_time / 2)
    rows, constants = [], []
    for phase in range(PHASES):
        first = start - (PAST + 1 - phase / PHASES) * sample
        x = first + sample * np.arange(PAST + 3 + int((end - start) / sample))
        seen = np.hstack([splines(x), (PITCH / CUT.length * x)[:, None]])
        state = np.zeros((3, INTERVALS + 1))
        state[2] = seen[0]
        state[1, -1] = PITCH / CUT.length * line_speed  # the line is followed from the beginning
        for k in range(1, len(x)):
            reference = PAPER.position_gain * (seen[k] - state[2]) + (seen[k] - seen[k - 1]) / PAPER.sample_time
            if k == 1:
                state[2, -1] = seen[k, -1]
                reference[-1] = state[1, -1]
            for place, axis in (
                (x[k], state[2]),
                (x[k] + sample / 2, half.transition[2] @ state + half.input[2] * reference),
            ):
                if start <= place <= end:
                    rows.append(axis[:-1])
                    constants.append(axis[-1] - (PITCH + place - CUT.length))
            state = plant.transition @ state + plant.input[:, None] * reference
    return np.array(rows), np.array(constants)


@pytest.mark.slow
def test_the_least_peak_acceleration_over_a_band_is_within_a_fifth_of_a_fine_programmes() -> None:
    cvxpy = pytest.importorskip("cvxpy")
    v = CUT.line_speed
    z, peak = cvxpy.Variable(INTERVALS), cvxpy.Variable()
    nodes = CUT.length / INTERVALS * np.arange(INTERVALS)
    unit = 1e-3
    slope, curve = splines(nodes, 1) * unit, splines(nodes, 2) * unit * v**2
    jerk = splines(nodes + 0.5 * CUT.length / INTERVALS, 3) * unit * v**3
    kept = [
        curve @ z <= peak * 10.0,
        curve @ z >= -peak * 10.0,
        jerk @ z / LIMITS.jerk <= 1.0,
        jerk @ z / LIMITS.jerk >= -1.0,
        (PITCH / CUT.length + slope @ z) * v <= LIMITS.speed,
        PITCH / CUT.length + slope @ z >= 0.0,
    ]
    for share in np.linspace(0.1, 1.0, SPEEDS):
        rows, constants = followed(float(share * v))
        error = (rows * (unit / CUT.sync_tolerance)) @ z + constants / CUT.sync_tolerance
        kept += [error <= 1.0, error >= -1.0]
    cvxpy.Problem(cvxpy.Minimize(peak), kept).solve(solver=cvxpy.HIGHS)
    best = 10.0 * float(peak.value)
    task = Task(RotaryKnife(PITCH), CUT, LIMITS)
    shares = tuple(np.linspace(1.0, 0.1, 41).tolist())
    ours = solve_axis(task, "peak_acceleration", "shaped", (PAPER,), shares=shares)
    assert 0.9 * best <= ours.minimised <= 1.2 * best
