"""How far an axis can be off when the line creeps: bounds that hold without a simulation, which would take for ever there.

Over time a slow line asks for little. What the axis is behind its command is the command's velocity, weighted over the past by what the
loop has not yet done of a unit step; so it goes to nothing with the line speed, and what is left is what the command itself is off.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.servo import Servo, mean_lag
from camwright.profiles.task import Task
from camwright.validation.motion import greatest_magnitude
from camwright.validation.servo.axis_run import AxisRun
from camwright.validation.servo.lifting import lift
from camwright.validation.servo.response import shear_zone_peaks
from camwright.validation.servo.simulation import memory

_SAFE = 1.25
"""Factor on the bounds: they are sums over samples, the axis is bounded between them too."""

_POINTS = 513
"""Places in the shear zone at which the command itself is looked at."""


@dataclass(frozen=True)
class Tracking:
    """How an axis follows its command, as bounds for any command.

    Parameters
    ----------
    behind
        Greatest distance behind the command per greatest speed of it (s).
    late
        Greatest change of that distance per greatest acceleration of the command (s²).
    lag
        Distance behind at constant speed, per speed, signed (s).
    forgotten
        Time after which nothing earlier is felt (s).
    gain
        Greatest speed of the axis per greatest speed of the command.
    """

    behind: float
    late: float
    lag: float
    forgotten: float
    gain: float


@lru_cache(maxsize=32)  # a property of the servo alone
def tracking(servo: Servo) -> Tracking:
    """Sum up how a stable servo follows.

    Raises
    ------
    InputError
        The servo is unstable.
    """
    past = memory(servo.loop)
    newest_first = lift(servo.loop, past, (1, 0)).history[
        0, 2, ::-1
    ]  # weights of the command's samples in the axis' place
    undone = np.abs(np.concatenate(([1.0], 1.0 - np.cumsum(newest_first))))
    step, delay = servo.sample_time, abs(servo.delay)
    times = step * np.arange(1, len(undone) + 1) + delay
    return Tracking(
        behind=_SAFE * (step * float(undone.sum()) + step + delay),
        late=_SAFE * (step * float(undone @ times) + 0.5 * (step + delay) ** 2),
        lag=mean_lag(servo) - servo.lead_time,
        forgotten=step * (past + 2) + delay,
        gain=_SAFE * (1.0 + float(np.abs(newest_first).sum())),
    )


def command_error(profile: CamProfile, task: Task) -> float:
    """Greatest sync error in the shear zone of an axis that follows its command at once (m): that of a line that stands nearly still."""
    cut = task.cut
    start = cut.return_start + cut.return_zone + cut.shear_zone_at
    room = max(cut.shear_zone / (_POINTS - 1), 1e-6 * cut.length)
    master = np.linspace(start - room, start + cut.shear_zone + room, _POINTS)[None]
    run = AxisRun(master, profile(master, outside="repeat"), profile(master, 1, outside="repeat"))
    return float(shear_zone_peaks(run, profile, task, 1)[0])


def creeping_speeds(profile: CamProfile, task: Task, servo: Servo) -> tuple[float, float]:
    """Line speeds below which the axis is surely within the sync tolerance in the shear zone, and surely not.

    Parameters
    ----------
    profile
        One cycle over the master period ``[0, x_c]``.
    task
        As in `camwright.validation.servo.response.servo_response`; the cut's own line speed does not matter.
    servo
        A stable servo.

    Returns
    -------
    (within, outside)
        In m/s; one of the two is 0, or both where the command itself is off by just the tolerance.

    Raises
    ------
    InputError
        The servo is unstable.
    """
    cut, follows = task.cut, tracking(servo)
    error, lever = command_error(profile, task), _lever(task)
    fastest = greatest_magnitude(profile, 1).value
    per_speed = lever * follows.behind * fastest
    room = cut.sync_tolerance - error
    if room <= 0.0:
        return 0.0, -room / per_speed
    within = room / per_speed
    if (
        not cut.shaped
    ):  # in sync all the way: once the return is forgotten, only the lag and the bend of the ratio are left
        ratio, slope = (greatest_magnitude(task.sync, order).value for order in (1, 2))
        linear, square = lever * abs(follows.lag) * ratio, lever * follows.late * slope
        kept = (
            2.0 * room / (linear + math.hypot(linear, 2.0 * math.sqrt(square * room))) if linear or square else math.inf
        )
        within = max(within, min(cut.shear_zone_at / follows.forgotten, kept))
    return within, 0.0


def creeping_axis(profile: CamProfile, task: Task, servo: Servo, allowed: float) -> float:
    """Line speed below which the axis itself surely keeps the limits of speed, acceleration and reversal.

    Parameters
    ----------
    profile, task, servo
        As in `creeping_speeds`.
    allowed
        Backward speed that counts as none where the slave must not run backwards (slave unit/s).

    Raises
    ------
    InputError
        The servo is unstable.
    """
    follows, limits = tracking(servo), task.limits
    ratio, slope = (greatest_magnitude(profile, order).value for order in (1, 2))
    speed = limits.speed / (follows.gain * ratio)
    acceleration = math.sqrt(limits.acceleration / (follows.gain * slope))
    if task.reverses:
        return min(speed, acceleration)
    # the axis is slower than its command by what that changes within the time that it is behind
    slower, least = follows.behind * slope, max(profile.extrema(1)[0].value, 0.0)
    forward = (least + math.sqrt(least**2 + 4.0 * slower * allowed)) / (2.0 * slower)
    return min(speed, acceleration, forward)


def _lever(task: Task) -> float:
    """Bound the tool's travel per slave travel about the sync zone; a percent for the axis being off."""
    start, end = task.slave_at_sync_start, task.slave_at_sync_end
    return 1.01 * float(np.abs(task.machine.tool_ratio(np.linspace(start, end, _POINTS))).max())
