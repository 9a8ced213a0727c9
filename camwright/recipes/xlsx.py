"""recipe.xlsx: parameters, expected values, checks and table points as sheets; numbers as numbers, texts as texts."""

from __future__ import annotations

import datetime
import io
from collections.abc import Sequence
from typing import TYPE_CHECKING

from camwright.house.numbers import converted, unit_shown
from camwright.recipes.blocks import visible
from camwright.recipes.catalogue import Catalogue, catalogue_of
from camwright.recipes.facts import GROUPS, Fact, fact_text
from camwright.recipes.model import Recipe, RecipeCheck, RecipeTable
from camwright.recipes.production import mark_blocks, mark_cells, mark_head, start_blocks
from camwright.recipes.release import released_at, status_text
from camwright.recipes.sheet import objective_text, particular_rows, speed_columns

if TYPE_CHECKING:
    from xlsxwriter import Workbook
    from xlsxwriter.format import Format
    from xlsxwriter.worksheet import Worksheet

Cell = str | float | None

_EPOCH = datetime.datetime(2000, 1, 1, tzinfo=datetime.UTC).replace(tzinfo=None)
"""Date of creation that every file states: the same recipe gives the same bytes."""

_TEXT_ONLY = {
    "in_memory": True,
    "strings_to_formulas": False,
    "strings_to_numbers": False,
    "strings_to_urls": False,
}


def recipe_xlsx(recipe: Recipe) -> bytes:
    """Write a recipe as a workbook; the same recipe gives the same bytes.

    Every text is stored as a text, marked so that a spreadsheet does not take it for a formula when it is edited.
    """
    import xlsxwriter

    words, file = catalogue_of(recipe.language, recipe.job.toml), io.BytesIO()
    book = xlsxwriter.Workbook(file, _TEXT_ONLY)
    book.set_properties({"title": f"{words('recipe')} {visible(recipe.name)}", "created": _EPOCH})
    _parameters(_Page(book, words("sheet.parameters"), (44, 24, 10)), recipe, words)
    _speeds(_Page(book, words("sheet.speeds"), (14,) * 13), recipe, words)
    _production(_Page(book, words("sheet.production"), (44, *(16,) * 6)), recipe, words)
    _checks(_Page(book, words("sheet.checks"), (18, 40, 14, 14, 8, 16, 10, 60)), recipe, words)
    for table in recipe.tables:
        page = _Page(book, words("sheet.points", target=table.target)[:31], (8, 22, 22, 22, 26))
        _points(page, table, words)
    book.close()
    return file.getvalue()


class _Page:
    """A sheet that is filled row by row."""

    def __init__(self, book: Workbook, name: str, widths: Sequence[int]) -> None:
        self._sheet: Worksheet = book.add_worksheet(name)
        self._text: Format = book.add_format({"text_wrap": True, "valign": "top", "quote_prefix": True})
        self._head: Format = book.add_format({"bold": True, "text_wrap": True, "valign": "top", "bg_color": "#E8E8E8"})
        self._row = 0
        for column, width in enumerate(widths):
            self._sheet.set_column(column, column, width)
        self._sheet.set_paper(9)  # A4
        self._sheet.fit_to_pages(1, 0)

    def head(self, *cells: str, fixed: bool = False) -> None:
        """Write headings; if fixed they stay in view."""
        for column, cell in enumerate(cells):
            self._sheet.write_string(self._row, column, cell, self._head)
        self._row += 1
        if fixed:
            self._sheet.freeze_panes(self._row, 0)

    def row(self, *cells: Cell) -> None:
        """Write one row; what does not exist stays empty."""
        for column, cell in enumerate(cells):
            if isinstance(cell, str) and cell:
                self._sheet.write_string(self._row, column, cell, self._text)
            elif isinstance(cell, int | float):
                self._sheet.write_number(self._row, column, cell)
        self._row += 1

    def gap(self) -> None:
        """Leave a row empty."""
        self._row += 1


