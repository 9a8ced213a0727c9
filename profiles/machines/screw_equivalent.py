"""The screw-driven carriage that would do the work of a crank's: what S3 compares the crank with."""

from __future__ import annotations

import math

from camwright.profiles.machines.crank_slider import CrankSlider
from camwright.profiles.machines.linear_carriage import LinearCarriage


def screw_equivalent(crank: CrankSlider, carriage_speed: float, motor_speed: float) -> LinearCarriage:
    """Put a crank's carriage on a screw.

    The carriage's mass and its stroke are those of the crank's. The lead is such that the motor has its greatest speed when the carriage
    has its own. Screw, coupling and motor add no mass, which favours the screw; a crank's inertia holds all that turns.

    Parameters
    ----------
    crank
        The crank.
    carriage_speed
        Greatest speed of the carriage on the screw (m/s).
    motor_speed
        Speed of the motor at which it is reached (rad/s): the greatest of the crank's motor.
    """
    lead = 2 * math.pi * carriage_speed / motor_speed
    return LinearCarriage(stroke=crank.stroke, mass=crank.carriage_mass, travel_per_turn=lead)
