"""Choosing the points of a table: as few as keep the rebuilt motion within the stated error."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from profiles.errors import InputError
from profiles.polynomial import CamProfile, FloatArray
from profiles.tables.cam_table import CamTable, Unit, Units, sample_profile
from profiles.tables.deviation import Deviation, deviation
from profiles.tables.number_formats import rounded
from profiles.tables.target import Target

MOST_SPLINE = 1000
"""Points beyond which splines are not refined: the file grows, the motion does not improve."""
MOST_LINE = 4097
_GROWTH = 1.2
_MOST_DIVISIONS = 720
_EXACT_DEGREE = 5


@dataclass(frozen=True)
class Accuracy:
    """What the rebuilt motion may be off the profile.

    Parameters
    ----------
    position
        Of the slave (m).
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


def choose(profile: CamProfile, target: Target, units: Units, accuracy: Accuracy, points: int | None = None) -> Choice:
    """Choose the points of a table.

    A target that carries the profile's pieces gets a point at every break; if it takes fewer points, or the pieces are
    of a degree that it does not carry, points go where they help most. All others get a point at every break too, or if
    they must be evenly spaced a spacing that the breaks are multiples of, and as many points between as the accuracy
    asks for. Of tables that all miss the accuracy the nearest is taken: in float32 that is not the one with the most
    points.

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

    Raises
    ------
    InputError
        The number of points is out of the target's range, or the target cannot take the profile at all.
    """
    if points is not None:
        most = target.max_points or points
        if not target.min_points <= points <= most:
            raise InputError(f"{target.name} takes {target.min_points} to {most} points; {points} are asked for")
    best: Choice | None = None
    for x in _candidates(profile, target, points):
        choice = _try(profile, target, units, x)
        if best is None or points is not None or _misses(choice, accuracy) < _misses(best, accuracy):
            best = choice  # of the points asked for, the last candidate has the most
        if points is None and accuracy.kept_by(choice.deviation):
            return choice
    if best is None:
        raise InputError(
            f"{target.name} takes at most {points or target.max_points} points, too few for the pieces of this profile"
        )
    return best


def _misses(choice: Choice, accuracy: Accuracy) -> float:
    """By how many times the worst deviation exceeds what it may be."""
    found = choice.deviation
    acceleration = 0.0 if found.acceleration is None else found.acceleration / accuracy.acceleration
    return max(found.position / accuracy.position, found.ratio / accuracy.ratio, acceleration)


def _try(profile: CamProfile, target: Target, units: Units, x: FloatArray) -> Choice:
    """Sample the profile where the target's number format can put its points, and rebuild the motion."""
    if target.placing == "equidistant" and target.number_format == "int32":  # the drive counts points
        units = Units(Unit("step", profile.length / (len(x) - 1)), Unit("0.1um", 1e-7))
    size = units.master.size
    placed = rounded(x / size, target.number_format) * size
    inner = np.clip(placed, profile.start, profile.end)
    table = sample_profile(profile, inner, units, target.law)
    if target.law == "quintic" and target.number_format == "float32":
        # the chord between two rounded points has not quite the ratio that its neighbours end with
        table = replace(table, laws=(target.law,) * len(table.laws))
    rebuilt = units.to_si(target.rebuild(table))
    return Choice(table, rebuilt, deviation(profile, rebuilt))


def _candidates(profile: CamProfile, target: Target, points: int | None) -> Iterator[FloatArray]:
    """Positions of the points, few first."""
    limit = target.max_points or (MOST_LINE if target.law == "line" else MOST_SPLINE)
    most = points or min(limit, MOST_LINE if target.law == "line" else MOST_SPLINE)
    if target.placing == "equidistant":
        yield from _even(profile, most, points)
    elif target.placing == "pieces":
        yield from _pieces(profile, target.min_points, points, target.max_points or MOST_SPLINE)
    else:
        for x in _subdivided(profile, most, points, spline=target.law == "spline"):
            if len(x) >= target.min_points:
                yield x


def _pieces(profile: CamProfile, least: int, points: int | None, most: int) -> Iterator[FloatArray]:
    """Give the breaks; more points by halving the pieces that a quintic misses most, fewer from the zones on."""
    x = profile.breaks.copy()
    if profile.degree <= _EXACT_DEGREE and len(x) <= (points or most):
        while len(x) < (points or least):
            x = _halved(x, int(np.argmax(np.diff(x))))
        yield x
        return
    straight = np.array([not np.any(row[2:]) for row in profile.coefficients])
    keep = np.concatenate([[True], straight[1:] != straight[:-1], [True]])  # the ends of the straight pieces
    x = x[keep] if len(x) > (points or most) else x
    if len(x) > (points or most):
        return
    while True:
        if len(x) >= least:
            yield x
        if len(x) >= (points or most):
            return
        x = _halved(x, _worst_piece(profile, x))


