"""`Reach`: how fast and how short with the axis in tolerance: what `design` would pass, redesigned at each line speed and cut length."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

from camwright.design.feasible.extremes import Extremes
from camwright.design.optimise import motion_objective
from camwright.design.returns.curve_limits import motor_limits
from camwright.design.servo_aware.axis_problem import AxisProblem, thinned
from camwright.design.servo_aware.programme import AxisProgramme
from camwright.design.servo_aware.refusal import AXIS_RATIO
from camwright.jobs.job import Job
from camwright.jobs.servos import between_of, servos_of
from camwright.profiles.errors import InputError, SolverError
from camwright.profiles.objective import MotionObjective, of_command, of_motion
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.servo import Servo
from camwright.profiles.task import Task
from camwright.studies.axis_study import shares_of
from camwright.studies.least_length import AWARE_STEEP, STEEP, SketchedFirst, least_length, nowhere
from camwright.studies.look import RAMP, Failure, Looks, Verdict, failure_name, look, ramp_missed
from camwright.validation.report import judge

ACCURACY, RAMPED_ACCURACY, SERVO_AWARE_ACCURACY = 1e-4, 1e-3, 5e-3
"""Accuracy of an edge, relative to it; of jobs whose line ramps, and of servo-aware ones: there a step is a design of up to a second."""

SLOWEST, LONGEST = 0.02, 4.0
"""Line speeds down to this share of the perfect axis' highest, and cut lengths up to this multiple of its shortest, are looked at."""

LEAST_ZONE = 1.01
"""Shortest cut that is looked at, as a multiple of the sync zone: a return must be left."""

_INSIDE = 1e-6
"""What the perfect axis' own edge is asked with, relative to it: solvers need room."""

TOLERANCE, BAND, AXIS = "sync_tolerance", "sync_over_line_speeds", "axis_acceleration"
"""What binds where no servo-aware command brings the axis into the tolerance, none at every line speed of the job, none with the axis'
own limits kept: where it is not the ratio, speed or reversal of the axis."""

_LOOKED = 6
"""Each so many-th of the line speeds of a design is looked at while an edge is searched; at the edge that is told, all."""

_BACK, _TRIES = 0.996, 16
"""Factor by which an edge is taken back where it holds at those line speeds, of servos at the corners of their ranges, but not at all of
them, and how often it is."""

_FOLLOWED_STEEP, _RAMPED_STEEP = 9.0, 15.0
"""What the error of a servo-aware command is taken to grow by with the line speed, as `STEEP`, where an edge is followed; and that of a
cam on a line that ramps."""

_MADE_FOR = 1.03
"""Factor of the line speed, and of what is cut off the length, to where the edge of a servo-aware job is expected."""

_BELOW_END = 0.8
"""Accuracies below the end of the line speeds where an edge is followed that may be there: at the very end limits allow no command."""

FOLLOWED_ACCURACY = 7e-3
"""Accuracy of an edge that is followed: one percent beyond it nothing designs."""

_ENOUGH = 0.05
"""Share of the tolerance, as a logarithm, that is kept at most where an edge is followed: half a percent of the line speed."""

_FLATTERED = 0.25, 8e-4
"""Share of an accuracy, and least share of itself, by which an edge is taken back before it is designed: cams of the first mesh settle a
little sooner."""

WITHIN = 0.998
"""Factor by which the edge of a servo-aware job is told within what programmes allow: a design, whose rows are others, needs that room."""


@dataclass(frozen=True)
class Reach:
    """How far a machine can go at a job's other numbers with its axis in tolerance.

    Parameters
    ----------
    max_line_speed
        Highest line speed at the job's cut length (m/s); ``None`` if none was found.
    line_speed_binding
        What fails beyond: a check, or what binds the perfect axis.
    min_cut_length
        Shortest cut at the job's line speed (m); ``None`` if none was found.
    cut_length_binding
        What fails below it.
    """

    max_line_speed: float | None
    line_speed_binding: str
    min_cut_length: float | None
    cut_length_binding: str


