"""`Job`: what a job file asks for, in SI numbers; reading it."""

from __future__ import annotations

import hashlib
import tomllib
from dataclasses import dataclass
from pathlib import Path

from camwright.files import read_text
from camwright.job_checks import conflicts
from camwright.job_file import JobFile, Objective, read_structure
from profiles.cycle import Cut
from profiles.errors import InputError
from profiles.limits import Limits
from profiles.machines import RotaryKnife
from profiles.servo import Servo

BUNDLED_JOB = Path(__file__).parent / "jobs" / "paper-600.toml"
"""The paper's job, read when no job file is named."""

_MOST_BYTES = 1 << 20


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
        The machine.
    cut
        The cycle on the master.
    limits
        What the slave may do.
    servo
        The discrete servo.
    objective
        What is made least: ``"peak_acceleration"``, ``"rms_acceleration"``, ``"peak_jerk"`` or ``"rms_jerk"``.
    output
        How the cam is written.
    text
        The job file's text, from which the job can be read again.
    sha256
        SHA-256 of the text in UTF-8, in hexadecimal.
    """

    name: str
    machine: RotaryKnife
    cut: Cut
    limits: Limits
    servo: Servo
    objective: Objective
    output: Output
    text: str
    sha256: str


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
    return parse_job(read_text(file, "job file", _MOST_BYTES), str(file))


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
    file, values, faults = read_structure(data)
    if isinstance(data.get("cut"), dict) and "shear_zone" not in data["cut"]:
        values["shear_zone"] = 0.0
    faults += conflicts(values)
    if file is None or faults:
        raise InputError(*(f"{place}: {fault}" for fault in faults))
    return _job(file, text)


def _job(file: JobFile, text: str) -> Job:
    """Make the job of a file without faults; fill in what it leaves out."""
    cut, servo = file.cut, file.servo
    at = cut.sync_zone - cut.shear_zone if cut.shear_zone_at is None else cut.shear_zone_at
    return Job(
        name=file.name,
        machine=RotaryKnife(file.machine.circumference),
        cut=Cut(
            length=cut.length,
            line_speed=cut.line_speed,
            sync_zone=cut.sync_zone,
            shear_zone=cut.shear_zone,
            shear_zone_at=min(at, cut.sync_zone - cut.shear_zone),
            sync_tolerance=cut.sync_tolerance,
            origin=file.output.origin,
        ),
        limits=Limits(file.limits.speed, file.limits.acceleration, file.limits.jerk, file.limits.reversal),
        servo=Servo(servo.bandwidth, servo.damping, servo.position_gain, servo.sample_time, servo.velocity_feedforward),
        objective=file.objective.minimise,
        output=Output(file.output.points),
        text=text,
        sha256=hashlib.sha256(text.encode()).hexdigest(),
    )
