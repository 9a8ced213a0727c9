"""`SpeedScan`: the checks of a cam that must be made at every line speed, as values over their limits."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.servo import Servo
from camwright.profiles.task import Task
from camwright.validation.check import Check
from camwright.validation.motor import greatest_load
from camwright.validation.report import ALLOWANCE
from camwright.validation.servo.axis_motion import ALLOWANCE as AXIS_ALLOWANCE
from camwright.validation.servo.axis_motion import axis_checks, axis_peaks
from camwright.validation.servo.creeping import creeping_axis, creeping_speeds, tracking
from camwright.validation.servo.line_speeds import line_speed_errors
from camwright.validation.servo.monte_carlo import FEW_PHASES

TOLERANCE = "servo_tolerance"
"""What binds where a servo at the corners of the job's ranges leaves the tolerance before the job's own does."""

NAMES = (
    "motor_torque",
    "shear_zone_error",
    "settling",
    "axis_speed",
    "axis_acceleration",
    "axis_reversal",
    TOLERANCE,
)
"""Checks, in the order of the columns of `SpeedScan.excess`."""

_EASY = 0.25
"""Share of its limits at which the axis is at ease."""

_SURE = 0.75, 1.5
"""Sync errors over the tolerance between which all sampling phases are looked at."""

_ROUNDING = 1e-6
"""What a tolerance that a design used up may be exceeded by at the corners of the servo's ranges: the accuracy of its programme."""


@dataclass(frozen=True, eq=False)
class SpeedScan:
    """The checks of a cam that must be made at every line speed, each as a value over its limit: a check passes up to 1.

    Parameters
    ----------
    profile
        One cycle over the master period ``[0, x_c]``.
    task
        Machine, cut and limits; the line speed is not used.
    servos
        Stable servos: the one that is judged, then those that must keep the tolerance as well.
    servo_aware
        As in `camwright.validation.report.judge`.
    """

    profile: CamProfile
    task: Task
    servos: tuple[Servo, ...]
    servo_aware: bool

    @cached_property
    def creeping(self) -> tuple[float, float]:
        """Line speeds below which all servos are surely within the tolerance, and one surely is not (m/s)."""
        within, outside = zip(*(creeping_speeds(self.profile, self.task, servo) for servo in self.servos), strict=True)
        return min(within), max(outside)

    @cached_property
    def _axis_at_ease(self) -> float:
        """Line speed below which the axis itself surely keeps its limits (m/s)."""
        return creeping_axis(self.profile, self.task, self.servos[0], AXIS_ALLOWANCE * self.task.limits.speed)

    @property
    def sure(self) -> float:
        """Line speed below which nothing changes any more (m/s): all is as it must be, or the tolerance surely is not kept."""
        within, outside = self.creeping
        return max(outside, min(within, self._axis_at_ease) if self.servo_aware else within)

    def excess(self, speeds: FloatArray, phases: int) -> FloatArray:
        """Give values over limits, shape ``(speeds, NAMES)``; 0 where there is no such check."""
        cut = self.task.cut
        found = np.zeros((len(speeds), len(NAMES)))
        found[:, 0] = (
            [self._load(speed) for speed in speeds.tolist()]
            if self.task.limits.motor is not None and self.task.machine.moves_something
            else 0.0
        )
        zones = {1: cut.shear_zone_at}
        last = cut.sync_zone - cut.shear_zone
        if not self.servo_aware and last - cut.shear_zone_at > 1e-9 * cut.length:
            zones[2] = last  # who is within the tolerance there has settled in time
        asked = np.nonzero(speeds > self.creeping[0])[0]
        if len(asked):
            off = self._errors(speeds[asked], list(zones.values()), phases)
            found[asked[:, None], list(zones)] = off[0].T
            found[asked, -1] = off[1:].max(axis=(0, 1), initial=0.0) / (1 + _ROUNDING)
        if self.servo_aware:
            self._load_axis(speeds, found)
        return found

    def _load(self, speed: float) -> float:
        """Torque of the motor over what it gives, where that is worst; both in N·m."""
        task = self.task.at_speed(speed)
        curve = task.limits.motor
        if curve is None:
            return 0.0
        torque, available = greatest_load(self.profile, task, curve)
        return torque.value / (available + ALLOWANCE * curve.points[0][1])

    def _errors(self, speeds: FloatArray, places: list[float], phases: int) -> FloatArray:
        """Sync error over the tolerance in zones as long as the shear zone, shape ``(servos, places, speeds)``.

        Of a command in sync only the part is simulated that may still feel the return: beyond that the axis is late by its lag, as it is
        where that part ends. By few sampling phases where they tell that the error is far from the tolerance.
        """
        cut = self.task.cut
        at = np.repeat(places, len(speeds))
        every = np.tile(speeds, len(places))
        felt = math.inf if cut.shaped or not self.task.straight else self._forgotten * every - at
        length = np.clip(felt, 0.0, np.full(len(at), cut.shear_zone))

        def off(asked: NDArray[np.bool_], phases: int) -> FloatArray:
            errors = line_speed_errors(self.profile, self.task, self.servos, every, phases, (at, length), asked)
            return errors / cut.sync_tolerance

        few = off(np.full((len(self.servos), len(at)), True), FEW_PHASES)
        near = np.asarray(((few > _SURE[0]) & (few < _SURE[1])).any(axis=0))
        found, asked, rest = few.copy(), np.zeros(few.shape, dtype=bool), np.tile(near, (len(few), 1))
        asked[0] = near
        if (
            len(few) > 1
        ):  # of the corners the worst alone is told: first that at few phases, then those that may be worse at all
            asked[1 + few[1:].argmax(axis=0), np.arange(len(at))] = near
        while asked.any():
            found[asked] = off(asked, phases)[asked]
            rest &= ~asked
            asked = rest & (few + 2.0 * (found - few).max() > found[1:].max(axis=0, initial=0.0))
        return found.reshape(len(found), len(places), -1)

    @cached_property
    def _forgotten(self) -> float:
        """Time after which none of the servos feels the return any more (s)."""
        return max(tracking(servo).forgotten for servo in self.servos)

    def _load_axis(self, speeds: FloatArray, found: FloatArray) -> None:
        """Fill in what the axis itself does, from the highest line speed down to where it is at ease.

        Its speed falls with the line speed, its acceleration and what it runs backwards after a stop with the square: where all are a small
        part of their limits, no slower line is looked at.
        """
        for row in np.argsort(-speeds).tolist():
            speed = float(speeds[row])
            if speed <= self._axis_at_ease:
                return
            if (found[row, :3] > 1.0).any():
                continue  # it fails as it is
            found[row, 3:6] = self._axis_loads(speed)
            if found[row, 3:6].max() <= _EASY:
                return

    def _axis_loads(self, speed: float) -> list[float]:
        """Speed, acceleration and backward speed of the axis over their limits."""
        task = self.task.at_speed(speed)
        limits = task.limits
        peaks = axis_peaks(self.profile, task.cut, self.servos[0])
        checks = axis_checks(peaks, limits.speed, limits.acceleration, task.least_velocity, task.machine.slave_unit)
        return [_share(check, AXIS_ALLOWANCE * limits.speed) for check in checks]


def _share(check: Check, least: float) -> float:
    """Value over limit, and on the right side of 1 as the check was judged."""
    share = (check.value or 0.0) / max(check.limit or 0.0, least)
    return min(share, 1.0) if check.passed else max(share, 1.0 + ALLOWANCE)
