"""The servos of a job: the nominal one, and those that its ranges leave possible."""

from __future__ import annotations

from camwright.jobs.job import Job
from camwright.profiles.servo import Servo


def servos_of(job: Job) -> tuple[Servo, ...]:
    """Servos with which a servo-aware design must keep the tolerance: the nominal one, then the corners of its ranges."""
    if job.servo_tolerance is None or not job.servo_tolerance.varying:
        return (job.servo,)
    return (job.servo, *job.servo_tolerance.vertices(job.servo))


def between_of(job: Job) -> tuple[Servo, ...]:
    """Servos between the corners of a job's ranges, which a servo-aware design looks at too."""
    return () if job.servo_tolerance is None else job.servo_tolerance.between(job.servo)
