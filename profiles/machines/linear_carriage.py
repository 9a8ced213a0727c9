"""The linear carriage: a flying shear or saw that goes out with the material and comes back."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Annotated, Any, ClassVar, Self

from camwright.profiles.cut import Cut
from camwright.profiles.errors import InputError
from camwright.profiles.machines.fields import Quantity
from camwright.profiles.machines.machine import Machine, SlaveUnit, straight_sync
from camwright.profiles.message import Message, Value
from camwright.profiles.polynomial.profile import CamProfile


@dataclass(frozen=True)
class LinearCarriage(Machine):
    """A carriage on a screw or rack.

    The slave coordinate is the carriage's position along the material (m), from the home position.

    Parameters
    ----------
    stroke
        Length of the guide that may be used (m).
    home
        Position of the home end of the stroke (m), where the carriage waits at rest; the stroke lies ahead of it.
    mass
        Moved mass, with what the motor and the transmission add (kg).
    travel_per_turn
        Carriage travel per motor turn (m): lead of the screw, or circumference of the pinion over the gear ratio.

    Examples
    --------
    >>> from camwright import LinearCarriage
    >>> LinearCarriage(stroke=1.2, mass=40.0).pitch
    0.0
    """

    kind: ClassVar[str] = "linear_carriage"
    noun: ClassVar[str] = "carriage"
    summary: ClassVar[str] = "A carriage on a screw or rack: flying shear, flying saw."
    slave_unit: ClassVar[SlaveUnit] = "m"
    turns_back: ClassVar[bool] = True
    constant_inertia: ClassVar[bool] = True

    stroke: Annotated[
        float, Quantity("length", example="800 mm", shown=True, description="length of the guide that may be used")
    ]
    home: Annotated[
        float, Quantity("length", signed=True, example="0 mm", description="place of the home end of the stroke")
    ] = 0.0
    mass: Annotated[
        float, Quantity("mass", zero=True, description="moved mass, with what motor and transmission add")
    ] = 0.0
    travel_per_turn: Annotated[
        float, Quantity("length", example="20 mm", description="carriage travel per motor turn")
    ] = 1.0

    @property
    def pitch(self) -> float:
        """Zero: the carriage comes back."""
        return 0.0

    @property
    def motor_ratio(self) -> float:
        """Motor angle per travel (rad/m)."""
        return 2 * math.pi / self.travel_per_turn

    def sync_start(self, cut: Cut) -> float:
        """Carriage position at the start of the sync zone (m): the zone lies in the middle of the stroke.

        A return between two ends of equal ratio overshoots both by the same length, so the middle leaves most room.
        """
        travel = cut.sync_ratio * cut.sync_zone
        if travel >= self.stroke:
            raise InputError(*self.zone_faults(cut))
        return self.home + 0.5 * (self.stroke - travel)

    def zone_faults(self, cut: Cut, angle: float | None = None) -> tuple[Message, ...]:
        """Say that the carriage travels further in sync than its stroke allows."""
        del angle  # that is a knife's
        travel = cut.sync_ratio * cut.sync_zone
        if travel < self.stroke:
            return ()
        values = {
            "stroke": Value(self.stroke, "m"),
            "travel": Value(travel, "m"),
            "longer": Value(travel, "m", toward="above"),
            "shorter": Value(self.stroke / cut.sync_ratio, "m", toward="below"),
        }
        text = (
            "{@machine.stroke} = {stroke}: not above the {travel} that the carriage travels in the sync zone; lengthen it to {longer} at "
            "least, or shorten {@sync_zone} to {shorter} at most"
        )
        return (Message(text, tuple(values.items())),)

    @property
    def guide(self) -> tuple[float, float]:
        """Both ends of the stroke (m)."""
        return self.home, self.home + self.stroke

    def with_guide(self, length: float) -> Self:
        """Make the same carriage with another stroke (m)."""
        return replace(self, stroke=length)

    @property
    def slave_turn(self) -> float:
        """Travel per motor turn (m)."""
        return self.travel_per_turn

    def sync_profile(self, cut: Cut) -> CamProfile:
        """Slave in the sync zone: ``y = s x`` with the sync ratio ``s``."""
        return straight_sync(cut.sync_zone, cut.sync_ratio)

    def tool(self, y: Any) -> Any:
        """Return the carriage itself."""
        return y

    def tool_ratio(self, y: Any) -> Any:
        """One."""
        return 1.0 + 0.0 * y

    def inertia(self, y: Any) -> Any:
        """Return the moved mass (kg)."""
        return self.mass + 0.0 * y

    def inertia_slope(self, y: Any) -> Any:
        """Zero: the mass does not change."""
        return 0.0 * y
