"""What the plots show: while a hand drags the optimum of a motion objective, without bound, servo and comparison; then the design."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from camwright.design.draft import draft
from camwright.jobs.job import Job, parse_job
from camwright.profiles.objective import OBJECTIVES, MotionObjective
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.returns import baseline, baseline_names
from camwright.profiles.task import Task
from camwright.stored.design_file import parse_design
from camwright.validation.motor import greatest_load
from camwright.workbench.sampling import limits_of, samples, zones

_STAND_IN: MotionObjective = "rms_acceleration"
"""What is minimised where the job's own objective takes longer than a hand waits: of the motor, or of the axis."""

_TOUCHED = 1e-6
"""Share by which a peak may stay below its limit and yet count as touching it; a draft on a grid stays further away."""


def preview(text: str, laws: Sequence[str] = (), place: float | None = None) -> dict[str, Any]:
    """Draw the cam of a job at once.

    Parameters
    ----------
    text
        The job file's text.
    laws
        Baselines to draw beside it, those that the machine can have.
    place
        Where the sync zone lies (slave unit) if the job leaves that free: the place of the last design, say. In the middle of where the
        machine can have it if this is nothing, or no place for it.

    Returns
    -------
    dict
        ``objective`` (name, value, unit), ``exact`` (whether it is what a design gives: the optimum of the job's own objective),
        ``binding`` (the limits that are touched), ``units`` that the job is written in (metric, inch), ``slave_unit`` and ``turn`` (slave
        travel of a turn, null where nothing turns), ``place`` (where a sync zone lies that has a place), ``line_speed_m_per_s``,
        ``zones_m``, ``limits`` in SI units, ``samples`` of the cam and of the ``laws``.

    Raises
    ------
    InputError
        The job has faults.
    InfeasibleError
        No motion keeps the limits.
    SolverError
        The solver failed.
    """
    job = parse_job(text, "job")
    own = OBJECTIVES[job.objective].of == "motion" and not job.servo_aware and job.limits.motor is None
    placed = job.task if job.machine.placed else _placed(job.task, place)
    placed = placed.with_cut(replace(placed.cut, shaped=False))
    task = placed.with_limits(replace(placed.limits, motor=None))
    name: MotionObjective = job.objective if own else _STAND_IN  # type: ignore[assignment]
    found = draft(task, name)
    return _drawn(replace(job, machine=placed.machine), placed, found.profile, laws) | {
        "objective": {
            "name": name,
            "value": found.value,
            "unit": OBJECTIVES[name].unit(job.machine.slave_unit),
        },
        "exact": own and job.machine.placed and found.exact,
    }


def drawn_design(text: str, laws: Sequence[str] = ()) -> dict[str, Any]:
    """Draw a design: what is shown once it is proved.

    Parameters
    ----------
    text
        The text of a design.json.
    laws
        As of `preview`.

    Returns
    -------
    dict
        As of `preview`, ``exact`` always; the objective is told by the design itself.

    Raises
    ------
    InputError
        The text is no design.json.
    """
    stored = parse_design(text, "design")
    return _drawn(stored.job, stored.job.task, stored.profile, laws) | {"exact": True}


def _placed(task: Task, place: float | None) -> Task:
    """Put a free sync zone where it is asked for, if it can be there."""
    least, greatest = task.machine.place_range(task.cut)
    return task.placed_at(place) if place is not None and least < place < greatest else task.placed_midway()


def _drawn(job: Job, task: Task, profile: CamProfile, laws: Sequence[str]) -> dict[str, Any]:
    """Gather what plots show of a cycle."""
    known = baseline_names(task)
    return {
        "job": job.name,
        "units": job.units.name,
        "binding": _binding(profile, task),
        "slave_unit": job.machine.slave_unit,
        "turn": job.machine.slave_turn,
        "place": task.machine.place if task.machine.place_name else None,
        "line_speed_m_per_s": job.cut.line_speed,
        "zones_m": zones(job),
        "limits": limits_of(job),
        "samples": samples(profile, task),
        "laws": {law: samples(baseline(law, task), task) for law in laws if law in known},
    }


def _binding(profile: CamProfile, task: Task) -> list[str]:
    """Name the limits that a cycle touches."""
    v, limits = task.cut.line_speed, task.limits
    found = []
    for order, (name, limit) in enumerate(
        (("speed", limits.speed), ("acceleration", limits.acceleration), ("jerk", limits.jerk)), start=1
    ):
        low, high = (extreme.value * v**order for extreme in profile.extrema(order))
        if max(-low, high) >= limit * (1.0 - _TOUCHED):
            found.append(name)
        if order == 1 and not task.reverses and low <= _TOUCHED * v:
            found.append("reversal")
    if limits.motor is not None and task.machine.moves_something:
        torque, available = greatest_load(profile, task, limits.motor)
        if torque.value >= available * (1.0 - _TOUCHED):
            found.append("motor_torque")
    return found
