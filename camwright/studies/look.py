"""`Look`: a redesign that is not servo-aware, judged as far as it takes: what it fails, and by how much its axis misses the tolerance."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from camwright.design.line.ramped import ramp_share
from camwright.design.optimise import solve
from camwright.design.returns.problem import return_problem
from camwright.jobs.job import Job
from camwright.profiles.errors import InfeasibleError, InputError, SolverError
from camwright.profiles.line import STEADY
from camwright.profiles.objective import MotionObjective
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.polynomial.rows import ascending
from camwright.profiles.servo import Servo
from camwright.profiles.task import Task
from camwright.studies.least_length import BEYOND, STEEP
from camwright.validation.report import judge
from camwright.validation.servo.line_speeds import line_speed_errors

RAMP = "line_ramp"
"""What binds where no cam bears the ramps of the line: the check that would fail."""

_UNSEEN = 1e-6
"""Shares of the tolerance below this one are not told apart."""

_OUTSIDE = 1e-6
"""By how much the tolerance is surely missed, as a logarithm: simulations of the whole cycle and of a part of it round differently."""

_ROOM = 0.1
"""Where so great a share of the tolerance is left the ramps of the line may be what is nearer to its limit."""

_MUCH, _ASKED = 0.35, 3
"""A cam that misses by more than this, as a logarithm, tells at which line speed it would not, and how many cams of a search do."""

_SLOWER = np.array([[1.0, 0.96, 0.91, 0.85, 0.77], [0.77, 0.67, 0.55, 0.42, 0.3], [0.3, 0.22, 0.16, 0.12, 0.09]])
"""Shares of its line speed at which it is looked at for that, the next ones where it misses at all before."""

_BETWEEN = np.array([0.2, 0.4, 0.6, 0.8])
"""Where it is looked at between two of them."""

_BESIDE, _ABOVE = 1.03, 12
"""Factor of the edge that was found from which on its cam tells of line speeds above a hole, and at how many it is asked."""

_AT_END = 0.9
"""From this share on a search begins at the perfect axis' edge: where that one passes nothing else is to be looked at."""

Failure = str | Callable[[], str]
"""The first check that fails, or what makes a design impossible, empty where it passes; or what tells it, where all checks are yet to be
made: of the many designs of a search only the last is asked."""

Verdict = tuple[Failure, float]
"""What fails; and by how much the sync error misses its tolerance, as the logarithm of a share: infinite where that is not what decides."""


def failure_name(failure: Failure) -> str:
    """Tell what fails."""
    return failure if isinstance(failure, str) else failure()


@dataclass(frozen=True)
class Look:
    """A task that was designed.

    Parameters
    ----------
    task
        What it was designed for, its sync zone placed where there is a cam.
    failed
        What fails.
    missed
        By how much the sync error misses its tolerance, as the logarithm of a share; infinite where there is no cam.
    missed_at
        Tells the same of the very cam at other line speeds (m/s).
    """

    task: Task
    failed: Failure
    missed: float
    missed_at: Callable[[FloatArray], FloatArray] | None = None

    @property
    def out(self) -> bool:
        """Whether it surely fails, by no cam or by the sync error, whatever other checks do."""
        return self.missed > _OUTSIDE

    @property
    def verdict(self) -> Verdict:
        """What it comes to, by all checks where the sync error does not decide."""
        if self.out:
            return self.failed, self.missed
        failed = failure_name(self.failed)
        if (self.missed > 0.0) != bool(failed):
            return failed, math.copysign(math.inf, 1.0 if failed else -1.0)
        return failed, self.missed if self.missed > -_ROOM else max(self.missed, ramp_missed(self.task))

    def slower(self) -> tuple[float, float]:
        """Tell at which share of its line speed the very cam would keep the tolerance, the greatest that is seen, 0 where none is.

        And how much less it misses there at a line speed that is slower by a share.
        """
        if self.missed_at is None:
            return 0.0, 0.0
        own = self.task.cut.line_speed
        for shares in _SLOWER:
            missed = self.missed_at(own * shares)
            if missed[0] <= 0.0:
                return 1.0, 0.0
            if keeps := int((missed <= 0.0).argmax()):
                part = shares[keeps] + (shares[keeps - 1] - shares[keeps]) * _BETWEEN
                closer = np.concatenate([shares[keeps : keeps + 1], part, shares[keeps - 1 : keeps]])
                off = np.concatenate([missed[keeps : keeps + 1], self.missed_at(own * part), missed[keeps - 1 : keeps]])
                last = int((off <= 0.0).nonzero()[0][-1])
                falls = float((off[last + 1] - off[last]) / (closer[last + 1] - closer[last]))
                share = float(closer[last]) - float(off[last]) / falls
                return share, falls * share
        return 0.0, 0.0


