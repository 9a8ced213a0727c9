"""`SpeedBand`: all line speeds at which a cam, fixed over the master, passes every check with its servo, fixed in time."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from camwright.jobs.job import Job
from camwright.jobs.servos import servos_of
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.polynomial.rows import ascending
from camwright.profiles.servo import Servo
from camwright.profiles.task import Task
from camwright.studies.speed_scan import NAMES, TOLERANCE, SpeedScan
from camwright.validation.production.line_ramp import line_ramp
from camwright.validation.report import ALLOWANCE, ValidationReport
from camwright.validation.servo.simulation import PHASES

NO_END = "none"
"""What binds where nothing ends a range: at standstill."""

ACCURACY = 5e-4
"""Width to which an end is bisected, relative to it; the end that is told lies inside."""

_POWERS = {"speed": 1, "motor_speed": 1, "acceleration": 2, "jerk": 3}
"""How a checked value grows with the line speed, exactly."""

_BY_SPEED = (
    "motor_torque",
    "following_error",
    "crossing",
    "settling",
    "shear_zone_error",
    "minimum_cut_length",
    "physical_cut_length",
    "axis_speed",
    "axis_acceleration",
    "axis_reversal",
)
"""Checks that must be made at every line speed. The lengths follow from others: who is within the limit of speed and settles in the zone is
longer than both minimum lengths, and has crossed the line."""

RAMP = "line_ramp"
"""The check of a line that ramps: a slower line leaves more to its ramps."""

_STEP, _SLOW_STEP, _FINER = 1.1, 1.3, 3
"""Steps of the scan above and below `_SLOW`, and the parts into which each is divided where the limit is not far."""

_FAR = 10.0
"""Factor on the limit from which a step is not divided: what the axis makes of a cam goes evenly over such steps."""

_SLOW, _CREEPING, _LEAST = 0.1, 0.01, 1e-3
"""Shares of the job's line speed: what is slow, below what nothing but the ends is looked at, and the least."""

_EDGE_PHASES = 64
"""Sampling phases at which an end must pass; those of the scan are fewer."""

_ASIDE = 0.05
"""Share of the range of an end that every step of its search leaves at either side."""

_STEPS_INWARDS = 6
"""Steps of growing width by which an end is taken inwards."""

_NOTHING = 1e-3
"""Part of a limit below which no value is told apart."""

_NEAR = 1.5
"""An extremum of the scan between its nodes is looked at where it is within this factor of the limit."""


@dataclass(frozen=True)
class SpeedBand:
    """Line speeds at which a cam passes every check.

    Parameters
    ----------
    parts
        Lowest and highest line speed of each part (m/s), ascending; several where there are gaps, none where no speed passes.
    binds
        What binds at these two ends of each part: the name of a check, `TOLERANCE`, or `NO_END` at standstill.
    forbids
        Checks that fail at every line speed, where no part is left.
    """

    parts: tuple[tuple[float, float], ...]
    binds: tuple[tuple[str, str], ...]
    forbids: tuple[str, ...] = ()

    def holds(self, line_speed: float) -> bool:
        """Whether a line speed (m/s) lies in a part."""
        return any(low <= line_speed <= high for low, high in self.parts)


def failed_checks(report: ValidationReport, band: SpeedBand, line_speed: float) -> list[str]:
    """Name the checks of a cam that failed at its line speed (m/s); `TOLERANCE` where only a servo at the corners of its ranges fails."""
    failed = [check.name for check in report.checks if not check.passed]
    return failed or ([] if band.holds(line_speed) else [TOLERANCE])


def failed_words(failed: Sequence[str]) -> str:
    """Say how many checks failed, and which."""
    count = f"{len(failed)} {'check' if len(failed) == 1 else 'checks'} failed"
    return f"{count}: {', '.join(failed)}" if failed else "every check passed"


def job_band(profile: CamProfile, job: Job, report: ValidationReport) -> SpeedBand:
    """Find the line speeds at which a job's cam passes every check; the arguments as in `speed_band`, the sync zone placed."""
    return speed_band(profile, job.task, servos_of(job), report, servo_aware=job.servo_aware)


