"""The rotary knife: blades on a drum that turns one way, its edge moving with the material during the cut."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Annotated, Any, ClassVar, Literal, get_args

import numpy as np

from camwright.profiles.cut import Cut
from camwright.profiles.errors import InputError
from camwright.profiles.machines.fields import GEAR_RATIO, Choice, Instead, Quantity, Whole
from camwright.profiles.machines.machine import Machine, SlaveUnit, straight_sync
from camwright.profiles.message import Message, Value
from camwright.profiles.polynomial.fitting import fit_profile
from camwright.profiles.polynomial.profile import CamProfile, FloatArray

Sync = Literal["tangential", "horizontal"]

GREATEST_ANGLE = math.radians(80.0)
"""Greatest angle of the blade from the cut point at which horizontal sync is offered: there the drum turns 5.8 times as fast."""


@dataclass(frozen=True)
class RotaryKnife(Machine):
    """A rotary knife.

    The slave coordinate ``y`` is the travel of a blade's edge along the blade circle (m), zero where the blade points at the
    material. In tangential sync the edge's speed on its circle equals the material's (S1); in horizontal sync, for thick product, the
    component along the material does: ``dy/dx = 1 / cos(y / r)``.

    Parameters
    ----------
    circumference
        Circumference of the blade circle (m).
    blades
        Number of blades, evenly spaced.
    gear_ratio
        Motor turns per drum turn.
    drum_inertia
        Inertia of drum, gear and motor at the drum (kg·m²).
    drum_friction
        Friction torque at the drum (N·m).

    Examples
    --------
    >>> from camwright import RotaryKnife
    >>> RotaryKnife(circumference=0.8, blades=2).pitch
    0.4
    """

    kind: ClassVar[str] = "rotary_knife"
    noun: ClassVar[str] = "knife"
    summary: ClassVar[str] = "Blades on a drum that turns one way."
    slave_unit: ClassVar[SlaveUnit] = "m"
    constant_inertia: ClassVar[bool] = True
    by_angle: ClassVar[bool] = True

    circumference: Annotated[
        float,
        Quantity(
            "length",
            example="400 mm",
            shown=True,
            description="circumference of the blade circle",
            instead=Instead(
                "diameter", math.pi, "127 mm", "diameter of the blade circle, in place of the circumference"
            ),
        ),
    ]
    blades: Annotated[int, Whole(1, 1000, 2, "blades, evenly spaced", shown=True)] = 1
    gear_ratio: Annotated[float, GEAR_RATIO] = 1.0
    sync: Annotated[
        Sync,
        Choice(get_args(Sync), "which speed of the blade is in sync: on its circle, or along the material", shown=True),
    ] = "tangential"
    drum_inertia: Annotated[
        float, Quantity("inertia", zero=True, key="inertia", description="inertia of drum, gear and motor, at the drum")
    ] = 0.0
    drum_friction: Annotated[
        float,
        Quantity("torque", zero=True, usual="2 N m", key="friction", description="friction torque at the drum"),
    ] = 0.0

    @property
    def radius(self) -> float:
        """Radius of the blade circle ``r`` (m)."""
        return self.circumference / (2 * math.pi)

    @property
    def pitch(self) -> float:
        """Slave travel per cycle: circumference over blades (m)."""
        return self.circumference / self.blades

    @property
    def motor_ratio(self) -> float:
        """Motor angle per edge travel (rad/m)."""
        return self.gear_ratio / self.radius

    def greatest_sync_zone(self, sync_ratio: float) -> float:
        """Longest sync zone that horizontal sync allows (m)."""
        return 2 * self.radius * math.sin(GREATEST_ANGLE) / sync_ratio

    def sync_start(self, cut: Cut) -> float:
        """Edge travel at the start of the sync zone, the cut point at its middle (m, negative)."""
        half = 0.5 * cut.sync_ratio * cut.sync_zone
        if self.sync == "tangential":
            return -half
        if cut.sync_zone > self.greatest_sync_zone(cut.sync_ratio):
            raise InputError(*self.zone_faults(cut))
        return -self.radius * math.asin(half / self.radius)

    def sync_profile(self, cut: Cut) -> CamProfile:
        """Slave in the sync zone: ``y = s x``, or ``r sin(y / r) = s (x - l_s / 2)``, with the sync ratio ``s``."""
        if self.sync == "tangential":
            return straight_sync(cut.sync_zone, cut.sync_ratio)
        self.sync_start(cut)  # refuses a zone beyond the greatest angle
        return _horizontal(self.radius, cut.sync_zone, cut.sync_ratio)

    def tool(self, y: Any) -> Any:
        """Position of the edge along the material; along its circle in tangential sync."""
        return y if self.sync == "tangential" else self.radius * np.sin(y / self.radius)

    def tool_ratio(self, y: Any) -> Any:
        """Return the derivative of `tool`."""
        return 1.0 + 0.0 * y if self.sync == "tangential" else np.cos(y / self.radius)

    def inertia(self, y: Any) -> Any:
        """Drum inertia over ``r²`` (kg)."""
        return self.drum_inertia / self.radius**2 + 0.0 * y

    def inertia_slope(self, y: Any) -> Any:
        """Zero: the inertia does not depend on the angle."""
        return 0.0 * y

    @property
    def friction(self) -> float:
        """Friction at the edge (N)."""
        return self.drum_friction / self.radius

    @property
    def slave_turn(self) -> float:
        """One turn of the drum (m)."""
        return self.circumference

    def zone_of_angle(self, angle: float, sync_ratio: float) -> float:
        """Length of the sync zone in which the blade turns by an angle (m).

        In tangential sync ``l_s = angle r / s``, in horizontal sync ``l_s = 2 r sin(angle / 2) / s``, with the sync ratio ``s``; beyond
        the greatest angle the zone of that angle.
        """
        chord = angle if self.sync == "tangential" else 2 * math.sin(min(0.5 * angle, GREATEST_ANGLE))
        return self.radius * chord / sync_ratio

    def master_of_angle(self, angle: float, cut: Cut) -> float:
        """Master travel from the start of the sync zone in which the blade turns by an angle (m).

        ``angle r / s`` in tangential sync; ``l_s / 2 + r sin(a + angle) / s`` in horizontal sync, from the angle ``a`` at its start, and
        no further than where the blade moves across the material.
        """
        if self.sync == "tangential":
            return self.radius * angle / cut.sync_ratio
        half = 0.5 * cut.sync_ratio * cut.sync_zone
        place = angle - math.asin(min(half / self.radius, 1.0))
        return (half + self.radius * math.sin(max(-0.5 * math.pi, min(0.5 * math.pi, place)))) / cut.sync_ratio

    def angle_of_master(self, travel: float, cut: Cut) -> float:
        """Angle by which the blade turns over master travel from the start of the sync zone (rad): the inverse of `master_of_angle`."""
        if self.sync == "tangential":
            return cut.sync_ratio * travel / self.radius
        half = 0.5 * cut.sync_ratio * cut.sync_zone
        first, place = (
            math.asin(max(-1.0, min(1.0, each / self.radius))) for each in (-half, cut.sync_ratio * travel - half)
        )
        return place - first

    def zone_faults(self, cut: Cut, angle: float | None = None) -> tuple[Message, ...]:
        """Say that more than one blade would be in sync at a time, or in horizontal sync one too far from the cut point."""
        travel, longest = cut.sync_ratio * cut.sync_zone, self.pitch / cut.sync_ratio
        where, given = "{@sync_zone} = {zone}", {"zone": Value(cut.sync_zone, "m")}
        if angle is not None:
            where, given = where + " ({angle})", given | {"angle": Value(angle, "rad", 6)}
        if self.sync == "horizontal":
            bound = self.greatest_sync_zone(cut.sync_ratio)
            if cut.sync_zone > bound if angle is None else 0.5 * angle > GREATEST_ANGLE:
                degrees = f"{math.degrees(GREATEST_ANGLE):.0f}"
                most = Value(bound, "m", toward="below") if angle is None else Value(2 * GREATEST_ANGLE, "rad", 6)
                text = (
                    f"{where}: takes the blade beyond ±{degrees}° from the cut point, where horizontal sync ends; shorten it to {{most}} "
                    "at most"
                )
                return (Message(text, (*given.items(), ("most", most))),)
            travel = 2 * self.radius * math.asin(min(1.0, 0.5 * travel / self.radius))
            half = min(0.5 * self.pitch / self.radius, GREATEST_ANGLE)
            longest = 2 * self.radius * math.sin(half) / cut.sync_ratio
        if travel < self.pitch:
            return ()
        if self.blades == 1 and cut.sync_ratio == 1.0:
            room = "{@machine.circumference} = {circumference}, so the knife would turn a whole turn in sync"
        else:
            room = (
                f"the {{longest}} that {{@machine.circumference}} = {{circumference}}, blades = {self.blades} and {{@sync_ratio}} = "
                f"{cut.sync_ratio:.6g} leave to one blade, so no return zone is left"
            )
        given |= {
            "circumference": Value(self.circumference, "m"),
            "longest": Value(longest, "m"),
            "most": Value(longest, "m", toward="below"),
        }
        return (Message(f"{where}: not below {room}; shorten the sync zone to {{most}} at most", tuple(given.items())),)

    @property
    def published(self) -> bool:
        """Whether the edge is in sync on its circle, whatever the sync ratio."""
        return self.sync == "tangential"

    def tangential_mismatch(self, cut: Cut) -> float:
        """Share by which the edge's speed along the material falls short of its speed in sync at the ends of a tangential sync zone.

        The edge moves at ``s`` times the line speed on its circle, ``s`` the sync ratio, so along the material it moves at ``cos(y / r)``
        of that: ``1 - cos(s l_s / 2 r)``.
        """
        return 1.0 - math.cos(min(0.5 * cut.sync_ratio * cut.sync_zone / self.radius, math.pi))

    def remarks(self, cut: Cut) -> tuple[str, ...]:
        """Say what horizontal sync saves."""
        if self.sync == "tangential":
            return ()
        mismatch = 100 * self.tangential_mismatch(cut)
        return (
            f"along the material a blade in tangential sync falls short of the line speed by {mismatch:.3g} % at the ends of the sync zone",
        )


@lru_cache(maxsize=256)
def _horizontal(radius: float, zone: float, ratio: float) -> CamProfile:
    """Edge travel in horizontal sync; kept, because line speed and cut length do not change it."""

    def per_material(x: FloatArray) -> FloatArray:
        return np.asarray(ratio / np.sqrt(1.0 - (ratio * (x - 0.5 * zone) / radius) ** 2))

    return fit_profile(per_material, 0.0, zone)
