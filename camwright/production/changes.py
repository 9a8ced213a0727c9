"""From which cam to which: directly, slower first, through a transition, through a cycle that ends in sync, or not at all."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from camwright.design.production.transition import RunningCam, design_transition, in_sync, transition_speed
from camwright.production.cams import ListCam
from camwright.profiles.line_run import LineRun
from camwright.profiles.objective import MotionObjective
from camwright.profiles.polynomial.profile import CamProfile
from camwright.validation.check import Check
from camwright.validation.production.motion_table import ShiftCam, motion_table
from camwright.validation.production.seams import SeamJump, seam_jump
from camwright.validation.production.shift import Shift, run_shift
from camwright.validation.production.transition import judge_transition

How = Literal["direct", "slow_down", "transition", "sync_cycle", "stop"]

_AROUND = 3
"""Cycles of either cam that are run about a transition."""

_SETTLED = 1.01
"""By this factor a sync error may be above that of the cam which runs then."""

_CYCLES = 2
"""Pieces that a change through a cycle in sync takes."""

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
        ``"sync_cycle"``, through a cycle that ends in sync as any cam in sync does, and one that leads from there into the new cam;
        ``"stop"``, not while the line runs.
    line_speed
        Highest line speed in the first cycles after the change (m/s), 0 for a stop.
    jump
        Steps if the one were run straight into the other.
    times
        How often the list makes this change.
    transitions
        The cycles in between, of changes that the list makes: none, one, or those into sync and out of it.
    """

    before: int
    after: int
    how: How
    line_speed: float
    jump: SeamJump
    times: int
    transitions: tuple[Transition, ...] = ()

    def first_pieces(self, of: NDArray[np.intp]) -> NDArray[np.intp]:
        """Pieces of a list, counted from 0, which it begins; ``of`` says which cam, counted from 0, makes each piece."""
        return 1 + np.flatnonzero((of[:-1] == self.before - 1) & (of[1:] == self.after - 1))


def find_changes(
    cams: Sequence[ListCam], of: NDArray[np.intp], objective: MotionObjective
) -> dict[tuple[int, int], Change]:
    """Look at every ordered pair of cams; transitions are designed where the list needs them.

    Parameters
    ----------
    cams
        The cams, numbered from 1.
    of
        Which of them, counted from 0, makes each piece of the list.
    objective
        What transitions minimise.

    Raises
    ------
    SolverError
        A transition could not be designed.
    """
    made, runs = _made(of)
    return {
        (before.number, after.number): _change(
            before,
            after,
            made.get((before.number, after.number), 0),
            runs.get((before.number, after.number), _CYCLES),
            objective,
        )
        for before in cams
        for after in cams
        if before is not after
    }


def _made(of: NDArray[np.intp]) -> tuple[Counter[tuple[int, int]], dict[tuple[int, int], int]]:
    """Count how often a list changes from which cam to which, and the fewest pieces that then follow of the second."""
    firsts = np.concatenate([[0], np.flatnonzero(np.diff(of)) + 1])
    follow = np.diff(np.append(firsts, len(of)))
    pairs = list(pairwise((of[firsts] + 1).tolist()))
    fewest: dict[tuple[int, int], int] = {}
    for pair, count in zip(pairs, follow[1:].tolist(), strict=True):
        fewest[pair] = min(count, fewest.get(pair, count))
    return Counter(pairs), fewest


def _change(before: ListCam, after: ListCam, times: int, follow: int, objective: MotionObjective) -> Change:
    """Find what a change takes that a list makes so often, and after which so many pieces of the second cam follow at least."""
    one, other = before.running, after.running
    speed = min(before.line_speed, after.line_speed)
    jump = seam_jump(one.profile, one.zero, other.profile, other.zero, after.job.task, speed)
    pair = before.number, after.number
    if meets(jump, after, speed):
        slower = after.line_speed < before.line_speed
        return Change(*pair, "slow_down" if slower else "direct", after.line_speed, jump, times)
    ways: tuple[tuple[How, tuple[RunningCam, ...]], ...] = (("transition", (other,)),)
    if after.job.cut.shaped and follow >= _CYCLES:  # of one in sync that is the same
        ways = (*ways, ("sync_cycle", (in_sync(other), other)))
    for how, through in ways:
        legs = tuple(pairwise((one, *through)))
        speeds = [transition_speed(*leg) for leg in legs]
        possible = min((speed for speed in speeds if speed is not None), default=0.0)
        if None in speeds:
            continue
        if not times:
            return Change(*pair, how, possible, jump, times)
        for stride in range(_STRIDES):
            found = _transitions(before, legs, after, possible * _STRIDE**stride, objective)
            if all(each.passed for each in found):
                return Change(*pair, how, found[0].line_speed, jump, times, found)
    return Change(*pair, "stop", 0.0, jump, times)


def _transitions(
    before: ListCam,
    legs: Sequence[tuple[RunningCam, RunningCam]],
    after: ListCam,
    line_speed: float,
    objective: MotionObjective,
) -> tuple[Transition, ...]:
    """Design the transitions of a change at a line speed, and judge them."""
    profiles = [design_transition(*leg, line_speed, objective) for leg in legs]
    sync = _sync_check(before, profiles, after, line_speed)
    task = after.job.task.at_speed(line_speed)
    return tuple(
        Transition(profile, line_speed, (*judge_transition(profile, after.running.zero, task), sync))
        for profile in profiles
    )


def _sync_check(before: ListCam, profiles: Sequence[CamProfile], after: ListCam, line_speed: float) -> Check:
    """Run the servo through a change at a steady line: the greatest sync error from the first transition on.

    It must keep the tolerance, or where the cam itself does not at this line speed be no worse than that.
    """
    one, other = before.running, after.running
    between = [ShiftCam(profile, other.zero) for profile in profiles]
    parts = [ShiftCam(one.profile, one.zero), *between, ShiftCam(other.profile, other.zero)]
    last = len(parts) - 1
    order = np.array([0] * _AROUND + list(range(1, last)) + [last] * _AROUND)
    tasks = (before.job.task, after.job.task)
    shift = Shift(motion_table(parts, order, after.job.machine.pitch), tasks, np.minimum(order, 1))
    time = float(shift.table.joints[-1]) / line_speed
    run = run_shift(shift, LineRun(np.array([0.0, time]), np.full(2, line_speed)), after.job.servo)
    worst, settled = float(run.sync_errors[_AROUND:].max()), float(run.sync_errors[-1])
    allowed = max(after.job.cut.sync_tolerance, _SETTLED * settled)
    return Check("sync", worst <= allowed, worst, allowed, "m", None, "simulation of the servo through the change")


def meets(jump: SeamJump, cam: ListCam, line_speed: float) -> bool:
    """Whether the steps at a seam are none."""
    task = cam.job.task
    lever = abs(float(task.machine.tool_ratio(task.slave_at_sync_end)))
    return (
        jump.position <= _POSITION
        and jump.velocity <= _SHARE * line_speed
        and jump.acceleration <= _SHARE * task.limits.acceleration * lever
    )