def speed_band(
    profile: CamProfile,
    task: Task,
    servos: tuple[Servo, ...],
    report: ValidationReport,
    *,
    servo_aware: bool = False,
) -> SpeedBand:
    """Find all line speeds from standstill to the highest at which a cam passes every check.

    The highest is that of the limits of speed, acceleration, jerk and motor speed, exact. Below it the motor's torque and the axis are
    looked at in steps of ten per cent of the speed, of three within a factor of ten of the limit, thrice as wide below a tenth of the
    job's; an extremum near the limit is looked at between the steps too; ends are found to 0.05 %. Where the axis is surely right, or
    surely wrong, however slow the line (`camwright.validation.servo.creeping`), nothing is simulated; between that and a hundredth of the
    job's line speed only the two ends are, and below a thousandth it is as it is there.

    Parameters
    ----------
    profile
        One cycle over the master period ``[0, x_c]``.
    task
        What the cam is for, at the line speed of the job.
    servos
        The servo that is judged, then those at the corners of its ranges, which must keep the tolerance as well.
    servo_aware
        As in `camwright.validation.report.judge`.

    Raises
    ------
    InputError
        The memory of a servo is too long to simulate.

    Examples
    --------
    >>> from camwright import load_job
    >>> from camwright.profiles.returns import baseline
    >>> from camwright.validation.report import judge
    >>> job = load_job()
    >>> cam = baseline("cycloid", job.task)
    >>> band = job_band(cam, job, judge(cam, job.task, job.servo))
    >>> [(low, round(60 * high, 1)) for low, high in band.parts], band.binds
    ([(0.0, 117.3)], (('none', 'acceleration'),))
    """
    forbids = tuple(check.name for check in report.checks if not check.passed and not _depends(check.name, task))
    top, at_top = _top(report, task)
    if not forbids and top > 0.0:
        top, at_top = _within_ramp(profile, task, top, at_top)
    if forbids or not top > 0.0:
        return SpeedBand((), (), forbids or (at_top,))
    own, scan = task.cut.line_speed, SpeedScan(profile, task, servos, servo_aware)
    speeds = _nodes(own, scan.sure, top)
    rows = scan.excess(speeds, PHASES)
    speeds, rows = _finer(scan, speeds, rows)
    speeds, rows = _with_extrema(scan, speeds, rows)
    at = int(np.argmin(np.abs(speeds - own)))
    if report.passed and speeds[at] == own:
        rows[at, :-1] = np.minimum(
            rows[at, :-1], 1.0
        )  # as judged; the servos at the corners are nobody's check but this
    return _assembled(scan, speeds, rows, at_top)


def _depends(name: str, task: Task) -> bool:
    """Whether a check depends on the line speed."""
    return name in _POWERS or name in (*_BY_SPEED, RAMP) or (name == "reversal" and task.reverses)


def _top(report: ValidationReport, task: Task) -> tuple[float, str]:
    """Highest line speed (m/s) within the limits whose values go with a power of it, and which of them binds; 0 where one is unbounded."""
    powers = {**_POWERS, **({"reversal": 1} if task.reverses else {})}
    own, top, binding = task.cut.line_speed, math.inf, NO_END
    for check in report.checks:
        power = powers.get(check.name)
        if power is None or check.limit is None or check.value == 0.0:
            continue
        if check.value is None:
            return 0.0, check.name
        speed = own * (check.limit * (1 + ALLOWANCE) / check.value) ** (1 / power)
        if speed < top:
            top, binding = speed, check.name
    return (own if abs(top - own) <= ALLOWANCE * own else top), binding


def _within_ramp(profile: CamProfile, task: Task, top: float, at_top: str) -> tuple[float, str]:
    """Highest line speed (m/s) up to which the line may ramp as the job says, if it is below a top; and what binds there."""

    def bears(speed: float) -> bool:
        allowed = line_ramp(profile, task.at_speed(speed))
        return task.line.speeding <= allowed.speeding.value * (
            1 + ALLOWANCE
        ) and task.line.braking <= allowed.braking.value * (1 + ALLOWANCE)

    own = task.cut.line_speed
    if not task.line.ramps or bears(top):
        return top, at_top
    if own <= top and bears(own) and not bears(own * (1 + ACCURACY)):
        return own, RAMP
    low, high = 0.0, top
    while high - low > ACCURACY * high and high > _LEAST * own:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if bears(middle) else (low, middle)
    return low, RAMP


def _nodes(own: float, sure: float, top: float) -> FloatArray:
    """Line speeds of the scan (m/s), ascending: from below which all is sure to the highest, and the job's own."""
    slow = _SLOW * own
    lowest = min(max(sure, _LEAST * own), top)
    creeping = min(max(lowest, _CREEPING * own), top)
    nodes = [lowest, creeping, top]
    for step, low, high in ((_SLOW_STEP, creeping, min(slow, top)), (_STEP, max(lowest, slow), top)):
        if low < high:
            count = math.ceil(math.log(high / low) / math.log(step))
            nodes += np.geomspace(low, high, count + 1)[1:-1].tolist()
    return ascending(np.array([*nodes, *([own] if lowest <= own <= top else [])]))