def reach(job: Job, far: Extremes) -> Reach:
    """Find how far a job's machine can go with its axis in tolerance.

    Parameters
    ----------
    job
        The job; a crank's sync zone placed.
    far
        The same for the perfect axis, which is the end of the search.
    """
    programmes = Programmes(job)
    speed, too_fast = highest_speed(job, far.max_line_speed, programmes=programmes)
    length, too_short = shortest_cut(job, far.min_cut_length, programmes)
    return Reach(speed, too_fast or far.line_speed_binding, length, too_short or far.cut_length_binding)


def highest_speed(
    job: Job,
    perfect: float | None,
    near: float | None = None,
    accuracy: float = ACCURACY,
    programmes: Programmes | None = None,
    cam: CamProfile | None = None,
) -> tuple[float | None, str]:
    """Find the highest line speed at the job's cut length that passes, and what fails beyond.

    Parameters
    ----------
    perfect
        Highest line speed of the perfect axis (m/s), ``None`` where none works.
    near
        Line speed (m/s) near which the edge is expected; without it the search comes from the perfect axis' edge,
        of a servo-aware job from its own line speed.
    accuracy
        Of the line speed, relative to it; of a servo-aware job no finer than `SERVO_AWARE_ACCURACY`.
    programmes
        Those of a search before for the same job, which began at it too.
    cam
        A cam of the job, which is not servo-aware: run at other line speeds it says where the edge is, if nothing else does.

    Returns
    -------
    (speed, failed)
        The line speed (m/s), ``None`` where none works; and what fails beyond, empty where the perfect axis ends there.
    """
    if perfect is None:
        return None, ""
    end = _end_of_speeds(job, perfect)
    if near is None and job.servo_aware:  # a job is made for a little less than what its machine can do
        near = min(job.cut.line_speed * _MADE_FOR, end)
    at = None if near is None else near / end
    found, failed = _kept(job, lambda share: job.task.designed_at(end * share), SLOWEST, accuracy, at, programmes, cam)
    return (None if found is None else end if not failed else end * found), failed


def followed_speed(job: Job, perfect: float | None, near: float, programmes: Programmes) -> float | None:
    """Find the highest line speed of a servo-aware job (m/s) near where a cut length beside has it; ``None`` where none works.

    Every step is the whole design, with all line speeds and servos: from near by there are few. What fails beyond is not asked.
    """
    if perfect is None:
        return None
    end = _end_of_speeds(job, perfect)

    def judged(share: float) -> Verdict:
        failed, missed = programmes.verdict(job.task.designed_at(end * share))
        return failed, 0.0 if -_ENOUGH <= missed <= 0.0 else missed

    at = min(near / end, 1.0 - _BELOW_END * FOLLOWED_ACCURACY)
    found, _ = _edge(judged, SLOWEST, FOLLOWED_ACCURACY, at, _FOLLOWED_STEEP)
    return None if found is None else end * found


def _end_of_speeds(job: Job, perfect: float) -> float:
    """Give the highest line speed that is looked at: of a shaped command the one beyond which the mean speed alone is too high."""
    return max(perfect, job.limits.speed * job.cut.length / job.machine.pitch) if _shaped(job) else perfect


def shortest_cut(job: Job, perfect: float | None, programmes: Programmes | None = None) -> tuple[float | None, str]:
    """Shortest cut at the job's line speed that passes (m), and what fails below it, empty where the perfect axis ends there."""
    if perfect is None:
        return None, ""
    end = perfect
    if _shaped(job):
        by_speed = job.machine.pitch * job.cut.line_speed / job.limits.speed
        end = min(perfect, max(by_speed, job.cut.sync_zone * LEAST_ZONE))
    near = min(1.0, end / job.cut.length * _MADE_FOR) if job.servo_aware else None
    found, failed = _kept(
        job, lambda share: job.task.with_length(end / share), 1.0 / LONGEST, near=near, programmes=programmes
    )
    return (None if found is None else end if not failed else end / found), failed


