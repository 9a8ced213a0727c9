"""`Target`: a drive that a table is written for, and the header of its files."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.tables.cam_table import CamTable, TableUnits, Unit
from camwright.profiles.tables.interpolation import by_law
from camwright.profiles.tables.number_formats import NumberFormat

Spacing = Literal["pieces", "free", "equidistant"]
"""Where a target's points may lie: at the ends of the profile's pieces (carried whole), anywhere, or evenly spaced."""

SAFETY_NOTE = (
    "Importing corrupt files can result in unwanted behavior of the axes. "
    "Each time you import a cam from a file, check the integrity of the imported data."
)

_LINE = r"(?m)^[-+0-9., \t]{0,80}[/#(*<!-]{0,4} ?"
"""Where a line of a head begins: in a comment only, so that no name of a user's can pass for it."""
_POINTS = re.compile(_LINE + r"points: ([0-9]{1,7}); period: (\S{1,30}) \S{1,20}; cam: (open|closed|appending)")
_RUNS_ONCE = re.compile(_LINE + r"runs once, from cam: ")
_ADDED = re.compile(_LINE + r"table: ([0-9]{1,2}) of ([0-9]{1,2}), times the line speed")
_SAME = 1e-6
"""Part of period and travel by which a table may miss what its head states."""
_LONGEST = 24
_DIGITS = 8
_SIMPLE = re.compile(r"[a-z][a-z0-9]*(-[a-z0-9]+)*")
_SUMMED = re.compile(rf"-[0-9a-f]{{{_DIGITS}}}$")
_CONTROL = re.compile(r"[\x00-\x1f\x7f-\x9f\u2028\u2029]+")
_FACTS = re.compile(
    _LINE + r"camwright units: "
    r"master (\S{1,20}) (\S{1,30}), slave (\S{1,20}) (\S{1,30}?)( rad)?; advance (\S{1,30})(?!\S)"
)


@dataclass(frozen=True)
class Header:
    """What the head of a table says about its origin.

    Parameters
    ----------
    name
        Name of the product or job, as the user writes it.
    version
        Version of the program.
    job_sha256
        SHA-256 of the job file, or ``""`` without one.
    facts
        Further lines, ``(what, value)``: peak values, number of wraps judged.
    warnings
        Why the table was not released, if it was written all the same.
    link
        The master's period in the unit that the user named for it, or ``""`` where none was named.
    """

    name: str
    version: str
    job_sha256: str = ""
    facts: tuple[tuple[str, str], ...] = ()
    warnings: tuple[str, ...] = ()
    link: str = ""

    def lines(self, target: str, table: CamTable) -> list[str]:
        """Write the head's lines, plain text without control characters; a target's writer puts them into comments."""
        units = table.units
        master, slave = (units.master.symbol, units.slave.symbol) if units else ("units", "units")
        lines = [f"camwright {self.version}: cam table for {target}", f"name: {self.name}"]
        if self.job_sha256:
            lines.append(f"job SHA-256: {self.job_sha256}")
        lines += [f"NOT RELEASED: {warning}" for warning in self.warnings]
        lines.append(f"points: {table.points}; period: {table.period!r} {master}; cam: {table.kind}")
        if units:
            turned = " rad" if units.slave.si == "rad" else ""
            lines.append(
                f"camwright units: master {master} {units.master.size!r}, slave {slave} {units.slave.size!r}{turned}; "
                f"advance {float(f'{table.advance:.15g}')!r}"  # the sum of a cycle's steps may miss it by its last digit
            )
        lines += [f"{what}: {value}" for what, value in self.facts]
        lines.append(SAFETY_NOTE)
        return [_CONTROL.sub(" ", line) for line in lines]

    @property
    def identifier(self) -> str:
        """The name as an identifier of at most 24 letters, digits and single underscores, beginning with a letter.

        Two names have two identifiers, whatever their case. Words of small letters and digits joined by single hyphens become words
        joined by underscores, which can be undone; any other name keeps what it has of letters and digits and gets eight digits of
        its SHA-256.
        """
        if _SIMPLE.fullmatch(self.name) and len(self.name) <= _LONGEST and not _SUMMED.search(self.name):
            return self.name.replace("-", "_")
        digest = hashlib.sha256(self.name.encode("utf-8", "surrogatepass")).hexdigest()[:_DIGITS]
        plain = re.sub(r"[^A-Za-z0-9]+", "_", self.name[:200]).strip("_")
        plain = plain if re.match(r"[A-Za-z]", plain) else f"Cam_{plain}"
        return f"{plain[: _LONGEST - _DIGITS - 1].rstrip('_')}_{digest}"


def units_in(text: str) -> TableUnits | None:
    """Find the units that a head written by `Header.lines` states; ``None`` without one."""
    facts = _stated(text)
    return facts[0] if facts else None


def advance_in(text: str) -> float | None:
    """Find the slave's travel per cycle that a head written by `Header.lines` states; ``None`` without one."""
    facts = _stated(text)
    return facts[1] if facts else None


