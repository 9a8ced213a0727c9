"""The sync error in the shear zone over many servos at once: what a cam still does when the servo is not quite the one assumed."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.servo import Servo, spectral_radius
from camwright.profiles.task import Task
from camwright.validation.motion import require_period
from camwright.validation.servo.lifting import SUBSTEPS, lift_side_by_side, loops_of
from camwright.validation.servo.response import shear_zone_of, shear_zone_peaks, slow_sync_error, worst_place
from camwright.validation.servo.simulation import PHASES, WHOLE_PART, memories_at, shear_zone_run

_VALUES = 2**17
"""Command values that are held at a time."""


FEW_PHASES = 4
"""Sampling phases at which much is looked at first; some of all that count."""

_ROUGHLY = 2, 2, 1e-6
"""Sampling phases and points of a sample at which all servos are looked at first, and the part to which they then forget their past."""

_LOOKED, _LOOKED_SLOW = 64, 8
"""Servos that are run at all phases, in the whole shear zone, at first; fewer on a slow line. Twice as many each time."""

_SHOWING = 8
"""Servos that show where in the shear zone others may be worst."""

_ABOUT = 8
"""Samples about such a place that are looked at."""

_LONG = 16
"""Shear zone, as a multiple of `_ABOUT`, up to which all of it is looked at."""

_SAME = 1e-12
"""Share of the cut length by which errors differ that are the same: what the closed form leaves of its digits."""


def shear_zone_errors(profile: CamProfile, task: Task, servos: Sequence[Servo], phases: int = PHASES) -> FloatArray:
    """Greatest sync error in the shear zone of every servo, over all sampling phases.

    The figure of `camwright.validation.servo.response.ServoResponse.shear_zone_error`, of many servos: nothing but the servo's memory
    and the shear zone
    is simulated, many servos side by side.

    Parameters
    ----------
    profile
        One cycle over the master period ``[0, x_c]``.
    task
        As in `camwright.validation.servo.response.servo_response`.
    servos
        The servos, e.g. of `camwright.profiles.servo_tolerance.ServoTolerance.draw`.
    phases
        Sampling phases, a multiple of 16 to compare with the response of one servo; at most `SUBSTEPS` in closed form, as for that.

    Returns
    -------
    ndarray
        Greatest magnitude of the sync error (m), infinite for a servo that is unstable; shape ``(servos,)``.

    Raises
    ------
    InputError
        The profile does not run over ``[0, x_c]``.
    """
    return _greatest_errors(profile, task, servos, phases, SUBSTEPS)


def _greatest_errors(
    profile: CamProfile, task: Task, servos: Sequence[Servo], phases: int, parts: int, forgotten: float | None = None
) -> FloatArray:
    """As `shear_zone_errors`, at so many points of a sample, a servo's past forgotten to a part of itself."""
    require_period(profile, task.cut)
    found = np.full(len(servos), np.inf)
    if not len(servos):
        return found
    loops = loops_of(servos, parts)
    radii = np.abs(np.linalg.eigvals(loops.closed())).max(axis=1)
    past = memories_at(radii)
    travel = task.cut.line_speed * np.array([servo.sample_time for servo in servos])
    within = np.ceil(task.cut.shear_zone / travel).astype(np.intp)
    for i in np.nonzero((past > 0) & (past + within > WHOLE_PART))[0].tolist():
        closed = slow_sync_error(profile, task, servos[i], *shear_zone_of(task.cut), min(phases, SUBSTEPS))
        if closed is not None:
            found[i], past[i] = closed, 0
    if forgotten is not None:
        past = np.where(past > 0, memories_at(radii, forgotten), 0)
    for group in _groups(past, within, phases):
        lifted = lift_side_by_side(loops.take(group), int(past[group].max()), (1, 0))
        run = shear_zone_run(profile, task.cut, [servos[i] for i in group.tolist()], lifted, phases)
        found[group] = shear_zone_peaks(run, profile, task, len(group))
    return found


def worst_shear_zone_error(profile: CamProfile, task: Task, servos: Sequence[Servo]) -> float:
    """Greatest sync error in the shear zone over many servos and all sampling phases (m): the greatest of `shear_zone_errors`.

    All servos are run roughly, on a slow line about a few places only, then the worst in full: until the next one, and twice what
    more phases, points and places have added to any, stay below the greatest. A sixth of the time, a hundredth on a slow line. Arguments
    as in `shear_zone_errors`.
    """
    parts = _shown_parts(profile, task, servos)
    few = np.max([_greatest_errors(profile, part, servos, *_ROUGHLY) for part in parts], axis=0)
    order, step = np.argsort(-few, kind="stable"), _LOOKED if parts == [task] else _LOOKED_SLOW
    worst, added, first = 0.0, 0.0, 0
    while first < len(order):
        looked = order[first : first + step]
        if not np.isfinite(few[looked[0]]):
            return math.inf
        if first and few[looked[0]] + 2.0 * added <= worst + _SAME * task.cut.length:
            break
        found = shear_zone_errors(profile, task, [servos[row] for row in looked.tolist()])
        worst, added = max(worst, float(found.max())), max(added, float((found - few[looked]).max()))
        first += step
        step *= 2
    return worst


def _shown_parts(profile: CamProfile, task: Task, servos: Sequence[Servo]) -> list[Task]:
    """Give the task with parts of its shear zone, where that has too many samples: about its ends, and where some servos are worst."""
    cut = task.cut
    about = _ABOUT * cut.line_speed * max((servo.sample_time for servo in servos), default=0.0)
    if cut.shear_zone <= _LONG * about:
        return [task]
    start, end = shear_zone_of(cut)
    stable = (servo for servo in servos if spectral_radius(servo) < 1.0)
    shown = (worst_place(profile, task, servo) for servo in islice(stable, _SHOWING))
    zone, parts, last = cut.return_start + cut.return_zone, [], -math.inf
    for place in sorted([start, 0.5 * (start + end), end, *shown]):
        if place - about > last:
            begin, last = max(start, place - about), min(end, place + about)
            parts.append(task.with_cut(replace(cut, shear_zone_at=begin - zone, shear_zone=last - begin)))
    return parts


def _groups(past: NDArray[np.intp], within: NDArray[np.intp], phases: int) -> Iterator[NDArray[np.intp]]:
    """Divide servos into groups that fit, those with the most samples first; gives their places.

    Parameters
    ----------
    past, within
        Samples that each servo remembers, 0 for one that is left out, and samples in the shear zone.
    phases
        Sampling phases.
    """
    order = np.lexsort((-past, -within))
    order = order[past[order] > 0]
    longest = int(past.max(initial=0))
    while len(order):
        size = max(1, _VALUES // (phases * (longest + int(within[order[0]]))))
        yield order[:size]
        order = order[size:]
