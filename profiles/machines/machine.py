"""`Machine`: what every machine says about itself, in the slave's own coordinate."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, ClassVar, Literal

from camwright.profiles.cut import Cut
from camwright.profiles.polynomial.profile import CamProfile

SlaveUnit = Literal["m", "rad"]


@dataclass(frozen=True)
class Machine(ABC):
    """A cutting machine: its slave, its tool and its drive train.

    The slave coordinate ``y`` (m or rad, see `slave_unit`) is the machine's own; a profile counts from zero where its cycle starts, so
    a profile's position plus the coordinate at its start (`camwright.profiles.returns.slave_at_start`) is a slave coordinate. Methods
    that take
    a slave coordinate are plain formulas: they accept floats, numpy arrays and symbols alike.
    """

    slave_unit: ClassVar[SlaveUnit]
    """Unit of the slave coordinate."""
    turns_back: ClassVar[bool] = False
    """Whether the slave cannot help running backwards, whatever ``limits.reversal`` says."""

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


@lru_cache(maxsize=256)
def straight_sync(zone: float, ratio: float) -> CamProfile:
    """Slave that moves at a constant ratio over a sync zone of a length (m); kept, because it is asked for again and again."""
    return CamProfile.from_arrays([0.0, zone], [[0.0, ratio]])
