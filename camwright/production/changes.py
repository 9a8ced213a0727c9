"""From which cam to which: directly, slower first, through a transition, or not at all."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from camwright.design.production.transition import design_transition, transition_speed
from camwright.production.cams import ListCam
from camwright.profiles.line_run import LineRun
from camwright.profiles.objective import MotionObjective
from camwright.profiles.polynomial.profile import CamProfile
from camwright.validation.check import Check
from camwright.validation.production.motion_table import ShiftCam, motion_table
from camwright.validation.production.seams import SeamJump, seam_jump
from camwright.validation.production.shift import Shift, run_shift
from camwright.validation.production.transition import judge_transition

How = Literal["direct", "slow_down", "transition", "stop"]

_AROUND = 3
"""Cycles of either cam that are run about a transition."""

_SETTLED = 1.01
"""By this factor a sync error may be above that of the cam which runs then."""

_STRIDE, _STRIDES = 0.8, 12
"""Where the axis is off after a transition, a slower line is tried in such steps: the servo is quicker against it."""

_POSITION = 1e-9
_SHARE = 1e-6
"""Steps of position (m), and of velocity and acceleration as shares of line speed and limit, that are none: solvers' accuracy."""


@dataclass(frozen=True, eq=False)
class Transition:
    """A cycle that leads from one cam into another.

    Parameters
    ----------
    profile
        The cycle, counted like that of the cam it leads into.
    line_speed
        Highest line speed at which it keeps the limits (m/s).
    checks
        The checks on it.
    """

    profile: CamProfile
    line_speed: float
    checks: tuple[Check, ...]

    @property
    def passed(self) -> bool:
        """Whether it keeps every limit."""
        return all(check.passed for check in self.checks)


@dataclass(frozen=True, eq=False)
class Change:
    """What it takes to run one cam after another.

    Parameters
    ----------
    before, after
        Numbers of the cams.
    how
        ``"direct"``; ``"slow_down"``, directly, but the line must slow down before; ``"transition"``, through a cycle of its own;
        ``"stop"``, not while the line runs.
    line_speed
        Highest line speed in the first cycle after the change (m/s), 0 for a stop.
    jump
        Steps if the one were run straight into the other.
    times
        How often the list makes this change.
    transition
        The transition, of changes that the list makes.
    """

    before: int
    after: int
    how: How
    line_speed: float
    jump: SeamJump
    times: int
    transition: Transition | None = None

    def first_pieces(self, of: NDArray[np.intp]) -> NDArray[np.intp]:
        """Pieces of a list, counted from 0, which it begins; ``of`` says which cam, counted from 0, makes each piece."""
        return 1 + np.flatnonzero((of[:-1] == self.before - 1) & (of[1:] == self.after - 1))


def find_changes(
    cams: Sequence[ListCam], made: Mapping[tuple[int, int], int], objective: MotionObjective
) -> dict[tuple[int, int], Change]:
    """Look at every ordered pair of cams; transitions are designed where the list needs them.

    Parameters
    ----------
    cams
        The cams, numbered from 1.
    made
        How often the list changes from which to which.
    objective
        What transitions minimise.

    Raises
    ------
    SolverError
        A transition could not be designed.
    """
    return {
        (before.number, after.number): _change(before, after, made.get((before.number, after.number), 0), objective)
        for before in cams
        for after in cams
        if before is not after
    }


def _change(before: ListCam, after: ListCam, times: int, objective: MotionObjective) -> Change:
    one, other = before.running, after.running
    speed = min(before.line_speed, after.line_speed)
    jump = seam_jump(one.profile, one.zero, other.profile, other.zero, after.job.task, speed)
    pair = before.number, after.number
    if _meets(jump, after, speed):
        slower = after.line_speed < before.line_speed
        return Change(*pair, "slow_down" if slower else "direct", after.line_speed, jump, times)
    possible = transition_speed(one, other)
    if possible is None:
        return Change(*pair, "stop", 0.0, jump, times)
    if not times:
        return Change(*pair, "transition", possible, jump, times)
    for stride in range(_STRIDES):
        found = _transition(before, after, possible * _STRIDE**stride, objective)
        if found.passed:
            return Change(*pair, "transition", found.line_speed, jump, times, found)
    return Change(*pair, "stop", 0.0, jump, times)


def _transition(before: ListCam, after: ListCam, line_speed: float, objective: MotionObjective) -> Transition:
    """Design a transition at a line speed, and judge it."""
    zero = after.running.zero
    profile = design_transition(before.running, after.running, line_speed, objective)
    checks = judge_transition(profile, zero, after.job.task.at_speed(line_speed))
    return Transition(profile, line_speed, (*checks, _sync_check(before, profile, after, line_speed)))


def _sync_check(before: ListCam, profile: CamProfile, after: ListCam, line_speed: float) -> Check:
    """Run the servo through a change at a steady line: the greatest sync error from the transition on.

    It must keep the tolerance, or where the cam itself does not at this line speed be no worse than that.
    """
    one, other = before.running, after.running
    parts = [ShiftCam(one.profile, one.zero), ShiftCam(profile, other.zero), ShiftCam(other.profile, other.zero)]
    order = np.array([0] * _AROUND + [1] + [2] * _AROUND)
    tasks = (before.job.task, after.job.task)
    shift = Shift(motion_table(parts, order, after.job.machine.pitch), tasks, np.minimum(order, 1))
    time = float(shift.table.joints[-1]) / line_speed
    run = run_shift(shift, LineRun(np.array([0.0, time]), np.full(2, line_speed)), after.job.servo)
    worst, settled = float(run.sync_errors[_AROUND:].max()), float(run.sync_errors[-1])
    allowed = max(after.job.cut.sync_tolerance, _SETTLED * settled)
    return Check("sync", worst <= allowed, worst, allowed, "m", None, "simulation of the servo through the change")


def _meets(jump: SeamJump, cam: ListCam, line_speed: float) -> bool:
    """Whether the steps at a seam are none."""
    task = cam.job.task
    lever = abs(float(task.machine.tool_ratio(task.slave_at_sync_end)))
    return (
        jump.position <= _POSITION
        and jump.velocity <= _SHARE * line_speed
        and jump.acceleration <= _SHARE * task.limits.acceleration * lever
    )
