"""The crank-slider: a chasing shear whose carriage is driven by a crank that always turns the same way (S3)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Annotated, Any, ClassVar

import numpy as np

from camwright.profiles.cut import Cut
from camwright.profiles.errors import InputError
from camwright.profiles.machines.fields import GEAR_RATIO, Quantity
from camwright.profiles.machines.linear_carriage import LinearCarriage
from camwright.profiles.machines.machine import Machine, SlaveUnit
from camwright.profiles.message import Message, Value
from camwright.profiles.polynomial.fitting import fit_profile
from camwright.profiles.polynomial.profile import CamProfile, FloatArray

_SETTLED, _ROUNDING = 1e-15, 2e-16
"""Step of the inverse map (rad), and gap left as a share of crank and rod, that are rounding."""
_MOST_STEPS = 64
"""Steps of the inverse map, and of the place of least speed: bisection alone needs no more."""
_NOT_CHOSEN = (
    "the place of the sync zone on the crank is not chosen yet; design the job first, or give {@machine.sync_at}"
)


_STROKES = 100.0
"""Cut lengths up to this multiple of the stroke."""


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

    Examples
    --------
    >>> from camwright import CrankSlider
    >>> crank = CrankSlider(crank=0.15, rod=0.6)
    >>> crank.placed, round(crank.stroke, 9)           # the design places the sync zone
    (False, 0.3)
    """

    kind: ClassVar[str] = "crank_slider"
    noun: ClassVar[str] = "crank"
    summary: ClassVar[str] = "A carriage driven by a crank and a rod: chasing shear."
    slave_unit: ClassVar[SlaveUnit] = "rad"
    place_name: ClassVar[str] = "sync_at"
    own_baselines: ClassVar[tuple[str, ...]] = ("crank_tabulated",)

    crank: Annotated[float, Quantity("length", example="150 mm", shown=True, description="crank radius")]
    rod: Annotated[float, Quantity("length", shown=True, description="rod length")]
    offset: Annotated[
        float,
        Quantity(
            "length",
            signed=True,
            example="0 mm",
            shown=True,
            description="distance of the crank's centre from the carriage's line",
        ),
    ] = 0.0
    crank_inertia: Annotated[
        float,
        Quantity(
            "inertia",
            zero=True,
            usual="0.5 kg m^2",
            description="inertia of crank, rod's rotating share, gear and motor, at the crank",
        ),
    ] = 0.0
    carriage_mass: Annotated[
        float, Quantity("mass", zero=True, description="mass of the carriage with the rod's other share")
    ] = 0.0
    gear_ratio: Annotated[float, GEAR_RATIO] = 1.0
    sync_at: Annotated[
        float,
        Quantity("angle", signed=True, description="crank angle at mid sync zone; the design's to choose if left out"),
    ] = math.nan

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
            raise InputError(Message(_NOT_CHOSEN))
        return _sync_start(self, cut.sync_zone, cut.sync_ratio)

    def place_range(self, cut: Cut) -> tuple[float, float]:
        """Crank angles between which `sync_at` must lie for the sync zone to fit between the dead centres (rad)."""
        if cut.sync_ratio * cut.sync_zone >= self.stroke:
            raise InputError(*self.zone_faults(cut))
        return _place_range(self, cut.sync_ratio * cut.sync_zone)

    def faults(self) -> tuple[Message, ...]:
        """Say that the crank cannot turn all the way round."""
        least, longest = self.crank + abs(self.offset), self.rod - abs(self.offset)
        if self.rod > least:
            return ()
        values = {
            "rod": Value(self.rod, "m"),
            "least": Value(least, "m"),
            "longer": Value(least, "m", toward="above"),
            "shorter": Value(longest, "m", toward="below"),
        }
        text = (
            "{@machine.rod} = {rod}: not above {@machine.crank} + |offset| = {least}, so the crank could not turn all the way round; "
            "lengthen the rod to {longer} at least"
            + (", or shorten the crank to {shorter} at most" if longest > 0 else "")
        )
        return (Message(text, tuple(values.items())),)

    def zone_faults(self, cut: Cut, angle: float | None = None) -> tuple[Message, ...]:
        """Say that the sync zone does not fit between the dead centres, or not where it is placed."""
        del angle  # that is a knife's
        travel = cut.sync_ratio * cut.sync_zone
        zone = ("zone", Value(cut.sync_zone, "m"))
        if travel >= self.stroke:
            values = {
                "travel": Value(travel, "m"),
                "stroke": Value(self.stroke, "m"),
                "shorter": Value(self.stroke / cut.sync_ratio, "m", toward="below"),
            }
            text = (
                "{@sync_zone} = {zone}: the carriage would travel {travel}, not below the crank's stroke of {stroke}; shorten the sync "
                "zone to {shorter} at most, or take a longer crank"
            )
            return (Message(text, (zone, *values.items())),)
        if math.isnan(self.sync_at):
            return ()
        least, greatest = _place_range(self, travel)
        return () if least < self.sync_at < greatest else (_misplaced(self, cut.sync_zone, travel),)

    def longest_cut(self, sync_zone: float) -> float:
        """Longest cut (m): beyond a hundred strokes a baseline turns the crank hundreds of times to and fro."""
        return min(super().longest_cut(sync_zone), _STROKES * self.stroke)

    def sync_pace(self, cut: Cut) -> float:
        """Greatest crank speed over line speed in the sync zone (rad/m); where its place is free the least such, over its places.

        The tool ratio has one maximum in the forward stroke, so it is least at one of the zone's ends; and a crank needs least speed
        where it is the same at both.
        """
        if self.placed:
            return cut.sync_ratio / min(_end_ratios(self, cut))
        low, high = self.place_range(cut)
        for _ in range(_MOST_STEPS):
            middle = 0.5 * (low + high)
            first, last = _end_ratios(self.placed_at(middle), cut)
            if first < last:  # slower at the start: move on
                low = middle
            else:
                high = middle
        return cut.sync_ratio / min(first, last)

    def on_screw(self, carriage_speed: float, motor_speed: float) -> LinearCarriage | None:
        """Put the carriage on a screw: what S3 compares the crank with; None for a carriage of no mass.

        The carriage's mass and its stroke are those of the crank's. The lead is such that the motor has its greatest speed when the
        carriage has its own. Screw, coupling and motor add no mass, which favours the screw; a crank's inertia holds all that turns.
        """
        if self.carriage_mass == 0.0:
            return None
        lead = 2 * math.pi * carriage_speed / motor_speed
        return LinearCarriage(stroke=self.stroke, mass=self.carriage_mass, travel_per_turn=lead)

    def sync_profile(self, cut: Cut) -> CamProfile:
        """Crank angle in the sync zone: ``X(alpha) = X(alpha_start) + s x`` with the sync ratio ``s``."""
        return _in_sync(self, self.sync_start(cut), cut.sync_zone, cut.sync_ratio)

    def angle_at(self, position: FloatArray) -> FloatArray:
        """Crank angle of the forward stroke at which the carriage stands at a position (m).

        The pin lies at ``(-R cos alpha, R sin alpha)``, a rod ``L`` away from the carriage at ``(X, E)``: ``X cos alpha - E sin alpha =
        (L² - R² - E² - X²) / 2 R``. Solved for ``alpha``, then by safeguarded Newton steps down to rounding.
        """
        back, front = self.dead_centres
        low, high = np.full(position.shape, back), np.full(position.shape, front)
        across = self.rod**2 - self.crank**2 - self.offset**2 - position**2
        with np.errstate(divide="ignore", invalid="ignore"):
            cosine = across / (2 * self.crank * np.hypot(position, self.offset))
        angle = np.arccos(np.clip(cosine, -1.0, 1.0)) - np.arctan2(self.offset, position)
        angle = np.clip(angle, low, high)
        rounding = _ROUNDING * (self.crank + self.rod)
        for _ in range(_MOST_STEPS):
            gap = np.asarray(self.tool(angle)) - position
            low, high = np.where(gap <= 0, angle, low), np.where(gap >= 0, angle, high)
            with np.errstate(divide="ignore", invalid="ignore"):
                step = angle - gap / np.asarray(self.tool_ratio(angle))
            met = np.abs(gap) <= rounding
            new = np.where((step > low) & (step < high), step, np.where(met, angle, 0.5 * (low + high)))
            settled = np.all(met | (np.abs(new - angle) <= _SETTLED))
            angle = new
            if settled:
                break
        return np.asarray(angle)


