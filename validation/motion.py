"""Motion of a profile over time at the cut's line speed: peaks, root mean squares, error of the speed in sync.

The slave's measures are in its own unit (m or rad), the tool's in m.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from camwright.profiles.cut import Cut
from camwright.profiles.errors import InputError
from camwright.profiles.machines import Machine
from camwright.profiles.polynomial.profile import CamProfile, Extremum, FloatArray
from camwright.profiles.task import Task
from camwright.validation.composed import compose

RATIO_JUMP = 1e-9
"""Jump of the ratio above which acceleration and jerk count as unbounded, relative to `ratio_scale`."""

SLOPE_JUMP = 1e-9
"""Jump of the ratio slope above which the jerk counts as unbounded, relative to `slope_scale`. Rounding of the
standard laws leaves jumps of up to about 3e-12 of that scale, a table of 1e-7 relative resolution jumps of more than
1e-7."""

POSITION_JUMP = 1e-12
"""Jump of the position, relative to `position_scale`, above which speed, acceleration and jerk count as unbounded."""

_DOMAIN = 1e-12
"""Rounding, relative to the cut length, that a profile's domain may be off the period ``[0, x_c]``."""

_EDGE = 1e-12
"""Rounding, relative to the cut length, by which a break may miss the end of the sync zone that it stands for."""


@dataclass(frozen=True)
class MotionMeasures:
    """Measures of one cycle over time, of the slave or of the tool (``u`` is m or rad).

    ``None`` stands for unbounded. The peaks are of the whole cycle, the root mean squares of the return zone alone,
    so that they do not depend on how long the slave runs in sync. The least velocity is signed.

    Parameters
    ----------
    peak_speed
        Greatest speed (u/s).
    min_speed
        Least velocity, negative where it runs backwards (u/s).
    peak_acceleration, rms_acceleration
        Greatest magnitude and root mean square over the return zone (u/s²).
    peak_jerk, rms_jerk
        Greatest magnitude and root mean square over the return zone (u/s³).
    sync_ratio_error
        Greatest ``|tool speed / (s × line speed) - 1|`` inside the sync zone, ``s`` the cut's sync ratio.
    """

    peak_speed: float
    min_speed: float
    peak_acceleration: float | None
    rms_acceleration: float | None
    peak_jerk: float | None
    rms_jerk: float | None
    sync_ratio_error: float


def require_period(profile: CamProfile, cut: Cut) -> None:
    """Refuse a profile that does not run over one master period ``[0, x_c]`` of the cut.

    Raises
    ------
    InputError
        The profile's domain is another one.
    """
    allowed = _DOMAIN * cut.length
    if abs(profile.start) > allowed or abs(profile.end - cut.length) > allowed:
        raise InputError(
            f"the profile runs over the master from {profile.start!r} m to {profile.end!r} m, but one cycle of this "
            f"cut runs from 0 m to the cut length {cut.length!r} m; judge it with the cut that it was made for"
        )


def greatest_magnitude(profile: CamProfile, order: int) -> Extremum:
    """Greatest magnitude of a derivative over the master, one-sided values at breaks included, and its place."""
    least, greatest = profile.extrema(order)
    return Extremum(-least.value, least.at) if -least.value > greatest.value else greatest


@lru_cache(maxsize=16)  # several checks ask for the same jumps
def greatest_jump(profile: CamProfile, order: int) -> Extremum:
    """Greatest magnitude of the jumps of a derivative, at all joins and at the seam, and where it is.

    The position (``order=0``) is judged at the joins only: at the seam it is judged by the advance.
    """
    jumps = abs(profile.jumps(order))
    worst = int(jumps.argmax())
    return Extremum(float(jumps[worst]), float(profile.breaks[worst + 1]))


def position_scale(profile: CamProfile, machine: Machine) -> float:
    """Size of the slave's travel that rounding is measured against (slave unit): the cut length for m, one turn for rad."""
    return profile.length if machine.slave_unit == "m" else 2 * math.pi


def ratio_scale(profile: CamProfile, machine: Machine) -> float:
    """Size of the ratio that rounding is measured against: 1 for m, the greatest ratio for rad (rad/m)."""
    return 1.0 if machine.slave_unit == "m" else greatest_magnitude(profile, 1).value


def slope_scale(profile: CamProfile) -> float:
    """Size of the ratio slope (slave unit/m²): its greatest magnitude, at least a ratio of one per cycle."""
    return max(greatest_magnitude(profile, 2).value, 1.0 / profile.length)


def is_steady(profile: CamProfile, machine: Machine) -> bool:
    """Whether neither position nor ratio jumps, so that the acceleration is bounded."""
    if greatest_jump(profile, 0).value > POSITION_JUMP * position_scale(profile, machine):
        return False
    return greatest_jump(profile, 1).value <= RATIO_JUMP * ratio_scale(profile, machine)


