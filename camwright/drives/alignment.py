"""Where a foreign cam's cycle begins: its zeros of master and slave, found from where it is in sync."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from camwright.drives.axis_path import axis_path
from camwright.jobs.job import Job
from camwright.profiles.cut import Cut
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.validation.rebuilt import cuts_in, each_cut, one_cycle
from camwright.validation.servo.response import shear_zone_of

Path = Callable[[FloatArray], FloatArray]
"""Slave positions over the master positions of a file, its cycles repeated."""
Misfit = Callable[[FloatArray], FloatArray]
"""How ill each of some beginnings fits, shape ``(n,)`` to ``(n,)``."""

_IN_ZONE = 65
"""Places in the sync zone where the cycle is compared."""
_CHUNK = 4096
_EVENLY = 3600
"""Beginnings that are tried beside those at the cam's own points, where these stand far apart."""
_EDGE = 1e-6
"""Part of the cut length beside the ends of the zone where the ratio may be the return's."""
_EXACT = 1e-8
"""Misfit, as a part of what is allowed, that is rounding: beginnings below it are as good as each other."""
_SAME = 1e-12
"""Part of the cut length within which two places are one."""
_LEVELS = np.array([1.0, 2.0, 4.0, 8.0, 16.0, 32.0])
"""Misfits at which the sides of a cam in counts are looked for, in units of what a count does."""
_SNAP = 0.05
"""Part of the beginnings that a count leaves open within which one is taken whose zone begins and ends on points."""
_TOLD = 0.1
"""Misfit at the file's own zero, as a part of what is allowed, from which on another zero is told."""
_LINE_SPEEDS = 5
"""Line speeds of the job's range at which the axis of a shaped cam is looked at: one alone leaves its place open by
millimetres, for the axis is straight beyond the shear zone too, and elsewhere nothing says where a command has to be."""
_ROUNDS = 60
"""Steps of the golden section: the last is far below a nanometre."""


