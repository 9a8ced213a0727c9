"""The crank-slider: a chasing shear whose carriage is driven by a crank that always turns the same way (S3)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, ClassVar

import numpy as np

from camwright.profiles.cut import Cut
from camwright.profiles.errors import InputError
from camwright.profiles.machines.machine import Machine, SlaveUnit
from camwright.profiles.polynomial.fitting import fit_profile
from camwright.profiles.polynomial.profile import CamProfile, FloatArray

_SETTLED = 1e-15
"""Step of the inverse map (rad) that is rounding."""
_MOST_STEPS = 64
"""Steps of the inverse map: bisection alone needs no more."""


@dataclass(frozen=True)
class CrankSlider(Machine):
    """A carriage driven by a crank and a rod (S3).

    The slave coordinate ``alpha`` is the crank angle (rad). The carriage stands at ``X(alpha) = -R cos alpha + sqrt(L² - (R sin alpha
    - E)²)``; it moves with the material, in positive direction, between the two dead centres, where the crank passes about 90°.

    Parameters
    ----------
    crank
        Crank radius ``R`` (m).
    rod
        Rod length ``L`` (m), above ``R + |E|``.
    offset
        Distance ``E`` of the crank's centre from the carriage's line (m).
    crank_inertia
        Inertia of crank, rod's rotating share, gear and motor at the crank (kg·m²).
    carriage_mass
        Mass of the carriage with the rod's other share (kg).
    gear_ratio
        Motor turns per crank turn.
    sync_at
        Crank angle at mid sync zone (rad); not a number while the design is free to choose it.
    """

    slave_unit: ClassVar[SlaveUnit] = "rad"

    crank: float
    rod: float
    offset: float = 0.0
    crank_inertia: float = 0.0
    carriage_mass: float = 0.0
    gear_ratio: float = 1.0
    sync_at: float = math.nan

    @property
    def pitch(self) -> float:
        """One turn (rad)."""
        return 2 * math.pi

    @property
    def motor_ratio(self) -> float:
        """Motor angle per crank angle."""
        return self.gear_ratio

    def tool(self, y: Any) -> Any:
        """Carriage position ``X(alpha)`` (m)."""
        across = self.crank * np.sin(y) - self.offset
        return -self.crank * np.cos(y) + np.sqrt(self.rod**2 - across**2)

    def tool_ratio(self, y: Any) -> Any:
        """``X'(alpha)`` (m/rad)."""
        across = self.crank * np.sin(y) - self.offset
        along = np.sqrt(self.rod**2 - across**2)
        return self.crank * (np.sin(y) - across * np.cos(y) / along)

    def tool_curvature(self, y: Any) -> Any:
        """``X''(alpha)`` (m/rad²)."""
        across = self.crank * np.sin(y) - self.offset
        along = np.sqrt(self.rod**2 - across**2)
        reach = self.crank * np.cos(y)
        return reach + self.crank * across * np.sin(y) / along - reach**2 * self.rod**2 / along**3

    def inertia(self, y: Any) -> Any:
        """Inertia at the crank: ``J + m X'²`` (kg·m²)."""
        return self.crank_inertia + self.carriage_mass * self.tool_ratio(y) ** 2

    def inertia_slope(self, y: Any) -> Any:
        """``2 m X' X''`` (kg·m²/rad)."""
        return 2 * self.carriage_mass * self.tool_ratio(y) * self.tool_curvature(y)

    @property
    def dead_centres(self) -> tuple[float, float]:
        """Crank angles between which the carriage moves forwards: crank and rod in one line, folded and stretched.

        Folded, ``X = L - R`` measured along the rod: ``sin(alpha) = -E / (L - R)``, ``alpha`` near 0. Stretched, ``X = L + R`` alike:
        ``sin(alpha) = E / (L + R)``, ``alpha`` near pi.
        """
        return math.asin(self.offset / (self.crank - self.rod)), math.pi + math.asin(
            -self.offset / (self.rod + self.crank)
        )

    @property
    def stroke(self) -> float:
        """Carriage travel between the dead centres (m)."""
        back, front = self.dead_centres
        return float(self.tool(front) - self.tool(back))

    def sync_start(self, cut: Cut) -> float:
        """Crank angle at the start of the sync zone (rad)."""
        if math.isnan(self.sync_at):
            raise InputError(
                "the place of the sync zone on the crank is not chosen yet; design the job first, or give [machine] sync_at"
            )
        return _sync_start(self, cut.sync_zone, cut.sync_ratio)

    def sync_range(self, cut: Cut) -> tuple[float, float]:
        """Crank angles between which `sync_at` must lie for the sync zone to fit between the dead centres (rad)."""
        return _sync_range(self, cut.sync_ratio * cut.sync_zone)

    def sync_profile(self, cut: Cut) -> CamProfile:
        """Crank angle in the sync zone: ``X(alpha) = X(alpha_start) + s x`` with the sync ratio ``s``."""
        return _in_sync(self, self.sync_start(cut), cut.sync_zone, cut.sync_ratio)

    def angle_at(self, position: FloatArray) -> FloatArray:
        """Crank angle of the forward stroke at which the carriage stands at a position (m), by safeguarded Newton steps."""
        back, front = self.dead_centres
        low, high = np.full(position.shape, back), np.full(position.shape, front)
        angle = 0.5 * (low + high)
        for _ in range(_MOST_STEPS):
            gap = np.asarray(self.tool(angle)) - position
            low, high = np.where(gap <= 0, angle, low), np.where(gap >= 0, angle, high)
            with np.errstate(divide="ignore", invalid="ignore"):
                step = angle - gap / np.asarray(self.tool_ratio(angle))
            new = np.where((step > low) & (step < high), step, 0.5 * (low + high))
            settled = np.all(np.abs(new - angle) <= _SETTLED)
            angle = new
            if settled:
                break
        return np.asarray(angle)


