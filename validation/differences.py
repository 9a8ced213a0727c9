"""What a drive is commanded at its samples: differences of a cam's positions."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from camwright.profiles.cut import Cut
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.servo import Servo
from camwright.validation.servo.periodic import periodic_part

_PHASES = 4096


def sampled_peaks(run: CamProfile, cut: Cut, servo: Servo) -> tuple[tuple[float, float], tuple[float, float]]:
    """Greatest second and third difference of the positions at the servo's sample time, over all sampling phases.

    That is what the drive is commanded: it knows the cam at its samples only. Where the cam is smooth over some samples
    the differences approach the derivatives; where straight lines meet they stay finite.

    Parameters
    ----------
    run
        One or more cycles, SI units.
    cut, servo
        Line speed, and sample time.

    Returns
    -------
    tuple
        Acceleration and where its samples begin on the master (m), jerk and where.
    """
    step = cut.line_speed * servo.sample_time
    joins = (run.breaks[:, None] - step * np.arange(4)).ravel()  # differences peak where a sample falls on a join
    x = np.concatenate([np.linspace(0.0, cut.length, _PHASES, endpoint=False), joins[joins >= 0.0]])
    x.sort()
    # the straight line that a deviation leaves out has no second difference
    y = list(periodic_part(run, x + step * np.arange(4)[:, None]))
    y = [after - before for before, after in pairwise(y)]
    found = []
    for order in (2, 3):
        y = [after - before for before, after in pairwise(y)]
        size = np.abs(y[0]) / servo.sample_time**order
        worst = int(size.argmax())
        found.append((float(size[worst]), float(x[worst]) % cut.length))
    return found[0], found[1]


def differences(run: CamProfile, x: FloatArray, order: int, cut: Cut, servo: Servo) -> FloatArray:
    """Second (acceleration) or third difference (jerk) of samples that begin at master positions ``x``, over time."""
    step = cut.line_speed * servo.sample_time
    y = [run(x + k * step, outside="repeat") for k in range(order + 1)]
    for _ in range(order):
        y = [after - before for before, after in pairwise(y)]
    return y[0] / servo.sample_time**order