def _shaped(job: Job) -> bool:
    """Whether the command may be shaped, of a machine that goes on by a pitch: it need not be in sync in all of the sync zone."""
    return job.servo_aware and job.command == "shaped" and job.machine.pitch > 0.0


def stand_in(job: Job) -> MotionObjective:
    """Objective that redesigns are made for: the job's, or that of the motion which stands for it."""
    if job.objective == "sync_error":
        return "peak_acceleration"
    objective = of_command(job.objective)
    return motion_objective(job.machine, objective) or of_motion(objective)


def verdict(job: Job, task: Task, objective: MotionObjective, *, thorough: bool = False) -> Verdict:
    """Design a task as the job would and judge it; a cam that bears the ramps of the line on a first mesh where it is not `thorough`."""
    return Programmes(job).verdict(task) if job.servo_aware else look(job, task, objective, thorough=thorough).verdict


def _kept(
    job: Job,
    at: Callable[[float], Task],
    least: float,
    accuracy: float = ACCURACY,
    near: float | None = None,
    programmes: Programmes | None = None,
    cam: CamProfile | None = None,
) -> tuple[float | None, str]:
    """Find the greatest share of the perfect axis' edge that passes, as `_edge`.

    Of a servo-aware job by sketches at some line speeds with servos at the corners of their ranges; at all line speeds, and with the servos
    between, where these hold.
    """
    if not job.servo_aware:
        return _blind_edge(job, at, least, accuracy, near, cam)
    shares = shares_of(job.slowest)
    some, between = thinned(shares, _LOOKED), between_of(job)
    programmes = programmes or Programmes(job)
    missed = SketchedFirst(
        (lambda share: programmes.misses(at(share), some, sketch=True)) if some != shares or between else None,
        lambda share: programmes.misses(at(share), shares, between),
    )

    def looked(share: float) -> Verdict:
        by = missed(share)
        return (TOLERANCE if by > 0.0 else ""), by

    found, failed = _edge(looked, least, max(accuracy, SERVO_AWARE_ACCURACY), near, AWARE_STEEP)
    tries = _TRIES
    while tries and found is not None and missed.by_all(found) > 0.0:
        tries -= 1
        found, failed = (found * _BACK if tries and found * _BACK > least else None), TOLERANCE
    if not failed:
        return found, failed
    beyond = at(1.0 if found is None else found * (1.0 + SERVO_AWARE_ACCURACY))
    return None if found is None else found * WITHIN, binding_of(job, beyond, programmes.last)


def _blind_edge(
    job: Job, at: Callable[[float], Task], least: float, accuracy: float, near: float | None, cam: CamProfile | None
) -> tuple[float | None, str]:
    """Find the edge of a job that is not servo-aware; of a line that ramps from that of one which keeps its speed."""
    if near is None or not job.line.ramps:
        near, failed = _steady_edge(Looks(job, at, stand_in(job), cam), least, accuracy, near)
        if near is None or not job.line.ramps:
            return near, failed
    return _ramped_edge(job, at, least, max(accuracy, RAMPED_ACCURACY), near)


def _steady_edge(looks: Looks, least: float, accuracy: float, near: float | None) -> tuple[float | None, str]:
    """Find the edge on a line that keeps its speed: by the sync error alone, and by all checks where one of them fails there."""
    near, steep = looks.begun() if near is None else (near, STEEP)
    found, failed = _edge(looks.in_sync, least, accuracy, near, steep, looks.expected)
    if found is not None and (above := looks.above_hole(found)):
        found, failed = _edge(looks.in_sync, least, accuracy, above)
    if looks.last_held is not None and failure_name(looks.last_held.failed):
        return _edge(looks.whole, least, accuracy, found)
    if found is not None and failed == TOLERANCE:  # nothing beyond was looked at
        failed = failure_name(looks.in_sync(found * (1.0 + accuracy))[0]) or TOLERANCE
    return found, failed


