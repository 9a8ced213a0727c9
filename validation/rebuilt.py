"""Judging a cam table as the drive will run it: its rebuilt motion over several wraps, with allowances for rounding."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camwright.profiles.cut import Cut
from camwright.profiles.errors import InputError
from camwright.profiles.polynomial import rows
from camwright.profiles.polynomial.profile import CamProfile, Extremum, FloatArray
from camwright.profiles.servo import Servo, spectral_radius
from camwright.profiles.task import Task
from camwright.validation.check import Check
from camwright.validation.differences import sampled_peaks
from camwright.validation.motion import (
    RATIO_JUMP,
    greatest_jump,
    position_scale,
    ratio_scale,
)
from camwright.validation.servo.response import greatest_shear_zone_error

LEAST_WRAPS = 3

RUN = 10_000
"""Cuts of a run over which what a written table lacks of the pitch adds up; stated in every report."""

ALLOWANCE = 0.01
"""What a limit may be exceeded by, relative to the limit: interpolation and number format, stated in every report."""

_SAME_PERIOD = 1e-3
"""How far a table's period may be off the cut length, relative to it, to be the table of this cut at all."""

_ROUNDED = 1e-12
"""Part of the slave's way that an advance may miss the pitch by for being computed; ten thousand cuts would show it."""

_STEP = 1e-9
"""Step of the position at a join, relative to the cut length (a turn, for a slave in rad), that is rounding."""

_EDGE = 1e-6
"""Part of the cut length next to the ends of the sync zone in which the ratio is not judged: a point that stands for an
end is rounded to the number format, and what lies on its other side is the return."""

_RINGS = 4
"""Steps of a table over which a spline rings on behind a corner: by then to a two hundredth."""
_MOST_MARGIN = 0.05
"""Part of the sync zone that these may take at either end; a table of wider steps is judged all over."""

_NODES = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, 17))


@dataclass(frozen=True, eq=False)
class TableJudgement:
    """What the drive makes of a table, judged.

    Parameters
    ----------
    checks
        All checks, in a fixed order.
    cycle
        One rebuilt cycle, over the master period ``[0, x_c]``.
    wraps
        Number of cycles that were run.
    """

    checks: tuple[Check, ...]
    cycle: CamProfile
    wraps: int

    @property
    def passed(self) -> bool:
        """Whether every check passed."""
        return all(check.passed for check in self.checks)


def one_cycle(rebuilt: CamProfile, cut: Cut, cuts: int = 1) -> CamProfile:
    """Put a rebuilt cycle over the master period of so many cuts exactly; its slave positions stay.

    Raises
    ------
    InputError
        The table's period is not the cut length, to `_SAME_PERIOD`.
    """
    length = cuts * cut.length
    if abs(rebuilt.length - length) > _SAME_PERIOD * length:
        raise InputError(
            f"the table's master period is {rebuilt.length * 1e3:.10g} mm, but the cut length is "
            f"{cut.length * 1e3:.10g} mm; check the units, or name the job that the table was made for"
        )
    return rebuilt.shift(-rebuilt.start).scale(master=length / rebuilt.length).over(0.0, length)


