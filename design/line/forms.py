"""What a line that ramps asks of a cam over the master, as linear forms of its derivatives.

While the line moves at ``v`` with acceleration ``a`` and jerk ``j`` the slave's acceleration is ``y'' v² + y' a`` and its jerk
``y''' v³ + 3 y'' v a + y' j`` (chain rule). The greatest magnitudes over all ramps that the line may make are greatest values of linear
forms of ``(y', y'', y''')``, so what is asked is convex, and for every form the highest line speed or standstill is the worst.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.task import Task

KEPT = 1e-9
"""Share by which rounding may carry a cam over what the line's ramps ask."""


@dataclass(frozen=True)
class Form:
    """A linear form of a cam's derivatives over the master that must not exceed 1 anywhere in the cycle.

    Parameters
    ----------
    ratio, slope, jerk
        Factors of ``y'``, ``y''`` and ``y'''``.
    """

    ratio: float
    slope: float
    jerk: float


def ramp_forms(task: Task) -> tuple[Form, ...]:
    """Give what must not exceed 1 so that the slave keeps its limits of acceleration and jerk while the line ramps.

    The line may brake harder than it speeds up. Where the slave may run backwards its ratio counts with either sign.

    Parameters
    ----------
    task
        Cut, limits and line; the motor's curve is not looked at.
    """
    v, limits, line = task.cut.line_speed, task.limits, task.line
    turns = (1.0, -1.0) if task.reverses else (1.0,)
    found: dict[Form, None] = {}

    def add(ratio: float, slope: float, jerk: float) -> None:
        if ratio or slope or jerk:
            found[Form(ratio, slope, jerk)] = None

    for turn in turns:
        for push in (1.0, -1.0):  # which way the slave is accelerated
            ramp = line.speeding if push == turn else line.braking
            add(turn * ramp / limits.acceleration, push * v**2 / limits.acceleration, 0.0)
        add(turn * line.hardest / limits.acceleration, 0.0, 0.0)  # near standstill the ratio alone counts
        comes = turn * line.known_jerk / limits.jerk
        for push in (1.0, -1.0):
            for bend in (1.0, -1.0):
                ramp = line.speeding if push == bend else line.braking
                slope = bend * 3.0 * v * ramp / limits.jerk
                add(comes, slope, push * v**3 / limits.jerk)
                if line.speeding != line.braking:  # else the one above is never less for one of its signs
                    add(comes, slope, 0.0)
    return tuple(found)


def greatest_form(profile: CamProfile, task: Task) -> float:
    """Greatest value of any of the forms over a profile or a part of one, exactly: at most 1 where the line may ramp as it is said to."""
    ratio, slope, jerk = (profile.derivative(order) for order in (1, 2, 3))
    return max(
        (
            ratio.scale(slave=form.ratio)
            .plus(slope.scale(slave=form.slope))
            .plus(jerk.scale(slave=form.jerk))
            .extrema(0)[1]
            .value
            for form in ramp_forms(task)
        ),
        default=-math.inf,
    )


def keeps_ramp(profile: CamProfile, task: Task) -> bool:
    """Whether the slave keeps its limits of acceleration and jerk while the line ramps; a line that keeps its speed asks nothing."""
    return not task.line.ramps or greatest_form(profile, task) <= 1.0 + KEPT
