"""The servo response over the published ranges of the servo's parameters."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import product

from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.servo import PAPER_RANGES, Servo, spectral_radius
from camwright.profiles.task import Task
from camwright.validation.servo.response import ServoResponse, servo_response


@dataclass(frozen=True)
class SweepCase:
    """One servo of the sweep and its response, ``None`` if this servo is unstable."""

    servo: Servo
    response: ServoResponse | None


@dataclass(frozen=True)
class Sweep:
    """Responses at the corners of the ranges and, last, at their centre."""

    cases: tuple[SweepCase, ...]

    @property
    def responses(self) -> tuple[ServoResponse, ...]:
        """Responses of the stable servos."""
        return tuple(case.response for case in self.cases if case.response is not None)

    @property
    def settling(self) -> tuple[float | None, float | None]:
        """Best and worst settling length of the stable servos (m), ``None`` for none in the sync zone."""
        found = [response.settling for response in self.responses]
        settled = [length for length in found if length is not None]
        best = min(settled, default=None)
        worst = max(settled) if settled and len(settled) == len(found) else None
        return best, worst

    @property
    def shear_zone_error(self) -> tuple[float | None, float | None]:
        """Best and worst shear zone error of the stable servos (m); ``None`` if none is stable."""
        found = [response.shear_zone_error for response in self.responses]
        return min(found, default=None), max(found, default=None)


def sweep_servos(servo: Servo) -> tuple[Servo, ...]:
    """Servos at all corners of `camwright.profiles.servo.PAPER_RANGES` and, last, at the centre.

    Parameters
    ----------
    servo
        Gives what no range is published for: velocity feed-forward, dead time and lead.
    """
    names = tuple(PAPER_RANGES)
    centre = tuple(0.5 * (low + high) for low, high in PAPER_RANGES.values())
    points = (*product(*PAPER_RANGES.values()), centre)
    return tuple(replace(servo, **dict(zip(names, point, strict=True))) for point in points)


def servo_sweep(profile: CamProfile, task: Task, servo: Servo) -> Sweep:
    """Simulate the profile on every servo of the published ranges.

    Parameters
    ----------
    profile, task
        As in `camwright.validation.servo.response.servo_response`.
    servo
        Gives what no range is published for.
    """
    return Sweep(
        tuple(
            SweepCase(each, servo_response(profile, task, each) if spectral_radius(each) < 1.0 else None)
            for each in sweep_servos(servo)
        )
    )