def aligned(
    rebuilt: CamProfile,
    job: Job,
    *,
    seen: CamProfile | None = None,
    count: float = 0.0,
    grain: float = 0.0,
    tick: float = 0.0,
) -> tuple[CamProfile, tuple[str, ...]]:
    """Begin the cycle where it fits the job's sync zone best, and put the slave's zero where the job has it.

    A shaped command is not in sync itself: there it is the axis that is put into the shear zone. One that is for one line speed alone is
    left where the file has it if it is in tolerance there.

    The zero is found from the cam alone: the beginnings tried are those at which an end of the zone falls on a point of
    the cam, so that the answer does not depend on where the file begins. Where many fit, as in a cam that stays in sync
    for longer than the job's zone, it is the middle of them; where one fits best, it is refined between its neighbours.

    Parameters
    ----------
    rebuilt
        One cycle from master 0 on, in SI units, or several.
    seen
        The same without the rounding to counts, if it is known: the zero is found from it.
    count
        Size of the counts that its positions are in (slave unit), if that is coarse: its exact ratio is noise then, and
        chords between the places take its part; beginnings that differ by what a count does are as good as each other.
    grain
        What its positions are rounded to, if they are, however finely (slave unit): the last digit shakes the ratio, and
        beginnings that differ by no more are as good as each other, too.
    tick
        What its master positions are rounded to, likewise (m).

    Returns
    -------
    (profile, notes)
        The cycle, and where it begins in the file if that is not at the file's first point.
    """
    task, cut, machine = job.task, job.cut, job.machine
    sync = task.sync
    cuts = cuts_in(rebuilt, cut)
    stretch = rebuilt.length / (cuts * cut.length)
    paths, zone, end = _seen(seen or rebuilt, job, cuts, stretch)
    width = end - zone
    in_zone = np.linspace(0.0, width, _IN_ZONE)
    inside = np.clip(in_zone, _EDGE * cut.length, width - _EDGE * cut.length)
    before = cut.shear_zone_at * cut.shaped
    meant, slope = (sync(np.minimum(before + x, sync.end), order) for x, order in ((in_zone, 0), (inside, 1)))
    chord, piece = width / (_IN_ZONE - 1), 0.5 * cuts * cut.length / rebuilt.pieces
    count = count or (
        grain if piece < chord else 0.0
    )  # the closer the points, the more their rounding shakes the ratio
    lever = float(np.abs(machine.tool_ratio(task.slave_at_sync_start + meant)).max())
    speed = machine.tool_ratio(task.slave_at_sync_start + sync(np.minimum(before + inside, sync.end))) / cut.sync_ratio
    by_position = count > 0.0 or cut.shaped  # a ratio is mostly rounding in counts, and free in a shaped command

    def misfit(begin: FloatArray) -> FloatArray:
        """Error of the tool in the zone over the tolerance, and of its speed over what that allows; the greater."""
        found = []
        for part in np.array_split(begin, len(begin) // _CHUNK + 1):
            at = (part[:, None] + zone) * stretch
            off = np.concatenate([path(at + in_zone * stretch) - meant for path in paths], axis=1)
            position = 0.5 * np.ptp(off, axis=1) * lever / cut.sync_tolerance
            if by_position:
                found.append(position)
                continue
            slip = (rebuilt(at + inside * stretch, 1, outside="repeat") * stretch - slope) * speed
            found.append(np.maximum(position, np.abs(slip).max(axis=1) * cut.sync_zone / cut.sync_tolerance))
        return np.concatenate(found)

    # a position, or a ratio, off by its rounding
    slack = (count or grain * (1.0 if by_position else cut.sync_zone / piece)) * lever / cut.sync_tolerance
    begins = _beginnings(rebuilt, stretch, zone, width, cut.length)
    # points say nothing of where the axis of a shaped command is in sync
    ends = () if cut.shaped else (zone, end)
    anchored = _anchored(begins, rebuilt.breaks / stretch, ends, cut.length, tick)
    if count > 0.0:
        begin = _between_sides(begins, misfit(begins), cut.length, slack, anchored)
    else:
        begin = _best(begins, misfit, cut.length, max(_EXACT, slack), anchored)
    begin, notes = _settled(begin, begins, misfit, cut, slack, len(paths))
    met = 0.0
    if begin:  # even where the file's own zero is as good: figures must not depend on where a file begins
        rebuilt, met = rebuilt.roll(begin * stretch), float(rebuilt(begin * stretch))
    off = np.concatenate([path((begin + zone + in_zone) * stretch) - met - meant for path in paths])
    wanted = task.height if cut.origin == "return" else machine.pitch - float(sync(0.5 * cut.sync_zone))
    return rebuilt.shift(0.0, wanted - 0.5 * float(off.max() + off.min())), notes


def _told(begin: float, here: float, there: float, shaped: bool) -> tuple[str, ...]:
    """Say that the file's own zero is not the job's, where the cycle fits worse than at another, and ill."""
    if not here > max(there, 1.0 if shaped else _TOLD):
        return ()
    fits = "axis fits the shear" if shaped else "cam fits the sync"
    note = (
        f"the file's master zero is not the job's: the job's cycle begins {begin * 1e3:.6g} mm into the file's, "
        f"where the {fits} zone best ([output] origin says which zero is meant)"
    )
    return (note,)


def _settled(
    begin: float, begins: FloatArray, misfit: Misfit, cut: Cut, slack: float, line_speeds: int
) -> tuple[float, tuple[str, ...]]:
    """Keep the file's own zero where nothing tells a better one, and say where the cycle begins if it is elsewhere or open."""
    here, there = misfit(np.array([0.0, begin])).tolist()
    left_open = cut.shaped and line_speeds == 1
    if left_open and here <= 1.0:
        begin, there = 0.0, here
    notes = _told(begin, here, there + slack, cut.shaped)
    return begin, (*notes, *_told_open(begin, begins, misfit, cut.length)) if left_open else notes


def _told_open(begin: float, begins: FloatArray, misfit: Misfit, length: float) -> tuple[str, ...]:
    """Say how far the beginning of a shaped cam is open whose axis is in sync at one line speed: wherever it is in tolerance."""
    least, good = int(np.abs(begins - begin).argmin()), misfit(begins) <= 1.0
    if not good[least]:
        return ()
    first, last = _run(good, least)
    width = (begins[last] - begins[first]) % length
    taken = "the own zero of the file" if begin == 0.0 else "what fits best"
    note = (
        "the axis of a shaped command is in sync at one line speed, which leaves open where its cycle begins: anywhere within "
        f"{width * 1e3:.3g} mm it is in tolerance; {taken} is taken"
    )
    return (note,)


def _seen(rebuilt: CamProfile, job: Job, cuts: int, stretch: float) -> tuple[list[Path], float, float]:
    """Give what is to be in sync, and between which master positions: the cam, or of a shaped one its axis at several line speeds."""
    cut = job.cut
    if cut.shaped:
        start, end = shear_zone_of(cut)
        cycle = each_cut(one_cycle(rebuilt, cut, cuts), job.task, cuts)[0]
        paths = [
            axis_path(cycle, job, v, stretch) for v in np.unique(np.geomspace(*job.line_speeds, _LINE_SPEEDS)).tolist()
        ]
        return paths, start % cut.length, start % cut.length + end - start
    zone = (cut.return_start + cut.return_zone) % cut.length
    return [lambda at: rebuilt(at, outside="repeat")], zone, zone + cut.sync_zone


def _beginnings(rebuilt: CamProfile, stretch: float, zone: float, width: float, length: float) -> FloatArray:
    """Give beginnings at which an end of the zone falls on a point of the cam; evenly between where these are few."""
    points = rebuilt.breaks[:-1] / stretch
    tried = np.concatenate([points - zone, points - zone - width])
    extra = max(0, _EVENLY // len(points))
    if extra > 1:
        gaps = np.diff(np.append(points, points[0] + rebuilt.length / stretch))
        between = points[:, None] + gaps[:, None] * (np.arange(1, extra) / extra)
        tried = np.concatenate([tried, between.ravel() - zone])
    return np.unique(np.mod(tried, length))


def _anchored(
    begins: FloatArray, points: FloatArray, ends: tuple[float, ...], length: float, tick: float
) -> NDArray[np.bool_]:
    """Whether both ends of the zone, if there are any, fall on points of the cam, as well as the rounding of these lets tell."""
    ring = np.sort(np.mod(points, length))
    ring = np.concatenate([ring - length, ring, ring + length])
    both = np.full(len(begins), bool(ends))
    for end in ends:
        at = np.mod(begins + end, length)
        after = np.searchsorted(ring, at)
        both &= np.minimum(ring[after] - at, at - ring[after - 1]) <= _SAME * length + tick
    return both


def _best(begins: FloatArray, misfit: Misfit, length: float, slack: float, anchored: NDArray[np.bool_]) -> float:
    """Find the best beginning: the middle of those that fit as well as rounding lets tell, or the best between neighbours.

    Where one fits whose zone begins and ends on points of the cam, it is that: a beginning a micrometre beside it fits as well,
    for what the ratio can tell. Of several in a cam that is rounded it is the one nearest to the middle.
    """
    found = misfit(begins)
    least = int(found.argmin())
    bound = slack if slack <= _EXACT else float(found[least]) + slack
    good = found <= bound
    sure = begins[good & anchored]
    if len(sure) and slack <= _EXACT and float(np.ptp(sure)) <= 2.0 * _SAME * length:
        return float(sure[0])
    if int(good.sum()) > 1:
        first, last = _run(good, least)
        width = (begins[last] - begins[first]) % length
        middle = (begins[first] + 0.5 * width) % length
        if slack > _EXACT and good[anchored].any():
            sure = begins[good & anchored]
            away = np.abs((sure - middle + 0.5 * length) % length - 0.5 * length)
            if away.min() <= 0.5 * width:
                return float(sure[int(away.argmin())])
        if float(misfit(np.array([middle]))[0]) <= bound:
            return float(middle)
    low = begins[least - 1] - (length if least == 0 else 0.0)
    high = begins[(least + 1) % len(begins)] + (length if least == len(begins) - 1 else 0.0)
    refined = _golden(misfit, float(low), float(high))
    return float(begins[least]) if found[least] <= misfit(np.array([refined]))[0] else refined % length


def _between_sides(
    begins: FloatArray, found: FloatArray, length: float, slack: float, anchored: NDArray[np.bool_]
) -> float:
    """Find the beginning of a cam that is rounded to counts: between the sides on which the misfit rises beyond the rounding.

    The higher a level, the better both places are known at which the misfit passes it; but the sides of a cam that is not symmetric rise
    differently. So the middles at some levels are continued to where the sides begin: like cubes, as a limited jerk makes them.
    """
    least = int(found.argmin())
    order = np.argsort((begins - begins[least]) % length)
    away, ring = (begins[order] - begins[least]) % length, found[order]
    ahead_at, ahead = np.append(away, length), np.append(ring, ring[0])
    behind_at, behind = length - ahead_at[::-1], ahead[::-1]
    middles, widths = [], []
    for level in (float(found[least]) + slack * _LEVELS).tolist():
        if level >= float(found.max()):
            break
        sides = [_passed(at, value, level) for at, value in ((ahead_at, ahead), (behind_at, behind))]
        middles.append(0.5 * (sides[0] - sides[1]))
        widths.append(sides[0] + sides[1])
    middle, width = np.array(middles), np.array(widths)
    if not len(middle):
        return float(begins[least])
    centre = float(middle[0])
    if len(middle) == len(_LEVELS):
        flat = max(0.0, 2.0 * float(width[-4]) - float(width[-1]))
        columns = np.stack([np.ones_like(width), np.maximum(width - flat, 0.0)], axis=1)
        centre = float(np.linalg.lstsq(columns * width[:, None] ** 2, middle * width**2, rcond=None)[0][0])
    begin = (float(begins[least]) + centre) % length
    sure = begins[anchored]
    if len(sure):
        off = np.abs((sure - begin + 0.5 * length) % length - 0.5 * length)
        if off.min() <= _SNAP * float(width[0]):
            return float(sure[int(off.argmin())])
    return begin


def _passed(at: FloatArray, value: FloatArray, level: float) -> float:
    """Find the first place at which a function that begins below a level passes it."""
    after = int(np.argmax(value > level))
    share = (level - value[after - 1]) / (value[after] - value[after - 1])
    return float(at[after - 1] + share * (at[after] - at[after - 1]))


def _run(good: NDArray[np.bool_], at: int) -> tuple[int, int]:
    """Find the ends of the run of true entries of a ring that holds one of them."""
    count = len(good)
    first = last = at
    while last - first < count - 1 and good[(first - 1) % count]:
        first -= 1
    while last - first < count - 1 and good[(last + 1) % count]:
        last += 1
    return first % count, last % count


def _golden(misfit: Misfit, low: float, high: float) -> float:
    """Find the least of a function that falls and then rises between two places."""
    part = 0.5 * (5.0**0.5 - 1.0)
    left, right = high - part * (high - low), low + part * (high - low)
    at_left, at_right = misfit(np.array([left, right])).tolist()
    for _ in range(_ROUNDS):
        if at_left <= at_right:
            high, right, at_right = right, left, at_left
            left = high - part * (high - low)
            at_left = float(misfit(np.array([left]))[0])
        else:
            low, left, at_left = left, right, at_right
            right = low + part * (high - low)
            at_right = float(misfit(np.array([right]))[0])
    return 0.5 * (low + high)
