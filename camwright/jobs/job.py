"""`Job`: what a job file asks for, in SI numbers; reading it, and writing it anew."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from camwright.house.files import read_text
from camwright.house.numbers import METRIC, Units
from camwright.house.toml_file import MOST_BYTES, toml_data
from camwright.jobs.checks import conflicts
from camwright.jobs.fields import Known
from camwright.jobs.line_speeds import line_speeds_text, slowest_share
from camwright.jobs.machine_checks import moved_by_nothing
from camwright.jobs.machine_tables import machine_of
from camwright.jobs.servo_checks import tolerance_of
from camwright.jobs.si_keys import with_units
from camwright.jobs.structure import (
    Command,
    JobFile,
    read_structure,
)
from camwright.jobs.tables import cut_table, limits_table, line_table, machine_table, servo_table
from camwright.jobs.toml_text import toml_text
from camwright.profiles.cut import Cut
from camwright.profiles.errors import InputError
from camwright.profiles.limits import Limits
from camwright.profiles.line import STEADY, Line
from camwright.profiles.machines import MACHINES, Machine
from camwright.profiles.motor import MotorCurve
from camwright.profiles.objective import ObjectiveName
from camwright.profiles.servo import Servo
from camwright.profiles.servo_tolerance import ServoTolerance
from camwright.profiles.task import Task

BUNDLED_JOB = Path(__file__).parent / "paper-600.toml"
"""The paper's job, read when no job file is named."""


@dataclass(frozen=True)
class Output:
    """How the cam is written.

    Parameters
    ----------
    points
        Rows of cam.csv.
    targets
        Targets of the tables where none are named otherwise; none stands for CSV alone.
    counts
        Units of master and slave for targets that store whole counts, as ``--units`` takes them; empty where nothing is said.
    """

    points: int
    targets: tuple[str, ...] = ()
    counts: str = ""


