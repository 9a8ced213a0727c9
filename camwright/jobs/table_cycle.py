"""One whole cycle of a table that somebody recorded or exported: a modulo slave unwrapped, an end that is left out put there."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from camwright.jobs.job import Job
from camwright.jobs.table_units import kernel_units, slave_length, units_of
from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import FloatArray
from camwright.profiles.tables.cam_table import CamTable, TableUnits, make_table

_FEWEST = 12
"""Points from which on a jump can be told from motion."""
_JUMP = 0.5
"""Part of the slave's range that one step must be off the ratios beside it to be a jump."""
_USUAL = 4.0
"""By how many times that exceeds the steps beside it."""
_ALIKE = 1e-4
"""Part by which two ratios may differ to be one."""
_PARTS = 12
"""Parts of a turn that a slave may be counted modulo of."""
_EXACT = 1e-5
"""Part of its travel that a slave, unwrapped by a modulus that the machine does not have, may miss."""
_WIDEST = 0.2
"""Part of the cycle up to which a step is one whose end may be missing: beyond, motion would be made up."""
_MOST_OF = 0.5
"""Part of the pitch that a slave must run backwards to be mounted so."""
_NEAR = 0.02
"""Part of a step by which the period may miss the cut length where one row is missing, or one too many."""


@dataclass(frozen=True, eq=False)
class WholeCycle:
    """A table with both its ends, its units, and what had to be assumed, a sentence each."""

    table: CamTable
    units: TableUnits
    notes: tuple[str, ...]


def whole_cycle(
    table: CamTable, job: Job, place: str, units: str | None = None, travel: str | None = None
) -> WholeCycle:
    """Bring a table to one whole cycle of the job.

    Parameters
    ----------
    table
        As it was read.
    job
        What it is run for.
    place
        What messages begin with.
    units
        Units as `camwright.jobs.table_units.parse_units` reads them, for files that state none.
    travel
        Slave's travel per cycle, ``400 mm`` or ``360 deg``, for files that leave out where the cycle ends.

    Raises
    ------
    InputError
        The units or the travel cannot be told; the message names the option that tells them.
    """
    asked = None if travel is None else slave_length(travel, job.machine)
    if not table.travel_known:
        return _closed(table, job, place, units, asked)
    known = _listed_sizes(table, job, place, units) if table.listed else _sizes(table, job, place, units)
    notes: tuple[str, ...] = ()
    if known is not None:
        table, notes = _unwrapped(table, job, known, asked, place)
        table, turned = _forwards(table, job, known)
        ended = _with_listed_end if table.listed else _with_end
        table, more = ended(table, job, known, asked)
        notes += (*turned, *more)
    elif job.machine.pitch > 0:
        table, notes = _unwrapped(table, job, None, None, place)
        table, more = _forwards(table, job, None)
        notes += more
    _require_master_first(table, job, place)
    found, assumed = units_of(table, units, job, place)
    if asked is not None and abs(table.advance * found.slave.size - asked) > job.cut.sync_tolerance:
        raise InputError(
            f"{place}: --travel says {asked:.10g} {job.machine.slave_unit} a cycle, but the table's own ends are "
            f"{table.advance * found.slave.size:.10g} {job.machine.slave_unit} apart; leave --travel out"
        )
    return WholeCycle(table, found, (*notes, *assumed))


def _require_master_first(table: CamTable, job: Job, place: str) -> None:
    """Refuse columns without units of which the first runs over the pitch and the second over the cut length, as if they were swapped."""
    swapped = job.machine.pitch / job.cut.length
    known = table.units is not None or table.words != (None, None)
    if known or not swapped > 0.0 or abs(swapped - 1.0) < _ALIKE or not table.advance > 0.0:
        return
    if abs(table.period / table.advance / swapped - 1.0) < _ALIKE and (np.diff(table.y) > 0.0).all():
        raise InputError(
            f"{place}: the first column runs over {table.period:.6g} and the second over {table.advance:.6g}, like the job's pitch and its "
            "cut length: master and slave are swapped; name the columns with their units, as in x [mm],y [mm]"
        )


def _sizes(table: CamTable, job: Job, place: str, units: str | None) -> TableUnits | None:
    """Give the units where they are known without the table's ends; ``None`` where these are needed to tell them."""
    if units is not None and table.units is None:
        return None if units.replace(" ", "").startswith("cycle,") else units_of(table, units, job, place)[0]
    if table.units is not None or None not in table.words:
        return units_of(table, units, job, place)[0]
    return None


def _listed_sizes(table: CamTable, job: Job, place: str, units: str | None) -> TableUnits:
    """Give the units of a list of slave positions; that of the master is a step, the slave's must be said.

    Raises
    ------
    InputError
        It is not: whether the last row ends the cycle could not be told.
    """
    if units is None and table.words[1] is None:
        raise InputError(
            f"{place}: a list of {table.points} numbers, slave positions at even steps of the master, says no unit; write it above, as in "
            "slave [mm], or say it with --units cycle,mm"
        )
    return units_of(table, units, job, place)[0]


