"""Choosing the points of a table: as few as keep the rebuilt motion within the stated error."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from camwright.profiles.errors import InputError
from camwright.profiles.machines.machine import SlaveUnit
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.tables.cam_table import (
    CamTable,
    PieceLaw,
    TableUnits,
    Unit,
    sample_profile,
)
from camwright.profiles.tables.candidates import candidates, required_points, zone_ends
from camwright.profiles.tables.csv_target import CSV_LENGTHS
from camwright.profiles.tables.deviation import Deviation, deviation, glance
from camwright.profiles.tables.interpolation import in_format
from camwright.profiles.tables.number_formats import NumberFormat, rounded
from camwright.profiles.tables.target import Target

_STEP = "step"
"""Symbol of a master unit that is one step of an evenly spaced table."""

_MOST_CUTS = 24
"""Most cuts in one table."""

_WHOLE = 1e-6
"""What a whole number of counts may be off by rounding."""


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
class ChosenTable:
    """A table, the motion that the drive makes of it (SI units), and how far that is off."""

    table: CamTable
    rebuilt: CamProfile
    deviation: Deviation


def choose(
    profile: CamProfile,
    target: Target,
    units: TableUnits,
    accuracy: Accuracy,
    points: int | None = None,
    zones: Sequence[float] | None = None,
) -> ChosenTable:
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
    if points is not None and not target.min_points <= points <= (target.max_points or points):
        most = target.max_points or points
        raise InputError(f"{target.name} takes {target.min_points} to {most} points; {points} are asked for")
    peak = max(profile.peak(2), 1e-300)
    allowed = np.array([accuracy.position, accuracy.ratio, accuracy.acceleration * peak])
    tried: list[tuple[float, int, FloatArray]] = []
    for x in _places(profile, target, units.master, allowed, points, zones):
        table, rebuilt = _rebuilt(profile, target, units, x)
        bound = _misses(glance(profile, rebuilt, peak), accuracy)
        if points is None and bound <= 1.0:
            choice = ChosenTable(table, rebuilt, deviation(profile, rebuilt))
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
    units: TableUnits,
    accuracy: Accuracy,
    tried: Sequence[tuple[float, int, FloatArray]],
) -> ChosenTable:
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


def _chosen(profile: CamProfile, target: Target, units: TableUnits, x: FloatArray) -> ChosenTable:
    table, rebuilt = _rebuilt(profile, target, units, x)
    return ChosenTable(table, rebuilt, deviation(profile, rebuilt))


def _rebuilt(profile: CamProfile, target: Target, units: TableUnits, x: FloatArray) -> tuple[CamTable, CamProfile]:
    """Sample the profile where the target's number format can put its points, and rebuild the motion."""
    if units.master.symbol == _STEP:  # the drive counts points
        units = TableUnits(Unit(_STEP, profile.length / (len(x) - 1)), units.slave)
    # the chord between two points in float32 has not quite the ratio that its neighbours end with
    straight = target.states_laws and target.number_format == "float64"
    return _sampled(profile, target.law, target.number_format, target.rebuild, units, x.tobytes(), straight)


