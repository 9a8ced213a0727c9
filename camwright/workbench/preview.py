"""What the page shows while a handle is dragged: the optimum of one motion objective, without bounds, servo and comparison."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from camwright.design.optimise import solve
from camwright.jobs.job import Job, parse_job
from camwright.profiles.objective import OBJECTIVES, MotionObjective
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.returns import baseline, baseline_names
from camwright.profiles.task import Task

POINTS = 721
"""Samples over the cycle."""

_STAND_IN: MotionObjective = "rms_acceleration"
"""What is minimised where the job's own objective takes longer than a hand waits: of the motor, or of the axis."""

_TOUCHED = 1e-6
"""Share by which a peak may stay below its limit and yet count as touching it."""


def preview(text: str, laws: Sequence[str] = ()) -> dict[str, Any]:
    """Draw the cam of a job at once.

    Parameters
    ----------
    text
        The job file's text.
    laws
        Baselines to draw beside it, those that the machine can have.

    Returns
    -------
    dict
        ``objective`` (name, value, unit), ``exact`` (whether it is the job's own objective on the job's own terms), ``binding`` (the
        limits that are touched), ``samples`` over the master and the zones' ends in m.

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
    task = job.task if job.machine.placed else job.task.placed_midway()
    task = task.with_cut(replace(task.cut, shaped=False)).with_limits(replace(task.limits, motor=None))
    name: MotionObjective = job.objective if own else _STAND_IN  # type: ignore[assignment]
    solution = solve(task, name, suggest=False)
    unit = OBJECTIVES[name].unit(job.machine.slave_unit)
    return {
        "job": job.name,
        "objective": {"name": name, "value": solution.minimised, "unit": unit},
        "exact": own and job.machine.placed,
        "binding": _binding(solution.profile, task),
        "slave_unit": job.machine.slave_unit,
        "zones_m": zones(job),
        "limits": limits_of(job),
        "samples": samples(solution.profile, task.cut.line_speed),
        "laws": {law: samples(baseline(law, task), task.cut.line_speed) for law in laws if law in baseline_names(task)},
    }


def samples(profile: CamProfile, line_speed: float) -> dict[str, list[float]]:
    """Sample a cycle over the master: position and ratio over the master, acceleration and jerk over time.

    Parameters
    ----------
    profile
        The cycle.
    line_speed
        Line speed (m/s).
    """
    x = np.linspace(profile.start, profile.end, POINTS)
    return {
        "x_m": x.tolist(),
        "y": profile(x).tolist(),
        "ratio": profile(x, 1).tolist(),
        "speed": (profile(x, 1) * line_speed).tolist(),
        "acceleration": (profile(x, 2) * line_speed**2).tolist(),
        "jerk": (profile(x, 3) * line_speed**3).tolist(),
    }


def zones(job: Job) -> dict[str, list[list[float]]]:
    """Where the sync zone and the shear zone lie on the master of a cycle (m), as parts of it."""
    cut = job.cut
    start = cut.shear_start % cut.length
    end = start + cut.shear_zone
    shear = [[start, end]] if end <= cut.length else [[start, cut.length], [0.0, end - cut.length]]
    return {"sync": [list(part) for part in cut.sync_parts], "shear": shear if cut.shear_zone > 0.0 else []}


def limits_of(job: Job) -> dict[str, float | bool]:
    """List the limits of the slave in SI units."""
    limits = job.limits
    return {
        "speed": limits.speed,
        "acceleration": limits.acceleration,
        "jerk": limits.jerk,
        "reversal": limits.reversal,
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
    return found
