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
from camwright.production.cams import ListCam, highest_speed, list_cam, list_job, ramping_speed
from camwright.production.changes import Change, find_changes
from camwright.production.tables import TargetSeams, list_tables
from camwright.profiles.cut_list import CutList
from camwright.profiles.errors import InfeasibleError, InputError
from camwright.profiles.line import STEADY
from camwright.profiles.line_run import LineRun
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.studies.reach import stand_in
from camwright.validation.production.line_ramp import line_ramp
from camwright.validation.production.motion_table import ShiftCam, motion_table
from camwright.validation.production.shift import Shift, ShiftRun, run_shift

MOST_CAMS = 300
"""Most cams of a list."""

_MOST_FAULTS = 20

_ALLOWED = 1e-3
"""Share by which a ramp may be harder than what is borne: what a solver's margin leaves."""

_MORE = 1.02
"""Factor on the speed of a given line for which its cams are designed: marks move the pieces along it."""

_STEADY = 1e-9
"""Share by which the line's speed may change within a piece that counts as steady."""


@dataclass(frozen=True, eq=False)
class ListPlan:
    """The cams of a cut list, the changes between them, and the speed of the line.

    Parameters
    ----------
    job
        The job.
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
    line
        The speed of the line over the list: the fastest plan, or the one that was given.
    """

    job: Job
    asked: CutList
    cams: tuple[ListCam, ...]
    of: NDArray[np.intp]
    changes: dict[tuple[int, int], Change]
    highest: FloatArray
    line: LineRun

    @property
    def transitions(self) -> tuple[Change, ...]:
        """Changes of the list that go through a transition."""
        return tuple(change for change in self.changes.values() if change.transition is not None)

    @property
    def time_at_slowest(self) -> float:
        """Time if the whole list ran at its slowest piece's speed (s)."""
        return float(self.asked.gaps.sum() / self.highest.min())

    def ramped_too_hard(self, joints: FloatArray) -> NDArray[np.bool_]:
        """Say on which pieces the line ramps harder than their cam bears at its highest line speed.

        Parameters
        ----------
        joints
            Where the pieces begin on the material, and the end of the last (m), shape ``(pieces + 1,)``.
        """
        borne = np.array([line_ramp(cam.solution.profile, cam.job.task).ramp.value for cam in self.cams])
        return np.asarray(self.line.hardest_between(joints) > borne[self.of] * (1.0 + _ALLOWED))

    def first_pieces(self, change: Change) -> NDArray[np.intp]:
        """Pieces, counted from 0, which a change begins."""
        return first_pieces(self.of, change)


@dataclass(frozen=True, eq=False)
class ListStudy:
    """A cut list worked out: planned, its tables written, its servo run.

    Parameters
    ----------
    planned
        Cams, changes and the fastest line speed.
    tables
        The tables of each target.
    run
        What the job's servo makes of the list on this plan.
    """

    planned: ListPlan
    tables: tuple[TargetSeams, ...]
    run: ShiftRun

    @property
    def off(self) -> int:
        """Pieces cut outside the sync tolerance."""
        return int((self.run.sync_errors > self.planned.job.cut.sync_tolerance).sum())

    @property
    def passed(self) -> bool:
        """Whether every cam passes its checks, and all tables are released and meet."""
        return all(cam.report.passed for cam in self.planned.cams) and all(table.passed for table in self.tables)


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
    """Work a cut list out; arguments and errors as `plan_list`, and the names of the tables' targets."""
    planned = plan_list(job, asked, step=step)
    step("writing the tables and running their seams")
    tables = list_tables(planned.cams, planned.changes, names)
    step("running the servo")
    run = run_shift(list_shift(planned.cams, planned.of, planned.changes), planned.line, job.servo)
    return ListStudy(planned, tables, run)


