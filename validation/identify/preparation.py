"""A recording made fit for a fit: a modulo axis unwrapped, a gear between command and axis taken off."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import FloatArray
from camwright.profiles.trace import Trace

_JUMP = 0.4
"""Part of a signal's range that one step must cover to be a jump."""
_USUAL = 8.0
"""By how many times a jump exceeds the usual step."""
_AROUND = 4
"""Rows on either side by which the step at a jump is estimated."""
_NEARBY = 20
"""Rows on either side of a jump from which it is told how well the step there is estimated."""
_SURE = 6.0
"""Standard deviations of an estimate within which a plain number is the modulus; many jumps at one place are off by the same."""
_ODD = 12.0
"""Standard deviations of one jump beyond which it is none of the modulus."""
_FEW, _PLAIN = 4, 2e-6
"""A modulus so near to one that the machine has, or to a number of so few digits, is that one: a drum that people have ordered."""
_ROUNDING = 1e-9
"""What rounding in the file may do to a modulus, as a part of it."""
_TURNS = 6
"""How often a modulus is measured by the command, each time a turn further on by the modulus found before."""
_PERIODIC = 1e-5
"""Doubt of a modulus measured by the command, as a part of it, beyond which the motion is not periodic."""
_GEARED, _FOLLOWS, _PLAIN_GEAR, _TEETH = 0.15, 0.05, 1e-3, 24
"""How far a ratio of actual position to command is from 1 to be a gear, what may be left of the actual position, how well a plain
ratio is met, and what its two numbers come to at most."""
_SHOWN = {"m": (1e3, "mm"), "rad": (180.0 / math.pi, "deg")}


def unwrapped(trace: Trace, place: str, known: Sequence[float] = (), known_master: Sequence[float] = ()) -> Trace:
    """Take out the jumps of an axis that is recorded modulo its turn or its pitch.

    A jump is a step that covers `_JUMP` of the signal's range and is far beyond the usual step. The step that the motion makes there is
    that of the parabola through the steps beside it; how well these tell it is found at all other rows. All jumps must be one and the
    same modulus: one that is known, else the plainest number (in mm or deg), within what the jumps leave open.

    Parameters
    ----------
    trace
        The recording.
    place
        What messages begin with.
    known
        Moduli (unit of the trace) that the machine has.
    known_master
        The same of the master (its unit).

    Raises
    ------
    InputError
        Jumps that are no one modulus.
    """
    step = trace.step, trace.start
    command, first = without_jumps(trace.command, trace.unit, step, f"{place}: the command", known)
    both = known if first is None else (*known, first)  # the command has the less noise
    actual, second = without_jumps(trace.actual, trace.unit, step, f"{place}: the actual position", both)
    if first is None and second is not None:
        second = _by_command(trace, command, actual, second)
        actual, second = without_jumps(
            trace.actual, trace.unit, step, f"{place}: the actual position", (*known, second)
        )
    told = [("command", first, trace.unit), ("actual position", second, trace.unit)]
    if second is not None and first in (
        None,
        second,
    ):  # it turns over by itself, so whole turns between them mean nothing
        actual = actual - second * round(float(np.mean(actual - command)) / second)
    master = trace.master
    if master is not None:
        master, third = without_jumps(master, trace.master_unit, step, f"{place}: the master", known_master)
        told.append(("master", third, trace.master_unit))
    notes = list(trace.notes)
    for name, modulus, counted in told:
        if modulus is not None:
            factor, unit = _SHOWN[counted]
            notes.append(f"the {name} is recorded modulo {modulus * factor:.10g} {unit} and was unwrapped")
    return replace(trace, command=command, actual=actual, master=master, notes=tuple(notes))


def geared(trace: Trace, place: str) -> Trace:
    """Take off the gear of an axis that runs on: its position is in another ratio to the command than 1.

    Where the command comes back there is none to be told from an axis that does not keep up.

    Raises
    ------
    InputError
        The ratio is that of no plain gear.
    """
    command, actual = trace.command, trace.actual
    if len(command) < 2 * _AROUND or abs(float(command[-1] - command[0])) < 0.5 * float(np.ptp(command)):
        return trace
    columns = np.stack([command - command.mean(), np.gradient(command), np.ones_like(command)], axis=1)
    found, *_ = np.linalg.lstsq(columns, actual, rcond=None)
    ratio = float(found[0])
    left = float(np.std(actual - columns @ found))
    if not (ratio > 0.0 and abs(ratio - 1.0) > _GEARED and left <= _FOLLOWS * float(np.std(actual))):
        return trace
    gears = {Fraction(p, q) for p in range(1, _TEETH) for q in range(1, _TEETH - p + 1)}
    near = [gear for gear in gears if abs(float(gear) / ratio - 1.0) <= _PLAIN_GEAR]
    if not near and 0.5 < ratio < 2.0:
        return trace  # an axis that does not keep up may look so; what the fit says of it is told
    if not near:
        raise InputError(
            f"{place}: the actual position moves {ratio:.5g} times as far as the command; divide the column by the gear, or the unit, "
            "between them"
        )
    plain = min(near, key=lambda gear: gear.numerator + gear.denominator)
    note = f"the actual position moves {plain} times as far as the command: that gear was taken off"
    return replace(trace, actual=actual / float(plain), notes=(*trace.notes, note))