def _ramped_edge(
    job: Job, at: Callable[[float], Task], least: float, accuracy: float, near: float
) -> tuple[float | None, str]:
    """Find the edge of a line that ramps.

    Where the ramps bind they are asked alone, which takes a third of the time. Where they do not, cams are searched with on a mesh, which
    settle a little sooner than what is designed: the edge is taken back by that, and to `RAMPED_ACCURACY` is one where a design passes.
    """
    objective, ramps_bind = stand_in(job), False

    def whole(share: float) -> Verdict:
        return verdict(job, at(share), objective)

    def looked(share: float) -> Verdict:
        nonlocal ramps_bind
        missed = ramp_missed(at(share)) if ramps_bind else math.inf
        if math.isfinite(missed):
            return (RAMP if missed > 0.0 else ""), missed
        found = whole(share)
        ramps_bind = found[0] == RAMP
        return found

    back = max(_FLATTERED[0] * accuracy, _FLATTERED[1])
    found, failed = _edge(looked, least, accuracy - back, near, _RAMPED_STEEP)
    if failed == RAMP and found is not None and whole(found)[0]:
        found, failed = _edge(whole, least, accuracy - back, found, _RAMPED_STEEP)
    if failed in ("", RAMP) or found is None:
        return found, failed
    found *= 1.0 - back
    tries = _TRIES if accuracy <= RAMPED_ACCURACY else 0
    while tries and found is not None and (fails := failure_name(verdict(job, at(found), objective, thorough=True)[0])):
        tries -= 1
        found, failed = (found * (1.0 - 0.5 * accuracy) if tries and found > least else None), fails
    return found, failed


class Programmes:
    """Programmes of a servo-aware job one after another, each with the rows that bound in the one before.

    The first is kept: the searches for the highest line speed and for the shortest cut both begin at the job.
    """

    def __init__(self, job: Job) -> None:
        self._job = job
        self.last: AxisProgramme | None = None
        self._first: tuple[AxisProgramme, float] | None = None

    def verdict(self, task: Task) -> Verdict:
        """Judge a task at all line speeds of the job, with the servos between, as `verdict`."""
        missed = self.misses(task, shares_of(self._job.slowest), between_of(self._job))
        return (TOLERANCE if missed > 0.0 else ""), missed

    def misses(
        self, task: Task, shares: tuple[float, ...], between: tuple[Servo, ...] = (), *, sketch: bool = False
    ) -> float:
        """By how much servo-aware commands within the limits miss the tolerance at line speeds, the axis' own limits kept."""
        if self._first is not None and _is_of(self._first[0].problem, task, shares, sketch=sketch):
            self.last = self._first[0]
            return self._first[1]
        missed = math.inf
        for limits in motor_limits(task.machine, task.limits):
            problem = replace(_problem(self._job, task.with_limits(limits), shares, between), sketch=sketch)
            self.last = AxisProgramme(problem, self.last, own=True)
            missed = min(missed, _missed(self.last, ratio=_asks_ratio(self._job)))
            if missed <= 0.0:
                break
        if self._first is None and self.last is not None:
            self._first = self.last, missed
        return missed


def _is_of(problem: AxisProblem, task: Task, shares: tuple[float, ...], *, sketch: bool) -> bool:
    """Whether a problem is that of a task at line speeds, but for rounding of its cut length and line speed."""
    one, other = problem.task.cut, task.cut
    return (
        (problem.sketch, problem.shares) == (sketch, shares)
        and math.isclose(one.length, other.length)
        and math.isclose(one.line_speed, other.line_speed)
    )


def _asks_ratio(job: Job) -> bool:
    """Whether a design holds the ratio of the axis, too: not where it makes the sync error least."""
    return job.objective != "sync_error"


