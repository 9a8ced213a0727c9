"""A shift of production simulated: each piece's length and sync error, the optimised cam beside the linear return, over servos."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from camwright.design.production.line_plan import HARDEST
from camwright.house.numbers import with_unit
from camwright.house.progress import Step, ignore
from camwright.jobs.job import Job
from camwright.production.cut_list import ListPlan, list_shift, plan_list
from camwright.production.line_speeds import plan_line
from camwright.production.list_checks import require_passed
from camwright.profiles.cut_list import CutList
from camwright.profiles.errors import InputError
from camwright.profiles.line_run import LineRun
from camwright.profiles.polynomial.profile import CamProfile, FloatArray, join
from camwright.profiles.servo import Servo
from camwright.validation.production.shift import Disturbance, Shift, ShiftRun, run_shift

MOTIONS = ("optimised", "linear_return")
"""What is compared."""

_ROUNDING = 1e-9

BINS = 40
"""Bins of the histogram of lengths."""

_NOISES = 2**20
"""Readings of the encoder that are drawn; after them the noise begins anew."""

_FARTHEST = 4.0
"""Standard deviations beyond which nothing is drawn: a mark or a slip beyond is another fault."""


@dataclass(frozen=True)
class Disturbances:
    """What goes wrong in a shift, all normally distributed and drawn from one seed.

    Parameters
    ----------
    noise
        Of the encoder, at each sample (m, RMS).
    slip
        Share by which the wheel measures too little, from piece to piece (RMS).
    marks
        By which marks are off their place, so that pieces become longer or shorter (m, RMS).
    servos
        Servos drawn from the job's ranges, beside its own.
    seed
        Seed of all draws.
    """

    noise: float = 0.0
    slip: float = 0.0
    marks: float = 0.0
    servos: int = 0
    seed: int = 1


@dataclass(frozen=True, eq=False)
class MotionRuns:
    """What servos make of one kind of cams.

    Parameters
    ----------
    nominal
        The job's own servo.
    length_errors
        Length less what was asked of each piece, with the job's own servo (m), shape ``(pieces,)``.
    worst_length_errors, worst_sync_errors
        Greatest magnitudes over all servos (m), shape ``(pieces,)``.
    """

    nominal: ShiftRun
    length_errors: FloatArray
    worst_length_errors: FloatArray
    worst_sync_errors: FloatArray

    def outside(self, tolerance: float) -> int:
        """Pieces whose sync error leaves the tolerance, with the job's own servo."""
        return int((self.nominal.sync_errors > tolerance).sum())


@dataclass(frozen=True, eq=False)
class ShiftStudy:
    """A simulated shift.

    Parameters
    ----------
    planned
        Cams, changes and the speed of the line.
    given
        Whether the line's speed was given, and not planned.
    disturbances
        What went wrong.
    lengths
        What was asked of each piece, its mark counted (m), shape ``(pieces,)``.
    cut_times
        When each piece is cut (s), shape ``(pieces,)``.
    too_fast, too_hard
        Pieces on which the line ran faster than the cam may, and on which it ramped harder than the cam bears.
    servos
        Servos that were run.
    runs
        What became of it, by `MOTIONS`.
    """

    planned: ListPlan
    given: bool
    disturbances: Disturbances
    lengths: FloatArray
    cut_times: FloatArray
    too_fast: int
    too_hard: int
    servos: int
    runs: dict[str, MotionRuns]

    @property
    def edges(self) -> FloatArray:
        """Edges of the bins of length errors (m), shape ``(BINS + 1,)``, the same for all motions."""
        widest = max(float(np.abs(run.length_errors).max()) for run in self.runs.values())
        return np.linspace(-widest, widest, BINS + 1) if widest > 0.0 else np.linspace(-1e-9, 1e-9, BINS + 1)

    def histogram(self, motion: str) -> FloatArray:
        """Count the pieces by their length error, with the job's own servo; shape ``(BINS,)``."""
        return np.histogram(self.runs[motion].length_errors, self.edges)[0].astype(np.float64)


