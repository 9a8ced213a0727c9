"""The trade-off of all objectives and laws."""

from __future__ import annotations

from camwright.cli.views.parts import View, new_table, new_text, stacked
from camwright.house.numbers import number
from camwright.studies.tradeoff import TradeOff, measure_words


def tradeoff_view(result: TradeOff) -> View:
    """Show all profiles, each measure with its multiple of the best."""
    heads = ["minimised, or law"]
    for name in result.measures:
        unit = result.unit(name).replace("^2", "²").replace("^3", "³")
        heads.append(f"{measure_words(name).replace('acceleration', 'acc.')}\n{unit}")
    table = new_table(f"Objectives and laws, by {measure_words(result.sorted_by)}; × the best", heads, heads[:1])
    for row in result.rows:
        title = measure_words(row.name) if row.kind == "objective" else row.name
        cells = [_cell(row.values[measure], result.cost(row, measure)) for measure in result.measures]
        style = "bold" if row.kind == "objective" else ""
        table.add_row(title + ("" if row.within_limits else " †"), *cells, style=style)
    for failure in result.failures:
        table.add_row(measure_words(failure.name), "failed", *[""] * (len(result.measures) - 1), style="bold")
    broken = any(not row.within_limits for row in result.rows)
    notes = [new_text("† breaks a limit of the job; not counted as the best")] if broken else []
    notes += [
        new_text(f"minimised {measure_words(failure.name)}, failed: {failure.reason}") for failure in result.failures
    ]
    return stacked(table, *notes)


def _cell(value: float | None, cost: float | None) -> str:
    """Write a value and its multiple of the best."""
    text = number(value, 4, without="unbounded")
    return text if cost is None else f"{text} ×{cost:.2f}"
