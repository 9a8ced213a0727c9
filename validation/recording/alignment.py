"""Where a recording lies on the cam: the zeros of master and slave, what was counted, and the line speed where the master is missing."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from camwright.profiles.errors import InputError
from camwright.profiles.machines.machine import SlaveUnit
from camwright.profiles.message import part_of
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.task import Task
from camwright.profiles.trace import Trace
from camwright.validation.recording.gears import Gear, gears_of
from camwright.validation.recording.zeros import Zeros, zeros_of

_PLACES = 360
"""Zeros of the master that are tried over a cycle."""
_HARMONICS = 8
"""Harmonics of the cam that a line speed is found by."""
_SEARCH_CYCLES = 12
"""Cycles from the beginning of the recording that the search looks at; the rest follows from there."""
_SEARCH_ROWS = 600
_FASTEST = 1.5
"""Greatest line speed that is looked for, as a share of the stated one."""
_STATED = 0.2
"""What a line speed may be off that was stated for the recording, as a part of it."""
_ROUNDS = 12
_FLAT = 1e-3
"""Departure of a cam from its straight line, as a part of its travel, below which it does not tell where the master is zero."""
_LEFT = 0.1
"""Part of the cam's departure from its straight line that a command may leave over."""
_LEFT_OF_TRAVEL = 2e-3
"""The same of the whole travel, for cams that are nearly straight."""
_SLIPPED = 0.02
"""Drift of the command a cycle, as a part of the travel, from which on it is another gear."""
_FEWEST = 3
"""Rows a cycle below which a recording tells nothing."""


@dataclass(frozen=True, eq=False)
class Alignment:
    """A recording in the coordinates of the job.

    Parameters
    ----------
    times
        Times of the rows (s).
    master
        Master position (m), counted on over the cycles like the profile's.
    command, axis
        Slave positions (slave unit), counted like the profile's.
    gear
        What was recorded.
    master_shift
        What was added to the recorded master (m), within half a cut length; 0 where there is none.
    line_speed
        Mean line speed (m/s).
    left
        What the command leaves over of the design (rms, slave unit), a steady drift taken off.
    reconstructed
        Whether the master was not recorded.
    zeros
        What lies between command and axis; what was taken off as another zero is no longer in `axis`.
    """

    times: FloatArray
    master: FloatArray
    command: FloatArray
    axis: FloatArray
    gear: Gear
    master_shift: float
    line_speed: float
    left: float
    reconstructed: bool
    zeros: Zeros


@dataclass(frozen=True, eq=False)
class _Lie:
    """A way in which the command lies on the cam: ``factor * command = profile(master) + zero + drift * master / length``.

    The master is the recorded one plus a shift, or the line speed times the time plus a shift.
    """

    gear: Gear
    shift: float
    speed: float
    zero: float
    drift: float
    left: float


def aligned(
    trace: Trace,
    profile: CamProfile,
    task: Task,
    place: str,
    line_speed: float | None = None,
    gear: float | None = None,
) -> Alignment:
    """Lay a recording over a cam.

    The zeros of a recording mean nothing, so the command is moved over the cam until it lies on it: along the master, and along the
    slave. A steady drift of the command against the cam is fitted beside, so that it moves neither zero, and left in the positions.

    Parameters
    ----------
    trace
        The recording, unwrapped.
    profile
        One cycle over the master period ``[0, x_c]``.
    task
        Machine and cut.
    place
        What messages begin with.
    line_speed
        Line speed of the recording (m/s), if it is known; used where the master was not recorded.
    gear
        Recorded travel over the slave's, if it is known.

    Raises
    ------
    InputError
        Master or command stand still, there are too few rows a cycle, or the command is not that of the cam.
    """
    cut, times = task.cut, trace.times - trace.start
    gears = gears_of(task.machine, trace.unit, gear)
    if not gears:
        raise InputError(
            f"{place}: positions in {trace.unit} are no slave of a {task.machine.kind}, which is counted in "
            f"{task.machine.slave_unit}; record the axis itself"
        )
    if float(np.ptp(trace.command)) == 0.0:
        raise InputError(
            f"{place}: the command stands still, so no cam runs; record some cycles of a line that runs, and the axis' own set value"
        )
    master = None if trace.master is None else _counted_on(trace.master, trace.master_unit, cut.length, place)
    found = []
    for each in gears:
        slave = each.factor * trace.command
        found += [
            _refined(times, slave, master, start, profile)
            for start in (
                _starts_of_speed(times, slave, each, profile, _speeds(times, task, line_speed))
                if master is None
                else _starts_of_master(master, slave, each, profile)
            )
        ]
    # a cam that reads the same backwards would fit a line that runs backwards
    best = min(
        (lie for lie in found if master is not None or lie.speed > 0.0), key=lambda lie: lie.left, default=found[0]
    )
    _require_the_cam(best, profile, place, master is None)
    counted = best.speed * times if master is None else master
    if float(np.ptp(counted)) < cut.length:
        raise InputError(
            f"{place}: the master travels {1e3 * float(np.ptp(counted)):.4g} mm, less than one cut of {1e3 * cut.length:.4g} mm; record "
            "some cycles"
        )
    line = float(np.polyfit(times, counted, 1)[0])
    shift = (best.shift + 0.5 * cut.length) % cut.length - 0.5 * cut.length
    turns = round((best.shift - shift) / cut.length) * profile.advance
    command, axis = (best.gear.factor * signal - best.zero - turns for signal in (trace.command, trace.actual))
    zeros = zeros_of(profile, counted + shift, line, axis - command)
    return Alignment(
        times=trace.times,
        master=counted + shift,
        command=command,
        axis=axis - zeros.taken_off,
        gear=best.gear,
        master_shift=0.0 if master is None else shift,
        line_speed=line,
        left=best.left,
        reconstructed=master is None,
        zeros=zeros,
    )


