"""What to expect at shares of the line speed: the same cam over the master, the servo simulated at each speed."""

from __future__ import annotations

from camwright.jobs.job import Job
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.servo import spectral_radius
from camwright.recipes.model import AtSpeed
from camwright.validation.motion import measure_motion
from camwright.validation.motor import measure_motor
from camwright.validation.report import ValidationReport
from camwright.validation.servo.response import servo_response


def at_speeds(profile: CamProfile, job: Job, report: ValidationReport) -> tuple[AtSpeed, ...]:
    """Measure a cam at 10, 25, 50 and 100 % of the line speed.

    Over time the speed goes with the line speed, the acceleration with its square, the jerk with its cube; what the servo makes of
    it follows no such law and is simulated.

    Parameters
    ----------
    job
        The job, its machine with everything that the design chose.
    report
        Its validation, which has the servo's response at full line speed and where the cut falls.
    """
    stable = spectral_radius(job.servo) < 1.0
    rows = []
    errors = {error.share: error for error in report.length_errors}
    for share in SHARES:
        task = job.task.at_speed(share * job.cut.line_speed)
        motion, motor = measure_motion(profile, task), measure_motor(profile, task)
        response = report.servo if task == job.task or not stable else servo_response(profile, task, job.servo)
        error = errors.get(share)
        rows.append(
            AtSpeed(
                share=share,
                line_speed=task.cut.line_speed,
                speed=motion.peak_speed,
                acceleration=motion.peak_acceleration,
                jerk=motion.peak_jerk,
                motor_speed=motor.peak_speed,
                peak_torque=motor.peak_torque,
                rms_torque=motor.rms_torque,
                following_error=response.peak_following_error if response else None,
                sync_error=response.shear_zone_error if response else None,
                length_offset=error.offset if error else None,
                length_offset_with_lead=error.offset_with_lead if error else None,
                length_variation=error.variation if error else None,
            )
        )
    return tuple(rows)


SHARES = (0.1, 0.25, 0.5, 1.0)
"""Shares of the line speed at which a machine is commissioned."""
