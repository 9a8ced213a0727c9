"""`Ramp`: how a slave that stands gets into the sync zone, or out of it to rest; and where it stands."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

from camwright.profiles.closed_forms.transfer import State, Transfer
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.task import Task

Aim = Literal["peak_acceleration", "rms_acceleration", "shortest"]
"""What is made least of a ramp: the peak of its acceleration, the heat of one start, or the master that it takes."""


_ROUNDING = 1e-12
"""Share of the guide by which a park may lie beyond its end."""


@dataclass(frozen=True)
class Ramp:
    """A motion between rest and the sync zone, at a line speed; over the master it is the same at every other.

    Parameters
    ----------
    way
        The motion over time.
    line_speed
        The line speed (m/s).
    """

    way: Transfer
    line_speed: float

    @cached_property
    def profile(self) -> CamProfile:
        """The motion over the master, from zero to zero (slave unit over m)."""
        return self.way.profile().scale(master=self.line_speed)

    @property
    def arc(self) -> float:
        """Slave travel from its start to its end (slave unit), negative where it ends behind."""
        return self.way.distance

    @property
    def time(self) -> float:
        """Time that it takes (s)."""
        return self.way.time

    @property
    def master(self) -> float:
        """Material that passes meanwhile (m)."""
        return self.time * self.line_speed

    @property
    def peak_acceleration(self) -> float:
        """Greatest magnitude of the acceleration (slave unit over s²)."""
        return self.way.peak_acceleration

    @property
    def heat(self) -> float:
        """Integral of the squared acceleration over the time (slave unit² over s³): what heats the motor."""
        return self.way.heat

    @property
    def rms_acceleration(self) -> float:
        """Root mean square of the acceleration over its time (slave unit over s²)."""
        return math.sqrt(self.heat / self.time)


@dataclass(frozen=True, eq=False)
class Stand:
    """A machine whose slave can stand at a park, and what lies between: the way into the sync zone, the zone, the way back to the park.

    Parameters
    ----------
    task
        The task, its sync zone placed.
    zone
        The slave in the sync zone, over the zone from zero on the master; its slave zero is the machine's own.
    park
        Slave coordinate of the park, before the sync zone (slave unit).
    """

    task: Task
    zone: CamProfile
    park: float

    @property
    def zone_start(self) -> float:
        """Slave coordinate at the start of the sync zone."""
        return float(self.zone(self.zone.start))

    @property
    def zone_end(self) -> float:
        """Slave coordinate at the end of the sync zone."""
        return self.zone_start + self.zone.advance

    @property
    def run_up(self) -> float:
        """Way from the park to the sync zone (slave unit)."""
        return self.zone_start - self.park

    @property
    def run_out(self) -> float:
        """Way from the sync zone to the park one pitch on (slave unit), negative for a slave that comes back."""
        return self.park + self.task.machine.pitch - self.zone_end

    @property
    def room(self) -> float:
        """How far the slave may go beyond the sync zone (slave unit); infinite where it goes round."""
        guide = self.task.machine.guide
        return math.inf if guide is None else guide[1] - self.zone_end

    @property
    def parked_within(self) -> bool:
        """Whether the park lies on the guide of a slave that has one, but for rounding."""
        guide = self.task.machine.guide
        return guide is None or guide[0] - _ROUNDING * (guide[1] - guide[0]) <= self.park <= guide[1]

    @property
    def into(self) -> State:
        """State over time at the start of the sync zone."""
        return self._state(self.zone.start)

    @property
    def out_of(self) -> State:
        """State over time at the end of the sync zone."""
        return self._state(self.zone.end)

    def _state(self, master: float) -> State:
        v = self.task.cut.line_speed
        return State(v * float(self.zone(master, 1)), v * v * float(self.zone(master, 2)))

    def at_speed(self, line_speed: float) -> Stand:
        """Return the same at another line speed (m/s)."""
        return Stand(self.task.at_speed(line_speed), self.zone, self.park)

    def parked_at(self, park: float) -> Stand:
        """Return the same with another park (slave unit)."""
        return Stand(self.task, self.zone, park)


def stand(task: Task, zone: CamProfile | None = None, park: float | None = None) -> Stand:
    """Put a task beside its park: opposite the sync zone where the slave goes round, at home where it comes back, unless another is given.

    Parameters
    ----------
    task
        The task, its sync zone placed.
    zone
        The slave in the sync zone as of `Stand`; in sync throughout if not given.
    park
        Slave coordinate of the park (slave unit); any number of pitches off is the same.
    """
    if zone is None:
        zone = task.sync.shift(-task.sync.start, task.slave_at_sync_start - float(task.sync(task.sync.start)))
    start, pitch = float(zone(zone.start)), float(task.machine.pitch)
    if park is None:
        guide = task.machine.guide
        return Stand(task, zone, start - 0.5 * (pitch - zone.advance) if guide is None else guide[0])
    if pitch > 0:
        park -= pitch * math.ceil((park - start) / pitch)
    return Stand(task, zone, park)