@lru_cache(maxsize=256)
def _sync_start(machine: CrankSlider, zone: float, ratio: float) -> float:
    """Crank angle at the start of the sync zone; kept, because line speed and cut length do not change it."""
    travel = ratio * zone
    if travel >= machine.stroke:
        raise InputError(*machine.zone_faults(Cut(2.0 * zone, 1.0, zone, 0.0, 0.0, 1e-4, sync_ratio=ratio)))
    middle = float(machine.tool(machine.sync_at))
    back, front = machine.dead_centres
    behind = middle - 0.5 * travel - float(machine.tool(back))
    ahead = float(machine.tool(front)) - middle - 0.5 * travel
    if not (back < machine.sync_at < front and behind > 0 and ahead > 0):
        raise InputError(_misplaced(machine, zone, travel))
    return float(machine.angle_at(np.array([middle - 0.5 * travel]))[0])


def _misplaced(machine: CrankSlider, zone: float, travel: float) -> Message:
    """Say that the sync zone leaves the forward stroke where it is placed."""
    least, greatest = _place_range(machine, travel)
    values = {
        "at": Value(machine.sync_at, "rad"),
        "zone": Value(zone, "m"),
        "least": Value(least, "rad", toward="above"),
        "greatest": Value(greatest, "rad", toward="below"),
    }
    text = (
        "{@machine.sync_at} = {at}: leaves no room for the sync zone of {zone} between the dead centres; place it between {least} and "
        "{greatest}, or leave it out, and the design chooses"
    )
    return Message(text, tuple(values.items()))


def _place_range(machine: CrankSlider, travel: float) -> tuple[float, float]:
    """Crank angles between which the middle of a carriage travel must lie."""
    back, front = machine.dead_centres
    ends = np.array([float(machine.tool(back)) + 0.5 * travel, float(machine.tool(front)) - 0.5 * travel])
    least, greatest = machine.angle_at(ends)
    return float(least), float(greatest)


def _end_ratios(machine: CrankSlider, cut: Cut) -> tuple[float, float]:
    """Tool ratio at both ends of the sync zone (m/rad)."""
    half = 0.5 * cut.sync_ratio * cut.sync_zone
    middle = float(machine.tool(machine.sync_at))
    first, last = machine.tool_ratio(machine.angle_at(np.array([middle - half, middle + half])))
    return float(first), float(last)


@lru_cache(maxsize=256)
def _in_sync(machine: CrankSlider, start: float, zone: float, ratio: float) -> CamProfile:
    """Crank angle in sync; kept, because line speed and cut length do not change it."""
    from_here = float(machine.tool(start))

    def per_material(x: FloatArray) -> FloatArray:
        return np.asarray(ratio / machine.tool_ratio(machine.angle_at(from_here + ratio * x)))

    return fit_profile(per_material, 0.0, zone)
