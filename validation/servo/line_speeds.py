"""The sync error in the shear zone over line speed: one cam, its servo, and a line that runs slower or faster."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.servo import Servo, spectral_radius
from camwright.profiles.task import Task
from camwright.validation.motion import require_period
from camwright.validation.servo.axis_run import AxisRun
from camwright.validation.servo.lifting import BLOCK, lift, lift_side_by_side, loops_of
from camwright.validation.servo.monte_carlo import FEW_PHASES, shear_zone_errors
from camwright.validation.servo.response import shear_zone_peaks
from camwright.validation.servo.simulation import PHASES, WHOLE_PART, memory, simulate_part

_VALUES = 2**16
"""Command values that are held at a time: what a processor has at hand."""

_ALIKE = 0.8
"""Line speeds are run side by side whose samples are no fewer than this share of the most."""

_NEAR = 0.75
"""Share of the greatest sync error at few sampling phases from which on all are looked at."""


def line_speed_errors(
    profile: CamProfile,
    task: Task,
    servos: Sequence[Servo],
    line_speeds: FloatArray,
    phases: int = PHASES,
    zones: tuple[FloatArray, FloatArray] | None = None,
    asked: NDArray[np.bool_] | None = None,
) -> FloatArray:
    """Greatest sync error in the shear zone at each line speed, over all sampling phases.

    The cam is fixed over the master, the servo in time. Only the shear zone is simulated, and before it what the servo remembers. The
    matrices of the servos are made once and serve every line speed; all are run side by side.

    Parameters
    ----------
    profile
        One cycle over the master period ``[0, x_c]``.
    task
        As in `camwright.validation.servo.response.servo_response`; the cut's own line speed does not matter.
    servos
        The servos as they are, dead time and lead included.
    line_speeds
        Line speeds above 0 (m/s), shape ``(n,)``.
    zones
        Beginning, from the start of the sync zone, and length of what is looked at with each line speed (m), shapes ``(n,)``; the shear
        zone if not given.
    asked
        Which servos are looked at with which line speeds, shape ``(servos, n)``; all if not given.

    Returns
    -------
    ndarray
        Greatest magnitude of the sync error (m), infinite for a servo that is unstable or not asked for; shape ``(servos, n)``.

    Raises
    ------
    InputError
        The profile does not run over ``[0, x_c]``.
    """
    cut = task.cut
    require_period(profile, cut)
    speeds = np.asarray(line_speeds, dtype=np.float64)
    found = np.full((len(servos), len(speeds)), np.inf)
    asked = np.ones(found.shape, dtype=bool) if asked is None else asked
    stable = [row for row, servo in enumerate(servos) if asked[row].any() and spectral_radius(servo) < 1.0]
    if not stable or not len(speeds):
        return found
    kept, asked = [servos[row] for row in stable], asked[stable]
    past = max(memory(servo.loop) for servo in kept)
    # one servo may be found lifted by another call
    lifted = (
        lift(kept[0].loop, past, (1, 0)) if len(kept) == 1 else lift_side_by_side(loops_of(kept), past, (1, 0), BLOCK)
    )
    at, length = zones or (np.full(len(speeds), zone) for zone in (cut.shear_zone_at, cut.shear_zone))
    samples = past + length / (speeds * min(servo.sample_time for servo in kept))
    slow = samples > WHOLE_PART
    for column in np.nonzero(slow)[0].tolist():
        zone = replace(cut, shear_zone_at=float(at[column]), shear_zone=float(length[column]))
        slower = task.with_cut(zone).at_speed(float(speeds[column]))
        for row in np.nonzero(asked[:, column])[0].tolist():
            found[stable[row], column] = shear_zone_errors(profile, slower, [kept[row]], phases)[0]
    start = cut.return_start + cut.return_zone
    begin, end = start + at, start + np.minimum(at + length, cut.sync_zone)
    quick = np.nonzero(~slow & asked.any(axis=0))[0]
    for group in _groups(samples[quick], _VALUES / (phases * len(kept))):
        columns = quick[group]
        rows, at_columns = np.nonzero(asked[:, columns])
        of_each = columns[at_columns]
        part = begin[of_each], end[of_each]
        every = lifted if len(kept) == 1 else lifted.take(rows)
        many = [kept[row] for row in rows.tolist()]
        master, (ratio, axis) = simulate_part(profile, cut, many, every, part, phases, speeds[of_each])
        peaks = shear_zone_peaks(AxisRun(master, axis, ratio), profile, task, len(rows), part)
        found[np.array(stable)[rows], of_each] = peaks
    return found


def worst_line_speed_error(profile: CamProfile, task: Task, servos: Sequence[Servo], line_speeds: FloatArray) -> float:
    """Greatest sync error over servos and line speeds (m): the greatest of `line_speed_errors`, whose arguments these are.

    At all line speeds a few sampling phases are looked at, all phases where that comes near the greatest.
    """
    few = line_speed_errors(profile, task, servos, line_speeds, FEW_PHASES)
    if not np.isfinite(few).all():
        return math.inf
    near = few >= _NEAR * few.max()
    speeds = np.asarray(line_speeds, dtype=np.float64)
    return max(
        float(line_speed_errors(profile, task, [servo], speeds[columns]).max())
        for servo, columns in zip(servos, near, strict=True)
        if columns.any()
    )


def _groups(samples: FloatArray, most: float) -> Iterator[NDArray[np.intp]]:
    """Divide line speeds into groups that are run side by side, by the samples of each: about as many, and not too many together."""
    order = np.argsort(-samples, kind="stable")
    while len(order):
        longest = float(samples[order[0]])
        alike = int((samples[order] > _ALIKE * longest).sum())
        size = max(1, min(alike, int(most / longest)))
        yield order[:size]
        order = order[size:]