def points_in(text: str) -> int | None:
    """Find the number of points that a head written by `Header.lines` states; ``None`` without one."""
    found = _POINTS.search(text)
    return int(found[1]) if found else None


def fits_head(table: CamTable, head: str) -> bool:
    """Whether a table is the one that a head describes: as many points over the same period, with the same advance."""
    found, facts = _POINTS.search(head), _stated(head)
    if found is None or facts is None or int(found[1]) != table.points:
        return False
    try:
        period = float(found[2])
    except ValueError:
        return False
    off = _SAME * float(np.ptp(table.y)) + (
        1.0 if (table.y == np.rint(table.y)).all() else 0.0
    )  # written in whole counts
    return abs(period - table.period) <= _SAME * period and abs(facts[1] - table.advance) <= off


def no_cycle_in(head: str) -> str:
    """Say what a table is whose head states that it is no cycle of a cam; nothing where it is one."""
    found = _POINTS.search(head)
    if (found and found[3] == "open") or _RUNS_ONCE.search(head):
        return "runs once, between rest and a cam or from one cam into another"
    added = _ADDED.search(head)
    if added:
        return f"is number {added[1]} of 0 to {added[2]} that the controller adds, each times a power of the line speed"
    return ""


def _stated(text: str) -> tuple[TableUnits, float] | None:
    found = _FACTS.search(text)
    if not found:
        return None
    try:
        master, slave, advance = (float(found[group]) for group in (2, 4, 6))
    except ValueError:
        return None
    if not (0 < master < 1e12 and 0 < slave < 1e12 and abs(advance) < 1e12):
        return None
    return TableUnits(Unit(found[1], master), Unit(found[3], slave, "rad" if found[5] else "m")), advance


def slash_comments(lines: list[str]) -> str:
    """Write the head as ``//`` comments; braces would be pragmas, a backslash at the end a continuation."""
    return "".join(f"// {line.translate(_HARMLESS).rstrip()}\n" for line in lines)


_HARMLESS = str.maketrans({"{": "(", "}": ")", "\\": "/", "*": "+"})


def not_written(table: CamTable, header: Header) -> dict[str, str]:
    """Refuse to write a layout that is read only.

    Raises
    ------
    InputError
        Always.
    """
    raise InputError(f"the table of {table.points} points of {header.name} is not written: this layout is read only")


def companion(lines: list[str], steps: tuple[str, ...]) -> str:
    """Write the head as a file of its own, for layouts that allow no comment."""
    return "\n".join([*lines, "", *(f"{i}. {step}" for i, step in enumerate(steps, start=1))]) + "\n"


@dataclass(frozen=True, kw_only=True)
class Target:
    """A drive or controller that takes cam tables.

    Parameters
    ----------
    name
        What the user calls it by.
    title
        Maker and mechanism.
    interpolation
        What the controller computes between the points.
    law
        The law that its pieces follow in a `CamTable`.
    spacing
        Where its points may lie.
    max_points
        Most points of a table, or ``None`` if no limit is documented.
    number_format
        How it stores the points.
    evidence
        Where the layout and the interpolation are known from, and what was inferred.
    steps
        What the engineer does to bring the table into the controller.
    endings
        What the names of its files end with, behind the header's identifier.
    write
        The table and its header as files, by name.
    read
        The table in a text; the second argument names the file in messages. Raises `InputError` only.
    rebuild
        The motion that the controller makes of a table, in its number format and in the table's units.
    tested_on_controller
        Whether a file written here has run on the controller.
    min_points
        Fewest points of a table.
    least_step
        Least distance of two points as a part of the master period.
    states_laws
        Whether its tables say of each piece what law it follows; else all follow `law`.
    master_steps
        Spacings of the master that it takes, in whole units of the table; none where the file holds no master positions.
    adds_scaled
        How the controller adds cams that are scaled while they run, and where this is known from; empty where no such way is documented.
    """

    name: str
    title: str
    interpolation: str
    law: Literal["quintic", "spline", "line"]
    spacing: Spacing
    max_points: int | None = None
    number_format: NumberFormat = "float64"
    evidence: str
    steps: tuple[str, ...] = ()
    endings: tuple[str, ...] = ()
    write: Callable[[CamTable, Header], dict[str, str]] = not_written
    read: Callable[[str, str], CamTable]
    rebuild: Callable[[CamTable], CamProfile] = by_law
    tested_on_controller: bool = False
    min_points: int = 2
    least_step: float = 0.0
    states_laws: bool = False
    master_steps: tuple[int, ...] = ()
    adds_scaled: str = ""

    @property
    def counts(self) -> bool:
        """Whether it stores whole counts of the slave, and the master by evenly spaced steps."""
        return self.spacing == "equidistant" and self.number_format == "int32"

    def file_names(self, header: Header) -> tuple[str, ...]:
        """Names of the files that `write` makes."""
        return tuple(header.identifier + ending for ending in self.endings)
