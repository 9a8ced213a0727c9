"""A cut list worked out: its cams, the changes between them, the line's speed over it, its tables, and the servo's cuts."""

from __future__ import annotations

import collections
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from camwright.design.production.line_plan import fastest_line
from camwright.house.numbers import with_unit
from camwright.house.progress import Step, ignore
from camwright.jobs.job import Job
from camwright.production.cams import ListCam, highest_speeds, list_cam
from camwright.production.changes import Change, find_changes
from camwright.production.tables import TargetSeams, list_tables
from camwright.profiles.cut_list import CutList
from camwright.profiles.errors import InfeasibleError, InputError
from camwright.profiles.line import STEADY, Line
from camwright.profiles.line_run import LineRun
from camwright.profiles.polynomial.profile import FloatArray
from camwright.studies.reach import stand_in
from camwright.validation.production.motion_table import ShiftCam, motion_table
from camwright.validation.production.shift import Shift, ShiftRun, run_shift

_STEADY = 1e-12
"""Share by which the line's speed may change within a piece that counts as steady."""


@dataclass(frozen=True, eq=False)
class ListStudy:
    """A cut list worked out.

    Parameters
    ----------
    job
        The job, the line's ramp in it.
    asked
        The list.
    cams
        The cams that it needs, numbered from 1 in the order in which they are first needed.
    of
        Which cam, counted from 0, makes each piece; shape ``(pieces,)``.
    changes
        What each change between two cams takes, by their numbers.
    highest
        Highest line speed on each piece (m/s), shape ``(pieces,)``.
    plan
        The fastest line speed over the list.
    tables
        The tables of each target.
    run
        What the job's servo makes of the list on this plan.
    """

    job: Job
    asked: CutList
    cams: tuple[ListCam, ...]
    of: NDArray[np.intp]
    changes: dict[tuple[int, int], Change]
    highest: FloatArray
    plan: LineRun
    tables: tuple[TargetSeams, ...]
    run: ShiftRun

    @property
    def transitions(self) -> tuple[Change, ...]:
        """Changes of the list that go through a transition."""
        return tuple(change for change in self.changes.values() if change.transition is not None)

    @property
    def time_at_slowest(self) -> float:
        """Time if the whole list ran at its slowest piece's speed (s)."""
        return float(self.asked.gaps.sum() / self.highest.min())

    @property
    def off(self) -> int:
        """Pieces cut outside the sync tolerance."""
        return int((self.run.sync_errors > self.job.cut.sync_tolerance).sum())

    @property
    def passed(self) -> bool:
        """Whether every cam passes its checks, all tables are released and meet, and every piece is cut within the tolerance."""
        cams = all(cam.report.passed for cam in self.cams)
        return cams and all(table.passed for table in self.tables) and not self.off

    def shift(self) -> Shift:
        """Put the list into one command over the material."""
        return list_shift(self.cams, self.of, self.changes)


def line_of(job: Job, acceleration: float | None) -> Job:
    """Give a job the line's ramp that a plan needs.

    Raises
    ------
    InputError
        Neither the option nor the job states one.
    """
    if acceleration is not None:
        return replace(job, line=replace(job.line, acceleration=acceleration))
    if job.line.acceleration is None:
        raise InputError(
            f"{job.name}: how hard the line ramps is not stated, and no plan of its speed can do without; write "
            '[line] acceleration = "0.5 m/s^2" in the job, or give --line-acceleration "0.5 m/s^2"'
        )
    return job


def study_list(job: Job, asked: CutList, names: Sequence[str], step: Step = ignore) -> ListStudy:
    """Work a cut list out.

    Parameters
    ----------
    job
        The job, `Line.acceleration` of its line known; its line speed is that above which the line never runs.
    asked
        The list.
    names
        Targets of the tables.
    step
        Told what begins now.

    Raises
    ------
    InputError
        A length leaves no room for the sync zone.
    InfeasibleError
        A gap cannot be cut at any line speed, or a change needs the line to stop.
    SolverError
        The solver failed.
    """
    gaps = asked.gaps
    _require_room(job, asked)
    lengths, first, inverse = np.unique(gaps, return_index=True, return_inverse=True)
    order = np.argsort(first, kind="stable")
    rank = np.argsort(order)
    lengths, of = lengths[order], rank[inverse].astype(np.intp)
    step("finding the highest line speeds")
    speeds = [highest_speeds(job, length) for length in lengths.tolist()]
    _require_possible(job, asked, of, speeds)
    step("designing the cams")
    cams = _designed(job, lengths, gaps, of, speeds)
    step("looking at the changes")
    pairs = collections.Counter((a + 1, b + 1) for a, b in pairwise(of.tolist()) if a != b)
    changes = find_changes(cams, pairs, stand_in(job))
    _require_running(job, asked, of, changes, cams)
    step("planning the speed of the line")
    highest = _highest(cams, of, changes)
    plan = fastest_line(gaps, highest, float(job.line.acceleration or 0.0))
    step("writing the tables and running their seams")
    tables = list_tables(cams, changes, names)
    step("running the servo")
    run = run_shift(list_shift(cams, of, changes), plan, job.servo)
    return ListStudy(job, asked, cams, of, changes, highest, plan, tables, run)


