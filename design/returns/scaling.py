"""The normalised return: unit length, unit height, no line. The solver sees nothing else."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from camwright.design.returns.problem import ReturnProblem
from camwright.profiles.closed_forms.reach import least_acceleration
from camwright.profiles.objective import MotionObjective
from camwright.profiles.polynomial.profile import CamProfile

# Limits far beyond what any motion of unit height in unit length needs (2, 8 and 60) are cut off to keep the solver's numbers small.
# They still allow for jobs at the edge of the speed limit, whose motion happens in a small part of the return.
GREATEST_SCALED_SPEED = 1e2
GREATEST_SCALED_ACCELERATION = 1e6
# Peak acceleration of unit height in unit length where nothing but the time is limited.
LEAST_PEAK = 4.0
# A ramp shorter than this share of the return cannot be told from a jump: its ends lie only 1e9 roundings apart. A jerk limit that would
# allow shorter ramps is lowered; the least peak acceleration then grows by this share of the time that the acceleration takes.
SHORTEST_RAMP = 2e-7
# The same between ends with accelerations of their own, which it changes by a small part only: by much shorter ramps.
SHORTEST_CHANGE = 4e-6


@dataclass(frozen=True)
class ScaledProblem:
    """A return over ``[0, 1]``, relative to the line through its start: ``q(xi) = (y(xi L) - y'(0) xi L) / scale``.

    Adding a straight line changes neither acceleration nor jerk, only shifts the speed limits; what is left for a knife is a
    rest-to-rest motion of unit height whatever the job.

    Parameters
    ----------
    height, end_ratio, start_slope, end_slope
        Boundary values: ``q(1)``, ``q'(1)``, ``q''(0)``, ``q''(1)``; ``q(0) = q'(0) = 0``.
    least_ratio, greatest_ratio, greatest_slope, greatest_jerk
        Limits of ``q'``, ``|q''|``, ``|q'''|``.
    drift
        Slope of the line that was taken away: ``q + drift xi`` is the slave's position, in the scaled unit.
    least_position, greatest_position
        Limits of that position.
    """

    height: float
    end_ratio: float
    start_slope: float
    end_slope: float
    least_ratio: float
    greatest_ratio: float
    greatest_slope: float
    greatest_jerk: float
    objective: MotionObjective
    drift: float = 0.0
    least_position: float = -math.inf
    greatest_position: float = math.inf

    @property
    def rest_to_rest(self) -> bool:
        """Whether the motion over the line starts and ends at rest without acceleration."""
        return not (self.end_ratio or self.start_slope or self.end_slope)

    @property
    def confined(self) -> bool:
        """Whether the slave must keep to a stroke."""
        return math.isfinite(self.least_position) or math.isfinite(self.greatest_position)


def motion_scale(problem: ReturnProblem) -> float:
    """Slave travel that becomes 1: the largest deviation from the line that the boundary values ask for; zero if the line will do.

    From rest to rest it is signed so that the height of the scaled problem is positive; elsewhere it is positive.
    """
    length = problem.length
    height = problem.height - problem.start_ratio * length
    ratio = (problem.end_ratio - problem.start_ratio) * length
    start, end = problem.start_slope * length**2, problem.end_slope * length**2
    size = max(abs(height), abs(ratio), abs(start), abs(end))
    return -size if height < 0 and not (ratio or start or end) else size


def scale_problem(problem: ReturnProblem, scale: float) -> ScaledProblem:
    """Normalise a return by its length and by the scale from `motion_scale`."""
    length = problem.length
    least_ratio, greatest_ratio = _scaled_ratios(problem, scale)
    height = (problem.height - problem.start_ratio * length) / scale
    places = sorted((problem.least_position / scale, problem.greatest_position / scale))
    return ScaledProblem(
        height=height,
        end_ratio=(problem.end_ratio - problem.start_ratio) * length / scale,
        start_slope=problem.start_slope * length**2 / scale,
        end_slope=problem.end_slope * length**2 / scale,
        least_ratio=least_ratio,
        greatest_ratio=greatest_ratio,
        greatest_slope=min(problem.greatest_slope * length**2 / abs(scale), GREATEST_SCALED_ACCELERATION),
        greatest_jerk=min(
            problem.greatest_jerk * length**3 / abs(scale), _sharpest(height, greatest_ratio, _shortest(problem))
        ),
        objective=problem.objective,
        drift=problem.start_ratio * length / scale,
        least_position=places[0],
        greatest_position=places[1],
    )


def _scaled_ratios(problem: ReturnProblem, scale: float) -> tuple[float, float]:
    """Limits of the ratio in the scaled problem."""
    least, greatest = sorted(
        (limit - problem.start_ratio) * problem.length / scale
        for limit in (problem.least_ratio, problem.greatest_ratio)
    )
    return max(least, -GREATEST_SCALED_SPEED), min(greatest, GREATEST_SCALED_SPEED)


def _shortest(problem: ReturnProblem) -> float:
    """Shortest ramp, as a share of the return."""
    return SHORTEST_CHANGE if problem.start_slope or problem.end_slope else SHORTEST_RAMP


def _sharpest(height: float, greatest_ratio: float, shortest: float) -> float:
    """Jerk of the scaled problem whose ramps are as short as is allowed."""
    straight = least_acceleration(abs(height), 1.0, max(greatest_ratio, 1e-300), math.inf)
    return max(LEAST_PEAK, straight if math.isfinite(straight) else 0.0) / shortest


def resolved(problem: ReturnProblem) -> ReturnProblem:
    """Return the problem with the jerk limit that the design goes by: no higher than what the shortest ramps allow."""
    scale = motion_scale(problem)
    if scale == 0.0:
        return problem
    length = problem.length
    unit, shortest = abs(scale) / length**3, _shortest(problem)
    if problem.greatest_jerk <= LEAST_PEAK / shortest * unit:
        return problem
    height = (problem.height - problem.start_ratio * length) / scale
    sharpest = _sharpest(height, _scaled_ratios(problem, scale)[1], shortest) * unit
    return problem if problem.greatest_jerk <= sharpest else replace(problem, greatest_jerk=sharpest)


def unscale_profile(profile: CamProfile, problem: ReturnProblem, scale: float) -> CamProfile:
    """Bring a solution of the scaled problem back to the master and the slave."""
    back = profile.scale(master=problem.length, slave=scale).add_line(problem.start_ratio)
    return back.over(0.0, problem.length)
