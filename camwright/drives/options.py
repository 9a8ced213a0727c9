"""The options that name targets and units of cam tables."""

from __future__ import annotations

import math

from camwright.house.units import quantity
from camwright.profiles.errors import InputError
from camwright.profiles.machines import Machine
from camwright.profiles.tables.cam_table import Unit, Units
from camwright.profiles.tables.targets import TARGETS, target_of
from camwright.profiles.task import Task

_MOST_NAMES = 50
_LENGTHS = {"m": 1.0, "mm": 1e-3, "um": 1e-6, "in": 0.0254}


def parse_targets(text: str) -> list[str]:
    """Read ``codesys,logix`` or ``all`` into names of targets.

    Raises
    ------
    InputError
        An unknown name, or none.
    """
    if text.strip() == "all":
        return list(TARGETS)
    names = [name.strip() for name in text.split(",") if name.strip()]
    if not names or len(names) > _MOST_NAMES:
        raise InputError(
            f"--to names one or more targets, separated by commas, or all; the targets are {', '.join(TARGETS)}"
        )
    return [target_of(name).name for name in names]


def default_units(machine: Machine) -> Units:
    """Millimetres; degrees for a slave that is counted in rad."""
    slave = Unit("mm", 1e-3) if machine.slave_unit == "m" else Unit("deg", math.radians(1.0), "rad")
    return Units(Unit("mm", 1e-3), slave)


def parse_units(text: str, task: Task, period: float | None = None) -> Units:
    """Read ``mm,deg`` into the units of master and slave.

    A degree or a turn (``rev``) of the master is that part of the cycle, one of the slave that part of a turn of the
    drum or the crank. A quantity is a unit, too: ``0.5 um`` for a count of an encoder.

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
    master = {**_LENGTHS, "deg": cut.length / 360.0, "rev": cut.length}
    if period is not None:
        master["cycle"] = cut.length / period
    if machine.slave_unit == "rad":
        slave = {"rad": 1.0, "deg": math.radians(1.0), "rev": 2 * math.pi}
    elif machine.slave_turn is not None:
        slave = {**_LENGTHS, "deg": machine.slave_turn / 360.0, "rev": machine.slave_turn}
    else:
        slave = _LENGTHS
    turned = machine.slave_unit == "rad"
    return Units(
        Unit(*_unit(names[0], master, "length")),
        Unit(*_unit(names[1], slave, "angle" if turned else "length"), machine.slave_unit),
    )


def _unit(name: str, known: dict[str, float], kind: str) -> tuple[str, float]:
    """Find a unit's size by its name, or read a quantity."""
    if name in known:
        return name, known[name]
    if name[:1].isdigit() and len(name) <= 20:
        return name.replace(" ", ""), quantity(name, kind)
    raise InputError(
        f"--units: there is no unit {name[:20]!r} here; the units are {', '.join(known)}, or a quantity like "
        f"{'0.5 um' if kind == 'length' else '0.01 deg'}"
    )
