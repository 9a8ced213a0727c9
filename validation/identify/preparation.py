"""A recording made fit for a fit: a modulo axis unwrapped."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import FloatArray
from camwright.profiles.trace import Trace

_JUMP = 0.4
"""Part of a signal's range that one step must cover to be a jump."""
_USUAL = 8.0
"""By how many times a jump exceeds the usual step."""
_AROUND = 4
"""Rows on either side by which the step at a jump is estimated."""
_SHOWN = {"m": (1e3, "mm"), "rad": (180.0 / math.pi, "deg")}


def unwrapped(trace: Trace, place: str) -> Trace:
    """Take out the jumps of an axis that is recorded modulo its turn or its pitch.

    A jump is a step that covers `_JUMP` of the signal's range and is far beyond the usual step. All jumps must be one and
    the same modulus, the plainest number (in mm or deg) within what the motion beside the jumps leaves open.

    Raises
    ------
    InputError
        Jumps that are no one modulus.
    """
    command, first = _without_jumps(trace.command, trace, "command", place)
    actual, second = _without_jumps(trace.actual, trace, "actual position", place)
    notes = list(trace.notes)
    factor, unit = _SHOWN[trace.unit]
    for name, modulus in (("command", first), ("actual position", second)):
        if modulus is not None:
            notes.append(f"the {name} is recorded modulo {modulus * factor:.10g} {unit} and was unwrapped")
    if first is not None and first == second:  # both turn over by themselves, so whole turns between them mean nothing
        actual = actual - first * round(float(np.mean(actual - command)) / first)
    return replace(trace, command=command, actual=actual, notes=tuple(notes))


def _without_jumps(signal: FloatArray, trace: Trace, name: str, place: str) -> tuple[FloatArray, float | None]:
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
    sizes = []
    for jump in jumps.tolist():
        near = [k for k in range(max(jump - _AROUND, 0), min(jump + _AROUND + 1, len(steps))) if smooth[k]]
        sizes.append(float(np.mean(steps[near])) - float(steps[jump]) if near else -float(steps[jump]))
    found = np.abs(sizes)
    middle = float(np.median(found))
    odd = np.abs(found - middle) > max(2.0 * usual, 1e-6 * middle)
    if odd.any():
        row = int(jumps[int(np.argmax(odd))])
        factor, unit = _SHOWN[trace.unit]
        raise InputError(
            f"{place}: the {name} jumps by {steps[row] * factor:.6g} {unit} at {trace.start + row * trace.step:.6g} s, which is no "
            f"modulus of an axis (others jump by {middle * factor:.6g} {unit}); record without a reset of the position"
        )
    modulus = _plainest(middle, usual / max(1.0, math.sqrt(len(jumps))), trace)
    turns = np.zeros(len(signal))
    turns[jumps + 1] = np.sign(sizes)
    return signal + modulus * np.cumsum(turns), modulus


def _plainest(value: float, slack: float, trace: Trace) -> float:
    """Give the number of fewest digits in mm or deg, or the part of a turn in rad, within the slack."""
    factor = _SHOWN[trace.unit][0]
    if trace.unit == "rad":
        parts = round(2.0 * math.pi / value) if value < 2.0 * math.pi * 1.01 else 0
        if parts and abs(2.0 * math.pi / parts - value) <= slack:
            return 2.0 * math.pi / parts
    for digits in range(1, 15):
        plain = float(f"{value * factor:.{digits}g}") / factor
        if abs(plain - value) <= slack:
            return plain
    return value
