"""A recorded motion of an axis, and whether the axis can be known from it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from profiles.errors import InputError
from profiles.machines.machine import SlaveUnit
from profiles.polynomial import FloatArray

FEWEST_ROWS = 200
SHORTEST = 0.3
"""Least length of a trace (s)."""

_FLAT_ROWS = 4
"""Rows of one and the same value from which a signal that moved before counts as held."""

_BEYOND = 0.05
"""Part of its range by which the other signal then moves on."""

_STRAIGHT = 5.0
"""Deviation of the command from a straight line that counts as excitation, as a multiple of the noise of the actual position."""

_SCALE = 8.0
"""How much further one of the two signals may move than the other: inches taken for millimetres are more."""

_STAIRS = 0.5
"""Share of rows in which a command that moves before and after stands still, from which on it is one that is held between samples."""


@dataclass(frozen=True, eq=False)
class Trace:
    """What a drive recorded: command and actual position at equally spaced times.

    Parameters
    ----------
    start
        Time of the first row (s).
    step
        Time between two rows (s).
    command, actual
        Positions (m or rad), shape ``(n,)``.
    unit
        Unit of the positions.
    """

    start: float
    step: float
    command: FloatArray
    actual: FloatArray
    unit: SlaveUnit

    @property
    def times(self) -> FloatArray:
        """Times of the rows (s)."""
        return self.start + self.step * np.arange(len(self.command))


def require_usable(trace: Trace, place: str) -> None:
    """Refuse a trace from which the axis cannot be known.

    Parameters
    ----------
    place
        What messages begin with.

    Raises
    ------
    InputError
        It is too short, a signal is clipped or held, the command does not excite the axis, or the two signals do not belong together;
        all faults are told.
    """
    faults = list(_faults(trace))
    if faults:
        raise InputError(*(f"{place}: {fault}" for fault in faults))


def noise_of(signal: FloatArray) -> float:
    """Size of a signal's noise (rms, in its unit), from the third differences, to which its motion adds little."""
    return float(np.sqrt(np.mean(np.diff(signal, 3) ** 2) / 20.0))


def _faults(trace: Trace) -> Iterator[str]:
    rows, lasts = len(trace.command), trace.step * (len(trace.command) - 1)
    if rows < FEWEST_ROWS or lasts < SHORTEST:
        yield (
            f"{rows} rows over {lasts:.4g} s: too short to know the axis from; record {FEWEST_ROWS} rows and {SHORTEST:g} s at least, "
            "better 2 s at 1 kHz"
        )
        return
    if np.ptp(trace.command) == 0.0:
        yield "the command stands still, so the axis is not excited; record a motion with accelerations, e.g. some cycles of the cam"
        return
    if np.ptp(trace.actual) == 0.0:
        yield "the actual position stands still while the command moves; record an axis that follows"
        return
    clipped = [
        fault
        for name, signal, other, others in (
            ("actual position", trace.actual, trace.command, "command"),
            ("command", trace.command, trace.actual, "actual position"),
        )
        if (fault := _clipped(name, signal, other, others, trace)) is not None
    ]
    yield from clipped
    held = _held(trace)
    if held is not None:
        yield held
    bend = _bend(trace)
    if bend <= _STRAIGHT * noise_of(trace.actual) or bend <= 1e-9 * np.ptp(trace.command):
        yield (
            f"the command runs straight to {bend:.2g} {trace.unit} rms, so the axis is not excited; record a motion with accelerations, "
            "e.g. some cycles of the cam"
        )
    elif not clipped:
        yield from _scale(trace)


def _clipped(name: str, signal: FloatArray, other: FloatArray, others: str, trace: Trace) -> str | None:
    """Say where a signal stays at its extreme while the other moves on beyond it.

    A signal that turns round slowly may repeat its extreme too, but then it came slowly.
    """
    beyond = _BEYOND * float(np.ptp(other))
    steps = np.abs(np.diff(signal))
    least = float(steps[steps > 0.0].min())  # a quantised signal moves by no less
    for side, extreme in ((1.0, signal.max()), (-1.0, signal.min())):
        at = signal == extreme
        edges = np.flatnonzero(np.diff(np.concatenate([[False], at, [False]])))
        for first, end in edges.reshape(-1, 2).tolist():
            came = steps[max(first - 2, 0) : max(first - 1, 0)]
            if end - first < _FLAT_ROWS or not (came > 2.0 * least).any():
                continue
            if float((side * (other[first:end] - extreme)).max()) > beyond:
                begins, ends = (trace.start + trace.step * row for row in (first, end - 1))
                return (
                    f"the {name} is clipped: from {begins:.6g} s to {ends:.6g} s it stays at {extreme:.6g} {trace.unit}, its "
                    f"{'greatest' if side > 0 else 'least'}, while the {others} moves on; record it with a greater range"
                )
    return None


def _held(trace: Trace) -> str | None:
    """Say that the command was recorded as it is held between samples."""
    steps = np.diff(trace.command)
    moving = np.flatnonzero(steps)
    gaps = np.diff(moving)
    if len(gaps) < 10:
        return None
    usual = int(np.median(gaps))
    if usual > 1 and np.mean(gaps == usual) > _STAIRS:
        return (
            f"the command is recorded in stairs of {usual * trace.step * 1e3:.4g} ms, as a sampled loop holds it; record the command "
            "before it is sampled, or every value once"
        )
    return None


def _bend(trace: Trace) -> float:
    """Deviation of the command from its straight line (rms)."""
    time = np.linspace(-1.0, 1.0, len(trace.command))
    level = trace.command - trace.command.mean()
    return float(np.sqrt(np.mean((level - time * (time @ level) / (time @ time)) ** 2)))


def _scale(trace: Trace) -> Iterator[str]:
    """Check that the actual position moves about as far as the command; an axis does not follow fast motion fully."""
    share = float(np.std(trace.actual) / np.std(trace.command))
    if not 1.0 / _SCALE < share < _SCALE:
        yield (
            f"the actual position moves {share:.3g} times as far as the command; give both in their true units, of one and the same axis"
        )