def _problem(
    job: Job, task: Task, shares: tuple[float, ...], between: tuple[Servo, ...] = (), *, axis_limits: bool = True
) -> AxisProblem:
    """Give what a design asks for at line speeds, and of servos between the corners of their ranges."""
    return AxisProblem(task, job.command, servos_of(job), axis_limits=axis_limits, between=between, shares=shares)


def _missed(programme: AxisProgramme, *, ratio: bool) -> float:
    """By how much servo-aware commands miss the tolerance; infinite where none keeps the limits, or none can be found."""
    try:
        return programme.missed(ratio=ratio)
    except (InputError, SolverError):
        return math.inf


def binding_of(job: Job, task: Task, beside: AxisProgramme | None = None) -> str:
    """Name what a servo-aware design beyond the edge fails, where more than one thing does the first of them; programmes beside help."""
    shares = shares_of(job.slowest)
    free, some, programme = _problem(job, task, shares, axis_limits=False), thinned(shares, _LOOKED), beside

    def by(problem: AxisProblem) -> float:
        nonlocal programme
        programme = AxisProgramme(problem, programme, own=True)
        return _missed(programme, ratio=_asks_ratio(job))

    sketch = replace(free, shares=some, sketch=True)
    missed = SketchedFirst((lambda _: by(sketch)) if some != shares else None, lambda _: by(free))(1.0)
    if missed <= 0.0:
        return _axis_limit(job, task, programme.last if programme else None)
    if job.slowest < 1.0 and Programmes(job).misses(task, (1.0,)) <= 0.0:
        return BAND
    if (
        math.isinf(missed)
        and _shaped(job)
        and job.machine.pitch * task.cut.line_speed > task.limits.speed * task.cut.length
    ):
        return "speed"
    if math.isinf(missed):
        blind = replace(job, servo_aware=False, cut=replace(job.cut, shaped=False))
        return (
            failure_name(verdict(blind, task.with_cut(replace(task.cut, shaped=False)), stand_in(job))[0]) or TOLERANCE
        )
    error_alone = AxisProgramme(replace(free, shares=(1.0,)))
    return AXIS_RATIO if _asks_ratio(job) and _missed(error_alone, ratio=False) <= 0.0 else TOLERANCE


def _axis_limit(job: Job, task: Task, profile: CamProfile | None) -> str:
    """Name the limit that the axis itself breaks with a command that brings it into the tolerance."""
    if profile is None:
        return AXIS
    report = judge(profile, task.from_return(), job.servo, servo_aware=True)
    return next((check.name for check in report.checks if check.name.startswith("axis_") and not check.passed), AXIS)


def _edge(
    judged: Callable[[float], Verdict],
    least: float,
    accuracy: float,
    near: float | None = None,
    steep: float = STEEP,
    expected: Callable[[float], tuple[float, float]] = nowhere,
) -> tuple[float | None, str]:
    """Find the greatest share of the perfect axis' edge that passes, from where it is expected or from above.

    The inverse of a share that fails may tell where that of the edge is ``expected``.

    Returns
    -------
    (share, failed)
        The share, ``None`` if none passes, and what fails beyond it; nothing where the edge itself passes.
    """
    failures: dict[float, Failure] = {}

    def missed(longer: float) -> float:
        failed, by = judged(1.0 / longer)
        if failed:
            failures[longer] = failed
        return by

    first = 1.0 / (1.0 - _INSIDE)
    ends = first, 1.0 / least
    found = least_length(missed, first if near is None else 1.0 / near, ends, accuracy, steep, expected)
    if found is None:
        return None, failure_name(failures[max(failures)])
    if found <= first:
        return 1.0, ""
    return 1.0 / found, failure_name(
        failures[max(failures)]
    ) if failures else TOLERANCE  # unseen, it is near enough to its tolerance


def placed_as(job: Job, task: Task) -> Job:
    """Give a job the machine of a task, whose sync zone is placed."""
    return replace(job, machine=task.machine)
