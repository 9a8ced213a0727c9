"""Several servos simulated side by side, about the shear zone only."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from camwright.profiles.cut import Cut
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.servo import Servo, sample_plant
from camwright.validation.servo.lifting import SUBSTEPS
from camwright.validation.servo.simulation import (
    PHASES,
    AxisRun,
    deviation,
    mean_ratio,
    require_samples,
    steady_following_error,
)


def shear_zone_run(
    profile: CamProfile, cut: Cut, servos: Sequence[Servo], plants: FloatArray, past: int, phases: int = PHASES
) -> AxisRun:
    """Simulate several servos about the shear zone, ``phases`` rows a servo.

    Nothing else of the cycle is simulated but what the servos remember.

    As in `camwright.validation.servo.simulation.simulate` phase ``j`` samples ``(j / phases - 1 + k) dT`` after the start of the
    return zone. The first
    sample here is the last that no phase has after the start of the shear zone.

    Parameters
    ----------
    profile, cut
        As in `camwright.validation.servo.simulation.simulate`.
    servos
        Stable servos.
    plants
        Their `sampled_plants`.
    past
        Samples that are remembered, by the servo that remembers most.
    phases
        Sampling phases.

    Raises
    ------
    InputError
        They remember too many samples.
    """
    many = len(servos)
    step = cut.line_speed * np.array([servo.sample_time for servo in servos]) / phases  # from phase to phase
    shift = np.fmod(cut.line_speed * np.array([servo.delay for servo in servos]), cut.length)
    most = math.ceil(cut.shear_zone / (phases * float(step.min()))) + 3
    require_samples(cut, servos[0], past, most)
    first = np.floor((cut.return_zone + cut.shear_zone_at) / (phases * step)) * phases - phases
    index = first[:, None] + np.arange(-past * phases, most * phases)
    grid = cut.return_start + index * step[:, None]
    alike = step.min() == step.max() and shift.min() == shift.max()  # one grid for all
    seen = (grid - shift[:, None])[: 1 if alike else many]
    command = deviation(profile, seen).reshape(-1, past + most, phases)

    gain = np.array([servo.position_gain for servo in servos])[:, None, None]
    lead = np.array([servo.velocity_feedforward / servo.sample_time for servo in servos])[:, None, None]
    loops, held = closed_loops(plants[SUBSTEPS], servos), plants[SUBSTEPS, :, :3, 3:]
    response = _powers(loops, held, past)[:, :, ::-1]
    history = (gain + lead) * response
    history[:, :, :-1] -= lead * response[:, :, 1:]
    state = history @ command[:, :past]
    within = np.empty((many, 4, most, phases))  # state and input of the closed loop at the samples
    for k in range(most):
        now, before = command[:, past + k, None], command[:, past + k - 1, None]
        drive = (gain + lead) * now - lead * before
        within[:, :3, k], within[:, 3:, k] = state, drive
        state = loops @ state + held * drive

    between = plants[:SUBSTEPS, :, 1:3].transpose(1, 2, 0, 3).reshape(many, -1, 4)  # velocity and position
    between[:, :, 2:3] -= gain * between[:, :, 3:]  # the reference is u = f - K p
    points = (between @ within.reshape(many, 4, -1)).reshape(many, 2, SUBSTEPS, most, phases)
    points = points.transpose(1, 0, 4, 3, 2).reshape(2, many * phases, -1)
    starts = grid[:, past * phases : (past + 1) * phases].reshape(-1, 1)
    master = starts + np.repeat(step * (phases / SUBSTEPS), phases)[:, None] * np.arange(most * SUBSTEPS)
    slope = mean_ratio(profile)
    late = np.array([steady_following_error(slope * cut.line_speed, servo) for servo in servos])
    axis = points[1] + (float(profile.coefficients[0, 0]) + slope * (master - profile.start))
    axis -= np.repeat(late, phases)[:, None]
    return AxisRun(master, axis, points[0] / cut.line_speed + slope)


def _powers(loops: FloatArray, start: FloatArray, length: int) -> FloatArray:
    """Powers of matrices times columns: ``A^j b`` for ``j`` = 0 … ``length - 1``, shape ``(servos, 3, length)``."""
    found, power = start, loops
    while found.shape[2] < length:  # twice as many in each round, side by side
        found = np.concatenate([found, power @ found], axis=2)
        power = power @ power
    return found[:, :, :length]


def sampled_plants(servos: Sequence[Servo]) -> FloatArray:
    """Plants on ``(z, u)`` over no time to a whole sample, in `SUBSTEPS` steps: shape ``(SUBSTEPS + 1, servos, 4, 4)``."""
    step = np.zeros((len(servos), 4, 4))
    step[:, 3, 3] = 1.0
    for servo, matrix in zip(servos, step, strict=True):
        plant = sample_plant(servo, servo.sample_time / SUBSTEPS)
        matrix[:3, :3], matrix[:3, 3] = plant.transition, plant.input
    found = np.empty((SUBSTEPS + 1, len(servos), 4, 4))
    found[0] = np.eye(4)
    for point in range(SUBSTEPS):
        found[point + 1] = step @ found[point]
    return found


def closed_loops(plants: FloatArray, servos: Sequence[Servo]) -> FloatArray:
    """Close the loops of plants over a whole sample: ``A`` of `camwright.profiles.servo.closed_loop`, shape ``(servos, 3, 3)``."""
    loops = plants[:, :3, :3].copy()
    loops[:, :, 2] -= plants[:, :3, 3] * np.array([[servo.position_gain] for servo in servos])
    return loops