def _counted_on(recorded: FloatArray, unit: SlaveUnit, length: float, place: str) -> FloatArray:
    """Master position in m, growing."""
    master = recorded * (1.0 if unit == "m" else length / (2.0 * math.pi))
    travel = float(master[-1] - master[0])
    if travel < 0.0:
        master, travel = -master, -travel
    cycles = travel / length
    if not cycles > 0.0:
        raise InputError(
            f"{place}: the master does not move; record it, or leave its column out if it was not connected"
        )
    if len(master) < _FEWEST * cycles:
        raise InputError(
            f"{place}: {len(master)} rows over {cycles:.4g} cycles of {1e3 * length:.4g} mm; record 50 rows a cycle at least, or look at "
            "the unit of the master"
        )
    return master


def _speeds(times: FloatArray, task: Task, stated: float | None) -> tuple[float, float]:
    """Line speeds between which that of a recording is looked for."""
    if stated is not None:
        return (1.0 - _STATED) * stated, (1.0 + _STATED) * stated
    lasts = float(times[-1])
    return min(0.8 * task.cut.length / lasts, task.cut.line_speed), _FASTEST * task.cut.line_speed


def _straight(profile: CamProfile) -> bool:
    """Whether a cam is so nearly a straight line that it does not tell where the master is zero."""
    return _departure(profile)[1] <= _FLAT * _travel(profile)


def _departure(profile: CamProfile) -> tuple[FloatArray, float]:
    """Give what a cam is beyond its straight line, at equal steps over the cycle, and its rms."""
    length = profile.end - profile.start
    place = profile.start + length * np.arange(256) / 256
    values = profile(place) - profile.advance / length * place
    values = values - values.mean()
    return values, float(np.sqrt(np.mean(values**2)))


def _travel(profile: CamProfile) -> float:
    low, high = profile.extrema()
    return max(abs(profile.advance), high.value - low.value)