@lru_cache(maxsize=64)  # many targets put the same law through the same points
def _sampled(
    profile: CamProfile,
    law: PieceLaw,
    number_format: NumberFormat,
    rebuild: Callable[[CamTable], CamProfile],
    units: TableUnits,
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


def _places(
    profile: CamProfile,
    target: Target,
    master: Unit,
    allowed: FloatArray,
    points: int | None,
    zones: Sequence[float] | None,
) -> Iterable[FloatArray]:
    """Give the places of points to try: whole steps of the master for a target that knows no others, else those of `choose`."""
    if target.master_steps and master.symbol != _STEP:
        return _whole_steps(profile, target, master, points)
    required = required_points(profile, zone_ends(profile) if zones is None else zones)
    return candidates(profile, target, required, allowed, points)


def _whole_steps(profile: CamProfile, target: Target, master: Unit, points: int | None) -> list[FloatArray]:
    """Even spacings of whole counts of the master, wide ones first.

    Raises
    ------
    InputError
        The cycle is no whole number of counts, or no spacing of the target's divides it into few enough points.
    """
    count = round(profile.length / master.size)
    if not _is_whole(profile.length / master.size):
        raise InputError(
            f"{target.name} stores the master in whole counts, and the cycle of {profile.length * 1e3:.10g} mm is "
            f"{profile.length / master.size:.10g} of {master.symbol}; name a count that divides it with --units"
        )
    most = min(points or target.max_points or count + 1, target.max_points or count + 1)
    found = [
        np.linspace(profile.start, profile.end, count // step + 1)
        for step in sorted(target.master_steps, reverse=True)
        if count % step == 0 and max(2, target.min_points) <= count // step + 1 <= most
    ]
    if not found:
        raise InputError(
            f"{target.name} takes at most {most} points spaced by {', '.join(map(str, target.master_steps))} counts, and none of "
            f"these divides the {count} counts of {master.symbol} in the cycle; name another count with --units"
        )
    return found


def closing_cuts(target: Target, profile: CamProfile, units: TableUnits) -> int:
    """Count the cuts after which whole counts of the user's encoders close: the cycle of the table; 1 if there are none up to 24."""
    if not target.counts or units.master.symbol == units.slave.symbol == _STEP:
        return 1
    spans = [(profile.advance, units.slave.size)]
    if target.master_steps and units.master.symbol != _STEP:
        spans.append((profile.length, units.master.size))
    return next((cuts for cuts in range(1, _MOST_CUTS + 1) if all(_is_whole(cuts * a / size) for a, size in spans)), 1)


def _is_whole(number: float) -> bool:
    return abs(number - round(number)) <= _WHOLE


def _finest(travel: float, si: SlaveUnit) -> Unit:
    """Give the count of a drive whose encoder nobody named: a ten-thousandth of a millimetre, or so near to it that the cycle closes."""
    finest = Unit("0.1um", 1e-7) if si == "m" else Unit("1e-5deg", math.radians(1e-5), "rad")
    counts = travel / finest.size
    return finest if _is_whole(counts) else Unit("count", travel / round(counts), si)


def table_units(
    target: Target, profile: CamProfile, units: TableUnits, *, asked: bool = False, travel: float | None = None
) -> TableUnits:
    """Give the units that a target needs: the user's, or where it counts in its own, those.

    Parameters
    ----------
    target
        What the table is for.
    profile
        One cycle, in SI units.
    asked
        Whether the user named them: they are obeyed, or refused.
    travel
        What is to be a whole number of counts where no unit was named (slave unit): the pitch of the machine, for its ramps too;
        the profile's advance if not given.

    Raises
    ------
    InputError
        A target with whole periods, and no decimal part of the user's units in which both periods are whole; or one that cannot
        have the units that the user named.
    """
    turned = units.slave.si == "rad"
    if target.counts:
        return _counted(target, profile, units, profile.advance if travel is None else travel, asked=asked)
    if target.name == "twincat-cnc":
        if asked:
            raise InputError(
                f"{target.name} counts the master in 1e-4 deg and the slave in {'1e-4 deg' if turned else '1e-4 mm'}; leave --units out"
            )
        slave = Unit("1e-4deg", math.radians(1e-4), "rad") if turned else Unit("1e-4mm", 1e-7)
        return TableUnits(Unit("1e-4deg", profile.length / 3_600_000), slave)
    if target.name == "csv":
        metre = Unit("metre", 1.0)
        if not asked:
            return TableUnits(metre, Unit("rad", 1.0, "rad") if turned else metre)
        if turned or not {units.master.symbol, units.slave.symbol} <= CSV_LENGTHS.keys():
            raise InputError(
                f"csv takes {', '.join(CSV_LENGTHS)} by name for a slave that is a length, and writes rad for one that turns; "
                f"got {units.master.symbol},{units.slave.symbol}"
            )
        return units
    if target.name == "br":
        return TableUnits(_whole(units.master, profile.length), _whole(units.slave, profile.advance))
    return units


def _counted(target: Target, profile: CamProfile, units: TableUnits, travel: float, *, asked: bool) -> TableUnits:
    """Give the units of a target that stores whole counts: the user's where they were asked for, else the finest that its numbers hold."""
    if not asked:
        return TableUnits(Unit(_STEP, profile.length), _finest(travel, units.slave.si))
    if not units.slave.counted:
        raise InputError(
            f"{target.name} stores whole counts of the slave, and {units.slave.symbol} is no count; write the size of one, as in "
            '--units "mm,9.25 um", or the counts of a turn, as in --units mm,36000/rev'
        )
    return units if target.master_steps else TableUnits(Unit(_STEP, profile.length), units.slave)


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