@dataclass(frozen=True)
class Job:
    """One machine, one product, one drive; all numbers in SI units.

    Parameters
    ----------
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
    slowest
        Least line speed at which the cam of a servo-aware design must be in sync, as a share of the cut's; 1 if that is the only one.
    servo_tolerance
        Ranges of the servo's parameters, nothing where the job file gives none.
    output
        How the cam is written.
    line
        How the line ramps its speed, which the slave's limits are to bear.
    source
        The file that it was read from, nothing where there is none; two jobs of the same numbers are equal whatever their files.
    units
        Units in which it is answered, those of who wrote it; no part of its numbers either.

    Examples
    --------
    The text follows the numbers:

    >>> job = load_job()
    >>> shorter = replace(job, cut=replace(job.cut, length=0.5))
    >>> 'length = "500 mm"' in shorter.text, parse_job(shorter.text, "") == shorter
    (True, True)
    >>> shorter.sha256 == job.sha256
    False
    """

    name: str
    machine: Machine
    cut: Cut
    limits: Limits
    servo: Servo
    objective: ObjectiveName
    servo_aware: bool
    slowest: float
    servo_tolerance: ServoTolerance | None
    output: Output
    line: Line = STEADY
    source: Source | None = field(default=None, compare=False, repr=False)
    units: Units = field(default=METRIC, compare=False, repr=False)

    def __post_init__(self) -> None:
        if self.cut.shaped and not self.servo_aware:
            raise InputError(
                f"{self.name}: the cut asks for a shaped command, which is for servo-aware designs only; "
                "give servo_aware=True with it, or a cut with shaped=False"
            )

    @staticmethod
    def of(
        name: str,
        machine: Mapping[str, Any] | Machine,
        cut: Mapping[str, Any] | Cut,
        limits: Mapping[str, Any] | Limits,
        servo: Mapping[str, Any] | Servo,
        objective: Mapping[str, Any] | ObjectiveName = "peak_acceleration",
        output: Mapping[str, Any] | None = None,
        line: Mapping[str, Any] | Line | None = None,
    ) -> Job:
        """Make a job without a job file, checked as one from a file is.

        Parameters
        ----------
        machine, cut, limits, servo
            Each one a table with the keys of a job file, or the object itself. A quantity is a text with a unit, or a number in SI
            units under a key that ends with the unit: ``length_m``, ``line_speed_m_per_s``, ``bandwidth_rad_per_s``, ``mass_kg``.
        objective, output
            Tables with the keys of a job file, as far as they differ from the defaults; the name of the objective will do.
        line
            How the line ramps its speed, a table or the object; nothing for a line that runs steadily.

        Raises
        ------
        InputError
            It has faults: all of them are told, each with its place.

        Examples
        --------
        >>> from camwright import Job, Servo, optimise
        >>> job = Job.of(
        ...     name="short",
        ...     machine={"kind": "rotary_knife", "circumference": "400 mm"},
        ...     cut={"length_m": 0.5, "line_speed": "80 m/min", "sync_zone": "160 mm", "shear_zone": "40 mm"},
        ...     limits={"speed": "200 m/min", "acceleration_m_per_s2": 50.0, "jerk_m_per_s3": 5000.0},
        ...     servo=Servo(bandwidth=120.0, damping=0.7, position_gain=35.0, sample_time=0.004, velocity_feedforward=1.0),
        ... )
        >>> job.cut.length, round(optimise(job).objective, 3)
        (0.5, 6.212)
        """
        table = _table_of(machine)
        known = MACHINES.get(str(table.get("kind")))
        turning = known is not None and known.slave_unit == "rad"
        data: dict[str, Any] = {
            "name": name,
            "machine": table,
            "cut": cut_table(cut) if isinstance(cut, Cut) else cut,
            "limits": limits_table(limits, turning=turning) if isinstance(limits, Limits) else limits,
            "servo": servo_table(servo, None) if isinstance(servo, Servo) else servo,
            "objective": {"minimise": objective} if isinstance(objective, str) else objective,
            "line": line_table(line) if isinstance(line, Line) else dict(line or {}),
            "output": dict(output or {}),
        }
        if isinstance(cut, Cut):
            data["output"].setdefault("origin", cut.origin)
            if cut.shaped and isinstance(data["objective"], Mapping):
                data["objective"] = {"servo_aware": True, "command": "shaped", **data["objective"]}
        faults: list[str] = []
        data = with_units(data, "", faults)
        if faults:
            raise InputError(*(f"{name}: {fault}" for fault in faults))
        return read_job(data, None, name)

    @property
    def command(self) -> Command:
        """What a servo-aware design may do to the command in the sync zone: it follows the cut, which is what is replaced for another.

        Examples
        --------
        >>> job = load_job()
        >>> replace(job, servo_aware=True, cut=replace(job.cut, shaped=True)).command
        'shaped'
        """
        return "shaped" if self.cut.shaped else "in_sync"

    @cached_property
    def text(self) -> str:
        """The job as the text of a job file, from which the same numbers are read again, bit by bit.

        It is that of the file that the job was read from, comments and all, as long as the numbers are the file's; else it is written
        from the numbers. A place of the sync zone that the file leaves free is no other number, wherever the design put it.
        """
        return self.source.text if self.source is not None and self.source.says(self) else toml_text(self._tables())

    @cached_property
    def sha256(self) -> str:
        """SHA-256 of the text in UTF-8, in hexadecimal."""
        return hashlib.sha256(self.text.encode()).hexdigest()

    def _tables(self) -> dict[str, Any]:
        """Write the job as the data of a job file, with every key that it can have."""
        objective: dict[str, Any] = {"minimise": self.objective}
        if self.servo_aware:
            objective |= {
                "servo_aware": True,
                "command": self.command,
                "line_speeds": line_speeds_text(self.slowest),
            }
        return {
            "name": self.name,
            "machine": machine_table(self.machine),
            "cut": cut_table(self.cut),
            "limits": limits_table(self.limits, turning=self.machine.slave_unit == "rad"),
            "servo": servo_table(self.servo, self.servo_tolerance),
            **({} if self.line == STEADY else {"line": line_table(self.line)}),
            "objective": objective,
            "output": {
                "origin": self.cut.origin,
                "points": self.output.points,
                **({"targets": list(self.output.targets)} if self.output.targets else {}),
                **({"counts": self.output.counts} if self.output.counts else {}),
            },
        }

    @property
    def line_speeds(self) -> tuple[float, float]:
        """Least and greatest line speed at which the axis of a servo-aware design must be in sync (m/s)."""
        return self.slowest * self.cut.line_speed, self.cut.line_speed

    @property
    def task(self) -> Task:
        """The job's machine, cut and limits, and how the line ramps."""
        return Task(self.machine, self.cut, self.limits, self.line)


