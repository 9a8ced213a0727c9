"""`ChangeRun`: the servo run through the change from one cam into another at a steady line, at every sampling phase."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from camwright.profiles.errors import InputError
from camwright.profiles.servo import Servo
from camwright.profiles.task import Task
from camwright.validation.check import Check
from camwright.validation.production.motion_table import ShiftCam, motion_table
from camwright.validation.production.shift import Shift
from camwright.validation.servo.axis_motion import AxisPeaks, axis_checks, greatest_peaks
from camwright.validation.servo.lifting import SUBSTEPS, follow, lift
from camwright.validation.servo.simulation import memory

PHASES, CORNER_PHASES = 64, 16
"""Sampling phases at which a change is run with the servo that is judged, and with those at the corners of its ranges."""

AFTER = 3
"""Cycles that are looked at from the change on, the first of them the transition's."""

_MOST_VALUES = 2**20
"""Values of the command that are held at a time."""

_MOST_SAMPLES = 2**17
"""Most samples of a run."""


@dataclass(frozen=True)
class ChangeRun:
    """What one servo makes of a change; of several line speeds and all phases the worst.

    Parameters
    ----------
    sync_error
        Greatest magnitude of the sync error in the shear zones (m), from the last cycle before the change on.
    peaks
        Extremes of the axis' motion from the change on.
    """

    sync_error: float
    peaks: AxisPeaks


@dataclass(frozen=True, eq=False)
class CamChange:
    """A change from one cam into another.

    Parameters
    ----------
    before, after
        The cams as they run, their master zero at the end of the sync zone.
    tasks
        Their tasks, the sync zone placed.
    between
        The cycle in between and the slave coordinate of the machine at its slave zero; ``None`` where the one runs straight into the other.
    """

    before: ShiftCam
    after: ShiftCam
    tasks: tuple[Task, Task]
    between: ShiftCam | None

    def shift(self, first: int) -> Shift:
        """Put so many cycles of the one before the change and `AFTER` from it on."""
        cams = [self.before, self.after if self.between is None else self.between, self.after]
        order = np.array([0] * first + [1] + [2] * (AFTER - 1), dtype=np.intp)
        table = motion_table(cams, order, self.tasks[1].machine.pitch)
        return Shift(table, self.tasks, np.minimum(order, 1))


def run_change(change: CamChange, servo: Servo, line_speeds: Sequence[float], phases: int = PHASES) -> ChangeRun:
    """Run a servo through a change at steady line speeds (m/s).

    Parameters
    ----------
    line_speeds
        Line speeds, each by itself.
    phases
        Sampling phases.

    Raises
    ------
    InputError
        The servo is unstable, or a cycle has too many samples.
    """
    runs = [_run(change, servo, speed, phases) for speed in line_speeds]
    return ChangeRun(max(run.sync_error for run in runs), greatest_peaks([run.peaks for run in runs]))


def _run(change: CamChange, servo: Servo, line_speed: float, phases: int) -> ChangeRun:
    past, step = memory(servo.loop), servo.sample_time * line_speed
    length = change.before.profile.end
    felt = (past + 2) * step + abs(servo.delay) * line_speed
    first = 1 + math.ceil(felt / length)
    shift = change.shift(first)
    joints = shift.table.joints
    begin, end = float(joints[first - 1]), float(joints[-1])
    count = math.ceil((end - begin) / step) + 1
    if past + count > _MOST_SAMPLES:
        raise InputError(
            f"a change between cams at {line_speed:.4g} m/s has {past + count} samples of {servo.sample_time:g} s, the limit is "
            f"{_MOST_SAMPLES}; raise the sample time or the line speeds"
        )
    lifted = lift(servo.loop, past, (2, 1, 0))
    error, peaks = 0.0, []
    each = max(1, _MOST_VALUES // (past + count * SUBSTEPS))
    for start in range(0, phases, each):
        at = begin + step * np.arange(start, min(start + each, phases)) / phases
        seen = at + step * np.arange(-past, count)[:, None] - servo.delay * line_speed
        command = shift.table(seen)
        base = command[past].copy()
        slope, velocity, axis = follow(lifted, (command - base)[None], base[None], 0.0, 1.0)
        place = at[:, None] + step / SUBSTEPS * np.arange(count * SUBSTEPS)
        piece = np.clip(np.searchsorted(joints, place, side="right") - 1, first - 1, len(joints) - 2)
        zones = shift.places()
        cutting = (place >= zones[piece, 0]) & (place <= zones[piece, 2])
        error = max(error, float(np.abs(shift.off(place[cutting], piece[cutting], axis[cutting])).max(initial=0.0)))
        changed = (place >= joints[first]) & (place <= end)
        peaks.append(
            AxisPeaks(
                float(velocity[changed].max()), float(velocity[changed].min()), float(np.abs(slope[changed]).max())
            )
        )
    return ChangeRun(error, greatest_peaks(peaks))


def change_checks(change: CamChange, servos: Sequence[Servo], line_speeds: Sequence[float]) -> list[Check]:
    """Check a change: the sync error of every servo, and the axis' own motion with the first.

    Parameters
    ----------
    servos
        The servo that is judged, then those at the corners of its ranges.
    line_speeds
        Line speeds at which it is made (m/s).
    """
    task = change.tasks[1]
    own = run_change(change, servos[0], line_speeds)
    worst = max(
        [own.sync_error, *(run_change(change, servo, line_speeds, CORNER_PHASES).sync_error for servo in servos[1:])]
    )
    tolerance, limits = task.cut.sync_tolerance, task.limits
    how = f"servo run through the change at {len(line_speeds)} line speeds, {PHASES} sampling phases"
    return [
        Check("sync", worst <= tolerance, worst, tolerance, "m", None, how),
        *axis_checks(own.peaks, limits.speed, limits.acceleration, task.least_velocity, task.machine.slave_unit),
    ]