@lru_cache(maxsize=256)
def _sync_start(machine: CrankSlider, zone: float, ratio: float) -> float:
    """Crank angle at the start of the sync zone; kept, because line speed and cut length do not change it."""
    travel = ratio * zone
    if travel >= machine.stroke:
        raise InputError(
            f"[cut] sync_zone needs {travel * 1e3:.6g} mm of carriage travel, the crank's stroke is {machine.stroke * 1e3:.6g} mm; shorten "
            f"the sync zone below {machine.stroke / ratio * 1e3:.6g} mm or take a longer crank"
        )
    middle = float(machine.tool(machine.sync_at))
    back, front = machine.dead_centres
    behind = middle - 0.5 * travel - float(machine.tool(back))
    ahead = float(machine.tool(front)) - middle - 0.5 * travel
    if not (back < machine.sync_at < front and behind > 0 and ahead > 0):
        least, greatest = _sync_range(machine, travel)
        raise InputError(
            f"[machine] sync_at = {math.degrees(machine.sync_at):.6g} deg leaves no room for the sync zone between the dead centres; it "
            f"must lie between {math.degrees(least):.6g} deg and {math.degrees(greatest):.6g} deg"
        )
    return float(machine.angle_at(np.array([middle - 0.5 * travel]))[0])


def _sync_range(machine: CrankSlider, travel: float) -> tuple[float, float]:
    """Crank angles between which the middle of a carriage travel must lie."""
    back, front = machine.dead_centres
    ends = np.array([float(machine.tool(back)) + 0.5 * travel, float(machine.tool(front)) - 0.5 * travel])
    least, greatest = machine.angle_at(ends)
    return float(least), float(greatest)


@lru_cache(maxsize=256)
def _in_sync(machine: CrankSlider, start: float, zone: float, ratio: float) -> CamProfile:
    """Crank angle in sync; kept, because line speed and cut length do not change it."""
    from_here = float(machine.tool(start))

    def per_material(x: FloatArray) -> FloatArray:
        return np.asarray(ratio / machine.tool_ratio(machine.angle_at(from_here + ratio * x)))

    return fit_profile(per_material, 0.0, zone)
