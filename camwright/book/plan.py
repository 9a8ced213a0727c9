"""`Book`: which combinations of cut length, line speed and objective a book holds, and under which numbers and names."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from typing import Any

from camwright.book.ranges import (
    Range,
    decimal,
    distinct,
    parse_range,
)
from camwright.book.units import BookUnits, book_units
from camwright.drives.options import chosen_targets
from camwright.house.numbers import units_of
from camwright.house.provenance import provenance
from camwright.house.toml_file import toml_data
from camwright.house.units import shown
from camwright.jobs.job import Job, parse_job, read_job
from camwright.jobs.line_speeds import line_speeds_text
from camwright.jobs.toml_text import toml_text
from camwright.profiles.errors import InputError
from camwright.profiles.objective import OBJECTIVES
from camwright.profiles.task import Task

MOST_DESIGNS = 100_000
"""Most combinations of a book."""

LAYOUT = 2
"""Version of the layout of a book's folder."""

_LONGEST_NAME = 60


@dataclass(frozen=True)
class Combination:
    """One recipe of a book.

    Parameters
    ----------
    number
        Its number in the book, from 1: by length, then line speed, then objective.
    length
        Cut length (m), exact.
    line_speed
        Line speed (m/s), exact.
    objective
        What is made least.
    first
        Whether it is the first of its cut length.
    """

    number: int
    length: Fraction
    line_speed: Fraction
    objective: str
    first: bool
    units: BookUnits

    @property
    def length_text(self) -> str:
        """Cut length in the unit of the book, as it is written."""
        return decimal(self.length * self.units.per_metre)

    @property
    def speed_text(self) -> str:
        """Line speed in the unit of the book, as it is written."""
        return decimal(self.line_speed * self.units.per_metre_per_second)

    @property
    def folder(self) -> str:
        """Where its files lie in the book's folder."""
        speed = self.units.speed.replace("/", "-per-")
        return f"designs/{self.length_text}{self.units.length}/{self.speed_text}{speed}/{self.objective}"


@dataclass(frozen=True)
class Book:
    """What a book is made of; everything that its bytes depend on.

    Parameters
    ----------
    toml
        Text of the job file.
    job_sha256
        SHA-256 of that text.
    lengths
        Cut lengths (m), ascending.
    line_speeds
        Line speeds (m/s), ascending.
    targets
        Names of the targets that tables are written for.
    versions
        Versions of camwright and the libraries, by name.
    """

    name: str
    toml: str
    job_sha256: str
    lengths: Range
    line_speeds: Range
    objectives: tuple[str, ...]
    targets: tuple[str, ...]
    versions: tuple[tuple[str, str], ...]

    @property
    def units(self) -> BookUnits:
        """Units in which it is read: those of its job."""
        return book_units(units_of(_data(self.toml)))

    def __len__(self) -> int:
        """Count the combinations."""
        return len(self.lengths) * len(self.line_speeds) * len(self.objectives)

    def indices(self, number: int) -> tuple[int, int, int]:
        """Give the indices of length, line speed and objective of the combination of a number, 1 and up."""
        rest, objective = divmod(number - 1, len(self.objectives))
        return *divmod(rest, len(self.line_speeds)), objective

    def combination(self, number: int) -> Combination:
        """Give the combination of a number, 1 and up."""
        length, speed, objective = self.indices(number)
        return Combination(
            number,
            self.lengths[length],
            self.line_speeds[speed],
            self.objectives[objective],
            first=speed == objective == 0,
            units=self.units,
        )

    def job(self, combination: Combination) -> Job:
        """Make the job of a combination, read from a job file of its own.

        Its name begins with number, length and speed, so that no two cams in a controller are called alike.

        Raises
        ------
        InputError
            The combination is no job: its zones do not fit into its cut length, for example.
        """
        of, data = combination, _data(self.toml)
        name = f"C{of.number:05d} L{of.length_text} V{of.speed_text} {self.name}"
        own = {
            **data,
            "name": name[:_LONGEST_NAME].rstrip(" ."),
            "cut": {
                **data["cut"],
                "length": _written(of.length, self.units.per_metre, self.units.length, "m"),
                "line_speed": _written(of.line_speed, self.units.per_metre_per_second, self.units.speed, "m/s"),
            },
            "objective": {**data.get("objective", {}), **_line_speeds(self.toml), "minimise": of.objective},
        }
        return read_job(own, toml_text(own), self.name)  # what is written is read back as it was

    def tasks(self, job: Job) -> list[Task]:
        """Tasks of a job at the book's cut lengths, each at the book's highest line speed: what a common place is looked for by."""
        speed = float(max(self.line_speeds[k] for k in range(len(self.line_speeds))))
        lengths = [float(self.lengths[k]) for k in range(len(self.lengths))]
        return [job.task.with_length(length).at_speed(speed) for length in lengths if length > job.cut.sync_zone]

    def parameters(self) -> dict[str, Any]:
        """Name what makes two books the same, as it is told and stored."""
        return {
            "layout": LAYOUT,
            "job_sha256": self.job_sha256,
            "length": _range_text(self.lengths, self.units.per_metre, self.units.length),
            "line_speed": _range_text(self.line_speeds, self.units.per_metre_per_second, self.units.speed),
            "objective": list(self.objectives),
            "targets": list(self.targets),
            "versions": dict(self.versions),
        }

    @property
    def fingerprint(self) -> str:
        """SHA-256 of the parameters and all values."""
        ranges = [
            str(number) for each in (self.lengths, self.line_speeds) for number in (each.first, each.step, each.count)
        ]
        return hashlib.sha256(json.dumps([self.parameters(), ranges], sort_keys=True).encode()).hexdigest()


