"""A book's index as one page: it opens without a network and prints."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from html import escape

from camwright.book.plan import Book
from camwright.book.rows import (
    COLUMNS,
    LIMIT_COLUMNS,
    Cell,
    Counts,
)

_STYLE = """
body { font: 14px/1.4 system-ui, sans-serif; margin: 2em; color: #111; background: #fff; }
h1 { font-size: 1.5em; margin: 0 0 .3em; }
h2 { font-size: 1.15em; margin: 1.6em 0 .4em; }
dl { display: grid; grid-template-columns: max-content auto; gap: .1em 1em; margin: 0; }
dt { color: #555; }
dd { margin: 0; overflow-wrap: anywhere; }
.wide { overflow: auto; max-height: 90vh; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { padding: .15em .6em; border-bottom: 1px solid #ccc; text-align: left; vertical-align: top; }
th { position: sticky; top: 0; background: #eee; border-bottom: 2px solid #555; }
td.n { text-align: right; white-space: nowrap; }
tr.infeasible td, tr.failed td { background: #f2f2f2; }
tr.check_failed td:nth-child(5), tr.failed td:nth-child(5) { font-weight: bold; }
@media (max-width: 40em) { body { margin: 1em; } dl { grid-template-columns: auto; } }
@page { size: A4 landscape; margin: 12mm; }
@media print {
  body { margin: 0; font-size: 8px; }
  .wide { overflow: visible; max-height: none; }
  th { position: static; }
  tr { break-inside: avoid; }
}
"""

_TITLES = {
    "number": "no.",
    "length_mm": "length mm",
    "line_speed_m_per_min": "line speed m/min",
    "peak_speed_m_per_s": "peak speed m/s",
    "peak_acceleration_m_per_s2": "peak acc. m/s²",
    "rms_acceleration_m_per_s2": "RMS acc. m/s²",
    "peak_jerk_m_per_s3": "peak jerk m/s³",
    "following_error_mm": "following error mm",
    "settling_mm": "settling mm",
    "shear_zone_error_mm": "shear-zone error mm",
    "worst_shear_zone_error_mm": "worst servo mm",
    "released_m_per_min": "this cam released m/min",
    "failed_checks": "checks failed",
    "binding": "binds",
    "folder": "files",
    "highest_line_speed_m_per_min": "highest line speed of the book m/min",
    "lower_that_fail": "lower ones that fail",
    "next_line_speed_m_per_min": "next of the book m/min",
    "physical_line_speed_m_per_min": "limits alone m/min",
    "physical_binding": "binds there",
    "axis_in_tolerance_line_speed_m_per_min": "axis in tolerance m/min",
    "axis_in_tolerance_binding": "fails beyond",
    "line_ramp_m_per_s2": "line ramp m/s²",
    "line_stop_m_per_s2": "line stop m/s²",
    "mark_earliest_mm": "mark earliest mm",
    "mark_latest_mm": "mark latest mm",
}

_INCHES = {"_in": "in", "_ft_per_min": "ft/min", "_ft_per_s2": "ft/s²", "_ft_per_s3": "ft/s³"}
"""Units of an inch book by the endings of its columns."""

_HEAD, _MIDDLE, _END = COLUMNS[:5], COLUMNS[5:18], ("binding", "folder")

_STATUS = {"passed": "passed", "check_failed": "check failed", "infeasible": "infeasible", "failed": "solver failed"}


def html_pieces(book: Book, counts: Counts, limits: Iterable[Sequence[Cell]], designs: Iterable[str]) -> Iterator[str]:
    """Write the page piece by piece, its designs as `design_row` writes them; every text is escaped."""
    name = escape(book.name)
    yield '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
    yield f'<meta name="viewport" content="width=device-width">\n<title>{name}: recipe book</title>\n'
    yield f"<style>{_STYLE}</style>\n</head>\n<body>\n<h1>{name}: recipe book</h1>\n<dl>\n"
    for what, value in _facts(book, counts):
        yield f"<dt>{escape(what)}</dt><dd>{escape(value)}</dd>\n"
    yield "</dl>\n<h2>Highest line speeds</h2>\n"
    yield (
        "<p>The highest line speed of the book at which every check passed, and what forbids the next one. “This cam released” is "
        "where the cam of that line speed passes every check. “Limits alone” is what the limits of speed, acceleration, jerk and "
        "reversal allow; the servo may not settle there.</p>\n"
    )
    yield from _table(book, LIMIT_COLUMNS, map(_limit, limits))
    yield "<h2>Designs</h2>\n"
    yield from _table(book, (*_HEAD, *_MIDDLE, *_END), designs)
    yield "</body>\n</html>\n"


def _facts(book: Book, counts: Counts) -> Iterator[tuple[str, str]]:
    """Say what the book is made of."""
    own = book.parameters()
    yield "cut length", own["length"]
    yield "line speed", own["line_speed"]
    yield "objective", ", ".join(book.objectives)
    yield "tables", ", ".join(book.targets) + "; none was tested on a controller"
    ends = f"{counts.passed} passed, {counts.check_failed} with a check that failed, {counts.infeasible} infeasible"
    yield "designs", f"{counts.designs}: {ends}, {counts.failed} failed"
    yield "job SHA-256", book.job_sha256
    yield "made by", ", ".join(f"{name} {version}" for name, version in book.versions)


def _table(book: Book, columns: Sequence[str], rows: Iterable[str]) -> Iterator[str]:
    """Write a table of rows that are written, its heads with the units of the book."""
    named = zip(columns, book.units.named(columns), strict=True)
    heads = "".join(f"<th>{escape(_title(metric, own))}</th>" for metric, own in named)
    yield f'<div class="wide"><table>\n<thead><tr>{heads}</tr></thead>\n<tbody>\n'
    yield from rows
    yield "</tbody>\n</table></div>\n"


def _title(metric: str, own: str) -> str:
    """Write the head of a column: its title, in an inch book with the unit that its own name ends with."""
    words = _TITLES.get(metric, metric)
    if metric == own:
        return words
    for ending, unit in _INCHES.items():
        if own.endswith(ending):
            return f"{words.rpartition(' ')[0]} {unit}"
    return words


def _limit(row: Sequence[Cell]) -> str:
    """Write a row of the limit table."""
    return f"<tr>{''.join(map(_cell, LIMIT_COLUMNS, row))}</tr>\n"


def design_row(row: Sequence[Cell]) -> str:
    """Write a row of the designs; where there is no design its reason takes the place of the numbers."""
    cells = dict(zip(COLUMNS, row, strict=True))
    head = "".join(_cell(column, cells[column]) for column in _HEAD)
    end = "".join(_cell(column, cells[column]) for column in _END)
    reason = escape(str(cells["reason"] or ""))
    if cells["folder"] is None:
        middle = f'<td colspan="{len(_MIDDLE)}">{reason}</td>'
    else:
        numbers = "".join(_cell(column, cells[column]) for column in _MIDDLE[:-1])
        failed = escape(str(cells["failed_checks"] or ""))
        middle = f"{numbers}<td>{failed}{'<br>' if failed and reason else ''}{reason}</td>"
    return f'<tr class="{cells["status"]}">{head}{middle}{end}</tr>\n'


def _cell(column: str, cell: Cell) -> str:
    """Write a cell: numbers with six digits, folders as links."""
    if cell is None:
        return "<td></td>"
    if not isinstance(cell, str):
        return f'<td class="n">{cell:.6g}</td>'
    if column == "folder":
        return f'<td><a href="{escape(cell)}/">{escape(cell.removeprefix("designs/"))}</a></td>'
    if column == "status":
        return f"<td>{_STATUS[cell]}</td>"
    return f"<td>{escape(cell)}</td>"