@dataclass(frozen=True)
class Source:
    """The text of a job file, and the job that it says.

    Parameters
    ----------
    job
        The job, without a source of its own.
    """

    text: str
    job: Job

    def says(self, job: Job) -> bool:
        """Whether a job has the numbers of the text; one whose sync zone is placed has those of a text that leaves its place free."""
        own, machine = self.job.machine, job.machine
        if own.placed or own.place_name != machine.place_name:
            return job == self.job
        # a place that is free is not a number, which equals nothing: both are put at the same one
        return replace(job, machine=machine.placed_at(0.0)) == replace(self.job, machine=own.placed_at(0.0))


def _table_of(given: Mapping[str, Any] | Machine) -> Mapping[str, Any]:
    """Give a machine's table as it is, a machine as its table."""
    return given if isinstance(given, Mapping) else machine_table(given)


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
    return read_job(toml_data(text, place, "job file"), text, place)


def read_job(data: dict[str, Any], text: str | None, place: str) -> Job:
    """Read a job from what the text of its job file holds, or would hold where there is none; as `parse_job`.

    Raises
    ------
    InputError
        It has faults.
    """
    file, known, faults = read_structure(data)
    faults += conflicts(known)
    machine = machine_of(known)
    if file is not None and machine is not None:
        faults += moved_by_nothing(machine, file.objective.minimise, with_curve=file.limits.motor is not None)
    if file is None or machine is None or faults:
        raise InputError(*(f"{place}: {fault}" for fault in faults))
    job = _job(file, known, machine)
    return job if text is None else replace(job, source=Source(text, job))


def _job(file: JobFile, known: Known, machine: Machine) -> Job:
    """Make the job of a file without faults; fill in what it leaves out."""
    cut, objective, numbers = file.cut, file.objective, known.numbers
    servo = Servo(**file.servo.model_dump(exclude={"tolerance"}))
    zone, shear = numbers["cut.sync_zone"], numbers["cut.shear_zone"]
    at = numbers.get("cut.shear_zone_at", zone - shear)
    return Job(
        name=file.name,
        machine=machine,
        cut=Cut(
            length=cut.length,
            line_speed=cut.line_speed,
            sync_zone=zone,
            shear_zone=shear,
            shear_zone_at=min(at, zone - shear),
            sync_tolerance=cut.sync_tolerance,
            origin=file.output.origin,
            sync_ratio=cut.sync_ratio,
            shaped=objective.servo_aware and objective.command == "shaped",
            sync_time=known.indirect.times.get("cut.sync_zone"),
            shear_time=known.indirect.times.get("cut.shear_zone"),
        ),
        limits=Limits(
            numbers["limits.speed"],
            numbers["limits.acceleration"],
            numbers["limits.jerk"],
            file.limits.reversal,
            None if file.limits.motor is None else MotorCurve(file.limits.motor),
        ),
        servo=servo,
        objective=objective.minimise,
        servo_aware=objective.servo_aware,
        slowest=slowest_share(known, cut.line_speed),
        servo_tolerance=None if file.servo.tolerance is None else tolerance_of(known, servo),
        output=Output(file.output.points, file.output.targets, file.output.counts),
        line=Line(**file.line.model_dump()),
        units=known.units,
    )