def _starts_of_master(master: FloatArray, slave: FloatArray, gear: Gear, profile: CamProfile) -> Iterator[_Lie]:
    """Find the zero of a recorded master, by trying all over a cycle."""
    length = profile.end - profile.start
    some = np.flatnonzero(master - master[0] <= _SEARCH_CYCLES * length)
    some = some[:: max(1, len(some) // _SEARCH_ROWS)]
    shifts = np.zeros(1) if _straight(profile) else length * np.arange(_PLACES) / _PLACES
    apart = slave[some] - profile(master[some] + shifts[:, None], outside="repeat")
    worst = apart.std(axis=1)
    best = int(worst.argmin())
    yield _Lie(gear, float(shifts[best]), 0.0, float(apart[best].mean()), 0.0, float(worst[best]))


def _starts_of_speed(
    times: FloatArray, slave: FloatArray, gear: Gear, profile: CamProfile, between: tuple[float, float]
) -> Iterator[_Lie]:
    """Find line speed and zero of a master that was not recorded: the period at which the command is the cam."""
    length = profile.end - profile.start
    slope, (periodic, size) = profile.advance / length, _departure(profile)
    lasts = min(float(times[-1]), _SEARCH_CYCLES * length / between[1] * _FASTEST)
    some = np.flatnonzero(times <= lasts)
    some = some[:: max(1, len(some) // _SEARCH_ROWS)]
    at, y = times[some], slave[some]
    if _straight(profile):
        speed = float(np.polyfit(at, y, 1)[0]) / slope
        yield _Lie(gear, 0.0, speed, float(np.mean(y - slope * speed * at)), 0.0, math.inf)
        return
    harmonics = np.fft.rfft(periodic)[1 : _HARMONICS + 1] / len(periodic)
    numbers = np.arange(1, _HARMONICS + 1)
    count = max(3, math.ceil((between[1] - between[0]) * 16.0 * float(at[-1]) / length))
    found = []
    for speed in np.linspace(*between, count).tolist():
        beyond = y - slope * speed * at
        beyond = beyond - beyond.mean()
        turns = np.exp(-2j * math.pi * speed / length * numbers[:, None] * at)
        seen = turns @ beyond / len(at)
        # likeness over all shifts: the cam lies at master = speed * time + shift
        spectrum = np.zeros(_PLACES // 2 + 1, dtype=np.complex128)
        spectrum[1 : _HARMONICS + 1] = np.conj(harmonics) * seen
        likeness = np.fft.irfft(spectrum, _PLACES) * _PLACES
        best = int(likeness.argmax())
        left = float(np.mean(beyond**2)) - 2.0 * float(likeness[best]) + size**2
        found.append((left, speed, length * best / _PLACES))
    found.sort()
    for left, speed, shift in found[:3]:
        zero = float(np.mean(y - profile(speed * at + shift, outside="repeat")))
        yield _Lie(gear, shift, speed, zero, 0.0, left)


def _refined(times: FloatArray, slave: FloatArray, master: FloatArray | None, start: _Lie, profile: CamProfile) -> _Lie:
    """Move a command onto the cam by least squares, over more and more of the recording."""
    length, straight = profile.end - profile.start, _straight(profile)
    shift, speed, drift = start.shift, start.speed, 0.0
    place = master if master is not None else speed * times
    span = float(place[-1] - place[0]) / length
    left, zero = start.left, start.zero
    cycles: list[float] = [_SEARCH_CYCLES]
    while cycles[-1] < span:
        cycles.append(2.0 * cycles[-1])
    for window in cycles:
        for _ in range(_ROUNDS):
            place = (master if master is not None else speed * times) + shift
            some = np.flatnonzero(place - place[0] <= window * length)
            some = some[:: max(1, len(some) // (4 * _SEARCH_ROWS))]
            at = place[some]
            apart = slave[some] - profile(at, outside="repeat")
            ratio = profile(at, 1, outside="repeat")
            middle = float(np.mean(at))
            columns = [np.ones_like(at), (at - middle) / length]
            if straight:  # the master's zero, or its speed, is the slave's
                columns = columns[:1]
            else:
                columns.append(ratio)
                if master is None:
                    columns.append(ratio * times[some])
            steps = np.linalg.lstsq(np.stack(columns, axis=1), apart, rcond=None)[0]
            rest = apart - np.stack(columns, axis=1) @ steps
            left = float(np.sqrt(np.mean(rest**2)))
            zero = float(steps[0])
            if straight:
                break
            # zero of the slave at the middle of the recording, so that a drift does not move it
            drift = float(steps[1])
            shift += float(steps[2])
            speed += float(steps[3]) if master is None else 0.0
            if abs(steps[2]) < 1e-9 * length and (master is not None or abs(steps[3]) * times[-1] < 1e-9 * length):
                break
    return _Lie(start.gear, shift, speed, zero, drift, left)


def _require_the_cam(lie: _Lie, profile: CamProfile, place: str, no_master: bool) -> None:
    """Refuse a command that does not lie on the cam."""
    travel, departs = _travel(profile), _departure(profile)[1]
    if lie.left <= max(_LEFT * departs, _LEFT_OF_TRAVEL * travel) and abs(lie.drift) <= _SLIPPED * travel:
        return
    why = (
        f"it drifts by {part_of(abs(lie.drift) / travel)} its travel each cut"
        if abs(lie.drift) > _SLIPPED * travel
        else f"{part_of(lie.left / max(departs, _LEFT_OF_TRAVEL * travel))} what the cam is beyond a straight line is left over"
    )
    ways = ["name the design that ran (--design) and its job"]
    if no_master:
        ways.append("record the master beside it where the line speed changes, or give --line-speed")
    ways.append("give --gear if the axis was counted at another shaft than the slave or the motor")
    raise InputError(f"{place}: the command is not the cam of this design: {why}; {'; '.join(ways)}")
