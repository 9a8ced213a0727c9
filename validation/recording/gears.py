"""What a recording may have counted the slave at: the slave itself, the turn of a drum, the motor; either way round."""

from __future__ import annotations

import math
from dataclasses import dataclass

from camwright.profiles.machines import Machine
from camwright.profiles.machines.machine import SlaveUnit


@dataclass(frozen=True)
class Gear:
    """What turns recorded positions into those of the slave.

    Parameters
    ----------
    counted_at
        What was recorded, in words.
    factor
        Slave travel per recorded travel (slave unit per unit of the recording); below zero where it is counted the other way round.
    """

    counted_at: str
    factor: float


def gears_of(machine: Machine, unit: SlaveUnit, given: float | None) -> tuple[Gear, ...]:
    """Say what a recording may have counted.

    Parameters
    ----------
    unit
        Unit of the recorded positions.
    given
        Recorded travel over the slave's, both in the recording's kind of unit, if it is known: turns of the motor per turn of the drum.

    Returns
    -------
    tuple
        Nothing where the unit cannot be that of anything that moves in proportion to the slave.
    """
    found: list[Gear] = []
    if unit == machine.slave_unit:
        found.append(Gear("the slave", 1.0))
    elif unit == "rad" and machine.slave_turn is not None:
        found.append(Gear("the slave by its turn", machine.slave_turn / (2.0 * math.pi)))
    if given is not None:
        found = [Gear(f"what moves {given:g} times as far as the slave", gear.factor / given) for gear in found]
    elif unit == "rad" and machine.motor_ratio not in (0.0, 1.0):
        found.append(Gear("the motor", 1.0 / machine.motor_ratio))
    return tuple(Gear(gear.counted_at + way, sign * gear.factor) for gear in found for way, sign in _WAYS)


_WAYS = (("", 1.0), (", counted the other way round", -1.0))