def plan_list(job: Job, asked: CutList, line: LineRun | None = None, step: Step = ignore) -> ListPlan:
    """Design the cams of a cut list and plan the speed of the line over it.

    Parameters
    ----------
    job
        The job, `Line.acceleration` of its line known unless the line's speed is given; its line speed is that above which the line never
        runs.
    asked
        The list.
    line
        Speed of the line; the fastest plan if not given.
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
    job, gaps = list_job(job), asked.gaps
    _require_room(job, asked)
    if line is not None:
        require_passed(gaps, line)
    lengths, first, inverse = np.unique(gaps, return_index=True, return_inverse=True)
    order = np.argsort(first, kind="stable")
    lengths, of = lengths[order], np.argsort(order)[inverse].astype(np.intp)
    step("finding the highest line speeds")
    perfect = np.array([highest_speed(job, length) for length in lengths.tolist()])
    _require_possible(job, asked, of, perfect)
    step("finding which cams run while the line ramps")
    acceleration, tops = job.line.acceleration, np.minimum(perfect, job.cut.line_speed)
    if line is not None:  # for the speeds that they will see
        fastest = np.zeros(len(lengths))
        np.maximum.at(fastest, of, line.fastest_between(np.concatenate([[0.0], np.cumsum(gaps)])))
        tops = np.minimum(tops, np.where(fastest > 0.0, _MORE * fastest, tops))
    tops, bears = _tops(job, gaps, lengths, of, tops, planned=line is None)
    step("designing the cams")
    cams = tuple(
        list_cam(number + 1, job, length, most, top, job.line if bears[number] else STEADY)
        for number, (length, most, top) in enumerate(
            zip(lengths.tolist(), perfect.tolist(), tops.tolist(), strict=True)
        )
    )
    step("looking at the changes")
    pairs = collections.Counter((a + 1, b + 1) for a, b in pairwise(of.tolist()) if a != b)
    changes = find_changes(cams, pairs, stand_in(job))
    _require_running(job, asked, of, changes, cams)
    step("planning the speed of the line")
    highest = _highest(cams, of, changes)
    run = fastest_line(gaps, highest, acceleration or 0.0) if line is None else line
    return ListPlan(job, asked, cams, of, changes, highest, run)


def first_pieces(of: NDArray[np.intp], change: Change) -> NDArray[np.intp]:
    """Pieces, counted from 0, which a change of a list begins; ``of`` as in `ListPlan`."""
    return 1 + np.flatnonzero((of[:-1] == change.before - 1) & (of[1:] == change.after - 1))


def list_shift(
    cams: Sequence[ListCam],
    of: NDArray[np.intp],
    changes: dict[tuple[int, int], Change],
    profiles: Sequence[CamProfile] | None = None,
    longer: FloatArray | None = None,
) -> Shift:
    """Put cams and transitions one after the other, as a list runs them.

    Parameters
    ----------
    cams, of, changes
        As in `ListPlan`.
    profiles
        Cycles to run instead of the cams' own and the transitions', in this order; all begin and end like those.
    longer
        By how much each piece is longer than its cam (m), shape ``(pieces,)``; nothing of it if not given.
    """
    through = [change for change in changes.values() if change.transition is not None]
    own = [cam.solution.profile for cam in cams]
    own += [change.transition.profile for change in through if change.transition is not None]
    zeros = [cam.running.zero for cam in cams] + [cams[change.after - 1].running.zero for change in through]
    order = of.copy()
    for number, change in enumerate(through):
        order[first_pieces(of, change)] = len(cams) + number
    parts = [ShiftCam(profile, zero) for profile, zero in zip(profiles or own, zeros, strict=True)]
    places = {cam.running.zero: cam.job.task for cam in cams}
    kinds = np.array([list(places).index(cam.running.zero) for cam in cams], dtype=np.intp)
    table = motion_table(parts, order, cams[0].job.machine.pitch, cams[0].job.cut.sync_zone, longer)
    return Shift(table, list(places.values()), kinds[of])


def _require_room(job: Job, asked: CutList) -> None:
    """Refuse lengths that leave no room for the sync zone, by their line, and more lengths than a list may have."""
    zone, units = job.cut.sync_zone, job.units
    short, first = np.unique(asked.lines[asked.gaps <= zone], return_index=True)
    gaps = asked.gaps[asked.gaps <= zone][first].tolist()
    if len(short):
        raise InputError(
            *(
                f"{asked.place}, line {line}: a length of {with_unit(gap, 'm', 4, units)} leaves no room for the sync zone of "
                f"{with_unit(zone, 'm', 4, units)}; cut longer pieces, or shorten [cut] sync_zone"
                for line, gap in zip(short.tolist()[:_MOST_FAULTS], gaps, strict=False)
            )
        )
    lengths = len(np.unique(asked.gaps))
    if lengths > MOST_CAMS:
        raise InputError(
            f"{asked.place}: {lengths} different gaps between cuts, the limit is {MOST_CAMS}; round the lengths, or split the list"
        )


def require_passed(lengths: FloatArray, line: LineRun) -> None:
    """Refuse a line that stands still before the list is cut."""
    needed = float(lengths.sum())
    if line.length < needed and line.speeds[-1] == 0.0:
        raise InputError(
            f"the line stands still after {line.length:.6g} m, the list needs {needed:.6g} m; let it run longer, or shorten the list"
        )


def _require_possible(job: Job, asked: CutList, of: NDArray[np.intp], perfect: FloatArray) -> None:
    """Refuse gaps that no line speed allows."""
    for number in np.flatnonzero(perfect <= 0.0).tolist():
        at = int(np.flatnonzero(of == number)[0])
        raise InfeasibleError(
            f"{asked.where(at)}: {with_unit(float(asked.gaps[at]), 'm', 4, job.units)} cannot be cut at any line speed; "
            "a shorter sync zone or a longer piece would help: ask camwright limits",
            "cut_length",
            None,
            "m",
            (),
        )


def _tops(
    job: Job, gaps: FloatArray, lengths: FloatArray, of: NDArray[np.intp], tops: FloatArray, *, planned: bool
) -> tuple[FloatArray, NDArray[np.bool_]]:
    """Find the line speed that each cam is designed for, and whether it is to bear the line's ramps there.

    A cam that runs while the line ramps may run no faster than what bears it, which may make others ramp. One that runs at a steady line
    only need not bear its ramps.

    Parameters
    ----------
    gaps, of
        The list, and which cam makes each piece.
    lengths
        Lengths of the cams (m).
    tops
        Their line speeds on a line that keeps its speed (m/s).
    planned
        Whether the line's speed is planned; where it is given every cam that can is to bear the ramps.

    Returns
    -------
    (tops, bears)
        Shapes ``(cams,)``.

    Raises
    ------
    InfeasibleError
        A cam that runs while the line ramps bears it at no line speed.
    """
    found = np.array(
        [ramping_speed(job, length, top) for length, top in zip(lengths.tolist(), tops.tolist(), strict=True)]
    )
    bears = found == tops
    ramp = job.line.acceleration
    if not planned or ramp is None:
        return tops, bears & job.line.ramps
    ends = np.concatenate([[0.0], np.cumsum(gaps)])
    places = np.stack([ends[:-1], 0.5 * (ends[:-1] + ends[1:]), ends[1:]])
    slower = np.zeros(len(tops), dtype=bool)
    while True:
        plan = fastest_line(gaps, np.where(slower, found, tops)[of], ramp)
        at = plan.speed(plan.when(places))
        ramping = np.zeros(len(tops), dtype=bool)
        ramping[np.unique(of[at.max(axis=0) > at.min(axis=0) * (1.0 + _STEADY)])] = True
        more = ramping & ~bears & ~slower
        if not more.any():
            return np.where(slower, found, tops), bears | slower
        if (found[more] <= 0.0).any():
            length = float(lengths[more][found[more] <= 0.0][0])
            raise InfeasibleError(
                f"no cam of {with_unit(length, 'm', 4, job.units)} bears the line's ramp of "
                f"{with_unit(ramp, 'm/s^2', 4, job.units)}; let it ramp more gently",
                "line.acceleration",
                None,
                "m/s^2",
                (),
            )
        slower |= more


def _require_running(
    job: Job, asked: CutList, of: NDArray[np.intp], changes: dict[tuple[int, int], Change], cams: Sequence[ListCam]
) -> None:
    """Refuse a list with a change that no motion makes while the line runs."""
    for change in changes.values():
        if change.times and change.how == "stop":
            at = int(first_pieces(of, change)[0])
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
                f"{asked.where(at)}: from {one} to {other} no motion within the limits leads while the line runs; "
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
            here = first_pieces(of, change)
            highest[here] = np.minimum(highest[here], change.line_speed)
    return highest