def simulate_shift(
    job: Job, asked: CutList, line: LineRun | None, disturbances: Disturbances, step: Step = ignore
) -> ShiftStudy:
    """Simulate a shift.

    Parameters
    ----------
    job
        The job; where the line's speed is planned its ramp is known, where it is given and the job states no ramp the cams are to bear its
        hardest.
    line
        Speed of the line; the fastest plan if not given.
    disturbances
        What goes wrong.

    Raises
    ------
    InputError
        The line stops before the list is cut, marks move where the ratio in sync is not constant, or as `plan_list`.
    InfeasibleError, SolverError
        As `plan_list`.
    """
    _require_simple(job, disturbances)
    if (
        line is not None and job.line.acceleration is None and 0.0 < line.hardest <= HARDEST
    ):  # harder is a jump, which no cam bears
        job = replace(job, line=replace(job.line, acceleration=line.hardest))
    servos = _servos(job, disturbances)
    planned = plan_list(job, asked, line, step, len(servos) * len(MOTIONS))
    draw = np.random.default_rng(disturbances.seed)
    pieces = asked.pieces
    longer = _normal(draw, pieces) * disturbances.marks if disturbances.marks else None
    lengths = asked.gaps if longer is None else asked.gaps + longer
    _require_long(lengths, job)
    if line is None and longer is not None:  # the line follows the pieces as they come
        planned = replace(planned, line=plan_line(job.line, lengths, planned.highest, planned.steady))
    slip = _normal(draw, pieces) * disturbances.slip if disturbances.slip else np.zeros(0)
    noise = _normal(draw, _NOISES) * disturbances.noise if disturbances.noise else np.zeros(0)
    wrong = Disturbance(noise, slip)
    require_passed(float(lengths.sum()), planned.line)
    found, shift = {}, None
    for motion in MOTIONS:
        step(f"running {motion.replace('_', ' ')}")
        shift = list_shift(planned.cams, planned.of, planned.changes, _profiles(planned, motion), longer)
        found[motion] = _runs(shift, planned.line, servos, wrong, lengths)
    assert shift is not None  # noqa: S101 - there are motions
    times = planned.line.when(shift.places()[:, 1])
    joints = shift.table.joints
    fast = int((planned.line.fastest_between(joints) > planned.highest * (1.0 + _ROUNDING)).sum())
    hard = int(planned.ramped_too_hard(joints).sum())
    return ShiftStudy(planned, line is not None, disturbances, lengths, times, fast, hard, len(servos), found)


def _normal(draw: np.random.Generator, count: int) -> FloatArray:
    """Draw from a normal distribution cut off far out."""
    return np.clip(draw.standard_normal(count), -_FARTHEST, _FARTHEST)


def _require_simple(job: Job, disturbances: Disturbances) -> None:
    """Refuse what cannot be simulated: marks on a machine whose ratio changes in sync, servos without ranges."""
    faults = []
    if _FARTHEST * disturbances.noise > job.cut.sync_zone:
        faults.append(
            f"--noise: {with_unit(disturbances.noise, 'm', 4, job.units)} a sample, drawn up to four times that, is more than the sync "
            f"zone of {with_unit(job.cut.sync_zone, 'm', 4, job.units)}, and no encoder's; write e.g. 5 um"
        )
    if disturbances.marks and (not job.machine.placed or not job.task.straight or job.cut.shaped):
        faults.append(
            "--marks: pieces are made longer by stretching the return, which needs a constant ratio in sync and a command that is in sync; "
            "leave it out for this job"
        )
    if disturbances.servos and (job.servo_tolerance is None or not job.servo_tolerance.varying):
        faults.append("--servos: the job gives no ranges to draw servos from; add [servo.tolerance], or leave it out")
    if faults:
        raise InputError(*faults)


def _require_long(lengths: FloatArray, job: Job) -> None:
    """Refuse marks that leave no room for the sync zone."""
    if lengths.min() <= job.cut.sync_zone:
        raise InputError(
            f"--marks: the shortest piece becomes {lengths.min() * 1e3:.6g} mm long, no more than the sync zone; draw smaller deviations"
        )


def _servos(job: Job, disturbances: Disturbances) -> tuple[Servo, ...]:
    """Give the job's servo and those drawn from its ranges."""
    ranges = job.servo_tolerance
    if ranges is None or not disturbances.servos:
        return (job.servo,)
    return (job.servo, *ranges.draw(job.servo, disturbances.servos, disturbances.seed))


def _profiles(planned: ListPlan, motion: str) -> list[CamProfile]:
    """Cycles of the cams and the transitions: as designed, or with straight returns between the same states."""
    own = [(cam.solution.profile, cam.running.zone_start) for cam in planned.cams]
    own += [
        (transition.profile, planned.cams[change.after - 1].running.zone_start)
        for change in planned.changes.values()
        for transition in change.transitions
    ]
    return [profile if motion == "optimised" else _straight_return(profile, zone) for profile, zone in own]


def _straight_return(profile: CamProfile, zone: float) -> CamProfile:
    """Replace the return of a cycle by a straight line: the linear return, with the speed stepping at both its ends."""
    start, end = float(profile(profile.start)), float(profile(zone))
    back = CamProfile.from_arrays([profile.start, zone], [[start, (end - start) / (zone - profile.start)]])
    return join(back, profile.restrict(zone, profile.end))


def _runs(shift: Shift, line: LineRun, servos: Sequence[Servo], wrong: Disturbance, lengths: FloatArray) -> MotionRuns:
    """Run all servos over a shift, the job's own first."""
    nominal = run_shift(shift, line, servos[0], wrong)
    errors = nominal.lengths - lengths
    worst_lengths, worst_sync = np.abs(errors), nominal.sync_errors
    for servo in servos[1:]:
        found = run_shift(shift, line, servo, wrong)
        worst_lengths = np.maximum(worst_lengths, np.abs(found.lengths - lengths))
        worst_sync = np.maximum(worst_sync, found.sync_errors)
    return MotionRuns(nominal, errors, worst_lengths, worst_sync)
