"""What the lower floors say in names and SI units, worded for people: places in the job file, units that they write."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from camwright.house.numbers import METRIC, Shown, Units
from camwright.profiles.errors import CamwrightError, InfeasibleError, InputError
from camwright.profiles.message import HOLE, Message, Value

TABLES: dict[str, tuple[str, ...]] = {
    "cut": ("length", "line_speed", "sync_zone", "shear_zone", "shear_zone_at", "sync_tolerance", "sync_ratio"),
    "limits": ("speed", "acceleration", "jerk", "reversal", "motor"),
    "line": ("stop",),
    "servo": ("position_gain", "sample_time", "bandwidth", "damping", "lead_time"),
    "objective": ("minimise", "line_speeds"),
    "output": ("points",),
}
"""Tables of a job file that hold the quantities which messages name; a machine names its own as ``machine.stroke``."""


def place_of(quantity: str) -> str:
    """Say where in a job file a quantity stands: ``[table] key``."""
    table, _, key = quantity.rpartition(".")
    table = table or next(name for name, keys in TABLES.items() if key in keys)
    return f"[{table}] {key}"


def value_words(value: Value, units: Units = METRIC) -> str:
    """Write a value in the unit that people use for it."""
    unit = units.shown.get(value.unit, Shown(value.unit))
    return value.written(unit.factor, unit.typed or unit.printed, unit.bound)


def words(message: Message | str, units: Units = METRIC) -> str:
    """Word a message as one that speaks of a job file."""
    if isinstance(message, str):
        return message
    known = dict(message.values)
    return HOLE.sub(
        lambda found: place_of(found[2]) if found[1] else value_words(known[found[2]], units),
        message.text,
    )


def error_words(error: CamwrightError, units: Units = METRIC) -> tuple[str, ...]:
    """Word the faults that an error tells, one message each."""
    if isinstance(error, InputError):
        return tuple(words(message, units) for message in error.messages)
    if isinstance(error, InfeasibleError):
        return (words(error.message, units),)
    return (str(error),)


@contextmanager
def in_job_words(units: Units = METRIC) -> Iterator[None]:
    """Let errors that leave speak of the job file, in its units."""
    try:
        yield
    except InfeasibleError as error:
        message = words(error.message, units)
        raise InfeasibleError(
            message, error.binding, error.excess, error.unit, error.suggestions, error.covered
        ) from error
    except InputError as error:
        if not any(isinstance(message, Message) for message in error.messages):
            raise
        raise InputError(*error_words(error, units)) from error


def unforeseen(error: Exception) -> str:
    """Word an error that nobody foresaw: what it is, in which function, and that it is ours.

    Examples
    --------
    >>> unforeseen(ValueError("no such thing"))
    'a fault of camwright, not of the job: ValueError: no such thing; report it with the job file'
    """
    trace = error.__traceback__
    while trace is not None and trace.tb_next is not None:
        trace = trace.tb_next
    where = "" if trace is None else f" (in {trace.tb_frame.f_code.co_name})"
    # a lone surrogate would end the file that the words are written to
    told = "".join(each if each.isprintable() or each.isspace() else ascii(each)[1:-1] for each in str(error))
    return f"a fault of camwright, not of the job: {type(error).__name__}: {told}{where}; report it with the job file"