def _with_listed_end(
    table: CamTable, job: Job, units: TableUnits, asked: float | None
) -> tuple[CamTable, tuple[str, ...]]:
    """Put the end of the cycle behind a list whose last row is a step before it: where a step more meets the travel better."""
    travel = (job.machine.pitch if asked is None else asked) / units.slave.size
    step = 0.5 * float(table.y[-1] - table.y[-2] + table.y[1] - table.y[0])
    if abs(table.advance + step - travel) >= abs(table.advance - travel):
        return table, ()
    longer = make_table(
        np.append(table.x, table.x[-1] + 1.0),
        np.append(table.y, table.y[0] + travel),
        law=table.laws[0],
        notes=table.notes,
    )
    note = f"the list ends a step before the cycle, {travel:.6g} {units.slave.symbol} beyond its first row (--travel says another)"
    return replace(longer, words=table.words, units=table.units), (note,)


def _forwards(table: CamTable, job: Job, units: TableUnits | None) -> tuple[CamTable, tuple[str, ...]]:
    """Turn the sign of a slave that runs on, but backwards: drives count as they are mounted."""
    pitch = job.machine.pitch
    back = table.advance < 0.0 if units is None else table.advance * units.slave.size < -_MOST_OF * pitch
    if not (pitch > 0 and back):
        return table, ()
    note = f"the slave runs backwards in the file, {table.advance:.6g} a cycle: its sign was turned"
    return replace(table, y=-table.y, ratio=-table.ratio, ratio_slope=-table.ratio_slope), (note,)


def _unwrapped(
    table: CamTable, job: Job, units: TableUnits | None, asked: float | None, place: str
) -> tuple[CamTable, tuple[str, ...]]:
    """Take out the jumps of a slave that is counted modulo its pitch or its turn."""
    y = table.y
    jumps, usual = _jumps(table.x, y)
    if not len(jumps) or job.machine.pitch <= 0:
        return table, ()
    steps = np.diff(y)
    meant = usual - steps[jumps]
    modulus = float(np.median(np.abs(meant)))
    named = "" if units is None else f" {units.slave.symbol}"
    slack = 2.0 * float(np.abs(usual).max())
    if units is not None:
        ways = [way for way in (asked, job.machine.pitch, job.machine.slave_turn) if way]
        sizes = [way / units.slave.size for way in ways]
        fits = [size for size in sizes if abs(size - modulus) <= slack] or _other_modulus(y, meant, slack, sizes)
        if not fits:
            turns = " or ".join(sorted({f"{size:.6g}{named}" for size in sizes}))
            raise InputError(
                f"{place}: the slave jumps by {float(steps[jumps[0]]):.6g}{named} at point {int(jumps[0]) + 2}, which is no whole "
                f"turn of {turns}; say the travel of a cycle with --travel, or mend the row"
            )
        modulus = min(fits, key=lambda size: abs(size - modulus))
    else:
        modulus = _plain(modulus, slack)
    turned = np.zeros(len(y))
    for jump, by in zip(jumps.tolist(), meant.tolist(), strict=True):
        turned[jump + 1 :] += modulus if by > 0 else -modulus
    rows = ", ".join(str(int(jump) + 2) for jump in jumps[:3])
    note = (
        f"the slave turns over at point {rows}: it is counted modulo {modulus:.6g}{named} and was unwrapped by that"
        if len(jumps) > 1 or jumps[0] != len(y) - 2
        else f"the last row wraps: the slave starts anew there; it was unwrapped by {modulus:.6g}{named}"
    )
    return replace(table, y=y + turned), (note,)


def _other_modulus(y: FloatArray, meant: FloatArray, slack: float, travels: list[float]) -> list[float]:
    """Find a modulus that is no turn of the machine: a part of one, or a plain number; by it the slave must run on to its travel."""
    size, turns = float(np.median(np.abs(meant))), float(np.sign(meant).sum())
    tried = [travel / part for travel in travels for part in range(2, _PARTS + 1)] + [_plain(size, slack)]
    return [
        modulus
        for modulus in tried
        if (np.abs(np.abs(meant) - modulus) <= slack).all()
        and any(abs(float(y[-1] - y[0]) + turns * modulus - travel) <= _EXACT * travel for travel in travels)
    ]


