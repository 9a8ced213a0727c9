"""Checks with their values and limits."""

from __future__ import annotations

from collections.abc import Sequence

from camwright.cli.views.parts import View, fitting, new_table, new_text, stacked
from camwright.cli.views.whole_table import WholeTable
from camwright.house.numbers import Units, number, with_unit
from camwright.validation.check import Check

_ALLOWED, _SLIGHT = "*", 2e-3
"""Mark of a value beyond its limit that passed, and the share of the limit that is so marked."""

_WIDE = 110
"""Columns of a terminal from which the source of each check has room beside it."""


def checks_view(checks: Sequence[Check], units: Units) -> View:
    """Show checks with values, limits and the master position of the worst value; the sources only where there is room."""
    table = fitting(_table(checks, units, sources=True), _table(checks, units, sources=False), _WIDE)
    if not any(_allowed(check) for check in checks):
        return table
    return stacked(
        table,
        new_text(
            f"{_ALLOWED} beyond the limit by no more than rounding leaves, or points between which the axis is not seen"
        ),
    )


def _allowed(check: Check) -> bool:
    """Whether a check passed whose value is shown just beyond its limit."""
    if not check.passed or check.value is None or check.limit is None:
        return False
    return 0.0 < check.value - check.limit <= _SLIGHT * abs(check.limit) and number(check.value) != number(check.limit)


def _value(check: Check, factor: float) -> str:
    """Write the value of a check, marked if it passed beyond its limit."""
    text = number(None if check.value is None else check.value * factor, without="none")
    return f"{text} {_ALLOWED}" if _allowed(check) else text


def _table(checks: Sequence[Check], units: Units, *, sources: bool) -> WholeTable:
    """Lay out the checks."""
    heads = ("check", "", "value", "limit", "unit", "at")
    left = ("check", "", "unit", "source")
    table = new_table("Checks", (*heads, "source") if sources else heads, left, heads)
    for check in checks:
        measure = units.measure(check.unit)
        table.add_row(
            check.name,
            new_text("passed", "green") if check.passed else new_text("FAILED", "bold red"),
            _value(check, measure.factor),
            number(None if check.limit is None else check.limit * measure.factor, without=""),
            check.unit if units.si_measures else measure.printed,
            "" if check.at is None else with_unit(check.at, "m", 4, units),
            *([new_text(check.source)] if sources else []),
        )
    return table
