"""A cut list worked out: its cams, the changes between them, the line's speed over it, its tables, and the servo's cuts."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from camwright.house.progress import Step, ignore
from camwright.jobs.job import Job
from camwright.production.cams import ListCam, highest_for_gap, list_cam, list_job
from camwright.production.changes import Change, find_changes
from camwright.production.line_speeds import given_line_tops, line_speed_tops, plan_line
from camwright.production.list_checks import (
    require_passed,
    require_possible,
    require_ramp,
    require_room,
    require_running,
    require_simulable,
)
from camwright.production.tables import TargetSeams, list_tables
from camwright.profiles.cut_list import CutList
from camwright.profiles.errors import InputError
from camwright.profiles.line import STEADY
from camwright.profiles.line_run import LineRun
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.studies.reach import stand_in
from camwright.validation.production.line_ramp import line_ramp
from camwright.validation.production.motion_table import ShiftCam, motion_table
from camwright.validation.production.shift import Shift, ShiftRun, run_shift

_ROUNDING = 1e-9
"""Part by which two ways to the same time may differ."""

_ALLOWED = 1e-3
"""Share by which a ramp may be harder than what is borne: what a solver's margin leaves."""

_MORE = 1.02
"""Factor on the speed of a given line for which its cams are designed: marks move the pieces along it."""


@dataclass(frozen=True, eq=False)
class ListPlan:
    """The cams of a cut list, the changes between them, and the speed of the line.

    Parameters
    ----------
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
        return tuple(change for change in self.changes.values() if change.transitions)

    @property
    def steady(self) -> NDArray[np.bool_]:
        """Pieces whose cam bears no ramp of the line, shape ``(pieces,)``."""
        return ~np.array([cam.bears_ramps for cam in self.cams])[self.of]

    @property
    def time_at_slowest(self) -> float:
        """Time if the whole list ran at its slowest piece's speed (s); no rounding puts it below the plan's."""
        alone = float(self.asked.gaps.sum() / self.highest.min())
        return max(alone, self.line.time) if math.isclose(alone, self.line.time, rel_tol=_ROUNDING) else alone

    def ramped_too_hard(self, joints: FloatArray) -> NDArray[np.bool_]:
        """Say on which pieces the line ramps harder than their cam bears at its highest line speed.

        Parameters
        ----------
        joints
            Where the pieces begin on the material, and the end of the last (m), shape ``(pieces + 1,)``.
        """
        borne = np.array([line_ramp(cam.solution.profile, cam.job.task).ramp.value for cam in self.cams])
        return np.asarray(self.line.hardest_between(joints) > borne[self.of] * (1.0 + _ALLOWED))


@dataclass(frozen=True, eq=False)
class ListStudy:
    """A cut list worked out: planned, its tables written, its servo run.

    Parameters
    ----------
    planned
        Cams, changes and the fastest line speed.
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


def plan_list(job: Job, asked: CutList, line: LineRun | None = None, step: Step = ignore, runs: int = 1) -> ListPlan:
    """Design the cams of a cut list and plan the speed of the line over it.

    Parameters
    ----------
    job
        The job, `Line.acceleration` of its line known unless the line's speed is given; its line speed is that above which the line never
        runs.
    line
        Speed of the line; the fastest plan if not given.
    runs
        How often a servo will run through it.

    Raises
    ------
    InputError
        A length leaves no room for the sync zone, the line does not get through, or running its servos would not end.
    InfeasibleError
        A gap cannot be cut at any line speed, or a change needs the line to stop.
    SolverError
        The solver failed.
    """
    job, gaps = list_job(job), asked.gaps
    require_room(job, asked)
    material = float(gaps.sum())
    if line is None:
        require_ramp(job)
    else:
        require_passed(material, line)
    require_simulable(material / job.cut.line_speed if line is None else float(line.when(material)), job, runs)
    lengths, first, inverse = np.unique(gaps, return_index=True, return_inverse=True)
    order = np.argsort(first, kind="stable")
    lengths, of = lengths[order], np.argsort(order)[inverse].astype(np.intp)
    step("finding the highest line speeds")
    perfect = np.array([highest_for_gap(job, length) for length in lengths.tolist()])
    require_possible(job, asked, of, perfect)
    step("finding which cams run while the line ramps")
    tops = np.minimum(perfect, job.cut.line_speed)
    if line is not None:  # for the speeds that they will see
        fastest = np.zeros(len(lengths))
        np.maximum.at(fastest, of, line.fastest_between(np.concatenate([[0.0], np.cumsum(gaps)])))
        wanted = np.where(fastest > 0.0, fastest, tops)
        tops, bears = given_line_tops(job, lengths, np.minimum(tops, _MORE * wanted), wanted)
    else:
        tops, bears = line_speed_tops(job, gaps, lengths, of, tops)
    step("designing the cams")
    cams = tuple(
        list_cam(number + 1, job, length, most, top, job.line if bears[number] else STEADY)
        for number, (length, most, top) in enumerate(
            zip(lengths.tolist(), perfect.tolist(), tops.tolist(), strict=True)
        )
    )
    step("looking at the changes")
    changes = find_changes(cams, of, stand_in(job))
    require_running(job, asked, of, changes, cams)
    step("planning the speed of the line")
    highest = _highest(cams, of, changes)
    run = plan_line(job.line, gaps, highest, ~np.array([cam.bears_ramps for cam in cams])[of]) if line is None else line
    require_simulable(float(run.when(material)), job, runs)
    return ListPlan(job, asked, cams, of, changes, highest, run)


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
    own = [cam.solution.profile for cam in cams]
    zeros = [cam.running.zero for cam in cams]
    order = of.copy()
    for change in changes.values():
        for number, transition in enumerate(change.transitions):
            order[change.first_pieces(of) + number] = len(own)
            own.append(transition.profile)
            zeros.append(cams[change.after - 1].running.zero)
    parts = [ShiftCam(profile, zero) for profile, zero in zip(profiles or own, zeros, strict=True)]
    places = {cam.running.zero: cam.job.task for cam in cams}
    kinds = np.array([list(places).index(cam.running.zero) for cam in cams], dtype=np.intp)
    table = motion_table(parts, order, cams[0].job.machine.pitch, cams[0].job.cut.sync_zone, longer)
    return Shift(table, list(places.values()), kinds[of])


def _highest(cams: Sequence[ListCam], of: NDArray[np.intp], changes: dict[tuple[int, int], Change]) -> FloatArray:
    """Give the highest line speed of each piece: its cam's, or that of the transition which begins it."""
    highest = np.array([cam.line_speed for cam in cams])[of]
    for change in changes.values():
        for number in range(len(change.transitions)):
            here = change.first_pieces(of) + number
            highest[here] = np.minimum(highest[here], change.line_speed)
    return highest
