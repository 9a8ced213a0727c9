"""`Machine`: what every machine says about itself, in the slave's own coordinate."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, ClassVar, Literal, Self

from camwright.profiles.cut import Cut
from camwright.profiles.machines.fields import fields_of
from camwright.profiles.message import Message
from camwright.profiles.polynomial.profile import CamProfile

SlaveUnit = Literal["m", "rad"]


LONGEST = 1000.0
"""Cut lengths up to this multiple of the sync zone: rounding of the master is 2e-13 of the zone there."""


@dataclass(frozen=True)
class Machine(ABC):
    """A cutting machine: its slave, its tool and its drive train.

    The slave coordinate ``y`` (m or rad, see `slave_unit`) is the machine's own; a profile counts from zero where its cycle starts, so
    a profile's position plus the coordinate at its start (`camwright.profiles.returns.slave_at_start`) is a slave coordinate. Methods
    that take
    a slave coordinate are plain formulas: they accept floats, numpy arrays and symbols alike, and say the same wherever the sync zone lies.

    Examples
    --------
    >>> from camwright import CrankSlider, LinearCarriage, Machine, RotaryKnife
    >>> [issubclass(machine, Machine) for machine in (RotaryKnife, LinearCarriage, CrankSlider)]
    [True, True, True]
    """

    kind: ClassVar[str]
    """What job files call such a machine."""
    noun: ClassVar[str]
    """What people call that which the slave moves."""
    summary: ClassVar[str]
    """What the machine is, in a sentence."""
    slave_unit: ClassVar[SlaveUnit]
    """Unit of the slave coordinate."""
    turns_back: ClassVar[bool] = False
    """Whether the slave cannot help running backwards, whatever ``limits.reversal`` says."""
    constant_inertia: ClassVar[bool] = False
    """Whether `inertia` is the same everywhere, so that least torque is least acceleration."""
    place_name: ClassVar[str] = ""
    """Field that places the sync zone, the slave coordinate at its middle, and may be left to the design; empty where none does."""
    by_angle: ClassVar[bool] = False
    """Whether zones and limits may be given by the angle by which the tool turns: `slave_turn`, `zone_of_angle`, `master_of_angle`."""
    own_baselines: ClassVar[tuple[str, ...]] = ()
    """Baselines that only this machine has, where its ratio changes in the sync zone."""

    @property
    @abstractmethod
    def pitch(self) -> float:
        """Slave travel per cycle (slave unit)."""

    @property
    @abstractmethod
    def motor_ratio(self) -> float:
        """Motor angle per slave travel (rad per slave unit)."""

    @abstractmethod
    def sync_start(self, cut: Cut) -> float:
        """Slave coordinate at the start of the sync zone (slave unit).

        Raises
        ------
        InputError
            The machine cannot be in sync over this zone.
        """

    @abstractmethod
    def sync_profile(self, cut: Cut) -> CamProfile:
        """Slave travel in the sync zone, from master and slave zero: over ``[0, l_s]``, in sync with the material."""

    @abstractmethod
    def tool(self, y: Any) -> Any:
        """Position of the tool along the material (m) at slave coordinate ``y``."""

    @abstractmethod
    def tool_ratio(self, y: Any) -> Any:
        """Return the derivative of `tool` with respect to the slave coordinate (m per slave unit)."""

    @abstractmethod
    def inertia(self, y: Any) -> Any:
        """Inertia that the slave coordinate sees (kg for m, kg·m² for rad)."""

    @abstractmethod
    def inertia_slope(self, y: Any) -> Any:
        """Return the derivative of `inertia` with respect to the slave coordinate."""

    @property
    def friction(self) -> float:
        """Friction against the motion (N for m, N·m for rad), a magnitude."""
        return 0.0

    @property
    def moves_something(self) -> bool:
        """Whether the machine says what the motor has to move: mass, inertia or friction."""
        return any(getattr(self, each.name) > 0.0 for each in fields_of(type(self)) if each.load)

    @property
    def guide(self) -> tuple[float, float] | None:
        """Slave coordinates between which the slave must stay, the sync zone in their middle; None where nothing holds it in."""
        return None

    def with_guide(self, length: float) -> Self:
        """Make the same machine with a guide of another length (slave unit).

        Raises
        ------
        TypeError
            It has no guide.
        """
        raise TypeError(f"a {self.kind} of no guide cannot have one of {length!r}")

    @property
    def dead_centres(self) -> tuple[float, float] | None:
        """Slave coordinates between which the tool moves with the material, turning at both; None where it does not turn back."""
        return None

    @property
    def slave_turn(self) -> float | None:
        """Slave travel of one turn of what the slave is counted at (slave unit); None where nothing turns with it."""
        return 2 * math.pi if self.slave_unit == "rad" else None

    @property
    def placed(self) -> bool:
        """Whether the place of the sync zone is given, or there is nothing to place."""
        return not self.place_name or not math.isnan(self.place)

    @property
    def place(self) -> float:
        """Slave coordinate at mid sync zone where `place_name` names a field for it; not a number while it is free."""
        return float(getattr(self, self.place_name)) if self.place_name else math.nan

    def placed_at(self, place: float) -> Self:
        """Make the same machine with its sync zone at a place."""
        return replace(self, **{self.place_name: place})

    def place_range(self, cut: Cut) -> tuple[float, float]:
        """Places between which the middle of the sync zone must lie.

        Raises
        ------
        InputError
            The sync zone fits nowhere.
        TypeError
            There is nothing to place.
        """
        raise TypeError(f"the sync zone of a {self.kind} cannot be placed over {cut.sync_zone!r} m")

    def longest_cut(self, sync_zone: float) -> float:
        """Longest cut (m) that a cam over the master is for: beyond it rounding of the master is more than a motion near its end bears."""
        return LONGEST * sync_zone

    def sync_pace(self, cut: Cut) -> float:
        """Greatest slave velocity over line speed in the sync zone; where its place is free the least such.

        The tool ratio is taken at the ends of the zone: a machine whose tool is slowest elsewhere says so itself.
        """
        start = self.sync_start(cut)
        ends = start, start + self.sync_profile(cut).advance
        return cut.sync_ratio / min(float(self.tool_ratio(end)) for end in ends)

    def zone_of_angle(self, angle: float, sync_ratio: float) -> float:
        """Length of the sync zone on the master (m) in which the tool turns by an angle (rad).

        Raises
        ------
        TypeError
            The zone of this machine is no angle.
        """
        raise TypeError(f"the sync zone of a {self.kind} is no angle such as {angle!r} at {sync_ratio!r}")

    def master_of_angle(self, angle: float, cut: Cut) -> float:
        """Master travel from the start of the sync zone in which the tool turns by an angle (rad) from where it stands there (m).

        Raises
        ------
        TypeError
            Nothing of this machine turns by an angle.
        """
        raise TypeError(f"the tool of a {self.kind} does not turn by {angle!r} over {cut.sync_zone!r} m")

    def angle_of_master(self, travel: float, cut: Cut) -> float:
        """Angle by which the tool turns (rad) over master travel from the start of the sync zone (m): the inverse of `master_of_angle`.

        Raises
        ------
        TypeError
            Nothing of this machine turns by an angle.
        """
        raise TypeError(f"the tool of a {self.kind} turns by no angle over {travel!r} of {cut.sync_zone!r} m")

    def faults(self) -> tuple[Message, ...]:
        """Say what is wrong with the machine whatever it cuts."""
        return ()

    def zone_faults(self, cut: Cut, angle: float | None = None) -> tuple[Message, ...]:
        """Say why the machine cannot be in sync over a cut's zone; `sync_start` refuses with the same words.

        Parameters
        ----------
        angle
            The angle that the zone was given as (rad), if it was.
        """
        del cut, angle
        return ()

    @property
    def published(self) -> bool:
        """Whether the published minimum cut lengths (S1) are about this machine: it has a pitch, and its edge is in sync on its circle."""
        return False

    def tangential_mismatch(self, cut: Cut) -> float | None:
        """Share by which a blade in tangential sync falls short of the material at the ends of the zone; None where there is no blade."""
        del cut
        return None

    def remarks(self, cut: Cut) -> tuple[str, ...]:
        """Say in sentences what is worth knowing of a design of this machine."""
        del cut
        return ()

    def on_screw(self, carriage_speed: float, motor_speed: float) -> Machine | None:
        """Give the screw-driven carriage that would do this machine's work; None where nobody would compare it with one.

        Parameters
        ----------
        carriage_speed
            Greatest speed of the carriage on the screw (m/s).
        motor_speed
            Speed of the motor at which it is reached (rad/s).
        """
        del carriage_speed, motor_speed
        return None


@lru_cache(maxsize=256)
def straight_sync(zone: float, ratio: float) -> CamProfile:
    """Slave that moves at a constant ratio over a sync zone of a length (m); kept, because it is asked for again and again."""
    return CamProfile.from_arrays([0.0, zone], [[0.0, ratio]])