def list_shift(cams: Sequence[ListCam], of: NDArray[np.intp], changes: dict[tuple[int, int], Change]) -> Shift:
    """Put cams and transitions one after the other, as a list runs them."""
    parts = [ShiftCam(cam.solution.profile, cam.running.zero) for cam in cams]
    order = of.copy()
    for change in changes.values():
        if change.transition is not None:
            here = 1 + np.flatnonzero((of[:-1] == change.before - 1) & (of[1:] == change.after - 1))
            order[here] = len(parts)
            parts.append(ShiftCam(change.transition.profile, cams[change.after - 1].running.zero))
    places = {cam.running.zero: cam.job.task for cam in cams}
    tasks = list(places.values())
    kinds = np.array([list(places).index(cam.running.zero) for cam in cams], dtype=np.intp)
    return Shift(motion_table(parts, order, cams[0].job.machine.pitch), tasks, kinds[of])


def _require_room(job: Job, asked: CutList) -> None:
    """Refuse lengths that leave no room for the sync zone, by their line."""
    zone, units = job.cut.sync_zone, job.units
    bad = sorted({(int(line), float(gap)) for line, gap in zip(asked.lines, asked.gaps, strict=True) if gap <= zone})
    if bad:
        raise InputError(
            *(
                f"line {line}: a length of {with_unit(gap, 'm', 4, units)} leaves no room for the sync zone of "
                f"{with_unit(zone, 'm', 4, units)}; cut longer pieces, or shorten [cut] sync_zone"
                for line, gap in bad[:20]
            )
        )


def _require_possible(job: Job, asked: CutList, of: NDArray[np.intp], speeds: Sequence[tuple[float, float]]) -> None:
    """Refuse gaps that no line speed allows."""
    for number, (perfect, _) in enumerate(speeds):
        if perfect <= 0.0:
            at = int(np.flatnonzero(of == number)[0])
            raise InfeasibleError(
                f"line {asked.lines[at]}: {with_unit(float(asked.gaps[at]), 'm', 4, job.units)} cannot be cut at any line speed; "
                "a shorter sync zone or a longer piece would help: ask camwright limits",
                "cut_length",
                None,
                "m",
                (),
            )


def _designed(
    job: Job, lengths: FloatArray, gaps: FloatArray, of: NDArray[np.intp], speeds: Sequence[tuple[float, float]]
) -> tuple[ListCam, ...]:
    """Design the cams: each at its own highest speed where the line is steady whenever it runs, else below what bears the ramps."""
    cap = job.cut.line_speed
    ramps = _ramping(gaps, of, np.array(speeds), cap, float(job.line.acceleration or 0.0))
    cams = []
    for number, length in enumerate(lengths.tolist()):
        perfect, bearing = speeds[number]
        line: Line = job.line if ramps[number] or bearing >= min(cap, perfect) else STEADY
        cams.append(list_cam(number + 1, job, length, (perfect, bearing), cap, line))
    return tuple(cams)


def _ramping(
    gaps: FloatArray, of: NDArray[np.intp], speeds: FloatArray, cap: float, acceleration: float
) -> NDArray[np.bool_]:
    """Say which cams run while the line ramps: those may run no faster than what bears it, which may make others ramp."""
    ramps = np.zeros(len(speeds), dtype=bool)
    while True:
        highest = np.minimum(cap, np.where(ramps, speeds[:, 1], speeds[:, 0]))
        plan = fastest_line(gaps, highest[of], acceleration)
        ends = np.concatenate([[0.0], np.cumsum(gaps)])
        moment = plan.when(ends)
        inner = plan.speed(plan.when(0.5 * (ends[1:] + ends[:-1])))
        at = plan.speed(moment)
        low, high = (pick(pick(at[:-1], at[1:]), inner) for pick in (np.minimum, np.maximum))
        found = ramps.copy()
        found[np.unique(of[high > low * (1.0 + 1e-9)])] = True
        found |= ramps
        if (found == ramps).all():
            return ramps
        ramps = found


def _require_running(
    job: Job, asked: CutList, of: NDArray[np.intp], changes: dict[tuple[int, int], Change], cams: Sequence[ListCam]
) -> None:
    """Refuse a list with a change that no motion makes while the line runs."""
    for change in changes.values():
        if change.times and change.how == "stop":
            at = 1 + int(np.flatnonzero((of[:-1] == change.before - 1) & (of[1:] == change.after - 1))[0])
            one, other = (
                with_unit(cams[number - 1].length, "m", 4, job.units) for number in (change.before, change.after)
            )
            way = (
                f"place the sync zone at one place for all: --common-place, or {{@machine}}.{job.machine.place_name}"
                if job.machine.place_name
                else 'let the command be in sync: [objective] command = "in_sync"'
                if job.cut.shaped
                else "put a length between them"
            )
            raise InfeasibleError(
                f"line {asked.lines[at]}: from {one} to {other} no motion within the limits leads while the line runs; "
                + way.replace("{@machine}.", "[machine] "),
                "change",
                None,
                "m",
                (),
            )


def _highest(cams: Sequence[ListCam], of: NDArray[np.intp], changes: dict[tuple[int, int], Change]) -> FloatArray:
    """Give the highest line speed of each piece: its cam's, or that of the transition which begins it."""
    highest = np.array([cam.line_speed for cam in cams])[of]
    for change in changes.values():
        if change.transition is not None:
            here = 1 + np.flatnonzero((of[:-1] == change.before - 1) & (of[1:] == change.after - 1))
            highest[here] = np.minimum(highest[here], change.line_speed)
    return highest
