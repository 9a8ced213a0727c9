"""The rotary knife: blades on a drum that turns one way, its edge moving with the material during the cut."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, ClassVar, Literal

import numpy as np

from camwright.profiles.cut import Cut
from camwright.profiles.errors import InputError
from camwright.profiles.machines.machine import Machine, SlaveUnit, straight_sync
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
    sync
        Which speed of the blade is in sync.
    drum_inertia
        Inertia of drum, gear and motor at the drum (kg·m²).
    drum_friction
        Friction torque at the drum (N·m).
    """

    slave_unit: ClassVar[SlaveUnit] = "m"

    circumference: float
    blades: int = 1
    gear_ratio: float = 1.0
    sync: Sync = "tangential"
    drum_inertia: float = 0.0
    drum_friction: float = 0.0

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
            raise InputError(
                f"[cut] sync_zone {cut.sync_zone * 1e3:.6g} mm takes the blade beyond ±{math.degrees(GREATEST_ANGLE):.0f}° from the cut "
                f"point, where horizontal sync ends; the longest possible is "
                f"{self.greatest_sync_zone(cut.sync_ratio) * 1e3:.6g} mm"
            )
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

    def tangential_mismatch(self, cut: Cut) -> float:
        """Share by which the edge's speed along the material falls short of its speed in sync at the ends of a tangential sync zone.

        The edge moves at ``s`` times the line speed on its circle, ``s`` the sync ratio, so along the material it moves at ``cos(y / r)``
        of that: ``1 - cos(s l_s / 2 r)``.
        """
        return 1.0 - math.cos(min(0.5 * cut.sync_ratio * cut.sync_zone / self.radius, math.pi))


@lru_cache(maxsize=256)
def _horizontal(radius: float, zone: float, ratio: float) -> CamProfile:
    """Edge travel in horizontal sync; kept, because line speed and cut length do not change it."""

    def per_material(x: FloatArray) -> FloatArray:
        return np.asarray(ratio / np.sqrt(1.0 - (ratio * (x - 0.5 * zone) / radius) ** 2))

    return fit_profile(per_material, 0.0, zone)
