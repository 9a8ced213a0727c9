"""A recorded run laid over its design: the sync error of each cut, what kind of error it is, and what that kind points to."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from camwright.house.numbers import with_unit
from camwright.jobs.job import Job
from camwright.profiles.machines import Machine
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.servo import spectral_radius
from camwright.profiles.tables.text import decode
from camwright.profiles.tables.trace_csv import read_trace_csv
from camwright.profiles.trace import Trace
from camwright.validation.check import Check
from camwright.validation.identify.preparation import unwrapped
from camwright.validation.recording.alignment import Alignment, aligned
from camwright.validation.recording.cut_errors import CutError, cut_errors
from camwright.validation.recording.offset_drift_scatter import Errors, Kind, told_apart
from camwright.validation.servo.lead import LengthError, length_errors

MOST_BYTES = 1 << 25
_MOST_ROWS = 200_000

_SMALL = 0.1
"""Part of the sync tolerance below which a kind of error is not worth a word."""

_EXPECTED = 1.5
"""How much more than the simulated servo an axis may scatter before its sampling is not what explains it."""


@dataclass(frozen=True, eq=False)
class RecordedRun:
    """A recorded run beside its design.

    Parameters
    ----------
    job
        The job that it was judged by.
    run
        The recording in the job's coordinates.
    total, command, axis
        The errors of the cuts told apart: of all, of the command against the design, of the axis against its command.
    expected
        What the job's servo would do at the recorded line speed; ``None`` where it is unstable.
    checks
        The sync error against the tolerance.
    kind
        The kind that moves a cut farthest; ``None`` where none is worth a word.
    causes
        What the kinds found point to, a sentence each.
    notes
        What was assumed to lay the recording over the design, a sentence each.
    """

    job: Job
    profile: CamProfile
    run: Alignment
    cuts: tuple[CutError, ...]
    total: Errors
    command: Errors
    axis: Errors
    expected: LengthError | None
    checks: tuple[Check, ...]
    kind: Kind | None
    causes: tuple[str, ...]
    notes: tuple[str, ...]

    @property
    def passed(self) -> bool:
        """Whether the tool was within the tolerance at every cut."""
        return all(check.passed for check in self.checks)


def recorded_run(
    data: bytes,
    place: str,
    job: Job,
    profile: CamProfile,
    line_speed: float | None = None,
    gear: float | None = None,
    columns: str | None = None,
) -> RecordedRun:
    """Lay a recording over a cam.

    Parameters
    ----------
    data
        The bytes of the recording: time, command and actual position, the master's if it was recorded.
    place
        What messages begin with.
    job
        The job, the place of its sync zone chosen.
    profile
        The cam that ran, one cycle.
    line_speed
        Line speed of the recording (m/s), if it is known and the master was not recorded.
    gear
        Recorded travel over the slave's, if it is known.
    columns
        As of `camwright.profiles.tables.trace_csv.read_trace_csv`.

    Raises
    ------
    InputError
        It cannot be read, or is no run of this cam.
    """
    text = decode(data, place, MOST_BYTES)
    trace = read_trace_csv(text, place, most_rows=_MOST_ROWS, master=True, columns=columns)
    trace = _unwrapped(trace, job.machine, job.cut.length, place)
    run = aligned(trace, profile, job.task, place, line_speed, gear)
    cuts = cut_errors(run, profile, job.task, place)
    speeds = [cut.line_speed for cut in cuts]
    total, command, axis = (
        told_apart([getattr(cut, of) for cut in cuts], speeds) for of in ("error", "command", "axis")
    )
    expected = None
    if spectral_radius(job.servo) < 1.0:
        expected = length_errors(profile, job.task.at_speed(run.line_speed), job.servo)[-1]
    shares = total.shares(len(cuts))
    worst = max(shares, key=lambda kind: shares[kind])
    found = RecordedRun(
        job=job,
        profile=profile,
        run=run,
        cuts=cuts,
        total=total,
        command=command,
        axis=axis,
        expected=expected,
        checks=(_check(cuts, job),),
        kind=worst if shares[worst] > _SMALL * job.cut.sync_tolerance else None,
        causes=(),
        notes=(),
    )
    return replace(found, causes=tuple(_causes(found)), notes=tuple(_notes(found, trace)))


def _unwrapped(trace: Trace, machine: Machine, length: float, place: str) -> Trace:
    """Unwrap a recording; its axis may turn over by the pitch, a turn of the slave, or some of these."""
    turn = machine.slave_turn
    known: list[float] = []
    if trace.unit == machine.slave_unit:
        known = [each for each in (machine.pitch, turn) if each]
    known += [each * number for each in known for number in (2, 3, 4)]
    master = [length * number for number in (1, 2, 3, 4)] if trace.master_unit == "m" else []
    return unwrapped(trace, place, known, master)


def _check(cuts: tuple[CutError, ...], job: Job) -> Check:
    """Judge the greatest sync error in the shear zone of any cut."""
    worst = max(cuts, key=lambda cut: abs(cut.greatest))
    tolerance = job.cut.sync_tolerance
    return Check(
        "recorded_sync_error",
        abs(worst.greatest) <= tolerance,
        abs(worst.greatest),
        tolerance,
        "m",
        None,
        f"tool against material in the shear zone of {len(cuts)} recorded cuts, greatest at cut {worst.number}",
    )


def _causes(found: RecordedRun) -> Iterator[str]:
    """Say what each kind of error that is worth a word points to, the greatest first."""
    small = _SMALL * found.job.cut.sync_tolerance
    shares = found.total.shares(len(found.cuts))
    for kind in sorted(shares, key=lambda each: -shares[each]):
        if shares[kind] <= small:
            continue
        if kind == "offset":
            yield _offset_cause(found)
        elif kind == "drift":
            yield _drift_cause(found)
        else:
            yield _scatter_cause(found)
    lag = found.total.lag
    if lag is not None and found.total.lag_interval is not None:
        low, high = found.total.lag_interval
        if not low <= 0.0 <= high:
            yield (
                f"line speed: the tool runs {1e3 * abs(lag):.3g} ms {'late' if lag > 0 else 'early'} (95 %: {1e3 * low:.3g} to "
                f"{1e3 * high:.3g} ms), so lengths change where the line changes its speed; a lead time of that much makes up for it"
            )


def _offset_cause(found: RecordedRun) -> str:
    """Say what an offset that is the same for all cuts points to."""
    units, offset, speed = found.job.units, found.total.offset, found.run.line_speed
    words = (
        f"offset: the tool is {with_unit(abs(offset), 'm', 4, units)} {'ahead of' if offset > 0 else 'behind'} the material at every cut, "
        f"which spoils no length at a steady speed; "
    )
    zeros = found.run.zeros
    if zeros.lag is None or zeros.zero is None or found.job.machine.slave_unit != "m":
        return words + (
            f"it is a lag of {-1e3 * offset / speed:.3g} ms (dead time, velocity feed-forward below 1, a lead that is not set), or a zero "
            "that is off"
        )
    by_lag, by_zero = -zeros.lag * speed, zeros.zero
    if abs(by_lag) >= abs(by_zero):
        return words + (
            f"a {'lag' if by_lag < 0 else 'lead'} of {1e3 * abs(zeros.lag):.3g} ms: dead time, velocity feed-forward below 1 or a wrong "
            "lead time; it grows with the line speed"
        )
    return words + (
        f"the zero of the axis is off its command by {with_unit(by_zero, 'm', 4, units)} at any speed: reference, offset of the encoder"
    )


def _drift_cause(found: RecordedRun) -> str:
    """Say what an error that grows from cut to cut points to."""
    drift = found.total.drift or 0.0
    more = abs(found.command.drift or 0.0) > abs(found.axis.drift or 0.0)
    return (
        f"drift: the tool {'gains' if drift > 0 else 'loses'} {with_unit(abs(drift), 'm', 4, found.job.units)} each cut, so every piece is "
        f"{'short' if drift > 0 else 'long'} by that; "
        + (
            "the command has it already: the cycle of the table is not the pitch (circumference, gear ratio, rounded counts), or "
            "the master is scaled wrongly"
            if more
            else "the axis drifts off its command: its encoder and its command are scaled apart, or the recorded encoder slips"
        )
    )


def _scatter_cause(found: RecordedRun) -> str:
    """Say what errors that change from cut to cut point to."""
    units, total = found.job.units, found.total
    words = (
        f"scatter: cuts differ by {with_unit(2.0 * (total.scatter or 0.0), 'm', 4, units)} (2 σ) from one to the next; "
    )
    if (found.command.scatter or 0.0) > (found.axis.scatter or 0.0):
        return words + (
            "the command has it already: a rough or slipping master encoder, a master that is not filtered, or corrections by marks"
        )
    expected = found.expected
    if expected is not None and (total.range or 0.0) <= _EXPECTED * expected.variation:
        return words + (
            "no more than the sampling of the servo explains, which meets each cut at another phase "
            f"({with_unit(expected.variation, 'm', 4, units)}): a shorter sample time, or cycles of whole samples"
        )
    return (
        words
        + "the axis has it: play, a load that changes, a weak or a ringing loop, vibration; look at torque and following error"
    )


def _notes(found: RecordedRun, trace: Trace) -> Iterator[str]:
    """Say what was assumed."""
    run, units, job = found.run, found.job.units, found.job
    yield from trace.notes
    if run.reconstructed:
        yield (
            f"the master was not recorded: a steady line of {with_unit(run.line_speed, 'm/s', units=units)} is taken, at which the command "
            "is the cam; what the line itself does cannot be seen (record the master's position)"
        )
    elif abs(run.master_shift) > 1e-6 * job.cut.length:
        behind = "behind" if run.master_shift < 0.0 else "ahead of"
        yield (
            f"the command lies on the cam {with_unit(abs(run.master_shift), 'm', 5, units)} {behind} the recorded master: another zero, "
            f"or, if both count from the job's, {1e3 * abs(run.master_shift) / run.line_speed:.3g} ms at this line speed"
        )
    if run.gear.counted_at != "the slave":
        yield f"the recording counts {run.gear.counted_at} (--gear says it otherwise)"
    if run.zeros.taken_off:
        slave = (
            with_unit(run.zeros.taken_off, "m", 6, units)
            if job.machine.slave_unit == "m"
            else f"{run.zeros.taken_off:.6g} rad"
        )
        yield f"the actual position has another zero than the command: {slave} were taken off"
    if len(found.cuts) < 2:
        yield "one cut says neither a length nor a drift; record 20"
