"""A job as plain numbers in SI units, under the keys of a job file."""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import Any

from camwright.jobs.job import Job
from camwright.jobs.tables import servo_numbers
from camwright.profiles.line import STEADY
from camwright.profiles.machines import MACHINES, Machine
from camwright.profiles.machines.fields import fields_of


def machine_numbers(machine: Machine) -> dict[str, Any]:
    """Write a machine under the keys of a job file; the place of its sync zone is null while it is free."""
    values = {each.key: getattr(machine, each.name) for each in fields_of(type(machine))}
    if not machine.placed:
        values[machine.place_name] = None
    return {"kind": machine.kind, **values}


def stored_machine(numbers: dict[str, Any]) -> Machine:
    """Make the machine that `machine_numbers` has written.

    Raises
    ------
    KeyError
        There is no such machine, or a number is missing.
    """
    machine = MACHINES[numbers["kind"]]
    values = {each.name: numbers[each.key] for each in fields_of(machine)}
    return machine(**{name: math.nan if value is None else value for name, value in values.items()})


def job_numbers(job: Job) -> dict[str, Any]:
    """Write a job as plain numbers in SI units; what the line does, and times of zones, are left out where nothing is said of them."""
    numbers = {
        "name": job.name,
        "machine": machine_numbers(job.machine),
        "cut": {key: value for key, value in asdict(job.cut).items() if value is not None},
        "limits": asdict(job.limits),
        "servo": servo_numbers(job.servo),
        "objective": job.objective,
        "servo_aware": job.servo_aware,
        "command": job.command,
        "slowest": job.slowest,
        "servo_tolerance": None if job.servo_tolerance is None else asdict(job.servo_tolerance),
        "points": job.output.points,
    }
    return numbers if job.line == STEADY else numbers | {"line": asdict(job.line)}
