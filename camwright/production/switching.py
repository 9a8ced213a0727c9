"""`Switching`: from a cam of a family to its faster neighbour and back, the axis in tolerance through either change."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from camwright.design.production.axis_transition import design_axis_transition
from camwright.design.production.transition import RunningCam
from camwright.jobs.servos import servos_of
from camwright.production.changes import Change, Transition, meets
from camwright.production.family_cams import FamilyCam, FamilyCams
from camwright.profiles.line import STEADY
from camwright.validation.check import Check
from camwright.validation.production.cam_change import CamChange, change_checks
from camwright.validation.production.motion_table import ShiftCam
from camwright.validation.production.seams import seam_jump
from camwright.validation.production.transition import judge_transition

_SPEEDS = 3
"""Line speeds at which a change is run, those at which it is begun among them."""


@dataclass(frozen=True, eq=False)
class Switching:
    """What the controller does between two neighbours of a family.

    Parameters
    ----------
    line_speeds
        Least and greatest line speed that both cams hold, and each change of them (m/s).
    down, up
        Line speeds below and above which it changes (m/s); between them it leaves the cam that runs.
    changes
        Up, from the slower cam to the faster, and down.
    checks
        The checks of both, in the same order.
    """

    line_speeds: tuple[float, float]
    down: float
    up: float
    changes: tuple[Change, Change]
    checks: tuple[tuple[Check, ...], tuple[Check, ...]]

    @property
    def how(self) -> str:
        """The harder of both: ``"direct"``, ``"transition"`` or ``"stop"``."""
        kinds = [change.how for change in self.changes]
        return next(kind for kind in ("stop", "transition", "direct") if kind in kinds)

    @property
    def passed(self) -> bool:
        """Whether both changes can be made while the line runs, and pass every check."""
        return self.how != "stop" and all(check.passed for checks in self.checks for check in checks)


def switchings(family: FamilyCams) -> tuple[Switching, ...]:
    """Work the changes between neighbours of a family out, from the slowest pair up.

    Raises
    ------
    SolverError
        A transition could not be designed.
    """
    return tuple(
        _switching(family, slower, faster) for slower, faster in zip(family.cams, family.cams[1:], strict=False)
    )


def change_speeds(low: float, top: float) -> list[float]:
    """List the line speeds at which a change is run, of those that both cams hold (m/s)."""
    return [float(speed) for speed in np.linspace(low, top, _SPEEDS)]


def _switching(family: FamilyCams, slower: FamilyCam, faster: FamilyCam) -> Switching:
    low, top = faster.line_speeds[0], slower.line_speeds[1]
    up, up_checks = _change(family, slower, faster, (low, top))
    down, down_checks = _change(family, faster, slower, (low, top))
    return Switching((low, top), *family.overlap.switching(low, top), (up, down), (up_checks, down_checks))


def _change(
    family: FamilyCams, before: FamilyCam, after: FamilyCam, line_speeds: tuple[float, float]
) -> tuple[Change, tuple[Check, ...]]:
    """Run one cam into another where that will do, else through a transition; and what the checks say of it."""
    one, other, top = _running(before, family), _running(after, family), line_speeds[1]
    pair = before.number, after.number
    servos, speeds = servos_of(family.job), change_speeds(*line_speeds)
    tasks = before.job.task, after.job.task.at_speed(top)
    cams = ShiftCam(one.profile, one.zero), ShiftCam(other.profile, other.zero)
    jump = seam_jump(one.profile, one.zero, other.profile, other.zero, after.job.task, top)
    checks: tuple[Check, ...] = ()
    if meets(jump, after, top):
        checks = tuple(change_checks(CamChange(*cams, tasks, None), servos, speeds))
        if all(check.passed for check in checks):
            return Change(*pair, "direct", top, jump, 1), checks
    found = design_axis_transition(one, other, line_speeds, family.job.command, servos)
    if found is None:
        return Change(*pair, "stop", 0.0, jump, 1), checks
    between = CamChange(*cams, tasks, ShiftCam(found.profile, other.zero))
    checks = (
        *judge_transition(found.profile, other.zero, tasks[1]),
        *change_checks(between, servos, speeds),
    )
    return Change(*pair, "transition", top, jump, 1, (Transition(found.profile, top, checks),)), checks


def _running(cam: FamilyCam, family: FamilyCams) -> RunningCam:
    """Give the cam as it runs while it is changed: where the line keeps its speed then, without its ramps."""
    running = cam.running
    return replace(running, task=running.task.with_line(STEADY)) if family.holds_line else running
