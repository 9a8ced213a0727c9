"""The sync error in the shear zone over line speed: one cam, its servo, and a line that runs slower or faster."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.servo import Servo, spectral_radius
from camwright.profiles.task import Task
from camwright.validation.motion import require_period
from camwright.validation.servo.lifting import BLOCK, lift, lift_side_by_side, loops_of
from camwright.validation.servo.monte_carlo import FEW_PHASES, shear_zone_errors
from camwright.validation.servo.response import shear_zone_peaks
from camwright.validation.servo.simulation import PHASES, WHOLE_PART, memory, shear_zone_run

_SIDE_BY_SIDE = 8
"""Servos that are run side by side; more of them save nothing."""

_NEAR = 0.75
"""Share of the greatest sync error at few sampling phases from which on all are looked at."""


def line_speed_errors(
    profile: CamProfile, task: Task, servos: Sequence[Servo], line_speeds: FloatArray, phases: int = PHASES
) -> FloatArray:
    """Greatest sync error in the shear zone at each line speed, over all sampling phases.

    The cam is fixed over the master, the servo in time. Only the shear zone is simulated, and before it what the servo remembers. The
    matrices of the servos are made once and serve every line speed.

    Parameters
    ----------
    profile
        One cycle over the master period ``[0, x_c]``.
    task
        As in `camwright.validation.servo.response.servo_response`; the cut's own line speed does not matter.
    servos
        The servos as they are, dead time and lead included.
    line_speeds
        Line speeds above 0 (m/s), shape ``(n,)``.

    Returns
    -------
    ndarray
        Greatest magnitude of the sync error (m), infinite for a servo that is unstable; shape ``(servos, n)``.

    Raises
    ------
    InputError
        The profile does not run over ``[0, x_c]``.
    """
    require_period(profile, task.cut)
    speeds = np.asarray(line_speeds, dtype=np.float64).tolist()
    found = np.full((len(servos), len(speeds)), np.inf)
    stable = [row for row, servo in enumerate(servos) if spectral_radius(servo) < 1.0]
    for first in range(0, len(stable), _SIDE_BY_SIDE):
        rows = stable[first : first + _SIDE_BY_SIDE]
        found[rows] = _side_by_side(profile, task, [servos[row] for row in rows], speeds, phases)
    return found


def worst_line_speed_error(profile: CamProfile, task: Task, servos: Sequence[Servo], line_speeds: FloatArray) -> float:
    """Greatest sync error over servos and line speeds (m): the greatest of `line_speed_errors`, whose arguments these are.

    At all line speeds a few sampling phases are looked at, all phases where that comes near the greatest.
    """
    few = line_speed_errors(profile, task, servos, line_speeds, FEW_PHASES)
    if not np.isfinite(few).all():
        return math.inf
    near = few >= _NEAR * few.max()
    speeds = np.asarray(line_speeds, dtype=np.float64)
    return max(
        float(line_speed_errors(profile, task, [servo], speeds[columns]).max())
        for servo, columns in zip(servos, near, strict=True)
        if columns.any()
    )


def _side_by_side(
    profile: CamProfile, task: Task, servos: Sequence[Servo], speeds: Sequence[float], phases: int
) -> FloatArray:
    """Run a few stable servos at each line speed; as `line_speed_errors`."""
    past = max(memory(servo.loop) for servo in servos)
    alone = len(servos) == 1  # then another call may find it lifted
    lifted = lift(servos[0].loop, past, (1, 0)) if alone else lift_side_by_side(loops_of(servos), past, (1, 0), BLOCK)
    shortest = min(servo.sample_time for servo in servos)
    found = np.empty((len(servos), len(speeds)))
    for column, speed in enumerate(speeds):
        if past + task.cut.shear_zone / (speed * shortest) > WHOLE_PART:
            slower = task.at_speed(speed)
            found[:, column] = [shear_zone_errors(profile, slower, [servo], phases)[0] for servo in servos]
        else:
            run = shear_zone_run(profile, task.at_speed(speed).cut, servos, lifted, phases)
            found[:, column] = shear_zone_peaks(run, profile, task, len(servos))  # where zones lie knows no speed
    return found
