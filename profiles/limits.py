"""`Limits`: what the slave may do at the given line speed."""

from __future__ import annotations

from dataclasses import dataclass

from camwright.profiles.motor import MotorCurve


@dataclass(frozen=True)
class Limits:
    """Limits of the slave over time, as magnitudes.

    Parameters
    ----------
    speed
        Greatest speed (m/s).
    acceleration
        Greatest acceleration (m/s²).
    jerk
        Greatest jerk (m/s³).
    reversal
        Whether the slave may run backwards.
    motor
        What the motor can give, if that is to be kept too.

    Examples
    --------
    >>> from camwright import Limits
    >>> Limits(speed=3.0, acceleration=30.0, jerk=3000.0).reversal
    False
    """

    speed: float
    acceleration: float
    jerk: float
    reversal: bool = False
    motor: MotorCurve | None = None
