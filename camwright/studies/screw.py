"""`ScrewCarriage`: a crank's cut done by a carriage on a screw, the comparison that S3 makes."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from camwright.design.optimise import solve
from camwright.jobs.job import Job
from camwright.profiles.errors import InputError
from camwright.profiles.limits import Limits
from camwright.profiles.machines import Machine
from camwright.profiles.objective import of_command
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.task import Task
from camwright.studies.measured import Measured, measured

SCREW = "screw_carriage"
"""Name of the carriage's profile among the measured profiles."""

_ROOM = 1e-6
"""Share by which the carriage's limits exceed what the crank's carriage reaches, so that a motion at the limits is not lost to rounding."""

_STANDING = 1e-9
"""Ratio, relative to the greatest, below which a carriage stands: rounding is no reversal."""

_GRID = 20_001


@dataclass(frozen=True, eq=False)
class ScrewCarriage:
    """The carriage on a screw beside the crank that it is compared with.

    Parameters
    ----------
    limits
        What it may reach: the greatest speed, acceleration and jerk of the crank's carriage (m).
    row
        Its optimal cycle and measures, for the same cut, objective and servo.
    crank
        The crank's optimal cycle and measures.
    reversals
        How often its motor turns back in one cycle.
    heating
        RMS torque of its motor over that of the crank's.
    """

    machine: Machine
    limits: Limits
    row: Measured
    crank: Measured
    reversals: int
    heating: float

    @property
    def sentence(self) -> str:
        """What is compared, what is equal, and the outcome."""
        own, crank = self.row.motor, self.crank.motor
        lead = 2 * math.pi / self.machine.motor_ratio
        return (
            f"{SCREW}: the same carriage on a screw of {lead * 1e3:.4g} mm lead, with the stroke, the greatest "
            f"motor speed and the limits of carriage speed, acceleration and jerk that the crank's optimum reaches, screw and motor "
            f"without inertia: {self.reversals} reversals a cut and {own.rms_torque:.4g} N m RMS against none and "
            f"{crank.rms_torque:.4g} N m of the crank ({self.heating:.3g} times)"
        )


def require_screw(job: Job) -> None:
    """Refuse a machine that has no equal on a screw, before anything is solved.

    Raises
    ------
    InputError
        The machine is no crank, or its carriage has no mass.
    """
    if job.machine.on_screw(1.0, 1.0) is None:
        raise InputError(
            "--screw: only a crank whose carriage has a mass has an equal on a screw; leave it out, or give [machine] carriage_mass"
        )


def screw_carriage(job: Job, crank: Measured) -> ScrewCarriage:
    """Optimise the screw-driven carriage that does a crank's cut.

    Equal are: cut, objective, servo, mass of the carriage, stroke, greatest speed of the motor; and the greatest speed, acceleration and
    jerk of the crank's carriage are the limits of the screw's.

    Parameters
    ----------
    job
        A job, its machine with everything that the design chose.
    crank
        Its optimal cycle, measured.

    Returns
    -------
    ScrewCarriage
        The carriage beside the crank.

    Raises
    ------
    InputError
        There is nothing to compare: the machine has no equal on a screw, acceleration or jerk of the crank's carriage are unbounded, or
        motors do nothing.
    InfeasibleError
        A carriage on a screw cannot do the cut within these limits.
    """
    require_screw(job)
    machine, tool = job.machine, crank.tool
    if tool.peak_acceleration is None or tool.peak_jerk is None or not crank.motor.rms_torque:
        raise InputError(
            "--screw: the crank's cycle gives no limits to compare with: its acceleration or jerk is unbounded, or it needs no torque; "
            "give [limits] jerk"
        )
    room = 1 + _ROOM
    limits = Limits(tool.peak_speed * room, tool.peak_acceleration * room, tool.peak_jerk * room, reversal=True)
    motor_speed = crank.motor.peak_speed
    first = machine.on_screw(tool.peak_speed, motor_speed)
    assert first is not None  # noqa: S101 - required above
    profile = solve(Task(first, job.cut, limits), of_command(job.objective)).profile
    # the motion of a carriage does not depend on the lead: it is chosen last, by the speed that the carriage reaches
    screw = machine.on_screw(job.cut.line_speed * _greatest_ratio(profile), motor_speed) or first
    row = measured(SCREW, profile, replace(job, machine=screw, limits=limits))
    assert row.motor.rms_torque is not None  # noqa: S101 - its carriage has a mass
    heating = row.motor.rms_torque / crank.motor.rms_torque
    return ScrewCarriage(screw, limits, row, crank, reversals(profile), heating)


def reversals(profile: CamProfile) -> int:
    """Count how often a cycle turns back, the seam included."""
    x: FloatArray = np.linspace(profile.start, profile.end, _GRID)
    ratio = profile(x, 1)
    signs = np.sign(ratio[np.abs(ratio) > _STANDING * np.abs(ratio).max()])
    return int(np.count_nonzero(signs != np.roll(signs, 1)))


def _greatest_ratio(profile: CamProfile) -> float:
    """Greatest magnitude of the ratio."""
    least, greatest = profile.extrema(1)
    return max(-least.value, greatest.value)
