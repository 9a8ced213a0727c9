"""What the real axis makes of a profile: when it meets the material, when it stays with it, how far it is off."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from camwright.profiles.cut import Cut
from camwright.profiles.machines import Machine
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.servo import Servo
from camwright.profiles.task import Task
from camwright.validation.servo.axis_run import AxisRun, ServoRun, hermite
from camwright.validation.servo.lifting import SUBSTEPS
from camwright.validation.servo.simulation import (
    run_about,
    simulate,
    slow_axis,
    slow_cycle,
    slow_run,
    slow_shear_zone_run,
)
from camwright.validation.servo.slow_axis import decided, humps

ON_THE_LINE = 1e-9
"""Part of the cut length within which the axis counts as lying on the ideal sync line; well above rounding, well
below what a drive resolves."""

_AS_GREAT = 1.0 - 1e-6
"""Share of the greatest error that counts as it; the first such point is taken."""

_NEAR = 0.9
"""Share of a greatest error below which no hump of it is looked for."""

_ROUNDING = 1e-15
"""Share of the positions by which errors differ that are the same: they are differences of positions."""

_Index = Any
"""Anything that picks points of an array."""

_ZERO = 1e-12
"""Accuracy of a zero between two points of the axis, as a part of the step between them."""


@dataclass(frozen=True)
class ServoResponse:
    """Response of the servo over all sampling phases, SI units (m).

    Distances are master travel from the start of the sync zone. The sync error is that of the tool, along the material: where the axis
    puts it, minus where it would move with the material.

    Parameters
    ----------
    crossing
        Where the sync error first changes its sign after it was greatest (the paper's criterion for the transition length), at
        the phase where that is latest; 0 if the axis lies on the line throughout, ``None`` if at some phase it meets
        the line nowhere in the zone.
    settling
        Beyond this distance the sync error stays within the tolerance, at every phase; 0 if it never leaves it,
        ``None`` if at some phase it is outside at the end of the zone.
    overshoot
        Greatest sync error of the other sign after the crossing, at the worst phase; 0 without a crossing.
    peak_following_error
        Greatest magnitude of command minus axis over the whole cycle, at the tool where the slave is an angle.
    shear_zone_error
        Greatest magnitude of the sync error in the shear zone; at its place if its length is zero.
    phases
        Number of sampling phases simulated.
    """

    crossing: float | None
    settling: float | None
    overshoot: float
    peak_following_error: float
    shear_zone_error: float
    phases: int


def servo_response(profile: CamProfile, task: Task, servo: Servo, tolerance: float | None = None) -> ServoResponse:
    """Simulate the servo on a profile and measure its response.

    Parameters
    ----------
    profile
        One cycle over the master period ``[0, x_c]``.
    task
        The machine, which says what the ideal sync line is, and the cut.
    tolerance
        Sync error allowed for the settling length (m); the cut's sync tolerance if not given.

    Raises
    ------
    InputError
        As `camwright.validation.servo.simulation.simulate`.
    """
    cut = task.cut
    slow = slow_cycle(profile, cut, servo)
    if slow is not None:
        return decided(slow, lambda *known: _with_places(slow_run(profile, *known), profile, task, tolerance))
    return measure_response(simulate(profile, cut, servo), profile, task, tolerance)


def measure_response(run: ServoRun, profile: CamProfile, task: Task, tolerance: float | None = None) -> ServoResponse:
    """Measure a simulated response; arguments as in `servo_response`."""
    return _measured(run, profile, task, tolerance)[0]


def _with_places(
    run: ServoRun, profile: CamProfile, task: Task, tolerance: float | None
) -> tuple[ServoResponse, list[float]]:
    """Measure a response at some of its samples; gives the master positions (m), too, that decided it."""
    response, zone, shear = _measured(run, profile, task, tolerance)
    start = task.cut.return_start + task.cut.return_zone
    greatest = (zone, (zone[0], -zone[1]), (run.master, _following_sizes(run, profile, task)), shear)
    met = [start + place for place in (response.crossing, response.settling) if place is not None]
    noise = _noise(profile, task)
    return response, [*met, *(place for master, size in greatest for place in humps(master, size, noise))]


def _noise(profile: CamProfile, task: Task) -> float:
    """Give the difference up to which errors are the same (m)."""
    return _ROUNDING * max(abs(profile.advance), task.cut.length)


_Bound = float | FloatArray
"""A master position (m), or one of each phase."""

_Curve = tuple[FloatArray, FloatArray]
"""Master positions (m) and what is seen there, shapes ``(phases, n)``."""


def _measured(
    run: ServoRun, profile: CamProfile, task: Task, tolerance: float | None
) -> tuple[ServoResponse, _Curve, _Curve]:
    """Measure a response; gives the sync error in the sync zone and its magnitude in the shear zone, too."""
    cut = task.cut
    start = cut.return_start + cut.return_zone  # counted on like AxisRun.master
    part = _in_sync(run, profile, task, start, start + cut.sync_zone)
    distance, error = part.master - start, part.error()
    crossing, overshoot = _crossing(distance, error, part.slope, ON_THE_LINE * cut.length)
    settling = _settling(distance, error, part.slope, cut.sync_tolerance if tolerance is None else tolerance)
    shear = _in_sync(run, profile, task, *shear_zone_of(cut))
    off = np.abs(shear.error())
    response = ServoResponse(
        crossing=crossing,
        settling=settling,
        overshoot=overshoot,
        peak_following_error=_peak_following_error(run, profile, task),
        shear_zone_error=float(off.max()),
        phases=run.phases,
    )
    return response, (part.master, error), (shear.master, off)


def sync_error(
    run: AxisRun, profile: CamProfile, task: Task, start: float, end: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Tool minus ideal sync line in a part of the sync zone, for every sampling phase.

    The ideal line passes through the profile's position at the cut length ``x_c``, which lies in the sync zone with
    either origin (S1: ``Y = X - x_c + y_c`` in the first cycle); for a shaped command, which is elsewhere there, through the pitch. With
    the machine's map ``X`` and the slave coordinate ``c`` of that line the error is ``X(c + e) - X(c)`` for an axis that is off by ``e``.

    Parameters
    ----------
    start, end
        The part (m), counted like `camwright.validation.servo.axis_run.AxisRun.master`.

    Returns
    -------
    (master, error, slope)
        Master position (m), error (m) and its derivative over the master; shapes ``(phases, n)``.
    """
    part = _in_sync(run, profile, task, start, end)
    return part.master, part.error(), part.slope()


@dataclass(frozen=True, eq=False)
class _InSync:
    """The axis beside the ideal sync line in a part of the sync zone, at every sampling phase; shapes ``(phases, n)``.

    Parameters
    ----------
    machine, sync
        The machine, and its slave in the sync zone.
    master, along
        Master position, counted on and from the start of the sync zone (m).
    ideal, actual
        Slave coordinate on the line, and of the axis (slave unit).
    """

    machine: Machine
    sync: CamProfile
    master: FloatArray
    along: FloatArray
    ideal: FloatArray
    actual: FloatArray
    ratio: FloatArray

    def error(self) -> FloatArray:
        """Tool minus ideal sync line (m)."""
        return np.asarray(self.machine.tool(self.actual) - self.machine.tool(self.ideal))

    def slope(self, at: _Index = ...) -> FloatArray:
        """Give the derivative of the error over the master, at some of the points or at all."""
        moves = self.machine.tool_ratio(self.actual[at]) * self.ratio[at]
        return np.asarray(moves - self.machine.tool_ratio(self.ideal[at]) * self.sync(self.along[at], 1))


def _in_sync(run: AxisRun, profile: CamProfile, task: Task, start: _Bound, end: _Bound) -> _InSync:
    """Put the axis beside the ideal sync line; arguments as in `sync_error`."""
    cut = task.cut
    zone = cut.return_start + cut.return_zone
    sync = task.sync
    master, axis, ratio = run.window(start, end)
    along = np.minimum(np.maximum(master - zone, sync.start), sync.end)
    travel = sync(along)
    line = travel + _line_at(profile, task)
    ideal = task.slave_at_sync_start + travel
    return _InSync(task.machine, sync, master, along, ideal, ideal + (axis - line), ratio)


def _line_at(profile: CamProfile, task: Task) -> float:
    """Slave position on the ideal line less the travel in the sync zone."""
    cut, sync = task.cut, task.sync
    met = task.machine.pitch if cut.shaped else float(profile(profile.end))
    return met - float(sync(min(max(cut.length - cut.return_start - cut.return_zone, sync.start), sync.end)))


def _off_line(run: AxisRun, profile: CamProfile, task: Task, start: _Bound, end: _Bound) -> FloatArray:
    """Tool minus ideal sync line alone, quicker where that is a straight line; arguments as in `sync_error`."""
    if not task.straight:
        return _in_sync(run, profile, task, start, end).error()
    sync, zone = task.sync, task.cut.return_start + task.cut.return_zone
    master, axis = run.places(start, end)
    ratio = float(sync(sync.start, 1))
    master *= ratio
    axis -= master
    axis -= float(sync(sync.start)) + _line_at(profile, task) - ratio * (zone + sync.start)
    per_slave = task.cut.sync_ratio / ratio  # of the tool, as constant as the ratio
    return axis if per_slave == 1.0 else per_slave * axis


def shear_zone_error(run: AxisRun, profile: CamProfile, task: Task) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Sync error in the shear zone; as `sync_error`."""
    return sync_error(run, profile, task, *shear_zone_of(task.cut))


def greatest_sync_error(profile: CamProfile, task: Task, servo: Servo, start: float, end: float) -> float:
    """Greatest magnitude of the sync error in a part of the sync zone, at every sampling phase (m).

    Parameters
    ----------
    profile, task, servo
        As in `servo_response`.
    start, end
        The part (m), counted like `camwright.validation.servo.axis_run.AxisRun.master`.
    """
    found = slow_sync_error(profile, task, servo, start, end, SUBSTEPS)
    if found is None:
        return float(
            np.abs(_off_line(run_about(profile, task.cut, servo, (start, end)), profile, task, start, end)).max()
        )
    return found


def shear_zone_peaks(
    run: AxisRun, profile: CamProfile, task: Task, servos: int, part: tuple[FloatArray, FloatArray] | None = None
) -> FloatArray:
    """Greatest magnitude of the sync error in the shear zone over the phases of each of several servos (m), shape ``(servos,)``.

    Of each in a part of its own (m), counted like `camwright.validation.servo.axis_run.AxisRun.master`, where such are given.
    """
    start, end = shear_zone_of(task.cut) if part is None else np.repeat(part, run.phases // servos, axis=1)
    error = _off_line(run, profile, task, start, end).reshape(servos, -1)
    return np.asarray(np.maximum(error.max(axis=1), -error.min(axis=1)))


def slow_sync_error(
    profile: CamProfile, task: Task, servo: Servo, start: float, end: float, phases: int
) -> float | None:
    """Greatest sync error in closed form: as `greatest_sync_error`; ``None`` where there is none."""
    slow = slow_axis(profile, task.cut, servo, (1, 0), (start, end), phases=phases)
    if slow is None:
        return None

    def measure(master: FloatArray, found: FloatArray) -> tuple[float, list[float]]:
        ratio, axis = found
        part = _in_sync(AxisRun(master, axis, ratio, even=False), profile, task, start, end)
        size = np.abs(part.error())
        return float(size.max()), humps(part.master, size, noise)

    noise = _noise(profile, task)
    return decided(slow, measure)


def greatest_shear_zone_error(profile: CamProfile, task: Task, servo: Servo) -> float:
    """Greatest magnitude of the sync error in the shear zone, at every sampling phase (m); arguments as in `servo_response`."""
    return greatest_sync_error(profile, task, servo, *shear_zone_of(task.cut))


def worst_place(profile: CamProfile, task: Task, servo: Servo) -> float:
    """Master position (m) in the shear zone where the sync error is greatest, of a first round; arguments as in `servo_response`."""
    run = slow_shear_zone_run(profile, task.cut, servo, SUBSTEPS)
    if run is None:
        run = run_about(profile, task.cut, servo, shear_zone_of(task.cut))
    master, error, _ = shear_zone_error(run, profile, task)
    return float(master.ravel()[np.abs(error).argmax()])


def shear_zone_of(cut: Cut) -> tuple[float, float]:
    """Start and end of the shear zone, counted on like `AxisRun.master`."""
    zone = cut.return_start + cut.return_zone
    start = zone + cut.shear_zone_at
    return start, min(start + cut.shear_zone, zone + cut.sync_zone)


def _peak_following_error(run: ServoRun, profile: CamProfile, task: Task) -> float:
    """Greatest magnitude of command minus axis; for a slave in rad at the tool (m).

    The tool of a slave that is off by ``e`` is off by at most the greatest lever times ``e``, so it is computed only where that may be
    the greatest.
    """
    machine = task.machine
    off = np.abs(run.command - run.axis)
    if machine.slave_unit == "m":
        return float(off.max())
    at_tool = _following_error(run, profile, task)
    found = float(at_tool(np.unravel_index(off.argmax(), off.shape)))
    return float(at_tool(off * _lever(machine) >= found).max(initial=found))


def _following_sizes(run: ServoRun, profile: CamProfile, task: Task) -> FloatArray:
    """Magnitude of command minus axis at every point, at the tool (m); 0 where it is surely not near its greatest."""
    off = np.abs(run.command - run.axis)
    if task.machine.slave_unit == "m":
        return off
    at_tool, lever = _following_error(run, profile, task), _lever(task.machine)
    greatest = float(at_tool(np.unravel_index(off.argmax(), off.shape)))
    near = off * lever >= _NEAR * greatest
    found = np.zeros_like(off)
    found[near] = at_tool(near)
    return found


def _following_error(run: ServoRun, profile: CamProfile, task: Task) -> Callable[[_Index], FloatArray]:
    """Give the magnitude of command minus axis (m) at points of a run; for a slave in rad at the tool."""
    machine = task.machine
    if machine.slave_unit == "m":
        return lambda at: np.abs(run.command[at] - run.axis[at])
    start = task.slave_zero(profile)
    return lambda at: np.abs(machine.tool(start + run.command[at]) - machine.tool(start + run.axis[at]))


@lru_cache(maxsize=64)
def _lever(machine: Machine) -> float:
    """Bound the tool's travel per slave travel, of a slave in rad: its greatest value around the turn, and a percent more."""
    return 1.01 * float(np.abs(machine.tool_ratio(np.linspace(0.0, 2 * np.pi, 3601))).max())


def _crossing(
    distance: FloatArray, error: FloatArray, slope: Callable[[_Index], FloatArray], floor: float
) -> tuple[float | None, float]:
    """Latest over the phases of the first change of sign after the greatest error, and the greatest error beyond it.

    What is left of the return before may have put the axis on the other side of the line by a little: it crosses the line at once, only
    then to swing out. The transition is over when it meets the line again.
    """
    size = np.abs(error)
    greatest = size.max(axis=1)
    rows = np.nonzero(greatest > floor)[0]
    if len(rows) == 0:
        return 0.0, 0.0
    first = (size[rows] >= _AS_GREAT * greatest[rows, None]).argmax(axis=1)
    side = np.sign(error[rows, first])[:, None]
    before = np.arange(error.shape[1]) <= first[:, None]
    met = (side * error[rows] <= 0.0) & ~before
    at = met.argmax(axis=1)
    crossed = met.any(axis=1)
    after = np.arange(error.shape[1]) >= at[:, None]
    beyond = np.where(after & crossed[:, None], -side * error[rows], 0.0)
    overshoot = max(0.0, float(beyond.max()))
    if not crossed.all():
        return None, overshoot
    pairs = _pairs(rows, at - 1)
    return _latest_zero(distance[pairs], error[pairs], slope(pairs)), overshoot


def _settling(
    distance: FloatArray, error: FloatArray, slope: Callable[[_Index], FloatArray], tolerance: float
) -> float | None:
    """Distance beyond which no phase is outside the tolerance."""
    outside = np.abs(error) > tolerance
    if outside[:, -1].any():
        return None
    rows = np.nonzero(outside.any(axis=1))[0]
    if len(rows) == 0:
        return 0.0
    last = error.shape[1] - 1 - outside[rows, ::-1].argmax(axis=1)
    pairs = _pairs(rows, last)
    edge = np.sign(error[rows, last])[:, None] * tolerance
    return _latest_zero(distance[pairs], error[pairs] - edge, slope(pairs))


def _pairs(rows: NDArray[np.intp], left: NDArray[np.intp]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Index of the points ``left`` and ``left + 1`` of rows; shapes ``(n, 1)`` and ``(n, 2)``."""
    return rows[:, None], left[:, None] + np.arange(2)


def _latest_zero(place: FloatArray, error: FloatArray, slope: FloatArray) -> float:
    """Greatest zero of the cubics between two points each, where the sign changes; all of shape ``(n, 2)``."""
    latest = 0.0
    rows = zip(place.tolist(), error.tolist(), slope.tolist(), strict=True)
    for (x, beyond), value, slopes in sorted(rows, reverse=True):
        if beyond <= latest:  # it ends before a zero that is known
            continue
        step = beyond - x
        if latest > x and hermite((latest - x) / step, step, value, slopes)[0] * value[0] < 0.0:
            continue  # its sign has changed before
        latest = max(latest, x + step * _zero_part(step, value, slopes))
    return latest


def _zero_part(step: float, value: list[float], slopes: list[float]) -> float:
    """Zero of the cubic through two points of different sign, as a part of the step: safeguarded Newton."""
    low, high, part = 0.0, 1.0, value[0] / (value[0] - value[1])
    line, rise = step * slopes[0], value[1] - value[0]  # as `hermite`, its powers made once
    square, cube = 3 * rise - step * (2 * slopes[0] + slopes[1]), step * (slopes[0] + slopes[1]) - 2 * rise
    while True:
        error = value[0] + part * (line + part * (square + part * cube))
        slope = (line + part * (2 * square + part * 3 * cube)) / step
        if error * value[0] > 0.0:
            low = part
        else:
            high = part
        guess = part - error / (slope * step) if slope else low
        if not low < guess < high:
            guess = 0.5 * (low + high)
        if abs(guess - part) <= _ZERO:
            return guess
        part = guess
