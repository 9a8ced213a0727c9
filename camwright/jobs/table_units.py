"""The units of cam tables: as an option names them, as a file names them, or as the job's cycle and pitch tell them."""

from __future__ import annotations

import math
import re

from camwright.house.units import quantity
from camwright.jobs.job import Job
from camwright.profiles.cut import Cut
from camwright.profiles.errors import InputError
from camwright.profiles.machines import Machine
from camwright.profiles.tables.cam_table import CamTable, TableUnits, Unit
from camwright.profiles.task import Task

_ANGLE = re.compile(r"([+-]?[0-9]{1,9}(?:\.[0-9]{1,9})?(?:e-?[0-9])?) ?(deg|rev)")
_COUNTS = re.compile(r"([1-9][0-9]{0,9})(?: counts?)? ?/ ?rev")
_PER_TURN = re.compile(r"/ ?rev$")
_LENGTHS = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "um": 1e-6, "in": 0.0254, "ft": 0.3048}


def default_units(machine: Machine) -> TableUnits:
    """Millimetres; degrees for a slave that is counted in rad."""
    slave = Unit("mm", 1e-3) if machine.slave_unit == "m" else Unit("deg", math.radians(1.0), "rad")
    return TableUnits(Unit("mm", 1e-3), slave)


def parse_units(text: str, task: Task, period: float | None = None) -> TableUnits:
    """Read ``mm,deg`` into the units of master and slave.

    A degree or a turn (``rev``) of the master is that part of the cycle, one of the slave that part of a turn of the
    drum or the crank. A quantity is a unit, too: ``0.5 um`` for a count of an encoder, ``0.0001 deg`` for a kernel's; so is the
    number of counts in a turn: ``36000/rev``.

    Parameters
    ----------
    text
        Two units, separated by a comma.
    task
        The machine, for the slave's turn, and the cut, for the cycle.
    period
        Master period of a table that is read, in its own unit: allows ``cycle`` as the master's unit, the one in which
        that period is the cut length.

    Raises
    ------
    InputError
        Not two units, or one that is not known or not the slave's.
    """
    machine, cut = task.machine, task.cut
    names = [name.strip() for name in text.split(",")]
    if len(names) != 2:
        raise InputError(f"--units takes the master's unit and the slave's, for example mm,deg; got {text[:40]!r}")
    master = _master_units(cut)
    if period is not None:
        master["cycle"] = cut.length / period
    return TableUnits(
        Unit(*_unit(names[0], master, "length", cut.length)),
        Unit(*_unit(names[1], _slave_units(machine), _kind(machine), machine.slave_turn), machine.slave_unit),
    )


def slave_length(text: str, machine: Machine) -> float:
    """Read a distance of the slave, in a unit of its own or as part of a turn.

    Raises
    ------
    InputError
        It is no quantity, or none of the slave's.
    """
    plain = text.strip()
    if plain == "0":
        return 0.0
    size = _part_of_turn(plain, machine.slave_turn) if machine.slave_unit == "m" else None
    return quantity(plain, _kind(machine), signed=True) if size is None else size


def kernel_units(machine: Machine, length: float) -> list[TableUnits]:
    """Give the units that a kernel's own table may be in: 0.0001 deg or mm, as integers always; reals may be deg or mm."""
    master = Unit("0.0001 deg", length / 3_600_000)
    slaves = [
        Unit(f"{name}{word}", size * each, machine.slave_unit)
        for name, size in (("0.0001 ", 1e-4), ("", 1.0))
        for word, each in _slave_units(machine).items()
        if word in ("deg", "mm")
    ]
    return [TableUnits(master, slave) for slave in slaves]


def units_of(table: CamTable, asked: str | None, job: Job, place: str) -> tuple[TableUnits, tuple[str, ...]]:
    """Give the units that the file states, else those that the user states, else those in which the cycle is the job's.

    Returns
    -------
    (units, notes)
        A sentence for each assumption, with how to give the truth.
    """
    unit = job.machine.slave_unit
    if table.units is not None:
        if asked is not None:
            stated = f"{table.units.master.symbol},{table.units.slave.symbol}"
            raise InputError(f"{place}: the file states its units ({stated}); leave --units out")
        if table.units.slave.si != unit:
            raise InputError(
                f"{place}: the slave is counted in {table.units.slave.si}, but that of the job's machine in {unit}; name "
                "the job that the file was made for"
            )
        return table.units, ()
    if asked is not None:
        return parse_units(asked, job.task, table.period), ()
    return _from_words(table, job, place)


