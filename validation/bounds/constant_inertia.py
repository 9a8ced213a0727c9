"""Lower bounds of torque and energy where the inertia is constant: closed forms of speed, standstill and friction."""

from __future__ import annotations

import math

import numpy as np

from camwright.profiles.closed_forms.overshoot import least_overshoot
from camwright.profiles.closed_forms.reach import greatest_reach, least_acceleration
from camwright.profiles.closed_forms.transfer import Bounds
from camwright.profiles.halving import halved
from camwright.profiles.polynomial.profile import FloatArray
from camwright.profiles.task import Task

HALVINGS = 60
ROUNDING = 1e-9
"""Share by which a bound that a design may reach is lowered."""
STOPS = 400
"""Times and ways of a stop that are looked at."""
ENDS = 120
"""Ways of a stop that are looked at beside these, closer and closer to either end: on a slow line one of them is next to nothing."""
COAST = 0.1
"""Least time of a stop that is looked at, in that of coasting to rest, which costs least of all."""
SPLITS = 200
"""Moments of a standstill that are looked at."""
BETWEEN = 2e-3
"""Share by which a bound that is the least over such places is lowered, for what lies between them."""


def farthest_speed(task: Task) -> float:
    """Speed farthest from that in sync which every return must have somewhere (m/s), where the slave's ratio is constant in sync.

    Whether limits leave any return is known in closed form, so the limit of the speed is lowered until they leave none.
    """
    pace = float(task.sync(0.0, 1)) * task.cut.line_speed
    time = task.cut.return_zone / task.cut.line_speed
    height = task.height - pace * time
    limits = task.limits
    room = (limits.speed - pace) if height > 0 else pace - task.least_velocity
    low = halved(lambda change: _possible(task, change, pace, time, height), room, 0.0, most=HALVINGS)[1]
    return pace + math.copysign(low, height)


def _possible(task: Task, change: float, pace: float, time: float, height: float) -> bool:
    limits = task.limits
    guide = task.machine.guide
    if guide is None:
        return greatest_reach(time, change, limits.acceleration, limits.jerk) >= abs(height)
    bounds = Bounds(pace - change, limits.speed, limits.acceleration, limits.jerk)
    spare = 0.5 * (guide[1] - guide[0] - task.sync.advance)
    found = least_overshoot(time, pace, task.sync.advance, bounds, spare)
    return found is not None and found.distance <= spare


def drawn(task: Task) -> float:
    """Energy that every cycle draws at least (J), where the slave's ratio is constant in sync.

    The kinetic energy must rise from that of the lowest velocity, or to that of the highest speed; friction takes its force times the way.
    What rises is paid with the friction over its own way, which is no shorter than the acceleration's limit makes it.
    """
    inertia, friction = float(task.machine.inertia(task.slave_at_sync_start)), task.machine.friction
    pace = float(task.sync(0.0, 1)) * task.cut.line_speed
    speed = farthest_speed(task)
    rise = abs(pace**2 - max(speed, 0.0) ** 2) + min(speed, 0.0) ** 2
    way = rise / (2.0 * task.limits.acceleration)
    travel = abs(task.height) + task.sync.advance
    at_zone = friction * task.sync.advance
    return max(friction * travel, 0.5 * inertia * rise + friction * way + at_zone) * (1 - ROUNDING)


def square_with_friction(task: Task, softest_square: float) -> float:
    """Integral of the squared force over time that every return has at least (N² s), where friction is paid while the slave moves.

    Parameters
    ----------
    task
        The job, its slave turning one way.
    softest_square
        Least integral of the squared acceleration of any return (m²/s³).

    A slave that never stands pays for all the time. One that stands stops on a way in a time and starts on what is left in another: cubics
    are the softest, or cubics that stop sooner where these would run backwards.
    """
    inertia, friction = float(task.machine.inertia(task.slave_at_sync_start)), task.machine.friction
    out, into = (float(task.sync(at, 1)) * task.cut.line_speed for at in (task.sync.end, task.sync.start))
    time = task.cut.return_zone / task.cut.line_speed
    moving = inertia**2 * softest_square + friction**2 * time
    coast = COAST * inertia * min(out, into) / friction
    least = min(1e-4, coast / time, 0.5 * coast * min(out, into) / abs(task.height))
    half = np.union1d(np.linspace(1e-4, 0.5, STOPS // 2), np.geomspace(least, 1e-2, ENDS))
    way = task.height * np.append(half, 1.0 - half[::-1])
    times = time * np.geomspace(min(1e-4, coast / time), 1.0, 4 * STOPS * max(1, math.ceil(-0.25 * math.log10(least))))
    stop, start = (_stop(way, pace, times, inertia, friction) for pace in (out, into))
    # between two moments of the standstill the later one leaves the stop most time, the earlier one the start
    split = np.linspace(0.0, time, SPLITS + 1)
    before, after = (
        np.searchsorted(times, split[1:] * (1 - ROUNDING)),
        np.searchsorted(times, (time - split[:-1]) * (1 - ROUNDING)),
    )
    standing = float((stop[before] + start[after, ::-1]).min()) * (1 - BETWEEN)
    return min(moving, standing)


def _stop(way: FloatArray, pace: float, times: FloatArray, inertia: float, friction: float) -> FloatArray:
    """Least cost of coming to rest over ways in any time up to given ones, shape ``(times, ways)``."""
    t = times[:, None]
    used = np.minimum(t, 3.0 * way / pace)  # beyond that the cubic would run backwards: it stops sooner
    square = 4 * pace**2 / used - 12 * pace * way / used**2 + 12 * way**2 / used**3
    return np.asarray(np.minimum.accumulate(inertia**2 * square + friction**2 * used, axis=0))


def peak_with_friction(task: Task) -> float:
    """Force that every return has somewhere at least (N), where friction helps to brake and must be overcome to accelerate.

    With ``a`` the least peak of an acceleration that may be as large both ways, ``1/a⁺ + 1/a⁻ >= 2/a`` holds for any other pair; the force
    ``P`` is ``I a⁺ + F`` one way and ``I a⁻ - F`` the other, so ``P² - I a P - F² >= 0``.
    """
    inertia, friction = float(task.machine.inertia(task.slave_at_sync_start)), task.machine.friction
    pace = float(task.sync(0.0, 1)) * task.cut.line_speed
    time = task.cut.return_zone / task.cut.line_speed
    height = task.height - pace * time
    room = (task.limits.speed - pace) if height > 0 else pace - task.least_velocity
    if height == 0.0:
        return friction
    half = 0.5 * inertia * least_acceleration(abs(height), time, room, math.inf)
    return (half + math.hypot(half, friction)) * (1 - ROUNDING)