def judge_table(
    rebuilt: CamProfile,
    task: Task,
    servo: Servo,
    wraps: int = LEAST_WRAPS,
    run: int = 0,
    stored: float = 0.0,
    *,
    count: float = 0.0,
) -> TableJudgement:
    """Judge the motion that a drive makes of a table.

    The cycle is repeated with the table's own period and advance, as the drive repeats it, and compared with the
    material over all wraps: what the number format loses in one cycle adds up. Limits may be exceeded by `ALLOWANCE`;
    a jerk, and an acceleration where the drive puts straight lines, is judged as the drive's own differences of its
    positions at the servo's sample time, at every sampling phase. Errors in sync are those of the tool along the
    material, for every machine.

    Parameters
    ----------
    rebuilt
        One cycle as the drive interpolates it, in SI units (slave unit). At the start of the master's period the slave
        is at zero.
    task, servo
        What it is judged by.
    wraps
        Number of cycles to run, at least `LEAST_WRAPS`.
    run
        Cuts over which the advance may fall short of the pitch by the sync tolerance; those of the wraps if more.
    stored
        Size of the counts of the user's encoder that a table is written in (slave unit), its motion with their rounding: like
        `count`, and acceleration and jerk beyond what rounding to counts makes of their differences, which the sources state.
    count
        Size of the counts that the positions are given in (slave unit), if that is coarse: then acceleration and speed in
        sync are judged by differences at the sample time, the speed beyond what one count makes of it.

    Raises
    ------
    InputError
        Too few wraps, or a table of another cut length.
    """
    if wraps < LEAST_WRAPS:
        raise InputError(f"a table is run over at least {LEAST_WRAPS} wraps; got {wraps}")
    cuts = cuts_in(rebuilt, task.cut)
    whole = one_cycle(rebuilt, task.cut, cuts)
    cycles = each_cut(whole, task, cuts)
    periods = -(-wraps // cuts)
    wrapped = rebuilt.shift(-rebuilt.start).repeat(periods)
    checks = (
        *_closing(rebuilt, task, cuts, wraps, max(run, wraps)),
        *_sync(wrapped, task, periods * cuts, max(count, stored), servo.sample_time),
        *_limits(whole, wrapped, task, servo, counted=count > 0.0 or stored > 0.0, stored=stored),
        *_stroke(whole, task),
        _shear_zone(cycles, task, servo),
    )
    return TableJudgement(checks, cycles[0], periods * cuts)


def cuts_in(rebuilt: CamProfile, cut: Cut) -> int:
    """Count the cuts in a table: several where its counts close after several only."""
    return max(1, round(rebuilt.length / cut.length))


def each_cut(whole: CamProfile, task: Task, cuts: int) -> list[CamProfile]:
    """Take a table of several cuts apart, each over ``[0, x_c]`` and from its own pitch on."""
    length, pitch = task.cut.length, task.machine.pitch
    if cuts == 1:
        return [whole]
    ends = [float(whole.breaks[np.abs(whole.breaks - k * length).argmin()]) for k in range(cuts + 1)]
    ends = [near if abs(near - k * length) <= _STEP * length else k * length for k, near in enumerate(ends)]
    return [whole.restrict(ends[k], ends[k + 1]).shift(-ends[k], -k * pitch).over(0.0, length) for k in range(cuts)]


def _closing(rebuilt: CamProfile, task: Task, cuts: int, wraps: int, run: int) -> list[Check]:
    """Give what period and advance are off, the latter added up over a run, and steps at the joins."""
    machine, cut = task.machine, task.cut
    step = greatest_jump(rebuilt, 0)
    lost = abs(rebuilt.advance - cuts * machine.pitch) / cuts
    lost = lost if lost > _ROUNDED * position_scale(rebuilt, machine) else 0.0
    number = "in the target's number format"
    of = "" if cuts == 1 else f" of {cuts} cuts"
    zone = task.slave_at_sync_start + task.sync(np.linspace(0.0, cut.sync_zone, 33))
    lever = float(np.abs(machine.tool_ratio(zone)).max())
    off = wraps * abs(rebuilt.length - cuts * cut.length) / cuts
    period = f"period{of} against cut length over {wraps} wraps, {number}"
    closure = f"advance{of} against pitch, at the tool in sync, over a run of {run} cuts, {number}"
    allowed = _STEP * position_scale(rebuilt, machine)
    joins = "no jump of the position at any join"
    return [
        Check.at_most("period", off, cut.sync_tolerance, "m", period),
        Check.at_most("closure", run * lost * lever, cut.sync_tolerance, "m", closure),
        Check.at_most("position_joins", step.value, allowed, machine.slave_unit, joins, step.at),
    ]


def _sync(run: CamProfile, task: Task, wraps: int, count: float, sample_time: float) -> list[Check]:
    """Tool against material in the sync zones of all wraps: position, and speed.

    Where the slave is off by ``e`` from its coordinate ``c`` in sync, the tool is off by ``X(c + e) - X(c)``.
    """
    machine, cut = task.machine, task.cut
    if cut.shaped:  # not the command but the axis is in sync, and judged beside this
        return []
    sync = task.sync
    began = task.slave_at_sync_start - task.slave_at_start  # of the zone, from the start of the cycle
    margins = _margins(run, task)
    points, middles, homes = _zone_places(run, task, wraps, margins)

    def off(parts: list[FloatArray]) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Places of all parts, the starts of their cycles, and the slave there: as it should be, and as it is."""
        x = np.concatenate(parts)
        cycle, origin, turns = np.repeat(np.array(homes).T, [len(part) for part in parts], axis=1)
        along = sync(np.clip(x - origin, sync.start, sync.end))
        meant = task.slave_at_sync_start + along
        return x, cycle, meant, meant + run(x) - (began + along + turns)

    def greatest(size: FloatArray, x: FloatArray, cycle: FloatArray) -> tuple[float, float | None]:
        if not size.size or not size.any():
            return 0.0, None
        worst = int(size.argmax())
        return float(size[worst]), float(x[worst] - cycle[worst])

    x, cycle, meant, found = off(points)
    worst, at = greatest(np.abs(machine.tool(found) - machine.tool(meant)), x, cycle)
    if count > 0.0:
        step = cut.line_speed * sample_time
        starts = [
            np.linspace(part[0], part[-1] - step, len(part)) if part[-1] - part[0] > step else part[:0]
            for part in points
        ]
        ends = [part + step for part in starts]
        x, cycle, before, found = off(starts)
        _, _, after, moved = off(ends)
        error = np.abs((machine.tool(moved) - machine.tool(after)) - (machine.tool(found) - machine.tool(before)))
        excess = np.maximum(0.0, error - count * np.abs(machine.tool_ratio(found)))
        slip = excess / step
    else:
        x, cycle, _, found = off(middles)
        slip = np.abs(machine.tool_ratio(found) * run(x, 1) / cut.sync_ratio - 1.0)
    ratio, ratio_at = greatest(slip, x, cycle)
    return [
        Check.at_most("sync_position", worst, cut.sync_tolerance, "m", f"tool against material, {wraps} wraps", at),
        Check.at_most(
            "sync_ratio",
            ratio,
            cut.sync_tolerance / cut.sync_zone,
            "1",
            "speed of the tool in the sync zone (S1), against the sync tolerance over the sync zone"
            + ("; over a sample time, beyond one count" if count > 0.0 else "")
            + ("; not beside ends of the zone that are no points of the table" if any(margins) else ""),
            ratio_at,
        ),
    ]


def _zone_places(
    run: CamProfile, task: Task, wraps: int, margins: tuple[float, float]
) -> tuple[list[FloatArray], list[FloatArray], list[tuple[float, float, float]]]:
    """Places in each part of the sync zones, places between these, and where its cycle and its zone begin, and the travel there."""
    cut, machine = task.cut, task.machine
    zone = cut.return_start + cut.return_zone
    edge = _EDGE * cut.length
    points, middles, homes = [], [], []
    for wrap in range(wraps):
        for start, end in cut.sync_parts:
            later = end == cut.length  # the zone that begins in this cycle
            x = _places(run, wrap * cut.length + start, min(wrap * cut.length + end, run.end))
            middle = 0.5 * (x[1:] + x[:-1])
            points.append(x)
            low = x[0] + (edge if start == 0.0 and len(cut.sync_parts) > 1 else max(edge, margins[0]))
            high = x[-1] - (edge if later and len(cut.sync_parts) > 1 else max(edge, margins[1]))
            middles.append(middle[(middle > low) & (middle < high)])
            origin = wrap * cut.length + zone - (0.0 if later else cut.length)
            homes.append((wrap * cut.length, origin, (wrap + (1 if later else 0)) * machine.pitch))
    return points, middles, homes


def _margins(run: CamProfile, task: Task) -> tuple[float, float]:
    """Give how far from either end of the sync zone the ratio is not judged.

    Where an end lies between two points of a dense table, the drive leads across it with what it computes between points,
    and a spline rings on for some points more: what that does to the position is judged, its slope there is not.
    """
    cut = task.cut
    zone = (cut.return_start + cut.return_zone) % cut.length
    found = []
    for end in (zone, (zone + cut.sync_zone) % cut.length + cut.length):
        near = int(np.searchsorted(run.breaks, end))
        beside = run.breaks[max(near - 1, 0) : near + 1]
        off = float(np.abs(beside - end).min())
        step = float(np.diff(beside)[0]) if len(beside) > 1 else 0.0
        dense = _RINGS * step <= _MOST_MARGIN * cut.sync_zone
        found.append(_RINGS * step if off > _EDGE * cut.length and dense else 0.0)
    return found[0], found[1]


def _places(run: CamProfile, start: float, end: float) -> FloatArray:
    """Master positions between two, dense on every piece."""
    inner = run.breaks[(run.breaks > start) & (run.breaks < end)]
    breaks = np.concatenate([[start], inner, [end]])
    return rows.ascending(np.concatenate([(breaks[:-1, None] + np.diff(breaks)[:, None] * _NODES).ravel(), [end]]))


def _limits(
    cycle: CamProfile, run: CamProfile, task: Task, servo: Servo, *, counted: bool, stored: float
) -> list[Check]:
    """Speed, acceleration and reversal of the cycle; differences over all wraps.

    A position is off by half a count at most, so a second difference by two counts, a third by four.
    """
    machine, limits = task.machine, task.limits
    v = task.cut.line_speed
    speed, least = _extremes(cycle, 1)
    sampled = sampled_peaks(run, task.cut, servo)
    scale, unit = ratio_scale(cycle, machine), machine.slave_unit
    if not counted and greatest_jump(run, 1).value <= RATIO_JUMP * scale:
        found, _ = _extremes(cycle, 2)
        acceleration, at = v * v * found.value, found.at
        how = "exact"
    else:
        acceleration, at = sampled[0]
        how = "differences at the servo's sample time"
    jerk, jerk_at = sampled[1]
    allowed = 1.0 + ALLOWANCE
    shake = 2.0 * stored / servo.sample_time**2
    jolt = 4.0 * stored / servo.sample_time**3
    made = [f"; {off:.4g} of the limit is what counts make of it" if off else "" for off in (shake, jolt)]
    sampled_how = "differences at the servo's sample time"
    backward = limits.speed if task.reverses else ALLOWANCE * v * scale
    return [
        Check.at_most("speed", v * speed.value, allowed * limits.speed, f"{unit}/s", "exact", speed.at),
        Check.at_most(
            "acceleration", acceleration, allowed * limits.acceleration + shake, f"{unit}/s^2", how + made[0], at
        ),
        Check.at_most("jerk", jerk, allowed * limits.jerk + jolt, f"{unit}/s^3", sampled_how + made[1], jerk_at),
        Check.at_most(
            "reversal", max(0.0, -v * least.value), backward, f"{unit}/s", "greatest backward speed", least.at
        ),
    ]


def _extremes(cycle: CamProfile, order: int) -> tuple[Extremum, Extremum]:
    """Find the greatest magnitude and the least value; constants on thousands of pieces need no roots."""
    if cycle.degree > order:
        least, greatest = cycle.extrema(order)
        return Extremum(-least.value, least.at) if -least.value > greatest.value else greatest, least
    value = cycle(cycle.breaks[:-1], order)
    most, fewest = int(np.abs(value).argmax()), int(value.argmin())
    return (
        Extremum(float(abs(value[most])), float(cycle.breaks[most])),
        Extremum(float(value[fewest]), float(cycle.breaks[fewest])),
    )


def _stroke(cycle: CamProfile, task: Task) -> list[Check]:
    """Whether a carriage stays on its guide; the rounding of a table may take it a sync tolerance beyond."""
    if task.machine.guide is None:
        return []
    low, high = task.machine.guide
    least, greatest = cycle.extrema(0)
    below, above = low - task.slave_at_start - least.value, task.slave_at_start + greatest.value - high
    over, at = (below, least.at) if below >= above else (above, greatest.at)
    source = "how far the carriage goes beyond its stroke, negative inside"
    return [Check.at_most("stroke", float(over), task.cut.sync_tolerance, "m", source, at)]


def _shear_zone(cycles: list[CamProfile], task: Task, servo: Servo) -> Check:
    """Tool of the real axis against material in the shear zone, the worst of all cuts; no value if the servo is unstable."""
    cut = task.cut
    worst = None
    if spectral_radius(servo) < 1.0:
        worst = max(greatest_shear_zone_error(cycle, task, servo) for cycle in cycles)
    return Check(
        "shear_zone_error",
        worst is not None and worst <= cut.sync_tolerance,
        worst,
        cut.sync_tolerance,
        "m",
        None,
        "tool against material in the shear zone, at every sampling phase",
    )