def plan_book(
    job: Job, length: str, line_speed: str, objectives: Sequence[str] = (), targets: str | None = None
) -> Book:
    """Plan a book.

    Parameters
    ----------
    job
        The job; its cut length, line speed and, if some are given, its objective are replaced.
    length, line_speed
        Ranges as `camwright.book.ranges.parse_range` reads them; bare numbers are mm and m/min, in
        an inch job inches and feet a minute.
    objectives
        Objectives; the job's if none is given.
    targets
        Names of targets, separated by commas, or ``all``; those of the job, else CSV, if not given.

    Raises
    ------
    InputError
        Every fault of all of them.
    """
    faults: list[str] = []

    def gathered(text: str, option: str, kind: str, unit: str, scale: Fraction) -> Range:
        try:
            values = parse_range(text, option, kind, unit)
        except InputError as error:
            faults.extend(error.faults)
            return Range(Fraction(0), Fraction(0), 0)
        if not distinct(values, scale):
            faults.append(f"{option} {shown(text)}: neighbouring values are the same to 15 digits; take a larger step")
        return values

    units = book_units(job.units)
    lengths = gathered(length, "--length", "length", units.length, units.per_metre)
    speeds = gathered(line_speed, "--line-speed", "speed", units.speed, units.per_metre_per_second)
    asked = tuple(dict.fromkeys(objectives)) or (job.objective,)
    for name in asked:
        faults += _objective_faults(job, name)
    names: list[str] = []
    try:
        names = chosen_targets(targets, job)
    except InputError as error:
        faults += [fault.replace("--to ", "--targets ") for fault in error.faults]
    count = len(lengths) * len(speeds) * len(asked)
    if count > MOST_DESIGNS:
        faults.append(
            f"{len(lengths)} lengths, {len(speeds)} line speeds and {len(asked)} objectives are {count} designs, the limit is "
            f"{MOST_DESIGNS}; make several books"
        )
    if faults:
        raise InputError(*faults)
    origin = provenance(job.sha256)
    libraries = origin["libraries"]
    versions = {"camwright": str(origin["camwright"]), **(libraries if isinstance(libraries, dict) else {})}
    return Book(
        job.name, job.text, job.sha256, lengths, speeds, asked, tuple(dict.fromkeys(names)), tuple(versions.items())
    )


def _objective_faults(job: Job, name: str) -> tuple[str, ...]:
    """Say what is wrong with an objective: there is none of that name, or it is none for this job."""
    if name not in OBJECTIVES:
        return (f"--objective {shown(name)}: there is no such objective; the objectives are {', '.join(OBJECTIVES)}",)
    data = _data(job.text)
    text = toml_text({**data, "objective": {**data.get("objective", {}), "minimise": name}})
    try:
        parse_job(text, f"--objective {name}")
    except InputError as error:
        return error.faults
    return ()


@lru_cache(maxsize=16)
def _line_speeds(text: str) -> dict[str, list[str] | str]:
    """Line speeds of a job that states them, as shares of its own: a book changes that one."""
    stated = "line_speeds" in _data(text).get("objective", {})
    return {"line_speeds": line_speeds_text(parse_job(text, "job").slowest)} if stated else {}


@lru_cache(maxsize=4)
def _data(toml: str) -> dict[str, Any]:
    """Read the data of a job file; kept, because every combination begins with it."""
    return toml_data(toml, "job", "job file")


def _written(value: Fraction, scale: Fraction, unit: str, si: str) -> str:
    """Write a value so that it is read back exactly, or where it is no decimal number, to the nearest float."""
    scaled = value * scale
    power = next((power for power in range(16) if (scaled * 10**power).denominator == 1), None)
    if power is None:
        return f"{float(value)!r} {si}"
    whole, part = divmod((scaled * 10**power).numerator, 10**power)
    return f"{whole}.{part:0{power}d} {unit}" if power else f"{whole} {unit}"


def _range_text(values: Range, scale: Fraction, unit: str) -> str:
    """Write a range for people, or its one value."""
    if len(values) == 1:
        return f"{decimal(values.first * scale)} {unit}"
    return ":".join(decimal(value * scale) for value in (values.first, values.last, values.step)) + f" {unit}"
