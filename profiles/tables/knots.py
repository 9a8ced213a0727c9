"""Choosing the points of a table: as few as keep the rebuilt motion within the stated error."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.tables.cam_table import (
    CamTable,
    PieceLaw,
    Unit,
    Units,
    sample_profile,
)
from camwright.profiles.tables.candidates import candidates, required_points, zone_ends
from camwright.profiles.tables.deviation import Deviation, deviation, glance
from camwright.profiles.tables.interpolation import in_format
from camwright.profiles.tables.number_formats import NumberFormat, rounded
from camwright.profiles.tables.target import Target


@dataclass(frozen=True)
class Accuracy:
    """What the rebuilt motion may be off the profile.

    Parameters
    ----------
    position
        Of the slave (slave unit).
    ratio
        Of the ratio.
    acceleration
        Of the acceleration, relative to its greatest value.
    """

    position: float = 1e-6
    ratio: float = 1e-3
    acceleration: float = 0.01

    def kept_by(self, found: Deviation) -> bool:
        """Say whether a deviation keeps within; an acceleration that is unbounded by its law is not judged here."""
        near = found.position <= self.position and found.ratio <= self.ratio
        return near and (found.acceleration is None or found.acceleration <= self.acceleration)


@dataclass(frozen=True)
class Choice:
    """A table, the motion that the drive makes of it (SI units), and how far that is off."""

    table: CamTable
    rebuilt: CamProfile
    deviation: Deviation


def choose(
    profile: CamProfile,
    target: Target,
    units: Units,
    accuracy: Accuracy,
    points: int | None = None,
    zones: Sequence[float] | None = None,
) -> Choice:
    """Choose the points of a table.

    The ends of the zones always get points. A target that carries the profile's pieces gets one at every break; if it
    takes fewer points, or the pieces are of a degree that it does not carry, points go where they help most. All others
    get a point at every break too, or if they must be evenly spaced a spacing that the zones' ends are multiples of, and
    as many points between as the accuracy asks for; breaks that lie close together share one where that serves better.
    Of tables that all miss the accuracy the nearest is taken: in float32 that is not the one with the most points.

    Parameters
    ----------
    profile
        One cycle, in SI units.
    target
        What the table is for.
    units
        Units of the table.
    accuracy
        What the rebuilt motion may be off.
    points
        Number of points, if the user insists; what can be had nearest to it is taken.
    zones
        Where the zones begin and end inside the cycle (m); the ends of straight pieces if not given.

    Raises
    ------
    InputError
        The number of points is out of the target's range, or the target cannot take the profile at all.
    """
    if points is not None:
        most = target.max_points or points
        if not target.min_points <= points <= most:
            raise InputError(f"{target.name} takes {target.min_points} to {most} points; {points} are asked for")
    required = required_points(profile, zone_ends(profile) if zones is None else zones)
    least, greatest = profile.extrema(2)
    peak = max(-least.value, greatest.value, 1e-300)
    allowed = np.array([accuracy.position, accuracy.ratio, accuracy.acceleration * peak])
    tried: list[tuple[float, int, FloatArray]] = []
    for x in candidates(profile, target, required, allowed, points):
        table, rebuilt = _rebuilt(profile, target, units, x)
        bound = _misses(glance(profile, rebuilt, peak), accuracy)
        if points is None and bound <= 1.0:
            choice = Choice(table, rebuilt, deviation(profile, rebuilt))
            if accuracy.kept_by(choice.deviation):
                return choice
        tried.append((bound, len(tried), x))
    if not tried:
        raise InputError(
            f"{target.name} takes at most {points or target.max_points} points, too few for the pieces of this profile"
        )
    if points is not None:  # of the points asked for, the last candidate has the most
        return _chosen(profile, target, units, tried[-1][2])
    return _nearest(profile, target, units, accuracy, tried)


def _nearest(
    profile: CamProfile,
    target: Target,
    units: Units,
    accuracy: Accuracy,
    tried: Sequence[tuple[float, int, FloatArray]],
) -> Choice:
    """Choose the candidate with the least deviation; of equals the first.

    Candidates come with what they miss the accuracy by at least, so most of them need not be looked at closely.
    """
    order = sorted(tried, key=lambda entry: entry[:2])
    best = _chosen(profile, target, units, order[0][2])
    least = _misses(best.deviation, accuracy), order[0][1]
    for bound, number, x in order[1:]:
        if bound > least[0]:
            break
        choice = _chosen(profile, target, units, x)
        found = _misses(choice.deviation, accuracy), number
        if found < least:
            best, least = choice, found
    return best


def _misses(found: Deviation, accuracy: Accuracy) -> float:
    """By how many times the worst deviation exceeds what it may be."""
    acceleration = 0.0 if found.acceleration is None else found.acceleration / accuracy.acceleration
    return max(found.position / accuracy.position, found.ratio / accuracy.ratio, acceleration)


def _chosen(profile: CamProfile, target: Target, units: Units, x: FloatArray) -> Choice:
    table, rebuilt = _rebuilt(profile, target, units, x)
    return Choice(table, rebuilt, deviation(profile, rebuilt))


def _rebuilt(profile: CamProfile, target: Target, units: Units, x: FloatArray) -> tuple[CamTable, CamProfile]:
    """Sample the profile where the target's number format can put its points, and rebuild the motion."""
    if target.spacing == "equidistant" and target.number_format == "int32":  # the drive counts points
        finest = Unit("0.1um", 1e-7) if units.slave.si == "m" else Unit("1e-5deg", math.radians(1e-5), "rad")
        units = Units(Unit("step", profile.length / (len(x) - 1)), finest)
    # the chord between two points in float32 has not quite the ratio that its neighbours end with
    straight = target.states_laws and target.number_format == "float64"
    return _sampled(profile, target.law, target.number_format, target.rebuild, units, x.tobytes(), straight)