def _parameters(page: _Page, recipe: Recipe, words: Catalogue) -> None:
    page.head(*(words(f"column.{key}") for key in ("quantity", "value", "unit")), fixed=True)
    page.row(words("head.job"), visible(recipe.name))
    page.row(words("column.passed"), status_text(recipe, words))
    if recipe.note:
        page.row(words("note"), visible(recipe.note))
    for row in particular_rows(recipe, words):
        page.row(*row)
    page.row(words("head.objective"), objective_text(recipe, words))
    page.row(words("head.camwright"), f"camwright {recipe.provenance.camwright}")
    page.row(words("head.job_sha256"), recipe.provenance.job_sha256)
    for heading, listed in GROUPS.items():
        page.gap()
        page.head(words(heading))
        for fact in listed(recipe):
            page.row(words(fact.name), *_value(fact, words))
    page.gap()
    page.head(words("section.range"))
    cut, far = recipe.job.si["cut"], recipe.working_range
    for key, edge, unit in (
        ("range.min_length", far.min_length, "m"),
        ("range.max_length", far.max_length, "m"),
        ("range.min_line_speed", far.min_line_speed, "m/s"),
        ("range.max_line_speed", far.max_line_speed, "m/s"),
    ):
        values = {
            "length": f"{converted(cut['length'], 'm', words.units):.6g}",
            "line_speed": f"{converted(cut['line_speed'], 'm/s', words.units):.6g}",
        }
        value = None if edge.value is None else converted(edge.value, unit, words.units)
        page.row(words(key, **values), value, unit_shown(unit, words.units), words.named("binding", edge.binding))
    page.gap()
    page.head(words("section.files"), "SHA-256")
    for table in (*recipe.tables, *(table for motion in recipe.start_tables for table in motion.tables)):
        for file in table.files:
            page.row(file.path, file.sha256)


def _production(page: _Page, recipe: Recipe, words: Catalogue) -> None:
    """Write start and stop as on the sheet, and print marks as numbers; what has no limit stays empty."""
    for key, blocks in (
        ("section.start_stop", start_blocks(recipe, words)),
        ("section.marks", mark_blocks(recipe, words)),
    ):
        page.head(words(key))
        for block in blocks:
            if block["kind"] == "text":
                page.row(block["text"])
            elif key == "section.start_stop":
                page.head(*block["head"])
                for row in block["rows"]:
                    page.row(*row)
        page.gap()
    page.head(*mark_head(words))
    for each in recipe.marks:
        cells = (
            None if isinstance(cell, str) or cell is None else converted(cell, "m", words.units)
            for cell in mark_cells(each)
        )
        page.row(converted(each.line_speed, "m/s", words.units), *cells)


def _value(fact: Fact, words: Catalogue) -> tuple[Cell, str]:
    if isinstance(fact.value, bool | str) or fact.value is None or fact.unit == "curve" or fact.ends:
        return fact_text(fact, words), ""
    return converted(fact.value, fact.unit, words.units), unit_shown(fact.unit, words.units)


def _speeds(page: _Page, recipe: Recipe, words: Catalogue) -> None:
    columns = speed_columns(recipe)
    page.head(
        words("column.share_of_speed"),
        words("column.released"),
        *(words(f"column.{name}", unit=unit_shown(unit, words.units)) for name, unit in columns.items()),
        fixed=True,
    )
    for row in recipe.speeds:
        values = [(getattr(row, name), unit) for name, unit in columns.items()]
        page.row(
            100.0 * row.share,
            words("yes" if released_at(recipe, row.line_speed) else "no"),
            *(None if value is None else converted(value, unit, words.units) for value, unit in values),
        )


def _checks(page: _Page, recipe: Recipe, words: Catalogue) -> None:
    keys = ("check", "value", "limit", "unit", "at", "passed", "source")
    page.head("", *(words(f"column.{key}") for key in keys), fixed=True)
    for name, checks in (("", recipe.checks), *((table.target, table.checks) for table in recipe.tables)):
        for check in checks:
            page.row(name, *_check(check, words))


def _check(check: RecipeCheck, words: Catalogue) -> tuple[Cell, ...]:
    at = None if check.at is None else converted(check.at, "m", words.units)
    passed = words("yes" if check.passed else "no")
    return words.named("check", check.name), check.value, check.limit, check.unit, at, passed, check.source


def _points(page: _Page, table: RecipeTable, words: Catalogue) -> None:
    master, slave, points = table.master_unit.symbol, table.slave_unit.symbol, table.points
    per = "1" if master == slave else f"{slave}/{master}"
    per_master = f"1/{master}" if master == slave else f"{slave}/{master}²"
    columns: list[tuple[str, Sequence[float | None]]] = [
        (words("column.master", unit=master), points.master),
        (words("column.slave", unit=slave), points.slave),
    ]
    if points.ratio is not None:
        columns.append((words("column.ratio", unit=per), points.ratio))
    if points.ratio_slope is not None:
        columns.append((words("column.ratio_slope", unit=per_master), points.ratio_slope))
    page.head(words("column.point"), *(heading for heading, _ in columns), fixed=True)
    for number, row in enumerate(zip(*(values for _, values in columns), strict=True), start=1):
        page.row(number, *row)
