"""Which columns of a recording are time, command, actual position and master: by their names, or as they are asked for."""

from __future__ import annotations

import difflib
from dataclasses import replace

from camwright.profiles.errors import InputError
from camwright.profiles.tables.column_words import is_measured, is_position, split_unit, trace_role
from camwright.profiles.tables.delimited import Sheet

_CYCLES = frozenset({"cycle", "cycles", "zyklus"})
"""What the first column of a trace of CODESYS 2.3 is called, saved as a text."""

_SAY = "say which is meant with --columns TIME,COMMAND,ACTUAL"


def columns_by_name(sheet: Sheet, master: bool, header: str) -> dict[str, list[int]]:
    """Say which columns are what: one command and one actual position, or the lag in the place of one, and the times.

    One master, where it is asked for and there; where there are several, that whose name says that it was measured. Of several
    columns of times those before the positions, that of the last of them last.

    Raises
    ------
    InputError
        A column is missing or there twice.
    """
    scope = any(
        column.heading == "Name" for column in sheet.columns
    )  # whose times have that heading, whatever channels are called
    at = _by_role(sheet, scope=scope)
    for name, found in at.items():
        if not found:
            raise _missing(sheet, name, header)
    if master and (masters := _masters(sheet)):
        at["master"] = masters
    for name, found in at.items():
        if len(found) > 1 and not (name == "time" and scope):
            at[name] = _only(sheet, name, found)
    if len(at["time"]) > 1:
        at["time"] = _times_before(sheet, at)
    return at


def _by_role(sheet: Sheet, *, scope: bool) -> dict[str, list[int]]:
    """Find all columns of each role that must be filled; a lag stands for the position that is not there."""
    roles = [trace_role(column.name) if column.name else None for column in sheet.columns]
    at = {role: [k for k, own in enumerate(roles) if own == role] for role in ("time", "command", "actual", "lag")}
    if scope:
        at["time"] = [k for k in at["time"] if sheet.columns[k].heading == "Name"]
    lags = at.pop("lag")
    if lags and (at["command"] == []) != (at["actual"] == []):
        at = {name: found for name, found in at.items() if found or name == "time"} | {"lag": lags}
    return at


def _missing(sheet: Sheet, name: str, header: str) -> InputError:
    """Say that a column is missing, and which it may be."""
    names = _called(sheet)
    left = [names[k] for k, column in enumerate(sheet.columns) if trace_role(column.name) is None]
    if name == "time" and left and left[0].strip().lower() in _CYCLES:
        return InputError(
            f"{sheet.where}: column {left[0]!r} counts cycles of the PLC, and how long one lasts is not in the file; write the time in "
            "its place, under time [ms]"
        )
    near = difflib.get_close_matches(name, [word.lower().split("[")[0].strip() for word in left], n=1, cutoff=0.6)
    told = f"the columns are {', '.join(map(repr, names[:8]))}; " if any(names) else ""
    told = f"is it {near[0]!r}? " if near else told
    return InputError(f"{sheet.where}: there is no column {name}; {told}write a header like {header}, or {_SAY}")


def _only(sheet: Sheet, name: str, found: list[int]) -> list[int]:
    """Give the one of several columns that has the very name, or else is called a position."""
    exact = [k for k in found if sheet.columns[k].name.strip().lower() == name]
    exact = exact or [k for k in found if is_position(sheet.columns[k].name)]
    if len(exact) != 1:
        both = " and ".join(repr(_called(sheet)[k]) for k in found[:2])
        raise InputError(f"{sheet.where}: column {name} stands there twice ({both}); leave one out, or {_SAY}")
    return exact


def _called(sheet: Sheet) -> list[str]:
    """Call the columns as messages do."""
    return [column.heading[:50] or column.name[:50] for column in sheet.columns]


def columns_chosen(sheet: Sheet, columns: str, master: bool) -> tuple[Sheet, dict[str, list[int]]]:
    """Take the columns that are asked for, with the units that are said.

    Raises
    ------
    InputError
        There is no such column, or there are several, or its unit is another.
    """
    asked = [part.strip() for part in columns.split(",")]
    if len(asked) not in (2, 3):
        raise InputError(
            "--columns takes headings or numbers of command and actual, or of time, command and actual, separated by commas; got "
            f"{columns[:60]!r}"
        )
    changed = list(sheet.columns)
    found: list[int] = []
    for part in asked:
        name, unit, known = split_unit(part)
        numbers = [
            k
            for k, column in enumerate(sheet.columns)
            if name == str(k + 1) or {part.lower(), name.lower()} & {column.heading.lower(), column.name.lower()}
        ]
        if len(numbers) != 1:
            names = ", ".join(repr(column.heading[:30]) for column in sheet.columns[:12])
            raise InputError(
                f"{sheet.place}: --columns {part[:40]!r}: {len(numbers)} columns are called so; the columns are {names}; their numbers "
                "may be said, too"
            )
        column = sheet.columns[numbers[0]]
        if unit is not None and column.unit is not None and unit != column.unit:
            raise InputError(
                f"{sheet.place}: --columns {part[:40]!r}: the file says that it is in {column.unit[:20]!r}"
            )
        if unit is not None:
            changed[numbers[0]] = replace(column, unit=unit, known=known)
        found += numbers
    named = replace(sheet, columns=tuple(changed))
    at = {name: [k] for name, k in zip(("time", "command", "actual")[-len(found) :], found, strict=True)}
    if "time" not in at:
        at["time"] = _times_before(named, at)
    if master and (masters := _masters(named)):
        at["master"] = masters
    return named, at


def _times_before(sheet: Sheet, at: dict[str, list[int]]) -> list[int]:
    """Find the columns of times by name; of several those that stand before the positions."""
    times = [k for k, column in enumerate(sheet.columns) if column.name and trace_role(column.name) == "time"]
    if not times:
        raise InputError(f"{sheet.place}: there is no column time; {_SAY}")
    if len(times) == 1:
        return times
    return sorted(
        {max((k for k in times if k < found[0]), default=times[0]) for name, found in at.items() if name != "time"}
    )


def _masters(sheet: Sheet) -> list[int]:
    """Find the columns of the master; where one of several is the measured one, that."""
    found = [k for k, column in enumerate(sheet.columns) if column.name and trace_role(column.name) == "master"]
    measured = [k for k in found if is_measured(sheet.columns[k].name)]
    return measured if len(found) > 1 and len(measured) == 1 else found