@lru_cache(maxsize=64)  # many targets put the same law through the same points
def _sampled(
    profile: CamProfile,
    law: PieceLaw,
    number_format: NumberFormat,
    rebuild: Callable[[CamTable], CamProfile],
    units: Units,
    places: bytes,
    straight: bool,
) -> tuple[CamTable, CamProfile]:
    size = units.master.size
    placed = rounded(np.frombuffer(places) / size, number_format) * size
    table = sample_profile(profile, np.clip(placed, profile.start, profile.end), units, law)
    if not straight:
        table = replace(table, laws=(law,) * len(table.laws))
    stored = in_format(table, "int32") if number_format == "int32" else table  # as it will be written
    return table, units.to_si(rebuild(stored))


def table_units(target: Target, profile: CamProfile, units: Units) -> Units:
    """Give the units that a target needs: the user's, or where it counts in its own, those.

    Parameters
    ----------
    target
        What the table is for.
    profile
        One cycle, in SI units.
    units
        The user's units.

    Raises
    ------
    InputError
        A target with whole periods, and no decimal part of the user's units in which both periods are whole.
    """
    turned = units.slave.si == "rad"
    if target.name == "twincat-cnc":
        slave = Unit("1e-4deg", math.radians(1e-4), "rad") if turned else Unit("1e-4mm", 1e-7)
        return Units(Unit("1e-4deg", profile.length / 3_600_000), slave)
    if target.name == "csv":
        return Units(Unit("m", 1.0), Unit("rad", 1.0, "rad") if turned else Unit("m", 1.0))
    if target.name == "br":
        return Units(_whole(units.master, profile.length), _whole(units.slave, profile.advance))
    return units


def _whole(unit: Unit, length: float) -> Unit:
    """Give the unit, or the largest decimal part of it, of which a length is a whole multiple."""
    for power in range(7):
        part = Unit(unit.symbol if power == 0 else f"1e-{power}{unit.symbol}", unit.size * 10.0**-power, unit.si)
        count = length / part.size
        if abs(count - round(count)) <= 1e-9 * max(1.0, abs(count)) and abs(count) <= 2**24:
            return part
    raise InputError(
        f"this drive takes whole periods, and {length / unit.size!r} {unit.symbol} is no whole number of a decimal "
        f"part of {unit.symbol} up to 16777216; choose another unit with --units"
    )
