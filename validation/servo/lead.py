"""Where the cut falls at every line speed: what dead time does to it, and what a lead time makes up for."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.servo import Servo, mean_lag
from camwright.profiles.task import Task
from camwright.validation.motion import require_period
from camwright.validation.servo.axis_run import AxisRun
from camwright.validation.servo.lifting import lift_side_by_side, loops_of
from camwright.validation.servo.response import shear_zone_error
from camwright.validation.servo.simulation import PHASES, memory, shear_zone_run, slow_shear_zone_run

SHARES = (0.1, 0.25, 0.5, 1.0)
"""Shares of the line speed at which the cut is looked at."""


@dataclass(frozen=True)
class LengthError:
    """Where the cut falls at one line speed, against where it should; positive where the tool is late and the piece too long.

    Parameters
    ----------
    share
        Line speed as a share of the job's.
    line_speed
        Line speed (m/s).
    offset
        Mean distance of the tool behind the material in the shear zone, mean over the sampling phases (m). The same for every cut at
        this line speed: it moves all cuts alike, and spoils a length where the line speed changes.
    variation
        Greatest minus least over the sampling phases (m): what changes from cut to cut.
    offset_with_lead
        The offset with the lead time that makes up for the mean lag (`camwright.profiles.servo.mean_lag`).
    """

    share: float
    line_speed: float
    offset: float
    variation: float
    offset_with_lead: float


def length_errors(profile: CamProfile, task: Task, servo: Servo) -> tuple[LengthError, ...]:
    """Predict where the cut falls when the line runs slower: the same cam over the master, slower in time.

    Parameters
    ----------
    profile
        One cycle over the master period ``[0, x_c]``.
    task
        As in `camwright.validation.servo.response.servo_response`.
    servo
        The servo, its dead time and lead included.

    Returns
    -------
    tuple
        One entry for each of `SHARES`, in this order.

    Raises
    ------
    InputError
        The profile does not run over ``[0, x_c]``, or the servo is unstable.
    """
    cut = task.cut
    require_period(profile, cut)
    servos = (servo, replace(servo, lead_time=mean_lag(servo)))
    lifted = lift_side_by_side(loops_of(servos), memory(servo.loop), (1, 0))
    found = []
    for share in SHARES:
        slower = task.at_speed(share * cut.line_speed)
        closed = [slow_shear_zone_run(profile, slower.cut, each, PHASES) for each in servos]
        runs = [run for run in closed if run is not None]
        if len(runs) < len(servos):
            runs = [shear_zone_run(profile, slower.cut, servos, lifted)]
        late = np.concatenate([_late(run, profile, slower) for run in runs]).reshape(len(servos), PHASES)
        offset, with_lead = late.mean(axis=1).tolist()
        found.append(LengthError(share, slower.cut.line_speed, offset, float(np.ptp(late[0])), with_lead))
    return tuple(found)


def _late(run: AxisRun, profile: CamProfile, task: Task) -> FloatArray:
    """Mean distance of the tool behind the material in the shear zone at each sampling phase (m)."""
    master, error, slope = shear_zone_error(run, profile, task)
    if task.cut.shear_zone == 0:
        return -error[:, 0]
    # mean of the cubics between the points, 0 wide where a row is filled up
    step = np.diff(master, axis=1)
    area = 0.5 * step * (error[:, :-1] + error[:, 1:]) + step**2 / 12 * (slope[:, :-1] - slope[:, 1:])
    return np.asarray(-area.sum(axis=1) / (master[:, -1] - master[:, 0]))