def _with_extrema(scan: SpeedScan, speeds: FloatArray, rows: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Look closer where the value of a check turns near the limit between two nodes, twice.

    Of each check by itself: what one does between two nodes is not seen in the greatest of all where another rises.
    """
    for _ in range(2):
        inner, within = np.arange(1, len(rows) - 1), rows[1:-1]
        rise, fall = within - rows[:-2], rows[2:] - within
        near = (within < _NEAR) & (within > 1.0 / _NEAR)
        turns = inner[((rise * fall <= 0.0) & near & ((within > 1.0) == (rise <= 0.0))).any(axis=1)]
        if not len(turns):
            break
        speeds, rows = _merged(scan, speeds, rows, np.sqrt(speeds[turns, None] * speeds[turns[:, None] + [-1, 1]]))
    return speeds, rows


def _finer(scan: SpeedScan, speeds: FloatArray, rows: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Divide the steps that are not far from the limit, those of a line that creeps apart."""
    worst = rows.max(axis=1)
    lower, upper = np.minimum(worst[:-1], worst[1:]), np.maximum(worst[:-1], worst[1:])
    near = (upper > 1.0 / _FAR) & (lower < _FAR) & (speeds[1:] <= 1.001 * _SLOW_STEP * speeds[:-1])
    parts = np.arange(1, _FINER) / _FINER
    more = speeds[:-1][near, None] * (speeds[1:] / speeds[:-1])[near, None] ** parts
    return _merged(scan, speeds, rows, more) if more.size else (speeds, rows)


def _merged(scan: SpeedScan, speeds: FloatArray, rows: FloatArray, more: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Look at more line speeds."""
    new = ascending(more)
    every = np.concatenate([speeds, new])
    order = np.argsort(every, kind="stable")
    every = every[order]
    first = np.concatenate([[True], every[1:] != every[:-1]])
    return every[first], np.concatenate([rows, scan.excess(new, PHASES)])[order[first]]


def _assembled(scan: SpeedScan, speeds: FloatArray, rows: FloatArray, at_top: str) -> SpeedBand:
    """Put nodes that pass together to parts, their ends bisected."""
    passes = (rows <= 1.0).all(axis=1)
    parts: list[tuple[float, float]] = []
    binds: list[tuple[str, str]] = []
    # a line that creeps is in tolerance as the command is
    lowest = (float(speeds[0]), "shear_zone_error") if scan.creeping[1] > 0.0 else (0.0, NO_END)
    edges = np.nonzero(np.diff(np.concatenate([[False], passes, [False]]).astype(int)))[0].reshape(-1, 2)
    for first, beyond in edges.tolist():
        low, why_low = lowest if first == 0 else _end(scan, float(speeds[first]), float(speeds[first - 1]))
        high, why_high = (
            (float(speeds[-1]), at_top)
            if beyond == len(speeds)
            else _end(scan, float(speeds[beyond - 1]), float(speeds[beyond]))
        )
        parts.append((low, high))
        binds.append((why_low, why_high))
    if parts:
        return SpeedBand(tuple(parts), tuple(binds))
    return SpeedBand((), (), tuple(dict.fromkeys(NAMES[column] for column in rows.argmax(axis=1).tolist())))


def _end(scan: SpeedScan, inside: float, outside: float) -> tuple[float, str]:
    """Find where a part ends between a line speed that passes and one that does not, and what fails there.

    Found at the phases of the scan first, then taken inwards until it passes at more of them, which never see less; not past where it
    began without looking there, nor past the job's own line speed.
    """

    def excess(speed: float, phases: int) -> FloatArray:
        return np.asarray(scan.excess(np.array([speed]), phases)[0])

    begun, passing, failing = inside, excess(inside, PHASES), excess(outside, PHASES)
    low, high = _size(passing), max(_size(failing), 0.0)
    while abs(outside - inside) > ACCURACY * inside:
        part = min(max(low / (low - high), _ASIDE), 1.0 - _ASIDE)  # as if it rose evenly from end to end
        between = inside * (outside / inside) ** part
        found = excess(between, PHASES)
        size = _size(found)
        if (found > 1.0).any():  # the end that stays counts for less each time, that it be reached too
            outside, failing, high, low = between, found, max(size, 0.0), 0.5 * low
        else:
            inside, low, high = between, min(size, 0.0), 0.5 * high
    step = ACCURACY * (-1.0 if outside > inside else 1.0)
    for _ in range(_STEPS_INWARDS):
        found = excess(inside, _EDGE_PHASES)
        if inside == scan.task.cut.line_speed or not (found > 1.0).any():
            break  # the job's own line speed is as it was judged
        inwards = inside * (1.0 + step)
        inside = begun if min(inside, inwards) < begun < max(inside, inwards) else inwards
        failing, step = found, 2.0 * step
    return inside, NAMES[_worst(failing)]


def _size(row: FloatArray) -> float:
    """Logarithm of the greatest value over its limit."""
    return math.log(max(float(row.max()), _NOTHING))


def _worst(row: FloatArray) -> int:
    """Give the column of the first check that fails, or else of the greatest."""
    return int((row > 1.0).argmax() if (row > 1.0).any() else row.argmax())