def is_smooth(profile: CamProfile) -> bool:
    """Whether the ratio slope does not jump, so that the jerk of a steady profile is bounded."""
    return greatest_jump(profile, 2).value <= SLOPE_JUMP * slope_scale(profile)


def tool_profile(profile: CamProfile, task: Task) -> CamProfile:
    """Tool over the master (m): the profile itself where the slave is counted in m, else the carriage ``X(y)`` from zero.

    The carriage's ratio ``X'(y) y'`` is made polynomials (`camwright.validation.composed.compose`, to 1e-13) and integrated.
    """
    if task.machine.slave_unit == "m":
        return profile
    start = task.slave_zero(profile)
    return compose(lambda y, ratio, _: np.asarray(task.machine.tool_ratio(start + y) * ratio), profile).integral()


@lru_cache(maxsize=8)  # a measure of the motion, and a check
def sync_ratio_error(profile: CamProfile, task: Task) -> Extremum:
    """Greatest ``|tool speed / (s × line speed) - 1|`` inside the sync zone, and where it is reached.

    The ends of the zone count with their one-sided values inside the zone. Exact where the slave's ratio is constant in sync, else to
    1e-13 (`camwright.validation.composed.compose`).
    """
    cut = task.cut
    edge = _EDGE * cut.length
    worst = Extremum(0.0, cut.sync_parts[0][0])
    for start, end in cut.sync_parts:
        part = profile.restrict(start + edge, min(end, profile.end) - edge)
        for found in _tool_in_sync(part, profile, task):
            error = abs(found.value / cut.sync_ratio - 1.0)
            if error > worst.value:
                worst = Extremum(error, found.at)
    return worst


def _tool_in_sync(part: CamProfile, profile: CamProfile, task: Task) -> tuple[Extremum, Extremum]:
    """Least and greatest ratio of the tool over the master in a part of the sync zone."""
    if task.straight:  # so the tool's ratio to the slave is constant too: what the sync zone says
        per_slave = task.cut.sync_ratio / float(task.sync(0.0, 1))
        least, greatest = part.extrema(1)
        return Extremum(per_slave * least.value, least.at), Extremum(per_slave * greatest.value, greatest.at)
    start = task.slave_zero(profile)
    if (
        part.end > 0.5 * task.cut.length
    ):  # the next pitch is the next blade, and the formulas speak of the blade that cuts
        start -= task.machine.pitch

    def ratio(y: FloatArray, slope: FloatArray, _: FloatArray) -> FloatArray:
        return np.asarray(task.machine.tool_ratio(start + y) * slope)

    return compose(ratio, part).extrema(0)


def measure_motion(profile: CamProfile, task: Task) -> MotionMeasures:
    """Measure the slave at the line speed of the cut, by roots of its polynomials and exact integration.

    Over time ``velocity = v y'``, ``acceleration = v² y''``, ``jerk = v³ y'''``.

    Parameters
    ----------
    profile
        One cycle over the master period ``[0, x_c]`` (slave unit).
    task
        The machine, its sync zone placed, and the cut it is judged for.

    Raises
    ------
    InputError
        The profile does not run over ``[0, x_c]``, or the machine's sync zone is not placed.
    """
    require_period(profile, task.cut)
    steady = is_steady(profile, task.machine)
    return _measure(profile, task.cut, steady, steady and is_smooth(profile), sync_ratio_error(profile, task).value)


def measure_tool(profile: CamProfile, task: Task, slave: MotionMeasures | None = None) -> MotionMeasures:
    """Measure the tool (m) like `measure_motion` the slave; where the slave is counted in m both are the same.

    Parameters
    ----------
    profile, task
        As in `measure_motion`.
    slave
        Measures of the slave, if they are known already.
    """
    if slave is None:
        slave = measure_motion(profile, task)
    if task.machine.slave_unit == "m":
        return slave
    steady, smooth = slave.peak_acceleration is not None, slave.peak_jerk is not None
    return _measure(tool_profile(profile, task), task.cut, steady, smooth, slave.sync_ratio_error)


def _measure(profile: CamProfile, cut: Cut, steady: bool, smooth: bool, in_sync: float) -> MotionMeasures:
    v = cut.line_speed
    start, end = cut.return_start, cut.return_start + cut.return_zone
    back = profile.restrict(start, min(end, profile.end)) if steady else profile

    def rms(order: int) -> float:
        return v**order * math.sqrt(back.mean_square(order))

    return MotionMeasures(
        peak_speed=v * greatest_magnitude(profile, 1).value,
        min_speed=v * profile.extrema(1)[0].value,
        peak_acceleration=v**2 * greatest_magnitude(profile, 2).value if steady else None,
        rms_acceleration=rms(2) if steady else None,
        peak_jerk=v**3 * greatest_magnitude(profile, 3).value if smooth else None,
        rms_jerk=rms(3) if smooth else None,
        sync_ratio_error=in_sync,
    )