def _by_command(trace: Trace, command: FloatArray, actual: FloatArray, modulus: float) -> float:
    """Measure the modulus of an actual position by a command that is recorded without: a turn later both are where they were.

    The modulus found is given where the command does not run on, or not periodically.
    """
    if not (np.diff(command) > 0.0).all() or command[-1] - command[0] < 1.5 * modulus:
        return modulus
    error, better, doubt = actual - command, modulus, math.inf
    for _ in range(_TURNS):  # what is compared lies a turn further on, so far as that is known
        at = command[command <= command[-1] - better]
        gained = np.interp(at + better, command, error) - error[: len(at)]
        doubt = float(np.std(gained)) / math.sqrt(len(gained))
        better = modulus - float(gained.mean())
    return _plainest(better, _SURE * doubt, trace.unit, ()) if doubt < _PERIODIC * modulus else modulus


def without_jumps(
    signal: FloatArray, unit: str, clock: tuple[float, float], name: str, known: Sequence[float] = ()
) -> tuple[FloatArray, float | None]:
    """Unwrap one signal.

    Parameters
    ----------
    signal
        Positions (m or rad).
    unit
        Which of these.
    clock
        Time between two rows, and time of the first (s), for messages.
    name
        What messages call it.
    known
        Moduli that it may have.

    Returns
    -------
    (signal, modulus)
        The modulus is ``None`` where nothing jumps.

    Raises
    ------
    InputError
        Jumps that are no one modulus.
    """
    steps = np.diff(signal)
    moving = np.abs(steps[steps != 0.0])
    if len(moving) < 2 * _AROUND:
        return signal, None
    usual = float(np.median(moving))
    jumps = np.flatnonzero((np.abs(steps) > _JUMP * float(np.ptp(signal))) & (np.abs(steps) > _USUAL * usual))
    if not len(jumps):
        return signal, None
    smooth = np.ones(len(steps), dtype=bool)
    smooth[jumps] = False
    expected, doubt = _expected(steps, smooth, jumps)
    sizes = expected - steps[jumps]
    found = np.abs(sizes)
    middle = float(np.median(found))
    odd = np.abs(found - middle) > max(_ODD * doubt, 0.02 * usual, 1e-6 * middle)
    if odd.any():
        row = int(jumps[int(np.argmax(odd))])
        factor, shown = _SHOWN[unit]
        raise InputError(
            f"{name} jumps by {steps[row] * factor:.6g} {shown} at {clock[1] + row * clock[0]:.6g} s, which is no "
            f"modulus of an axis (others jump by {middle * factor:.6g} {shown}); record without a reset of the position"
        )
    mean = float(found.mean())
    modulus = _plainest(mean, _SURE * doubt + _ROUNDING * mean, unit, known)
    turns = np.zeros(len(signal))
    turns[jumps + 1] = np.sign(sizes)
    return signal + modulus * np.cumsum(turns), modulus


def _expected(steps: FloatArray, smooth: NDArray[np.bool_], jumps: NDArray[np.intp]) -> tuple[FloatArray, float]:
    """Say what step the motion makes at the jumps, by the parabola through the steps beside it, and how far that is off (rms)."""
    beside = np.array([k for k in range(-_AROUND, _AROUND + 1) if k], dtype=np.float64)
    weights = np.linalg.pinv(np.stack([np.ones_like(beside), beside, beside**2], axis=1))[0]
    taps = np.concatenate([weights[:_AROUND], [0.0], weights[_AROUND:]])  # symmetric: a convolution reads it either way
    by_parabola = _folded(steps, taps)
    whole = _folded(smooth.astype(float), (np.abs(taps) > 0.0).astype(float)) > 2 * _AROUND - 0.5
    sure = whole & smooth
    # without rows beside it all there is are the nearest steps
    # an axis turns over at the same places again and again, so what counts is how well the parabola does beside the jumps
    beside_jumps = sure & (_folded((~smooth).astype(float), np.ones(2 * _NEARBY + 1)) > 0.5)
    judged = beside_jumps if beside_jumps.any() else sure
    doubt = (
        float(np.sqrt(np.mean((by_parabola - steps)[judged] ** 2))) if judged.any() else float(np.std(steps[smooth]))
    )
    expected = np.empty(len(jumps))
    for number, jump in enumerate(jumps.tolist()):
        near = [k for k in range(max(jump - _AROUND, 0), min(jump + _AROUND + 1, len(steps))) if smooth[k]]
        expected[number] = by_parabola[jump] if whole[jump] else float(np.mean(steps[near])) if near else 0.0
        doubt = doubt if whole[jump] or len(jumps) > 1 else max(doubt, float(np.ptp(steps[near])) if near else 0.0)
    return expected, doubt


def _folded(signal: FloatArray, taps: FloatArray) -> FloatArray:
    """Fold a signal with an odd number of taps around each row; as many values as rows, however few these are."""
    half = len(taps) // 2
    return np.asarray(np.convolve(signal, taps)[half : half + len(signal)])


def _plainest(value: float, slack: float, unit: str, known: Sequence[float]) -> float:
    """Give what is known, else the part of a turn in rad or the number of fewest digits in mm or deg, within the slack."""
    near = [each for each in known if abs(each - value) <= max(slack, _PLAIN * value)]
    if near:
        return min(near, key=lambda each: abs(each - value))
    factor = _SHOWN[unit][0]
    if unit == "rad":
        parts = round(2.0 * math.pi / value) if value < 2.0 * math.pi * 1.01 else 0
        if parts and abs(2.0 * math.pi / parts - value) <= slack:
            return 2.0 * math.pi / parts
    for digits in range(1, 15):
        plain = float(f"{value * factor:.{digits}g}") / factor
        if abs(plain - value) <= max(slack, _PLAIN * value if digits <= _FEW else 0.0):
            return plain
    return value
