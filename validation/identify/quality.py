"""Whether an axis can be known from its recorded motion."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import FloatArray
from camwright.profiles.trace import Trace

FEWEST_ROWS = 200
SHORTEST = 0.3
"""Least length of a trace (s)."""

_FLAT_ROWS = 4
"""Rows of one and the same value from which a signal that moved before counts as held."""

_MOVED = 0.05
"""Part of its range by which the other signal then moves."""

_STRAIGHT = 5.0
"""Deviation of the command from a straight line that counts as excitation, as a multiple of the noise of the actual position."""

_ALIKE = 1e-8
"""Lag of the actual position, as a part of its range, that is rounding of numbers with nine digits."""

_BY_CHANCE = 6.0
"""Share by which the variance of white noise seems greater than its third differences tell, times the root of its rows: never by chance."""

_AGAINST = 0.8
"""Correlation from which on two signals run against each other."""
_SCALE = 8.0
"""How much further one of the two signals may move than the other: inches taken for millimetres are more."""

_STAIRS = 0.5
"""Share of rows in which a command that moves before and after stands still, from which on it is one that is held between samples."""


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


def require_lag(trace: Trace, place: str) -> None:
    """Refuse a trace whose actual position is its command, but for noise: it tells nothing of an axis.

    Raises
    ------
    InputError
        Beside another zero and another ratio there is nothing but white noise between the two.
    """
    command = trace.command - trace.command.mean()
    lag = trace.actual - float(command @ trace.actual) / float(command @ command) * command
    left, noise = float(np.std(lag)), noise_of(lag) * (1.0 + _BY_CHANCE / len(lag) ** 0.5) ** 0.5
    if left <= max(noise, _ALIKE * float(np.ptp(trace.actual))):
        raise InputError(
            f"{place}: the actual position is the command itself, but for {left:.2g} {trace.unit} rms of noise or rounding: a simulated "
            "axis, or one column taken twice; record the position that the encoder measures"
        )


def noise_of(signal: FloatArray) -> float:
    """Size of a signal's noise (rms, in its unit), from the third differences, to which its motion adds little."""
    third = signal[3:] - 3.0 * signal[2:-1] + 3.0 * signal[1:-2] - signal[:-3]
    return float(np.sqrt(np.mean(third**2) / 20.0))


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
    clipped = [fault for fault in (_clipped_actual(trace), _clipped_command(trace)) if fault]
    yield from clipped
    held = _held(trace)
    if held is not None:
        yield held
    bend, noise = _bend(trace), noise_of(trace.actual)
    if bend <= 1e-9 * np.ptp(trace.command):
        yield "the command runs straight, so the axis is not excited; record a motion with accelerations, e.g. some cycles of the cam"
    elif bend <= _STRAIGHT * noise:
        yield (
            f"the command leaves its straight line by {bend:.2g} {trace.unit} rms only, in the noise of the actual position of "
            f"{noise:.2g} {trace.unit} rms, so the axis is hardly excited; record a motion with accelerations, e.g. some cycles of the cam"
        )
    elif not clipped:
        yield from _scale(trace)


def _clipped_actual(trace: Trace) -> str | None:
    """Say where the actual position stays at its extreme while the command moves."""
    reach = _MOVED * float(np.ptp(trace.command))
    for first, end, _ in _flats(trace.actual):
        if float(np.ptp(trace.command[first:end])) > reach:
            return _clipped("actual position", "command", trace, trace.actual, first, end)
    return None


def _clipped_command(trace: Trace) -> str | None:
    """Say where the command stays at its extreme while the actual position moves beyond it; it may come up to it."""
    reach = _MOVED * float(np.ptp(trace.actual))
    for first, end, side in _flats(trace.command):
        if float((side * (trace.actual[first:end] - trace.command[first])).max()) > reach:
            return _clipped("command", "actual position", trace, trace.command, first, end)
    return None


def _clipped(name: str, other: str, trace: Trace, signal: FloatArray, first: int, end: int) -> str:
    begins, ends = (trace.start + trace.step * row for row in (first, end - 1))
    return (
        f"the {name} is clipped: from {begins:.6g} s to {ends:.6g} s it stays at {signal[first]:.6g} {trace.unit}, the end of its range, "
        f"while the {other} moves on; record it with a greater range"
    )


def _flats(signal: FloatArray) -> Iterator[tuple[int, int, float]]:
    """Find where a signal stays at an extreme to which it came fast: first row, row after the last, and which extreme.

    A signal that turns round slowly may repeat its extreme too, but then it came slowly; one that starts at rest did not come.
    """
    steps = np.abs(np.diff(signal))
    least = float(steps[steps > 0.0].min())  # a quantised signal moves by no less
    for side, extreme in ((1.0, signal.max()), (-1.0, signal.min())):
        edges = np.flatnonzero(np.diff(np.concatenate([[False], signal == extreme, [False]])))
        for first, end in edges.reshape(-1, 2).tolist():
            came = steps[max(first - 2, 0) : max(first - 1, 0)]
            if end - first >= _FLAT_ROWS and (came > 2.0 * least).any():
                yield first, end, side


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
    """Check that the actual position moves about as far as the command, and its way; an axis does not follow fast motion fully."""
    if float(np.corrcoef(trace.command, trace.actual)[0, 1]) < -_AGAINST:
        yield "the actual position runs against the command: one of them counts the other way; turn the sign of one column"
        return
    share = float(np.std(trace.actual) / np.std(trace.command))
    if not 1.0 / _SCALE < share < _SCALE:
        yield (
            f"the actual position moves {share:.3g} times as far as the command; give both in their true units, of one and the same axis"
        )