def _halved(x: FloatArray, piece: int) -> FloatArray:
    return np.insert(x, piece + 1, 0.5 * (x[piece] + x[piece + 1]))


def _worst_piece(profile: CamProfile, x: FloatArray) -> int:
    """Find the piece on which the quintic through its ends is most off in the ratio slope."""
    from profiles.tables.interpolation import quintics

    metres = Units(Unit("m", 1.0), Unit("m", 1.0))
    rebuilt = quintics(sample_profile(profile, x, metres))
    inner = x[:-1, None] + np.diff(x)[:, None] * np.linspace(0.05, 0.95, 10)
    off = np.abs(rebuilt(inner.ravel(), 2) - profile(inner.ravel(), 2)).reshape(inner.shape).max(axis=1)
    return int(np.argmax(off))


def _subdivided(profile: CamProfile, most: int, points: int | None, *, spline: bool) -> Iterator[FloatArray]:
    """Give the breaks and points between, closer and closer, or as many as are asked for.

    Pieces that the drive's law carries are not divided: straight ones by lines, cubics by a spline. A spline that must
    bend elsewhere needs points in the straight pieces too, for it rings on; they stand wider and wider apart.
    """
    width = np.diff(profile.breaks)
    carried = np.array([not np.any(row[4 if spline else 2 :]) for row in profile.coefficients])
    straight = np.array([not np.any(row[2:]) for row in profile.coefficients])
    reach = float(width[~straight].sum()) or profile.length

    def divided(divisions: float) -> FloatArray:
        parts = [np.array([profile.start])]
        step = reach / divisions
        for left, right, flat in zip(profile.breaks, profile.breaks[1:], straight, strict=False):
            parts.append(_graded(left, right, step) if flat and spline else _divided(left, right, step, flat))
        return np.concatenate(parts)

    if points is not None:
        few, many = 1.0, 2.0 * points
        while many - few > 0.25:
            middle = 0.5 * (few + many)
            few, many = (middle, many) if len(divided(middle)) <= points else (few, middle)
        if len(divided(few)) <= points:
            yield divided(few)
        return
    if carried.all():
        yield profile.breaks.copy()
    divisions, before = 4.0, 0
    while len(x := divided(divisions)) <= most:
        if len(x) > before:
            yield x
        before = len(x)
        divisions *= _GROWTH


def _divided(left: float, right: float, step: float, flat: bool) -> FloatArray:
    """Even points of a piece without its left end; of a straight one its right end only."""
    count = 1 if flat else max(1, round((right - left) / step))
    return np.linspace(left, right, count + 1)[1:]


def _graded(left: float, right: float, step: float) -> FloatArray:
    """Points of a straight piece without its left end, each twice as far from the nearer end as the one before."""
    half = 0.5 * (right - left)
    distances = []
    distance = step
    while distance < half - 0.25 * step:
        distances.append(distance)
        distance = 2.0 * distance if len(distances) > 3 else distance + step
    near = np.array(distances)
    return np.concatenate([left + near, right - near[::-1], [right]])


def _even(profile: CamProfile, most: int, points: int | None) -> Iterator[FloatArray]:
    """Evenly spaced points, the zones' ends among them where a spacing of a reasonable number of parts has them."""
    straight = np.array([not np.any(row[2:]) for row in profile.coefficients])
    ends = profile.breaks[1:-1][straight[1:] != straight[:-1]]
    parts = (ends - profile.start) / profile.length
    base = 1
    for count in range(1, _MOST_DIVISIONS + 1):
        if np.abs(parts * count - np.rint(parts * count)).max(initial=0.0) < 1e-9:
            base = count
            break
    if points is not None:
        yield np.linspace(profile.start, profile.end, points)
        return
    factor = max(1.0, 16 / base)
    while base * round(factor) + 1 <= most:
        yield np.linspace(profile.start, profile.end, base * round(factor) + 1)
        factor = max(round(factor) + 1.0, factor * _GROWTH)


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
    if target.name == "twincat-cnc":
        return Units(Unit("1e-4deg", profile.length / 3_600_000), Unit("1e-4mm", 1e-7))
    if target.name == "csv":
        return Units(Unit("mm", 1e-3), Unit("mm", 1e-3))
    if target.name == "br":
        return Units(_whole(units.master, profile.length), _whole(units.slave, profile.advance))
    return units


def _whole(unit: Unit, length: float) -> Unit:
    """Give the unit, or the largest decimal part of it, of which a length is a whole multiple."""
    for power in range(7):
        part = Unit(unit.symbol if power == 0 else f"1e-{power}{unit.symbol}", unit.size * 10.0**-power)
        count = length / part.size
        if abs(count - round(count)) <= 1e-9 * max(1.0, abs(count)) and abs(count) <= 2**24:
            return part
    raise InputError(
        f"this drive takes whole periods, and {length / unit.size!r} {unit.symbol} is no whole number of a decimal "
        f"part of {unit.symbol} up to 16777216; choose another unit with --units"
    )
