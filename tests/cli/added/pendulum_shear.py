"""A machine added by the book (docs/extending.md): a blade on a swinging arm."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

import numpy as np

from camwright.profiles.cut import Cut
from camwright.profiles.errors import InputError
from camwright.profiles.machines.fields import GEAR_RATIO, Quantity
from camwright.profiles.machines.machine import Machine, SlaveUnit
from camwright.profiles.message import Message, Value
from camwright.profiles.polynomial.fitting import fit_profile
from camwright.profiles.polynomial.profile import CamProfile, FloatArray


@dataclass(frozen=True)
class PendulumShear(Machine):
    """A blade on a swinging arm; the slave coordinate is its travel on the arc (m), zero where the arm hangs straight down."""

    kind: ClassVar[str] = "pendulum_shear"
    noun: ClassVar[str] = "blade"
    summary: ClassVar[str] = "A blade on a swinging arm."
    slave_unit: ClassVar[SlaveUnit] = "m"
    turns_back: ClassVar[bool] = True
    constant_inertia: ClassVar[bool] = True

    arm: Annotated[float, Quantity("length", example="800 mm", shown=True, description="length of the arm")]
    arm_inertia: Annotated[
        float, Quantity("inertia", zero=True, description="inertia of arm, gear and motor at the arm")
    ] = 0.0
    gear_ratio: Annotated[float, GEAR_RATIO] = 1.0

    @property
    def pitch(self) -> float:
        """Zero: it comes back."""
        return 0.0

    @property
    def motor_ratio(self) -> float:
        """Motor angle per travel (rad/m)."""
        return self.gear_ratio / self.arm

    def sync_start(self, cut: Cut) -> float:
        """Travel on the arc at the start of the sync zone (m)."""
        half = 0.5 * cut.sync_ratio * cut.sync_zone
        if half >= self.arm:
            raise InputError(*self.zone_faults(cut))
        return -self.arm * math.asin(half / self.arm)

    def zone_faults(self, cut: Cut, angle: float | None = None) -> tuple[Message, ...]:
        """Say that the blade does not reach over the zone."""
        del angle
        if 0.5 * cut.sync_ratio * cut.sync_zone < self.arm:
            return ()
        values = ("arm", Value(self.arm, "m")), ("most", Value(2 * self.arm / cut.sync_ratio, "m", toward="below"))
        return (
            Message(
                "{@machine.arm} = {arm}: too short for the sync zone; shorten {@sync_zone} to {most} at most", values
            ),
        )

    def sync_profile(self, cut: Cut) -> CamProfile:
        """Travel in the sync zone: the blade's place along the material is ``r sin(y / r)``."""
        ratio, middle = cut.sync_ratio, 0.5 * cut.sync_zone

        def per_material(x: FloatArray) -> FloatArray:
            return np.asarray(ratio / np.sqrt(1.0 - (ratio * (x - middle) / self.arm) ** 2))

        return fit_profile(per_material, 0.0, cut.sync_zone)

    def tool(self, y: Any) -> Any:
        """Place of the blade along the material (m)."""
        return self.arm * np.sin(y / self.arm)

    def tool_ratio(self, y: Any) -> Any:
        """Return the derivative of `tool`."""
        return np.cos(y / self.arm)

    def inertia(self, y: Any) -> Any:
        """Inertia on the arc (kg)."""
        return self.arm_inertia / self.arm**2 + 0.0 * y

    def inertia_slope(self, y: Any) -> Any:
        """Zero."""
        return 0.0 * y

    @property
    def slave_turn(self) -> float:
        """Travel of a motor turn (m)."""
        return 2 * math.pi / self.motor_ratio