def _jumps(x: FloatArray, y: FloatArray) -> tuple[NDArray[np.intp], FloatArray]:
    """Find the steps that are far too large for motion, and what each would be by the ratios beside it.

    A straight line over half the cycle, as a drive that knows lines takes the sync zone, is one long step at the ratio beside it.
    """
    steps, wide = np.diff(y), np.diff(x)
    if len(y) < _FEWEST:
        return np.zeros(0, dtype=np.intp), np.zeros(0)
    usual = _beside(steps / wide) * wide
    off = np.abs(steps - usual)
    jumps = np.flatnonzero((off > _JUMP * float(np.ptp(y))) & (off > _USUAL * np.abs(_beside(steps))))
    return jumps, usual[jumps]


def _beside(values: FloatArray) -> FloatArray:
    """Mean of the values beside each."""
    beside = np.zeros(len(values))
    beside[1:-1] = 0.5 * (values[:-2] + values[2:])
    beside[0], beside[-1] = values[1], values[-2]
    return beside


def _plain(value: float, slack: float) -> float:
    """Give the number of fewest digits within the slack."""
    for digits in range(1, 13):
        rounded = float(f"{value:.{digits}g}")
        if abs(rounded - value) <= 0.5 * slack:
            return rounded
    return value


def _with_end(table: CamTable, job: Job, units: TableUnits, asked: float | None) -> tuple[CamTable, tuple[str, ...]]:
    """Put the end of the cycle there where the last row is one step short of it; take a row away that is beyond it."""
    length = job.cut.length / units.master.size
    step = float(table.x[-1] - table.x[-2])
    missing = length - table.period
    if abs(missing) > _NEAR * step and abs(missing + step) <= _NEAR * step and table.points > 3:
        rows = {name: getattr(table, name)[:-1] for name in ("x", "y", "ratio", "ratio_slope", "laws")}
        return replace(table, **rows), ("the last row is one step beyond the cycle and was left out",)
    if abs(missing - step) > _NEAR * step or step > _WIDEST * length:
        return table, ()
    travel = (job.machine.pitch if asked is None else asked) / units.slave.size
    meant = float(table.y[-1]) + 0.5 * float(table.y[-1] - table.y[-2] + table.y[1] - table.y[0])
    slack = 2.0 * max(abs(float(table.y[-1] - table.y[-2])), abs(float(table.y[1] - table.y[0])), 1e-12)
    if abs(float(table.y[0]) + travel - meant) > slack:
        return table, ()
    longer = replace(
        table,
        x=np.append(table.x, table.x[0] + length),
        y=np.append(table.y, table.y[0] + travel),
        ratio=np.append(table.ratio, table.ratio[0]),
        ratio_slope=np.append(table.ratio_slope, table.ratio_slope[0]),
        laws=(*table.laws, table.laws[-1]),
    )
    note = (
        "the row that ends the cycle is missing: it was added one step behind the last, "
        f"{travel:.6g} {units.slave.symbol} beyond the first row's slave (--travel says another)"
    )
    return longer, (note,)


def _closed(table: CamTable, job: Job, place: str, units: str | None, asked: float | None) -> WholeCycle:
    """Find the travel of a table that leaves its end out: that of the job where the table runs on to it."""
    tried = (
        [units_of(table, units, job, place)[0]] if units or table.units else kernel_units(job.machine, job.cut.length)
    )
    x, y = table.x, table.y
    slope = 0.5 * ((y[-2] - y[-3]) / (x[-2] - x[-3]) + (y[1] - y[0]) / (x[1] - x[0])) if len(x) > 3 else 0.0
    end = float(y[-2] + slope * (x[-1] - x[-2]))
    slack = 1.01 * float(max(abs(y[-2] - y[-3]), abs(y[1] - y[0]), abs(end - y[-2])))
    if asked is not None:
        travels = [(each, asked / each.slave.size) for each in tried]
        fits = travels if len(travels) == 1 else [entry for entry in travels if abs(y[0] + entry[1] - end) <= slack]
    else:
        travels = [(each, job.machine.pitch / each.slave.size) for each in tried]
        fits = [entry for entry in travels if abs(y[0] + entry[1] - end) <= slack]
    if len(fits) != 1:
        seems = " or ".join(
            f"{(end - float(y[0])) * each.slave.size:.6g} {job.machine.slave_unit} ({each.slave.symbol})"
            for each in tried
        )
        raise InputError(
            f"{place}: the slave's travel per cycle is not in the file; it runs on to about {seems}, and the job's pitch is "
            f"{job.machine.pitch:.6g} {job.machine.slave_unit}; say it with --travel, for example --travel '400 mm', and the "
            "units with --units"
        )
    found, travel = fits[0]
    whose = "the pitch of the job" if asked is None else "what --travel says"
    notes = [f"the slave's travel per cycle is not in the file: {travel:.6g}, {whose}, is taken"]
    if not (units or table.units):
        notes.append(
            f"the units are taken for the kernel's own: {found.master.symbol}, {found.slave.symbol} (--units says others)"
        )
    return WholeCycle(table.closing_by(travel), found, tuple(notes))
