"""`Task`: a machine, a cut, limits and what the line does, and the facts that follow from these."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

from camwright.profiles.cut import Cut
from camwright.profiles.limits import Limits
from camwright.profiles.line import STEADY, Line
from camwright.profiles.machines.machine import Machine
from camwright.profiles.polynomial.profile import CamProfile


@dataclass(frozen=True)
class Task:
    """What is to be done: a cut, on a machine, within limits. What it follows from them is asked here, and nowhere else.

    Parameters
    ----------
    cut
        The cycle on the master.
    limits
        What the slave may do, in its own unit.
    line
        How the line ramps its speed, which the limits are to bear.

    Examples
    --------
    >>> from camwright import Cut, Limits, RotaryKnife, Task
    >>> task = Task(RotaryKnife(0.4), Cut(0.6, 80 / 60, 0.2, 0.04, 0.16, 1e-4), Limits(200 / 60, 30.0, 3000.0))
    >>> round(task.height, 9)                          # what the blade travels in the return
    0.2
    """

    machine: Machine
    cut: Cut
    limits: Limits
    line: Line = STEADY

    @cached_property
    def sync(self) -> CamProfile:
        """Slave travel in the sync zone, from master and slave zero (slave unit over m); as `Machine.sync_profile`.

        Raises
        ------
        InputError
            The machine cannot be in sync over the zone.
        """
        return self.machine.sync_profile(self.cut)

    @cached_property
    def slave_at_sync_start(self) -> float:
        """Slave coordinate of the machine at the start of the sync zone (slave unit); as `Machine.sync_start`.

        Raises
        ------
        InputError
            The machine cannot be in sync over the zone.
        """
        return self.machine.sync_start(self.cut)

    @property
    def slave_at_sync_end(self) -> float:
        """Slave coordinate of the machine at the end of the sync zone, where the return starts (slave unit)."""
        return self.slave_at_sync_start + float(self.sync(self.sync.end))

    @property
    def slave_at_start(self) -> float:
        """Slave coordinate of the machine where a cycle starts: add it to a profile's position to get the slave coordinate."""
        passed = self.sync.end if self.cut.origin == "return" else 0.5 * self.cut.sync_zone
        return self.slave_at_sync_start + float(self.sync(passed))

    def slave_zero(self, profile: CamProfile) -> float:
        """Slave coordinate of the machine at a profile's slave zero: add it to the profile's positions to get slave coordinates.

        A profile, whatever it counts from, starts where the machine is in sync; a shaped one counts from there and may start elsewhere.
        """
        return self.slave_at_start - (0.0 if self.cut.shaped else float(profile(profile.start)))

    @property
    def height(self) -> float:
        """Slave travel in the return zone (slave unit), negative for a slave that comes back."""
        return self.machine.pitch - self.sync.advance

    @property
    def straight(self) -> bool:
        """Whether the slave's ratio is constant in the sync zone."""
        return self.sync.degree == 1

    @property
    def reverses(self) -> bool:
        """Whether the slave may run backwards: it is allowed to, or cannot help it."""
        return self.limits.reversal or self.machine.turns_back

    @property
    def least_velocity(self) -> float:
        """Least velocity allowed (slave unit/s): zero for a slave that must not run backwards."""
        return -self.limits.speed if self.reverses else 0.0

    @property
    def least_ratio(self) -> float:
        """Least ratio allowed (slave unit/m)."""
        return self.least_velocity / self.cut.line_speed

    @property
    def greatest_ratio(self) -> float:
        """Greatest ratio allowed (slave unit/m)."""
        return self.limits.speed / self.cut.line_speed

    @property
    def greatest_slope(self) -> float:
        """Greatest magnitude of the ratio slope allowed (slave unit/m²)."""
        return self.limits.acceleration / self.cut.line_speed**2

    @property
    def greatest_jerk(self) -> float:
        """Greatest magnitude of the third derivative over the master allowed (slave unit/m³)."""
        return self.limits.jerk / self.cut.line_speed**3

    def at_speed(self, line_speed: float) -> Task:
        """Return the task of the same cam at another line speed (m/s): its zones are the same on the material."""
        return self.with_cut(replace(self.cut, line_speed=line_speed))

    def designed_at(self, line_speed: float) -> Task:
        """Return the task of another design at a line speed (m/s), whose zones last as long there as they are to; as `Cut.designed_at`."""
        return self.with_cut(self.cut.designed_at(line_speed))

    def with_length(self, length: float) -> Task:
        """Return the task with another cut length (m)."""
        return self.with_cut(replace(self.cut, length=length))

    def from_return(self) -> Task:
        """Return the task with master zero at the start of the return zone."""
        return self if self.cut.origin == "return" else self.with_cut(replace(self.cut, origin="return"))

    def placed_at(self, place: float) -> Task:
        """Return the task with mid sync zone at a slave coordinate of the machine (slave unit)."""
        return self.with_machine(self.machine.placed_at(place))

    def placed_midway(self) -> Task:
        """Return the task with the sync zone in the middle of where the machine can have it.

        Raises
        ------
        InputError
            The sync zone fits nowhere.
        """
        least, greatest = self.machine.place_range(self.cut)
        return self.placed_at(0.5 * (least + greatest))

    def with_machine(self, machine: Machine) -> Task:
        """Return the task on another machine."""
        return replace(self, machine=machine)

    def with_cut(self, cut: Cut) -> Task:
        """Return the task with another cut."""
        return replace(self, cut=cut)

    def with_limits(self, limits: Limits) -> Task:
        """Return the task within other limits."""
        return replace(self, limits=limits)

    def with_line(self, line: Line) -> Task:
        """Return the task on a line that ramps otherwise."""
        return replace(self, line=line)
