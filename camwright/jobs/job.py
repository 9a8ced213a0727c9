"""`Job`: what a job file asks for, in SI numbers; reading it."""

from __future__ import annotations

import hashlib
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from camwright.house.files import read_text
from camwright.jobs.checks import conflicts
from camwright.jobs.fields import Known
from camwright.jobs.machine_checks import moved_by_nothing, sync_zone_of
from camwright.jobs.machine_tables import machine_of
from camwright.jobs.servo_checks import tolerance_of
from camwright.jobs.structure import (
    Command,
    JobFile,
    read_structure,
)
from camwright.profiles.cut import Cut
from camwright.profiles.errors import InputError
from camwright.profiles.limits import Limits
from camwright.profiles.machines import Machine
from camwright.profiles.motor import MotorCurve
from camwright.profiles.objective import ObjectiveName
from camwright.profiles.servo import Servo
from camwright.profiles.servo_tolerance import ServoTolerance
from camwright.profiles.task import Task

BUNDLED_JOB = Path(__file__).parent / "paper-600.toml"
"""The paper's job, read when no job file is named."""

MOST_BYTES = 1 << 20
"""The most bytes that a job file may have."""


@dataclass(frozen=True)
class Output:
    """How the cam is written.

    Parameters
    ----------
    points
        Rows of cam.csv.
    """

    points: int


@dataclass(frozen=True)
class Job:
    """One machine, one product, one drive; all numbers in SI units.

    Parameters
    ----------
    name
        What the job is called.
    machine
        The machine; a crank may leave the place of its sync zone to the design.
    cut
        The cycle on the master.
    limits
        What the slave may do, in its own unit.
    servo
        The discrete servo.
    objective
        What is made least, a key of `camwright.profiles.objective.OBJECTIVES`; ``"sync_error"`` only of servo-aware designs.
    servo_aware
        Whether the axis, not only its command, keeps the sync tolerance in the shear zone.
    command
        What a servo-aware design may do to the command in the sync zone.
    servo_tolerance
        Ranges of the servo's parameters, nothing where the job file gives none.
    output
        How the cam is written.
    text
        The job file's text, from which the job can be read again.
    sha256
        SHA-256 of the text in UTF-8, in hexadecimal.
    """

    name: str
    machine: Machine
    cut: Cut
    limits: Limits
    servo: Servo
    objective: ObjectiveName
    servo_aware: bool
    command: Command
    servo_tolerance: ServoTolerance | None
    output: Output
    text: str
    sha256: str

    @property
    def task(self) -> Task:
        """The job's machine, cut and limits."""
        return Task(self.machine, self.cut, self.limits)


def load_job(path: str | Path | None = None) -> Job:
    """Read a job file.

    Parameters
    ----------
    path
        The file; the bundled job of the paper if not given.

    Raises
    ------
    InputError
        The file cannot be read, or it has faults: all of them are told, each with its place.

    Examples
    --------
    >>> job = load_job()
    >>> job.name, job.cut.length, job.limits.speed
    ('paper-600', 0.6, 3.3333333333333335)
    """
    file = BUNDLED_JOB if path is None else Path(path)
    return parse_job(read_text(file, "job file", MOST_BYTES), str(file))


def parse_job(text: str, place: str) -> Job:
    """Read a job from the text of a job file.

    Parameters
    ----------
    text
        TOML.
    place
        What messages begin with: the file's path.

    Raises
    ------
    InputError
        It is not TOML, or it has faults.
    """
    try:
        data = tomllib.loads(text.removeprefix("\ufeff"))
    except RecursionError as error:
        raise InputError(f"{place}: not a job file: its arrays or tables are nested too deeply") from error
    except ValueError as error:  # TOMLDecodeError, and integers beyond Python's limit of digits
        end = f"at the end, line {text.rstrip().count(chr(10)) + 1}"
        raise InputError(f"{place}: not TOML: {str(error).replace('at end of document', end)}") from error
    return read_job(data, text, place)


def read_job(data: dict[str, Any], text: str, place: str) -> Job:
    """Read a job from what the text of its job file holds; as `parse_job`.

    Raises
    ------
    InputError
        It has faults.
    """
    file, known, faults = read_structure(data)
    faults += conflicts(known)
    machine = machine_of(known)
    zone = sync_zone_of(known, machine)
    if file is not None and machine is not None:
        faults += moved_by_nothing(machine, file.objective.minimise, with_curve=file.limits.motor is not None)
    if file is None or machine is None or zone is None or faults:
        raise InputError(*(f"{place}: {fault}" for fault in faults))
    return _job(file, known, machine, zone, text)


def _job(file: JobFile, known: Known, machine: Machine, zone: float, text: str) -> Job:
    """Make the job of a file without faults; fill in what it leaves out."""
    cut, objective = file.cut, file.objective
    servo = Servo(**file.servo.model_dump(exclude={"tolerance"}))
    at = zone - cut.shear_zone if cut.shear_zone_at is None else cut.shear_zone_at
    return Job(
        name=file.name,
        machine=machine,
        cut=Cut(
            length=cut.length,
            line_speed=cut.line_speed,
            sync_zone=zone,
            shear_zone=cut.shear_zone,
            shear_zone_at=min(at, zone - cut.shear_zone),
            sync_tolerance=cut.sync_tolerance,
            origin=file.output.origin,
            sync_ratio=cut.sync_ratio,
            shaped=objective.servo_aware and objective.command == "shaped",
        ),
        limits=Limits(
            file.limits.speed,
            file.limits.acceleration,
            file.limits.jerk,
            file.limits.reversal,
            None if file.limits.motor is None else MotorCurve(file.limits.motor),
        ),
        servo=servo,
        objective=objective.minimise,
        servo_aware=objective.servo_aware,
        command=objective.command or "in_sync",
        servo_tolerance=None if file.servo.tolerance is None else tolerance_of(known, servo),
        output=Output(file.output.points),
        text=text,
        sha256=hashlib.sha256(text.encode()).hexdigest(),
    )
