"""`Measured`: one profile of a job and what its machine, motor and servo make of it."""

from __future__ import annotations

from dataclasses import dataclass

from camwright.jobs.job import Job
from camwright.jobs.servos import servos_of
from camwright.profiles.objective import OBJECTIVES, ObjectiveName
from camwright.profiles.polynomial.profile import CamProfile
from camwright.studies.axis_study import greatest_sync_error
from camwright.studies.within_limits import keeps_limits
from camwright.validation.motion import MotionMeasures, measure_motion, measure_tool
from camwright.validation.motor import MotorMeasures, measure_motor
from camwright.validation.servo.response import ServoResponse, servo_response


@dataclass(frozen=True, eq=False)
class Measured:
    """A profile and its measures.

    Parameters
    ----------
    name
        ``"optimised"`` or the name of a baseline.
    motion
        Measures of the slave's motion at line speed (slave unit).
    tool
        Measures of the tool's motion (m): the same where the slave is counted in metres.
    motor
        What the motor must give.
    response
        What the servo makes of it.
    within_limits
        Whether it keeps the limits of the job.
    worst_error
        Greatest sync error in the shear zone with the job's servo and at the corners of its ranges (m); ``None`` if the job gives none.
    """

    name: str
    profile: CamProfile
    motion: MotionMeasures
    tool: MotionMeasures
    motor: MotorMeasures
    response: ServoResponse
    within_limits: bool
    worst_error: float | None

    def value(self, objective: ObjectiveName) -> float | None:
        """Give what a job makes least, of this profile; ``None`` where it is unbounded."""
        of = OBJECTIVES[objective].of
        if of == "axis":
            return self.response.shear_zone_error if self.worst_error is None else self.worst_error
        found: float | None = getattr(self.motor if of == "motor" else self.motion, objective)
        return found


def measured(name: str, profile: CamProfile, job: Job) -> Measured:
    """Measure one cycle of a job's machine.

    Parameters
    ----------
    name
        What it is called among the measured profiles.
    job
        Its job, the place of the sync zone chosen.
    """
    motion = measure_motion(profile, job.task)
    return Measured(
        name,
        profile,
        motion,
        measure_tool(profile, job.task, motion),
        measure_motor(profile, job.task),
        servo_response(profile, job.task, job.servo),
        keeps_limits(profile, motion, job),
        greatest_sync_error(profile, job) if len(servos_of(job)) > 1 else None,
    )
