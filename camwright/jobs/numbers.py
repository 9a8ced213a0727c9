"""A job as plain numbers in SI units, under the keys of a job file."""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import Any

from camwright.jobs.job import Job
from camwright.profiles.machines import CrankSlider, LinearCarriage, Machine, RotaryKnife


def machine_numbers(machine: Machine) -> dict[str, Any]:
    """Write a machine under the keys of a job file; the place of a crank's sync zone is null while it is free."""
    if isinstance(machine, RotaryKnife):
        return {
            "kind": "rotary_knife",
            "circumference": machine.circumference,
            "blades": machine.blades,
            "gear_ratio": machine.gear_ratio,
            "sync": machine.sync,
            "inertia": machine.drum_inertia,
            "friction": machine.drum_friction,
        }
    if isinstance(machine, LinearCarriage):
        return {"kind": "linear_carriage", **asdict(machine)}
    if isinstance(machine, CrankSlider):
        free = math.isnan(machine.sync_at)
        return {"kind": "crank_slider", **asdict(machine), "sync_at": None if free else machine.sync_at}
    raise TypeError(f"{type(machine).__name__} has no table in job files")


def job_numbers(job: Job) -> dict[str, Any]:
    """Write a job as plain numbers in SI units."""
    return {
        "name": job.name,
        "machine": machine_numbers(job.machine),
        "cut": asdict(job.cut),
        "limits": asdict(job.limits),
        "servo": asdict(job.servo),
        "objective": job.objective,
        "servo_aware": job.servo_aware,
        "command": job.command,
        "servo_tolerance": None if job.servo_tolerance is None else asdict(job.servo_tolerance),
        "points": job.output.points,
    }
