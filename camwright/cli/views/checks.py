"""Checks with their values and limits."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from camwright.cli.views.numbers import millimetres, number
from camwright.validation.check import Check


def checks_view(checks: Sequence[Check]) -> RenderableType:
    """Show checks with values, limits and the master position of the worst value."""
    table = Table(title="Checks", title_justify="left")
    for name in ("check", "", "value", "limit", "unit", "at", "source"):
        table.add_column(name, justify="right" if name in ("value", "limit", "at") else "left")
    for check in checks:
        table.add_row(
            check.name,
            Text("passed", "green") if check.passed else Text("FAILED", "bold red"),
            number(check.value, "none"),
            number(check.limit, ""),
            check.unit,
            "" if check.at is None else f"{millimetres(check.at)} mm",
            Text(check.source),
        )
    return table