def look(job: Job, task: Task, objective: MotionObjective, *, thorough: bool = False) -> Look:
    """Design a task as a job would that is not servo-aware; on a line that ramps on a first mesh where it is not `thorough`."""
    try:
        solution = solve(task, objective, suggest=False, thorough=thorough)
    except InfeasibleError as error:
        if not error.binding.startswith("line."):
            return Look(task, error.binding, math.inf)
        missed = ramp_missed(task)
        return Look(task, RAMP, missed if missed > 0.0 else math.inf)
    except (InputError, SolverError):
        return Look(task, "design", math.inf)
    profile, placed = solution.profile, task.with_machine(solution.machine)

    def first_failed() -> str:
        return next((check.name for check in judge(profile, placed, job.servo).checks if not check.passed), "")

    missed_at = _missed_at(profile, placed, job.servo)
    return Look(placed, first_failed, float(missed_at(np.array([task.cut.line_speed]))[0]), missed_at)


def ramp_missed(task: Task) -> float:
    """By how much all cams miss the ramps of the line, as the logarithm of a share of the limits; nothing where a design has to tell."""
    if not task.line.ramps or not task.machine.placed or task.limits.motor is not None:
        return -math.inf
    share = ramp_share(task, return_problem(task, "rms_acceleration"))
    return -math.inf if share is None else math.log(max(share, _UNSEEN))


def _missed_at(profile: CamProfile, task: Task, servo: Servo) -> Callable[[FloatArray], FloatArray]:
    """Give what tells by how much the sync error that decides misses the tolerance at line speeds (m/s), as the logarithm of a share.

    That is the error in the shear zone, and at the end of the sync zone, where the axis must have settled, too.
    """
    cut = task.cut
    places = ascending(np.array([cut.shear_zone_at, max(cut.shear_zone_at, cut.sync_zone - cut.shear_zone)]))

    def missed(line_speeds: FloatArray) -> FloatArray:
        zones = np.tile(places, len(line_speeds)), np.full(len(places) * len(line_speeds), cut.shear_zone)
        off = line_speed_errors(profile, task, [servo], np.repeat(line_speeds, len(places)), zones=zones)
        greatest = off.reshape(len(line_speeds), len(places)).max(axis=1)
        return np.asarray(np.log(np.maximum(greatest / cut.sync_tolerance, _UNSEEN)))

    return missed


class Looks:
    """The designs of one search for an edge on a line that keeps its speed, each made once.

    Parameters
    ----------
    job
        The job, not servo-aware.
    at
        Gives the task at a share of the perfect axis' edge.
    objective
        What designs make least.
    cam
        A cam of the job, if there is one, where the search is for a line speed.
    """

    def __init__(
        self, job: Job, at: Callable[[float], Task], objective: MotionObjective, cam: CamProfile | None
    ) -> None:
        self._designed: Callable[[float], Look] = lambda share: look(job, at(share).with_line(STEADY), objective)
        self._slower: Callable[[], tuple[float, float]] = lambda: (
            (0.0, 0.0) if cam is None else Look(at(1.0), "", math.inf, _missed_at(cam, at(1.0), job.servo)).slower()
        )
        self._length = job.cut.length
        self._known: dict[float, Look] = {}
        self._asked = 0
        self.last_held: Look | None = None

    def _look(self, share: float) -> Look:
        if share not in self._known:
            self._known[share] = self._designed(share)
        return self._known[share]

    def begun(self) -> tuple[float | None, float]:
        """Tell at which share to begin, by the job's cam, which limits bind less; and how fast less is missed there, as `Look.slower`."""
        share, falls = self._slower()
        return (share, falls / BEYOND) if 0.0 < share < _AT_END else (None, STEEP)

    def in_sync(self, share: float) -> Verdict:
        """Judge the sync error alone, as if all other checks passed; a design that keeps it is remembered."""
        seen = self._look(share)
        if seen.out:
            return seen.failed, seen.missed
        self.last_held = seen
        return "", min(seen.missed, 0.0)

    def whole(self, share: float) -> Verdict:
        """Judge by all checks."""
        return self._look(share).verdict

    def expected(self, longer: float) -> tuple[float, float]:
        """Tell at which inverse share the cam of another that misses by much would keep the tolerance, as `Look.slower`; 0 where untold.

        Of line speeds alone: another cut length is another cam.
        """
        seen = self._look(1.0 / longer)
        told = seen.missed > _MUCH and self.last_held is None and self._asked < _ASKED
        if not told or seen.task.cut.length != self._length:
            return 0.0, 0.0
        self._asked += 1
        share, falls = seen.slower()
        return (longer / share if share else 0.0), falls

    def above_hole(self, found: float) -> float:
        """Give the greatest share above an edge at which its cam keeps the tolerance again, and a design there, too; 0 where none is."""
        if not self._asked or self.last_held is None or self.last_held.missed_at is None or found * _BESIDE >= 1.0:
            return 0.0
        shares = np.geomspace(found * _BESIDE, 1.0, _ABOVE)
        keeps = shares[self.last_held.missed_at(shares / found * self.last_held.task.cut.line_speed) <= 0.0]
        return float(keeps[-1]) if len(keeps) and not self.in_sync(float(keeps[-1]))[0] else 0.0
