"""How far the tool was off the material at each cut of a recorded run, and how long the pieces became."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.task import Task
from camwright.validation.recording.alignment import Alignment


@dataclass(frozen=True)
class CutError:
    """One cut of a recorded run; distances along the material, positive where the tool is ahead of it.

    Parameters
    ----------
    number
        Which cut of the recording, from 1.
    time
        When the tool was mid shear zone (s).
    line_speed
        Mean line speed over the shear zone, over the cut before it where that has no length (m/s).
    error
        Mean of the sync error over the shear zone (m).
    greatest
        The sync error of greatest magnitude there (m).
    command
        What the command has of the mean: it was not where the design has it (m).
    length
        Length of the piece that this cut ended (m); ``None`` at the first.
    """

    number: int
    time: float
    line_speed: float
    error: float
    greatest: float
    command: float
    length: float | None

    @property
    def axis(self) -> float:
        """What the axis adds to its command (m)."""
        return self.error - self.command


@dataclass(frozen=True, eq=False)
class SyncPart:
    """The sync error in a part of one sync zone.

    Parameters
    ----------
    along
        Master travel from the start of the sync zone (m), ascending.
    error
        Sync error of the axis (m).
    command
        What its command is ahead of the design, at the tool (m).
    """

    along: FloatArray
    error: FloatArray
    command: FloatArray


def sync_parts(run: Alignment, profile: CamProfile, task: Task, start: float, end: float) -> list[tuple[int, SyncPart]]:
    """Give the sync error in one and the same part of all sync zones that were recorded whole.

    Parameters
    ----------
    run
        The recording.
    profile
        The cam that it was laid over.
    task
        Machine and cut.
    start, end
        The part, from the start of the sync zone (m).

    Returns
    -------
    list
        Number of the zone (that of the cycle which it ends in) and its part, ends included.
    """
    cut, machine = task.cut, task.machine
    passed = task.sync.end if cut.origin == "return" else 0.5 * cut.sync_zone
    there = task.slave_at_sync_start
    zero = task.slave_zero(profile)
    first = math.ceil((float(run.master[0]) + passed - start) / cut.length)
    last = math.floor((float(run.master[-1]) + passed - end) / cut.length)
    found = []
    for number in range(first, last + 1):
        origin = number * cut.length - passed  # master at the start of this zone
        rows = _rows(run.master, origin + start, origin + end)
        master = run.master[rows]
        order = np.argsort(master, kind="stable")
        along = np.concatenate([[start], np.clip(master[order] - origin, start, end), [end]])
        ideal = there + task.sync(np.clip(along, task.sync.start, task.sync.end))
        tools = []
        for signal in (run.axis[rows], run.command[rows], profile(run.master[rows], outside="repeat")):
            values = _with_ends(master[order] - origin, signal[order], start, end)
            # what a slave is beyond whole cycles is its machine coordinate
            tools.append(np.asarray(machine.tool(values + zero - number * machine.pitch)))
        axis, command, design = tools
        found.append((number, SyncPart(along, np.asarray(axis - machine.tool(ideal)), command - design)))
    return found


def cut_errors(run: Alignment, profile: CamProfile, task: Task, place: str) -> tuple[CutError, ...]:
    """Find how far the tool was off the material at each cut.

    A tool that is ahead of the material by ``e`` cuts it ``e`` nearer to the end that has passed. So a piece between two cuts is
    ``x_c + e_before - e``: a constant error spoils no length, a drift spoils all alike, scatter each by another amount.

    Parameters
    ----------
    run, profile
        The recording, and the cam that it was laid over.
    task
        Machine and cut.
    place
        What messages begin with.

    Raises
    ------
    InputError
        No shear zone was recorded whole.
    """
    cut = task.cut
    start, end = cut.shear_zone_at, min(cut.shear_zone_at + cut.shear_zone, cut.sync_zone)
    passed = task.sync.end if cut.origin == "return" else 0.5 * cut.sync_zone
    found: list[CutError] = []
    numbers: list[int] = []
    for number, part in sync_parts(run, profile, task, start, end):
        error, command = (_mean(part.along, values) for values in (part.error, part.command))
        middle = number * cut.length - passed + 0.5 * (start + end)
        time, speed = _passing(run, middle, cut.length)
        before = found[-1] if found and numbers[-1] == number - 1 else None
        found.append(
            CutError(
                number=len(found) + 1,
                time=time,
                line_speed=speed,
                error=error,
                greatest=float(part.error[int(np.abs(part.error).argmax())]),
                command=command,
                length=None if before is None else cut.length + before.error - error,
            )
        )
        numbers.append(number)
    if not found:
        raise InputError(
            f"{place}: no shear zone was recorded whole; record some cycles, each {1e3 * cut.length:.5g} mm of master travel"
        )
    return tuple(found)


def _rows(master: FloatArray, start: float, end: float) -> slice:
    """Rows within a part of the master, and one more on either side; a master that shivers may give a few more."""
    inside = np.flatnonzero((master >= start) & (master <= end))
    if len(inside):
        return slice(max(int(inside[0]) - 1, 0), int(inside[-1]) + 2)
    after = int(np.argmax(master > start))
    return slice(max(after - 1, 0), after + 1)


def _with_ends(along: FloatArray, values: FloatArray, start: float, end: float) -> FloatArray:
    """Values at the rows of a part, those beyond it moved onto its ends along the straight line to their neighbours, ends added."""
    inside = np.interp(np.clip(along, start, end), along, values)
    first, last = np.interp([start, end], along, values)
    return np.concatenate([[first], inside, [last]])


def _mean(along: FloatArray, values: FloatArray) -> float:
    """Mean over a part of the master; over its one place if it has no length."""
    width = float(along[-1] - along[0])
    if not width > 0.0:
        return float(values[0])
    return float(np.sum(0.5 * np.diff(along) * (values[1:] + values[:-1])) / width)


def _passing(run: Alignment, master: float, length: float) -> tuple[float, float]:
    """Time at which a master position was passed, and the mean line speed over a quarter of a cut around it."""
    row = int(np.clip(np.searchsorted(run.master, master), 1, len(run.master) - 1))
    step = float(run.master[row] - run.master[row - 1])
    part = (master - float(run.master[row - 1])) / step if step > 0.0 else 0.0
    time = float(run.times[row - 1] + min(max(part, 0.0), 1.0) * (run.times[row] - run.times[row - 1]))
    near = np.flatnonzero(np.abs(run.master - master) <= 0.125 * length)
    if len(near) < 2:
        near = np.array([row - 1, row])
    speed = (run.master[near[-1]] - run.master[near[0]]) / (run.times[near[-1]] - run.times[near[0]])
    return time, float(speed)
