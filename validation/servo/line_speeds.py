"""The sync error in the shear zone over line speed: one cam, its servo, and a line that runs slower or faster."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.servo import Servo
from camwright.profiles.task import Task
from camwright.validation.servo.monte_carlo import shear_zone_errors
from camwright.validation.servo.simulation import PHASES


def line_speed_errors(
    profile: CamProfile, task: Task, servos: Sequence[Servo], line_speeds: FloatArray, phases: int = PHASES
) -> FloatArray:
    """Greatest sync error in the shear zone at each line speed, over all sampling phases.

    The cam is fixed over the master, the servo in time. Only the shear zone is simulated, and before it what the servo remembers; all
    line speeds side by side, each as the servo that `camwright.profiles.servo.Servo.at_speed` gives.

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
    phases
        Sampling phases.

    Returns
    -------
    ndarray
        Greatest magnitude of the sync error (m), infinite for a servo that is unstable; shape ``(servos, n)``.

    Raises
    ------
    InputError
        The profile does not run over ``[0, x_c]``.
    """
    shares = (np.asarray(line_speeds, dtype=np.float64) / task.cut.line_speed).tolist()
    scaled = [servo.at_speed(share) for servo in servos for share in shares]
    return shear_zone_errors(profile, task, scaled, phases).reshape(len(servos), len(shares))