def _from_words(table: CamTable, job: Job, place: str) -> tuple[TableUnits, tuple[str, ...]]:
    """Units that the file names, as long as the job has them; what it does not name from the cycle and the pitch."""
    machine, cut = job.machine, job.cut
    master_word, slave_word = table.words
    notes: list[str] = []
    master = Unit("master unit", cut.length / table.period)
    if master_word is not None:
        master = Unit(*_unit(master_word, _master_units(cut), "length", cut.length))
    else:
        notes.append(
            f"the master's unit is not in the file: its period, {table.period:.6g}, is taken for the cut length "
            "(--units M,S says the truth)"
        )
    if slave_word is not None:
        return TableUnits(master, Unit(*_slave_word(slave_word, machine, place), machine.slave_unit)), tuple(notes)
    if not (table.advance > 0 and machine.pitch > 0):
        advance = table.advance if table.kind == "appending" else 0.0
        raise InputError(
            f"{place}: the slave advances by {advance:.10g} in a cycle, so its unit cannot be told from the pitch; "
            "say it with --units, for example --units cycle,mm (cycle: the master's unit is that in which the cut length "
            "is the table's period)"
        )
    notes.append(
        f"the slave's unit is not in the file: its advance, {table.advance:.6g}, is taken for the pitch "
        f"(--units {master_word or 'cycle'},mm says the truth)"
    )
    return TableUnits(master, Unit("slave unit", machine.pitch / table.advance, machine.slave_unit)), tuple(notes)


def _slave_word(word: str, machine: Machine, place: str) -> tuple[str, float]:
    """Size the unit that a file names for the slave."""
    known = _slave_units(machine)
    if word not in known:
        other = "rad" if word == "rad" else ("an angle" if word in ("deg", "rev") else "m")
        raise InputError(
            f"{place}: the slave is counted in {other}, but that of the job's machine in {machine.slave_unit}; name the "
            "job that the file was made for"
        )
    return word, known[word]


def _master_units(cut: Cut) -> dict[str, float]:
    """Units of the master: lengths, and parts of the cycle."""
    return {**_LENGTHS, "deg": cut.length / 360.0, "rad": 0.5 * cut.length / math.pi, "rev": cut.length}


def _slave_units(machine: Machine) -> dict[str, float]:
    if machine.slave_unit == "rad":
        return {"rad": 1.0, "deg": math.radians(1.0), "rev": 2 * math.pi}
    if machine.slave_turn is not None:
        return {**_LENGTHS, "deg": machine.slave_turn / 360.0, "rev": machine.slave_turn}
    return _LENGTHS


def _kind(machine: Machine) -> str:
    return "angle" if machine.slave_unit == "rad" else "length"


def _part_of_turn(text: str, turn: float | None) -> float | None:
    """Read ``0.0001 deg`` as part of a turn; ``None`` if the text is no angle, or there is nothing that turns."""
    found = _ANGLE.fullmatch(text)
    if found is None or turn is None:
        return None
    return float(found[1]) * turn * (1.0 if found[2] == "rev" else 1.0 / 360.0)


def _unit(name: str, known: dict[str, float], kind: str, turn: float | None) -> tuple[str, float]:
    """Find a unit's size by its name, or read a quantity; one of an angle is part of a turn."""
    if name in known:
        return name, known[name]
    if (counts := _COUNTS.fullmatch(name)) is not None and "rev" in known:
        return f"1/{counts[1]}rev", known["rev"] / int(counts[1])
    if name[:1].isdigit() and len(name) <= 20:
        if _PER_TURN.search(name):
            raise InputError(
                f"--units: {name!r}: counts in a turn are a whole number from 1 to 9999999999, of a slave or a master that turns; write "
                "e.g. 36000/rev"
            )
        size = _part_of_turn(name, turn) if kind == "length" else None
        if size is None:
            try:
                size = quantity(name, kind)
            except InputError as error:
                raise InputError(*(f"--units: {fault}" for fault in error.faults)) from error
        if size == 0.0:
            raise InputError(f"--units: {name!r}: zero; a unit is greater")
        return name.replace(" ", ""), size
    raise InputError(
        f"--units: there is no unit {name[:20]!r} here; the units are {', '.join(known)}, or a quantity like "
        f"{'0.5 um' if kind == 'length' else '0.01 deg'}"
    )
